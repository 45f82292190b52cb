"""A line that conducts: the Earth's field drives a current through it, and pushes it for that."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

from fmu_src.tethered_deorbit.environment.disturbing import Disturbing
from fmu_src.tethered_deorbit.field_table import DEGREE
from fmu_src.tethered_deorbit.turning import turn_vectors_back
from orbital.constants import EARTH_ROTATION_RATE
from orbital.kernel import kernel
from orbital.magnetism import dipole_field, dipole_north, harmonic_field, tether_current
from orbital.sky import greenwich_angle
from orbital.vectors import Array, cross, dot, norm


@kernel
def point_greenwich(record: Any, time: float, elapsed: float) -> None:
    """Direction of the meridian of Greenwich on the equator along the axes of the step, in `state.meridian`.

    Arguments as in `point_dipole`.

    Checked  tests/tethered_deorbit/test_field.py
    """
    r = record[0]
    angle = greenwich_angle(r.orbit_epoch + time, r.orbit_epoch)
    r.state_meridian[0], r.state_meridian[1], r.state_meridian[2] = math.cos(angle), math.sin(angle), 0.0
    turn_vectors_back(record, -elapsed, r.state_meridian, 3)


@kernel
def dipole(record: Any, position: Array) -> None:
    """The dipole's field at a place [m], in `state.field` [T]; after `point_dipole`.

    Checked  tests/tethered_deorbit/test_electrodynamic.py
    """
    dipole_field(record[0].state_field, position, record[0].state_dipole)


def make_igrf(reader: Any) -> Callable[..., Any]:
    """The kernel `igrf(record, position)`, which writes `state.field` [T]; after `point_axis` and `point_greenwich`.

    reader        of the table of coefficients

    Checked  tests/tethered_deorbit/test_field.py
    """

    @kernel
    def igrf(record: Any, position: Array) -> None:
        """The field by its harmonics, along the axes of the step.

        position      from the Earth's centre                    [m]        (3,)

        Checked  tests/tethered_deorbit/test_field.py
        """
        r = record[0]
        east, place, found = r.state_perturbing[0], r.state_perturbing[1], r.state_field
        cross(east, r.state_pole, r.state_meridian)
        place[0], place[1], place[2] = dot(position, r.state_meridian), dot(position, east), dot(position, r.state_pole)
        harmonic_field(found, place, reader(r), r.state_harmonics, DEGREE)
        x, y, z = found[0], found[1], found[2]
        for i in range(3):
            found[i] = x * r.state_meridian[i] + y * east[i] + z * r.state_pole[i]

    return igrf


@kernel
def point_dipole(record: Any, time: float, elapsed: float) -> None:
    """Direction of the dipole along the axes of the step, in `state.dipole`.

    time          since the start of the instance                [s]
    elapsed       for which the axes have turned                 [s]

    Checked  tests/tethered_deorbit/test_electrodynamic.py
    """
    r = record[0]
    dipole_north(r.state_dipole, greenwich_angle(r.orbit_epoch + time, r.orbit_epoch))
    turn_vectors_back(record, -elapsed, r.state_dipole, 3)


def make_electrodynamic(terms: Mapping[str, str], field: Callable[..., Any]) -> Disturbing:
    """What the current does to the pair; after `point_axis` and what the field wants.

    field         kernel (record, position): the field there, in `state.field`

        E = (u x B) . rho,   u = v - w p x r at the middle of the line,   F = I rho x B,   half of it on each body

    Whatever way the line takes between its ends, in an even field the force on it is that of the straight one; so a
    slack line is pushed as well. The power that the pair loses by it to the air's frame is I E.

    Valid    lines so short that the field is even along them; the sideways load on the line, which bows it, is left out
    Source   Lorentz; Cosmo and Lorenzini, Tethers in space handbook (1997), section 4.2
    Checked  tests/tethered_deorbit/test_electrodynamic.py
    """
    breaks, releases = "break" in terms, "release" in terms

    @kernel
    def flow(record: Any, position: Array, velocity: Array, line: Array) -> tuple[float, float]:
        """Voltage [V] and current [A]; the field [T] goes into `state.field`.

        position, velocity   of the middle of the line           [m], [m/s]  (3,)
        line                 from the chaser to the target       [m]         (3,)

        Checked  tests/tethered_deorbit/test_electrodynamic.py
        """
        r = record[0]
        speed, push = r.state_perturbing[0], r.state_perturbing[1]
        pole = r.state_pole
        field(record, position)
        cross(speed, pole, position)
        for i in range(3):
            speed[i] = velocity[i] - EARTH_ROTATION_RATE * speed[i]
        cross(push, speed, r.state_field)
        emf = dot(push, line)
        current = tether_current(
            emf,
            r.electrodynamic_resistance,
            r.electrodynamic_contactor_drop,
            r.electrodynamic_current_limit,
            r.electrodynamic_electron_density,
            r.electrodynamic_electron_temperature,
            r.electrodynamic_contactor_radius,
        )
        if breaks:
            if r.state_broken:
                current = 0.0
        if releases:
            if r.state_released:
                current = 0.0
        return emf, current

    @kernel
    def add(record: Any, state: Array, rate: Array) -> None:
        """Add the force to the rate of the pair [m/s^2].

            R'' += F/M,   rho'' += (F/2) (1/m_t - 1/m_c)

        Checked  tests/tethered_deorbit/test_electrodynamic.py
        """
        r = record[0]
        position, velocity, push = r.state_perturbing[3], r.state_perturbing[4], r.state_perturbing[2]
        off = 0.5 * (r.state_chaser_share - r.state_target_share)
        for i in range(3):
            position[i] = state[i] + off * state[6 + i]
            velocity[i] = state[3 + i] + off * state[9 + i]
        _, current = flow(record, position, velocity, state[6:9])
        cross(push, state[6:9], r.state_field)
        both = current / r.state_total_mass
        apart = 0.5 * both * (1.0 / r.state_target_share - 1.0 / r.state_chaser_share)
        for i in range(3):
            rate[3 + i] += both * push[i]
            rate[9 + i] += apart * push[i]

    @kernel
    def publish(record: Any, time: float) -> None:
        """Field [T], voltage [V], current [A], force [N], and powers [W]: I E, that of the plasma's frame, which turns,
        and -F . V, which the orbit loses, V being the velocity of the centre of mass.

        Checked  tests/tethered_deorbit/test_electrodynamic.py
        """
        r = record[0]
        position, velocity, line = r.state_perturbing[3], r.state_perturbing[4], r.state_perturbing[2]
        for i in range(3):
            position[i] = 0.5 * (r.chaser_position[i] + r.target_position[i])
            velocity[i] = 0.5 * (r.chaser_velocity[i] + r.target_velocity[i])
            line[i] = r.target_position[i] - r.chaser_position[i]
        emf, current = flow(record, position, velocity, line)
        r.electrodynamic_field = norm(r.state_field)
        r.electrodynamic_emf = emf
        r.electrodynamic_current = current
        r.electrodynamic_power = emf * current
        cross(velocity, line, r.state_field)
        r.electrodynamic_orbit_power = -current * dot(velocity, r.center_velocity)
        r.electrodynamic_force = abs(current) * norm(velocity)

    return Disturbing(add, publish)
