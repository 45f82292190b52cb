"""What a campaign's case costs beside the stepping of its FMUs, and what each costs whoever hands them out."""

from __future__ import annotations

import itertools
import time
from concurrent.futures import Executor, Future
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from fmpy.fmi1 import _FMU

from dcone_cosim.campaign.applied import base_of, inputs_of
from dcone_cosim.campaign.cluster import Cluster
from dcone_cosim.campaign.engine import Engine
from dcone_cosim.campaign.reading import read
from dcone_cosim.campaign.sampling import monte_carlo
from dcone_cosim.campaign.shipped import shipped
from dcone_cosim.campaign.shots import ground_of, run_shot
from dcone_cosim.cases.store import Store
from dcone_cosim.progress import Progress
from tests.campaign import fakes

CASES = 3


class _Here(Executor):
    def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> Future[Any]:
        future: Future[Any] = Future()
        future.set_result(fn(*args))
        return future


def engine_of(name: str, store: Any, work: Any, workers: int = 1) -> Engine:
    spec = replace(read(shipped()[name]), until=None)
    base = base_of(spec)
    inputs = inputs_of(spec, base)
    record = tuple(figure.removesuffix("?") for figure in spec.record)
    return Engine(
        spec, inputs, ground_of(base, None, record), name, store, Cluster(_Here(), workers, ""), Progress(), work
    )


@pytest.mark.bench
@pytest.mark.parametrize("name", ["table1-launch-errors", "mission-launch-errors"])
def test_share_of_stepping(name: str, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]) -> None:
    """Share of a case's CPU time in fmi2DoStep; FMUs stay loaded, as in a worker."""
    spent, call = [0.0], _FMU._call

    def timed(self: Any, function: str, *arguments: Any) -> Any:
        before = time.thread_time()
        result = call(self, function, *arguments)
        if function == "fmi2DoStep":
            spent[0] += time.thread_time() - before
        return result

    monkeypatch.setattr(_FMU, "_call", timed)
    one = engine_of(name, None, run_shot)
    size = len(one.inputs.inputs)
    shots = [one.shot(n, one.inputs.values(monte_carlo(1, n, size))) for n in range(1, CASES + 2)]
    run_shot(shots[0])
    spent[0], before = 0.0, time.thread_time()
    assert all(run_shot(shot).status for shot in shots[1:])
    whole = time.thread_time() - before
    with capfd.disabled():
        print(f"\n{name}: {whole / CASES:.3f} CPU-s a case, {100.0 * spent[0] / whole:.1f} % of it in fmi2DoStep")


@pytest.mark.bench
@pytest.mark.parametrize("workers", [1, 1000])
def test_handing_out(tmp_path: Path, workers: int, capfd: pytest.CaptureFixture[str]) -> None:
    """What a case costs the client: its point, its settings, its hash, its row on the disk. With many workers, many
    rows come at a time."""
    study = {"kind": "a campaign", "scene": "", "varied": [], "content": "", "fmus": {}, "code": {}}
    with Store(tmp_path / "out", study) as store:
        one, count = engine_of("table1-launch-errors", store, fakes.row_of, workers), 6000
        size = len(one.inputs.inputs)
        cpu, wall = time.process_time(), time.perf_counter()
        one.run((monte_carlo(1, number, size) for number in itertools.count(1)), count)
        cpu, wall = time.process_time() - cpu, time.perf_counter() - wall
    with capfd.disabled():
        print(f"\n{workers} workers: {1e3 * cpu / count:.2f} ms of CPU a case, {1e3 * wall / count:.2f} ms in all")
