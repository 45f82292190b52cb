"""Where the line leaves a body that turns: how it moves with the body, and what the line's pull there does to it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

from fmu_src.tethered_deorbit.bodies.wrapping import Wrapping
from fmu_src.tethered_deorbit.idle import nothing
from fmu_src.tethered_deorbit.layout import ATTITUDE
from orbital.kernel import kernel
from orbital.rigid import point_acceleration, point_velocity
from orbital.vectors import Array, add_scaled, cross, dot, matrix_vector, transposed_matrix_vector


class Arm(NamedTuple):
    """Kernels of the same names as in `rigid.Rigid`."""

    reach: Callable[..., Any]
    reach_acceleration: Callable[..., Any]
    relief: Callable[..., Any]
    set_pivot: Callable[..., Any]
    show_way: Callable[..., Any]
    ease: Callable[..., Any]
    give: Callable[..., Any]
    pull: Callable[..., Any]


def make_arm(role: str, first: int, sign: float, wrapping: Wrapping) -> Arm:
    """The kernels of one body; arguments as of `rigid.make_rigid`.

    Checked  tests/tethered_deorbit/test_rigid.py
    """
    leaving, follow = wrapping.leaving or f"{role}_attachment", wrapping.follow
    slide, slides, show_rates, pivot = wrapping.relief, wrapping.slides, wrapping.differentiate, wrapping.pivot
    inverse, turned, arms = (f"state_{role}_{name}" for name in ("inverse", "turned", "arms"))
    middle, last = first + 4, first + ATTITUDE

    @kernel
    def seek(record: Any, vector: Array, whole: bool) -> None:
        """The way of the line round the body to the other's end, from that of its vector which is the other's [m].

        Checked  tests/tethered_deorbit/test_wrapping.py
        """
        r = record[0]
        room = r[arms][2]
        transposed_matrix_vector(room, r[turned], vector)
        for i in range(3):
            room[i] *= -sign
        follow(record, room, whole)

    seek_way = seek if wrapping.leaving else nothing

    @kernel
    def reach(record: Any, state: Array, vector: Array, velocity: Array, whole: bool) -> None:
        """Add where the line leaves the body, and its rate, from the centre of mass; after `stand`: see `Rigid`.

            b = A a,   b' = A (w x a),   a the attachment, or where a line that wraps round the body leaves it

        Checked  tests/tethered_deorbit/test_rigid.py
        """
        r = record[0]
        seek_way(record, vector, whole)
        matrix_vector(r[arms][0], r[turned], r[leaving])
        point_velocity(r[arms][1], r[turned], state[middle:last], r[leaving])
        add_scaled(vector, vector, sign, r[arms][0])
        add_scaled(velocity, velocity, sign, r[arms][1])

    @kernel
    def reach_acceleration(record: Any, state: Array, rate: Array, out: Array) -> None:
        """Add the second derivative of the attachment, inertial [m/s^2]; after `reach`.

        Checked  tests/tethered_deorbit/test_rigid.py
        """
        r = record[0]
        point_acceleration(r[arms][2], r[turned], state[middle:last], rate[middle:last], r[leaving])
        add_scaled(out, out, sign, r[arms][2])

    @kernel
    def ease(record: Any, vector: Array) -> float:
        """What the body's turning adds to the inverse of the mass that the line has to move [1/kg]; after `reach`.

            (a x n).I^-1 (a x n)

        vector      along the line, of any length but zero       (3,)

        Source   impulse on a free rigid body
        Checked  tests/tethered_deorbit/test_rigid.py: an off-centre snap
        """
        r = record[0]
        lever, turned_by = r[arms][2], r[arms][3]
        transposed_matrix_vector(lever, r[turned], vector)
        cross(lever, r[leaving], lever)
        matrix_vector(turned_by, r[inverse], lever)
        return dot(lever, turned_by) / dot(vector, vector)

    @kernel
    def give(record: Any, vector: Array, out: Array) -> None:
        """Add how the attachment gives way to a pull along a vector [1/kg], by the body's turning; after `reach`.

            A ((I^-1 (a x n)) x a)

        vector      n       along the line                       (3,)

        Source   impulse on a free rigid body
        Checked  tests/tethered_deorbit/test_across.py
        """
        r = record[0]
        lever, turned_by = r[arms][2], r[arms][3]
        transposed_matrix_vector(lever, r[turned], vector)
        cross(lever, r[leaving], lever)
        matrix_vector(turned_by, r[inverse], lever)
        cross(lever, turned_by, r[leaving])
        matrix_vector(turned_by, r[turned], lever)
        add_scaled(out, out, 1.0, turned_by)

    @kernel
    def pull(record: Any, state: Array, rate: Array, x: float, y: float, z: float) -> None:
        """Add what a force at the attachment does to the body rate [rad/s^2]; `turned` must be that of the state.

            w' += I^-1 (a x A^T F),   F the force on this body

        x, y, z     the force on the chaser                      [N]

        Checked  tests/tethered_deorbit/test_rigid.py
        """
        r = record[0]
        room = r[arms][2]
        room[0] = -sign * x
        room[1] = -sign * y
        room[2] = -sign * z
        transposed_matrix_vector(room, r[turned], room)
        cross(room, r[leaving], room)
        matrix_vector(room, r[inverse], room)
        for i in range(3):
            rate[middle + i] += room[i]

    @kernel
    def parts(record: Any, state: Array, vector: Array, velocity: Array) -> None:
        """The rate of the line's far end as the body sees it, after `reach`: the part along the line, in `arms[2]`, and
        that across it, in `arms[3]`.

            w = -A^T d' + w_b x A^T d

        Checked  tests/tethered_deorbit/test_wrapping.py, against differences
        """
        r = record[0]
        along, across = r[arms][2], r[arms][3]
        transposed_matrix_vector(along, r[turned], vector)
        transposed_matrix_vector(r[arms][4], r[turned], velocity)
        cross(across, state[middle:last], along)
        add_scaled(across, across, -1.0, r[arms][4])
        square = dot(along, along)
        part = dot(across, along) / square if square > 0.0 else 0.0
        for i in range(3):
            along[i] *= part
            across[i] -= along[i]

    @kernel
    def relief(record: Any, state: Array, vector: Array, velocity: Array) -> float:
        """What the line's sliding over the body takes off the second derivative of its length [m/s^2]; after `reach`.

        Checked  tests/tethered_deorbit/test_wrapping.py, against differences
        """
        if not slides(record):
            return 0.0
        parts(record, state, vector, velocity)
        return float(slide(record, record[0][arms][3]))

    @kernel
    def set_pivot(record: Any, state: Array, vector: Array, velocity: Array) -> None:
        """The point about which the line turns; after `reach`.

        Checked  tests/tethered_deorbit/test_wrapping.py: steps of a line that slides
        """
        parts(record, state, vector, velocity)
        pivot(record, record[0][arms][3])

    @kernel
    def show_way(record: Any, state: Array, vector: Array, velocity: Array) -> None:
        """Rates of what is shown of the way; after `reach`.

        Checked  tests/tethered_deorbit/test_wrapping.py, against differences
        """
        r = record[0]
        parts(record, state, vector, velocity)
        show_rates(record, r[arms][2], r[arms][3])

    return Arm(reach, reach_acceleration, relief, set_pivot, show_way, ease, give, pull)
