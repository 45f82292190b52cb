"""How a target with a hinged appendage moves: two rigid bodies, a hinge without friction, a spring and a dashpot.

The state is that of a rigid target, place, velocity and angular momentum L of the whole about its centre of mass and
attitude of the rest, and besides the angle q of the hinge and its momentum p. With w the rate of the rest and M the
matrix of the masses, in the axes of the rest,

    (L, p) = M (w, q'),   M = [[J, b], [b, d]]
    J = I1 + I2 + mu (r.r 1 - r r),   b = I2 e + mu r x s,   d = e.I2 e + mu s.s

e is the axis, r goes from the centre of mass of the rest to that of the appendage, s = e x R a is its change with the
angle, a the way from the hinge to the appendage's centre of mass, I2 = R I R' its inertia turned with it, and
mu = m1 m2 / m. Between impulses L stands still in inertial space, and

    p' = dT/dq - k q - c q',   dT/dq = v.(e x I2 v) + mu u.(w x s + q' e x s),   v = w + q' e,   u = w x r + q' s

An impulse J n at a point x from the centre of mass changes L by x x n J and p by g.n J: g is the way of that point per
radian while the centre of mass of the whole and the rest's attitude stand still,

    g = e x (x - h) - (m2/m) s   on the appendage,   g = -(m2/m) s   on the rest

So linear and angular momentum are kept to rounding, whatever the hinge does. The free motion is integrated by the
classical method of Runge and Kutta, order 4, together with what the dashpot takes; cosine and sine of the angle are
integrated too, so that no function is needed whose bits differ between platforms.

Source   Lagrange's equation of the hinge; Kane and Levinson, Dynamics: Theory and Applications (1985)
Checked  tests/net_capture/test_hinge.py
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from fmu_src.interface import fault
from fmu_src.net_capture.hinge.matrix import NUMBER, assemble, derive, find_lean, take_rates, times, turned
from fmu_src.net_capture.hinge.meeting import make_meeting
from fmu_src.net_capture.hinge.numbers import (
    ARM,
    AXIS,
    BODY,
    GIRTH,
    HALF,
    HINGE,
    LIMIT,
    PIECES,
    RADIUS,
    REACH,
    SAMPLES,
    SHARE,
    YIELDS,
)
from orbital.kernel import kernel
from orbital.rotations import normalise, rotate, turn_attitude_back, turn_back
from orbital.vectors import dot

FINE = 0.1
"""Radians, or share of the dashpot's time, that an inner step is long at most."""
FASTEST = 1e5
"""Per second: fastest rate of spring or dashpot that is followed, a million inner steps for every second."""
TOO_FAST = fault(
    "hinge_too_fast",
    "hinge.stiffness",
    f"spring or dashpot of the hinge act within less than {1.0 / FASTEST:g} s on what they hold: their rate [1/s]",
)
TURNS_TOO_FAST = fault(
    "hinge_turns_too_fast",
    "hinge.start_rate",
    f"hinge and rest of the target turn by more than {2.0 * FASTEST:g} rad/s together, too fast to follow: [rad/s]",
)
RECOVERY = 1.0
"""Per second: speed over overshoot at which the hinge comes back to its stop, small against any that it had."""


class Hinge(NamedTuple):
    """Kernels of a target with a hinge; all expect what `settle` has left.

    place(p) -> fault            to angle and rate of the start, with the rest's rate in `target_rate`
    drift(p, frame_rate, h)      turn both bodies by a substep with their momenta held
    measure(p)                   rates and energies from the momenta
    show(p, ahead)               angle and rate, a time on [s]
    extent(p)                    box, sphere and girth that hold the target at any angle
    follow(p, out, number)       move a sample point from where it is at angle 0
    take(p, frame_rate)          rates of now for contact: `target_omega` and `hinge_speed`
    swing(p, arm)                velocity by the hinge of a point of the body that was found nearest, into `hinge_moved`
                                 [m/s]; arm from the centre of mass, frame axes
    along(p, point, direction)   g.n of that point, kept for the impulse [m]
    feel(p, lever)               what 1 N s changes of the speed there, beside 1/m of both [1/kg]; lever in body axes
    push(p, impulse)             give the target that impulse [N s] with the opposite sign, to its rates and the hinge
    along_own(p, vector), along_body(p, vector)   from the body axes to those that the body touched had at angle 0, and
                                 back
    as_drawn(p, point, out)      where that point is with the hinge at angle 0 [m]
    reach(p)                     largest way of a point per radian of the hinge [m]
    largest_share(p)             what an impulse gives at most where it acts, over what it gives the centre of mass [1]
    lean(p, up, given)           give the hinge what a central field gives it; given is 3 mu/r^3 times a time [1/s], up
                                 the way from the field's middle, body axes (3,)
    """

    place: Any
    drift: Any
    measure: Any
    show: Any
    extent: Any
    follow: Any
    take: Any
    swing: Any
    along: Any
    feel: Any
    push: Any
    along_own: Any
    along_body: Any
    as_drawn: Any
    reach: Any
    largest_share: Any
    lean: Any


def make_hinge(composition: Any, touched: Any, close_round: Any) -> Hinge:
    """Kernels for the composition's target.

    touched      kernel of its shape: whether the point of the surface found last belongs to the appendage
    close_round  kernel of its shape: the box that holds pieces as they are now
    """
    too_fast, turns_too_fast = composition.code(TOO_FAST.name), composition.code(TURNS_TOO_FAST.name)
    body_of, pieces_of = composition.table(BODY), composition.table("target.pieces")

    @kernel
    def settle(p):
        """All that depends on the angle: the matrix of the masses, rates, and where the pieces are.

        Checked  tests/net_capture/test_hinge.py
        """
        body, y = body_of(p), p.hinge_now
        rows, at, arm = pieces_of(p), p.hinge_room[5], p.hinge_room[6]
        axis = body[AXIS : AXIS + 3]
        c, s = y[4], y[5]
        assemble(p, body, c, s)
        take_rates(p, p.target_pose, y[7])
        turned(arm, axis, c, s, body[ARM : ARM + 3])
        for i in range(3):
            p.hinge_shift[i] = body[SHARE] * (arm[i] - body[ARM + i])
            p.hinge_recoil[i] = body[SHARE] * p.hinge_room[1][i]
        for k in range(rows.shape[0]):
            row, moved = rows[k], p.hinge_rows[k]
            for i in range(row.shape[0]):
                moved[i] = row[i]
            moved[row.shape[0]] = body[PIECES + k]
            if body[PIECES + k] != 0.0:
                for i in range(3):
                    at[i] = row[5 + i] - body[HINGE + i]
                turned(at, axis, c, s, at)
                for i in range(3):
                    moved[5 + i] = body[HINGE + i] + at[i]
                for j in range(3):
                    for i in range(3):
                        at[i] = row[8 + 3 * i + j]
                    turned(at, axis, c, s, at)
                    for i in range(3):
                        moved[8 + 3 * i + j] = at[i]
            for i in range(3):
                moved[5 + i] -= p.hinge_shift[i]
        close_round(p.half_size, p.hinge_rows[0 : rows.shape[0]])

    @kernel
    def fastest(p):
        """Rate of the spring or the dashpot, whichever is faster, on what the hinge feels now [1/s].

        Checked  tests/net_capture/test_hinge_extremes.py
        """
        light = p.hinge_inverse[3, 3]
        return max(math.sqrt(p.hinge_stiffness * light), p.hinge_damping * light)

    @kernel
    def place(p):
        """Put the hinge to its angle and rate of the start, and give the target the angular momentum of both bodies; a
        fault code or 0.

        Checked  tests/net_capture/test_hinge.py
        """
        body, y, spin = body_of(p), p.hinge_now, p.hinge_room[7]
        y[4] = math.cos(p.hinge_start_angle)
        y[5] = math.sin(p.hinge_start_angle)
        y[6] = p.hinge_start_angle
        y[8] = 0.0
        assemble(p, body, y[4], y[5])
        times(spin, p.hinge_whole, p.target_rate)
        for i in range(3):
            spin[i] += p.hinge_start_rate * p.hinge_coupling[i]
        rotate(p.target_spin, p.target_pose, spin)
        # p = b.w + d q', with d = 1 / (M^-1)_44 + b.J^-1 b
        y[7] = dot(p.hinge_coupling, p.target_rate)
        own = 1.0 / p.hinge_inverse[3, 3] + dot(p.hinge_coupling, p.hinge_eased)
        y[7] += own * p.hinge_start_rate
        settle(p)
        rate = fastest(p)
        if not rate <= (1.0 + 1e-9) * FASTEST:
            p.fault_value = rate
            return too_fast
        rate = math.sqrt(dot(p.target_rate, p.target_rate)) + abs(p.hinge_start_rate)
        if not rate <= 2.0 * FASTEST:
            p.fault_value = rate
            return turns_too_fast
        return 0

    @kernel
    def advance(p, body, h):
        """What is integrated, a time on [s], by one step of order 4.

        Checked  tests/net_capture/test_hinge.py
        """
        y, trial, slope, total = p.hinge_now, p.hinge_steps[0], p.hinge_steps[1], p.hinge_steps[2]
        for i in range(NUMBER):
            trial[i] = y[i]
            total[i] = 0.0
        for stage in range(4):
            derive(p, body, trial, slope)
            weight = 1.0 if stage == 0 or stage == 3 else 2.0
            ahead = h if stage == 2 else 0.5 * h
            for i in range(NUMBER):
                total[i] += weight * slope[i]
                trial[i] = y[i] + ahead * slope[i]
        for i in range(NUMBER):
            y[i] += h / 6.0 * total[i]
        normalise(y[0:4], y[0:4])
        size = math.sqrt(y[4] * y[4] + y[5] * y[5])
        y[4] /= size
        y[5] /= size

    @kernel
    def stop(p, body):
        """At its largest angle the hinge goes no further: an impulse between both bodies, whose loss is booked.

        Checked  tests/net_capture/test_hinge.py
        """
        y, rates = p.hinge_now, p.hinge_rates
        side = 1.0 if y[6] > 0.0 else -1.0
        beyond = side * y[6] - body[LIMIT]
        if beyond <= 0.0 or side * rates[3] <= -RECOVERY * beyond:
            return
        wanted = -side * RECOVERY * beyond
        impulse = (wanted - rates[3]) / p.hinge_inverse[3, 3]
        y[8] -= impulse * 0.5 * (wanted + rates[3])
        y[7] += impulse
        for i in range(4):
            rates[i] += impulse * p.hinge_inverse[i, 3]

    @kernel
    def drift(p, frame_rate, h):
        """Turn both bodies by a substep [s] with their momenta held; attitude and spin are seen in a frame that turns
        about its third axis [rad/s].

        Checked  tests/net_capture/test_hinge.py
        """
        body, y = body_of(p), p.hinge_now
        for i in range(4):
            y[i] = p.target_pose[i]
        take_rates(p, p.target_pose, y[7])
        turning = math.sqrt(dot(p.hinge_rates[0:3], p.hinge_rates[0:3])) + abs(p.hinge_rates[3])
        steps = 1 + int(h * max(fastest(p), turning) / FINE)
        for _ in range(steps):
            advance(p, body, h / steps)
        for i in range(4):
            p.target_pose[i] = y[i]
        turn_attitude_back(p.target_pose, frame_rate * h)
        turn_back(p.target_spin, frame_rate * h)
        settle(p)
        stop(p, body)

    @kernel
    def measure(p):
        """Rates, energies and moments of now, about the body axes of the rest.

        Checked  tests/net_capture/test_hinge.py
        """
        take_rates(p, p.target_pose, p.hinge_now[7])
        rates, spin = p.hinge_rates, p.hinge_room[3]
        energy = 0.5 * p.target_mass * dot(p.target_velocity, p.target_velocity)
        energy += 0.5 * (dot(spin, rates[0:3]) + p.hinge_now[7] * rates[3])
        p.target_energy = energy
        for i in range(3):
            p.target_rate[i] = rates[i]
            p.target_inertia[i] = p.hinge_whole[i, i]
            p.target_products[i] = p.hinge_whole[0 if i < 2 else 1, 1 if i == 0 else 2]
        p.hinge_energy = 0.5 * p.hinge_stiffness * p.hinge_now[6] * p.hinge_now[6]
        p.hinge_loss = p.hinge_now[8]

    @kernel
    def show(p, ahead):
        """Angle and rate of the hinge, a time on [s].

        Checked  tests/net_capture/test_hinge.py
        """
        p.hinge_angle = p.hinge_now[6] + ahead * p.hinge_rates[3]
        p.hinge_rate = p.hinge_rates[3]

    @kernel
    def extent(p):
        """Box, sphere and girth that hold the target at any angle [m].

        Checked  tests/net_capture/test_hinge.py
        """
        body = body_of(p)
        for i in range(3):
            p.half_size[i] = body[HALF + i]
        p.envelope_radius = body[RADIUS]
        p.girth = body[GIRTH]

    @kernel
    def follow(p, out, number):
        """Move a sample point from where it is at angle 0, body axes [m].

        Checked  tests/net_capture/test_hinge.py
        """
        body, y = body_of(p), p.hinge_now
        if body[SAMPLES + number] != 0.0:
            for i in range(3):
                out[i] -= body[HINGE + i]
            turned(out, body[AXIS : AXIS + 3], y[4], y[5], out)
            for i in range(3):
                out[i] += body[HINGE + i]
        for i in range(3):
            out[i] -= p.hinge_shift[i]

    @kernel
    def reach(p):
        """Largest way of a point per radian of the hinge [m], at any angle.

        Checked  tests/net_capture/test_hinge.py
        """
        return body_of(p)[REACH]

    @kernel
    def largest_share(p):
        """What an impulse gives the point at which it acts at most, over what it gives the centre of mass [1].

        Checked  tests/net_capture/test_hinge.py
        """
        return body_of(p)[YIELDS]

    @kernel
    def lean(p, up, given):
        """Give the hinge what a central field gives it, at the angle of now.

        Checked  tests/net_capture/test_hinged_gradient.py
        """
        p.hinge_now[7] += given * find_lean(p, body_of(p), up)

    meeting = make_meeting(composition, touched)
    return Hinge(place, drift, measure, show, extent, follow, *meeting, reach, largest_share, lean)
