"""Two points. The line is made fast at the chaser's centre of mass and at a fixed distance from the target's.

A target that is a point turns with the line, so that its attachment always lies on the line of centres.
"""

from __future__ import annotations

from typing import Any

from fmu_src.interface import Interface
from fmu_src.tethered_deorbit.bodies import Bodies
from fmu_src.tethered_deorbit.faults import blame
from fmu_src.tethered_deorbit.idle import no_end, nothing, zero
from fmu_src.tethered_deorbit.interface import BAD_PARAMETER, HANDED_OVER, START_STRETCHED
from fmu_src.tethered_deorbit.kinematics import distance_acceleration, distance_rate, turning_share
from orbital.kernel import kernel, view
from orbital.vectors import Array, dot, norm


@kernel
def begin(record: Any) -> int:
    """The line moves the pair's reduced mass [kg].

    Checked  tests/tethered_deorbit/test_snap.py
    """
    r = record[0]
    r.state_effective_mass = r.state_reduced_mass
    r.state_beyond = r.target_attachment_distance
    return 0


@kernel
def pace(record: Any, state: Array) -> float:
    """The environment's pace [rad/s]: nothing else turns.

    Checked  tests/tethered_deorbit/test_integrator.py
    """
    own: float = record[0].state_pace
    return own


@kernel
def square_across(record: Any, state: Array, error: Array, along: float) -> float:
    """Square of the error of the velocity across the line [m2/s2]: see `Bodies`.

    Checked  tests/tethered_deorbit/test_integrator.py
    """
    return dot(error[9:12], error[9:12]) - along * along


@kernel
def moved_mass(record: Any, state: Array) -> float:
    """The pair's reduced mass [kg], wherever the line is.

    Checked  tests/tethered_deorbit/test_snap.py
    """
    mass: float = record[0].state_effective_mass
    return mass


@kernel
def mass_now(record: Any, state: Array) -> float:
    """The same as the tank empties [kg].

    Checked  tests/tethered_deorbit/test_settled.py: an engine
    """
    mass: float = record[0].state_reduced_mass
    return mass


@kernel
def line_length(record: Any, separation: float) -> float:
    """Length of the line between its attachments [m]; negative where the chaser is nearer than the target's.

        l = s - a

    separation    s      of the centres of mass                  [m]

    with a the parameter target.attachment_distance; l has the rates of s.

    Valid    attachment on the line of centres
    Source   fmu_src/tethered_deorbit/README.md, What is computed
    Checked  tests/tethered_deorbit/test_attachment.py
    """
    length: float = separation - record[0].target_attachment_distance
    return length


@kernel
def line(record: Any, state: Array) -> tuple[float, float, float]:
    """Separation of the centres [m], length of the line [m] and its rate [m/s]: see `Bodies`.

    Checked  tests/tethered_deorbit/test_attachment.py, test_terms.py
    """
    separation = norm(state[6:9])
    speed: float = distance_rate(state[6:9], state[9:12], separation)
    return separation, line_length(record, separation), speed


@kernel
def along(record: Any, state: Array) -> tuple[float, float, float]:
    """Direction of the line, towards the target [m]: rho.

    Checked  tests/tethered_deorbit/test_terms.py, test_uncompiled.py
    """
    return state[6], state[7], state[8]


@kernel
def second(
    record: Any, state: Array, rate: Array, separation: float, length: float, speed: float, turned: float
) -> tuple[float, float, float]:
    """Second derivative of the length, which is that of the separation [m/s^2], and the rates of that: see `Bodies`.

    Checked  tests/tethered_deorbit/test_turning.py, test_terms.py
    """
    change: float = distance_acceleration(state[6:9], state[9:12], rate[9:12], separation, speed)
    change += turned * turning_share(record, state[6:9], state[9:12], separation)
    return change, speed, change


@kernel
def pull(record: Any, state: Array, rate: Array, tension: float, separation: float) -> None:
    """Add the pull of the line to the rate of the state [m/s^2].

        rho'' -= T/m_r rho/s

    state         R, V, rho, rho'  of `layout`                   (12,)
    tension       T                                              [N]
    separation    s      |rho|                                   [m]

    The two pulls are opposite, so that the centre of mass feels nothing.

    Valid    massless straight line, s > 0
    Source   Newton's third law
    Checked  tests/tethered_deorbit/test_terms.py
    """
    if separation > 0.0:
        factor = tension / (record[0].state_reduced_mass * separation)
        for i in range(3):
            rate[9 + i] -= factor * state[6 + i]


@kernel
def ends(record: Any, state: Array, out: Array) -> None:
    """Both centres of mass: see `Bodies`.

    Checked  tests/tethered_deorbit/test_nodes.py
    """
    for i in range(3):
        out[0][i] = -state[6 + i]
        out[1][i] = -state[9 + i]
        out[2][i] = 0.0
        out[3][i] = 0.0


@view
def as_it_is(record: Any, state: Array, elapsed: float) -> Array:
    """The state of a step: for points it has no coordinates of its own.

    Checked  tests/tethered_deorbit/test_macro_step.py
    """
    return state


@view
def as_it_was(record: Any, state: Array) -> Array:
    """The same.

    Checked  tests/tethered_deorbit/test_macro_step.py
    """
    return state


@view
def rate_as_it_is(record: Any, state: Array, rate: Array) -> Array:
    """And its rate.

    Checked  tests/tethered_deorbit/test_macro_step.py
    """
    return rate


def make_points(interface: Interface) -> Bodies:
    """The kernels for a record of this interface."""
    separation_slot = interface.references["start.separation"]

    @kernel
    def place(record: Any, state: Array, longest: float) -> int:
        """Fault of a start whose line has no length, or more than it may [m], or 0; what is handed over is as it is.

        Checked  tests/tethered_deorbit/test_robust.py, test_attachment.py: what starts stretched is refused
        """
        r = record[0]
        if r.start_condition == HANDED_OVER:
            return 0
        length = line_length(record, r.start_separation)
        if not length > 0.0:
            return blame(record, BAD_PARAMETER, separation_slot, r.start_separation)
        return blame(record, START_STRETCHED, separation_slot, r.start_separation) if length > longest else 0

    return Bodies(
        begin=begin,
        place=place,
        move=nothing,
        stand=nothing,
        measure=line,
        line=line,
        along=along,
        second=second,
        pull=pull,
        add_turning=nothing,
        turn_back=nothing,
        rest=nothing,
        enter=nothing,
        go_on=nothing,
        seen=as_it_is,
        felt=as_it_is,
        last_seen=as_it_was,
        seen_rate=rate_as_it_is,
        enter_rate=nothing,
        longest=no_end,
        squared_error=zero,
        pace=pace,
        square_across=square_across,
        moved_mass=moved_mass,
        mass_now=mass_now,
        publish=nothing,
        energy=zero,
        differentiate=zero,
        ends=ends,
    )
