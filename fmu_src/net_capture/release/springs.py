"""Bullets pushed out by a spring each.

    (m + m_p) v2 / 2 = k s2 / 2 + F0 s - F s

k, s, F0   stiffness, stroke, and force that is left at its end    [N/m], [m], [N]
F          friction                                                [N]
m, m_p     of the bullet, and of what moves with it and stops at the end of the stroke [kg]

Valid    a chaser heavy against the bullets, a spring light against them
Source   work and energy
Checked  tests/net_capture/test_ejectors.py
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import NamedTuple

from fmu_src.implied import Implied
from fmu_src.interface import Undesigned
from fmu_src.rows import at_least_zero, positive

Values = Mapping[str, float]

ROWS = (
    positive("ejector.stiffness", "N/m", "of the spring behind each bullet", 2000.0),
    positive("ejector.stroke", "m", "over which it pushes", 0.05),
    at_least_zero("ejector.rest_force", "N", "with which it still pushes at the end of the stroke", 0.0),
    at_least_zero("ejector.friction", "N", "on each bullet in its guide", 0.0),
    at_least_zero("ejector.plunger", "kg", "mass that moves with each bullet, and stops at the end of the stroke", 0.0),
    at_least_zero("ejector.most_impulse", "N.s", "that one bullet's mount may bear; zero: any", 0.0),
)


class Push(NamedTuple):
    """A bullet's speed [m/s], its impulse [N s], the largest force [N]."""

    speed: float
    impulse: float
    force: float


def push(values: Values) -> Push:
    """What a spring does to its bullet; `Undesigned` where it does not come out, or the mount bears too much.

    Checked  tests/net_capture/test_ejectors.py
    """
    stiffness, stroke, rest = (values[f"ejector.{key}"] for key in ("stiffness", "stroke", "rest_force"))
    friction, mass = values["ejector.friction"], values["bullets.mass"]
    work = 0.5 * stiffness * stroke * stroke + (rest - friction) * stroke
    if work <= 0.0:
        raise Undesigned("ejector.friction", f"{friction:g} N", "must be less: the bullet does not come out")
    speed = math.sqrt(2.0 * work / (mass + values["ejector.plunger"]))
    most = values["ejector.most_impulse"]
    if 0.0 < most < mass * speed:
        raise Undesigned(
            "ejector.most_impulse", f"{most:g} N s", f"must be at least {mass * speed:.4g} N s, that of this spring"
        )
    return Push(speed, mass * speed, stiffness * stroke + rest)


def rows(values: Values) -> Iterator[Implied]:
    """For people and machines."""
    found = push(values)
    yield Implied("ejector.speed", "speed that the springs give a bullet", found.speed, "m/s")
    yield Implied("ejector.impulse", "impulse of a bullet", found.impulse, "N.s")
    yield Implied("ejector.force", "largest force of a spring", found.force, "N")
