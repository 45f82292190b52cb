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
def flattening(out: Array, position: Array, pole: Array) -> None:
    """See `orbital.perturbations.flattening_acceleration`.

    Checked  tests/tethered_deorbit/test_perturbed.py
    """
    flattening_acceleration(out, position, pole, EARTH_MU, FLATTENING)


@kernel
def flattening_difference(out: Array, position: Array, offset: Array, pole: Array) -> None:
    """See `orbital.perturbations.differential_flattening`.

    Checked  tests/tethered_deorbit/test_perturbed.py
    """
    differential_flattening(out, position, offset, pole, EARTH_MU, FLATTENING)


@kernel
def energy_of_flattening(position: Array, pole: Array) -> float:
    """See `orbital.perturbations.flattening_energy`.

    Checked  tests/tethered_deorbit/test_perturbed.py: energy is kept
    """
    return float(flattening_energy(position, pole, EARTH_MU, FLATTENING))


@kernel
def higher(out: Array, position: Array, pole: Array) -> None:
    """See `orbital.zonals.zonal_acceleration`.

    Checked  tests/tethered_deorbit/test_sky.py
    """
    zonal_acceleration(out, position, pole, EARTH_MU, THIRD, FOURTH)


@kernel
def higher_difference(out: Array, position: Array, offset: Array, pole: Array) -> None:
    """See `orbital.zonals.differential_zonal`.

    Checked  tests/tethered_deorbit/test_sky.py
    """
    differential_zonal(out, position, offset, pole, EARTH_MU, THIRD, FOURTH)


@kernel
def energy_of_higher(position: Array, pole: Array) -> float:
    """See `orbital.zonals.zonal_energy`.

    Checked  tests/tethered_deorbit/test_sky.py: energy is kept
    """
    return float(zonal_energy(position, pole, EARTH_MU, THIRD, FOURTH))


def make_zonals(acceleration: Any, difference: Any, energy: Any) -> Disturbing:
    """What some harmonics do to the pair, from kernels of their acceleration, of its difference between two bodies, and
    of their energy by mass."""

    @kernel
    def add(record: Any, state: Array, rate: Array) -> None:
        """Add them to the rate of the pair [m/s^2]; after `point_axis`.

            R'' += a(R) + (m_c da_c + m_t da_t)/M,   rho'' += da_t - da_c

        da_c and da_t are the differences between the bodies and the centre, which have opposite signs.

        state, rate   R, V, rho, rho'  of `layout`                   (12,)

        Source   `orbital.perturbations`, `orbital.zonals`
        Checked  tests/tethered_deorbit/test_perturbed.py, tests/tethered_deorbit/test_sky.py
        """
        r = record[0]
        own, chaser, target = r.state_perturbing[0], r.state_perturbing[1], r.state_perturbing[2]
        offset = r.state_perturbing[3]
        acceleration(own, state[0:3], r.state_pole)
        for i in range(3):
            offset[i] = -r.state_target_share * state[6 + i]
        difference(chaser, state[0:3], offset, r.state_pole)
        for i in range(3):
            offset[i] = r.state_chaser_share * state[6 + i]
        difference(target, state[0:3], offset, r.state_pole)
        for i in range(3):
            rate[3 + i] += own[i] + (r.state_chaser_share * chaser[i] + r.state_target_share * target[i])
            rate[9 + i] += target[i] - chaser[i]

    @kernel
    def publish(record: Any, time: float) -> None:
        """Their potential belongs to the energy of the orbit [J].

        Checked  tests/tethered_deorbit/test_perturbed.py, tests/tethered_deorbit/test_sky.py: energy is kept
        """
        r = record[0]
        r.energy_orbital += r.state_total_mass * energy(r.center_position, r.state_pole)

    @kernel
    def differentiate(record: Any, center: Array, velocity: Array) -> None:
        """And its rate is what the acceleration of the centre does not account for [W].

        Checked  tests/tethered_deorbit/test_perturbed.py, tests/tethered_deorbit/test_sky.py: derivatives
        """
        r = record[0]
        own = r.state_perturbing[0]
        acceleration(own, center, r.state_pole)
        r.rate_energy_orbital -= r.state_total_mass * dot(velocity, own)

    @kernel
    def beside(record: Any, state: Array, distance: Array, parting: Array, rate: Array) -> None:
        """See `Disturbing`.

        Checked  tests/tethered_deorbit/test_nodes_in_orbit.py
        """
        r = record[0]
        target, found = r.state_perturbing[0], r.state_perturbing[1]
        for i in range(3):
            target[i] = state[i] + r.state_chaser_share * state[6 + i]
        difference(found, target, distance, r.state_pole)
        for i in range(3):
            rate[i] += found[i]

    return Disturbing(add, publish, differentiate, beside)


J2 = make_zonals(flattening, flattening_difference, energy_of_flattening)
J4 = together([J2, make_zonals(higher, higher_difference, energy_of_higher)])
ZONALS = {"J2": J2, "J4": J4}
