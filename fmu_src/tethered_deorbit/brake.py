"""A brake: an elastic line wound out to its end, which slips against a friction of its drum."""

from __future__ import annotations

import math
from typing import Any

from fmu_src.interface import Interface
from fmu_src.tethered_deorbit.acting import Acting
from fmu_src.tethered_deorbit.elastic import make_elastic, unstretched
from fmu_src.tethered_deorbit.faults import blame
from fmu_src.tethered_deorbit.interface import BAD_PARAMETER
from fmu_src.tethered_deorbit.law import Reel
from fmu_src.tethered_deorbit.sights import Sights
from fmu_src.tethered_deorbit.wound import drawn, elastic_share, heat_of, kept, line, tune
from orbital.kernel import kernel
from orbital.vectors import Array

MOVED, GATHERED = 1, 2
"""Components in the state: L; and the heat of the brake, of the line's dashpot."""
ABOVE = 1.0 + 1.0e-9
"""Share of the friction from which on the line slips, or of the tension with which it has stuck."""
FINE = 0.5
"""Longest step of a slipping line, in the time c/k in which it comes to its stretch."""


def make_brake(interface: Interface, sights: Sights) -> Reel:
    """A line that is elastic up to a tension F, at which it slips out of its drum until nothing is left on it.

        T = F while it slips,   L' = l' - (F - k (l - L))/c,   without a dashpot L' = l' L/l

    It slips where its tension reaches F and sticks where L' falls to zero. With all of it paid out it is held.

    Valid    small strains; massless line; dry friction without a difference between sticking and slipping
    Source   ours: dry friction in series with the spring and dashpot of a locked line
    Checked  tests/tethered_deorbit/test_brake.py
    """
    place, counted, sight = sights.place, sights.place + MOVED + 1, sights.line
    offset_slot = interface.references["reel.brake_offset"]
    start_slot, diameter_slot = interface.references["tether.rest_length"], interface.references["tether.diameter"]
    elastic = make_elastic(line)

    @kernel
    def asked(record: Any) -> tuple[float, float]:
        """What the input says: held over a step [N].

        Checked  tests/tethered_deorbit/test_brake.py
        """
        return record[0].reel_brake_offset, 0.0

    @kernel
    def leave(record: Any, value: float) -> None:
        """The input stays where it is."""

    @kernel
    def prepare(record: Any, value: float, rate: float, duration: float) -> int:
        """Put a friction in force; returns 0 or a fault.

        value         what is added to reel.brake_force              [N]

        Checked  tests/tethered_deorbit/test_brake.py
        """
        r = record[0]
        if not math.isfinite(value):
            return blame(record, BAD_PARAMETER, offset_slot, value)
        r.state_command = value
        r.state_command_rate = 0.0
        friction = max(0.0, r.reel_brake_force + value)
        if friction != r.state_friction:
            r.state_stuck = 0.0
        r.state_friction = friction
        return 0

    @kernel
    def partials(record: Any, length: float, rate: float) -> tuple[float, float]:
        """Derivatives of tension [1] and energy [J/N] by the friction: while it slips, the tension is it.

        Checked  tests/tethered_deorbit/test_brake.py: friction by an input
        """
        return (1.0 if record[0].state_slipping else 0.0), 0.0

    @kernel
    def see(record: Any, state: Array) -> None:
        """Keep what is wound out [m]; how fast it slips, `see_change` and `drive` keep.

        Checked  tests/tethered_deorbit/test_brake.py
        """
        r = record[0]
        r.state_rest = state[place]
        r.state_winding = 0.0

    @kernel
    def slipping(record: Any, length: float, speed: float) -> float:
        """Rate at which the line slips out [m/s]: the formula of `make_brake`.

        length        l      of the line                             [m]
        speed         l'     of it                                   [m/s]

        Checked  tests/tethered_deorbit/test_brake.py
        """
        r = record[0]
        _, _, _, _, damping = line(record, 0.0)
        if damping > 0.0:
            return float(speed - (r.state_friction - elastic_share(record, length)) / damping)
        return float(speed * r.state_rest / length)

    @kernel
    def breakaway(record: Any) -> float:
        """Tension from which on the line slips [N].

        Checked  tests/tethered_deorbit/test_brake.py
        """
        r = record[0]
        return float(ABOVE * max(r.state_friction, r.state_stuck))

    @kernel
    def see_change(record: Any, state: Array, rate: Array, turned: float) -> None:
        """Keep how fast it slips [m/s].

        Checked  tests/tethered_deorbit/test_brake.py, against differences
        """
        r = record[0]
        if r.state_slipping and r.state_taut:
            _, length, speed = sight(record, state)
            r.state_winding = slipping(record, length, speed)

    @kernel
    def tension(record: Any, length: float, rate: float, since: float) -> float:
        """Tension before the clamp [N]: the friction, or that of a line that is held.

        Checked  tests/tethered_deorbit/test_brake.py
        """
        r = record[0]
        if r.state_slipping:
            return float(r.state_friction)
        return float(elastic.tension(record, length, rate, since))

    @kernel
    def tension_rate(record: Any, length: float, rate: float, acceleration: float, since: float) -> float:
        """Its time derivative [N/s].

        Checked  tests/tethered_deorbit/test_brake.py
        """
        r = record[0]
        if r.state_slipping:
            return 0.0
        return float(elastic.tension_rate(record, length, rate, acceleration, since))

    @kernel
    def drive(
        record: Any, state: Array, rate: Array, length: float, speed: float, tension: float, since: float
    ) -> None:
        """Rates of L and of the two integrals.

            B' = (F + T_e^2/(2 EA)) L',   Q' = c (l' - L')^2

        Checked  tests/tethered_deorbit/test_brake.py: the book of energy
        """
        r = record[0]
        if r.state_taut and r.state_slipping:
            r.state_winding = slipping(record, length, speed)
        rate[place] = r.state_winding
        rate[counted] = drawn(record, length, tension) * r.state_winding
        rate[counted + 1] = heat_of(record, speed) if r.state_taut else 0.0

    @kernel
    def turn(record: Any, state: Array, length: float) -> float:
        """Book what a line has left as it goes slack: see `kept`. One that goes taut so fast that its dashpot leaps
        above the friction slips from the first.

        Checked  tests/tethered_deorbit/test_brake.py: the book of energy
        """
        r = record[0]
        left: float = kept(record, length)
        state[counted + 1] += left
        _, _, speed = sight(record, state)
        r.state_slipping = 0
        if r.state_taut and r.state_rest < r.reel_length_most:
            r.state_slipping = 1 if elastic.tension(record, length, speed, 0.0) > breakaway(record) else 0
        return left

    @kernel
    def publish(record: Any, state: Array, length: float, speed: float) -> None:
        """Outputs of its own.

        Checked  tests/tethered_deorbit/test_brake.py
        """
        r = record[0]
        r.reel_paid_out = r.state_rest
        r.reel_rate = slipping(record, length, speed) if r.state_slipping and r.state_taut else 0.0
        r.reel_heat = state[counted]
        r.tether_heat = state[counted + 1]

    @kernel
    def differentiate(record: Any, length: float, speed: float, acceleration: float) -> None:
        """Rates of these; `see_change` has been before.

        Checked  tests/tethered_deorbit/test_brake.py, against differences
        """
        r = record[0]
        r.rate_reel_rate = 0.0
        r.rate_reel_heat = 0.0
        r.rate_tether_heat = 0.0
        if r.state_taut:
            r.rate_tether_heat = heat_of(record, speed)
            if r.state_slipping:
                slip = r.state_winding
                r.rate_reel_heat = drawn(record, length, r.state_friction) * slip
                _, _, _, stiffness, damping = line(record, 0.0)
                if damping > 0.0:
                    # of F = k (l - L) + c (l' - L'), with k as 1/L and c as its root
                    lag = (r.state_friction - elastic_share(record, length)) / damping
                    change = stiffness * (speed - slip) - slip / r.state_rest * (
                        stiffness * (length - r.state_rest) + 0.5 * damping * lag
                    )
                    r.rate_reel_rate = acceleration + change / damping
                else:
                    r.rate_reel_rate = (
                        acceleration * r.state_rest + speed * (slip - speed * r.state_rest / length)
                    ) / length

    @kernel
    def begin(record: Any, state: Array) -> int:
        """Nothing has slipped; returns 0 or a fault.

        Checked  tests/tethered_deorbit/test_brake.py: refusals
        """
        r = record[0]
        state[place] = r.tether_rest_length
        state[counted] = 0.0
        state[counted + 1] = 0.0
        r.state_slipping = 0
        r.state_stuck = 0.0
        r.state_winding = 0.0
        r.state_winding_rate = 0.0
        if not r.tether_rest_length <= r.reel_length_most:
            return blame(record, BAD_PARAMETER, start_slot, r.tether_rest_length)
        see(record, state)
        if tune(record, r.tether_rest_length) != 0:
            return blame(record, BAD_PARAMETER, diameter_slot, r.tether_diameter)
        return 0

    @kernel
    def limit(record: Any) -> float:
        """Tension at which the line slips [N]; none while it does, or with all of it paid out.

        Checked  tests/tethered_deorbit/test_brake.py
        """
        r = record[0]
        if r.state_slipping or r.state_rest >= r.reel_length_most:
            return math.inf
        return float(breakaway(record))

    @kernel
    def longest(record: Any, state: Array) -> float:
        """Longest step of a line that slips [s].

        Checked  tests/tethered_deorbit/test_brake.py
        """
        r = record[0]
        if not r.state_slipping or r.state_damping == 0.0:
            return math.inf
        return float(FINE * r.state_damping / r.state_stiffness)

    @kernel
    def holds(record: Any, state: Array, since: float) -> bool:
        """Whether a line that slips still slips out, and there is more of it.

        Checked  tests/tethered_deorbit/test_brake.py
        """
        r = record[0]
        if not r.state_slipping:
            return True
        see(record, state)
        _, length, speed = sight(record, state)
        return bool(slipping(record, length, speed) > 0.0 and r.state_rest < r.reel_length_most)

    @kernel
    def act(record: Any, state: Array, time: float, by_state: bool) -> int:
        """Let the line slip, or stick; returns 0 or a fault.

        Checked  tests/tethered_deorbit/test_brake.py
        """
        r = record[0]
        see(record, state)
        _, length, speed = sight(record, state)
        if r.state_slipping:
            if not holds(record, state, 0.0):
                r.state_slipping = 0
                r.state_stuck = elastic.tension(record, length, speed, 0.0)
        elif r.state_taut and r.state_rest < r.reel_length_most:
            held = elastic.tension(record, length, speed, 0.0)
            # It slips only where it would slip out.
            if held >= r.state_friction and slipping(record, length, speed) > 0.0:
                r.state_slipping = 1
                r.state_stuck = 0.0
        r.state_winding = 0.0
        if tune(record, r.state_rest) != 0:
            return blame(record, BAD_PARAMETER, diameter_slot, r.tether_diameter)
        return 0

    return Reel(
        asked=asked,
        leave=leave,
        prepare=prepare,
        **(elastic._asdict() | {"tension": tension, "tension_rate": tension_rate}),
        partials=partials,
        start_limit=unstretched,
        acting=Acting(begin=begin, limit=limit, longest=longest, holds=holds, act=act),
        see=see,
        see_change=see_change,
        drive=drive,
        turn=turn,
        publish=publish,
        differentiate=differentiate,
    )
