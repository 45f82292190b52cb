"""What a winch is asked to do at each sample: a control for each law, and the kernels of the winch with it."""

from __future__ import annotations

import math
from typing import Any

from fmu_src.interface import Interface
from fmu_src.tethered_deorbit.faults import blame
from fmu_src.tethered_deorbit.interface import BAD_SCHEDULE
from fmu_src.tethered_deorbit.law import Reel
from fmu_src.tethered_deorbit.reel_rows import SCHEDULE_POINTS
from fmu_src.tethered_deorbit.sights import Sights
from fmu_src.tethered_deorbit.winch import make_winch
from fmu_src.tethered_deorbit.wound import line
from orbital.kernel import kernel
from orbital.vectors import Array, dot, norm

LENGTH_OFFSET, TENSION_OFFSET = "reel.length_offset", "reel.tension_offset"
"""Inputs: what is added to a length, or to a tension, that is asked for."""
RESPONSE = 3.0
"""Time in which an error of the tension dies out, in samples: with it a loop of the line's frequency omega is stable up
to omega h = 2, whatever its damping (eigenvalues of the sampled loop, tests/tethered_deorbit/test_winding.py)."""
INTEGRAL = 1.0 / 6.0
"""Share of an error that is added up at each sample: it takes off what a steady acceleration of the pair leaves."""
CATCHING = 0.5
"""Share of an error of the length that is made good in a sample; its loop has eigenvalues of size 1/2."""


@kernel
def ready(record: Any) -> int:
    """A control without a memory can always begin."""
    return 0


@kernel
def forget(record: Any) -> int:
    """Nothing has been added up yet.

    Checked  tests/tethered_deorbit/test_winding.py
    """
    r = record[0]
    r.state_added = 0.0
    r.state_cut = 0.0
    return 0


@kernel
def follow(record: Any, length: float, speed: float, tension: float, asked: float) -> float:
    """Rate of winding that lets the line have a tension [m/s].

        v* = l' + (e + I)/(k tau + 2 c),   e = T - T*,   tau = 3 h,   I += e/6;   slack: v* = l' - v_take

    length        l      of the line                             [m]
    speed         l'     of it                                   [m/s]
    tension       T      in it                                   [N]
    asked         T*                                             [N]

    With it s' = l' - v pulls the stretch s = T/k to what is asked. A slack line is taken in at a rate of its own, which
    comes to a snap of at most v_take sqrt(k m_r). While a limit holds the motor nothing is added up.

    Valid    omega h < 2, omega the frequency of the pair on its line
    Source   ours: a proportional and integral control of the tension by the rate of the motor
    Checked  tests/tethered_deorbit/test_winding.py: eigenvalues of the loop; a tension that is held
    """
    r = record[0]
    if not r.state_taut:
        r.state_added = 0.0
        return float(speed - r.reel_take_up)
    error = tension - asked
    if r.state_cut == 0.0:
        r.state_added = min(max(r.state_added + INTEGRAL * error, -asked), asked)
    _, _, _, stiffness, damping = line(record, 0.0)
    return float(speed + (error + r.state_added) / (stiffness * RESPONSE * r.reel_sample_time + 2.0 * damping))


def make_constant_tension(interface: Interface, sights: Sights) -> Reel:
    """A winch that holds a tension: `follow`, with T* = reel.held_tension.

    Valid    as `follow`
    Checked  tests/tethered_deorbit/test_winding.py
    """

    @kernel
    def want(record: Any, state: Array, length: float, speed: float, tension: float, time: float) -> float:
        """Rate asked for [m/s]: see `follow`.

        Checked  tests/tethered_deorbit/test_winding.py
        """
        return float(follow(record, length, speed, tension, record[0].reel_held_tension + record[0].state_command))

    return make_winch(interface, sights, TENSION_OFFSET, want, forget)


def make_detumble(interface: Interface, sights: Sights) -> Reel:
    """A winch by which the line takes energy out of the target's spin.

        T* = T_soft + (T_hard - T_soft) min(max(1/2 + l'/(2 v_b), 0), 1)

    The pull is hard while the line lengthens and soft while it shortens, and in between within v_b. As long as the
    chaser hardly moves, the line lengthens because its attachment on the target recedes, and takes (T_hard - T_soft)
    times the way of that out of the spin at each turn; what is left swings like a pendulum, and is damped by the same.
    Spin about the line itself stays. Of the chaser's drift the law takes too: a thrust between m_c/m_r T_soft and
    m_c/m_r T_hard away from the target holds it off.

    Valid    as `follow`; samples short against a turn of the target
    Source   ours: against any mean tension T_m the work (T - T_m) l' is taken from the motion
    Checked  tests/tethered_deorbit/test_winding.py: angular momentum goes from spin to orbit, the sum is kept
    """
    spin = sights.spin

    @kernel
    def begin(record: Any) -> int:
        """Nothing has been added up, and the target not been calmed.

        Checked  tests/tethered_deorbit/test_winding.py
        """
        record[0].reel_calmed = 0.0
        record[0].state_calmed = 0
        return int(forget(record))

    @kernel
    def want(record: Any, state: Array, length: float, speed: float, tension: float, time: float) -> float:
        """Rate asked for [m/s]: see `follow`.

        Checked  tests/tethered_deorbit/test_winding.py
        """
        r = record[0]
        calm = spin >= 0 and norm(state[spin : spin + 3]) < r.reel_spin_goal
        if calm and r.state_calmed == 0:
            r.reel_calmed = time
        if not calm:
            r.reel_calmed = 0.0
        r.state_calmed = 1 if calm else 0
        share = min(max(0.5 + 0.5 * speed / r.reel_blend_rate, 0.0), 1.0)
        asked = r.reel_tension_nearing + share * (r.reel_tension_receding - r.reel_tension_nearing)
        return float(follow(record, length, speed, tension, asked + r.state_command))

    return make_winch(interface, sights, TENSION_OFFSET, want, begin)


def make_schedule(interface: Interface, sights: Sights) -> Reel:
    """A winch that keeps to a table of lengths against time.

        v* = (S(t + 2h) - S(t + h))/h + (S(t) - L)/(2 h)

    S is linear between the points of the table, and constant before and behind them; the offset is added to it.

    Valid    within the limits of the motor
    Source   ours; the loop has z^2 - (3/4) z + 1/4 = 0, so that an error halves in a sample
    Checked  tests/tethered_deorbit/test_winding.py
    """
    times_slot = interface.references["reel.schedule_time[1]"]

    @kernel
    def begin(record: Any) -> int:
        """Fault of a table whose times do not increase, or 0. What repeats the last point is no point.

        Checked  tests/tethered_deorbit/test_winding.py: refusals
        """
        r = record[0]
        points = SCHEDULE_POINTS
        for k in range(1, SCHEDULE_POINTS):
            j = SCHEDULE_POINTS - k
            if points == j + 1 and r.reel_schedule_time[j] == r.reel_schedule_time[j - 1]:
                points = j
        r.state_points = points
        for k in range(1, points):
            if not r.reel_schedule_time[k] > r.reel_schedule_time[k - 1]:
                return blame(record, BAD_SCHEDULE, times_slot + k, r.reel_schedule_time[k])
        return 0

    @kernel
    def scheduled(record: Any, time: float) -> float:
        """Length that the table has at a time [m].

        Checked  tests/tethered_deorbit/test_winding.py
        """
        r = record[0]
        times, lengths, points = r.reel_schedule_time, r.reel_schedule_length, r.state_points
        if time <= times[0]:
            return float(lengths[0])
        for k in range(1, points):
            if time < times[k]:
                share = (time - times[k - 1]) / (times[k] - times[k - 1])
                return float(lengths[k - 1] + share * (lengths[k] - lengths[k - 1]))
        return float(lengths[points - 1])

    @kernel
    def want(record: Any, state: Array, length: float, speed: float, tension: float, time: float) -> float:
        """Rate asked for [m/s]: the formula of `make_schedule`.

        Checked  tests/tethered_deorbit/test_winding.py
        """
        r = record[0]
        h = r.reel_sample_time
        ahead = (scheduled(record, time + 2.0 * h) - scheduled(record, time + h)) / h
        error = scheduled(record, time) + r.state_command - r.state_rest
        return float(ahead + CATCHING * error / h)

    return make_winch(interface, sights, LENGTH_OFFSET, want, begin)


def make_swing(sights: Sights) -> Any:
    """The kernel (record, state) -> (angle, rate) of the line of centres in the frame [rad], [rad/s]: see
    `Environment`."""
    frame = sights.frame

    @kernel
    def swing(record: Any, state: Array) -> tuple[float, float]:
        """Angle from axis 1 towards axis 2 of the frame, and its rate as seen there.

            phi = atan2(y, x),   phi' = (x v - y u)/(x^2 + y^2) - n

        state         of `layout`, inertial

        Valid    the line not along axis 3
        Checked  tests/tethered_deorbit/test_winding.py
        """
        turning = frame(record, state[0:3], state[3:6])
        basis = record[0].state_basis
        x, y = dot(basis[0], state[6:9]), dot(basis[1], state[6:9])
        u, v = dot(basis[0], state[9:12]), dot(basis[1], state[9:12])
        return math.atan2(y, x), (x * v - y * u) / (x * x + y * y) - turning

    return swing


def make_libration(interface: Interface, sights: Sights) -> Reel:
    """A winch that damps the libration.

        v* = g l phi' (n + phi')/n + r (l_c - L),   slack: v* = 0

    The Coriolis force of a line that lengthens while it swings ahead, and shortens while it swings back, works against
    the swing. The swing's energy per m_r l^2, phi'^2/2 + U(phi), falls by 2 g phi'^2 (n + phi')^2/n, however fast it
    swings or whirls: a small swing of frequency w has the damping ratio g n/w, without thrust g/sqrt(3). The length
    goes by g phi: it needs no room of its own, and r brings it back. A slack line damps nothing.

    Valid    g |phi| < 1, else the line slackens; samples short against the swing; n > 0
    Source   a Lyapunov function, the energy of the swing at the length of now; as Fujii and Ishijima, J. Guidance 12
             (1989) 243, for deployment
    Checked  tests/tethered_deorbit/test_winding.py: the swing's decrement
    """
    swing = make_swing(sights)

    @kernel
    def want(record: Any, state: Array, length: float, speed: float, tension: float, time: float) -> float:
        """Rate asked for [m/s]: the formula of `make_libration`.

        Checked  tests/tethered_deorbit/test_winding.py
        """
        r = record[0]
        _, rate = swing(record, state)
        n = r.state_mean_motion
        if not (r.state_taut and n > 0.0):
            return 0.0
        back = r.reel_return_gain * (r.reel_length + r.state_command - r.state_rest)
        return float(r.reel_swing_gain * length * rate * (n + rate) / n + back)

    return make_winch(interface, sights, LENGTH_OFFSET, want, ready)


def make_sampled_linear(interface: Interface, sights: Sights) -> Reel:
    """A winch by a linear law of the whole state in the plane.

        v* = v - h (k_1 (L - l_c) + k_2 v + k_3 (phi - phi_c) + k_4 phi')

    The law gives the acceleration a = -K x of the motor, constant until the next sample.

    Valid    small motion about what the gains are designed for; a line that is as long as what is wound out
    Source   fmu_src/tethered_deorbit/design.py
    Checked  tests/tethered_deorbit/test_winding.py: decay by the poles of the sampled loop
    """
    swing = make_swing(sights)

    @kernel
    def want(record: Any, state: Array, length: float, speed: float, tension: float, time: float) -> float:
        """Rate asked for [m/s]: the formula of `make_sampled_linear`.

        Checked  tests/tethered_deorbit/test_winding.py
        """
        r = record[0]
        angle, rate = swing(record, state)
        off = angle - r.reel_angle
        pull = r.reel_winding_length_gain * (r.state_rest - r.reel_length - r.state_command)
        pull += r.reel_winding_rate_gain * r.state_winding
        pull += r.reel_winding_angle_gain * math.atan2(math.sin(off), math.cos(off))
        pull += r.reel_winding_angle_rate_gain * rate
        return float(r.state_winding - r.reel_sample_time * pull)

    return make_winch(interface, sights, LENGTH_OFFSET, want, ready)
