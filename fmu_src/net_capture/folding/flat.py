"""The net folded flat, normal to the shot, into a small square: seen along the shot it is shrunk to that."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from fmu_src.interface import Term, fault
from fmu_src.net_capture.folding import Checks, Folding, Values
from fmu_src.net_capture.planes import SHOWN, X
from fmu_src.net_capture.refusal import Refusal, Scene
from fmu_src.rows import positive
from orbital.kernel import kernel

SIDE = "net.fold_side"
TOO_LARGE = fault("fold_too_large", SIDE, "net.fold_side must be smaller than the mouth of the net is wide")


def make(composition: Any) -> Folding:
    """Kernels for the composition's net."""
    node_plane, too_large = composition.memory.node_plane, composition.code(TOO_LARGE.name)

    @kernel
    def check(p):
        """See `Folding`.

        Checked  tests/net_capture/test_nets.py
        """
        if p.net_fold_side >= min(p.mouth_width[0], p.mouth_width[1]):
            p.fault_value = p.net_fold_side
            return too_large
        return 0

    @kernel
    def fold(p, work):
        """Every node where it is in the net as meant, seen along the shot and shrunk to the square.

        Checked  tests/net_capture/test_nets.py
        """
        for i in range(p.node_slots):
            along = p.net_fold_side / p.mouth_width[0] * node_plane(p, work, SHOWN)[i]
            across = p.net_fold_side / p.mouth_width[1] * node_plane(p, work, SHOWN + 1)[i]
            for axis in range(3):
                at = p.muzzle[axis] + along * p.axes[axis] + across * p.axes[3 + axis]
                node_plane(p, work, X + axis)[i] = at

    return Folding(check, fold)


def _radius(values: Values, net: Any) -> float:
    shares = (place / width for place, width in zip(net.corner(values), net.widths(values), strict=True))
    return float(values[SIDE] * math.hypot(*shares))


def refuses(scene: Scene) -> Iterator[Refusal]:
    """A net that would have to be stretched."""
    width = min(scene.parts["net"].checks.widths(scene.values))
    if scene.values[SIDE] >= width:
        yield Refusal(SIDE, f"{scene.values[SIDE]:g} m", f"must be smaller than the mouth is wide, {width:g} m")


PART = Term(
    "folded flat into a square",
    (positive(SIDE, "m", "side of the flat square the net is folded into", 0.5),),
    faults=(TOO_LARGE,),
    make=make,
    checks=Checks(_radius, lambda values: 0.0),
    refuses=refuses,
)
