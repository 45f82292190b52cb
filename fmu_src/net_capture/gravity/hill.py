"""Gravity seen in the orbital frame of the target's initial centre of mass: Hill's equations."""

from __future__ import annotations

from typing import Any

from fmu_src.extremes import Extreme
from fmu_src.interface import Term
from fmu_src.net_capture.gravity import Gravity
from fmu_src.net_capture.planes import FX, INVERSE_MASS, P, U
from fmu_src.rows import output, parameter, state
from orbital.constants import EARTH_EQUATORIAL_RADIUS, EARTH_MU
from orbital.hill import hill_acceleration, hill_bend, hill_coefficients, hill_jacobi
from orbital.kernel import kernel
from orbital.twobody import mean_motion

FLIGHT, RATE, HALF = 8, 8, 9
"""Numbers of `hill_coefficients`; behind them the frame's rate and half a substep."""


@kernel
def start(p):
    """Mean motion of the target's orbit [rad/s].

    Checked  tests/net_capture/test_free_flight.py
    """
    p.mean_motion = mean_motion(EARTH_EQUATORIAL_RADIUS + p.orbit_altitude, EARTH_MU)


@kernel
def rate(p):
    """Mean motion of the target's orbit [rad/s].

    Checked  tests/net_capture/test_free_flight.py
    """
    return p.mean_motion


@kernel
def gradient(p):
    """3 mu/r^3 of the target's orbit [1/s2].

    Checked  tests/net_capture/test_gradient.py
    """
    return 3.0 * p.mean_motion * p.mean_motion


@kernel
def kick_body(p, place, velocity, pull, h):
    """Kick a body that feels gravity and an acceleration of its own [m/s2], as `kick_group` does.

    Checked  tests/net_capture/test_free_flight.py
    """
    n = p.mean_motion
    c = n * h
    a = velocity[0] + c * velocity[1] + h * (pull[0] + 3.0 * n * n * place[0])
    b = velocity[1] - c * velocity[0] + h * pull[1]
    velocity[0] = (a + c * b) / (1.0 + c * c)
    velocity[1] = (b - c * a) / (1.0 + c * c)
    velocity[2] += h * (pull[2] - n * n * place[2])


@kernel
def begin_flight(p, flight, first, steps):
    """Coefficients of Hill's free flight over so many substeps, the frame's rate and half a substep.

    Checked  tests/net_capture/test_sleep.py
    """
    hill_coefficients(flight, p.mean_motion, steps * p.solver_substep)
    flight[RATE] = p.mean_motion
    flight[HALF] = 0.5 * p.solver_substep


@kernel
def stray(p, distance, speed, time):
    """Bound of how far a free flight leaves the straight line [m], see `hill_bend`.

    Checked  tests/net_capture/test_sleep.py
    """
    return hill_bend(distance, speed, p.mean_motion, time)


@kernel
def accelerate(p, out, position, velocity):
    """out = acceleration of a free node in the frame [m/s2].

    Checked  tests/net_capture/test_free_flight.py
    """
    hill_acceleration(out, position, velocity, p.mean_motion)


@kernel
def potential(p, position):
    """Potential energy per mass [J/kg] at a place in the orbital frame, that of the Jacobi integral.

    Checked  tests/net_capture/test_energy_book.py
    """
    rest = p.scratch[0:3]
    for i in range(3):
        rest[i] = 0.0
    return hill_jacobi(position, rest, p.mean_motion)


@kernel
def chaser_potential(p):
    """Potential energy [J] of the chaser.

    Checked  tests/net_capture/test_energy_book.py
    """
    return p.chaser_mass * potential(p, p.chaser_place)


@kernel
def target_potential(p):
    """Potential energy [J] of the target, less the frame's rate times its spin about the orbit normal: a body that
    turns has a Jacobi integral of its own.

    Checked  tests/net_capture/test_energy_book.py
    """
    return p.target_mass * potential(p, p.target_place) - p.mean_motion * p.target_spin[2]


def make(composition: Any) -> Gravity:
    """Kernels for lanes of the composition's precision."""
    lanes = composition.lanes
    load, store, splat = lanes.load, lanes.store, lanes.splat

    @kernel
    def kick_group(p, reals, i, slots, h, n):
        """Velocities half a substep on under forces and Hill's equations, and those predicted for the next instant.

            du/dt = F_x/m + 3 n^2 x + 2 n v,   dv/dt = F_y/m - 2 n u,   dw/dt = F_z/m - n^2 z

        The Coriolis acceleration takes the mean of the velocities before and after, which is solved for: it turns the
        velocity and does no work.

        Valid    distances small against the orbital radius, circular orbit
        Source   Hill 1878; Clohessy and Wiltshire 1960; the mean velocity as in Boris' pusher of charged particles
                 (1970)
        Checked  tests/net_capture/test_contact.py, tests/net_capture/test_free_flight.py
        """
        step = splat(h)
        half = splat(0.5)
        zero = splat(0.0)
        turn = splat(n * h)
        share = splat(1.0 / (1.0 + n * n * h * h))
        square = splat(n * n)
        light = load(reals, i + INVERSE_MASS * slots)
        x = load(reals, i)
        y = load(reals, i + slots)
        z = load(reals, i + 2 * slots)
        u = load(reals, i + U * slots)
        v = load(reals, i + (U + 1) * slots)
        w = load(reals, i + (U + 2) * slots)
        a = u + turn * v + step * (load(reals, i + FX * slots) * light + splat(3.0) * square * x)
        b = v - turn * u + step * (load(reals, i + (FX + 1) * slots) * light)
        du = share * (a + turn * b) - u
        dv = share * (b - turn * a) - v
        dw = step * (load(reals, i + (FX + 2) * slots) * light - square * z)
        u = u + du
        v = v + dv
        w = w + dw
        store(reals, i + U * slots, u)
        store(reals, i + (U + 1) * slots, v)
        store(reals, i + (U + 2) * slots, w)
        store(reals, i + P * slots, u + half * du)
        store(reals, i + (P + 1) * slots, v + half * dv)
        store(reals, i + (P + 2) * slots, w + half * dw)
        for axis in range(3):
            store(reals, i + (FX + axis) * slots, zero)
        store(reals, i, x + step * u)
        store(reals, i + slots, y + step * v)
        store(reals, i + 2 * slots, z + step * w)

    @kernel
    def coast_group(p, reals, i, slots, h, n):
        """v(t) = v(t - h/2) + h/2 a, of Hill's equations; the error of the Coriolis term is (n h)^2 of the velocity.

        Checked  tests/net_capture/test_sleep.py
        """
        half = splat(0.5 * h)
        twice = splat(2.0 * n)
        square = splat(n * n)
        u = load(reals, i + U * slots)
        v = load(reals, i + (U + 1) * slots)
        w = load(reals, i + (U + 2) * slots)
        store(reals, i + P * slots, u + half * (splat(3.0) * square * load(reals, i) + twice * v))
        store(reals, i + (P + 1) * slots, v - half * (twice * u))
        store(reals, i + (P + 2) * slots, w - half * (square * load(reals, i + 2 * slots)))

    @kernel
    def fly_group(reals, i, slots, flight, place, rate, back):
        """Exact free flight, as `orbital.hill.hill_flown`, and the velocity half a substep back from where it ends.

        Checked  tests/net_capture/test_sleep.py
        """
        x = load(reals, i)
        y = load(reals, i + slots)
        z = load(reals, i + 2 * slots)
        u = load(reals, i + P * slots)
        v = load(reals, i + (P + 1) * slots)
        w = load(reals, i + (P + 2) * slots)
        versine = splat(flight[0])
        sine = splat(flight[1])
        bend = splat(2.0 * flight[2])
        twice = splat(2.0 * flight[7])
        xx = x + (splat(3.0) * versine * x + sine * u + bend * v)
        yy = y + (splat(flight[4]) * v - splat(6.0 * flight[3]) * x - bend * u)
        zz = z + (sine * w - versine * z)
        uu = u + (splat(3.0 * flight[5]) * x - versine * u + twice * v)
        vv = v - (splat(6.0 * flight[6]) * x + twice * u + splat(4.0) * versine * v)
        ww = w - (splat(flight[5]) * z + versine * w)
        store(reals, i + place * slots, xx)
        store(reals, i + (place + 1) * slots, yy)
        store(reals, i + (place + 2) * slots, zz)
        store(reals, i + rate * slots, uu)
        store(reals, i + (rate + 1) * slots, vv)
        store(reals, i + (rate + 2) * slots, ww)
        half = splat(flight[HALF])
        turn = splat(2.0 * flight[RATE])
        square = splat(flight[RATE] * flight[RATE])
        store(reals, i + back * slots, uu - half * (splat(3.0) * square * xx + turn * vv))
        store(reals, i + (back + 1) * slots, vv + half * (turn * uu))
        store(reals, i + (back + 2) * slots, ww + half * (square * zz))

    return Gravity(
        bends=True,
        start=start,
        rate=rate,
        kick_chaser=kick_body,
        kick_target=kick_body,
        kick_group=kick_group,
        coast_group=coast_group,
        begin_flight=begin_flight,
        fly_group=fly_group,
        stray=stray,
        stray_apart=stray,
        accelerate=accelerate,
        potential=potential,
        chaser_potential=chaser_potential,
        target_potential=target_potential,
        gradient=gradient,
    )


PART = Term(
    "relative motion about the target's circular orbit",
    (
        parameter(
            "orbit.altitude",
            "m",
            "of the circular orbit, over the equatorial radius",
            800e3,
            100e3,
            1e8,
            display_unit="km",
        ),
        output(
            "energy.potential",
            "J",
            "of all bodies in the orbital frame: m n2 (z2 - 3 x2) / 2, less n times the target's spin about the "
            "orbit normal; with the kinetic energies it makes the Jacobi integral",
        ),
        state("mean_motion", "rad/s", "of the orbital frame"),
    ),
    make=make,
    extremes=tuple(
        Extreme(
            f"orbit at {altitude / 1e3:g} km",
            "the rate at which the frame turns, at its ends",
            "energy_gained",
            {"orbit.altitude": altitude},
        )
        for altitude in (100e3, 1e8)
    ),
)
