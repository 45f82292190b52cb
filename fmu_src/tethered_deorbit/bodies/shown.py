"""What is seen of a body that turns: attitude and rate, angular momentum and energy, and how fast they change."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

from fmu_src.tethered_deorbit.layout import ATTITUDE
from orbital.kernel import kernel
from orbital.rotations import normalise, to_matrix_of_any_length
from orbital.vectors import Array, cross, dot, matrix_vector, transposed_matrix_vector


class Shown(NamedTuple):
    """Kernels: see `rigid.Rigid`."""

    publish: Callable[..., Any]
    energy: Callable[..., Any]
    differentiate: Callable[..., Any]


def make_shown(role: str, first: int) -> Shown:
    """The kernels of one body, "target" or "chaser", whose attitude begins at a place in the state.

    Checked  tests/tethered_deorbit/test_rigid.py
    """
    gradient = f"{role}_gravity_gradient"
    inertia, turned, arms = (f"state_{role}_{name}" for name in ("inertia", "turned", "arms"))
    shown, shown_rate, spin, spin_energy = (f"{role}_{name}" for name in ("attitude", "rate", "spin", "spin_energy"))
    rates = tuple(f"rate_{role}_{name}" for name in ("attitude", "rate", "spin", "spin_energy"))
    rate_attitude, rate_rate, rate_spin, rate_energy = rates
    middle, last = first + 4, first + ATTITUDE

    @kernel
    def publish(record: Any, state: Array) -> None:
        """Attitude, rate, angular momentum and energy of the turning; fills the matrix `turned` too.

            H = A I w,   E = w.I w/2

        Checked  tests/tethered_deorbit/test_rigid.py
        """
        r = record[0]
        to_matrix_of_any_length(r[turned], state[first:middle])
        normalise(r[shown], state[first:middle])
        room = r[spin]
        matrix_vector(room, r[inertia], state[middle:last])
        r[spin_energy] = 0.5 * dot(room, state[middle:last])
        matrix_vector(room, r[turned], room)
        for i in range(3):
            r[shown_rate][i] = state[middle + i]

    @kernel
    def energy(record: Any, state: Array, rate_of_frame: float) -> float:
        """What the body's turning adds to the energy of the pair [J], in the frame whose basis is in the record.

            w.I w/2 - n o.A I w + (3/2) n^2 (r.I r - tr I/3),   r and o the axes 1 and 3 of the frame, in the body's

        It is constant on a circular orbit but for what the line does. To be called after `publish`.

        Checked  tests/tethered_deorbit/test_rigid.py
        """
        r = record[0]
        room = r[arms][3]
        transposed_matrix_vector(room, r[turned], r.state_basis[0])
        other = r[arms][4]
        matrix_vector(other, r[inertia], room)
        trace = r[inertia][0, 0] + r[inertia][1, 1] + r[inertia][2, 2]
        tide = r[gradient] * 1.5 * rate_of_frame * rate_of_frame * (dot(room, other) - trace / 3.0)
        matrix_vector(other, r[inertia], state[middle:last])
        turning = 0.5 * dot(other, state[middle:last])
        transposed_matrix_vector(room, r[turned], r.state_basis[2])
        return float(turning - rate_of_frame * dot(room, other) + tide)

    @kernel
    def differentiate(record: Any, state: Array, rate: Array, rate_of_frame: float, change: float) -> float:
        """Rates of what `publish` fills; returns the rate of `energy` [W].

        rate            of the state, along inertial axes
        change          of the frame's rate                      [rad/s^2]

        Checked  tests/tethered_deorbit/test_rigid_outputs.py, against differences
        """
        r = record[0]
        n = rate_of_frame
        momentum, torque, axis, other = r[arms][0], r[arms][1], r[arms][2], r[arms][3]
        w = state[middle:last]
        matrix_vector(momentum, r[inertia], w)
        matrix_vector(torque, r[inertia], rate[middle:last])
        cross(axis, w, momentum)
        for i in range(3):
            torque[i] += axis[i]
            r[rate_rate][i] = rate[middle + i]
        for i in range(4):
            r[rate_attitude][i] = rate[first + i]
        matrix_vector(r[rate_spin], r[turned], torque)
        work = dot(w, torque)
        r[rate_energy] = work
        transposed_matrix_vector(axis, r[turned], r.state_basis[2])
        power = work - n * dot(axis, torque) - change * dot(axis, momentum)
        # rate of axis 1 as the body sees it: n times axis 2 less w x r
        transposed_matrix_vector(axis, r[turned], r.state_basis[0])
        cross(other, axis, w)
        transposed_matrix_vector(torque, r[turned], r.state_basis[1])
        for i in range(3):
            other[i] += n * torque[i]
        matrix_vector(momentum, r[inertia], axis)
        trace = r[inertia][0, 0] + r[inertia][1, 1] + r[inertia][2, 2]
        size = dot(axis, momentum) - trace / 3.0
        power += r[gradient] * (3.0 * n * change * size + 3.0 * n * n * dot(other, momentum))
        return float(power)

    return Shown(publish, energy, differentiate)
