"""Bullets on leads: each hangs on a line of its own from its corner of the mouth, outward along the diagonal."""

from __future__ import annotations

import math
from typing import Any

from fmu_src.extremes import Extreme
from fmu_src.implied import formula
from fmu_src.interface import Term
from fmu_src.net_capture.nets.weave import first_lanes
from fmu_src.net_capture.planes import SHOWN
from fmu_src.net_capture.rigging import Checks, Rig, Values
from fmu_src.net_capture.rigging.edge import of_edge, of_rim
from fmu_src.net_capture.rigging.rope import extremes, make_add_rope, piece, piece_of, rows
from fmu_src.rows import count, parameter, peak, positive
from orbital.kernel import kernel

MOST_PIECES = 64


@kernel
def rates(thread, dashpot, node, bullet, lead, lead_dashpot, lead_mass, pieces, rope, rope_dashpot, rope_mass):
    """The largest sums of stiffness over mass [1/s2] and of dashpots over mass [1/s]: at a corner of the net, within a
    lead, or at a bullet.

    thread, dashpot, node            of the net, see `Rig`
    bullet                           mass of one                              [kg]
    lead, lead_dashpot, lead_mass    of a piece of a lead                     [N/m], [N s/m], [kg]
    pieces                           of each lead                             [1]
    rope, rope_dashpot, rope_mass    of a piece of the rope along the rim, zeros without one

    Checked  tests/net_capture/test_rigging.py
    """
    corner = 0.5 * (node + lead_mass) + rope_mass
    end = bullet + 0.5 * lead_mass
    stiff = max((3.0 * thread + 2.0 * rope + lead) / corner, lead / end)
    damped = max((3.0 * dashpot + 2.0 * rope_dashpot + lead_dashpot) / corner, lead_dashpot / end)
    if pieces > 1:
        stiff = max(stiff, 2.0 * lead / lead_mass)
        damped = max(damped, 2.0 * lead_dashpot / lead_mass)
    return stiff, damped


def make(composition: Any) -> Rig:
    """Kernels for the composition's net."""
    memory = composition.memory
    node_plane, rim, corners, bullets = memory.node_plane, memory.rim, memory.corners, memory.bullets
    add_rope, has_rope = make_add_rope(memory), "edge" in composition.terms

    @kernel
    def rows_each(p):
        """Rows of nodes that a lead stands in [1].

        Checked  tests/net_capture/test_rigging.py
        """
        return (p.leads_segments + p.row_pitch - 1) // p.row_pitch

    @kernel
    def lead_node(p, lead, k):
        """Slot of the k-th node of a lead; the last is the bullet.

        Checked  tests/net_capture/test_rigging.py
        """
        return p.leads_slot + lead * rows_each(p) * p.row_pitch + k

    @kernel
    def count_up(p):
        """Nodes, strips and threads of the leads into the counts.

        Checked  tests/net_capture/test_rigging.py
        """
        p.leads_strip = p.strips
        p.leads_thread = p.thread_numbers
        p.leads_slot = p.node_slots
        # from the corner, within each row, and from row to row
        p.strips += p.net_corners * 2 * rows_each(p)
        if p.leads_segments % p.row_pitch == 1 or p.row_pitch == 1:
            p.strips -= p.net_corners
        p.node_slots += p.net_corners * rows_each(p) * p.row_pitch
        p.net_nodes += p.net_corners * p.leads_segments
        p.net_threads += p.net_corners * p.leads_segments
        p.thread_numbers += p.net_corners * p.leads_segments
        return 0

    @kernel
    def lay_out(p, work):
        """Write strips and bullets, and the places of their nodes: straight on from the middle of the mouth.

        Checked  tests/net_capture/test_rigging.py
        """
        length = p.leads_length / p.leads_segments
        stiffness, dashpot, mass = piece(
            p.leads_diameter, p.leads_youngs_modulus, p.leads_density, p.leads_damping_ratio, length
        )
        strip = p.leads_strip
        thread = p.leads_thread
        for lead in range(p.net_corners):
            corner = rim(p, work)[corners(p, work)[lead]]
            before = corner
            k = 0
            while k < p.leads_segments:
                first = lead_node(p, lead, k)
                add_rope(p, work, strip, thread, before, first, 1, length, stiffness, dashpot, mass)
                strip += 1
                thread += 1
                inside = min(p.leads_segments - k, p.row_pitch) - 1
                if inside > 0:
                    held = first_lanes(inside)
                    add_rope(p, work, strip, thread, first, first + 1, held, length, stiffness, dashpot, mass)
                    strip += 1
                    thread += inside
                before = first + inside
                k += inside + 1
            bullets(p, work)[lead] = before
            along = 1.0 * node_plane(p, work, SHOWN)[corner]
            across = 1.0 * node_plane(p, work, SHOWN + 1)[corner]
            radius = math.sqrt(along * along + across * across)
            for k in range(p.leads_segments):
                farther = 1.0 + (k + 1) * length / radius
                node = lead_node(p, lead, k)
                node_plane(p, work, SHOWN)[node] = farther * along
                node_plane(p, work, SHOWN + 1)[node] = farther * across
                node_plane(p, work, SHOWN + 2)[node] = node_plane(p, work, SHOWN + 2)[corner]

    @kernel
    def stiffest(p, thread, dashpot, node):
        """See `Rig`.

        Checked  tests/net_capture/test_rigging.py
        """
        lead, lead_dashpot, mass = piece(
            p.leads_diameter,
            p.leads_youngs_modulus,
            p.leads_density,
            p.leads_damping_ratio,
            p.leads_length / p.leads_segments,
        )
        rope = rope_dashpot = rope_mass = 0.0
        if has_rope:
            rope, rope_dashpot, rope_mass = of_rim(p)
        pieces = p.leads_segments
        return rates(
            thread, dashpot, node, p.bullets_mass, lead, lead_dashpot, mass, pieces, rope, rope_dashpot, rope_mass
        )

    return Rig(count_up, lay_out, stiffest)


def _piece(values: Values) -> tuple[float, float, float]:
    return piece_of(values, "leads", values["leads.length"] / values["leads.segments"])


def _rates(values: Values, net: Any, thread: float, dashpot: float, node: float) -> tuple[float, float]:
    pieces = int(values["leads.segments"])
    found: tuple[float, float] = formula(rates)(
        thread, dashpot, node, values["bullets.mass"], *_piece(values), pieces, *of_edge(values, net)
    )
    return found


def _mass(values: Values, net: Any) -> float:
    return float(net.bullets(values) * values["leads.segments"] * _piece(values)[2])


def _lines(values: Values, net: Any) -> list[list[int]]:
    """From each corner of the mouth to its bullet."""
    _, rim = net.drawing(values)
    if net.turns is not None:
        turns = net.turns(values)
    else:
        sides = net.sides(values)
        turns = [round((len(rim) - 1) * sum(sides[:k]) / sum(sides)) for k in range(len(sides))]
    pieces, first = int(values["leads.segments"]), net.nodes(values)
    return [[rim[turn], *range(first + k * pieces, first + (k + 1) * pieces)] for k, turn in enumerate(turns)]


PART = Term(
    "bullets on leads of their own, from the corners of the mouth outward",
    (
        positive("leads.length", "m", "of each lead, from the mouth's corner to the bullet", 1.0),
        parameter("leads.segments", "1", "pieces each lead is cut into", 1, 1, MOST_PIECES, kind="Integer"),
        peak("leads.tension_max", "N", "largest tension of the leads since the start"),
        peak("leads.tension_peak", "N", "largest tension of the leads over the last macro step"),
        *rows("leads", "leads", 1e-3),
        count("leads_strip", "their first strip", "state"),
        count("leads_thread", "number of their first piece among the threads", "state"),
        count("leads_slot", "slot of their first node", "state"),
    ),
    excludes=("closing", "break"),
    make=make,
    extremes=(
        *extremes("leads", "leads"),
        Extreme(
            "leads of 1 cm",
            "a piece far shorter and lighter than a thread of the net",
            "energy_gained",
            {"leads.length": 0.01, "leads.segments": 1},
            duration=2.0,
        ),
    ),
    checks=Checks(
        _rates,
        _mass,
        nodes=lambda values, net: net.bullets(values) * int(values["leads.segments"]),
        threads=lambda values, net: net.bullets(values) * int(values["leads.segments"]),
        corner=lambda values, net: 0.5 * _piece(values)[2],
        reach=lambda values: float(values["leads.length"]),
        lines=_lines,
    ),
)
