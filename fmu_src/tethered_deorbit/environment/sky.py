"""Sun and Moon as the pair sees them: where they stand, and what their gravity does to it."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from fmu_src.tethered_deorbit.environment.disturbing import Disturbing
from fmu_src.tethered_deorbit.turning import turn_vectors_back
from orbital.constants import MOON_MU, SUN_MU
from orbital.kernel import kernel
from orbital.sky import moon_place, sun_place
from orbital.twobody import differential_gravity
from orbital.vectors import Array

WINDOW = 3600.0
"""Time over which their places are interpolated [s]: a cubic is then good to 1e-9 of the Moon's distance."""
NODES = 4
NO_WINDOW = -1.0e9


@kernel
def forget_sky(record: Any) -> None:
    """No places are known yet: another epoch has others.

    Checked  tests/tethered_deorbit/test_sky.py: nothing is left of an earlier epoch
    """
    record[0].state_sky_window = NO_WINDOW


@kernel
def between(out: Array, nodes: Array, x: float) -> None:
    """out = vector between the two middle ones of four evenly spaced ones, by the cubic through all.

    nodes         at -1, 0, 1 and 2                              (4, 3)
    x             from the second towards the third              [-]

    Source   Lagrange
    Checked  tests/tethered_deorbit/test_sky.py
    """
    a, b, c = x + 1.0, x - 1.0, x - 2.0
    for i in range(3):
        out[i] = x * (a * b * nodes[3, i] - b * c * nodes[0, i]) / 6.0 + 0.5 * a * c * (
            b * nodes[1, i] - x * nodes[2, i]
        )


def make_point_sky(moon: bool) -> Callable[..., Any]:
    """The kernel `point_sky(record, time, elapsed)`, which writes `state.sun`, and `state.moon` if that is wanted.

    Their series are worked out once an hour of the tow, and interpolated: what is found for an instant hangs on that
    instant alone.

    Checked  tests/tethered_deorbit/test_sky.py
    """

    @kernel
    def point_sky(record: Any, time: float, elapsed: float) -> None:
        """Places of Sun and Moon along the axes of the step [m].

        time          since the start of the instance            [s]
        elapsed       for which the axes have turned             [s]

        Checked  tests/tethered_deorbit/test_sky.py
        """
        r = record[0]
        window = math.floor(time / WINDOW)
        if r.state_sky_window != window:
            r.state_sky_window = window
            for k in range(NODES):
                at = r.orbit_epoch + (window + k - 1.0) * WINDOW
                sun_place(r.state_sky[k], at, r.orbit_epoch)
                if moon:
                    moon_place(r.state_sky[NODES + k], at, r.orbit_epoch)
        share = time / WINDOW - window
        between(r.state_sun, r.state_sky[0:NODES], share)
        turn_vectors_back(record, -elapsed, r.state_sun, 3)
        if moon:
            between(r.state_moon, r.state_sky[NODES : 2 * NODES], share)
            turn_vectors_back(record, -elapsed, r.state_moon, 3)

    return point_sky


@kernel
def add_attraction(record: Any, state: Array, rate: Array, body: Array, mu: float) -> None:
    """Add the gravity of a distant body to the rate of the pair [m/s^2].

        R'' += g(R - s) - g(-s) + (m_c da_c + m_t da_t)/M,   rho'' += da_t - da_c,   g(x) = -mu x/|x|^3

    da_c and da_t are the differences between the bodies and the centre. All differences are formed without
    cancellation; that by g(-s) is the Earth's own fall.

    state, rate   R, V, rho, rho'  of `layout`                   (12,)
    body          s      its place                               [m]        (3,)
    mu            mu     its gravitational parameter             [m^3/s^2]

    Source   `orbital.twobody.differential_gravity`
    Checked  tests/tethered_deorbit/test_sky.py, against 40 digits
    """
    r = record[0]
    own, chaser, target = r.state_perturbing[0], r.state_perturbing[1], r.state_perturbing[2]
    place, offset = r.state_perturbing[3], r.state_perturbing[4]
    for i in range(3):
        place[i] = -body[i]
    differential_gravity(own, place, state[0:3], mu)
    for i in range(3):
        place[i] = state[i] - body[i]
        offset[i] = -r.state_target_share * state[6 + i]
    differential_gravity(chaser, place, offset, mu)
    for i in range(3):
        offset[i] = r.state_chaser_share * state[6 + i]
    differential_gravity(target, place, offset, mu)
    for i in range(3):
        rate[3 + i] += own[i] + (r.state_chaser_share * chaser[i] + r.state_target_share * target[i])
        rate[9 + i] += target[i] - chaser[i]


@kernel
def attraction_beside(record: Any, state: Array, offset: Array, rate: Array, body: Array, mu: float) -> None:
    """Add that of a distant body on a node less that on the target [m/s^2], without cancellation: see `Disturbing`.

    body          its place                                      [m]        (3,)
    mu            its gravitational parameter                    [m^3/s^2]

    Source   `orbital.twobody.differential_gravity`
    Checked  tests/tethered_deorbit/test_nodes_in_orbit.py
    """
    r = record[0]
    found, place = r.state_perturbing[0], r.state_perturbing[3]
    for i in range(3):
        place[i] = state[i] + r.state_chaser_share * state[6 + i] - body[i]
    differential_gravity(found, place, offset, mu)
    for i in range(3):
        rate[i] += found[i]


def make_attraction(which: str) -> Disturbing:
    """The gravity of `sun`, `moon`, or `sun_and_moon`; after `point_sky`."""
    sun, moon = which != "moon", which != "sun"

    @kernel
    def add(record: Any, state: Array, rate: Array) -> None:
        """See `Disturbing`.

        Checked  tests/tethered_deorbit/test_sky.py
        """
        r = record[0]
        if sun:
            add_attraction(record, state, rate, r.state_sun, SUN_MU)
        if moon:
            add_attraction(record, state, rate, r.state_moon, MOON_MU)

    @kernel
    def beside(record: Any, state: Array, offset: Array, parting: Array, rate: Array) -> None:
        """See `Disturbing`.

        Checked  tests/tethered_deorbit/test_nodes_in_orbit.py
        """
        r = record[0]
        if sun:
            attraction_beside(record, state, offset, rate, r.state_sun, SUN_MU)
        if moon:
            attraction_beside(record, state, offset, rate, r.state_moon, MOON_MU)

    return Disturbing(add=add, beside=beside)
