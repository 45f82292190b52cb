"""What gravities have in common that are the same everywhere: one acceleration for all that falls.

Net, bullets and vertex fall. Chaser and target are carried (on a stand, on wires, on air bearings): they take recoil
and contact, and fall only if asked to.
"""

from __future__ import annotations

from typing import Any

from fmu_src.interface import Variable
from fmu_src.net_capture.gravity import Gravity
from fmu_src.net_capture.planes import FX, INVERSE_MASS, P, U, X
from fmu_src.rows import output, state
from orbital.kernel import kernel
from orbital.vectors import dot

TIME, WAY, GAIN, BACK = 0, 1, 4, 7
"""Numbers of a free flight: its time [s], what gravity adds to way [m] and velocity [m/s] in it, and to the velocity in
the half substep before its end [m/s]; three components each."""


def falls(name: str, text: str) -> Variable:
    """Whether a body falls."""
    return Variable(name, "1", "parameter", text, False, kind="Boolean")


ROWS = (
    falls("gravity.on_chaser", "the chaser falls too; otherwise it is carried, and only recoil and tether move it"),
    falls("gravity.on_target", "the target falls too; otherwise it is carried, and only what touches it moves it"),
    output(
        "energy.potential",
        "J",
        "of all that falls, -m g r with r from the frame's origin, at the gravity of the instant",
    ),
    state("gravity_now[#]", "m/s2", "at this instant of the grid", shape=(3,)),
    state("gravity_most", "m/s2", "the largest there is"),
)


@kernel
def kick(p, velocity, pull, falls, h):
    """Kick a body with an acceleration of its own [m/s2], and with gravity if it falls.

    Checked  tests/net_capture/test_ground.py
    """
    for i in range(3):
        velocity[i] += h * pull[i]
        if falls:
            velocity[i] += h * p.gravity_now[i]


@kernel
def kick_chaser(p, place, velocity, pull, h):
    """See `kick`.

    Checked  tests/net_capture/test_ground.py
    """
    kick(p, velocity, pull, p.gravity_on_chaser != 0, h)


@kernel
def kick_target(p, place, velocity, pull, h):
    """See `kick`.

    Checked  tests/net_capture/test_ground.py
    """
    kick(p, velocity, pull, p.gravity_on_target != 0, h)


@kernel
def begin_steady_flight(p, flight, first, steps):
    """g t2/2 and g t of so many substeps under the gravity of now; the leapfrog does the same, exactly.

    Checked  tests/net_capture/test_ground.py
    """
    time = steps * p.solver_substep
    flight[TIME] = time
    for axis in range(3):
        flight[WAY + axis] = 0.5 * time * time * p.gravity_now[axis]
        flight[GAIN + axis] = time * p.gravity_now[axis]
        flight[BACK + axis] = 0.5 * p.solver_substep * p.gravity_now[axis]


@kernel
def stray(p, distance, speed, time):
    """What falls leaves the straight line by at most g t2/2 [m].

    Checked  tests/net_capture/test_ground.py
    """
    return 0.5 * p.gravity_most * time * time


@kernel
def stray_apart(p, distance, speed, time):
    """Two nodes fall alike, so the way between them stays straight [m]."""
    return 0.0


@kernel
def accelerate(p, out, position, velocity):
    """out = gravity [m/s2].

    Checked  tests/net_capture/test_ground.py
    """
    for i in range(3):
        out[i] = p.gravity_now[i]


@kernel
def potential(p, position):
    """-g r [J/kg].

    Checked  tests/net_capture/test_ground.py
    """
    return -dot(p.gravity_now, position)


@kernel
def chaser_potential(p):
    """That of the chaser [J], if it falls.

    Checked  tests/net_capture/test_ground.py
    """
    return p.chaser_mass * potential(p, p.chaser_place) if p.gravity_on_chaser != 0 else 0.0


@kernel
def target_potential(p):
    """That of the target [J], if it falls.

    Checked  tests/net_capture/test_ground.py
    """
    return p.target_mass * potential(p, p.target_place) if p.gravity_on_target != 0 else 0.0


def make_falling(composition: Any, start: Any, renew: Any, begin_flight: Any, watch: Any, given: Any) -> Gravity:
    """Kernels for lanes of the composition's precision, of a gravity that keeps `gravity_now` and `gravity_most`."""
    lanes = composition.lanes
    load, store, splat = lanes.load, lanes.store, lanes.splat

    @kernel
    def kick_group(p, reals, i, slots, h, n):
        """v(t + h/2) = v(t - h/2) + dv,   v(t + h) predicted as v(t + h/2) + dv/2,   dv = h (F/m + g), and drift.

        Source   leapfrog; the prediction is the straight line through the last two velocities
        Checked  tests/net_capture/test_ground.py
        """
        step = splat(h)
        half = splat(0.5)
        zero = splat(0.0)
        light = load(reals, i + INVERSE_MASS * slots)
        for axis in range(3):
            at = i + axis * slots
            change = step * (load(reals, at + FX * slots) * light + splat(p.gravity_now[axis]))
            velocity = load(reals, at + U * slots) + change
            store(reals, at + U * slots, velocity)
            store(reals, at + P * slots, velocity + half * change)
            store(reals, at + FX * slots, zero)
            store(reals, at + X * slots, load(reals, at + X * slots) + step * velocity)

    @kernel
    def coast_group(p, reals, i, slots, h, n):
        """v(t) = v(t - h/2) + h/2 g.

        Checked  tests/net_capture/test_ground.py
        """
        for axis in range(3):
            at = i + axis * slots
            store(reals, at + P * slots, load(reals, at + U * slots) + splat(0.5 * h * p.gravity_now[axis]))

    @kernel
    def fly_group(reals, i, slots, flight, place, rate, back):
        """x + v t + way, v + gain, and the velocity half a substep before.

        Checked  tests/net_capture/test_ground.py
        """
        time = splat(flight[TIME])
        for axis in range(3):
            at = i + axis * slots
            velocity = load(reals, at + P * slots)
            moved = load(reals, at + X * slots) + (time * velocity + splat(flight[WAY + axis]))
            after = velocity + splat(flight[GAIN + axis])
            store(reals, at + place * slots, moved)
            store(reals, at + rate * slots, after)
            store(reals, at + back * slots, after - splat(flight[BACK + axis]))

    return Gravity(
        bends=True,
        start=start,
        renew=renew,
        kick_chaser=kick_chaser,
        kick_target=kick_target,
        kick_group=kick_group,
        coast_group=coast_group,
        begin_flight=begin_flight,
        fly_group=fly_group,
        stray=stray,
        stray_apart=stray_apart,
        accelerate=accelerate,
        potential=potential,
        chaser_potential=chaser_potential,
        target_potential=target_potential,
        watch=watch,
        given=given,
    )
