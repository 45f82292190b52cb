"""The net folded to and fro along one axis of the mouth and rolled up along the other, into a cylindrical canister.

The band, as wide as the canister is deep, is wound in a spiral r = c phi about the shot axis, from a core of a quarter
of the canister's radius outwards; of its layers each lies a little farther in than the one before:

    w = zigzag(a x),   s(phi) = k y,   r = c phi - 0.9 P x / X,   P = 2 pi c

with s the length of the spiral. With p = 0.9 P / X that map stretches nothing for k = 1 / sqrt(1 + p) and
a = sqrt(1 - p - p^2), since the spiral rises by less than its length.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from fmu_src.implied import formula
from fmu_src.interface import Term, fault
from fmu_src.net_capture.folding import Checks, Folding
from fmu_src.net_capture.folding.spiral import CANISTER, KEPT, RADIUS, spiral_length, turned, volume
from fmu_src.net_capture.folding.zigzag import DEPTH, TOO_DEEP, extremes, fold_width, make_spans, zigzag
from fmu_src.net_capture.planes import SHOWN, X
from fmu_src.net_capture.refusal import Refusal, Scene
from fmu_src.net_capture.release import BOOKED
from orbital.kernel import kernel

CORE = 0.25
"""Of the canister's radius."""
FILLED = 0.9
"""Of the distance of two turns that the layers of the band take."""
TOO_ROOMY = fault("too_roomy", RADIUS, "the canister is so wide for this net that it would not make a roll of layers")


@kernel
def pitch(radius, length):
    """From a turn to the next [m]: P = pi (R^2 - R0^2) / L.

    radius    R    of the canister, R0 that of the core    [m]
    length    L    of the band                             [m]

    Checked  tests/net_capture/test_folding.py
    """
    return math.pi * (1.0 - CORE * CORE) * radius * radius / length


def make(composition: Any) -> Folding:
    """Kernels for the composition's net."""
    node_plane, spans = composition.memory.node_plane, make_spans(composition)
    too_deep, too_roomy = composition.code(TOO_DEEP.name), composition.code(TOO_ROOMY.name)

    @kernel
    def check(p):
        """See `Folding`.

        Checked  tests/net_capture/test_folding.py
        """
        if p.canister_depth >= 0.5 * min(p.mouth_width[0], p.mouth_width[1]):
            p.fault_value = p.canister_depth
            return too_deep
        if pitch(p.canister_radius, p.mouth_width[1]) >= CORE * p.canister_radius:
            p.fault_value = p.canister_radius
            return too_roomy
        return 0

    @kernel
    def fold(p, work):
        """Every node on the band, its first end at the core.

        Checked  tests/net_capture/test_folding.py
        """
        along, across = spans(p, work)
        step = pitch(p.canister_radius, across)
        c = step / (2.0 * math.pi)
        slope = FILLED * step / along
        folded = KEPT * math.sqrt(1.0 - slope - slope * slope)
        wound = KEPT / math.sqrt(1.0 + slope)
        core = spiral_length(CORE * p.canister_radius / c)
        width = fold_width(p.canister_depth, folded * p.rim_mesh)
        for i in range(p.node_slots):
            x = node_plane(p, work, SHOWN)[i] + 0.5 * along
            y = node_plane(p, work, SHOWN + 1)[i] + 0.5 * across
            angle = turned(core + wound * max(y, 0.0) / c)
            radius = c * angle - slope * x
            w = zigzag(folded * x, width) - 0.5 * p.canister_depth
            for axis in range(3):
                at = p.muzzle[axis] + w * p.axes[6 + axis]
                at += radius * (math.cos(angle) * p.axes[axis] + math.sin(angle) * p.axes[3 + axis])
                node_plane(p, work, X + axis)[i] = at

    return Folding(check, fold)


def refuses(scene: Scene) -> Iterator[Refusal]:
    """A canister that is none for this net."""
    values, widths = scene.values, scene.parts["net"].checks.widths(scene.values)
    radius = values[RADIUS]
    if values[DEPTH] >= 0.5 * min(widths):
        yield Refusal(DEPTH, f"{values[DEPTH]:g} m", f"must be less than half of the mouth's width, {min(widths):g} m")
    elif formula(pitch)(radius, widths[1]) >= CORE * radius:
        most = CORE * widths[1] / (math.pi * (1.0 - CORE * CORE))
        expected = f"must be less than {most:.4g} m: in a wider canister {widths[1]:g} m of net make no roll of layers"
        yield Refusal(RADIUS, f"{radius:g} m", expected)


PART = Term(
    "folded to and fro along one axis and rolled up along the other, into a cylindrical canister",
    (*CANISTER, *BOOKED),
    faults=(TOO_DEEP, TOO_ROOMY),
    make=make,
    checks=Checks(lambda values, net: values[RADIUS], volume),
    refuses=refuses,
    extremes=extremes(RADIUS),
)
