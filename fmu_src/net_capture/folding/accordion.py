"""The net folded to and fro along both axes of the mouth, as an accordion, into a box canister.

Seen along the shot a knot lies where a band folded on the canister's width would have it, along both axes alike; how
deep, its place in the stack says, from one side of the net to the other:

    u = zigzag(s x),  v = zigzag(s y),  w = D (p x / X + q y / Y),   s = sqrt(1 - (D p / X)^2 - (D q / Y)^2)

with p and q = 1 - p in the golden ratio, so that no two layers coincide. That map stretches nothing.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from fmu_src.interface import Term
from fmu_src.net_capture.folding import Checks, Folding, Values
from fmu_src.net_capture.folding.zigzag import (
    DEPTH,
    GOLDEN,
    TOO_DEEP,
    TOO_WIDE,
    extremes,
    fold_width,
    make_spans,
    zigzag,
)
from fmu_src.net_capture.planes import SHOWN, X
from fmu_src.net_capture.refusal import Refusal, Scene
from fmu_src.net_capture.release import BOOKED
from fmu_src.rows import positive
from orbital.kernel import kernel

SHARES = (1.0 - GOLDEN, GOLDEN)
"""Of the depth of the stack that one and the other axis of the mouth take."""
KEPT = 1.0 - 1e-6
"""Of lengths: rounding stretches nothing either."""


def make(composition: Any) -> Folding:
    """Kernels for the composition's net."""
    node_plane, spans = composition.memory.node_plane, make_spans(composition)
    too_deep, too_wide = composition.code(TOO_DEEP.name), composition.code(TOO_WIDE.name)
    first, second = SHARES

    @kernel
    def check(p):
        """See `Folding`.

        Checked  tests/net_capture/test_folding.py
        """
        narrowest = min(p.mouth_width[0], p.mouth_width[1])
        if p.canister_width >= narrowest:
            p.fault_value = p.canister_width
            return too_wide
        if p.canister_depth >= 0.5 * narrowest:
            p.fault_value = p.canister_depth
            return too_deep
        return 0

    @kernel
    def fold(p, work):
        """Every node in its layer, the mouth's first side deepest.

        Checked  tests/net_capture/test_folding.py
        """
        along, across = spans(p, work)
        a = p.canister_depth * first / along
        b = p.canister_depth * second / across
        kept = KEPT * math.sqrt(1.0 - a * a - b * b)
        width = fold_width(p.canister_width, kept * p.rim_mesh)
        for i in range(p.node_slots):
            x = node_plane(p, work, SHOWN)[i] + 0.5 * along
            y = node_plane(p, work, SHOWN + 1)[i] + 0.5 * across
            u = zigzag(kept * x, width)
            v = zigzag(kept * y, width)
            w = a * x + b * y - p.canister_depth
            for axis in range(3):
                at = p.muzzle[axis] + u * p.axes[axis] + v * p.axes[3 + axis] + w * p.axes[6 + axis]
                node_plane(p, work, X + axis)[i] = at

    return Folding(check, fold)


def refuses(scene: Scene) -> Iterator[Refusal]:
    """A canister that is none for this net."""
    values, width = scene.values, min(scene.parts["net"].checks.widths(scene.values))
    if values["canister.width"] >= width:
        expected = f"must be smaller than the mouth is wide, {width:g} m"
        yield Refusal("canister.width", f"{values['canister.width']:g} m", expected)
    elif values[DEPTH] >= 0.5 * width:
        yield Refusal(DEPTH, f"{values[DEPTH]:g} m", f"must be less than half of the mouth's width, {width:g} m")


def volume(values: Values) -> float:
    """Of the box [m3]."""
    return values["canister.width"] ** 2 * values[DEPTH]


PART = Term(
    "folded to and fro along both axes, as an accordion, into a box canister",
    (
        positive("canister.width", "m", "of the canister, square across the shot", 0.3),
        positive(DEPTH, "m", "of the canister, along the shot", 0.3),
        *BOOKED,
    ),
    faults=(TOO_WIDE, TOO_DEEP),
    make=make,
    checks=Checks(lambda values, net: math.sqrt(0.5) * values["canister.width"], volume),
    refuses=refuses,
    extremes=extremes("canister.width"),
)
