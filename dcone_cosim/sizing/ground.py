"""The tow of a scene by itself, as a function of its parameters: what every part of the sizing varies.

A tow that a capture hands over to begins as that left it: the net is shot once for all of them.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from dcone_cosim.cases.alone import Alone, Fmus
from dcone_cosim.cases.case import digest, key_of
from dcone_cosim.cases.rows import Row
from dcone_cosim.cases.runner import Runner
from dcone_cosim.errors import InputError
from dcone_cosim.progress import Progress
from dcone_cosim.scene.data import PhaseScene, Scene
from dcone_cosim.sizing.work import Load
from orbital.constants import EARTH_EQUATORIAL_RADIUS, EARTH_MU
from orbital.materials import section
from orbital.plain import mean_motion

PHASE, CAPTURE = "removal", "capture"
LINE = ("tether.diameter", "tether.youngs_modulus", "tether.rest_length", "tether.damping_ratio")
BREAK, SEPARATION, LENGTH = "break.strength", "start.separation", "tether.rest_length"
Values = Mapping[str, float]


@dataclass(frozen=True)
class Found:
    """What a run found: largest tension [N], the tugs (time [s], peak [N], speed [m/s]), and its row."""

    peak: float
    tugs: Sequence[tuple[float, float, float]]
    row: Row

    @property
    def worst(self) -> tuple[float, float, float] | None:
        """The tug of the largest peak."""
        return max(self.tugs, key=lambda tug: tug[1], default=None)

    def figure(self, name: str) -> float | None:
        value = self.row.figures.get(f"{next(iter(self.row.samples))}.{name}") if self.row.samples else None
        return float(value) if isinstance(value, int | float) else None

    @property
    def loads(self) -> Mapping[str, Any]:
        loads: Mapping[str, Any] = next(iter(self.row.samples.values()))
        return loads


class Ground:
    """The tow as it is, and with other values.

    alone      the scene, its phases each by itself, begun already
    name       of the phase, a tow
    runner     runs its cases; set before the first
    breaks_at  load at which the line breaks in the scene [N], None where it does not
    """

    def __init__(self, alone: Alone, progress: Progress, name: str = PHASE) -> None:
        self.alone, self._progress, self.name = alone, progress, name
        if name not in alone.phases or name == CAPTURE:
            names = ", ".join(alone.phases)
            raise InputError(
                f"{alone.scene.source}: sizing needs a tow, [{name}]; the phases of this scene are {names}"
            )
        self.scene = alone.scene_of(name)
        self.phase: PhaseScene = self.scene.phases[0]
        main = self.phase.main
        if main.fmu is not None:
            raise InputError(f"{alone.scene.source}: sizing varies parameters of our tow; [{name}] names an FMU")
        missing = [name for name in LINE if name not in {**main.defaults, **main.parameters}]
        if missing:
            reel = main.terms.get("reel")
            raise InputError(
                f'{alone.scene.source}: sizing needs a line that stretches; reel law "{reel}" has no {missing[0]}'
            )
        self.values: dict[str, float] = {**main.defaults, **main.parameters}
        self.breaks_at = self.values.get(BREAK)
        self.fmus = Fmus(progress)
        self.runner: Runner | None = None

    @property
    def handed_over(self) -> bool:
        """Whether a phase before it hands over to it."""
        return self.alone.phases[0] != self.name

    def pin(self, values: Values) -> None:
        """Let all of its runs have these values, SI by FMI name."""
        main = self.phase.main
        self.phase = replace(self.phase, main=replace(main, parameters={**main.parameters, **values}))
        self.scene = replace(self.scene, phases=(self.phase,))
        self.values |= values

    def scene_with(
        self, values: Values, terms: Mapping[str, str] | None = None, duration: float | None = None
    ) -> Scene:
        """The tow alone with other parameters, SI by FMI name, other terms, another duration."""
        main = self.phase.main
        main = replace(main, parameters={**main.parameters, **values}, terms={**main.terms, **(terms or {})})
        phase = replace(self.phase, main=main)
        if duration is not None:
            phase = replace(phase, duration=min(duration, phase.duration))
        return replace(self.scene, phases=(phase,))

    def fitted(self, values: Values) -> dict[str, float]:
        """Values with the start no farther from taut than the scene's own is, if that is what they change: a line that
        begins stretched is no start."""
        if self.handed_over or SEPARATION not in self.values:
            return dict(values)
        both = {**self.values, **values}
        beyond = max(0.0, self.values[SEPARATION] - self.values[LENGTH])
        most = both[LENGTH] + beyond
        return {**values, SEPARATION: most} if both[SEPARATION] > most else dict(values)

    def case(self, values: Values | None = None, history: bool = False) -> Load:
        """The case of the tow with these values in the place of its own."""
        return self.case_of(self.scene_with(values or {}), history)

    def case_of(self, scene: Scene, history: bool = False) -> Load:
        key = digest(key_of(scene, self.fmus.of(scene), None), "loads", history)
        return Load(key, scene, history=history)

    def run(self, cases: Iterable[Load], what: str) -> Iterator[Found]:
        """What each case found, in their order; a case that fails is told by `Row.message` and has a peak of NaN."""
        assert self.runner is not None
        wanted = list(cases)
        rows: dict[str, Row] = {}
        total = len({case.key for case in wanted})
        for row, _ in self.runner.rows(wanted):
            rows[row.key] = row
            self._progress.count("runs", len(rows), total, f"{what}: {len(rows)} of {total}")
        return (found(rows[case.key]) for case in wanted)

    def one(self, values: Values | None = None, history: bool = False, what: str = "the scene as it is") -> Found:
        return next(self.run([self.case(values, history)], what))


def why(row: Row) -> str:
    """What a row says of its failure: the last line that is about it, not where it came from."""
    lines = [line.strip() for line in row.message.splitlines() if line.strip()]
    return next((line for line in reversed(lines) if not line.startswith("(")), row.status)


def found(row: Row) -> Found:
    """What a row tells of loads."""
    if not row.samples:
        return Found(float("nan"), (), row)
    (loads,) = row.samples.values()
    return Found(loads["peak"], [(t, p, v) for t, p, v in loads["tugs"]], row)


def stiffness(values: Values) -> float:
    """k = 1/(l/(E A) + C) [N/m] of the line, C of a net in series with it, where there is one."""
    line = values["tether.youngs_modulus"] * section(values["tether.diameter"]) / values["tether.rest_length"]
    return line / (1.0 + line * values.get("net.compliance", 0.0))


def reduced(values: Values) -> float:
    """Reduced mass of the pair [kg]."""
    chaser, target = values["chaser.mass"], values["target.mass"]
    return chaser * target / (chaser + target)


def steady(values: Values) -> float:
    """The tension that thrust and tide keep in the line [N], the larger of the two.

    3 n^2 m_r l   of a pair at rest near the vertical;   |F| m_t/(m_c + m_t)   of one that is pulled along its line
    """
    total = values["chaser.mass"] + values["target.mass"]
    pulled = abs(values.get("thrust.level", 0.0)) * values["target.mass"] / total
    if "orbit.altitude" not in values:
        return pulled
    n = mean_motion(EARTH_EQUATORIAL_RADIUS + values["orbit.altitude"], EARTH_MU)
    length = values["tether.rest_length"] + values.get("target.attachment_distance", 0.0)
    return max(pulled, 3.0 * n**2 * reduced(values) * length)


def preload(values: Values, angle: float, rate: float) -> float:
    """Steady force that keeps the pair apart along its line on a circular orbit [N], of thrust along the track.

        P = m_r l [(phi' + n)^2 - n^2 + 3 n^2 cos^2 phi] - F m_t/(m_c + m_t) sin phi

    angle    phi   of the line from the vertical, towards the track  [rad]
    rate     phi'  in the orbital frame                              [rad/s]

    Source   planar equation of the relative distance, kinematics of a line of constant length
    """
    total = values["chaser.mass"] + values["target.mass"]
    pulled = -values.get("thrust.level", 0.0) * values["target.mass"] / total * math.sin(angle)
    n = mean_motion(EARTH_EQUATORIAL_RADIUS + values["orbit.altitude"], EARTH_MU)
    length = values["tether.rest_length"] + values.get("target.attachment_distance", 0.0)
    return reduced(values) * length * ((rate + n) ** 2 - n**2 + 3.0 * n**2 * math.cos(angle) ** 2) + pulled
