"""Bullets by simulation: how wide a net opens, and for how long, with lighter and heavier ones, beside the paper's rule
of 6:1.

A coarse net flies without a target. A shot is the same for any net of the same shape in its own measure (lengths in the
side, times in side over speed), so the ratio of the masses is what counts.

Checked  tests/sizing/test_bullets.py
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from dcone_cosim.cases.alone import Fmus
from dcone_cosim.cases.case import Case, digest, key_of
from dcone_cosim.cases.runner import Runner
from dcone_cosim.errors import InputError
from dcone_cosim.loading import load
from dcone_cosim.progress import Progress

SCENE = "deployment"
COARSE = ("capture.net.mesh=3 m", "capture.duration=20 s", "capture.macro_step=0.05 s")
"""Settings of the flight: a coarse net opens as a fine one does, within 1 %."""
RATIOS = (1.0, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0)
ENOUGH = 0.9
"""Share of the net's area that a mouth has to reach, a third more than a target needs [1]."""


@dataclass(frozen=True)
class Opening:
    """One flight: bullets over net [1], largest mouth over the net's area [1], when [s]; above 80 % since [s]."""

    ratio: float
    opening: float
    when: float
    since: float


def flights(runner: Runner, progress: Progress, ratios: Sequence[float] = RATIOS) -> list[Opening]:
    """Fly the net with each ratio."""
    base = load(SCENE, COARSE).phases[0]
    net = base.setting("net.mass")
    assert net is not None
    fmus = Fmus(progress)
    cases = []
    for ratio in ratios:
        scene = load(SCENE, [*COARSE, f"capture.bullets.mass={ratio * net / 4.0:.9g} kg"])
        cases.append(Case(digest(key_of(scene, fmus.of(scene), None), "opening"), scene))
    rows = {}
    for row, _ in runner.rows(cases):
        if not row.succeeded:
            raise InputError(f"the net of {SCENE} does not fly: {row.message}")
        rows[row.key] = row
        progress.count("runs", len(rows), len(cases), f"bullets: {len(rows)} of {len(cases)}")
    area = net_area()
    found = []
    for ratio, case in zip(ratios, cases, strict=True):
        figures = rows[case.key].figures
        largest = float(figures["capture.mouth.area_max"]) / area
        when = figures.get("capture.mouth.t_max", float("nan"))
        since = figures.get("capture.mouth.t80", float("nan"))
        found.append(Opening(ratio, largest, _number(when), _number(since)))
    return found


def net_area() -> float:
    """Area [m2] of the net that flies."""
    side = load(SCENE, COARSE).phases[0].setting("net.side")
    assert side is not None
    return side * side


def _number(value: object) -> float:
    return float(value) if isinstance(value, int | float) else float("nan")


def least(points: Sequence[Opening]) -> float | None:
    """The least ratio with which the mouth reaches `ENOUGH` of the net's area, between those flown; None if none
    does."""
    for before, after in pairwise(points):
        if before.opening < ENOUGH <= after.opening:
            share = (ENOUGH - before.opening) / (after.opening - before.opening)
            return before.ratio + share * (after.ratio - before.ratio)
    return points[0].ratio if points and points[0].opening >= ENOUGH else None
