"""Where a tow is admissible: how fast the debris may turn, how far from its middle the line may pull, how hard to
thrust.

Each point of the grid is a tow of a debris that turns; admissible is one whose tension stays within the strength of the
scene's line over the factor of safety, and of whose line no more comes to lie on the debris than goes half way round
it. A scene whose target is a point says nothing of its shape: then it is a box, of the capture's target, or of Table
1's.

Checked  tests/sizing/test_region.py
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from dcone_cosim.errors import InputError
from dcone_cosim.level import GROUP, with_term
from dcone_cosim.scene.data import Scene
from dcone_cosim.sizing.ground import LENGTH, SEPARATION, Ground, why

BOX = "box"
SURFACES = ("box", "cylinder", "hull")
TABLE_1 = (4.0, 8.0, 4.0)
"""Size of the paper's debris [m], Table 1."""
RATES = (0.0, 0.5, 1.0, 2.0, 5.0)
"""Tumble rates [deg/s]."""
OFFSETS = (0.0, 0.25, 0.5, 1.0)
"""Of the attachment from the middle of the face, over half the face's width [1]."""
THRUSTS = (1.0, 10.0)
"""Over the scene's thrust [1]."""
QUICK_GRID = ((0.0, 1.0, 5.0), (0.0, 0.5), (1.0,))
TOUCH = 1e-3
"""Slack that a start whose line reaches aside has beside the scene's own [m]."""
LASTS = 3600.0
"""How long each tow lasts [s]."""


@dataclass(frozen=True)
class Point:
    """One tow of the grid.

    rate [rad/s], offset [m], thrust [N]; peak [N]; wrapped   of the line on the debris at most [m]
    verdict    "admissible", or what is wrong
    """

    rate: float
    offset: float
    thrust: float
    peak: float
    wrapped: float
    verdict: str


@dataclass(frozen=True)
class Region:
    """All of them, of what debris, and how much of the line goes half way round it [m]."""

    points: Sequence[Point]
    body: str
    half_round: float


def region(ground: Ground, breaking: float, safety: float, quick: bool) -> Region:
    """Run the grid.

    breaking    load at which the scene's line breaks [N]
    """
    rates, offsets, thrusts = QUICK_GRID if quick else (RATES, OFFSETS, THRUSTS)
    base, body = _turning(ground)
    main = base.phases[0].main
    values = {**main.defaults, **main.parameters}
    far = tuple(values[f"target.attachment[{i}]"] for i in (1, 2, 3))
    half = _half_width(values)
    level = values.get("thrust.level", 0.0)
    plan = [(math.radians(r), o * half, t * level) for t in thrusts for o in offsets for r in rates]
    cases = []
    for rate, offset, thrust in plan:
        changed = {
            "target.start_rate[1]": 0.0,
            "target.start_rate[2]": 0.0,
            "target.start_rate[3]": rate,
            "target.attachment[1]": far[0] + offset,
            "thrust.level": thrust,
        }
        if SEPARATION in values and not ground.handed_over:  # the line reaches aside: no start is stretched for that
            aside = math.hypot(values[LENGTH], offset) - values[LENGTH]
            changed[SEPARATION] = values[SEPARATION] - aside - TOUCH * bool(offset)
        own = replace(main, parameters={**main.parameters, **changed})
        phase = base.phases[0]
        phase = replace(phase, main=own, duration=min(phase.duration, LASTS), macro_step=min(phase.macro_step, 60.0))
        cases.append(ground.case_of(replace(base, phases=(phase,))))
    runs = list(ground.run(cases, "admissible region"))
    allowed, half_round = breaking / safety, _half_round(values)
    points = []
    for (rate, offset, thrust), run in zip(plan, runs, strict=True):
        if math.isnan(run.peak):
            points.append(Point(rate, offset, thrust, math.nan, math.nan, why(run.row)))
            continue
        most = run.loads["extremes"].get("tether.wrapped", [0.0, 0.0, 0.0])[2]
        points.append(Point(rate, offset, thrust, run.peak, most, _verdict(run.peak, allowed, most, half_round)))
    return Region(points, body, half_round)


def _verdict(peak: float, allowed: float, wrapped: float, half_round: float) -> str:
    wrong = []
    if peak > allowed:
        wrong.append("too hard")
    if wrapped > half_round:
        wrong.append("wraps")
    return " and ".join(wrong) or "admissible"


def _half_width(values: Mapping[str, float]) -> float:
    if "target.size[1]" in values:
        return 0.5 * values["target.size[1]"]
    return values.get("target.cylinder_radius", 0.5 * TABLE_1[0])


def _half_round(values: Mapping[str, float]) -> float:
    """Half of the way round the debris across its third axis, about which it turns [m]."""
    if "target.size[1]" in values:
        return values["target.size[1]"] + values["target.size[2]"]
    if "target.cylinder_radius" in values:
        return 2.0 * values["target.cylinder_radius"] + values["target.cylinder_length"]
    return TABLE_1[0] + TABLE_1[1]


def _turning(ground: Ground) -> tuple[Scene, str]:
    """The tow with a debris that turns, and what it is."""
    main = ground.phase.main
    if main.terms.get(GROUP) in SURFACES:
        return ground.scene, f"the scene's {main.terms[GROUP]}"
    if GROUP not in main.terms:
        raise InputError("the tow has no target body to turn")
    size, whose = _size(ground)
    mass = ground.values["target.mass"]
    a, b, c = size
    moments = (mass * (b * b + c * c) / 12.0, mass * (a * a + c * c) / 12.0, mass * (a * a + b * b) / 12.0)
    own = with_term(main, GROUP, BOX)
    kept = {name: value for name, value in main.parameters.items() if name in own.defaults}
    changed: dict[str, Any] = {f"target.size[{i + 1}]": size[i] for i in range(3)}
    changed |= {f"target.inertia[{i + 1}]": moments[i] if i < 3 else 0.0 for i in range(6)}
    changed |= {f"target.attachment[{i + 1}]": (0.0, 0.5 * b * _towards_chaser(ground), 0.0)[i] for i in range(3)}
    changed |= {"target.rate_frame": float(own.choices["target.rate_frame"].index("inertial"))}
    if "start.separation" in own.defaults and not ground.handed_over:
        slack = ground.values["tether.rest_length"] - ground.values["start.separation"]
        changed["start.separation"] = ground.values["tether.rest_length"] + 0.5 * b - slack  # as much slack as before
    own = replace(own, parameters={**kept, **{n: v for n, v in changed.items() if n in own.defaults}})
    phase = replace(ground.phase, main=own)
    text = f"a full box of {a:g} x {b:g} x {c:g} m ({whose}) in place of the point, {mass:.6g} kg"
    return replace(ground.scene, phases=(phase,)), text


def _towards_chaser(ground: Ground) -> float:
    """On which side of the debris the chaser is at the start: -1 behind it, along the track, 1 ahead."""
    values = ground.values
    if ground.handed_over:
        return -math.copysign(1.0, values["start.relative_position[2]"])
    leading = ground.phase.main.choices.get("start.leading", ())
    return 1.0 if leading and leading[int(values["start.leading"])] == "chaser" else -1.0


def _size(ground: Ground) -> tuple[tuple[float, float, float], str]:
    """Size of the debris, and where it is told."""
    for phase in ground.alone.scene.phases:
        values = {**phase.main.defaults, **phase.main.parameters}
        if phase.name != ground.name and all(f"target.size[{i}]" in values for i in (1, 2, 3)):
            return (values["target.size[1]"], values["target.size[2]"], values["target.size[3]"]), f"{phase.name}'s"
    return TABLE_1, "that of the paper's Table 1, as the scene tells none"
