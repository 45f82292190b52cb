"""A rope along the mouth's rim, made fast at every knot of it beside the net's own thread.

Its pieces reach from knot to knot, as long as the thread beside them, and pull on their own: of the load on the rim
each bears as much as it is stiff.
"""

from __future__ import annotations

import math
from typing import Any

from fmu_src.implied import formula
from fmu_src.interface import Term
from fmu_src.net_capture.nets.weave import first_lanes
from fmu_src.net_capture.planes import LONGEST_ROW, SHOWN
from fmu_src.net_capture.rigging import Checks, Rig, Values
from fmu_src.net_capture.rigging.rope import extremes, make_add_rope, piece, piece_of, rows
from fmu_src.rows import count, peak
from orbital.kernel import kernel


@kernel
def rates(thread, dashpot, node, rope, rope_dashpot, rope_mass):
    """Sums of stiffness over mass [1/s2] and of dashpots over mass [1/s] at a knot of the rim: three threads meet there
    and two pieces of rope.

    thread, dashpot, node        of the net, see `Rig`
    rope, rope_dashpot           of a piece from knot to knot            [N/m], [N s/m]
    rope_mass                    of that piece                           [kg]

    Checked  tests/net_capture/test_rigging.py
    """
    mass = 0.75 * node + rope_mass
    return (3.0 * thread + 2.0 * rope) / mass, (3.0 * dashpot + 2.0 * rope_dashpot) / mass


@kernel
def of_rim(p):
    """Stiffness [N/m], dashpot [N s/m] and mass [kg] of the rope's shortest piece.

    Checked  tests/net_capture/test_rigging.py
    """
    return piece(p.edge_diameter, p.edge_youngs_modulus, p.edge_density, p.edge_damping_ratio, p.rim_mesh)


def make(composition: Any) -> Rig:
    """Kernels for the composition's net."""
    rim_node, rim_gap, memory = composition.net.rim_node, composition.net.rim_gap, composition.memory
    node_plane = memory.node_plane
    add_rope = make_add_rope(memory)

    @kernel
    def run(p, n):
        """How many pieces from the n-th knot of the rim on stand in one strip [1]: neighbours in a row, in one
        direction, of one length.

        Checked  tests/net_capture/test_rigging.py
        """
        here = rim_node(p, n)
        step = rim_node(p, (n + 1) % p.rim_nodes) - here
        if abs(step) != 1 or here // p.row_pitch != (here + step) // p.row_pitch:
            return 1
        found = 1
        while n + found < p.rim_nodes and found < LONGEST_ROW:
            at = rim_node(p, n + found)
            following = rim_node(p, (n + found + 1) % p.rim_nodes)
            if following - at != step or following // p.row_pitch != here // p.row_pitch:
                break
            if rim_gap(p, n + found) != rim_gap(p, n):
                break
            found += 1
        return found

    @kernel
    def count_up(p):
        """Strips and threads of the rope into the counts.

        Checked  tests/net_capture/test_rigging.py
        """
        p.edge_strip = p.strips
        p.edge_thread = p.thread_numbers
        n = 0
        while n < p.rim_nodes:
            p.strips += 1
            n += run(p, n)
        p.net_threads += p.rim_nodes
        p.thread_numbers += p.rim_nodes
        return 0

    @kernel
    def lay_out(p, work):
        """Write the rope's strips.

        Checked  tests/net_capture/test_rigging.py
        """
        strip = p.edge_strip
        thread = p.edge_thread
        n = 0
        while n < p.rim_nodes:
            pieces = run(p, n)
            first = rim_node(p, n)
            second = rim_node(p, (n + 1) % p.rim_nodes)
            squared = 0.0
            for axis in range(3):
                d = node_plane(p, work, SHOWN + axis)[second] - node_plane(p, work, SHOWN + axis)[first]
                squared += d * d
            a = first
            b = second
            if second < first:
                # lanes count upwards, this side of the rim downwards
                a = first - pieces if first - second == 1 else second
                b = a + (first - second)
            stiffness, dashpot, mass = piece(
                p.edge_diameter, p.edge_youngs_modulus, p.edge_density, p.edge_damping_ratio, math.sqrt(squared)
            )
            add_rope(p, work, strip, thread, a, b, first_lanes(pieces), math.sqrt(squared), stiffness, dashpot, mass)
            strip += 1
            thread += pieces
            n += pieces

    @kernel
    def stiffest(p, thread, dashpot, node):
        """See `Rig`.

        Checked  tests/net_capture/test_rigging.py
        """
        rope, rope_dashpot, mass = of_rim(p)
        return rates(thread, dashpot, node, rope, rope_dashpot, mass)

    return Rig(count_up, lay_out, stiffest)


def of_edge(values: Values, net: Any) -> tuple[float, float, float]:
    """Stiffness [N/m], dashpot [N s/m] and mass [kg] of the rope's shortest piece; zeros where a scene has no rope."""
    if "edge.diameter" not in values:
        return 0.0, 0.0, 0.0
    return piece_of(values, "edge", net.gap(values))


def _rates(values: Values, net: Any, thread: float, dashpot: float, node: float) -> tuple[float, float]:
    found: tuple[float, float] = formula(rates)(thread, dashpot, node, *of_edge(values, net))
    return found


def _mass(values: Values, net: Any) -> float:
    return sum(piece_of(values, "edge", side)[2] for side in net.sides(values))


PART = Term(
    "rope along the mouth's rim, made fast at its knots",
    (
        peak("edge.tension_max", "N", "largest tension of the edge rope since the start"),
        peak("edge.tension_peak", "N", "largest tension of the edge rope over the last macro step"),
        *rows("edge", "edge rope", 1e-3),
        count("edge_strip", "its first strip", "state"),
        count("edge_thread", "number of its first piece among the threads", "state"),
    ),
    excludes=("break",),
    make=make,
    extremes=extremes("edge", "edge rope"),
    checks=Checks(_rates, _mass, threads=lambda values, net: len(net.drawing(values)[1]) - 1),
)
