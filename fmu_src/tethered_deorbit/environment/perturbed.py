"""What disturbs the orbit of a pair about the Earth: the flattening of its field, and the air, each where it is named.

Both know the Earth's axis, which the laws of a step's axes do not: these turn with a taut line, and the axis is turned
along with them.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

from fmu_src.tethered_deorbit.idle import nothing
from fmu_src.tethered_deorbit.turning import turn_vectors_back
from orbital.constants import EARTH_EQUATORIAL_RADIUS, EARTH_J2, EARTH_MU, EARTH_ROTATION_RATE
from orbital.kernel import kernel
from orbital.perturbations import (
    air_density,
    altitude_of,
    differential_flattening,
    drag_acceleration,
    flattening_acceleration,
    flattening_energy,
)
from orbital.vectors import Array, dot

FLATTENING = EARTH_J2 * EARTH_EQUATORIAL_RADIUS * EARTH_EQUATORIAL_RADIUS
GROUPS = ("oblateness", "air")


class Perturbing(NamedTuple):
    """Kernels; as it stands, of an orbit that nothing disturbs.

    add(record, state, rate, elapsed)   to the rate under gravity, `elapsed` [s] after the begin of the step
    publish(record)                     outputs, and the potential in `energy.orbital`, from those of bodies and centre
    differentiate(record, center, velocity)   the part of the potential in the rate of that
    """

    add: Callable[..., Any] = nothing
    publish: Callable[..., Any] = nothing
    differentiate: Callable[..., Any] = nothing


@kernel
def point_axis(record: Any, elapsed: float) -> None:
    """The Earth's axis along the axes of the step, in `state.pole`.

    elapsed       for which these have turned                    [s]

    Checked  tests/tethered_deorbit/test_perturbed.py: axes change nothing
    """
    pole = record[0].state_pole
    pole[0] = 0.0
    pole[1] = 0.0
    pole[2] = 1.0
    turn_vectors_back(record, -elapsed, pole, 3)


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
def add_drag(record: Any, state: Array, rate: Array) -> None:
    """Add the drag of both bodies to the rate of the pair [m/s^2]; after `point_axis`.

        R'' += (m_c a_c + m_t a_t)/M,   rho'' += a_t - a_c

    Unlike gravity it is no difference of great accelerations: bodies of other shape bear another drag.

    state, rate   R, V, rho, rho'  of `layout`                   (12,)

    Source   `orbital.perturbations`
    Checked  tests/tethered_deorbit/test_perturbed.py
    """
    r = record[0]
    chaser, target = r.state_perturbing[1], r.state_perturbing[2]
    position, velocity = r.state_perturbing[3], r.state_perturbing[4]
    for i in range(3):
        position[i] = state[i] - r.state_target_share * state[6 + i]
        velocity[i] = state[3 + i] - r.state_target_share * state[9 + i]
    half = 0.5 * r.air_drag_coefficient / r.state_total_mass
    density = of_air(record, altitude_of(position, EARTH_EQUATORIAL_RADIUS))
    drag_acceleration(
        chaser, position, velocity, r.state_pole, EARTH_ROTATION_RATE,
        half * r.air_chaser_area / r.state_chaser_share * density,
    )  # fmt: skip
    for i in range(3):
        position[i] = state[i] + r.state_chaser_share * state[6 + i]
        velocity[i] = state[3 + i] + r.state_chaser_share * state[9 + i]
    density = of_air(record, altitude_of(position, EARTH_EQUATORIAL_RADIUS))
    drag_acceleration(
        target, position, velocity, r.state_pole, EARTH_ROTATION_RATE,
        half * r.air_target_area / r.state_target_share * density,
    )  # fmt: skip
    for i in range(3):
        rate[3 + i] += r.state_chaser_share * chaser[i] + r.state_target_share * target[i]
        rate[9 + i] += target[i] - chaser[i]


@kernel
def of_air(record: Any, altitude: float) -> float:
    """Density of the air at an altitude [m], as the scene has it [kg/m^3].

    Checked  tests/tethered_deorbit/test_perturbed.py: an orbit decays
    """
    r = record[0]
    return float(air_density(altitude, r.air_base_density, r.air_base_altitude, r.air_scale_height))


@kernel
def publish_flattening(record: Any) -> None:
    """The potential of the flattening belongs to the energy of the orbit [J].

    Checked  tests/tethered_deorbit/test_perturbed.py: energy is kept
    """
    r = record[0]
    point_axis(record, 0.0)
    r.energy_orbital += r.state_total_mass * flattening_energy(r.center_position, r.state_pole, EARTH_MU, FLATTENING)


@kernel
def differentiate_flattening(record: Any, center: Array, velocity: Array) -> None:
    """And its rate is what the acceleration of the centre does not account for [W].

    Checked  tests/tethered_deorbit/test_perturbed.py: derivatives
    """
    r = record[0]
    point_axis(record, 0.0)
    own = r.state_perturbing[0]
    flattening_acceleration(own, center, r.state_pole, EARTH_MU, FLATTENING)
    r.rate_energy_orbital -= r.state_total_mass * dot(velocity, own)


@kernel
def publish_drag(record: Any) -> None:
    """Density at the centre of mass [kg/m^3], and the drag of both bodies [N].

    Checked  tests/tethered_deorbit/test_perturbed.py
    """
    r = record[0]
    point_axis(record, 0.0)
    r.air_density = of_air(record, r.altitude)
    out, half = r.state_perturbing[0], 0.5 * r.air_drag_coefficient
    density = of_air(record, r.chaser_radius - EARTH_EQUATORIAL_RADIUS)
    speed = drag_acceleration(out, r.chaser_position, r.chaser_velocity, r.state_pole, EARTH_ROTATION_RATE, 0.0)
    r.air_chaser_drag = half * r.air_chaser_area * density * speed * speed
    density = of_air(record, r.target_radius - EARTH_EQUATORIAL_RADIUS)
    speed = drag_acceleration(out, r.target_position, r.target_velocity, r.state_pole, EARTH_ROTATION_RATE, 0.0)
    r.air_target_drag = half * r.air_target_area * density * speed * speed


def make_perturbing(terms: Mapping[str, str]) -> Perturbing:
    """The kernels of what is named among `GROUPS`; ValueError where there is no orbit to disturb."""
    named = [group for group in GROUPS if group in terms]
    if not named:
        return Perturbing()
    if terms["environment"] == "none":
        raise ValueError(f"{named[0]} = {terms[named[0]]!r} needs an orbit, and environment = 'none' has none")
    flat, air = "oblateness" in terms, "air" in terms
    first_add, second_add = add_flattening if flat else nothing, add_drag if air else nothing
    first_publish, second_publish = publish_flattening if flat else nothing, publish_drag if air else nothing

    @kernel
    def add(record: Any, state: Array, rate: Array, elapsed: float) -> None:
        """See `Perturbing`.

        Checked  tests/tethered_deorbit/test_perturbed.py
        """
        point_axis(record, elapsed)
        first_add(record, state, rate)
        second_add(record, state, rate)

    @kernel
    def publish(record: Any) -> None:
        """See `Perturbing`.

        Checked  tests/tethered_deorbit/test_perturbed.py
        """
        first_publish(record)
        second_publish(record)

    return Perturbing(add, publish, differentiate_flattening if flat else nothing)
