"""Numbers of the nodes as outputs count them: in the order of their slots, or knots first, in an order of the net's."""

from __future__ import annotations

from typing import Any, NamedTuple

from fmu_src.net_capture.planes import MASS, SHOWN
from orbital.kernel import kernel


class Numbering(NamedTuple):
    """Kernels of the numbers.

    of(p, work, slot)    number of the node in a slot, from 1
    write(p, work)       positions of all nodes into `node_position`, in the order of their numbers
    """

    of: Any
    write: Any


def make_numbering(composition: Any) -> Numbering:
    """Kernels for the composition's net."""
    node_plane, knot_slot = composition.memory.node_plane, composition.net.knot_slot
    has_order, has_nodes = knot_slot is not None, "nodes" in composition.terms
    knots = composition.net.knots

    @kernel
    def of(p, work, slot):
        """Number of the node in a slot, counted from 1 over those that hold one.

        Checked  tests/net_capture/test_hardest.py, tests/net_capture/test_own_order.py
        """
        first = 0
        found = 0
        if has_order:
            if slot < p.knot_slots:
                for k in range(knots(p)):
                    if knot_slot(p, k) == slot:
                        return k + 1
            first = p.knot_slots
            found = knots(p)
        mass = node_plane(p, work, MASS)
        for i in range(first, slot + 1):
            found += 1 if mass[i] > 0.0 else 0
        return found

    @kernel
    def put(p, work, number, slot):
        """Position of the node in a slot [m]; numbers from 0 here.

        Checked  tests/net_capture/test_own_order.py
        """
        if has_nodes:
            for axis in range(3):
                p.node_position[number, axis] = node_plane(p, work, SHOWN + axis)[slot]

    @kernel
    def write(p, work):
        """Positions of all nodes, unused slots passed over.

        Checked  tests/net_capture/test_nets.py, tests/net_capture/test_own_order.py
        """
        mass = node_plane(p, work, MASS)
        first = 0
        found = 0
        if has_order:
            for k in range(knots(p)):
                put(p, work, k, knot_slot(p, k))
            first = p.knot_slots
            found = knots(p)
        for slot in range(first, p.node_slots):
            if mass[slot] > 0.0:
                put(p, work, found, slot)
                found += 1

    return Numbering(of, write)
