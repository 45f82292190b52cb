"""What drives the thruster: the power that it has, the propellant that it takes, and the mass that goes with it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

from fmu_src.interface import Interface
from fmu_src.tethered_deorbit.acting import IDLE, Acting
from fmu_src.tethered_deorbit.faults import blame
from fmu_src.tethered_deorbit.idle import no_fault, nothing
from fmu_src.tethered_deorbit.interface import BAD_PARAMETER
from fmu_src.tethered_deorbit.layout import StateLayout
from orbital.constants import STANDARD_GRAVITY
from orbital.kernel import kernel
from orbital.oscillators import reduced_mass
from orbital.vectors import Array


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
    publish(record, force, change)    its outputs, for the force in use [N] and its rate [N/s]
    acting                            what it does by itself
    """

    real: bool = False
    check: Callable[..., Any] = no_fault
    limited: Callable[..., Any] = unlimited
    weigh: Callable[..., Any] = nothing
    lose: Callable[..., Any] = nothing
    publish: Callable[..., Any] = nothing
    acting: Acting = IDLE


IDEAL = Engine()


def make_engine(terms: Mapping[str, str], layout: StateLayout, interface: Interface) -> Engine:
    """The kernels of the scene's engine; IDEAL where it names none.

        electric    |F| <= 2 eta P/(Isp g0),   power drawn = |F| Isp g0/(2 eta)
        chemical    any F
        both        dm_c/dt = -|F|/(Isp g0), until the tank is empty

    R and V are the centre of mass of what is left, and the mean velocity weighted by its masses; mass that leaves at
    the chaser moves them,

        R' += (|m'|/M) (m_t/M) rho,   V' += (|m'|/M) (m_t/M) rho'

    Valid    a chaser that turns keeps its inertia and its centre of mass as the tank empties
    Source   Newton's second law for a body that sheds mass at its own velocity; jet power F v_e/2
    Checked  tests/tethered_deorbit/test_engine.py
    """
    if "engine" not in terms:
        return IDEAL
    spent, electric = layout.spent, terms["engine"] == "electric"
    tank_slot = interface.references["engine.propellant"]

    @kernel
    def exhaust_speed(record: Any) -> float:
        """Isp g0 [m/s].

        Checked  tests/tethered_deorbit/test_engine.py: the rocket equation
        """
        speed: float = record[0].thrust_specific_impulse * STANDARD_GRAVITY
        return speed

    @kernel
    def check(record: Any) -> int:
        """A full tank is part of the chaser's mass.

        Checked  tests/tethered_deorbit/test_engine.py
        """
        r = record[0]
        r.state_empty = 0
        if not r.engine_propellant < r.chaser_mass:
            return blame(record, BAD_PARAMETER, tank_slot, r.engine_propellant)
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
    def publish(record: Any, force: float, change: float) -> None:
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
            asked = r.state_thrust
            r.engine_limited = limited(record, asked) != asked

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

    return Engine(True, check, limited, weigh, lose, publish, Acting(holds=holds, act=act))
