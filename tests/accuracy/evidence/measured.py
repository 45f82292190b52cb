"""What each setting of our models errs by and costs: the table from which a scene's `accuracy` chooses.

    python -m tests.accuracy.evidence.measured

makes `dcone_cosim/measured.json` again, some ten minutes on two cores. Each scene is measured as `dcone accuracy` does;
of every setting the largest error over the scenes is kept, or what could be told of it if that is more, and the median
of its cost over that of the default setting. Of a net only the opening is taken: what comes after scatters more than
any of these settings errs. Schemes that cost ten times the leapfrog there are left out, and so are the one that shows
the shape alone, levels of detail, and substeps that follow the net, which save nothing there: a scene that wants them
names them.
"""

from __future__ import annotations

import json
import statistics
import sys
import tempfile
from collections.abc import Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Any

from dcone_cosim import build
from dcone_cosim.accuracy import plan
from dcone_cosim.accuracy.commands import Done, accuracy
from dcone_cosim.accuracy.settings import NUMERICS
from dcone_cosim.measured import FILE
from dcone_cosim.progress import Lines

COMMAND = "python -m tests.accuracy.evidence.measured"
COARSE = ("capture.net.mesh=1.5 m", "capture.macro_step=0.1 s")
SCENES: tuple[tuple[str, tuple[str, ...]], ...] = (
    ("deployment", (*COARSE, "capture.duration=7 s")),
    ("deployment", (*COARSE, "capture.net.damping_ratio=0", "capture.duration=7 s")),
    ("deployment", (*COARSE, "capture.net.damping_ratio=0.02", "capture.net.fold_side=0.5 m", "capture.duration=7 s")),
    ("deployment", (*COARSE, "capture.net.damping_ratio=0.106", "capture.duration=8 s")),
    ("deployment", (*COARSE, "capture.net.damping_ratio=0.5", "capture.net.side=12 m", "capture.duration=3.5 s")),
    ("table2-deorbit", ("removal.duration=6 h",)),
    ("table2-deorbit", ("removal.duration=90 min", "removal.tether.damping_ratio=0")),
    ("table2-deorbit", ("removal.duration=6 h", "removal.tether.damping_ratio=0.5", "removal.thrust.level=-1 N")),
    (
        "table2-deorbit",
        ("removal.duration=3 h", "removal.tether.rest_length=100 m", "removal.start.separation=95 m",
         "removal.tether.damping_ratio=0.1", "orbit.eccentricity=0.01"),
    ),
)  # fmt: skip
RUNS = 6
OPENING = ("mouth_area", "t80", "bullets")
LEFT_OUT = ("rk4", "ros2", "xpbd")
"""Schemes of the net."""


def rows_of(done: Sequence[Done], model: str) -> list[dict[str, Any]]:
    """The entries of a model, from all its scenes."""
    groups = [g for g in build.numerics(model) if g in build.CATALOGUE[model].groups]
    errors: dict[tuple[str, float], dict[str, float]] = {}
    costs: dict[tuple[str, float], list[float]] = {}
    for report in (report for one in done for report in one.reports):
        axis = report.numerics
        if axis.name != NUMERICS:
            continue
        default = next(p.sample.cpu for p in axis.points if p.setting.size == 1.0)
        for point in axis.points:
            if point.sample.failed:
                continue
            key = (point.setting.family, point.setting.size)
            told = errors.setdefault(key, {})
            for name, error in point.errors.items():
                if not report.plan.chaotic or name in OPENING:
                    told[name] = max(told.get(name, 0.0), error, point.floors[name])
            costs.setdefault(key, []).append(point.sample.cpu / default)
    return [
        {
            "terms": dict(zip(groups, family.split(", "), strict=False)),
            "size": size,
            "errors": {name: float(f"{error:.2g}") for name, error in told.items()},
            "cost": float(f"{statistics.median(costs[family, size]):.3g}"),
        }
        for (family, size), told in errors.items()
    ]


def main() -> None:
    every = plan.settings_of
    plan.settings_of = lambda *of: [s for s in every(*of) if not (s.detail or s.family.startswith(LEFT_OUT))]
    models: dict[str, list[Done]] = {"net_capture": [], "tethered_deorbit": []}
    with tempfile.TemporaryDirectory() as folder:
        for number, (scene, settings) in enumerate(SCENES):
            model = "net_capture" if scene == "deployment" else "tethered_deorbit"
            print(scene, *settings, file=sys.stderr, flush=True)
            out = Path(folder) / str(number)
            models[model].append(accuracy(scene, out, Lines(), settings, runs=RUNS, refine=False))
    content = {
        "made_by": COMMAND,
        "version": version("dcone-cosim"),
        "runs": RUNS,
        "scenes": [[scene, *settings] for scene, settings in SCENES],
        "models": {model: rows_of(done, model) for model, done in models.items()},
    }
    FILE.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
