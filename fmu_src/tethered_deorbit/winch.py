"""A winch: an elastic line whose rest length a motor winds, driven by a sampled controller within its limits.

    dL/dt = v,   dv/dt = a,   a constant from one sample to the next

L is the rest length that is wound out. At every sample, k times the sample time by the instance's own clock, a control
asks for the rate v* that is to be reached at the next sample, and a = (v* - v)/h. A rate that jumped would ring the
line with sqrt(k m_r) dv: hundreds of times the tow's tension for a millimetre per second.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from fmu_src.interface import Interface
from fmu_src.tethered_deorbit.acting import Acting
from fmu_src.tethered_deorbit.command import make_command
from fmu_src.tethered_deorbit.elastic import make_elastic, unstretched
from fmu_src.tethered_deorbit.faults import blame
from fmu_src.tethered_deorbit.interface import BAD_PARAMETER
from fmu_src.tethered_deorbit.law import Reel
from fmu_src.tethered_deorbit.sights import Sights
from fmu_src.tethered_deorbit.wound import drawn, elastic_share, heat_of, kept, line, tune
from orbital.kernel import kernel
from orbital.vectors import Array

MOVED, GATHERED = 2, 2
"""Components in the state: L, v; and the work of the motor, the heat of the line's dashpot."""
STILL = 1.0e-9
"""Share of its fastest rate below which a motor stands still."""
REACHED = 1.0 - 1.0e-6
"""Share of a limit of the tension from which on it is reached, to the accuracy with which that instant is located."""


@kernel
def never_moves(record: Any, length: float, rate: float) -> tuple[float, float]:
    """An input that the controller samples moves neither tension nor energy at once."""
    return 0.0, 0.0


def make_winch(
    interface: Interface, sights: Sights, command: str, want: Callable[..., Any], start: Callable[..., Any]
) -> Reel:
    """The kernels of a winch with a control.

    command       name of its input
    want(record, state, length, speed, tension, time) -> v*   rate of winding asked for the next sample [m/s]
    start(record) -> fault                                    what the control begins with, and whether it can

    Of a line that has parted nothing is wound any more: the motor comes to rest, whatever the control asks for.

    Valid    small strains; massless line; a motor that follows its command within a sample
    Source   ours; the line as of a locked reel
    Checked  tests/tethered_deorbit/test_winch.py
    """
    place, counted, sight, parted = sights.place, sights.place + MOVED + 1, sights.line, sights.parted
    command_slot = interface.references[command]
    start_slot, least_slot = interface.references["tether.rest_length"], interface.references["reel.length_least"]
    diameter_slot = interface.references["tether.diameter"]
    elastic = make_elastic(line)
    asked, leave = make_command(command.replace(".", "_"))

    @kernel
    def prepare(record: Any, value: float, rate: float, duration: float) -> int:
        """Keep the input, which is looked at when a sample is due; returns 0 or a fault.

        value, rate   of the input, and its rate                     [m], [m/s] or [N], [N/s]
        duration      for which it moves                             [s]

        Checked  tests/tethered_deorbit/test_winch.py
        """
        r = record[0]
        if not math.isfinite(value + rate * duration):
            return blame(record, BAD_PARAMETER, command_slot, value)
        r.state_command = value
        r.state_command_rate = rate
        return 0

    @kernel
    def see(record: Any, state: Array) -> None:
        """Keep what is wound out [m], and how fast [m/s].

        Checked  tests/tethered_deorbit/test_winch.py
        """
        r = record[0]
        r.state_rest = state[place]
        r.state_winding = state[place + 1]

    @kernel
    def drive(
        record: Any, state: Array, rate: Array, length: float, speed: float, tension: float, since: float
    ) -> None:
        """Rates of L, v, and of the two integrals.

            W' = -(T + T_e^2/(2 EA)) v,   Q' = c (l' - v)^2

        Checked  tests/tethered_deorbit/test_winch.py: the book of energy
        """
        r = record[0]
        rate[place] = r.state_winding
        rate[place + 1] = r.state_winding_rate
        rate[counted] = 0.0
        rate[counted + 1] = 0.0
        if r.state_taut:
            rate[counted] = -drawn(record, length, tension) * r.state_winding
            rate[counted + 1] = heat_of(record, speed)

    @kernel
    def turn(record: Any, state: Array, length: float) -> float:
        """Book what a line has left as it goes slack: see `kept`.

        Checked  tests/tethered_deorbit/test_winch.py: the book of energy
        """
        left: float = kept(record, length)
        state[counted + 1] += left
        return left

    @kernel
    def publish(record: Any, state: Array, length: float, speed: float) -> None:
        """Outputs of its own.

        Checked  tests/tethered_deorbit/test_winch.py
        """
        r = record[0]
        r.reel_paid_out = r.state_rest
        r.reel_rate = r.state_winding
        r.reel_power = -drawn(record, length, r.tether_tension) * r.state_winding
        r.reel_work = state[counted]
        r.tether_heat = state[counted + 1]

    @kernel
    def differentiate(record: Any, length: float, speed: float, acceleration: float) -> None:
        """Rates of these.

            P' = -(T' + T_e T_e'/EA) v - (T + T_e^2/(2 EA)) a,   T_e' = EA (l' L - l v)/L^2

        Checked  tests/tethered_deorbit/test_winch.py, against differences
        """
        r = record[0]
        r.rate_reel_rate = r.state_winding_rate
        r.rate_reel_power = 0.0
        r.rate_tether_heat = 0.0
        if r.state_taut:
            tension = elastic.tension(record, length, speed, 0.0)
            strain_rate = (speed * r.state_rest - length * r.state_winding) / (r.state_rest * r.state_rest)
            slope = elastic.tension_rate(record, length, speed, acceleration, 0.0)
            slope += elastic_share(record, length) * strain_rate
            r.rate_reel_power = -slope * r.state_winding - drawn(record, length, tension) * r.state_winding_rate
            r.rate_tether_heat = heat_of(record, speed)

    @kernel
    def begin(record: Any, state: Array) -> int:
        """The motor at rest, what is wound out as told; returns 0 or a fault.

        Checked  tests/tethered_deorbit/test_winch.py: refusals
        """
        r = record[0]
        state[place] = r.tether_rest_length
        state[place + 1] = 0.0
        state[counted] = 0.0
        state[counted + 1] = 0.0
        if not r.reel_length_least <= r.reel_length_most:
            return blame(record, BAD_PARAMETER, least_slot, r.reel_length_least)
        if not r.reel_length_least <= r.tether_rest_length <= r.reel_length_most:
            return blame(record, BAD_PARAMETER, start_slot, r.tether_rest_length)
        r.state_winding_rate = 0.0
        r.state_fastest = 0.0
        r.state_hauling = 0
        r.state_sample = 0
        r.reel_limited = 0
        see(record, state)
        if tune(record, r.tether_rest_length) != 0:
            return blame(record, BAD_PARAMETER, diameter_slot, r.tether_diameter)
        return int(start(record))

    @kernel
    def due(record: Any) -> float:
        """When the next sample is due [s].

        Checked  tests/tethered_deorbit/test_winch.py: on the instance's own clock
        """
        r = record[0]
        instant: float = r.state_sample * r.reel_sample_time
        return instant

    @kernel
    def limit(record: Any) -> float:
        """Tension above which the motor stalls before the next sample [N].

            P/max|v|, and while it hauls in, F

        Checked  tests/tethered_deorbit/test_winch.py: limits hold at every instant
        """
        r = record[0]
        most = math.inf
        if r.state_fastest > STILL * r.reel_rate_limit:
            most = r.reel_power_limit / r.state_fastest
            if r.state_hauling:
                most = min(most, r.reel_force_limit)
        return most

    @kernel
    def within(record: Any, wanted: float, tension: float) -> float:
        """The rate nearest to the one asked that the limits allow at the next sample [m/s].

            |v*| <= v_max,   |v* - v| <= a_max h,   v*^2/(2 a_max) + h |v*| <= room - h |v|/2
            |T v*| <= P,   v* >= 0 while T >= F

        wanted        v*                                             [m/s]
        tension       T                                              [N]

        room is what is left to the length limit ahead. By the third the motor can always stop in front of it at a_max,
        in whole samples; a rate of now that obeys it has such a v* within a_max h.

        Source   ours
        Checked  tests/tethered_deorbit/test_winch.py: limits hold at every instant
        """
        r = record[0]
        h, hardest, now = r.reel_sample_time, r.reel_acceleration_limit, r.state_winding
        rate = min(max(wanted, -r.reel_rate_limit), r.reel_rate_limit)
        rate = min(max(rate, now - hardest * h), now + hardest * h)
        if rate > 0.0 or now > 0.0:
            room = max(0.0, r.reel_length_most - r.state_rest - 0.5 * h * now)
            rate = min(rate, hardest * (math.sqrt(h * h + 2.0 * room / hardest) - h))
        if rate < 0.0 or now < 0.0:
            room = max(0.0, r.state_rest - r.reel_length_least + 0.5 * h * now)
            rate = max(rate, hardest * (h - math.sqrt(h * h + 2.0 * room / hardest)))
        if tension > 0.0:
            strongest = r.reel_power_limit / tension
            rate = min(max(rate, -strongest), strongest)
            if tension >= REACHED * r.reel_force_limit:
                rate = max(rate, 0.0)
        return float(rate) if abs(rate) > STILL * r.reel_rate_limit else 0.0

    @kernel
    def act(record: Any, state: Array, time: float, by_state: bool) -> int:
        """Take a sample where it is due; stall where the tension has reached what the motor can do.

        Returns 0 or a fault.

        Checked  tests/tethered_deorbit/test_winch.py
        """
        r = record[0]
        see(record, state)
        _, length, speed = sight(record, state)
        tension = max(0.0, float(elastic.tension(record, length, speed, 0.0))) if r.state_taut else 0.0
        if by_state and tension >= REACHED * limit(record):
            state[place + 1] = 0.0
            r.state_winding_rate = 0.0
            r.state_fastest = 0.0
            r.state_hauling = 0
            r.reel_limited += 1
        if time >= due(record):
            see(record, state)
            h, now = r.reel_sample_time, r.state_winding
            wanted = want(record, state, length, speed, tension, time)
            if not math.isfinite(wanted):
                return blame(record, BAD_PARAMETER, command_slot, wanted)
            if parted(record) or abs(wanted) <= STILL * r.reel_rate_limit:
                wanted = 0.0
            rate = within(record, wanted, tension)
            r.state_cut = wanted - rate
            if abs(r.state_cut) > 1.0e-9 * abs(wanted) and not parted(record):
                r.reel_limited += 1
            r.state_winding_rate = (rate - now) / h
            r.state_fastest = max(abs(now), abs(rate))
            r.state_hauling = 1 if min(now, rate) < 0.0 else 0
            r.state_sample += 1
        see(record, state)
        left = max(0.0, due(record) - time)
        if tune(record, max(0.5 * r.state_rest, r.state_rest - left * r.state_fastest)) != 0:
            return blame(record, BAD_PARAMETER, diameter_slot, r.tether_diameter)
        return 0

    return Reel(
        asked=asked,
        leave=leave,
        prepare=prepare,
        **elastic._asdict(),
        partials=never_moves,
        start_limit=unstretched,
        acting=Acting(begin=begin, due=due, limit=limit, act=act),
        see=see,
        drive=drive,
        turn=turn,
        publish=publish,
        differentiate=differentiate,
    )
