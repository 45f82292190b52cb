"""A pair of which one body or both turn, the line made fast at an attachment that turns with its body.

    d = rho + b_t - b_c,   l = |d|,   force T d/l on the chaser and -T d/l on the target, each at its attachment

A body that does not turn has its attachment at its centre of mass; a point target, at a distance from it on the line.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from fmu_src.interface import Interface
from fmu_src.tethered_deorbit.bodies import Bodies
from fmu_src.tethered_deorbit.bodies.bounds import make_bounds
from fmu_src.tethered_deorbit.bodies.carried import Carried
from fmu_src.tethered_deorbit.bodies.rigid import Rigid, make_rigid
from fmu_src.tethered_deorbit.bodies.stepping import make_stepping
from fmu_src.tethered_deorbit.bodies.wrapping import Wrapping, make_wrapping
from fmu_src.tethered_deorbit.faults import blame
from fmu_src.tethered_deorbit.idle import no_fault, nothing, zero
from fmu_src.tethered_deorbit.interface import BAD_PARAMETER, HANDED_OVER, START_STRETCHED
from fmu_src.tethered_deorbit.kinematics import distance_acceleration, distance_rate, turning_share
from fmu_src.tethered_deorbit.layout import ATTITUDE, PAIR
from fmu_src.tethered_deorbit.surfaces import SURFACES
from orbital.kernel import kernel
from orbital.vectors import Array, norm

FURTHER = 4.0 / 3.0
"""How much farther than of two points a step of a damped line may reach: to 4 radians of its vibration, of which the
default scheme then takes 0.20 a step where its dashpot takes 0.18 at a ratio of 0.05 (5.97 is the edge of stability).
What a step makes wrong of it is bounded as before."""
OVERRUN = 1e-12
"""Share of its length by which a line may be longer at the start, by rounding of the attitude."""


@kernel
def no_share(record: Any) -> tuple[float, int]:
    """The line feels its mass alone."""
    return 0.0, 0


STILL = Rigid(
    begin=no_share,
    arm_length=zero,
    place=no_fault,
    stand=nothing,
    move=nothing,
    reach=nothing,
    reach_acceleration=nothing,
    relief=zero,
    set_pivot=nothing,
    show_way=nothing,
    ease=zero,
    give=nothing,
    pull=nothing,
    add_turning=nothing,
    turn_back=nothing,
    squared_error=zero,
    publish=nothing,
    energy=zero,
    differentiate=zero,
    carried=Carried(),
)
"""A body that does not turn."""


def make_attached(
    turning: Sequence[str],
    terms: Mapping[str, str],
    size: int,
    frame_at: Callable[..., Any],
    strength_at: Callable[..., Any],
    interface: Interface,
) -> Bodies:
    """The kernels for a record of this interface.

    turning       which bodies turn: "target", "chaser", or both, in the order of their attitudes in the state
    terms         of the interface; the target's is among `SURFACES` or none
    size          of the state
    frame_at, strength_at   kernels `place` and `gradient` of the environment

    Checked  tests/tethered_deorbit/test_rigid.py
    """
    surface = terms["target"]
    straight = surface not in SURFACES
    wrapping = Wrapping() if straight else make_wrapping(SURFACES[surface], terms)
    show, keep, trouble = wrapping.publish, wrapping.keep, wrapping.trouble
    way_holds, renew_way, retry_way, on_body = wrapping.holds, wrapping.renew, wrapping.retry, wrapping.on_body
    lay_out, start_way = wrapping.begin, wrapping.start
    wrappings, signs = {"target": wrapping, "chaser": Wrapping()}, {"target": 1.0, "chaser": -1.0}
    made = {
        role: make_rigid(role, PAIR + ATTITUDE * at, signs[role], wrappings[role], strength_at, interface)
        for at, role in enumerate(turning)
    }
    bodies = len(turning)
    target, chaser = made.get("target", STILL), made.get("chaser", STILL)
    bounds = make_bounds(target, chaser, straight, wrapping.turning, bodies)
    separation_slot = interface.references["start.separation"]
    shorter = "target_attachment_distance" if "target" not in turning else "state_no_length"

    @kernel
    def begin(record: Any) -> int:
        """Least mass that the line moves [kg]: see `Bodies`. Returns 0 or a fault.

            1/m = 1/m_r + greatest of (a x n).I^-1 (a x n) over all directions n, of either body

        Valid    the line at its attachments
        Source   impulse on a free rigid body
        Checked  tests/tethered_deorbit/test_rigid.py: an off-centre snap
        """
        r = record[0]
        fault = lay_out(record)
        if fault != 0:
            return blame(record, fault, 0, 0.0)
        of_target, fault = target.begin(record)
        if fault != 0:
            return int(fault)
        of_chaser, fault = chaser.begin(record)
        if fault != 0:
            return int(fault)
        r.state_beyond = target.arm_length(record) + chaser.arm_length(record) + r[shorter]
        r.state_effective_mass = 1.0 / (1.0 / r.state_reduced_mass + of_target + of_chaser)
        return 0

    @kernel
    def span(record: Any, state: Array, whole: bool) -> None:
        """The line's vector and its rate, from the chaser's attachment to where it meets the target, in `state.line`.

        whole         as of `Wrapping.follow`

        Checked  tests/tethered_deorbit/test_rigid.py
        """
        vector, velocity = record[0].state_line[0], record[0].state_line[1]
        for i in range(3):
            vector[i] = state[6 + i]
            velocity[i] = state[9 + i]
        chaser.reach(record, state, vector, velocity, whole)
        target.reach(record, state, vector, velocity, whole)

    stepping = make_stepping(target, chaser, span, wrapping, bounds.turning, straight, bodies, size)

    @kernel
    def measure(record: Any, state: Array) -> tuple[float, float, float]:
        """Separation of the centres [m], length of the line [m] and its rate [m/s], after `stand`: see `Bodies`.

        Checked  tests/tethered_deorbit/test_rigid.py
        """
        r = record[0]
        distance = norm(r.state_line[0])
        speed: float = distance_rate(r.state_line[0], r.state_line[1], distance)
        return norm(state[6:9]), distance + r[on_body] - r[shorter], speed

    @kernel
    def stand(record: Any, state: Array) -> None:
        """Where the attachments and the line are: see `Bodies`.

        Checked  tests/tethered_deorbit/test_rigid.py
        """
        target.stand(record, state)
        chaser.stand(record, state)
        span(record, state, True)

    @kernel
    def line(record: Any, state: Array) -> tuple[float, float, float]:
        """The same, wherever the line was before.

        Checked  tests/tethered_deorbit/test_rigid.py
        """
        stand(record, state)
        found: tuple[float, float, float] = measure(record, state)
        return found

    @kernel
    def holds(record: Any, state: Array) -> bool:
        """Whether the way of the line goes over the edges that are held; after `stand`.

        Checked  tests/tethered_deorbit/test_wrapping.py
        """
        return bool(way_holds(record))

    @kernel
    def renew(record: Any, state: Array) -> None:
        """Hold the edges over which it does go.

        Checked  tests/tethered_deorbit/test_wrapping.py
        """
        stand(record, state)
        renew_way(record)

    @kernel
    def retry(record: Any, state: Array) -> bool:
        """Whether a way that holds could be found now, where there was none; after `stand`.

        Checked  tests/tethered_deorbit/test_wrapping.py
        """
        return bool(retry_way(record))

    @kernel
    def hold(record: Any, state: Array) -> None:
        """The way of the line to a state becomes that from which others are followed.

        Checked  tests/tethered_deorbit/test_wrapping.py
        """
        stand(record, state)
        keep(record)
        target.set_pivot(record, state, record[0].state_line[0], record[0].state_line[1])

    @kernel
    def along(record: Any, state: Array) -> tuple[float, float, float]:
        """Direction of the line at the chaser, towards the target [m].

        Checked  tests/tethered_deorbit/test_rigid.py
        """
        stand(record, state)
        vector = record[0].state_line[0]
        return vector[0], vector[1], vector[2]

    @kernel
    def second(
        record: Any, state: Array, rate: Array, separation: float, length: float, speed: float, turned: float
    ) -> tuple[float, float, float]:
        """Second derivative of the length, and rates of the separation [m/s^2], [m/s], [m/s^2]; after `stand`.

        Checked  tests/tethered_deorbit/test_rigid_outputs.py, against differences
        """
        r = record[0]
        vector, velocity, acceleration = r.state_line[0], r.state_line[1], r.state_line[2]
        for i in range(3):
            acceleration[i] = rate[9 + i]
        target.reach_acceleration(record, state, rate, acceleration)
        chaser.reach_acceleration(record, state, rate, acceleration)
        distance = norm(vector)
        change: float = distance_acceleration(vector, velocity, acceleration, distance, speed)
        # of rho' alone the rate is one in turning axes
        change += turned * turning_share(record, vector, state[9:12], distance)
        change -= target.relief(record, state, vector, velocity)
        apart = distance_rate(state[6:9], state[9:12], separation)
        slope: float = distance_acceleration(state[6:9], state[9:12], rate[9:12], separation, apart)
        slope += turned * turning_share(record, state[6:9], state[9:12], separation)
        return change, apart, slope

    @kernel
    def pull(record: Any, state: Array, rate: Array, tension: float, separation: float) -> None:
        """Add the pull of the line to the rate of the state, and its torques; after `stand` of the same state.

            rho'' -= T/m_r d/|d|

        tension       T                                          [N]

        Source   Newton's third law
        Checked  tests/tethered_deorbit/test_rigid.py
        """
        r = record[0]
        vector = r.state_line[0]
        distance = norm(vector)
        if distance > 0.0:
            force = tension / distance
            for i in range(3):
                rate[9 + i] -= force / r.state_reduced_mass * vector[i]
            target.pull(record, state, rate, force * vector[0], force * vector[1], force * vector[2])
            chaser.pull(record, state, rate, force * vector[0], force * vector[1], force * vector[2])

    @kernel
    def ends(record: Any, state: Array, out: Array) -> None:
        """Attachments and their rates, from the target's centre of mass: see `Bodies`.

        Checked  tests/tethered_deorbit/test_nodes_on_bodies.py
        """
        for row in range(4):
            for i in range(3):
                out[row][i] = 0.0
        target.reach(record, state, out[2], out[3], True)
        chaser.reach(record, state, out[0], out[1], True)
        for i in range(3):
            out[0][i] = -state[6 + i] - out[0][i]
            out[1][i] = -state[9 + i] - out[1][i]

    @kernel
    def place(record: Any, state: Array, longest: float) -> int:
        """Attitudes at the start, in the frame of the orbit's point; fault of a line that is stretched there, or 0.

        Checked  tests/tethered_deorbit/test_rigid.py
        """
        r = record[0]
        turning_rate = frame_at(record, r.state_vector[0], r.state_vector[1])
        code = target.place(record, state, r.state_basis, turning_rate)
        if code == 0:
            code = chaser.place(record, state, r.state_basis, turning_rate)
        if code != 0:
            return int(code)
        stand(record, state)
        start_way(record)
        code = trouble(record)
        if code != 0:
            return blame(record, code, 0, 0.0)
        _, length, _ = line(record, state)
        if r.start_condition == HANDED_OVER:
            return 0
        if not length > 0.0:
            return blame(record, BAD_PARAMETER, separation_slot, r.start_separation)
        stretched = length > longest * (1.0 + OVERRUN)
        return blame(record, START_STRETCHED, separation_slot, r.start_separation) if stretched else 0

    @kernel
    def move(record: Any, state: Array, rate: Array) -> None:
        """Rates of attitudes and body rates without the line.

        Checked  tests/tethered_deorbit/test_rigid.py
        """
        target.move(record, state, rate)
        chaser.move(record, state, rate)

    @kernel
    def add_turning(record: Any, state: Array, rate: Array, sign: float) -> None:
        """What the turning of the axes adds to the rates of the attitudes.

        Checked  tests/tethered_deorbit/test_rigid.py: axes change nothing
        """
        target.add_turning(record, state, rate, sign)
        chaser.add_turning(record, state, rate, sign)

    @kernel
    def turn_back(record: Any, time: float, vector: Array) -> None:
        """Attitudes along axes at rest.

        Checked  tests/tethered_deorbit/test_rigid.py: axes change nothing
        """
        target.turn_back(record, time, vector)
        chaser.turn_back(record, time, vector)

    @kernel
    def publish(record: Any, state: Array) -> None:
        """Outputs of both, after `stand`.

        Checked  tests/tethered_deorbit/test_rigid.py
        """
        target.publish(record, state)
        chaser.publish(record, state)
        show(record)

    @kernel
    def energy(record: Any, state: Array, turning_rate: float) -> float:
        """Energy of both attitudes [J].

        Checked  tests/tethered_deorbit/test_rigid.py
        """
        return float(target.energy(record, state, turning_rate) + chaser.energy(record, state, turning_rate))

    @kernel
    def differentiate(record: Any, state: Array, rate: Array, turning_rate: float, change: float) -> float:
        """Rates of their outputs; power [W].

        Checked  tests/tethered_deorbit/test_rigid_outputs.py, against differences
        """
        target.show_way(record, state, record[0].state_line[0], record[0].state_line[1])
        power = target.differentiate(record, state, rate, turning_rate, change)
        return float(power + chaser.differentiate(record, state, rate, turning_rate, change))

    pair = Bodies(
        begin=begin,
        place=place,
        move=move,
        stand=stand,
        measure=measure,
        line=line,
        along=along,
        second=second,
        pull=pull,
        add_turning=add_turning,
        turn_back=turn_back,
        rest=stepping.rest,
        enter=stepping.enter,
        go_on=stepping.go_on,
        seen=stepping.seen,
        felt=stepping.felt,
        last_seen=stepping.last_seen,
        seen_rate=stepping.seen_rate,
        enter_rate=stepping.enter_rate,
        longest=bounds.longest,
        squared_error=bounds.squared_error,
        pace=bounds.pace,
        square_across=bounds.square_across,
        moved_mass=bounds.moved_mass,
        mass_now=bounds.moved_mass,
        publish=publish,
        energy=energy,
        differentiate=differentiate,
        further=FURTHER,
        ends=ends,
        chaser_end=chaser.reach_acceleration,
        twist_chaser=chaser.pull,
        twist_target=target.pull,
        beyond=shorter,
    )
    if straight:
        return pair
    pair = pair._replace(stays=stepping.stays, rise=wrapping.rise, book=wrapping.book)
    return pair._replace(hold=hold, trouble=trouble, holds=holds, renew=renew, retry=retry)
