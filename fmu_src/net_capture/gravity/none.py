"""No gravity: what nothing pulls flies straight on."""

from __future__ import annotations

from typing import Any

from fmu_src.interface import Term
from fmu_src.net_capture.gravity import Gravity
from fmu_src.net_capture.planes import FX, INVERSE_MASS, P, U, X
from orbital.kernel import kernel


@kernel
def start(p):
    """Nothing to do."""


@kernel
def rate(p):
    """The frame does not turn."""
    return 0.0


@kernel
def kick_body(p, place, velocity, pull, h):
    """Kick a body that feels nothing but an acceleration of its own [m/s2].

    Checked  tests/net_capture/test_threads.py
    """
    for i in range(3):
        velocity[i] += h * pull[i]


@kernel
def begin_flight(p, flight, first, steps):
    """The time alone counts [s].

    Checked  tests/net_capture/test_sleep.py
    """
    flight[0] = steps * p.solver_substep


@kernel
def stray(p, distance, speed, time):
    """A free flight is straight [m]."""
    return 0.0


@kernel
def accelerate(p, out, position, velocity):
    """Nothing accelerates a free node.

    Checked  tests/net_capture/test_threads.py
    """
    for i in range(3):
        out[i] = 0.0


@kernel
def potential(p, position):
    """There is none [J/kg]."""
    return 0.0


@kernel
def body_potential(p):
    """There is none [J]."""
    return 0.0


def make(composition: Any) -> Gravity:
    """Kernels for lanes of the composition's precision."""
    lanes = composition.lanes
    load, store, splat = lanes.load, lanes.store, lanes.splat

    @kernel
    def kick_group(p, reals, i, slots, h, n):
        """v(t + h/2) = v(t - h/2) + dv,   v(t + h) predicted as v(t + h/2) + dv/2,   dv = h F/m,
        and h dv to the positions, which have drifted by h v(t - h/2) already.

        Source   leapfrog; the prediction is the straight line through the last two velocities
        Checked  tests/net_capture/test_threads.py
        """
        step = splat(h)
        half = splat(0.5)
        zero = splat(0.0)
        light = step * load(reals, i + INVERSE_MASS * slots)
        for axis in range(3):
            at = i + axis * slots
            change = load(reals, at + FX * slots) * light
            velocity = load(reals, at + U * slots) + change
            store(reals, at + U * slots, velocity)
            store(reals, at + P * slots, velocity + half * change)
            store(reals, at + FX * slots, zero)
            store(reals, at + X * slots, load(reals, at + X * slots) + step * change)

    @kernel
    def coast_group(p, reals, i, slots, h, n):
        """Free nodes keep their velocity.

        Checked  tests/net_capture/test_sleep.py
        """
        for axis in range(3):
            at = i + axis * slots
            store(reals, at + P * slots, load(reals, at + U * slots))

    @kernel
    def fly_group(reals, i, slots, flight, place, rate, back):
        """Straight on; velocities stay, so they are copied only where they are not there already.

        Checked  tests/net_capture/test_sleep.py
        """
        time = splat(flight[0])
        for axis in range(3):
            at = i + axis * slots
            velocity = load(reals, at + U * slots)
            store(reals, at + place * slots, load(reals, at + X * slots) + time * velocity)
            if place != X:
                store(reals, at + rate * slots, velocity)
                store(reals, at + back * slots, velocity)

    return Gravity(
        False,
        start,
        None,
        rate,
        kick_body,
        kick_body,
        kick_group,
        coast_group,
        begin_flight,
        fly_group,
        stray,
        stray,
        accelerate,
        potential,
        body_potential,
        body_potential,
    )


PART = Term("inertial drift", make=make)
