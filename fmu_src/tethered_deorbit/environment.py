"""Gravity on the pair, as what it does to the centre of mass and to the relative vector."""

from __future__ import annotations

from typing import Any

from orbital.constants import EARTH_MU
from orbital.kernel import kernel
from orbital.twobody import differential_gravity, two_body_acceleration
from orbital.vectors import Array


@kernel
def add_gravity(record: Any, state: Array, rate: Array) -> None:
    """Rate of the state under gravity alone [m/s, m/s^2]; writes all twelve components.

        r_c = R - (m_t/M) rho,   r_t = R + (m_c/M) rho
        R''   = g(R) + (m_c (g(r_c) - g(R)) + m_t (g(r_t) - g(R))) / M
        rho'' = (g(r_t) - g(R)) - (g(r_c) - g(R))

    state         R, V, rho, rho'  of `layout`                   (12,)

    The two differences are each formed without cancellation and have opposite signs: nothing is lost in between.

    Valid    point masses about a point mass, any length of line
    Source   Newton for two bodies; Battin's f(q) in `orbital.twobody`
    Checked  tests/tethered_deorbit/test_terms.py, against the difference of two accelerations in 50 digits
    """
    r = record[0]
    position = state[0:3]
    chaser = rate[0:3]
    target = rate[6:9]
    center = rate[3:6]
    for i in range(3):
        chaser[i] = -r.state_target_share * state[6 + i]
        target[i] = r.state_chaser_share * state[6 + i]
    differential_gravity(chaser, position, chaser, EARTH_MU)
    differential_gravity(target, position, target, EARTH_MU)
    two_body_acceleration(center, position, EARTH_MU)
    for i in range(3):
        center[i] += r.state_chaser_share * chaser[i] + r.state_target_share * target[i]
        rate[9 + i] = target[i] - chaser[i]
        rate[i] = state[3 + i]
        rate[6 + i] = state[9 + i]
