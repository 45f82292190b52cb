"""No gravity: what nothing pulls flies straight on."""

from __future__ import annotations

from typing import Any

from fmu_src.interface import Term
from fmu_src.net_capture.gravity import Gravity
from fmu_src.net_capture.planes import FX, INVERSE_MASS, P, U, X
from orbital.kernel import kernel


@kernel
def begin_flight(p, flight, first, steps):
    """The time alone counts [s].

    Checked  tests/net_capture/test_sleep.py
    """
    flight[0] = steps * p.solver_substep


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

    return Gravity(kick_group=kick_group, coast_group=coast_group, begin_flight=begin_flight, fly_group=fly_group)


PART = Term("inertial drift", make=make)
