"""Zonal harmonics of the Earth's field: the second, and the third and the fourth with it."""

from __future__ import annotations

from typing import Any

from fmu_src.tethered_deorbit.environment.disturbing import Disturbing, together
from orbital.constants import EARTH_EQUATORIAL_RADIUS, EARTH_J2, EARTH_J3, EARTH_J4, EARTH_MU
from orbital.kernel import kernel
from orbital.perturbations import differential_flattening, flattening_acceleration, flattening_energy
from orbital.vectors import Array, dot
from orbital.zonals import differential_zonal, zonal_acceleration, zonal_energy

FLATTENING = EARTH_J2 * EARTH_EQUATORIAL_RADIUS * EARTH_EQUATORIAL_RADIUS
THIRD, FOURTH = EARTH_J3 * EARTH_EQUATORIAL_RADIUS**3, EARTH_J4 * EARTH_EQUATORIAL_RADIUS**4


@kernel
def add_flattening(record: Any, state: Array, rate: Array) -> None:
    """Add the second zonal harmonic to the rate of the pair [m/s^2]; after `point_axis`.

        R'' += a(R) + (m_c da_c + m_t da_t)/M,   rho'' += da_t - da_c

    da_c and da_t are the differences between the bodies and the centre, which have opposite signs.

    state, rate   R, V, rho, rho'  of `layout`                   (12,)

    Source   `orbital.perturbations`
    Checked  tests/tethered_deorbit/test_perturbed.py
    """
    r = record[0]
    own, chaser, target = r.state_perturbing[0], r.state_perturbing[1], r.state_perturbing[2]
    offset = r.state_perturbing[3]
    flattening_acceleration(own, state[0:3], r.state_pole, EARTH_MU, FLATTENING)
    for i in range(3):
        offset[i] = -r.state_target_share * state[6 + i]
    differential_flattening(chaser, state[0:3], offset, r.state_pole, EARTH_MU, FLATTENING)
    for i in range(3):
        offset[i] = r.state_chaser_share * state[6 + i]
    differential_flattening(target, state[0:3], offset, r.state_pole, EARTH_MU, FLATTENING)
    for i in range(3):
        rate[3 + i] += own[i] + (r.state_chaser_share * chaser[i] + r.state_target_share * target[i])
        rate[9 + i] += target[i] - chaser[i]


@kernel
def publish_flattening(record: Any, time: float) -> None:
    """The potential of the flattening belongs to the energy of the orbit [J].

    Checked  tests/tethered_deorbit/test_perturbed.py: energy is kept
    """
    r = record[0]
    r.energy_orbital += r.state_total_mass * flattening_energy(r.center_position, r.state_pole, EARTH_MU, FLATTENING)


@kernel
def differentiate_flattening(record: Any, center: Array, velocity: Array) -> None:
    """And its rate is what the acceleration of the centre does not account for [W].

    Checked  tests/tethered_deorbit/test_perturbed.py: derivatives
    """
    r = record[0]
    own = r.state_perturbing[0]
    flattening_acceleration(own, center, r.state_pole, EARTH_MU, FLATTENING)
    r.rate_energy_orbital -= r.state_total_mass * dot(velocity, own)


@kernel
def add_higher(record: Any, state: Array, rate: Array) -> None:
    """Add the third and the fourth zonal harmonic to the rate of the pair [m/s^2]; after `point_axis`.

    Formula, state and rate as in `add_flattening`.

    Source   `orbital.zonals`
    Checked  tests/tethered_deorbit/test_sky.py
    """
    r = record[0]
    own, chaser, target = r.state_perturbing[0], r.state_perturbing[1], r.state_perturbing[2]
    offset = r.state_perturbing[3]
    zonal_acceleration(own, state[0:3], r.state_pole, EARTH_MU, THIRD, FOURTH)
    for i in range(3):
        offset[i] = -r.state_target_share * state[6 + i]
    differential_zonal(chaser, state[0:3], offset, r.state_pole, EARTH_MU, THIRD, FOURTH)
    for i in range(3):
        offset[i] = r.state_chaser_share * state[6 + i]
    differential_zonal(target, state[0:3], offset, r.state_pole, EARTH_MU, THIRD, FOURTH)
    for i in range(3):
        rate[3 + i] += own[i] + (r.state_chaser_share * chaser[i] + r.state_target_share * target[i])
        rate[9 + i] += target[i] - chaser[i]


@kernel
def publish_higher(record: Any, time: float) -> None:
    """Their potential belongs to the energy of the orbit [J].

    Checked  tests/tethered_deorbit/test_sky.py: energy is kept
    """
    r = record[0]
    r.energy_orbital += r.state_total_mass * zonal_energy(r.center_position, r.state_pole, EARTH_MU, THIRD, FOURTH)


@kernel
def differentiate_higher(record: Any, center: Array, velocity: Array) -> None:
    """And its rate is what the acceleration of the centre does not account for [W].

    Checked  tests/tethered_deorbit/test_sky.py: derivatives
    """
    r = record[0]
    own = r.state_perturbing[0]
    zonal_acceleration(own, center, r.state_pole, EARTH_MU, THIRD, FOURTH)
    r.rate_energy_orbital -= r.state_total_mass * dot(velocity, own)


J2 = Disturbing(add_flattening, publish_flattening, differentiate_flattening)
J4 = together([J2, Disturbing(add_higher, publish_higher, differentiate_higher)])
ZONALS = {"J2": J2, "J4": J4}
