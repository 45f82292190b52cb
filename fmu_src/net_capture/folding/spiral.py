"""What patterns in a cylindrical canister have in common: its rows and volume, and the spiral r = c phi."""

from __future__ import annotations

import math

from fmu_src.net_capture.folding import Values
from fmu_src.net_capture.folding.zigzag import DEPTH
from fmu_src.rows import positive
from orbital.kernel import kernel

RADIUS = "canister.radius"
CANISTER = (
    positive(RADIUS, "m", "of the canister", 0.15),
    positive(DEPTH, "m", "of the canister, along the shot", 0.3),
)
KEPT = 1.0 - 1e-6
"""Of lengths: rounding stretches nothing either."""
NEWTON_STEPS = 50


@kernel
def spiral_length(turned):
    """Length of the spiral r = phi from its middle to an angle [1]: (phi sqrt(1 + phi^2) + asinh phi) / 2.

    Checked  tests/net_capture/test_folding.py
    """
    return 0.5 * (turned * math.sqrt(1.0 + turned * turned) + math.asinh(turned))


@kernel
def turned(length):
    """The angle up to which that spiral is so long [rad], by Newton's method.

    Checked  tests/net_capture/test_folding.py
    """
    angle = math.sqrt(2.0 * length)
    for _ in range(NEWTON_STEPS):
        change = (spiral_length(angle) - length) / math.sqrt(1.0 + angle * angle)
        angle -= change
        if abs(change) <= 1e-15 * angle:
            break
    return angle


def volume(values: Values) -> float:
    """Of the cylinder [m3]."""
    return math.pi * values[RADIUS] ** 2 * values[DEPTH]
