"""In how many bits the nodes' positions and velocities are kept, and when these are too few."""

from __future__ import annotations

import math
from collections.abc import Iterator

from fmu_src.interface import Term
from fmu_src.net_capture.refusal import Refusal, Scene
from fmu_src.net_capture.substeps import substeps

SINGLE_BITS = 24
STEPS_BETWEEN = 24.0
"""Neighbouring numbers that a bullet has to pass in a substep: half of one is lost at most, so 2 % of its way. With 37
the energy book stays within 4 % at a hundred times the stiffness; with 19 and a damping ratio of 10 more is gained than
the shot had."""


def spacing(size: float) -> float:
    """Distance of neighbouring numbers of 24 bits at a size.

        2^(floor(log2 size) - 23)

    Source   IEEE 754, binary32
    """
    return math.ldexp(1.0, math.frexp(size)[1] - SINGLE_BITS)


def refuses(scene: Scene) -> Iterator[Refusal]:
    """Substeps in which a bullet hardly moves to the next number: what it loses there by rounding the velocities do not
    know of, and dashpots and threads turn it into energy (at a damping ratio of 10, five times that of the shot)."""
    values = scene.values
    bound, usual = substeps(values, scene.parts)
    ratio = values["solver.step_ratio"]
    step = ratio * bound if ratio > 0.0 else usual
    apart = spacing(max(math.hypot(*scene.vector("chaser.start_position")), 1e-3))
    way = step * values["bullets.speed"]
    if 0.0 < way < STEPS_BETWEEN * apart:
        least = STEPS_BETWEEN * apart
        expected = (
            f"bullets move {way:.2g} m in a substep of {step:.2g} s; 24-bit numbers lie {apart:.2g} m apart out there, "
            f"and it must be at least {STEPS_BETWEEN:g} of that, {least:.2g} m, or rounding drives the net: take double"
        )
        yield Refusal("solver.precision", "single", expected)


PRECISION = {
    "double": Term("of 53 bits, for positions and velocities of the nodes"),
    "single": Term(
        "of 24 bits, for positions and velocities of the nodes: faster, for campaigns",
        refuses=refuses,
    ),
}
