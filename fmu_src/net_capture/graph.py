"""The whole graph: the net's own, and what is rigged to it."""

from __future__ import annotations

from typing import Any, NamedTuple

from fmu_src.interface import fault
from fmu_src.net_capture.planes import LANES, LONGEST_ROW, MASS, STRIP_NUMBERS, STRIP_WORDS, THREAD_MASS, A, B
from fmu_src.net_capture.rigging import Rig
from orbital.kernel import kernel

WRONG_NUMBER = fault(
    "wrong_number", "net.mesh", "this FMU is built for another number of bullets than the net has corners"
)


class Graph(NamedTuple):
    """Kernels of the graph.

    count(p, work) -> fault            how many of everything there are, and the size of the mouth, into the record
    lay_out(p, work)                   write it, the masses of its threads, and every node's place as meant
    rates(p, thread, dashpot, node)    the largest of all riggings, see `rigging.Rig`; None without any
    """

    count: Any
    lay_out: Any
    rates: Any


def make_graph(composition: Any) -> Graph:
    """Kernels of the composition's net and riggings together."""
    net, memory = composition.net, composition.memory
    node_plane, strips, properties, rim = memory.node_plane, memory.strips, memory.properties, memory.rim
    corners, bullets = memory.corners, memory.bullets
    count_of, lay_net, rim_node = net.count, net.lay_out, net.rim_node
    planes = composition.planes
    number, wrong_number = composition.bullets, composition.code(WRONG_NUMBER.name)
    rig = _together(composition.rigging)
    has_rig = rig is not None
    count_rig, lay_rig = (rig.count, rig.lay_out) if rig is not None else (None, None)

    @kernel
    def count(p, work):
        """Counts of the graph and size of the mouth into the record; a fault code or 0.

        Checked  tests/net_capture/test_nets.py
        """
        fault = count_of(p, work)
        if fault != 0:
            return fault
        if p.net_corners != number:
            p.fault_value = number
            return wrong_number
        p.net_strips = p.strips
        p.node_planes = planes
        if has_rig:
            fault = count_rig(p)
        return fault

    @kernel
    def lay_masses(p, work, first, end):
        """Half of every thread of some strips to each of its nodes [kg].

        Checked  tests/net_capture/test_nets.py
        """
        mass = node_plane(p, work, MASS)
        table = strips(p, work)
        numbers = properties(p, work)
        for q in range(first, end):
            half = 0.5 * numbers[STRIP_NUMBERS * q + THREAD_MASS]
            for lane in range(LONGEST_ROW):
                if (table[STRIP_WORDS * q + LANES] >> lane) & 1:
                    mass[table[STRIP_WORDS * q + A] + lane] += half
                    mass[table[STRIP_WORDS * q + B] + lane] += half

    @kernel
    def lay_out(p, work):
        """Write the net, its rim and its bullets, what is rigged to it, and the masses of all threads.

        Checked  tests/net_capture/test_nets.py
        """
        lay_net(p, work)
        for n in range(p.rim_nodes):
            rim(p, work)[n] = rim_node(p, n)
        for corner in range(p.net_corners):
            bullets(p, work)[corner] = rim(p, work)[corners(p, work)[corner]]
        lay_masses(p, work, 0, p.net_strips)
        if has_rig:
            lay_rig(p, work)
            lay_masses(p, work, p.net_strips, p.strips)

    return Graph(count, lay_out, rig.rates if rig is not None else None)


def _together(riggings: list[Rig]) -> Rig | None:
    """One rigging of several, each after those before it; None of none."""
    if not riggings:
        return None
    first, *others = riggings
    rest = _together(others)
    if rest is None:
        return first
    count_first, lay_first, rates_first = first.count, first.lay_out, first.rates
    count_rest, lay_rest, rates_rest = rest.count, rest.lay_out, rest.rates

    @kernel
    def count(p):
        """See `rigging.Rig`.

        Checked  tests/net_capture/test_rigging.py
        """
        fault = count_first(p)
        return fault if fault != 0 else count_rest(p)

    @kernel
    def lay_out(p, work):
        """See `rigging.Rig`.

        Checked  tests/net_capture/test_rigging.py
        """
        lay_first(p, work)
        lay_rest(p, work)

    @kernel
    def rates(p, thread, dashpot, node):
        """See `rigging.Rig`.

        Checked  tests/net_capture/test_rigging.py
        """
        stiff, damped = rates_first(p, thread, dashpot, node)
        stiffer, more_damped = rates_rest(p, thread, dashpot, node)
        return max(stiff, stiffer), max(damped, more_damped)

    return Rig(count, lay_out, rates)
