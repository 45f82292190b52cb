"""The closing cord: winches at the bullets draw the mouth together and never pay out.

Each winch runs at its no-load speed less the share of the tension in its stall force:

    dL/dt = -v0 (1 - T / T_stall)   while 0 <= T < T_stall, otherwise 0

so the cord is ratcheted: its length out is a bound on the mouth's perimeter that only falls. No winch winds its pair
shorter than the lock length, so no cord is ever shorter, and none is stiffer than the stability bound reckons with.

The book of the cord, T_e = EA (s - L)/L the elastic part of its tension T:

    by the winches   [T + T_e^2 / (2 EA)] (-dL)        by the trapezoidal rule over the substep
    to the dashpots  (T - T_e) (ds - dL)
    stored           EA (s - L)^2 / (2 L)
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from fmu_src.extremes import Extreme, times
from fmu_src.interface import Term, Variable, fault
from fmu_src.net_capture.closing import Closing
from fmu_src.net_capture.closing.cord import make_cord
from fmu_src.net_capture.formulas import BREAKING_STRAIN, cord_damping, cord_stiffness
from fmu_src.net_capture.planes import MOST_BULLETS
from fmu_src.net_capture.refusal import Refusal, Scene
from fmu_src.rows import at_least_zero, choice, count, output, parameter, peak, positive, state
from orbital.kernel import kernel

TRIGGERS = ("time", "first_contact", "distance", "command")
TRIGGER_TIME, TRIGGER_CONTACT, TRIGGER_DISTANCE = range(3)
NEWTON_STEPS = 4
"""Of the winding law at most, from a start that is right to second order."""
NEWTON_ENDS = 1e-9
"""Share of the length by which a step may still change it for the last: the error that is left is its square."""


TOO_MANY_RINGS = fault(
    "too_many_rings", "closing.rings", "closing.rings: a side of the mouth has fewer knots between its bullets"
)


@kernel
def cord_energy(p, distance, length):
    """Energy [J] in a cord of this length between points this far apart: EA (s - L)^2 / (2 L).

    Checked  tests/net_capture/test_closing.py
    """
    stretch = distance - length
    return 0.5 * p.closing_axial_stiffness * stretch * stretch / length if stretch > 0.0 else 0.0


@kernel
def cord_tension(stiffness, damping, stretch, rate, speed, stall):
    """Tension [N] of a stretched cord that a winch may be drawing in.

        T = k (s - L) + d (ds/dt - dL/dt),   dL/dt = -v0 (1 - T / T_stall) while the winch turns

    The dashpot works on the cord's own stretch rate, so the winch's law and the tension are solved together.

    stiffness  k        EA / L                                     [N/m]
    damping    d        dashpot of the cord                        [N s/m]
    stretch    s - L    distance of the bullets less cord out      [m]
    rate       ds/dt    of their distance                          [m/s]
    speed      v0       of the winch without load; 0 once locked   [m/s]
    stall      T_stall  tension at which it stands still           [N]

    Checked  tests/net_capture/test_closing.py
    """
    tension = stiffness * stretch + damping * rate
    if tension < stall:
        tension = (tension + damping * speed) / (1.0 + damping * speed / stall)
    return tension if tension > 0.0 else 0.0


@kernel
def pull_of_cord(p, distance, rate, length):
    """Tension of one pair's cord [N], and the rate of its length [m/s] as the winch turns under it.

    Checked  tests/net_capture/test_closing.py
    """
    speed = p.closing_speed if length > p.closing_lock_length else 0.0
    tension = 0.0
    if distance > length:
        stiffness = cord_stiffness(p.closing_axial_stiffness, length)
        damping = cord_damping(p.closing_damping_ratio, stiffness, p.cord_mass)
        tension = cord_tension(stiffness, damping, distance - length, rate, speed, p.closing_stall_force)
    turning = speed * (1.0 - tension / p.closing_stall_force)
    return tension, -turning if turning > 0.0 else 0.0


@kernel
def winch_force(p, distance, rate, length):
    """What a winch works against per length wound [N]: T + T_e^2 / (2 EA).

    Checked  tests/net_capture/test_closing.py
    """
    tension, _ = pull_of_cord(p, distance, rate, length)
    stretch = distance - length
    elastic = p.closing_axial_stiffness * stretch / length if stretch > 0.0 else 0.0
    return tension + 0.5 * elastic * elastic / p.closing_axial_stiffness


@kernel
def wound(p, distance, rate, length, winding, h):
    """Length of a pair's cord one substep on [m], and how fast it then changes [m/s].

        L' = L + h/2 (dL/dt + dL'/dt),   dL'/dt by the winch's law at L'

    distance, rate   of the bullets at the end of the substep    [m], [m/s]
    length, winding  L, dL/dt at its begin                       [m], [m/s]

    The trapezoidal rule, solved by Newton's method: a short cord makes the law stiff, and this bounds no step.

    Checked  tests/net_capture/test_closing.py
    """
    known = length + 0.5 * h * winding
    shorter = max(length + h * winding, p.closing_lock_length)
    for _ in range(NEWTON_STEPS):
        _, then = pull_of_cord(p, distance, rate, shorter)
        slope = 1.0
        if distance > shorter and then < 0.0:
            stiffness = cord_stiffness(p.closing_axial_stiffness, shorter)
            damping = cord_damping(p.closing_damping_ratio, stiffness, p.cord_mass)
            yielding = p.closing_speed / (p.closing_stall_force + damping * p.closing_speed)
            slope += 0.5 * h * yielding * stiffness * distance / shorter
        before = shorter
        shorter -= (shorter - known - 0.5 * h * then) / slope
        shorter = min(max(shorter, p.closing_lock_length), length)
        if abs(shorter - before) <= NEWTON_ENDS * shorter:
            break
    _, then = pull_of_cord(p, distance, rate, shorter)
    return shorter, then


def make(composition: Any) -> Closing:
    """Kernels of the winches on the cord along the rim of the composition's net."""
    cord = make_cord(composition)
    pieces, rouse, along_now, along_shown = cord.pieces, cord.rouse, cord.along, cord.along_shown
    too_many_rings, burden = composition.code(TOO_MANY_RINGS.name), cord.burden

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
            p.cord_length[i] = max(p.mouth_side[i], p.closing_lock_length)
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
                tension, winding = pull_of_cord(p, distance, rate, length)
                p.cord_force[i] = winch_force(p, distance, rate, length)
                if tension > p.cord_tension_peak:
                    p.cord_tension_peak = tension
                if distance > length:
                    elastic = cord_stiffness(p.closing_axial_stiffness, length) * (distance - length)
                    p.cord_power += (tension - elastic) * (rate - winding)
                    draw_cord(p, work, i, tension)

        return pull

    @kernel
    def trigger(p, work, now, touched, beyond):
        """Start the winches when their trigger has fallen and its delay has passed; what is loose of the cord is taken
        in.

        A pair that stands closer than the lock length has its cord slack, at that length.

        Checked  tests/net_capture/test_closing.py
        """
        if p.trigger_time < 0.0 and (
            p.close_command != 0
            or (p.closing_trigger == TRIGGER_TIME and now >= p.closing_time)
            or (p.closing_trigger == TRIGGER_CONTACT and touched >= 0.0)
            or (p.closing_trigger == TRIGGER_DISTANCE and beyond >= p.closing_distance)
        ):
            p.trigger_time = now
        if p.closing_t_start < 0.0 and p.trigger_time >= 0.0 and now >= p.trigger_time + p.closing_delay:
            p.closing_t_start = now
            for i in range(p.net_corners):
                distance, rate = along_shown(p, work, i)
                p.cord_length[i] = max(distance, p.closing_lock_length)
                _, p.cord_rate[i] = pull_of_cord(p, distance, rate, p.cord_length[i])

    @kernel
    def wind(p, work):
        """Wind the winches by the substep at whose end the bullets now are.

        Checked  tests/net_capture/test_closing.py
        """
        if p.closing_t_start < 0.0:
            return
        locked = 0
        total = 0.0
        for i in range(p.net_corners):
            if p.cord_length[i] > p.closing_lock_length:
                distance, rate = along_now(p, work, i)
                length = p.cord_length[i]
                shorter, p.cord_rate[i] = wound(p, distance, rate, length, p.cord_rate[i], p.solver_substep)
                against = 0.5 * (p.cord_force[i] + winch_force(p, distance, rate, shorter))
                p.closing_work += against * (length - shorter)
                p.cord_length[i] = shorter
            if p.cord_length[i] <= p.closing_lock_length:
                locked += 1
            total += p.cord_length[i]
        p.mouth_locked_pairs = locked
        p.mouth_cord_length = total

    @kernel
    def stored(p, work):
        """Elastic energy of the cord [J].

        Checked  tests/net_capture/test_closing.py
        """
        if p.closing_t_start < 0.0:
            return 0.0
        energy = 0.0
        for i in range(p.net_corners):
            distance, _ = along_shown(p, work, i)
            energy += cord_energy(p, distance, p.cord_length[i])
        return energy

    @kernel
    def stiffen(p, work, span):
        """Nothing before the winches run; then every pair's cord, as short as it may be wound, taut or not.

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


def refuses(scene: Scene) -> Iterator[Refusal]:
    """More rings than the shortest side of the mouth has knots."""
    most = scene.parts["net"].checks.knots(scene.values)
    if scene.values["closing.rings"] > most >= 1:
        expected = f"must be at most {most}: a side of this net has so many knots between its bullets"
        yield Refusal("closing.rings", f"{int(scene.values['closing.rings'])}", expected)


PART = Term(
    "cord between neighbouring bullets, drawn by winches that stall and never pay out",
    (
        choice("closing.trigger", "what starts the winches; close.command always does", TRIGGERS),
        at_least_zero("closing.time", "s", "when the winches start, since the shot, for trigger time", 11.2),
        parameter(
            "closing.distance",
            "m",
            "bullets this far beyond the target's centre of mass, along "
            "the shot axis, start the winches, for trigger distance",
            0.0,
        ),
        at_least_zero("closing.delay", "s", "from the trigger to the start of the winches", 0.0),
        positive("closing.speed", "m/s", "no-load speed of each winch: a 24 m side in 5 s", 5.0),
        positive("closing.stall_force", "N", "tension at which a winch stands still", 5.0),
        parameter(
            "closing.rings",
            "1",
            "on each side of the mouth, evenly spaced, through which the cord between two bullets runs without "
            "friction; without any the sides stay open loops",
            1,
            0,
            64,
            kind="Integer",
        ),
        positive("closing.axial_stiffness", "N", "EA of the cord: 0.5 mm nylon", 903.0),
        at_least_zero("closing.damping_ratio", "1", "of the cord between two bullets", 0.106),
        positive("closing.lock_length", "m", "a pair is locked when its cord is shorter than this", 0.25),
        positive(
            "closing.timeout",
            "s",
            "after this long since the trigger a mouth that is not closed behind the target counts as not closed",
            20.0,
        ),
        Variable("close.command", "1", "input", "start the winches", False, kind="Boolean"),
        output(
            "mouth.cord_length",
            "m",
            "length of cord still out: the way round the bullets can not be longer, the net's slack sides can",
        ),
        output("mouth.girth", "m", "smallest girth of the target, which the mouth would have to pass"),
        peak(
            "mouth.margin_at_capture",
            "m",
            "girth of the target less cord out, at the instant of capture; -1 before",
        ),
        peak(
            "enclosure.share",
            "1",
            "share of the target's sample points that net and mouth go round, at the last look; "
            "-1 until the cord is shorter than the girth",
        ),
        peak("enclosure.at_capture", "1", "that share at the instant of capture; -1 before"),
        peak("enclosure.least", "1", "least share since the capture; -1 before"),
        peak("t_lost", "s", "instant at which the target was out of the net again after a capture; -1 before"),
        state("enclosure_since", "s", "since when enough of the target to count as caught has been inside"),
        state("enclosure_last_in", "s", "when enough of the target was last inside"),
        count("mouth.locked_pairs", "pairs of bullets whose cord is shorter than the lock length"),
        peak("cord.tension_max", "N", "largest tension of the cord since the start"),
        peak("cord.tension_peak", "N", "largest tension of the cord over the last macro step"),
        output("closing.work", "J", "work done by the winches so far"),
        output("cord.dissipated", "J", "taken by the cord's dashpots so far"),
        peak("closing.t_start", "s", "when the winches started, since the shot; -1 before"),
        state("cord_length[#]", "m", "cord out between neighbouring bullets", shape=(MOST_BULLETS,)),
        state("cord_rate[#]", "m/s", "rate of that length", shape=(MOST_BULLETS,)),
        state("cord_force[#]", "N", "what each winch works against per length wound", shape=(MOST_BULLETS,)),
        state("cord_mass", "kg", "that a pair's cord moves as it lengthens"),
        state("cord_power", "W", "what the cord's dashpots take now"),
        state("cord_loss", "J", "taken by the cord's dashpots up to half a substep back"),
        state("trigger_time", "s", "when the trigger fell, since the shot; -1 before"),
    ),
    faults=(TOO_MANY_RINGS,),
    make=make,
    refuses=refuses,
    extremes=(
        *(
            Extreme(
                f"cord {factor:g} times as stiff",
                "EA of the closing cord",
                "energy_gained",
                {"closing.axial_stiffness": times("closing.axial_stiffness", factor)},
                chief=factor == 1e2,
            )
            for factor in (1e-3, 1e2, 1e4)
        ),
        Extreme(
            "closing at the first instant",
            "the winches draw on a net that is still folded",
            "energy_gained",
            {"closing.trigger": TRIGGER_TIME, "closing.time": 0.0},
        ),
    ),
)
