"""The shipped scene `reel-control` in tools that couple FMUs: removal and control side by side, step by step.

Each tool holds the inputs over a step and steps both FMUs from the same outputs, as Jacobi does; our master is asked
for the same. The times can differ by rounding; and some tools read a step's outputs before they set the next inputs, so
what depends on an input directly arrives one step late.
"""

from __future__ import annotations

import functools
import itertools
import tempfile
from collections.abc import Iterable, Iterator
from importlib.metadata import version
from pathlib import Path

import numpy as np

from dcone_cosim import loading
from dcone_cosim.contract import EXTREMES
from dcone_cosim.progress import Progress
from dcone_cosim.recorder import Recorder
from dcone_cosim.scene_fmus import SceneFmus
from dcone_cosim.ssp.export import export_scene
from tests.interop.cases import Points, added_up, multiples_of_equal_steps
from tests.interop.packages import Rows, in_tool, own

SCENE, MAIN = "reel-control", "removal"
STEPS = 1000
GRIDS = {"binary": 2.0, "decimal": 2.1}
"""Coupling steps [s]: one that a double holds, and one that it does not."""
DIRECT = ("tether.tension",)
"""Outputs of the removal that depend directly on what the control commands."""
TITLE = "tethered removal + reel control"
SPREAD = 1e-12
"""Share of an output's largest size, allowed when a tool's times drift from the master's by rounding."""


def package(folder: Path, grid: str, scene: str = SCENE) -> Path:
    """The scene as a package, coupled as the tools do it: held inputs, all at once, one row per coupling step."""
    step = f"{GRIDS[grid]!r} s"
    told = {"coupling.method": "jacobi", "coupling.extrapolation": "constant", "coupling.step": step}
    told |= {"macro_step": step, "duration": f"{STEPS * GRIDS[grid]!r} s"}
    settings = [f"{MAIN}.{key}={value}" for key, value in told.items()]
    (path,) = export_scene(loading.load(scene, settings), folder, Progress(), open_inputs=False).paths
    return path


def nanoseconds(step: float, steps: int) -> Iterator[tuple[float, float]]:
    """Between whole nanoseconds, as libcosim counts what a package says."""
    whole = round(step * 1e9)
    for begin, end in itertools.pairwise(i * whole / 1e9 for i in range(steps + 1)):
        yield begin, end - begin


POINTS = {"libcosim": nanoseconds, "ecos": added_up, "container": multiples_of_equal_steps}
"""Times at which a tool steps."""


def at_points(package: Path, points: Points, step: float) -> Rows:
    """The pair by our own coupling over the given points."""
    scene = loading.load(str(package))
    (phase,) = scene.phases
    with SceneFmus(scene, Progress()) as archives:
        pair = archives.instantiate(phase.name, MAIN)
        try:
            pair.set(phase.main.parameters)
            pair.enter_initialisation(0.0, phase.duration)
            pair.exit_initialisation()
            read = pair.reader([v.name for v in pair.variables.values() if v.causality == "output"])
            rows = [read().copy()]
            for time, size in points(step, STEPS):
                pair.step(time, size)
                rows.append(read().copy())
        finally:
            pair.close()
    return dict(zip(read.names, np.array(rows).T, strict=True))


def pairs(found: Rows, ours: Recorder | Rows, late: Iterable[str] = ()) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Ours and theirs by output, from the first step's end on; those told late a step apart.

    Without the extremes of a step: ours take in what is told at its end, after the exchange, a tool's do not.
    """
    late = set(late)
    assert all(len(rows) == STEPS + 1 for rows in found.values())
    shared = [name for name in found if name in ours and name not in EXTREMES]
    return {n: (ours[n][1:-1], found[n][2:]) if n in late else (ours[n][1:], found[n][1:]) for n in shared}


def differing(found: Rows, ours: Recorder | Rows, late: Iterable[str] = ()) -> list[str]:
    """Outputs that differ in any bit of any row."""
    rows = pairs(found, ours, late).items()
    return [name for name, (a, b) in rows if not np.array_equal(a.astype(float).view(np.int64), b.view(np.int64))]


def farthest(found: Rows, ours: Recorder | Rows, late: Iterable[str] = ()) -> float:
    """Largest difference of an output, as a share of its largest size; elements count by their whole vector's."""
    sizes: dict[str, float] = {}
    rows = pairs(found, ours, late)
    for name, (a, _) in rows.items():
        vector = name.partition("[")[0]
        sizes[vector] = max(sizes.get(vector, 0.0), float(np.max(np.abs(a))))
    return max(float(np.max(np.abs(a - b))) / (sizes[n.partition("[")[0]] or 1.0) for n, (a, b) in rows.items())


@functools.cache
def folder() -> tempfile.TemporaryDirectory[str]:
    """Where the packages are that all tools are given."""
    return tempfile.TemporaryDirectory()


@functools.cache
def packaged(grid: str) -> Path:
    """The scene's package with the steps of a grid."""
    place = Path(folder().name) / grid
    place.mkdir()
    return package(place, grid)


@functools.cache
def found(tool: str, grid: str) -> Rows:
    """What a tool makes of it."""
    return in_tool(tool, packaged(grid), MAIN, GRIDS[grid], STEPS)


@functools.cache
def ours(grid: str) -> Recorder:
    """What our master makes of it."""
    return own(packaged(grid))


@functools.cache
def at_its_times(tool: str, grid: str) -> Rows:
    """What our coupling makes of it at the times of a tool."""
    return at_points(packaged(grid), POINTS[tool], GRIDS[grid])


def verdict(grid: str) -> str:
    """What the table of tools says of the container of fmu-manipulation-toolbox, run by fmpy."""
    length = f"{STEPS} steps of {GRIDS[grid]:g} s"
    theirs, by_master = found("container", grid), ours(grid)
    late = f"`{DIRECT[0]}` arrives one step late"
    if not differing(theirs, by_master, DIRECT):
        return f"same bits as the master's Jacobi over {length}; {late}"
    same = not differing(theirs, at_its_times("container", grid), DIRECT)
    if same and farthest(theirs, by_master, DIRECT) <= SPREAD:
        return (
            f"within {SPREAD:g} over {length}: it steps from i h by h; same bits as the master's at those times; {late}"
        )
    return "differs"


def row() -> list[str]:
    """Its line in that table."""
    title = "fmu-manipulation-toolbox, an FMU container run by fmpy"
    return [title, version("fmu-manipulation-toolbox"), TITLE, *(verdict(grid) for grid in GRIDS)]
