"""The net folded flat, normal to the shot, into a small square: no thread is then longer than its rest length."""

from __future__ import annotations

from typing import Any

from fmu_src.interface import Term
from fmu_src.net_capture.folding import Folding
from fmu_src.net_capture.planes import SHOWN, X
from orbital.kernel import kernel


def make(composition: Any) -> Folding:
    """Kernels for the composition's net."""
    node_plane = composition.memory.node_plane

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

    return Folding(fold)


PART = Term("folded flat into a square", make=make)
