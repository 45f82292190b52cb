"""The chaser's attitude control: wheels that hold it, with the torque and the momentum that they have."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

from fmu_src.interface import Interface
from fmu_src.tethered_deorbit.faults import blame
from fmu_src.tethered_deorbit.idle import no_fault, nothing
from fmu_src.tethered_deorbit.interface import NO_ATTITUDE
from fmu_src.tethered_deorbit.layout import ATTITUDE, PAIR, StateLayout
from orbital.kernel import kernel
from orbital.rotations import conjugate, from_matrix, from_rotation_vector, multiply, rotate_inverse
from orbital.vectors import Array, cross, dot, matrix_vector, norm

ORBITAL, LINE = range(2)
LEAST_TAPER, MOST_TAPER = 0.02, 0.5
"""Shares of the greatest momentum over which the wheels give way as they come to it: a smooth end, not a jump. In
between, as much as the greatest torque adds in 1/w_c, so that they do not give way faster than the loop is."""


class Aocs(NamedTuple):
    """Kernels of the control; as it stands, those of a chaser that has none.

    begin(record, state) -> fault     the attitude of the start is that to be held
    add(record, state, rate, elapsed) the wheels' torque, added to the rate of the state; its axes have turned so long
    publish(record, state)            outputs of its own
    """

    begin: Callable[..., Any] = no_fault
    add: Callable[..., Any] = nothing
    publish: Callable[..., Any] = nothing


def make_aocs(
    terms: Mapping[str, str],
    frame: Callable[..., Any],
    along: Callable[..., Any],
    layout: StateLayout,
    interface: Interface,
) -> Aocs:
    """The kernels of the wheels, if the scene names them.

        u = -I (w_c^2 theta + 2 zeta w_c (w - w_r)),   |u| <= torque limit
        I dw/dt = ... + u - w x h,   dh/dt = -u

    theta is twice the vector of the quaternion from the attitude to be held to that of now, w_r the rate of the orbital
    frame, in which it is held. Where the chaser points along its line, a to its attachment and d along the line,
    theta is d x a over their lengths. h is the momentum of the wheels, body axes. Near the greatest momentum
    they give less and less of what would add to it.

    frame         kernel of the environment: the orbital frame, and its rate
    along         kernel of the bodies: direction of the line at the chaser

    Valid    wheels that turn the chaser about any axis alike
    Source   Wie, Space Vehicle Dynamics and Control (2008), quaternion feedback
    Checked  tests/tethered_deorbit/test_aocs.py
    """
    if "aocs" not in terms:
        return Aocs()
    turns, orbits = terms["chaser"] != "point", terms["environment"] != "none"
    q_at = PAIR + (ATTITUDE if terms["target"] != "point" else 0)
    w_at, h_at = q_at + 4, layout.wheels

    @kernel
    def frame_attitude(record: Any, state: Array, elapsed: float) -> float:
        """Quaternion from the orbital frame's axes to those of the state, in `state.aocs[0]`; returns its rate [rad/s].

        The orbital frame turns with the axes of a step; that of a tow without a field is fixed in space.

        elapsed       for which the axes of the state have turned    [s]

        Checked  tests/tethered_deorbit/test_aocs.py
        """
        r = record[0]
        if not orbits:
            back = r.state_aocs_off[3]
            for i in range(3):
                back[i] = -elapsed * r.state_turning[i]
            from_rotation_vector(r.state_aocs[0], back)
            return 0.0
        rate: float = frame(record, state[0:3], state[3:6])
        from_matrix(r.state_aocs[1], r.state_basis)
        conjugate(r.state_aocs[0], r.state_aocs[1])
        return rate

    @kernel
    def begin(record: Any, state: Array) -> int:
        """Empty wheels, and the attitude of the start relative to the orbital frame as that to be held.

        Checked  tests/tethered_deorbit/test_aocs.py
        """
        r = record[0]
        if not turns:
            return blame(record, NO_ATTITUDE, 0, 0.0)
        for i in range(3):
            state[h_at + i] = 0.0
        frame_attitude(record, state, 0.0)
        conjugate(r.state_aocs[1], r.state_aocs[0])
        multiply(r.state_aocs_held, r.state_aocs[1], state[q_at:w_at])
        return 0

    @kernel
    def deviation(record: Any, state: Array, elapsed: float) -> None:
        """Deviation of the attitude [rad] and of its rate [rad/s] in `state.aocs_off[0]` and `[1]`, body axes.

        Checked  tests/tethered_deorbit/test_aocs.py
        """
        r = record[0]
        off, off_rate, room = r.state_aocs_off[0], r.state_aocs_off[1], r.state_aocs_off[2]
        attitude = state[q_at:w_at]
        turning = frame_attitude(record, state, elapsed)
        for i in range(3):
            room[i] = turning * r.state_basis[2][i] if orbits else 0.0
        rotate_inverse(off_rate, attitude, room)
        for i in range(3):
            off_rate[i] = state[w_at + i] - off_rate[i]
        if r.aocs_points == LINE:
            room[0], room[1], room[2] = along(record, state)
            d = r.state_aocs_off[3]
            rotate_inverse(d, attitude, room)
            a = r.chaser_attachment
            lengths = norm(a) * norm(d)
            # turned towards the line by a x d: the deviation is the other way
            cross(off, d, a)
            for i in range(3):
                off[i] = off[i] / lengths if lengths > 0.0 else 0.0
            return
        multiply(r.state_aocs[1], r.state_aocs[0], r.state_aocs_held)
        conjugate(r.state_aocs[0], r.state_aocs[1])
        multiply(r.state_aocs[1], r.state_aocs[0], attitude)
        sign = 2.0 if r.state_aocs[1][0] >= 0.0 else -2.0
        for i in range(3):
            off[i] = sign * r.state_aocs[1][1 + i]

    @kernel
    def torque(record: Any, state: Array, elapsed: float) -> None:
        """The wheels' torque on the chaser [N m] in `state.aocs_torque`, body axes: see `make_aocs`.

        Checked  tests/tethered_deorbit/test_aocs.py
        """
        r = record[0]
        deviation(record, state, elapsed)
        u, wanted = r.state_aocs_torque, r.state_aocs_off[2]
        pace = r.aocs_frequency
        for i in range(3):
            wanted[i] = -pace * (pace * r.state_aocs_off[0][i] + 2.0 * r.aocs_damping_ratio * r.state_aocs_off[1][i])
        matrix_vector(u, r.state_chaser_inertia, wanted)
        size = norm(u)
        r.state_aocs_asked = size
        if size > r.aocs_torque_limit:
            for i in range(3):
                u[i] *= r.aocs_torque_limit / size
        h = state[h_at : h_at + 3]
        held = norm(h)
        most = r.aocs_momentum_limit
        taper = min(MOST_TAPER * most, max(LEAST_TAPER * most, r.aocs_torque_limit / r.aocs_frequency))
        least = most - taper
        r.state_aocs_full = 0
        if held > least:
            adds = -dot(u, h) / held
            if adds > 0.0:
                refused = min(1.0, (held - least) / taper) * adds / held
                for i in range(3):
                    u[i] += refused * h[i]
                r.state_aocs_full = 1

    @kernel
    def add(record: Any, state: Array, rate: Array, elapsed: float) -> None:
        """Add the torque, and what the wheels' momentum does as the chaser turns.

            w' += I^-1 (u - w x h),   h' = -u

        Checked  tests/tethered_deorbit/test_aocs.py: momentum
        """
        r = record[0]
        torque(record, state, elapsed)
        u, gyro, change = r.state_aocs_torque, r.state_aocs_off[2], r.state_aocs_off[3]
        cross(gyro, state[w_at : w_at + 3], state[h_at : h_at + 3])
        for i in range(3):
            rate[h_at + i] = -u[i]
            gyro[i] = u[i] - gyro[i]
        matrix_vector(change, r.state_chaser_inverse, gyro)
        for i in range(3):
            rate[w_at + i] += change[i]

    @kernel
    def angle(record: Any) -> float:
        """By how much the attitude is off [rad], from 0 to pi; after `deviation`, of which the law takes a sine.

        Checked  tests/tethered_deorbit/test_aocs.py: large angles
        """
        r = record[0]
        off = norm(r.state_aocs_off[0])
        if r.aocs_points == LINE:
            a, d = r.chaser_attachment, r.state_aocs_off[3]
            lengths = norm(a) * norm(d)
            return math.atan2(off, dot(d, a) / lengths) if lengths > 0.0 else 0.0
        return 2.0 * math.atan2(0.5 * off, abs(r.state_aocs[1][0]))

    @kernel
    def publish(record: Any, state: Array) -> None:
        """Torque [N m], momentum [N m s], deviation [rad], and whether either limit holds it back.

        Checked  tests/tethered_deorbit/test_aocs.py
        """
        r = record[0]
        torque(record, state, 0.0)
        for i in range(3):
            r.aocs_torque[i] = r.state_aocs_torque[i]
            r.aocs_momentum[i] = state[h_at + i]
            r.rate_aocs_momentum[i] = -r.state_aocs_torque[i]
        r.aocs_deviation = angle(record)
        r.aocs_limited = r.state_aocs_full == 1 or r.state_aocs_asked > r.aocs_torque_limit

    return Aocs(begin, add, publish)
