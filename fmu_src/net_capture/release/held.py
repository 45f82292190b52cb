"""Bullets that leave each in its own way: faster or slower, off their direction, late, or not at all.

A bullet that has not left stays where it is in the chaser. Both are then one body with one velocity: after each substep
the velocities of chaser and held bullets are made that of their common momentum,

    v = (M v_c + sum m_i u_i) / (M + sum m_i)

so that what threads pull at a held bullet moves the chaser. That is the leapfrog of the joined body, and takes no
energy. When it leaves it gets its velocity relative to the chaser, and all that stays behind the opposite impulse.

Valid    a chaser whose attitude is held: the torque of the pull at the bullet's place is booked, and turns nothing
Source   ours
Checked  tests/net_capture/test_ejection.py
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from fmu_src.interface import fault
from fmu_src.net_capture.planes import MASS, SHOWN, SHOWN_BACK, SHOWN_RATE, P, U, X
from orbital.kernel import kernel

SCHEME = "leapfrog"
"""That knows bullets which are held."""
NO_WAY_OUT = fault(
    "no_way_out", "ejection.speed_error[1]", "a bullet has no speed along the shot; the value is that of the first such"
)
NONE_LEAVES = fault("none_leaves", "ejection.stays[1]", "every bullet stays; the net would never leave")
HELD_AND_TURNING = fault(
    "held_and_turning",
    "ejection.delay[1]",
    "a bullet that leaves late or stays cannot go with a net or chaser that turns",
)


class Ejection(NamedTuple):
    """Kernels of bullets that leave each in its own way.

    check(p)                 a fault code of values that make no shot, or 0
    fastest(p)               largest speed of a bullet [m/s]
    aim(p, work)             the velocity of each bullet relative to the chaser; those that leave at once have it
    start(p, work)           book what has left, and join what is held to the chaser
    wake(p, work)            rows of held bullets stay awake
    hold(p, work, before)    one velocity for chaser and held bullets; `before` is that of a substep ago [m/s]
    carry(p, work)           held bullets to their places in the chaser
    count_due(p)             how many leave now [1]
    fire(p, work)            bullets whose time has come leave
    show(p, work)            chaser and held bullets as shown
    """

    check: Any
    fastest: Any
    aim: Any
    start: Any
    wake: Any
    hold: Any
    carry: Any
    count_due: Any
    fire: Any
    show: Any


def make(composition: Any) -> Ejection:
    """Kernels for the composition's bullets."""
    if composition.terms["solver"] != SCHEME:
        raise ValueError(f"net_capture: ejection needs solver = {SCHEME!r}")
    if composition.terms["ejection"] != composition.terms["bullets"]:
        raise ValueError("net_capture: ejection is for another number of bullets")
    memory, rouse, now = composition.memory, composition.rouse, composition.clock.now
    node_plane, bullets = memory.node_plane, memory.bullets
    turns = composition.spin is not None
    is_turning = composition.spin.is_turning if turns else None
    no_way_out, none_leaves, held_and_turning = (
        composition.code(f.name) for f in (NO_WAY_OUT, NONE_LEAVES, HELD_AND_TURNING)
    )

    @kernel
    def speed_of(p, bullet):
        """Of a bullet [m/s].

        Checked  tests/net_capture/test_ejection.py
        """
        return p.bullets_speed + p.ejection_speed_error[bullet]

    @kernel
    def is_late(p, bullet):
        """Whether a bullet does not leave with the others.

        Checked  tests/net_capture/test_ejection.py
        """
        return p.ejection_stays[bullet] != 0 or p.ejection_delay[bullet] > 0.0

    @kernel
    def check(p):
        """A fault code of values that make no shot, or 0.

        Checked  tests/net_capture/test_ejection.py
        """
        leave = 0
        late = 0
        for i in range(p.net_corners):
            leave += 1 - p.ejection_stays[i]
            late += 1 if is_late(p, i) else 0
            if speed_of(p, i) < 0.0 or math.cos(p.bullets_angle + p.ejection_angle_error[i]) < 0.0:
                p.fault_value = p.ejection_speed_error[i]
                return no_way_out
        if leave == 0:
            p.fault_value = 1.0
            return none_leaves
        if turns:
            if late > 0 and is_turning(p):
                p.fault_value = p.ejection_delay[0]
                return held_and_turning
        return 0

    @kernel
    def fastest(p):
        """Largest speed of a bullet [m/s].

        Checked  tests/net_capture/test_ejection.py
        """
        most = 0.0
        for i in range(p.net_corners):
            most = max(most, speed_of(p, i))
        return most

    @kernel
    def aim(p, work):
        """Velocities relative to the chaser [m/s].

            v (cos a axis + sin a (cos b out + sin b side)),   side = axis x out

        v, a, b   speed, angle from the shot axis and turn about it from the bullet's diagonal `out`, with their errors

        Checked  tests/net_capture/test_ejection.py
        """
        for i in range(p.net_corners):
            node = bullets(p, work)[i]
            along = 1.0 * node_plane(p, work, SHOWN)[node]
            across = 1.0 * node_plane(p, work, SHOWN + 1)[node]
            diagonal = math.sqrt(along * along + across * across)
            c = math.cos(p.ejection_side_angle[i])
            s = math.sin(p.ejection_side_angle[i])
            angle = p.bullets_angle + p.ejection_angle_error[i]
            forward = speed_of(p, i) * math.cos(angle)
            outward = speed_of(p, i) * math.sin(angle)
            for axis in range(3):
                away = (c * along - s * across) * p.axes[axis] + (c * across + s * along) * p.axes[3 + axis]
                away /= diagonal
                p.ejection_velocity[i, axis] = forward * p.axes[6 + axis] + outward * away
                p.ejection_place[i, axis] = node_plane(p, work, X + axis)[node] - p.chaser_start_position[axis]
            p.ejection_held[i] = 1 if is_late(p, i) else 0
            p.ejection_left[i] = -1.0 if is_late(p, i) else 0.0
            if not is_late(p, i):
                for axis in range(3):
                    node_plane(p, work, U + axis)[node] += p.ejection_velocity[i, axis]

    @kernel
    def add_turn(turned, place, impulse):
        """What an impulse [N s] that the chaser takes at a bullet's place turns it by [N m s].

        Checked  tests/net_capture/test_ejection.py
        """
        turned[0] += place[1] * impulse[2] - place[2] * impulse[1]
        turned[1] += place[2] * impulse[0] - place[0] * impulse[2]
        turned[2] += place[0] * impulse[1] - place[1] * impulse[0]

    @kernel
    def stay_behind(p, work):
        """Mass of the chaser with what it holds [kg].

        Checked  tests/net_capture/test_ejection.py
        """
        mass = p.chaser_mass
        for i in range(p.net_corners):
            if p.ejection_held[i] != 0:
                mass += node_plane(p, work, MASS)[bullets(p, work)[i]]
        return mass

    @kernel
    def book(p, work, bullet):
        """Impulse of a bullet that leaves, added to `ejection_given` [N s], its work and its turn.

        Checked  tests/net_capture/test_ejection.py
        """
        mass = 1.0 * node_plane(p, work, MASS)[bullets(p, work)[bullet]]
        taken = p.scratch[3:6]
        for axis in range(3):
            taken[axis] = -mass * p.ejection_velocity[bullet, axis]
            p.ejection_given[axis] -= taken[axis]
            p.ejection_work += 0.5 * mass * p.ejection_velocity[bullet, axis] ** 2
        add_turn(p.chaser_turned, p.ejection_place[bullet], taken)

    @kernel
    def book_recoil(p, work):
        """Work on what stays behind: the velocity before takes none of it, since bullets and recoil cancel there.

        Checked  tests/net_capture/test_ejection.py
        """
        for axis in range(3):
            p.ejection_work += 0.5 * p.ejection_given[axis] ** 2 / stay_behind(p, work)

    @kernel
    def start(p, work):
        """Book what has left, and join what is held to the chaser, which has the recoil.

        Checked  tests/net_capture/test_ejection.py
        """
        p.ejection_work = 0.0
        for axis in range(3):
            p.ejection_given[axis] = 0.0
        for i in range(p.net_corners):
            if p.ejection_held[i] == 0:
                book(p, work, i)
        book_recoil(p, work)
        join(p, work, p.chaser_drift, U, p.chaser_turned)
        for i in range(p.net_corners):
            if p.ejection_held[i] != 0:
                for axis in range(3):
                    node_plane(p, work, P + axis)[bullets(p, work)[i]] = p.chaser_drift[axis]

    @kernel
    def join(p, work, velocity, rate, turned):
        """One velocity for the chaser and the bullets it holds, whose velocities stand in the planes from `rate` on.

        turned    takes the turn of the impulses between them [N m s]

        Checked  tests/net_capture/test_ejection.py
        """
        mass = stay_behind(p, work)
        common = p.scratch[6:9]
        for axis in range(3):
            common[axis] = p.chaser_mass * velocity[axis] / mass
            for i in range(p.net_corners):
                if p.ejection_held[i] != 0:
                    node = bullets(p, work)[i]
                    share = node_plane(p, work, MASS)[node] / mass
                    common[axis] += share * node_plane(p, work, rate + axis)[node]
        for i in range(p.net_corners):
            if p.ejection_held[i] != 0:
                node = bullets(p, work)[i]
                weight = 1.0 * node_plane(p, work, MASS)[node]
                taken = p.scratch[3:6]
                for axis in range(3):
                    taken[axis] = weight * (node_plane(p, work, rate + axis)[node] - common[axis])
                    node_plane(p, work, rate + axis)[node] = common[axis]
                add_turn(turned, p.ejection_place[i], taken)
        for axis in range(3):
            velocity[axis] = common[axis]

    @kernel
    def wake(p, work):
        """Rows of held bullets stay awake.

        Checked  tests/net_capture/test_ejection.py
        """
        for i in range(p.net_corners):
            if p.ejection_held[i] != 0:
                rouse(p, work, bullets(p, work)[i])

    @kernel
    def hold(p, work, before):
        """One velocity for chaser and held bullets, and the one that dashpots see: half a substep on.

        Checked  tests/net_capture/test_ejection.py
        """
        join(p, work, p.chaser_drift, U, p.chaser_turned)
        for i in range(p.net_corners):
            if p.ejection_held[i] != 0:
                node = bullets(p, work)[i]
                for axis in range(3):
                    onward = p.chaser_drift[axis] + 0.5 * (p.chaser_drift[axis] - before[axis])
                    node_plane(p, work, P + axis)[node] = onward

    @kernel
    def carry(p, work):
        """Held bullets to their places in the chaser.

        Checked  tests/net_capture/test_ejection.py
        """
        for i in range(p.net_corners):
            if p.ejection_held[i] != 0:
                for axis in range(3):
                    place = p.chaser_place[axis] + p.ejection_place[i, axis]
                    node_plane(p, work, X + axis)[bullets(p, work)[i]] = place

    @kernel
    def is_due(p, bullet):
        """Whether a bullet leaves now, at the grid point next to its delay.

        Checked  tests/net_capture/test_ejection.py
        """
        held = p.ejection_held[bullet] != 0 and p.ejection_stays[bullet] == 0
        return held and now(p) + 0.5 * p.solver_substep > p.ejection_delay[bullet]

    @kernel
    def count_due(p):
        """How many leave now [1].

        Checked  tests/net_capture/test_ejection.py
        """
        due = 0
        for i in range(p.net_corners):
            due += 1 if is_due(p, i) else 0
        return due

    @kernel
    def fire(p, work):
        """Bullets whose time has come leave, all of one instant at the same velocity of the chaser.

        Checked  tests/net_capture/test_ejection.py
        """
        for axis in range(3):
            p.ejection_given[axis] = 0.0
        for i in range(p.net_corners):
            if is_due(p, i):
                node = bullets(p, work)[i]
                p.ejection_held[i] = 0
                p.ejection_left[i] = now(p)
                for axis in range(3):
                    node_plane(p, work, U + axis)[node] += p.ejection_velocity[i, axis]
                    node_plane(p, work, P + axis)[node] += p.ejection_velocity[i, axis]
                book(p, work, i)
        book_recoil(p, work)
        before = p.scratch[0:3]
        for axis in range(3):
            before[axis] = p.chaser_drift[axis]
            p.chaser_drift[axis] -= p.ejection_given[axis] / p.chaser_mass
        join(p, work, p.chaser_drift, U, p.chaser_turned)
        for i in range(p.net_corners):
            if p.ejection_held[i] != 0:
                for axis in range(3):
                    change = p.chaser_drift[axis] - before[axis]
                    node_plane(p, work, P + axis)[bullets(p, work)[i]] += change

    @kernel
    def show(p, work):
        """Chaser and held bullets as shown, with one velocity; what is shown goes on as the chaser does.

        Checked  tests/net_capture/test_ejection.py
        """
        join(p, work, p.chaser_velocity, SHOWN_RATE, p.chaser_spin)
        for i in range(p.net_corners):
            if p.ejection_held[i] != 0:
                for axis in range(3):
                    node_plane(p, work, SHOWN_BACK + axis)[bullets(p, work)[i]] = p.chaser_drift[axis]

    return Ejection(check, fastest, aim, start, wake, hold, carry, count_due, fire, show)
