"""How far a step of a pair of which a body turns may go, and how large its errors are."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

from fmu_src.tethered_deorbit.bodies.rigid import Rigid
from fmu_src.tethered_deorbit.layout import ATTITUDE, PAIR
from orbital.kernel import kernel
from orbital.vectors import Array, dot, norm, unit

WIDEST = 1.0
"""By how much a body may turn in a step [rad]."""
ACROSS, DAMPED_ACROSS = (0.25, 0.0), (10.0, 1.0)
"""By how much velocities across a taut line may be off, as shares of the rate of the body that turns fastest, in
tolerances of the separation: of a straight line and of one that wraps, without damping and well damped. At 1 an
undamped pair without a field lost 1.4e-11 of its energy in two tugs, at a quarter 5e-12; a box that slips off its line
undamped kept its energy to 1.4e-9 J at a quarter. What a dashpot takes drowns such losses; at 10 in place of 1 the tugs
of a damped target at 5 deg/s come out twice as far off, with a quarter fewer steps."""
WELL_DAMPED = 0.05
"""Damping ratio from which on it is."""


class Bounds(NamedTuple):
    """Kernels of the same names as in `Bodies`; and turning(state) -> rate, at most of a line as the target sees it."""

    longest: Callable[..., Any]
    turning: Callable[..., Any]
    squared_error: Callable[..., Any]
    pace: Callable[..., Any]
    square_across: Callable[..., Any]
    moved_mass: Callable[..., Any]


def make_bounds(target: Rigid, chaser: Rigid, straight: bool, followed: float, bodies: int) -> Bounds:
    """The kernels for two bodies.

    straight      whether the line never wraps
    followed      by how much body and line may turn for its way to be followed [rad]
    bodies        how many of them turn

    Checked  tests/tethered_deorbit/test_rigid.py, test_wrapping.py
    """
    undamped, damped = (shares[0 if straight else 1] for shares in (ACROSS, DAMPED_ACROSS))

    @kernel
    def fastest(state: Array) -> float:
        """Rate of the body that turns fastest [rad/s].

        Checked  tests/tethered_deorbit/test_rigid.py
        """
        rate = 0.0
        for k in range(bodies):
            first = PAIR + ATTITUDE * k + 4
            rate = max(rate, norm(state[first : first + 3]))
        return rate

    @kernel
    def turning(state: Array) -> float:
        """How fast the line turns as the target sees it, at most [rad/s]: to first order in arms over its length.

        Checked  tests/tethered_deorbit/test_wrapping.py
        """
        apart, rate = norm(state[6:9]), norm(state[PAIR + 4 : PAIR + 7])
        return rate + norm(state[9:12]) / apart if apart > 0.0 else rate

    @kernel
    def longest(record: Any, state: Array) -> float:
        """Longest step [s]: over which no body turns by more than the series of `evenly_turned` bear, and body and line
        not by more than lets its way be followed.

        Checked  tests/tethered_deorbit/test_rigid.py, test_wrapping.py
        """
        rate, turns = fastest(state), turning(state)
        step = WIDEST / rate if rate > 0.0 else math.inf
        return min(step, followed / turns) if turns > 0.0 else step

    @kernel
    def squared_error(record: Any, state: Array, error: Array) -> float:
        """Square of the size of the errors of the attitudes [-].

        Checked  tests/tethered_deorbit/test_rigid.py
        """
        return float(target.squared_error(record, state, error) + chaser.squared_error(record, state, error))

    @kernel
    def drowned(record: Any) -> float:
        """How far what is lost of a vibration drowns in what its dashpot takes, 0 to 1 [-].

        Checked  tests/tethered_deorbit/test_rigid.py: the steps of a target that tumbles
        """
        r = record[0]
        damping = abs(r.state_damping) / (2.0 * r.state_effective_mass * r.state_frequency)
        return float(min(1.0, damping / WELL_DAMPED))

    @kernel
    def pace(record: Any, state: Array) -> float:
        """The environment's pace, or a share of the rate of the body that turns fastest, up to the line's [rad/s]: what
        moves across the line goes round with it.

        Checked  tests/tethered_deorbit/test_rigid.py: three tugs, and the steps of a target that tumbles
        """
        r = record[0]
        share = undamped + (damped - undamped) * drowned(record)
        return float(max(r.state_pace, min(r.state_frequency, share * fastest(state))))

    @kernel
    def square_across(record: Any, state: Array, error: Array, along: float) -> float:
        """Square of the error of the velocity across a taut line [m2/s2], without what is the line's own vibration.

            e'_x = e' - e'_n (n + s (M n/(n.M n) - n)),   M n = n/m_r + A ((I^-1 (a x n)) x a) of either body,
            s = zeta/0.05, at most 1

        A line made fast beside the centre of mass moves its end aside as it vibrates, by M n. That part of an error is
        judged by the stretch's tolerance, and dies with the vibration.

        along         e'_n   part of the error along the line    [m/s]

        Valid    after `derivative` of this state
        Source   impulse on a free rigid body
        Checked  tests/tethered_deorbit/test_across.py
        """
        r = record[0]
        share = drowned(record)
        if share == 0.0:
            return dot(error[9:12], error[9:12]) - along * along
        way, gives = r.state_line[2], r.state_line[3]
        unit(way, state[6:9])
        for i in range(3):
            gives[i] = way[i] / r.state_reduced_mass
        target.give(record, way, gives)
        chaser.give(record, way, gives)
        eased, square = dot(gives, way), 0.0
        for i in range(3):
            aside = error[9 + i] - along * (way[i] + share * (gives[i] / eased - way[i]))
            square += aside * aside
        return square

    @kernel
    def moved_mass(record: Any, state: Array) -> float:
        """Mass that the line has to move along its direction [kg]; after `seen`.

            1/m = 1/m_r + (a x n).I^-1 (a x n), of either body

        Source   impulse on a free rigid body
        Checked  tests/tethered_deorbit/test_rigid.py: an off-centre snap
        """
        r = record[0]
        vector = r.state_line[0]
        if not norm(vector) > 0.0:
            return float(r.state_effective_mass)
        return float(1.0 / (1.0 / r.state_reduced_mass + target.ease(record, vector) + chaser.ease(record, vector)))

    return Bounds(longest, turning, squared_error, pace, square_across, moved_mass)
