"""What long tows cost beside other programs and beside the tow that is followed throughout, and what that errs by.

    python -m tests.tethered_deorbit.evidence.speeds

makes `speeds.json` again, in some five minutes on one core; with names of its parts behind it, these alone. All times
are processor time, taken in turns within one run:

day      a damped day of Table 2 with all its tugs: scipy's DOP853 and heyoka on a compiled right-hand side, each at
         the loosest of its tolerances with which the first five tugs are within TIMES and PEAKS of a finer run of ours
         and the pair is where that has it after the day, to APARTED: looser ones miss tugs, and the pair flies apart;
         ours followed, settled, by the event map, and averaged, in macro steps of an hour
spiral   Table 2's pair from 800 to 200 km, followed to its end, and by each level, in macro steps of ten days
year     undamped tugs of a year: so many tows that begin a hundredth of a micrometre apart, followed and by the event
         map. A tow is a sample: the distance of Kolmogorov and Smirnov between the peaks of two tows, both followed,
         and of one followed and one mapped; and of all of one kind together
"""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Callable, Mapping
from importlib.metadata import version
from itertools import combinations, product
from pathlib import Path
from typing import Any

import numpy as np
from scipy.stats import ks_2samp

from dcone_cosim.accuracy.peers import tow
from dcone_cosim.loading import load
from dcone_cosim.quantities import Quantity
from tests.tethered_deorbit.evidence.levels import DAY, LEVELS, ONE_BY_ONE, begun, run

RESULT = Path(__file__).with_name("speeds.json")
COMMAND = "python -m tests.tethered_deorbit.evidence.speeds"
TIMES, PEAKS = 1e-4, 1e-5
"""What is asked of the first tugs of Table 2: times [s], and peaks, relative [1]."""
APARTED = 1e-3
"""And of the separation after the day [m]."""
ROUNDS, FIRST, STEP = 3, 5, 3600.0
PROGRAMS: Mapping[str, Callable[..., Any]] = {"scipy DOP853": tow.by_scipy, "heyoka": tow.by_heyoka}
TABLE_2 = {"thrust.level": -0.01, "start.separation": 10.0}
TERMS = {"reel": "locked", "thrust": "along_track"}
TOLERANCES = ("orbit", "separation", "stretch")
STARTS, APART = 6, 1e-8
"""Tows of a kind, and how far they begin from one another [m]."""

Row = dict[str, Any]


def our_day(level: str, finer: float = 1.0) -> tuple[float, np.ndarray, dict[str, float], float]:
    """Processor time [s], the first tugs, (FIRST, 2), values at its start, and the separation after it [m]."""
    i = begun(TERMS, TABLE_2, level)
    if finer != 1.0:
        own = {f"solver.tolerance_{name}": finer * i[f"solver.tolerance_{name}"] for name in TOLERANCES}
        i = begun(TERMS, TABLE_2 | own, level)
    values = {name: float(i[name]) for name in i.interface.references}
    began = time.process_time()
    tugs = np.zeros((0, 2))
    while i.time < DAY:
        i.step(min(600.0 if len(tugs) < FIRST else STEP, DAY - i.time))
        count = int(i["tether.tug_count"])
        if len(tugs) < FIRST <= count - (0 if not i["tether.taut"] else 1):
            seen = [(i[f"tug[{place}].time"], i[f"tug[{place}].peak"]) for place in range(1, min(count, 16) + 1)]
            tugs = np.array(seen)[::-1][:FIRST] if count <= 16 else tugs
    return time.process_time() - began, tugs, values, i["separation"]


def off(told: list[Quantity], tugs: np.ndarray, apart: float) -> tuple[float, float, float]:
    """Largest error of the first tugs: times [s], and peaks [1]; and of the separation after the day [m]."""
    found = {one.key: np.array(one.values)[:FIRST] for one in told if one.key in ("tug_times", "tug_peaks")}
    if len(found.get("tug_times", ())) < FIRST:
        return np.inf, np.inf, np.inf
    return (
        float(np.abs(found["tug_times"] - tugs[:, 0]).max()),
        float(np.abs(found["tug_peaks"] / tugs[:, 1] - 1.0).max()),
        abs(float(next(one.values[-1] for one in told if one.key == "separation")) - apart),
    )


def day() -> dict[str, Row]:
    """Each program and each level; see above."""
    _, tugs, values, apart = our_day("followed", finer=0.01)
    instants = np.arange(STEP, DAY + 1.0, STEP)
    found: dict[str, Row] = {}
    for name, program in PROGRAMS.items():
        for size in (1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13, 1e-15):
            late, high, away = off(program(values, size, instants).quantities, tugs, apart)
            if late <= TIMES and high <= PEAKS and away <= APARTED:
                found[name] = {
                    "tolerance": size,
                    "off in time [s]": late,
                    "off in peak [1]": high,
                    "off at the end [m]": away,
                }
                break
        print(name, found.get(name), flush=True)
    taken: dict[str, list[float]] = {name: [] for name in (*found, *LEVELS)}
    for level in LEVELS:
        _, own, _, ours = our_day(level)
        found[level] = {
            "off in time [s]": float(np.abs(own - tugs)[:, 0].max()),
            "off in peak [1]": float(np.abs(own[:, 1] / tugs[:, 1] - 1.0).max()),
            "off at the end [m]": abs(ours - apart),
        }
    for _ in range(ROUNDS):
        for name, program in PROGRAMS.items():
            if name in found:
                taken[name].append(program(values, found[name]["tolerance"], instants).cpu)
        for level in LEVELS:
            taken[level].append(our_day(level)[0])
    for name, row in found.items():
        row["cpu [s]"] = round(min(taken[name]), 5)
        row["over the followed"] = round(min(taken[name]) / min(taken["followed"]), 4)
        print("day", name, row, flush=True)
    return found


def spiral() -> dict[str, Row]:
    """See above."""
    main = load("spiral-to-200km").phases[0].main
    found: dict[str, Row] = {}
    for level in LEVELS:
        own = run(begun(main.terms, main.parameters, level), 1200.0, 10.0 * DAY)
        found[level] = {
            "ended [s]": own["time"],
            "mean tension [N]": own["impulse"] / own["time"],
            "tugs": own["count"],
            "cpu [s]": round(own["cpu"], 4),
        }
        first = found[LEVELS[0]]
        found[level] |= {
            "over the followed": round(own["cpu"] / first["cpu [s]"], 6),
            "error of the end [1]": own["time"] / first["ended [s]"] - 1.0,
            "error of the mean tension [1]": found[level]["mean tension [N]"] / first["mean tension [N]"] - 1.0,
        }
        print("spiral", level, found[level], flush=True)
    return found


def year() -> Row:
    """See above."""
    main = load("table2-deorbit").phases[0].main
    values = {**main.parameters, "tether.damping_ratio": 0.0}
    peaks: dict[str, list[np.ndarray]] = {"followed": [], "event_map": []}
    cost = dict.fromkeys(peaks, 0.0)
    for number in range(STARTS):
        for level, of in peaks.items():
            own = {**values, "start.separation": values["start.separation"] + number * APART}
            made = run(begun(main.terms, own, level), 365.0, DAY, calms=False)
            of.append(made["tugs"][made["tugs"][:, 1] > ONE_BY_ONE, 1])
            cost[level] += made["cpu"]
            print("year", number, level, len(of[-1]), float(of[-1].mean()), flush=True)
    alike = {level: [_distance(a, b) for a, b in combinations(of, 2)] for level, of in peaks.items()}
    across = [_distance(a, b) for a, b in product(peaks["followed"], peaks["event_map"])]
    whole = {level: np.concatenate(of) for level, of in peaks.items()}
    return {
        "tugs above 1 N": {level: [len(one) for one in of] for level, of in peaks.items()},
        "mean peak [N]": {level: [float(one.mean()) for one in of] for level, of in peaks.items()},
        "mean peak of all [N]": {level: float(one.mean()) for level, one in whole.items()},
        "90th percentile of all [N]": {level: float(np.percentile(one, 90)) for level, one in whole.items()},
        "distances, both followed [1]": alike["followed"],
        "distances, both mapped [1]": alike["event_map"],
        "distances, followed and mapped [1]": across,
        "distance of all [1]": _distance(whole["followed"], whole["event_map"]),
        "cpu, event map over followed": round(cost["event_map"] / cost["followed"], 4),
    }


def _distance(first: np.ndarray, second: np.ndarray) -> float:
    """Of Kolmogorov and Smirnov [1]."""
    return float(ks_2samp(first, second).statistic)


PARTS: Mapping[str, Callable[[], Any]] = {"day": day, "spiral": spiral, "year": year}


def main() -> None:
    stored = json.loads(RESULT.read_text(encoding="utf-8")) if RESULT.exists() else {}
    made = {}
    for name in sys.argv[1:] or PARTS:
        made[name] = PARTS[name]() | {"of": {"dcone-cosim": version("dcone-cosim"), "heyoka": version("heyoka")}}
        stored |= {"command": COMMAND, **made}
        RESULT.write_text(json.dumps(stored, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
