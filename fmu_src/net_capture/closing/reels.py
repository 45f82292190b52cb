"""The closing cord drawn in by reels, one at each bullet, whatever turns them: winches or springs.

Each reel runs at its no-load speed less the share of the tension in the force at which it stands still:

    dL/dt = -v0 (1 - T / F(L))   while 0 <= T < F, otherwise 0, or negative too where the reel pays out

A reel that pays out does so at most until its cord is as long as the mouth's side. None winds its pair shorter than the
lock length and a locked one never turns again, so no cord is stiffer than the stability bound reckons with.

What is loose of a cord as the reels start is taken in at once, whatever v0 (`closing.slack = "taken_in"`), or wound by
the same law at no tension, with v0 (`"wound"`).

The book of the cord, T_e = EA (s - L)/L the elastic part of its tension T:

    by the reels     [T + T_e^2 / (2 EA)] (-dL)        by the trapezoidal rule over the substep
    to the dashpots  (T - T_e) (ds - dL)
    stored           EA (s - L)^2 / (2 L)
"""

from __future__ import annotations

from typing import Any, NamedTuple

from fmu_src.interface import fault
from fmu_src.net_capture.closing import Closing
from fmu_src.net_capture.closing.cord import make_cord
from fmu_src.net_capture.closing.part import WOUND
from fmu_src.net_capture.closing.triggers import TRIGGER_CONTACT, TRIGGER_DISTANCE, TRIGGER_TIME
from fmu_src.net_capture.formulas import BREAKING_STRAIN, cord_damping, cord_stiffness
from orbital.kernel import kernel

NEWTON_STEPS = 4
"""Of the winding law at most, from a start that is right to second order."""
NEWTON_ENDS = 1e-9
"""Share of the length by which a step may still change it for the last: the error that is left is its square."""

TOO_MANY_RINGS = fault(
    "too_many_rings", "closing.rings", "closing.rings: a side of the mouth has fewer knots between its bullets"
)


class Drive(NamedTuple):
    """Kernels of what turns the reels.

    force(p, length)     tension at which a reel stands still, with so much cord out [N]
    slope(p, length)     its derivative by that length [N/m]
    pays_out(p)          whether a larger tension draws cord off
    note(p)              what the drive itself tells, of `cord_length`; None where it tells nothing
    """

    force: Any
    slope: Any
    pays_out: Any
    note: Any


@kernel
def cord_energy(p, distance, length):
    """Energy [J] in a cord of this length between points this far apart: EA (s - L)^2 / (2 L).

    Checked  tests/net_capture/test_closing.py
    """
    stretch = distance - length
    return 0.5 * p.closing_axial_stiffness * stretch * stretch / length if stretch > 0.0 else 0.0


@kernel
def cord_tension(stiffness, damping, stretch, rate, speed, stall, yields):
    """Tension [N] of a stretched cord that a reel may be drawing in.

        T = k (s - L) + d (ds/dt - dL/dt),   dL/dt = -v0 (1 - T / F) while the reel turns

    The dashpot works on the cord's own stretch rate, so the reel's law and the tension are solved together.

    stiffness  k        EA / L                                     [N/m]
    damping    d        dashpot of the cord                        [N s/m]
    stretch    s - L    distance of the bullets less cord out      [m]
    rate       ds/dt    of their distance                          [m/s]
    speed      v0       of the reel without load; 0 once locked    [m/s]
    stall      F        tension at which it stands still           [N]
    yields              whether a larger one draws cord off

    Checked  tests/net_capture/test_closing.py
    """
    tension = stiffness * stretch + damping * rate
    if yields or tension < stall:
        tension = (tension + damping * speed) / (1.0 + damping * speed / stall)
    return tension if tension > 0.0 else 0.0


class Laws(NamedTuple):
    """Kernels of one pair's cord, `top` the speed of its reel without load [m/s]: 0 for one that does not turn.

    pull(p, distance, rate, length, most, top) -> tension [N], rate of the length [m/s]
    against(p, distance, rate, length, most, top)   what the reel works against per length wound [N]
    wound(p, distance, rate, length, most, top, winding, h) -> length [m] and its rate [m/s], a substep on
    """

    pull: Any
    against: Any
    wound: Any


def make_laws(drive: Drive) -> Laws:
    """The laws of a cord whose reel a drive turns."""
    force, slope_of, pays_out = drive.force, drive.slope, drive.pays_out

    @kernel
    def pull_of_cord(p, distance, rate, length, most, top):
        """Tension of one pair's cord [N], and the rate of its length [m/s] as the reel turns under it.

        distance, rate   way of the cord from bullet to bullet, and its rate   [m], [m/s]
        length, most     cord out, and the most there can be                   [m]
        top              speed of the reel without load                        [m/s]

        Checked  tests/net_capture/test_closing.py
        """
        speed = top if length > p.closing_lock_length else 0.0
        stall = force(p, length)
        yields = pays_out(p) and speed > 0.0 and length < most
        tension = 0.0
        if distance > length:
            stiffness = cord_stiffness(p.closing_axial_stiffness, length)
            damping = cord_damping(p.closing_damping_ratio, stiffness, p.cord_mass)
            tension = cord_tension(stiffness, damping, distance - length, rate, speed, stall, yields)
        turning = speed * (1.0 - tension / stall)
        return tension, -turning if turning > 0.0 or yields else 0.0

    @kernel
    def against(p, distance, rate, length, most, top):
        """What a reel works against per length wound [N]: T + T_e^2 / (2 EA).

        Checked  tests/net_capture/test_closing.py
        """
        tension, _ = pull_of_cord(p, distance, rate, length, most, top)
        stretch = distance - length
        elastic = p.closing_axial_stiffness * stretch / length if stretch > 0.0 else 0.0
        return tension + 0.5 * elastic * elastic / p.closing_axial_stiffness

    @kernel
    def wound(p, distance, rate, length, most, top, winding, h):
        """Length of a pair's cord one substep on [m], and how fast it then changes [m/s].

            L' = L + h/2 (dL/dt + dL'/dt),   dL'/dt by the reel's law at L'

        distance, rate   of the bullets at the end of the substep    [m], [m/s]
        length, winding  L, dL/dt at its begin                       [m], [m/s]

        The trapezoidal rule, solved by Newton's method: a short cord makes the law stiff, and this bounds no step.

        Checked  tests/net_capture/test_closing.py
        """
        known = length + 0.5 * h * winding
        longest = most if pays_out(p) else length
        then_long = max(length + h * winding, p.closing_lock_length)
        shorter = min(then_long, longest)
        for _ in range(NEWTON_STEPS):
            tension, then = pull_of_cord(p, distance, rate, shorter, most, top)
            slope = 1.0
            if distance > shorter and then != 0.0:
                stiffness = cord_stiffness(p.closing_axial_stiffness, shorter)
                damping = cord_damping(p.closing_damping_ratio, stiffness, p.cord_mass)
                stall = force(p, shorter)
                yielding = top / (stall + damping * top)
                slope += 0.5 * h * yielding * stiffness * distance / shorter
                slope += 0.5 * h * yielding * slope_of(p, shorter) * tension / stall
            before = shorter
            shorter -= (shorter - known - 0.5 * h * then) / slope
            shorter = min(max(shorter, p.closing_lock_length), longest)
            if abs(shorter - before) <= NEWTON_ENDS * shorter:
                break
        _, then = pull_of_cord(p, distance, rate, shorter, most, top)
        return shorter, then

    return Laws(pull_of_cord, against, wound)


def make_reels(composition: Any, drive: Drive) -> Closing:
    """Kernels of the reels that a drive turns, on the cord along the rim of the composition's net."""
    cord, laws = make_cord(composition), make_laws(drive)
    pull_of_cord, against, wound = laws.pull, laws.against, laws.wound
    tells, note = drive.note is not None, drive.note
    jams, jam_holds = composition.jam is not None, composition.jam
    pieces, rouse, along_now, along_shown = cord.pieces, cord.rouse, cord.along, cord.along_shown
    too_many_rings, burden = composition.code(TOO_MANY_RINGS.name), cord.burden
    bends, meet = cord.meet is not None, cord.meet

    @kernel
    def top_speed(p, i):
        """Speed [m/s] of the reel of pair i without load; 0 once it has jammed.

        Checked  tests/net_capture/test_closing.py
        """
        if jams:
            if jam_holds(p, i):
                return 0.0
        return p.closing_speed

    @kernel
    def start(p, work):
        """Nothing is triggered yet, the cord lies along the mouth.

        Checked  tests/net_capture/test_closing.py
        """
        p.trigger_time = -1.0
        p.closing_t_start = -1.0
        p.closing_work = 0.0
        p.cord_dissipated = 0.0
        p.cord_power = 0.0
        p.cord_tension_max = 0.0
        p.cord_tension_peak = 0.0
        p.mouth_locked_pairs = 0
        p.mouth_cord_length = 0.0
        for i in range(p.net_corners):
            beyond = p.closing_reels_at / (p.closing_rings + 1)
            following = p.mouth_side[i + 1 if i + 1 < p.net_corners else 0]
            side = (1.0 - beyond) * p.mouth_side[i] + beyond * following
            p.cord_length[i] = max(side, p.closing_lock_length)
            p.cord_most[i] = p.cord_length[i]
            p.cord_rate[i] = 0.0
            p.mouth_cord_length += p.cord_length[i]
            if p.closing_rings >= pieces(p, work, i):
                p.fault_value = p.closing_rings
                return too_many_rings
        return 0

    def make_pull(along_cord: Any, draw_cord: Any, wake: bool) -> Any:
        """Kernel that draws neighbouring bullets together; `wake`: they stand in rows that may sleep."""

        @kernel
        def pull(p, work):
            """Pull neighbouring bullets together; sum what the cord's dashpots take [W].

            Checked  tests/net_capture/test_closing.py
            """
            p.cord_power = 0.0
            if p.closing_t_start < 0.0:
                return
            if wake:
                rouse(p, work)
            for i in range(p.net_corners):
                distance, rate = along_cord(p, work, i)
                length = p.cord_length[i]
                top = top_speed(p, i)
                tension, winding = pull_of_cord(p, distance, rate, length, p.cord_most[i], top)
                p.cord_force[i] = against(p, distance, rate, length, p.cord_most[i], top)
                if tension > p.cord_tension_peak:
                    p.cord_tension_peak = tension
                if distance > length:
                    elastic = cord_stiffness(p.closing_axial_stiffness, length) * (distance - length)
                    p.cord_power += (tension - elastic) * (rate - winding)
                    draw_cord(p, work, i, tension)

        return pull

    @kernel
    def trigger(p, work, now, touched, reached):
        """Start the reels when their trigger has fallen and its delay has passed; what is loose of the cord is taken
        in, if at once, but by a reel that has jammed.

        A pair that stands closer than the lock length has its cord slack, at that length. None begins stretched.

        Checked  tests/net_capture/test_closing.py, tests/net_capture/test_slack_cord.py
        """
        if p.trigger_time < 0.0 and (
            p.close_command != 0
            or (p.closing_trigger == TRIGGER_TIME and now >= p.closing_time)
            or (p.closing_trigger == TRIGGER_CONTACT and touched >= 0.0)
            or (p.closing_trigger == TRIGGER_DISTANCE and reached)
        ):
            p.trigger_time = now
        if p.closing_t_start < 0.0 and p.trigger_time >= 0.0 and now >= p.trigger_time + p.closing_delay:
            p.closing_t_start = now
            if bends:
                rouse(p, work)
            for i in range(p.net_corners):
                if bends:
                    meet(p, work, i, True)
                top = top_speed(p, i)
                distance, rate = along_shown(p, work, i)
                keeps_slack = top == 0.0 or p.closing_slack == WOUND
                p.cord_length[i] = max(distance, p.cord_length[i] if keeps_slack else p.closing_lock_length)
                _, p.cord_rate[i] = pull_of_cord(p, distance, rate, p.cord_length[i], p.cord_most[i], top)

    @kernel
    def wind(p, work):
        """Wind the reels by the substep at whose end the bullets now are.

        Checked  tests/net_capture/test_closing.py
        """
        if p.closing_t_start < 0.0:
            return
        locked = 0
        total = 0.0
        for i in range(p.net_corners):
            if bends:
                fallen = meet(p, work, i, False)
                if fallen != 0.0:
                    distance, _ = along_now(p, work, i)
                    p.wrap_slip_loss += cord_energy(p, distance + fallen, p.cord_length[i])
                    p.wrap_slip_loss -= cord_energy(p, distance, p.cord_length[i])
            top = top_speed(p, i)
            if top > 0.0 and p.cord_length[i] > p.closing_lock_length:
                distance, rate = along_now(p, work, i)
                length, most = p.cord_length[i], p.cord_most[i]
                shorter, p.cord_rate[i] = wound(p, distance, rate, length, most, top, p.cord_rate[i], p.solver_substep)
                mean = 0.5 * (p.cord_force[i] + against(p, distance, rate, shorter, most, top))
                p.closing_work += mean * (length - shorter)
                p.cord_length[i] = shorter
            if p.cord_length[i] <= p.closing_lock_length:
                locked += 1
            total += p.cord_length[i]
        p.mouth_locked_pairs = locked
        p.mouth_cord_length = total

    @kernel
    def stored(p, work):
        """Elastic energy of the cord [J]; the drive tells what it has to tell.

        Checked  tests/net_capture/test_closing.py
        """
        if tells:
            note(p)
        if p.closing_t_start < 0.0:
            return 0.0
        energy = 0.0
        for i in range(p.net_corners):
            distance, _ = along_shown(p, work, i)
            energy += cord_energy(p, distance, p.cord_length[i])
        return energy

    @kernel
    def stiffen(p, work, span):
        """Nothing before the reels run; then every pair's cord, as short as it may be wound, taut or not.

        Checked  tests/net_capture/test_following.py
        """
        if p.closing_t_start < 0.0:
            return
        for i in range(p.net_corners):
            length = max(p.cord_length[i] - span * p.closing_speed, p.closing_lock_length)
            stiffness = cord_stiffness(p.closing_axial_stiffness, length)
            dashpot = cord_damping(p.closing_damping_ratio, stiffness, p.cord_mass)
            burden(p, work, i, stiffness, dashpot, BREAKING_STRAIN * p.closing_axial_stiffness, span)

    pull, pull_shown = make_pull(along_now, cord.draw, True), make_pull(along_shown, cord.draw_shown, False)
    return Closing(start, pull, pull_shown, wind, trigger, stored, stiffen if burden is not None else None)
