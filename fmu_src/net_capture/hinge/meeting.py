"""What an impulse of contact changes of two bodies on a hinge: see `motion`."""

from __future__ import annotations

from typing import Any, NamedTuple

from fmu_src.net_capture.hinge.matrix import take_rates, turned
from fmu_src.net_capture.hinge.numbers import AXIS, BODY, HINGE
from orbital.kernel import kernel
from orbital.vectors import cross, dot


class Meeting(NamedTuple):
    """Kernels of `motion.Hinge` by that name."""

    take: Any
    swing: Any
    along: Any
    feel: Any
    push: Any
    along_own: Any
    along_body: Any
    as_drawn: Any


def make_meeting(composition: Any, touched: Any) -> Meeting:
    """Kernels for the composition's target.

    touched    kernel: whether the point of the surface found last belongs to the appendage
    """
    body_of = composition.table(BODY)

    @kernel
    def take(p, frame_rate):
        """Rate of the rest relative to the frame, frame axes, and that of the hinge [rad/s].

        Checked  tests/net_capture/test_hinged_contact.py
        """
        take_rates(p, p.target_pose, p.hinge_now[7])
        turn = p.target_turn
        for i in range(3):
            p.target_omega[i] = dot(turn[i], p.hinge_rates[0:3])
        p.target_omega[2] -= frame_rate
        p.hinge_speed = p.hinge_rates[3]

    @kernel
    def way(p, point, out):
        """out = way of a point of the body found nearest per radian of the hinge [m], body axes.

        point         from the centre of mass, body axes            [m]  (3,)

        Checked  tests/net_capture/test_hinged_contact.py
        """
        body, from_hinge = body_of(p), p.hinge_room[5]
        for i in range(3):
            out[i] = 0.0
        if touched(p):
            for i in range(3):
                from_hinge[i] = point[i] + p.hinge_shift[i] - body[HINGE + i]
            cross(out, body[AXIS : AXIS + 3], from_hinge)
        for i in range(3):
            out[i] -= p.hinge_recoil[i]

    @kernel
    def swing(p, arm):
        """Velocity that the hinge gives a point of the body found nearest, frame axes [m/s].

        arm           from the centre of mass, frame axes           [m]  (3,)

        Checked  tests/net_capture/test_hinged_contact.py
        """
        point, turn = p.hinge_point, p.target_turn
        for i in range(3):
            point[i] = turn[0, i] * arm[0] + turn[1, i] * arm[1] + turn[2, i] * arm[2]
        way(p, point, p.hinge_room[6])
        for i in range(3):
            p.hinge_moved[i] = p.hinge_speed * dot(turn[i], p.hinge_room[6])

    @kernel
    def along(p, point, direction):
        """Way of a point per radian along a direction, body axes, kept for the impulse [m].

        Checked  tests/net_capture/test_hinged_contact.py
        """
        way(p, point, p.hinge_room[6])
        p.hinge_lever = dot(p.hinge_room[6], direction)
        return p.hinge_lever

    @kernel
    def feel(p, lever):
        """What 1 N s changes of the speed along it by turning and swinging [1/kg]: (l, g.n) . M^-1 (l, g.n).

        lever         l = x x n, body axes                          [m]  (3,)

        Checked  tests/net_capture/test_hinged_contact.py
        """
        gain, inverse = p.hinge_gain, p.hinge_inverse
        for i in range(4):
            gain[i] = inverse[i, 3] * p.hinge_lever
            for j in range(3):
                gain[i] += inverse[i, j] * lever[j]
        return dot(lever, gain[0:3]) + p.hinge_lever * gain[3]

    @kernel
    def push(p, impulse):
        """Give the target an impulse of this size [N s] against the direction that `feel` was asked for, to its rates
        and the hinge's momentum; the momenta of the whole are the law's.

        Checked  tests/net_capture/test_hinged_contact.py
        """
        turn = p.target_turn
        for i in range(3):
            p.target_omega[i] -= impulse * dot(turn[i], p.hinge_gain[0:3])
        p.hinge_speed -= impulse * p.hinge_gain[3]
        p.hinge_now[7] -= impulse * p.hinge_lever

    @kernel
    def along_own(p, vector):
        """A vector of the body axes along the axes that the body touched had at angle 0, in place.

        Checked  tests/net_capture/test_hinged_contact.py
        """
        if touched(p):
            turned(vector, body_of(p)[AXIS : AXIS + 3], p.hinge_now[4], -p.hinge_now[5], vector)

    @kernel
    def along_body(p, vector):
        """The way back of `along_own`, in place.

        Checked  tests/net_capture/test_hinged_contact.py
        """
        if touched(p):
            turned(vector, body_of(p)[AXIS : AXIS + 3], p.hinge_now[4], p.hinge_now[5], vector)

    @kernel
    def as_drawn(p, point, out):
        """out = where a point of the body found nearest is with the hinge at angle 0 [m], body axes (3,).

        point         from the centre of mass, body axes            [m]  (3,)

        Checked  tests/net_capture/test_force_map.py
        """
        body, y = body_of(p), p.hinge_now
        for i in range(3):
            out[i] = point[i] + p.hinge_shift[i]
        if touched(p):
            for i in range(3):
                out[i] -= body[HINGE + i]
            turned(out, body[AXIS : AXIS + 3], y[4], -y[5], out)
            for i in range(3):
                out[i] += body[HINGE + i]

    return Meeting(take, swing, along, feel, push, along_own, along_body, as_drawn)
