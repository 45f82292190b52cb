"""The locked reel: an elastic line between two fixed ends, whose rest length an input may move."""

from __future__ import annotations

import math
from typing import Any

from fmu_src.interface import Interface
from fmu_src.tethered_deorbit.command import make_command, make_shortest
from fmu_src.tethered_deorbit.elastic import make_elastic, unstretched
from fmu_src.tethered_deorbit.faults import blame
from fmu_src.tethered_deorbit.interface import BAD_PARAMETER
from fmu_src.tethered_deorbit.law import Reel
from orbital.kernel import kernel
from orbital.oscillators import dashpot, line_stiffness, natural_frequency, reduced_mass


def make_locked(interface: Interface) -> Reel:
    """An elastic line with fixed ends.

        T = k (l - l0) + c (dl/dt - dl0/dt)   while l > l0 and T > 0, otherwise 0
        k = EA/(l0 + g),   c = 2 zeta sqrt(k m_r),   l0 = rest length + offset,   g = EA C

    C is the compliance of a net in series with the line, 1/k = l0/EA + C; without one g is zero, and nothing is paid.
    The dashpot works on the rate of stretch, so a rest length that moves is felt at once. Stiffness and dashpot follow
    the rest length on its way: after a ramp the line is the one that the new offset makes.

    Valid    small strains; massless line; a net that gives alike at any load
    Source   D-CoNe paper, eq. 1 and 3; springs in series; the clamp at zero and the moving rest length are ours
    Checked  tests/tethered_deorbit/test_snap.py, test_ramps.py, test_net_in_series.py
    """
    gives = "net" in interface.terms
    diameter_slot = interface.references["tether.diameter"]
    offset_slot = interface.references["reel.length_offset"]

    asked, leave = make_command("reel_length_offset")
    shortest_on_the_way = make_shortest(offset_slot)

    @kernel
    def prepare(record: Any, value: float, rate: float, duration: float) -> int:
        """Put a rest length in force; returns 0 or a fault. Formulas of k, c and l0 as in `make_locked`.

        value, rate   offset of the rest length, and its rate        [m], [m/s]
        duration      for which it moves                             [s]

        Source   `line_stiffness`, `dashpot` and `natural_frequency` of `orbital.oscillators`
        Checked  tests/tethered_deorbit/test_snap.py, test_ramps.py; test_robust.py: what is refused
        """
        r = record[0]
        length = r.tether_rest_length + value
        shortest, fault = shortest_on_the_way(record, length, rate, duration)
        if fault != 0:
            return int(fault)
        given = length
        if gives:
            extensional = line_stiffness(r.tether_youngs_modulus, r.tether_diameter, 1.0)
            r.state_give = extensional * r.net_compliance
            given = length + r.state_give
        stiffness = line_stiffness(r.tether_youngs_modulus, r.tether_diameter, given)
        if not stiffness > 0.0:
            return blame(record, BAD_PARAMETER, diameter_slot, r.tether_diameter)
        r.state_command = value
        r.state_command_rate = rate
        r.state_length = length
        r.state_stiffness = stiffness
        r.state_damping = dashpot(r.tether_damping_ratio, stiffness, reduced_mass(r.chaser_mass, r.target_mass))
        if shortest < length:
            stiffness = line_stiffness(r.tether_youngs_modulus, r.tether_diameter, shortest + (given - length))
        # Above critical damping the dashpot is the fastest thing there is.
        fastest = max(1.0, 2.0 * r.tether_damping_ratio)
        r.state_frequency = natural_frequency(stiffness, r.state_effective_mass) * fastest
        r.state_taut_tolerance = r.solver_tolerance_stretch
        return 0

    @kernel
    def line(record: Any, since: float) -> tuple[float, float, float, float, float]:
        """Rest length [m], its two rates, stiffness [N/m] and dashpot [N s/m] on the way.

            l0 = l0(0) + l0' t,   k = k(0) q,   c = c(0) sqrt(q),   q = (l0(0) + g)/(l0 + g)

        since         t      since the offset began to move          [s]

        Source   k goes as 1/(l0 + g), and c as its root
        Checked  tests/tethered_deorbit/test_ramps.py: hauling in a locked line; test_net_in_series.py
        """
        r = record[0]
        length, stiffness, damping = r.state_length, r.state_stiffness, r.state_damping
        if r.state_command_rate != 0.0:
            length = r.state_length + r.state_command_rate * since
            ratio = r.state_length / length
            if gives:
                ratio = (r.state_length + r.state_give) / (length + r.state_give)
            stiffness *= ratio
            damping *= math.sqrt(ratio)
        return length, r.state_command_rate, 0.0, stiffness, damping

    elastic = make_elastic(line, gives)

    @kernel
    def partials(record: Any, length: float, rate: float) -> tuple[float, float]:
        """Derivatives of tension [N/m] and energy [J/m] by the offset of the rest length, at since = 0.

            dT/dl0 = -k - (k d + c (l' - l0')/2)/(l0 + g),   dE/dl0 = -k d - k d^2/(2 (l0 + g)),   d = l - l0

        Checked  tests/tethered_deorbit/test_derivatives.py, against differences
        """
        r = record[0]
        rest, _, _, stiffness, damping = line(record, 0.0)
        stretch = length - rest
        if gives:
            rest += r.state_give
        by_tension = -stiffness - (stiffness * stretch + 0.5 * damping * (rate - r.state_command_rate)) / rest
        by_energy = -stiffness * stretch - 0.5 * stiffness * stretch * stretch / rest
        return by_tension, by_energy

    return Reel(
        asked=asked,
        leave=leave,
        prepare=prepare,
        **elastic._asdict(),
        partials=partials,
        start_limit=unstretched,
        at_rest=line,
    )
