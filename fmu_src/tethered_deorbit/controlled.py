"""Reels that control tension: one by a linear law of its own, the other as it is told. Their line is stiff."""

from __future__ import annotations

import math
from typing import Any

from fmu_src.interface import Interface
from fmu_src.tethered_deorbit.command import make_command, make_shortest
from fmu_src.tethered_deorbit.faults import blame
from fmu_src.tethered_deorbit.interface import BAD_PARAMETER
from fmu_src.tethered_deorbit.law import Reel
from orbital.kernel import kernel
from orbital.oscillators import natural_frequency
from orbital.references import equilibrium_tension


@kernel
def _no_limit(record: Any) -> float:
    """Longest line with which a pair may start [m]: any.

    Checked  tests/tethered_deorbit/test_terms.py, test_commanded.py: they start so
    """
    return math.inf


def make_linear(interface: Interface) -> Reel:
    """A reel that controls tension, its line stiff against what it does.

        T = max(0, T_ff + k_p (l - l_c) + k_d dl/dt),   T_ff = 3 n^2 m_r (l_c + a),   l_c = commanded length + offset

    The feed-forward is the tension at rest about the local vertical, n the mean motion of the reference orbit: the tide
    pulls by the distance of the centres, so a, from the attachments to the centres, counts in it. It moves with the
    commanded length; the damping stays on dl/dt itself.

    Valid    winding speeds and tensions within what the reel can do
    Source   fmu_src/tethered_deorbit/README.md, What is computed
    Checked  tests/tethered_deorbit/test_terms.py, test_ramps.py
    """
    offset_slot = interface.references["reel.length_offset"]

    asked, leave = make_command("reel_length_offset")
    shortest_on_the_way = make_shortest(offset_slot)

    @kernel
    def prepare(record: Any, value: float, rate: float, duration: float) -> int:
        """Put a commanded length in force; returns 0 or a fault. Formula of T_ff as in `make_linear`.

        value, rate   offset of the commanded length, and its rate   [m], [m/s]
        duration      for which it moves                             [s]

        Source   `orbital.references.equilibrium_tension` at l_c + a
        Checked  tests/tethered_deorbit/test_terms.py, test_attachment.py: at rest it carries the pair
        """
        r = record[0]
        length = r.reel_length + value
        _, fault = shortest_on_the_way(record, length, rate, duration)
        if fault != 0:
            return int(fault)
        r.state_command = value
        r.state_command_rate = rate
        r.state_length = length
        r.state_stiffness = r.reel_proportional_gain
        r.state_damping = r.reel_derivative_gain
        apart = length + r.state_beyond
        r.state_feed_forward = equilibrium_tension(r.state_mean_motion, apart, r.state_reduced_mass)
        r.state_frequency = max(
            natural_frequency(abs(r.state_stiffness), r.state_effective_mass), r.state_damping / r.state_effective_mass
        )
        r.state_frequency = max(r.state_frequency, r.state_pace)
        r.state_taut_tolerance = r.solver_tolerance_separation
        return 0

    @kernel
    def tension(record: Any, length: float, rate: float, since: float) -> float:
        """Tension before the clamp [N].

            T = T_ff + k_p (l - l_c) + k_d l'

        Checked  tests/tethered_deorbit/test_terms.py, test_ramps.py
        """
        r = record[0]
        commanded, forward = r.state_length, r.state_feed_forward
        if r.state_command_rate != 0.0:
            commanded = r.state_length + r.state_command_rate * since
            attachment = r.state_beyond
            forward *= (commanded + attachment) / (r.state_length + attachment)
        stretch = length - commanded
        force: float = forward + r.state_stiffness * stretch + r.state_damping * rate
        return force

    @kernel
    def tension_rate(record: Any, length: float, rate: float, acceleration: float, since: float) -> float:
        """Its time derivative [N/s].

            T' = T_ff l_c'/(l_c + a) + k_p (l' - l_c') + k_d l''

        Checked  tests/tethered_deorbit/test_derivatives.py, against differences
        """
        r = record[0]
        slope: float = r.state_stiffness * (rate - r.state_command_rate) + r.state_damping * acceleration
        if r.state_command_rate != 0.0:
            apart = r.state_length + r.state_beyond
            slope += r.state_feed_forward * r.state_command_rate / apart
        return slope

    @kernel
    def onset(record: Any, length: float, rate: float, since: float) -> float:
        """Signal [N] that rises through zero when a slack line goes taut: the tension itself.

        Checked  tests/tethered_deorbit/test_terms.py: slack and taut
        """
        return float(tension(record, length, rate, since))

    @kernel
    def onset_rate(record: Any, length: float, rate: float, acceleration: float, since: float) -> float:
        """Its time derivative [N/s].

        Checked  tests/tethered_deorbit/test_terms.py: slack and taut
        """
        return float(tension_rate(record, length, rate, acceleration, since))

    @kernel
    def taut(record: Any, length: float, rate: float) -> bool:
        """Whether the law asks for a pull.

        Checked  tests/tethered_deorbit/test_terms.py: slack and taut
        """
        return bool(tension(record, length, rate, 0.0) > 0.0)

    @kernel
    def energy(record: Any, length: float, since: float) -> float:
        """What the gain on length stores [J], as a spring's.

            k_p (l - l_c)^2 / 2

        Checked  tests/tethered_deorbit/test_derivatives.py: its derivative by the offset is that of the output
        """
        r = record[0]
        stretch = length - (r.state_length + r.state_command_rate * since)
        stored: float = 0.5 * r.state_stiffness * stretch * stretch
        return stored

    @kernel
    def energy_rate(record: Any, length: float, rate: float, since: float) -> float:
        """Its time derivative [W].

            k_p (l - l_c) (l' - l_c')

        Checked  tests/tethered_deorbit/test_derivatives.py, against differences
        """
        r = record[0]
        stretch = length - (r.state_length + r.state_command_rate * since)
        power: float = r.state_stiffness * stretch * (rate - r.state_command_rate)
        return power

    @kernel
    def partials(record: Any, length: float, rate: float) -> tuple[float, float]:
        """Derivatives of tension [N/m] and energy [J/m] by the offset of the commanded length, at since = 0.

            dT/dl_c = T_ff/(l_c + a) - k_p,   dE/dl_c = -k_p (l - l_c)

        Checked  tests/tethered_deorbit/test_derivatives.py, against differences
        """
        r = record[0]
        by_tension = r.state_feed_forward / (r.state_length + r.state_beyond) - r.state_stiffness
        by_energy = -r.state_stiffness * (length - r.state_length)
        return by_tension, by_energy

    return Reel(
        asked=asked,
        leave=leave,
        prepare=prepare,
        taut=taut,
        tension=tension,
        tension_rate=tension_rate,
        onset=onset,
        onset_rate=onset_rate,
        energy=energy,
        energy_rate=energy_rate,
        partials=partials,
        start_limit=_no_limit,
    )


def make_commanded(interface: Interface) -> Reel:
    """A reel that gives the tension it is told; its line has no length of its own.

        T = max(0, u),   u the command: reel.tension, moving at its rate

    Taut is a command above zero, or one that rises from it. Where a ramp crosses zero the step ends there.

    Valid    bodies that do not meet
    Source   ours
    Checked  tests/tethered_deorbit/test_commanded.py
    """
    command_slot = interface.references["reel.tension"]

    asked, leave = make_command("reel_tension")

    @kernel
    def prepare(record: Any, value: float, rate: float, duration: float) -> int:
        """Put a command in force; returns 0 or a fault.

        value, rate   of the tension                                 [N], [N/s]
        duration      for which it moves                             [s]

        Checked  tests/tethered_deorbit/test_commanded.py
        """
        r = record[0]
        if not math.isfinite(value + rate * duration):
            return blame(record, BAD_PARAMETER, command_slot, value)
        r.state_command = value
        r.state_command_rate = rate
        r.state_length = 0.0
        r.state_stiffness = 0.0
        r.state_damping = 0.0
        r.state_feed_forward = value
        r.state_frequency = r.state_pace
        r.state_taut_tolerance = r.solver_tolerance_separation
        return 0

    @kernel
    def tension(record: Any, length: float, rate: float, since: float) -> float:
        """Tension before the clamp [N], which is also its own onset.

            T = u + u' t

        Checked  tests/tethered_deorbit/test_commanded.py
        """
        r = record[0]
        force: float = r.state_command + r.state_command_rate * since
        return force

    @kernel
    def tension_rate(record: Any, length: float, rate: float, acceleration: float, since: float) -> float:
        """Its time derivative [N/s]: u'.

        Checked  tests/tethered_deorbit/test_derivatives.py, against differences; test_commanded.py: a ramp through zero
        """
        slope: float = record[0].state_command_rate
        return slope

    @kernel
    def taut(record: Any, length: float, rate: float) -> bool:
        """Whether the command is above zero, or rises from it.

        Checked  tests/tethered_deorbit/test_commanded.py: from zero itself the tug begins at once
        """
        r = record[0]
        return bool(r.state_command > 0.0 or (r.state_command == 0.0 and r.state_command_rate > 0.0))

    @kernel
    def energy(record: Any, length: float, since: float) -> float:
        """A line without a length of its own stores nothing [J]."""
        return 0.0

    @kernel
    def energy_rate(record: Any, length: float, rate: float, since: float) -> float:
        """And so nothing changes [W]."""
        return 0.0

    @kernel
    def partials(record: Any, length: float, rate: float) -> tuple[float, float]:
        """The tension is the command, and stores nothing."""
        return 1.0, 0.0

    return Reel(
        asked=asked,
        leave=leave,
        prepare=prepare,
        taut=taut,
        tension=tension,
        tension_rate=tension_rate,
        onset=tension,
        onset_rate=tension_rate,
        energy=energy,
        energy_rate=energy_rate,
        partials=partials,
        start_limit=_no_limit,
    )
