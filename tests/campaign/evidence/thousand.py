"""A million cases on a thousand workers: a model of discrete events, calibrated on fake cases.

    python -m tests.campaign.evidence.thousand          measure, simulate, and write thousand.json

Measured on this machine: what a case costs the client (its point, settings, hash, and its row on the disk), what a task
costs client, scheduler and workers of dask together, all of them inside one process, and what a row costs that is read
again as a campaign goes on. All are times of a processor, so a busy machine does not change them much; the dask of a
cluster has its scheduler on another processor than the client, and its workers on others again: the model counts all of
it as the scheduler's, which bounds it from above.
"""

from __future__ import annotations

import heapq
import itertools
import json
import logging
import math
import tempfile
import time
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from dcone_cosim.campaign.cluster import Cluster, Persistent, _Dask
from dcone_cosim.campaign.sampling import monte_carlo
from dcone_cosim.campaign.shots import Shot
from dcone_cosim.cases.rows import Row
from dcone_cosim.cases.runner import AHEAD, LOOK, TASKS, Bundles
from dcone_cosim.cases.store import Store
from tests.benchmarks.test_campaign_cost import engine_of
from tests.campaign import fakes

STORED = Path(__file__).with_name("thousand.json")
STUDY = {"kind": "a campaign", "scene": "", "varied": [], "content": "", "fmus": {}, "code": {}}
NAME, CASES, THREADS, TOGETHER = "table1-launch-errors", 6000, 100, 7
WORKERS, WANTED, DURATION, SPREAD = 1000, 1_000_000, 1.6, 0.1


@dataclass(frozen=True)
class Costs:
    """Times [s].

    client     of a case: to make it and to keep its row
    store      of rows that come together, on the clock: they are on the disk
    task       of a task, client, scheduler and worker of dask together
    inside     of each case of a task, the same
    again      of a case that is there already
    """

    client: float
    store: float
    task: float
    inside: float
    again: float


@dataclass(frozen=True)
class Simulated:
    """What a campaign took by the model.

    efficiency   share of the workers' time that cases took
    scheduler    share of one processor that dask takes;  client   the same of the client
    together     cases of a task;  segments   files of rows
    """

    workers: int
    cases: int
    together: int
    wall: float
    efficiency: float
    scheduler: float
    client: float
    segments: int


def nap_row(key: str, seconds: float = 0.0) -> Row:
    return Row(key, "completed", 0, "", {"capture.outcome": "captured"}, {}, {"cpu": seconds})


def nap(shot: Shot, seconds: float) -> Row:
    """A fake case that takes a while and no processor."""
    time.sleep(seconds)
    return nap_row(shot.key, seconds)


def measured() -> Costs:
    with tempfile.TemporaryDirectory() as place, Store(Path(place) / "out", STUDY) as store:
        first, again = _handed_out(store), _handed_out(store)
    alone, seven = (_of_dask(together) - first for together in (1, TOGETHER))
    inside = max(0.0, (TOGETHER * seven - alone) / (TOGETHER - 1))
    return Costs(first, _of_store(), max(0.0, alone - inside), inside, again)


def _handed_out(store: Store) -> float:
    """Time of the processor of a case that takes nothing [s]."""
    one = engine_of(NAME, store, fakes.row_of, WORKERS)
    size = len(one.inputs.inputs)
    cpu = time.process_time()
    one.run((monte_carlo(1, number, size) for number in itertools.count(1)), CASES)
    return (time.process_time() - cpu) / CASES


def _of_store() -> float:
    """Time on the clock to have rows that come together on the disk [s]."""
    together, files = round(LOOK * WORKERS / DURATION), 20
    with tempfile.TemporaryDirectory() as place, Store(Path(place) / "out", STUDY) as store:
        rows = [nap_row(f"{number:064x}") for number in range(together * (files + 1))]
        store.put_all(rows[:together])
        begun = time.perf_counter()
        for file in range(1, files + 1):
            store.put_all(rows[file * together : (file + 1) * together])
        return (time.perf_counter() - begun) / files


def _of_dask(together: int) -> float:
    """Time of the processor of a case where so many go to a task, everything inside this process [s]."""
    import distributed

    logging.getLogger("distributed").setLevel(logging.CRITICAL)
    cases, seconds = 10 * THREADS * together, 1.01 * THREADS / (TASKS * together)
    assert Bundles(AHEAD * THREADS, seconds).together == together
    with (
        distributed.LocalCluster(
            n_workers=1, threads_per_worker=THREADS, processes=False, dashboard_address=None, memory_limit=0
        ) as local,
        distributed.Client(local, set_as_default=False) as client,
        tempfile.TemporaryDirectory() as place,
        Store(Path(place) / "out", STUDY) as store,
    ):
        one = engine_of(NAME, store, partial(nap, seconds=seconds), 1)
        one._cost = seconds
        one._cluster = Cluster(Persistent(_Dask(client)), THREADS, "")
        size = len(one.inputs.inputs)
        cpu = time.process_time()
        one.run((monte_carlo(1, number, size) for number in itertools.count(1)), cases)
        return (time.process_time() - cpu) / cases


def simulated(costs: Costs, workers: int, cases: int, duration: float, spread: float) -> Simulated:
    """A campaign by the model: client and scheduler do one thing at a time, workers a task at a time in their order.

    duration   mean of a case [s];  spread   its standard deviation over it, lognormal [1]
    """
    draw = np.random.default_rng(18)
    sigma = math.sqrt(math.log1p(spread**2))
    together = Bundles(AHEAD * workers, duration).together
    free = [0.0] * workers
    out: list[tuple[float, int]] = []
    given = kept = segments = 0
    now = scheduler = busy_client = busy_scheduler = worked = 0.0
    while kept < cases:
        begun = now
        while given < cases and len(out) < AHEAD * workers:
            size = min(together, cases - given)
            now += size * costs.client
            cost = costs.task + size * costs.inside
            scheduler, busy_scheduler = max(scheduler, now) + cost, busy_scheduler + cost
            task = float(np.exp(sigma * draw.standard_normal(size) - 0.5 * sigma**2).sum()) * duration
            end = max(heapq.heappop(free), scheduler) + task
            heapq.heappush(free, end)
            heapq.heappush(out, (end, size))
            given, worked = given + size, worked + task
        rows = 0
        while out and out[0][0] <= now:
            rows += heapq.heappop(out)[1]
        if rows:
            now, segments, kept = now + costs.store, segments + 1, kept + rows
        busy_client += now - begun
        now = max(now + LOOK, out[0][0] if out and not rows else 0.0)
    last = max(free)
    return Simulated(
        workers, cases, together, last, worked / (workers * last), busy_scheduler / last, busy_client / last, segments
    )


def main() -> None:
    costs = measured()
    runs = [simulated(costs, workers, 100 * workers, DURATION, SPREAD) for workers in (10, 100, 300)]
    runs.append(simulated(costs, WORKERS, WANTED, DURATION, SPREAD))
    told: dict[str, Any] = {
        "costs [s]": asdict(costs),
        "case [s]": {"mean": DURATION, "spread": SPREAD},
        "runs": [asdict(run) for run in runs],
        "restart of all [s]": WANTED * costs.again,
        "lost by a kill": f"what came within {LOOK} s: {round(LOOK * WORKERS / DURATION)} cases, and those being run",
    }
    STORED.write_text(json.dumps(told, indent=1) + "\n", encoding="utf-8")
    print(STORED.read_text(encoding="utf-8"))


if __name__ == "__main__":
    main()
