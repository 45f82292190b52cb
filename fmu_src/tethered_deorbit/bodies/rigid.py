"""One rigid body: its attitude and rate, the torques on it, and where the line is made fast on it.

The attitude is a quaternion of any length, which is divided out wherever it is used: its equation is linear, so that it
may be set back to unit length between steps, and its rate with it.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

from fmu_src.interface import Interface
from fmu_src.tethered_deorbit.bodies.arm import make_arm
from fmu_src.tethered_deorbit.bodies.carried import Carried, make_carried
from fmu_src.tethered_deorbit.bodies.shown import make_shown
from fmu_src.tethered_deorbit.bodies.wrapping import Wrapping
from fmu_src.tethered_deorbit.body_rows import RATE_FRAMES
from fmu_src.tethered_deorbit.faults import blame
from fmu_src.tethered_deorbit.interface import BAD_ATTITUDE, BAD_INERTIA, BAD_PARAMETER
from fmu_src.tethered_deorbit.layout import ATTITUDE
from orbital.kernel import kernel
from orbital.rigid import (
    euler,
    extreme_moments,
    gradient_torque,
    inertia_matrix,
    invert_symmetric,
)
from orbital.rotations import evenly_turned, from_matrix, multiply, normalise, to_matrix_of_any_length
from orbital.vectors import Array, cross, dot, norm, transposed_matrix_vector

INERTIAL, ORBITAL, LINE = range(len(RATE_FRAMES))
SHARE, TAUT_SHARE = 5e-3, 0.1
"""Error of an attitude in one step, in tolerances of the separation, slack and taut: a spin is kept to 1e-12 through
tugs."""
UNIT = 1e-6
"""By how much the length of an attitude that is given may differ from one."""


class Rigid(NamedTuple):
    """Kernels of one body; vectors without a word on it lie along the axes of the state, which may turn.

    begin(record) -> (1/m, fault)               the most that its turning adds to the inverse of the line's effective
                                                mass [1/kg]
    arm_length(record) -> a                     of the attachment, from the centre of mass [m]
    place(record, state, basis, turning) -> fault   attitude and rate at the start, as given relative to a frame
    stand(record, state)                        the matrix of the attitude; of what follows all but `energy` and
                                                `squared_error` come after it
    move(record, state, rate)                   attitude and rate without the line
    reach(record, state, vector, velocity, whole)   add what the attachment adds to the line's vector, from the
                                                chaser's attachment to the target's [m], and to its rate [m/s]; `whole`
                                                as of `Wrapping.follow`
    reach_acceleration(record, state, rate, out)   and to the rate of that, inertial [m/s^2]; after `reach`
    relief(record, state, vector, velocity) -> l''   what a line that slides over the body takes off l'' [m/s^2]; after
                                                `reach`
    set_pivot(record, state, vector, velocity)  of the way: see `Wrapping`; after `reach`
    show_way(record, state, vector, velocity)   rates of what is shown of its way; after `reach`
    ease(record, vector) -> 1/m                 what its turning adds to the inverse of the mass that a line along this
                                                vector has to move [1/kg]; after `reach`
    give(record, vector, out)                   add how its attachment gives way to a pull [1/kg]; after `reach`
    pull(record, state, rate, x, y, z)          add the torque of the line, a force [N] on the chaser; after `reach`
    add_turning, turn_back, squared_error, energy   as of `Bodies`
    carried                                     coordinates of a step
    publish(record, state)
    differentiate(record, state, rate, turning, change) -> power [W]
    """

    begin: Callable[..., Any]
    arm_length: Callable[..., Any]
    place: Callable[..., Any]
    move: Callable[..., Any]
    stand: Callable[..., Any]
    reach: Callable[..., Any]
    reach_acceleration: Callable[..., Any]
    relief: Callable[..., Any]
    set_pivot: Callable[..., Any]
    show_way: Callable[..., Any]
    ease: Callable[..., Any]
    give: Callable[..., Any]
    pull: Callable[..., Any]
    add_turning: Callable[..., Any]
    turn_back: Callable[..., Any]
    squared_error: Callable[..., Any]
    publish: Callable[..., Any]
    energy: Callable[..., Any]
    differentiate: Callable[..., Any]
    carried: Carried


@kernel
def greatest_relief(room: Array, inverse: Array, arm: Array) -> float:
    """The most that a body's turning adds to the inverse of a line's effective mass, whatever its direction [1/kg].

        greatest eigenvalue of X^T I^-1 X,   X n = a x n

    room                                                         (3 and more, 3)
    inverse       I^-1                                           [1/(kg m2)]  (3, 3)
    arm           a      from the centre of mass                 [m]      (3,)

    Source   impulse on a free rigid body
    Checked  tests/tethered_deorbit/test_rigid.py: an off-centre snap
    """
    for k in range(3):
        # column k of X, turned by the inverse, and back
        x, y, z = (0.0, arm[2], -arm[1]) if k == 0 else ((-arm[2], 0.0, arm[0]) if k == 1 else (arm[1], -arm[0], 0.0))
        u = inverse[0, 0] * x + inverse[0, 1] * y + inverse[0, 2] * z
        v = inverse[1, 0] * x + inverse[1, 1] * y + inverse[1, 2] * z
        w = inverse[2, 0] * x + inverse[2, 1] * y + inverse[2, 2] * z
        room[0, k] = arm[2] * v - arm[1] * w
        room[1, k] = arm[0] * w - arm[2] * u
        room[2, k] = arm[1] * u - arm[0] * v
    _, greatest = extreme_moments(room)
    return float(greatest)


def make_rigid(
    role: str, first: int, sign: float, wrapping: Wrapping, strength_at: Callable[..., Any], interface: Interface
) -> Rigid:
    """The kernels of one body for a record of this interface.

    role        "target" or "chaser", with which the names of its variables begin
    first       place of its attitude in the state
    sign        of its centre in the relative vector: r = R + sign (share of the other's mass) rho
    wrapping    of the line round it
    strength_at kernel of the environment: strength of the field's gradient at a place [1/(m2 s2)]

    Checked  tests/tethered_deorbit/test_rigid.py
    """
    places = interface.references
    inertia_slot, attachment_slot, attitude_slot = (
        places[f"{role}.{name}[1]"] for name in ("inertia", "attachment", "start_attitude")
    )
    mass, share = f"{role}_mass", "state_chaser_share" if role == "target" else "state_target_share"
    moments, attachment = f"{role}_inertia", f"{role}_attachment"
    arm = make_arm(role, first, sign, wrapping)
    carried_point = "state_pivot" if wrapping.leaving else attachment
    start_attitude, start_rate, rate_frame = (
        f"{role}_{name}" for name in ("start_attitude", "start_rate", "rate_frame")
    )
    gradient, attitude = f"{role}_gravity_gradient", f"{role}_attitude"
    inertia, inverse, turned, arms, scale = (
        f"state_{role}_{name}" for name in ("inertia", "inverse", "turned", "arms", "scale")
    )
    shown = make_shown(role, first)
    turn = f"state_{role}_turn"
    middle, last = first + 4, first + ATTITUDE

    @kernel
    def begin(record: Any) -> tuple[float, int]:
        """Inertia and its inverse from the parameters; see `Rigid`.

            1/m <= greatest eigenvalue of X^T I^-1 X,   X n = a x n

        Checked  tests/tethered_deorbit/test_rigid.py
        """
        r = record[0]
        inertia_matrix(r[inertia], r[moments])
        least, greatest = extreme_moments(r[inertia])
        trace = r[moments][0] + r[moments][1] + r[moments][2]
        if not (least > 0.0 and greatest <= 0.5 * trace * (1.0 + 1.0e-9)):
            return 0.0, blame(record, BAD_INERTIA, inertia_slot, r[moments][0])
        invert_symmetric(r[inverse], r[inertia])
        reach = norm(r[attachment])
        if not math.isfinite(reach):
            return 0.0, blame(record, BAD_PARAMETER, attachment_slot, reach)
        r[scale] = max(reach, math.sqrt(greatest / r[mass]))
        return greatest_relief(r[arms], r[inverse], r[attachment]), 0

    @kernel
    def arm_length(record: Any) -> float:
        """Distance of the attachment from the centre of mass [m].

        Checked  tests/tethered_deorbit/test_rigid.py: a linear reel
        """
        return norm(record[0][attachment])

    @kernel
    def place(record: Any, state: Array, basis: Array, turning: float) -> int:
        """Attitude and rate as given, made those of inertial axes; returns 0 or a fault.

            w = w_given + A^T Omega,   Omega = 0, n o or rho x rho'/|rho|^2

        basis       of the frame in which the attitude is given  (3, 3)
        turning     n      its rate about axis 3, o              [rad/s]

        Checked  tests/tethered_deorbit/test_rigid.py
        """
        r = record[0]
        q = state[first:middle]
        rate = state[middle:last]
        given = r[start_attitude]
        length = math.sqrt(given[0] * given[0] + given[1] * given[1] + given[2] * given[2] + given[3] * given[3])
        if not (length == 0.0 or abs(length - 1.0) <= UNIT):
            return blame(record, BAD_ATTITUDE, attitude_slot, given[0])
        normalise(q, given)
        frame = r[attitude]
        from_matrix(frame, basis)
        for i in range(1, 4):
            frame[i] = -frame[i]
        multiply(q, frame, q)
        room = r[arms][0]
        for i in range(3):
            room[i] = turning * basis[2, i] if r[rate_frame] == ORBITAL else 0.0
        square = dot(state[6:9], state[6:9])
        if r[rate_frame] == LINE and square > 0.0:
            cross(room, state[6:9], state[9:12])
            for i in range(3):
                room[i] /= square
        to_matrix_of_any_length(r[turned], q)
        transposed_matrix_vector(room, r[turned], room)
        for i in range(3):
            rate[i] = r[start_rate][i] + room[i]
        return 0

    @kernel
    def move(record: Any, state: Array, rate: Array) -> None:
        """Rate of attitude and body rate without the line [1/s], [rad/s^2]; after `stand`.

            q' = q (0, w)/2,   w' = I^-1 (3 mu/r^5 r x I r - w x I w)

        Source   `orbital.rigid`
        Checked  tests/tethered_deorbit/test_rigid.py, against Jacobi's elliptic functions and scipy
        """
        r = record[0]
        a, b, c, d = state[first], state[first + 1], state[first + 2], state[first + 3]
        x, y, z = 0.5 * state[middle], 0.5 * state[middle + 1], 0.5 * state[middle + 2]
        rate[first] = -b * x - c * y - d * z
        rate[first + 1] = a * x + c * z - d * y
        rate[first + 2] = a * y - b * z + d * x
        rate[first + 3] = a * z + b * y - c * x
        torque = rate[middle:last]
        lever = sign * r[share]
        for i in range(3):
            torque[i] = state[i] + lever * state[6 + i]
        strength = r[gradient] * strength_at(torque)
        transposed_matrix_vector(torque, r[turned], torque)
        gradient_torque(torque, r[inertia], torque, strength)
        euler(torque, r[inertia], r[inverse], state[middle:last], torque)

    @kernel
    def stand(record: Any, state: Array) -> None:
        """The matrix `turned` of this attitude.

        Checked  tests/tethered_deorbit/test_rigid.py
        """
        to_matrix_of_any_length(record[0][turned], state[first:middle])

    @kernel
    def add_turning(record: Any, state: Array, rate: Array, spin_sign: float) -> None:
        """Add what the turning of the axes adds to the rate of the attitude [1/s].

            q' += s (0, w) q/2,   s = -1 into turning axes, 1 back

        Checked  tests/tethered_deorbit/test_rigid.py: axes change nothing
        """
        w = record[0].state_turning
        half = 0.5 * spin_sign
        x, y, z = half * w[0], half * w[1], half * w[2]
        a, b, c, d = state[first], state[first + 1], state[first + 2], state[first + 3]
        rate[first] -= x * b + y * c + z * d
        rate[first + 1] += x * a + y * d - z * c
        rate[first + 2] += y * a + z * b - x * d
        rate[first + 3] += z * a + x * c - y * b

    @kernel
    def turn_back(record: Any, time: float, state: Array) -> None:
        """Attitude along axes at rest, given along axes that have turned for a time [s]; in place.

        Checked  tests/tethered_deorbit/test_rigid.py: axes change nothing
        """
        r = record[0]
        evenly_turned(r[turn], r.state_turning, time)
        multiply(state[first:middle], r[turn], state[first:middle])

    @kernel
    def squared_error(record: Any, state: Array, error: Array) -> float:
        """Square of the size of the errors of attitude and rate, in units of the tolerance [-].

            (2 L |e_q|/tol)^2 + (L |e_w|/(tol p))^2,   L = max(|a|, radius of gyration),   tol = SHARE tol_s,
            p = max(pace, |w|), and while taut the line's frequency

        Checked  tests/tethered_deorbit/test_rigid.py
        """
        r = record[0]
        pace, share = max(r.state_pace, norm(state[middle:last])), SHARE
        if r.state_taut:
            pace, share = max(pace, r.state_frequency), TAUT_SHARE
        square = dot(error[middle:last], error[middle:last]) / (pace * pace)
        for i in range(first, middle):
            square += 4.0 * error[i] * error[i]
        size = r[scale] / (share * r.solver_tolerance_separation)
        return float(size * size * square)

    return Rigid(
        begin=begin,
        arm_length=arm_length,
        place=place,
        move=move,
        stand=stand,
        reach=arm.reach,
        reach_acceleration=arm.reach_acceleration,
        relief=arm.relief,
        set_pivot=arm.set_pivot,
        show_way=arm.show_way,
        ease=arm.ease,
        give=arm.give,
        pull=arm.pull,
        add_turning=add_turning,
        turn_back=turn_back,
        squared_error=squared_error,
        publish=shown.publish,
        energy=shown.energy,
        differentiate=shown.differentiate,
        carried=make_carried(role, first, sign, carried_point),
    )
