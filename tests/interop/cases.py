"""The two runs that every tool repeats, and what our own `Component` makes of them.

Both come from shipped scenes, and so do their FMUs. The net is coarser than the scene's (2 m), which makes it quick,
and its winches start by the Boolean input; the run goes through contact and closing to the capture. The tow begins with
the line nearly taut, so that it has its tugs from the start, and half way its Real input takes back some of the thrust.

Each run has two grids. The binary one has steps that a double holds exactly, so that no tool's arithmetic of time can
differ. The decimal one has steps that it can not hold: tools that add up t += h drift from i h by rounding.
"""

from __future__ import annotations

import functools
import itertools
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from dcone_cosim import build
from dcone_cosim.fmu.component import Archive, Component
from dcone_cosim.fmu.steppable import VariableInfo
from dcone_cosim.loading import load
from dcone_cosim.scene.data import ComponentScene
from tests.interop.job import Job, Row, Value

Points = Callable[[float, int], Iterator[tuple[float, float]]]
"""`points(step, steps)`: time and size [s] of each step."""

LOOKS = 8
"""Looks at all outputs, evenly spread; the last is the end."""


@dataclass(frozen=True)
class Case:
    """A run to be repeated.

    title      of the FMU, in the table
    scene      shipped scene and phase that give FMU and parameters
    changes    parameters that differ from the scene's
    length     [s]
    steps      of each grid
    command    time [s], input and value
    moved      the parameter that the twins move
    figures    outputs that say how the run came out
    """

    title: str
    scene: str
    phase: str
    changes: dict[str, Value]
    length: float
    steps: dict[str, float]
    command: tuple[float, str, Value]
    moved: str
    figures: tuple[str, ...]

    @functools.cached_property
    def terms(self) -> Mapping[str, str]:
        return self.main.terms

    @functools.cached_property
    def main(self) -> ComponentScene:
        return next(p.main for p in load(self.scene).phases if p.name == self.phase)

    @functools.cached_property
    def path(self) -> Path:
        return build.ensure([(self.main.model, self.terms)], lambda _: None)[0]

    @functools.cached_property
    def told(self) -> tuple[str, str, Mapping[str, VariableInfo]]:
        """Identifier, GUID and variables of the FMU."""
        with Archive(self.path) as archive:
            return str(archive.description.coSimulation.modelIdentifier), archive.guid, dict(archive.variables)

    def job(self, grid: str, coarse: int = 1) -> Job:
        """The run on one of the grids, with steps `coarse` times as long."""
        kinds = {"Real": float, "Integer": int, "Boolean": bool}
        step = self.steps[grid] * coarse
        steps = round(self.length / step)
        at, name, value = self.command
        identifier, guid, variables = self.told
        parameters = {**self.main.parameters, **self.changes}
        return Job(
            fmu=str(self.path),
            identifier=identifier,
            guid=guid,
            step=step,
            steps=steps,
            kinds={v.name: v.kind for v in variables.values()},
            references={v.name: v.reference for v in variables.values()},
            parameters={n: kinds[variables[n].kind](v) for n, v in parameters.items()},
            commands=[(round(at / step), name, value)],
            looks=[round(steps * (i + 1) / LOOKS) for i in range(LOOKS)],
            outputs=[v.name for v in variables.values() if v.causality == "output"],
        )


CAPTURE = Case(
    title="net capture",
    scene="table1-capture",
    phase="capture",
    changes={"net.mesh": 2.0, "closing.trigger": 3},
    length=16.0,
    steps={"binary": 0.25, "decimal": 0.2},
    command=(11.0, "close.command", True),
    moved="bullets.speed",
    figures=("outcome", "captured", "t_capture", "mouth.area_max", "mouth.t80", "contact.nodes", "target.position[2]"),
)
REMOVAL = Case(
    title="tethered removal",
    scene="mission",
    phase="removal",
    changes={"start.separation": 13.9},
    length=3640.0,
    steps={"binary": 10.0, "decimal": 9.1},
    command=(1820.0, "thrust.offset", 2.0**-8),
    moved="thrust.level",
    figures=("tether.tug_count", "tether.taut", "tug[1].time", "tug[1].peak", "separation", "altitude"),
)
CASES = {"capture": CAPTURE, "removal": REMOVAL}


def multiples(step: float, steps: int) -> Iterator[tuple[float, float]]:
    """From i h to (i + 1) h: the master's points."""
    for begin, end in itertools.pairwise(i * step for i in range(steps + 1)):
        yield begin, end - begin


def added_up(step: float, steps: int) -> Iterator[tuple[float, float]]:
    """t += h."""
    time = 0.0
    for _ in range(steps):
        yield time, step
        time += step


def added_up_to_the_end(step: float, steps: int) -> Iterator[tuple[float, float]]:
    """t += h, but never beyond the end, so that the last step closes the gap."""
    time, end = 0.0, steps * step
    for _ in range(steps):
        size = min(step, end - time)
        yield time, size
        time += size


def multiples_of_equal_steps(step: float, steps: int) -> Iterator[tuple[float, float]]:
    """From i h, always by h."""
    for i in range(steps):
        yield i * step, step


def by_component(job: Job, points: Points) -> list[Row]:
    """The same run by our own `Component`, over the given points."""
    rows = []
    with Archive(Path(job.fmu)) as archive, Component(archive, "towed") as component:
        component.set({name: float(value) for name, value in job.parameters.items()})
        component.initialise(0.0)
        read = component.reader(job.outputs)
        for i, (time, size) in enumerate(points(job.step, job.steps)):
            component.set({name: float(value) for name, value in job.due(i).items()})
            component.step(time, size)
            if i + 1 in job.looks:
                rows.append(dict(zip(read.names, read().tolist(), strict=True)))
    return rows


def moved(job: Job, case: Case, share: float = 1e-6) -> Job:
    """The job with one parameter moved by a share of itself: it must give other numbers."""
    value = job.parameters[case.moved] * (1.0 + share)
    return replace(job, parameters={**job.parameters, case.moved: value})


def farthest(ours: Sequence[Row], theirs: Sequence[Row], figures: Sequence[str]) -> float:
    """Largest relative difference of these outputs at any look."""
    pairs = [(float(a[name]), float(b[name])) for a, b in zip(ours, theirs, strict=True) for name in figures]
    return max(abs(a - b) / max(abs(a), abs(b), 1.0) for a, b in pairs)


def bits(value: Value) -> str:
    """A number so that two are equal only when all their bits are."""
    return float(value).hex()


def differing(ours: Sequence[Row], theirs: Sequence[Row]) -> list[str]:
    """Names of outputs that differ in any bit at any look."""
    assert len(ours) == len(theirs)
    names: dict[str, None] = {}
    for a, b in zip(ours, theirs, strict=True):
        assert a.keys() == b.keys()
        names |= dict.fromkeys(name for name in a if bits(a[name]) != bits(b[name]))
    return list(names)
