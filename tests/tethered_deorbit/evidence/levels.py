"""What each level of detail costs and errs by, on five scenes, beside the tow that is followed throughout.

    python -m tests.tethered_deorbit.evidence.levels

makes `levels.json` again, in some ten minutes on one core; with names of scenes behind it, the rows of these alone, and
`remade` says by which version. Of each scene and level it holds: processor time in seconds
and over that of the followed tow; the largest error of times and peaks of tugs above 1 N, as far as they can
be told one by one; errors of the impulse (that of the mean tension) and of what the axis fell by; the share of the
time spent in each way, and the bounds that the level tells. Undamped tugs are compared as distributions: mean and 90th
percentile of their peaks, and the distance of Kolmogorov and Smirnov. Beside them:

axis        drift of the semi-major axis over a year of undamped motion without thrust [m]
arrivals    the whole spiral of Table 2, which is not followed: 70 times the settled one's time
speed       each level and each macro step of a damped day, over the followed one
"""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Mapping
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
from scipy.stats import ks_2samp

from dcone_cosim.loading import load
from fmu_src.instance import Instance, ModelFault
from fmu_src.tethered_deorbit.interface import MODEL, TUGS

RESULT = Path(__file__).with_name("levels.json")
COMMAND = "python -m tests.tethered_deorbit.evidence.levels"
DAY = 86400.0
LEVELS = ("followed", "settled", "event_map", "averaged")
MODES = ("free", "followed", "mapped", "dumbbell", "averaged")
SCENES: Mapping[str, tuple[str, float, Mapping[str, float], tuple[str, ...], float]] = {
    "table2-deorbit": ("table2-deorbit", 30.0, {}, (), 30.0),
    "table2-deorbit, undamped": ("table2-deorbit", 365.0, {"tether.damping_ratio": 0.0}, (), 365.0),
    "spiral-to-200km, 100 days": ("spiral-to-200km", 100.0, {}, (), 100.0),
    "electric-tug, plume left out": ("electric-tug", 60.0, {}, ("plume",), 60.0),
    "geo-graveyard, plume left out": ("geo-graveyard", 7.0, {}, ("plume",), 7.0),
}
"""Scene, days, parameters that are changed, tables that are left out, and days for which it is followed."""
MANY, SOME = 60.0, 600.0
"""Macro step at first, and as long as tugs may come [s]."""
ONE_BY_ONE = 1.0
"""Tugs that are told one by one have a peak above this [N]."""


def begun(terms: Mapping[str, str], values: Mapping[str, float], level: str) -> Instance:
    """A tow of this level at its start."""
    own = {**terms, "level": level} if level != "followed" else {k: v for k, v in terms.items() if k != "level"}
    there = MODEL.interface(own).references
    return Instance(MODEL, own, {name: value for name, value in values.items() if name in there}).initialise()


def run(i: Instance, days: float, macro_step: float, calms: bool = True) -> dict[str, Any]:
    """The tow until its own end, or for so many days; every tug, macro steps short while there are many."""
    found: dict[int, tuple[float, float]] = {}
    cpu, axis = 0.0, i["center.semi_major_axis"]
    try:
        while i.time < days * DAY - 1e-6:
            seen = int(i["tether.tug_count"])
            step = MANY if i.time < 0.25 * DAY else macro_step if calms and i["tether.taut"] else SOME
            step = min(step, days * DAY - i.time)
            began = time.process_time()
            i.step(step)
            cpu += time.process_time() - began
            count = int(i["tether.tug_count"])
            if count != seen or i["tether.taut"]:
                for place in range(1, min(count, count - seen + 1, TUGS) + 1):
                    found[count - place + 1] = (i[f"tug[{place}].time"], i[f"tug[{place}].peak"])
    except ModelFault:
        pass
    ended = float(i["ends.time"]) if "ends.time" in i.interface.references and i["ends.time"] > 0.0 else i.time
    known = i.interface.references
    return {
        "cpu": cpu,
        "time": ended,
        "tugs": np.array([found[number] for number in sorted(found)]).reshape(-1, 2),
        "count": int(i["tether.tug_count"]),
        "impulse": i["tether.impulse"],
        "lowered": axis - i["center.semi_major_axis"],
        "steps": int(i["solver.steps"]),
        "shares": {m: round(i[f"level.{m}"] / ended, 9) for m in MODES if f"level.{m}" in known},
        "told": {m: i[f"level.{m}"] for m in ("error", "average_error") if f"level.{m}" in known},
    }


def beside(own: Mapping[str, Any], other: Mapping[str, Any], damped: bool) -> dict[str, Any]:
    """What one erred by, counted from the other."""
    found: dict[str, Any] = {
        "cpu [s]": round(own["cpu"], 4),
        "over the followed": round(own["cpu"] / other["cpu"], 5),
        "steps": own["steps"],
        "ended [s]": own["time"],
        "error of the end [1]": own["time"] / other["time"] - 1.0,
        "error of the impulse [1]": own["impulse"] / other["impulse"] - 1.0,
        "error of the lowering [1]": own["lowered"] / other["lowered"] - 1.0,
        "tugs": own["count"],
        "shares": own["shares"],
        "bounds told": own["told"],
    }
    mine, its = own["tugs"], other["tugs"]
    if damped and mine.shape == its.shape and len(its):
        hard = its[:, 1] > min(ONE_BY_ONE, 0.5 * its[:, 1].max())
        found["tugs compared"] = int(hard.sum())
        found["error of their times [s]"] = float(np.abs(mine - its)[hard, 0].max())
        found["error of their peaks [1]"] = float(np.abs(mine[hard, 1] / its[hard, 1] - 1.0).max())
    elif len(its):
        hard_mine, hard_its = (tugs[tugs[:, 1] > ONE_BY_ONE, 1] for tugs in (mine, its))
        found["tugs above 1 N"] = [len(hard_mine), len(hard_its)]
        found["mean peak [N]"] = [float(hard_mine.mean()), float(hard_its.mean())]
        found["90th percentile [N]"] = [float(np.percentile(p, 90)) for p in (hard_mine, hard_its)]
        test = ks_2samp(hard_mine, hard_its)
        found["distance of their distributions [1]"] = float(test.statistic)
    return found


def of_scene(name: str) -> dict[str, Any]:
    """Every level of one scene."""
    scene, days, changed, without, followed = SCENES[name]
    main = load(scene).phases[0].main
    terms = {group: term for group, term in main.terms.items() if group not in without}
    values = {**main.parameters, **changed}
    found: dict[str, Any] = {}
    reference: dict[str, Any] | None = None
    for level in LEVELS:
        own = run(
            begun(terms, values, level),
            days if level != "followed" else followed,
            DAY,
            values["tether.damping_ratio"] > 0.0,
        )
        reference = own if reference is None else reference
        found[level] = beside(own, reference, values["tether.damping_ratio"] > 0.0)
        print(name, level, json.dumps(found[level]), flush=True)
    return found


def axis_drift() -> dict[str, float]:
    """Semi-major axis over a year of undamped tugs without thrust [m]: means over two orbits, the last less the first,
    and the slope of a straight line."""
    found = {}
    for level in ("followed", "event_map"):
        values = {"thrust.level": 0.0, "start.separation": 10.0, "start.condition": 2.0, "tether.damping_ratio": 0.0}
        i = begun({"reel": "locked", "thrust": "along_track"}, values, level)
        rows = []
        while i.time < 365.0 * DAY:
            i.step(6060.0 / 4.0)
            rows.append((i.time, i["center.semi_major_axis"]))
        times, axis = np.array(rows).T
        slope = np.polyfit(times, axis - axis[0], 1)[0]
        found[level] = {
            "slope x year": float(slope * 365.0 * DAY),
            "last - first": float(axis[-8:].mean() - axis[:8].mean()),
            "tugs": float(i["tether.tug_count"]),
        }
        print("axis", level, found[level], flush=True)
    return found


def arrivals() -> dict[str, Any]:
    """Table 2's spiral from 800 to 200 km in macro steps of ten days: when it ends, mean tension, processor time."""
    main = load("spiral-to-200km").phases[0].main
    found: dict[str, Any] = {}
    for level in LEVELS[1:]:
        own = run(begun(main.terms, main.parameters, level), 1200.0, 10.0 * DAY)
        found[level] = {"ended [s]": own["time"], "mean tension [N]": own["impulse"] / own["time"],
                        "cpu [s]": round(own["cpu"], 4), "steps": own["steps"]}  # fmt: skip
        print("arrival", level, found[level], flush=True)
    return found


def speed() -> dict[str, Any]:
    """Processor time of a damped day of Table 2, least of five, over that of the followed one."""
    found: dict[str, Any] = {}
    values = {"thrust.level": -0.01, "start.separation": 10.0}
    for macro_step in (60.0, 600.0, DAY):
        taken = {}
        for level in LEVELS:
            best = np.inf
            for _ in range(5):
                i = begun({"reel": "locked", "thrust": "along_track"}, values, level)
                began = time.process_time()
                while i.time < DAY:
                    i.step(macro_step)
                best = min(best, time.process_time() - began)
            taken[level] = best
        found[f"macro steps of {macro_step:g} s"] = {
            level: {"cpu [s]": round(one, 5), "followed over it": round(taken["followed"] / one, 1)}
            for level, one in taken.items()
        }
    print(found, flush=True)
    return found


def main() -> None:
    if names := sys.argv[1:]:
        stored = json.loads(RESULT.read_text(encoding="utf-8"))
        for name in names:
            stored["scenes"][name] = of_scene(name)
            stored["remade"][name] = version("dcone-cosim")
        RESULT.write_text(json.dumps(stored, indent=1) + "\n", encoding="utf-8")
        return
    result = {
        "command": COMMAND,
        "dcone-cosim": version("dcone-cosim"),
        "speed": speed(),
        "axis": axis_drift(),
        "arrivals": arrivals(),
        "scenes": {name: of_scene(name) for name in SCENES},
        "remade": {},
    }
    RESULT.write_text(json.dumps(result, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
