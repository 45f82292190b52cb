"""The air, which drags each of the two bodies."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from fmu_src.tethered_deorbit.air_table import mean_profile
from fmu_src.tethered_deorbit.environment.disturbing import Disturbing
from orbital.constants import EARTH_EQUATORIAL_RADIUS, EARTH_ROTATION_RATE
from orbital.kernel import kernel
from orbital.perturbations import air_density, altitude_of, drag_acceleration
from orbital.vectors import Array

Rows = npt.NDArray[np.float64]


@kernel
def exponential(record: Any, position: Array) -> float:
    """Density of the air at a place [m], as the scene has it [kg/m^3].

    Checked  tests/tethered_deorbit/test_perturbed.py: an orbit decays
    """
    r = record[0]
    altitude = altitude_of(position, EARTH_EQUATORIAL_RADIUS)
    return float(air_density(altitude, r.air_base_density, r.air_base_altitude, r.air_scale_height))


def make_air(density_at: Callable[..., Any]) -> Disturbing:
    """The drag of air whose density the kernel `density_at(record, position)` gives [kg/m^3].

    Checked  tests/tethered_deorbit/test_perturbed.py
    """

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
        density = density_at(record, position)
        drag_acceleration(
            chaser, position, velocity, r.state_pole, EARTH_ROTATION_RATE,
            half * r.air_chaser_area / r.state_chaser_share * density,
        )  # fmt: skip
        for i in range(3):
            position[i] = state[i] + r.state_chaser_share * state[6 + i]
            velocity[i] = state[3 + i] + r.state_chaser_share * state[9 + i]
        density = density_at(record, position)
        drag_acceleration(
            target, position, velocity, r.state_pole, EARTH_ROTATION_RATE,
            half * r.air_target_area / r.state_target_share * density,
        )  # fmt: skip
        for i in range(3):
            rate[3 + i] += r.state_chaser_share * chaser[i] + r.state_target_share * target[i]
            rate[9 + i] += target[i] - chaser[i]

    @kernel
    def publish_drag(record: Any, time: float) -> None:
        """Density at the centre of mass [kg/m^3], and the drag of both bodies [N].

        Checked  tests/tethered_deorbit/test_perturbed.py
        """
        r = record[0]
        r.air_density = density_at(record, r.center_position)
        out, half = r.state_perturbing[1], 0.5 * r.air_drag_coefficient
        density = density_at(record, r.chaser_position)
        speed = drag_acceleration(out, r.chaser_position, r.chaser_velocity, r.state_pole, EARTH_ROTATION_RATE, 0.0)
        r.air_chaser_drag = half * r.air_chaser_area * density * speed * speed
        density = density_at(record, r.target_position)
        speed = drag_acceleration(out, r.target_position, r.target_velocity, r.state_pole, EARTH_ROTATION_RATE, 0.0)
        r.air_target_drag = half * r.air_target_area * density * speed * speed

    @kernel
    def drag_beside(record: Any, state: Array, offset: Array, parting: Array, rate: Array) -> None:
        """See `Disturbing`: a node shows the air its piece of line from the side, whichever way that lies.

            b = rho c_d d l_p/(2 m) = 2 rho c_d/(pi d rho_line)

        Valid    a line thin beside its pieces; the air along it is taken to drag as hard as across
        Checked  tests/tethered_deorbit/test_nodes_in_orbit.py
        """
        r = record[0]
        node, target = r.state_perturbing[1], r.state_perturbing[2]
        position, velocity = r.state_perturbing[3], r.state_perturbing[4]
        for i in range(3):
            position[i] = state[i] + r.state_chaser_share * state[6 + i]
            velocity[i] = state[3 + i] + r.state_chaser_share * state[9 + i]
        mass = r.state_target_share * r.state_total_mass
        density = density_at(record, position)
        drag_acceleration(
            target, position, velocity, r.state_pole, EARTH_ROTATION_RATE,
            0.5 * r.air_drag_coefficient * r.air_target_area / mass * density,
        )  # fmt: skip
        for i in range(3):
            position[i] += offset[i]
            velocity[i] += parting[i]
        density = density_at(record, position)
        drag_acceleration(
            node, position, velocity, r.state_pole, EARTH_ROTATION_RATE,
            2.0 * r.air_drag_coefficient / (math.pi * r.tether_diameter * r.lumped_density) * density,
        )  # fmt: skip
        for i in range(3):
            rate[i] += node[i] - target[i]

    return Disturbing(add_drag, publish_drag, beside=drag_beside)


def mean_density(values: Mapping[str, float], terms: Mapping[str, str]) -> Callable[[Rows], Rows] | None:
    """Function of altitudes [m] that gives the density of a scene's air [kg/m^3], for what is averaged; None without.

    values        parameters by FMI name, SI, and what only the scene knows
    """
    if terms.get("air") == "nrlmsis":
        return mean_profile(values)
    if terms.get("air") != "exponential":
        return None
    base, at, scale = (values[f"air.{name}"] for name in ("base_density", "base_altitude", "scale_height"))
    return lambda altitude: base * np.exp((at - altitude) / scale)
