"""What drives the thruster: the power that it has, the propellant that it takes, and the mass that goes with it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

from fmu_src.interface import Interface
from fmu_src.tethered_deorbit.acting import IDLE, Acting
from fmu_src.tethered_deorbit.faults import blame
from fmu_src.tethered_deorbit.idle import no_fault, nothing, zero
from fmu_src.tethered_deorbit.interface import BAD_INERTIA, BAD_PARAMETER
from fmu_src.tethered_deorbit.layout import ATTITUDE, PAIR, StateLayout
from orbital.constants import STANDARD_GRAVITY
from orbital.kernel import kernel
from orbital.oscillators import reduced_mass
from orbital.rigid import extreme_moments, inertia_matrix, invert_symmetric
from orbital.shadow import LIT
from orbital.vectors import Array, dot, matrix_vector


@kernel
def unlimited(record: Any, force: float) -> float:
    """The force that is asked for [N].

    Checked  tests/tethered_deorbit/test_burn.py
    """
    return force


class Engine(NamedTuple):
    """Kernels of one engine; as it stands, those of a thruster that gives what it is asked for, at no loss of mass.

    real                              whether it is another than that
    check(record) -> fault            at the start
    limited(record, force) -> force   what it gives of what is asked [N]
    weigh(record, state)              masses, shares and reduced mass of the pair in a state
    lose(record, state, rate, sign)   what the loss of mass does to the rate of the centre of mass; -1 undoes it
    shed(record, rate) -> M'          how fast the pair's mass changes [kg/s]; tells the rate of its centre of mass
    lighten(record, state, rate, n) -> power   what the loss of inertia adds to the rates of the chaser's spin, and to
                                      that of the energy of its turning in a frame of rate n [W]
    publish(record, force, change, asked)   its outputs, for the force in use [N], its rate [N/s], and what is asked of
                                      it, zero between burns [N]
    acting                            what it does by itself
    """

    real: bool = False
    check: Callable[..., Any] = no_fault
    limited: Callable[..., Any] = unlimited
    weigh: Callable[..., Any] = nothing
    lose: Callable[..., Any] = nothing
    shed: Callable[..., Any] = zero
    lighten: Callable[..., Any] = zero
    publish: Callable[..., Any] = nothing
    acting: Acting = IDLE


IDEAL = Engine()


def make_engine(terms: Mapping[str, str], layout: StateLayout, interface: Interface) -> Engine:
    """The kernels of the scene's engine; IDEAL where it names none.

        electric    |F| <= 2 eta P/(Isp g0),   power drawn = |F| Isp g0/(2 eta)
                    of solar power, P falls to a share of itself in shadow
        chemical    any F
        both        dm_c/dt = -|F|/(Isp g0), until the tank is empty

    R and V are the centre of mass of what is left, and the mean velocity weighted by its masses; mass that leaves at
    the chaser moves them,

        R' += (|m'|/M) (m_t/M) rho,   V' += (|m'|/M) (m_t/M) rho'

    The inertia of a chaser that turns falls by k^2 of the propellant's mass about any axis, k engine.tank_radius.

    Valid    propellant about the centre of mass, which stays where it is; what leaves takes its own spin with it
    Source   Newton's second law for a body that sheds mass at its own velocity; jet power F v_e/2
    Checked  tests/tethered_deorbit/test_engine.py
    """
    if "engine" not in terms:
        return IDEAL
    spent, electric, solar = layout.spent, terms["engine"] == "electric", "power" in terms
    tank_slot, radius_slot = (interface.references[f"engine.{name}"] for name in ("propellant", "tank_radius"))
    turns = terms["chaser"] != "point"
    w_at = PAIR + (ATTITUDE if terms["target"] != "point" else 0) + 4

    @kernel
    def exhaust_speed(record: Any) -> float:
        """Isp g0 [m/s].

        Checked  tests/tethered_deorbit/test_engine.py: the rocket equation
        """
        speed: float = record[0].thrust_specific_impulse * STANDARD_GRAVITY
        return speed

    @kernel
    def empty_is_a_body(record: Any) -> int:
        """The inertia without propellant is one that a body can have.

        Checked  tests/tethered_deorbit/test_engine.py
        """
        r = record[0]
        taken = r.engine_propellant * r.engine_tank_radius * r.engine_tank_radius
        least, greatest = extreme_moments(r.state_chaser_inertia)
        trace = r.chaser_inertia[0] + r.chaser_inertia[1] + r.chaser_inertia[2]
        if not (least > taken and greatest + 0.5 * taken <= 0.5 * trace):
            return blame(record, BAD_INERTIA, radius_slot, r.engine_tank_radius)
        return 0

    check_empty = empty_is_a_body if turns else no_fault

    @kernel
    def take_inertia(record: Any, spent_mass: float) -> None:
        """Inertia of the chaser, and its inverse, without the propellant that is spent [kg].

        Checked  tests/tethered_deorbit/test_engine.py: a thruster beside the centre of mass
        """
        r = record[0]
        if r.engine_tank_radius == 0.0:
            return
        inertia_matrix(r.state_chaser_inertia, r.chaser_inertia)
        for i in range(3):
            r.state_chaser_inertia[i, i] -= spent_mass * r.engine_tank_radius * r.engine_tank_radius
        invert_symmetric(r.state_chaser_inverse, r.state_chaser_inertia)

    take = take_inertia if turns else nothing

    @kernel
    def check(record: Any) -> int:
        """A full tank is part of the chaser's mass.

        Checked  tests/tethered_deorbit/test_engine.py
        """
        r = record[0]
        r.state_empty = 0
        if not r.engine_propellant < r.chaser_mass:
            return blame(record, BAD_PARAMETER, tank_slot, r.engine_propellant)
        if r.engine_tank_radius > 0.0:
            if not turns:
                return blame(record, BAD_PARAMETER, radius_slot, r.engine_tank_radius)
            return int(check_empty(record))
        return 0

    @kernel
    def limited(record: Any, force: float) -> float:
        """What it gives [N].

        Checked  tests/tethered_deorbit/test_engine.py
        """
        r = record[0]
        if r.state_empty:
            return 0.0
        if electric:
            most = 2.0 * r.engine_efficiency * r.engine_power_limit / exhaust_speed(record)
            if solar:
                most *= 1.0 if r.state_zone == LIT else r.power_battery_share
            return float(max(-most, min(most, force)))
        return force

    @kernel
    def weigh(record: Any, state: Array) -> None:
        """Masses of the pair, with what the tank has lost.

        Checked  tests/tethered_deorbit/test_engine.py
        """
        r = record[0]
        left = r.chaser_mass - state[spent]
        r.state_chaser_mass = left
        r.state_total_mass = left + r.target_mass
        r.state_chaser_share = left / r.state_total_mass
        r.state_target_share = r.target_mass / r.state_total_mass
        r.state_reduced_mass = reduced_mass(left, r.target_mass)
        take(record, state[spent])

    @kernel
    def lose(record: Any, state: Array, rate: Array, sign: float) -> None:
        """What the loss of mass does to R and V, added with a sign: see `make_engine`.

        Checked  tests/tethered_deorbit/test_engine.py: the two bodies move as Newton says of each
        """
        r = record[0]
        factor = sign * rate[spent] / r.state_total_mass * r.state_target_share
        for i in range(6):
            rate[i] += factor * state[6 + i]

    @kernel
    def shed(record: Any, rate: Array) -> float:
        """Rate of the pair's mass [kg/s]; that of its centre becomes the one told of `center.position`, R' [m/s].

        Checked  tests/tethered_deorbit/test_engine.py: rates of what masses move
        """
        for i in range(3):
            record[0].rate_center_position[i] = rate[i]
        return float(-rate[spent])

    @kernel
    def lighten_chaser(record: Any, state: Array, rate: Array, n: float) -> float:
        """What the loss of inertia adds: see `Engine`; after `differentiate` of the bodies.

            H' -= c A w,   E' -= c w^2/2,   power = -c (w^2/2 - n o.A w),   c = |m'| k^2, o axis 3 of the frame

        Checked  tests/tethered_deorbit/test_engine.py: rates of what masses move
        """
        r = record[0]
        c = rate[spent] * r.engine_tank_radius * r.engine_tank_radius
        w, along = state[w_at : w_at + 3], r.state_chaser_arms[0]
        matrix_vector(along, r.state_chaser_turned, w)
        for i in range(3):
            r.rate_chaser_spin[i] -= c * along[i]
        turning = 0.5 * dot(w, w)
        r.rate_chaser_spin_energy -= c * turning
        return float(-c * (turning - n * dot(r.state_basis[2], along)))

    lighten = lighten_chaser if turns else zero

    @kernel
    def publish(record: Any, force: float, change: float, asked: float) -> None:
        """Propellant left [kg], and power drawn [W]; with their rates.

        Checked  tests/tethered_deorbit/test_engine.py
        """
        r = record[0]
        r.engine_propellant_left = max(0.0, r.engine_propellant - r.chaser_propellant)
        r.rate_propellant_left = -abs(force) / exhaust_speed(record)
        if electric:
            per_force = exhaust_speed(record) / (2.0 * r.engine_efficiency)
            r.engine_power = per_force * abs(force)
            r.rate_engine_power = per_force * (change if force >= 0.0 else -change)
            r.engine_limited = not r.state_empty and limited(record, asked) != asked

    @kernel
    def holds(record: Any, state: Array, since: float) -> bool:
        """Whether there is propellant, or known to be none.

        Checked  tests/tethered_deorbit/test_engine.py
        """
        r = record[0]
        return bool(r.state_empty or state[spent] < r.engine_propellant)

    @kernel
    def act(record: Any, state: Array, time: float, by_state: bool) -> int:
        """The tank is empty.

        Checked  tests/tethered_deorbit/test_engine.py
        """
        r = record[0]
        if state[spent] >= r.engine_propellant:
            r.state_empty = 1
        return 0

    return Engine(True, check, limited, weigh, lose, shed, lighten, publish, Acting(holds=holds, act=act))
