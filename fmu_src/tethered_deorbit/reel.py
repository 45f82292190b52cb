"""The law of the line's tension: held by a locked reel, or given by a reel that controls it.

A law is a set of kernels. `tension` is unclamped, so that it runs smoothly through zero: the switch between slack and
taut is the integrator's business. `onset` is negative while a slack line stays slack.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

from fmu_src.tethered_deorbit.interface import BAD_PARAMETER, NO_LENGTH
from orbital.kernel import kernel


class Reel(NamedTuple):
    """Kernels of one law; lengths in m, rates in m/s, tension in N.

    prepare(record, offset) -> fault                 constants of the law for a length offset [m]
    tension(record, length, rate)                    unclamped
    tension_rate(record, rate, acceleration)         its time derivative
    onset(record, length, rate)                      rises through zero when a slack line goes taut
    onset_rate(record, length, rate, acceleration)   its time derivative
    start_limit(record)                              longest separation with which a pair may start
    """

    prepare: Callable[..., Any]
    tension: Callable[..., Any]
    tension_rate: Callable[..., Any]
    onset: Callable[..., Any]
    onset_rate: Callable[..., Any]
    start_limit: Callable[..., Any]


def make_reel(law: str, elastic_stiffness: Callable[..., Any]) -> Reel:
    """The kernels of a law by its name, `locked` or `linear`; `elastic_stiffness` is that of `tether`."""
    return _make_locked(elastic_stiffness) if law == "locked" else _make_linear()


@kernel
def _tension_rate(record: Any, rate: float, acceleration: float) -> float:
    r = record[0]
    slope: float = r.state_stiffness * rate + r.state_damping * acceleration
    return slope


def _make_locked(elastic_stiffness: Callable[..., Any]) -> Reel:
    """An elastic line with fixed ends.

        T = k (l - l0) + c dl/dt   while l > l0 and T > 0, otherwise 0
        k = EA/l0,   c = 2 zeta sqrt(k m_r),   l0 = rest length + offset

    Taut begins when min(l - l0, T) rises through zero. While lengthening that is l - l0; while shortening it is T, here
    as a length, T/k. Slack begins when T falls through zero, which it does before l - l0.

    Valid    small strains; massless line
    Source   D-CoNe paper, eq. 1 and 3; the clamp at zero is ours
    Checked  tests/tethered_deorbit/test_snap.py
    """

    @kernel
    def prepare(record: Any, offset: float) -> int:
        r = record[0]
        length = r.tether_rest_length + offset
        if not 0.0 < length < math.inf:
            return NO_LENGTH
        stiffness = elastic_stiffness(r.tether_youngs_modulus, r.tether_diameter, length)
        if not (stiffness > 0.0 and r.tether_damping_ratio >= 0.0):
            return BAD_PARAMETER
        r.state_length_offset = offset
        r.state_length = length
        r.state_stiffness = stiffness
        r.state_damping = 2.0 * r.tether_damping_ratio * math.sqrt(stiffness * r.state_reduced_mass)
        # Above critical damping the dashpot is the fastest thing there is.
        r.state_frequency = math.sqrt(stiffness / r.state_reduced_mass) * max(1.0, 2.0 * r.tether_damping_ratio)
        r.state_taut_tolerance = r.solver_tolerance_stretch
        return 0

    @kernel
    def tension(record: Any, length: float, rate: float) -> float:
        r = record[0]
        force: float = r.state_stiffness * (length - r.state_length) + r.state_damping * rate
        return force

    @kernel
    def onset(record: Any, length: float, rate: float) -> float:
        r = record[0]
        stretch: float = length - r.state_length
        if rate < 0.0:
            stretch += r.state_damping * rate / r.state_stiffness
        return stretch

    @kernel
    def onset_rate(record: Any, length: float, rate: float, acceleration: float) -> float:
        r = record[0]
        if rate < 0.0:
            slope: float = rate + r.state_damping * acceleration / r.state_stiffness
            return slope
        return rate

    @kernel
    def start_limit(record: Any) -> float:
        limit: float = record[0].tether_rest_length
        return limit

    return Reel(prepare, tension, _tension_rate, onset, onset_rate, start_limit)


def _make_linear() -> Reel:
    """A reel that controls tension, its line stiff against what it does.

        T = max(0, T_ff + k_p (l - l_c) + k_d dl/dt),   T_ff = 3 n^2 m_r l_c,   l_c = commanded length + offset

    The feed-forward is the tension at rest about the local vertical, n the mean motion of the reference orbit.

    Valid    winding speeds and tensions within what the reel can do
    Source   physics.md, section 2
    Checked  tests/tethered_deorbit/test_terms.py
    """

    @kernel
    def prepare(record: Any, offset: float) -> int:
        r = record[0]
        length = r.reel_length + offset
        if not 0.0 < length < math.inf:
            return NO_LENGTH
        if not (r.reel_proportional_gain >= 0.0 and r.reel_derivative_gain >= 0.0):
            return BAD_PARAMETER
        r.state_length_offset = offset
        r.state_length = length
        r.state_stiffness = r.reel_proportional_gain
        r.state_damping = r.reel_derivative_gain
        r.state_feed_forward = 3.0 * r.state_mean_motion * r.state_mean_motion * r.state_reduced_mass * length
        r.state_frequency = max(
            math.sqrt(r.state_stiffness / r.state_reduced_mass), r.state_damping / r.state_reduced_mass
        )
        r.state_frequency = max(r.state_frequency, r.state_mean_motion)
        r.state_taut_tolerance = r.solver_tolerance_separation
        return 0

    @kernel
    def tension(record: Any, length: float, rate: float) -> float:
        r = record[0]
        stretch = length - r.state_length
        force: float = r.state_feed_forward + r.state_stiffness * stretch + r.state_damping * rate
        return force

    @kernel
    def onset(record: Any, length: float, rate: float) -> float:
        return float(tension(record, length, rate))

    @kernel
    def onset_rate(record: Any, length: float, rate: float, acceleration: float) -> float:
        return float(_tension_rate(record, rate, acceleration))

    @kernel
    def start_limit(record: Any) -> float:
        return math.inf

    return Reel(prepare, tension, _tension_rate, onset, onset_rate, start_limit)
