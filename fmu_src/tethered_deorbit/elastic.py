"""An elastic line that pulls but never pushes, its rest length fixed or moving: kernels for the laws that have one."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

from orbital.kernel import kernel


class Elastic(NamedTuple):
    """Kernels of `law.Reel` that an elastic line has, whatever moves its rest length."""

    taut: Callable[..., Any]
    tension: Callable[..., Any]
    tension_rate: Callable[..., Any]
    onset: Callable[..., Any]
    onset_rate: Callable[..., Any]
    energy: Callable[..., Any]
    energy_rate: Callable[..., Any]


@kernel
def unstretched(record: Any) -> float:
    """Longest line with which a pair may start [m]: it may not start stretched.

    Checked  tests/tethered_deorbit/test_robust.py, test_attachment.py: what starts stretched is refused; test_winch.py
    """
    limit: float = record[0].tether_rest_length
    return limit


def make_elastic(line: Callable[..., Any], gives: bool = False) -> Elastic:
    """The kernels of a line with these properties.

        T = k (l - l0) + c (l' - l0')   while l > l0 and T > 0, otherwise 0;   k goes as 1/(l0 + g), c as its root

    line(record, since) -> (l0, l0', l0'', k, c)   [m], [m/s], [m/s^2], [N/m], [N s/m]
    gives           a net in series, which gives as g of the line would; without it g is zero

    Taut begins when min(l - l0, T) rises through zero. While it is stretching that is l - l0; else it is T, here as a
    length, T/k. Slack begins when T falls through zero, which it does before l - l0.

    Valid    small strains; massless line
    Source   D-CoNe paper, eq. 1 and 3; the clamp at zero and the moving rest length are ours
    Checked  tests/tethered_deorbit/test_snap.py, test_ramps.py, test_winch.py
    """

    @kernel
    def yielding(record: Any, rest: float) -> float:
        """Length of line that gives as line and net do [m]: l0 + g.

        Checked  tests/tethered_deorbit/test_net_in_series.py
        """
        if gives:
            return float(rest + record[0].state_give)
        return rest

    @kernel
    def tension(record: Any, length: float, rate: float, since: float) -> float:
        """Tension before the clamp [N].

            T = k (l - l0) + c (l' - l0')

        Source   D-CoNe paper, eq. 1 and 3
        Checked  tests/tethered_deorbit/test_snap.py, test_ramps.py
        """
        rest, moving, _, stiffness, damping = line(record, since)
        force: float = stiffness * (length - rest) + damping * (rate - moving)
        return force

    @kernel
    def tension_rate(record: Any, length: float, rate: float, acceleration: float, since: float) -> float:
        """Its time derivative [N/s].

            T' = k (l' - l0') + c (l'' - l0'') - l0'/(l0 + g) (k (l - l0) + c (l' - l0')/2)

        Source   derivative of `tension`, with those of k and c
        Checked  tests/tethered_deorbit/test_derivatives.py, test_winch.py, against differences
        """
        rest, moving, speeding, stiffness, damping = line(record, since)
        slope: float = stiffness * (rate - moving) + damping * (acceleration - speeding)
        if moving != 0.0:
            # k goes as 1/(l0 + g) and c as its root
            slope -= moving / yielding(record, rest) * (stiffness * (length - rest) + 0.5 * damping * (rate - moving))
        return slope

    @kernel
    def onset(record: Any, length: float, rate: float, since: float) -> float:
        """Signal [m] that rises through zero when a slack line goes taut.

            l - l0,   and while it shortens   l - l0 + c (l' - l0')/k

        Checked  tests/tethered_deorbit/test_tugs.py, against an independent integration
        """
        rest, moving, _, stiffness, damping = line(record, since)
        stretch: float = length - rest
        stretching = rate - moving
        if stretching < 0.0:
            stretch += damping * stretching / stiffness
        return stretch

    @kernel
    def onset_rate(record: Any, length: float, rate: float, acceleration: float, since: float) -> float:
        """Its time derivative [m/s].

        Source   derivative of `onset`, with those of k and c
        Checked  tests/tethered_deorbit/test_tugs.py, against an independent integration
        """
        rest, moving, speeding, stiffness, damping = line(record, since)
        stretching: float = rate - moving
        if stretching < 0.0:
            slope: float = stretching + damping * (acceleration - speeding) / stiffness
            if moving != 0.0:
                slope += 0.5 * moving / yielding(record, rest) * damping * stretching / stiffness
            return slope
        return stretching

    @kernel
    def taut(record: Any, length: float, rate: float) -> bool:
        """Whether a line met in this state pulls: stretched, and its dashpot does not push harder.

        Checked  tests/tethered_deorbit/test_start.py: taut at the start; test_macro_step.py: a changed length
        """
        return bool(onset(record, length, rate, 0.0) > 0.0 and tension(record, length, rate, 0.0) > 0.0)

    @kernel
    def energy(record: Any, length: float, since: float) -> float:
        """Elastic energy of the stretched line [J].

            k (l - l0)^2 / 2

        Checked  tests/tethered_deorbit/test_snap.py, test_attachment.py: a swing keeps its energy
        """
        rest, _, _, stiffness, _ = line(record, since)
        stored: float = 0.5 * stiffness * (length - rest) * (length - rest)
        return stored

    @kernel
    def energy_rate(record: Any, length: float, rate: float, since: float) -> float:
        """Its time derivative [W].

            k d (l' - l0') - k l0'/(2 (l0 + g)) d^2,   d = l - l0

        Checked  tests/tethered_deorbit/test_derivatives.py, test_winch.py, against differences
        """
        rest, moving, _, stiffness, _ = line(record, since)
        stretch = length - rest
        shortening = 0.5 * stiffness * moving / yielding(record, rest) * stretch * stretch
        power: float = stiffness * stretch * (rate - moving) - shortening
        return power

    return Elastic(taut, tension, tension_rate, onset, onset_rate, energy, energy_rate)
