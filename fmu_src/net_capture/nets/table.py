"""A net of one's own, from a file of nodes and a file of threads; see `written` for what stands in them.

The kernels read the net as it is laid out in rows and strips beforehand (`own_rows`), from tables that are made of both
files. What a thread weighs and how it pulls they work out themselves: the parameters of its material stay parameters.
"""

from __future__ import annotations

import math
from typing import Any

from fmu_src.interface import Term
from fmu_src.net_capture.nets import Net
from fmu_src.net_capture.nets.extremes import of_threads
from fmu_src.net_capture.nets.own_checks import CHECKS, MOST_NODES, refuses
from fmu_src.net_capture.nets.own_rows import (
    A_COLUMN,
    A_ROW,
    B_COLUMN,
    B_ROW,
    COLUMN,
    HALF_WORD,
    INNER_COLUMN,
    INNER_ROW,
    LANES_HIGH,
    LANES_LOW,
    ROW,
    SPAN,
)
from fmu_src.net_capture.nets.own_tables import (
    DASHPOT,
    DIAMETER,
    FLAT_AREA,
    GAP,
    INNER_ROWS,
    LONGEST,
    MASS,
    MESH,
    PLACE,
    ROWS,
    STIFFNESS,
    TABLES,
    UNLOADED,
    WHOLE_THREADS,
    WIDTH,
)
from fmu_src.net_capture.nets.own_threads import of_kinds, of_thread
from fmu_src.net_capture.nets.weave import THREAD, TOO_FINE
from fmu_src.net_capture.planes import (
    DAMPING,
    FACE_WORDS,
    FIRST,
    LANES,
    LENGTH,
    SHOWN,
    STRIP_NUMBERS,
    STRIP_WORDS,
    THREAD_MASS,
    A,
    B,
)
from fmu_src.net_capture.planes import LONGEST_ROW as MOST_LANES
from fmu_src.net_capture.planes import STIFFNESS as STRIP_STIFFNESS
from fmu_src.net_capture.release import BOOKED
from fmu_src.rows import state
from orbital.kernel import kernel


def make(composition: Any) -> Net:
    """Kernels of the net."""
    memory, width = composition.memory, composition.lanes.width
    node_plane, strips, properties = memory.node_plane, memory.strips, memory.properties
    corners, apex, faces = memory.corners, memory.apex, memory.faces
    sizes, knots, rows = (composition.table(name) for name in ("net.sizes", "net.knots", "net.strips"))
    rim, turns, vertex = (composition.table(name) for name in ("net.rim", "net.corners", "net.apex"))
    spans, kinds = composition.table("net.spans"), composition.table("net.kinds")
    too_fine = composition.code(TOO_FINE.name)

    @kernel
    def slot(p, row, column):
        """Slot of a node by its row and column, as they stand in a table.

        Checked  tests/net_capture/test_own_net.py
        """
        return int(row) * p.row_pitch + int(column)

    @kernel
    def count(p, work):
        """Counts of the graph and size of the mouth into the record; a fault code or 0.

        Checked  tests/net_capture/test_own_net.py
        """
        size = sizes(p)
        pieces = p.net_segments
        threads = int(size[WHOLE_THREADS])
        p.net_nodes = knots(p).shape[0] + (pieces - 1) * threads
        if p.net_nodes > MOST_NODES:
            p.fault_value = p.net_nodes
            return too_fine
        p.net_threads = pieces * threads
        p.row_pitch = (int(size[LONGEST]) + width - 1) // width * width
        p.knot_slots = int(size[ROWS]) * p.row_pitch
        p.node_slots = p.knot_slots + (pieces - 1) * int(size[INNER_ROWS]) * p.row_pitch
        p.rim_nodes = rim(p).shape[0]
        p.net_corners = turns(p).shape[0]
        p.apex_nodes = vertex(p).shape[0]
        p.net_faces = spans(p).shape[0]
        p.mouth_flat_area = size[FLAT_AREA]
        p.net_mesh = size[MESH]
        p.rim_mesh = math.inf
        for n in range(p.rim_nodes):
            p.rim_mesh = min(p.rim_mesh, rim(p)[n, GAP])
        for i in range(p.net_corners):
            p.mouth_side[i] = turns(p)[i, 1]
        for i in range(2):
            p.mouth_width[i] = size[WIDTH]
        p.strips = rows(p).shape[0] * pieces
        p.thread_numbers = 0
        for q in range(rows(p).shape[0]):
            p.thread_numbers += int(rows(p)[q, SPAN]) * pieces
        return 0

    @kernel
    def inner(p, q, piece):
        """Slot of the inner node that ends the piece-th piece of the first thread of a strip.

        Checked  tests/net_capture/test_own_net.py
        """
        row = rows(p)[q, INNER_ROW] + (piece - 1) * sizes(p)[INNER_ROWS]
        return p.knot_slots + slot(p, row, rows(p)[q, INNER_COLUMN])

    @kernel
    def lay_strips(p, table, numbers):
        """Write all strips, in the order of the file.

        Checked  tests/net_capture/test_own_net.py
        """
        pieces = p.net_segments
        thread = 0
        for q in range(rows(p).shape[0]):
            row = rows(p)[q]
            a = slot(p, row[A_ROW], row[A_COLUMN])
            last = slot(p, row[B_ROW], row[B_COLUMN])
            lanes = int(row[LANES_LOW]) | int(row[LANES_HIGH]) << HALF_WORD
            stiffness, dashpot, mass = of_thread(
                row[UNLOADED],
                row[DIAMETER],
                row[STIFFNESS],
                row[MASS],
                row[DASHPOT],
                p.net_youngs_modulus,
                p.net_density,
                p.net_damping_ratio,
            )
            for piece in range(1, pieces + 1):
                b = inner(p, q, piece) if piece < pieces else last
                words = STRIP_WORDS * (q * pieces + piece - 1)
                table[words + A] = a
                table[words + B] = b
                table[words + LANES] = lanes
                table[words + FIRST] = thread
                at = STRIP_NUMBERS * (q * pieces + piece - 1)
                numbers[at + LENGTH] = row[UNLOADED] / pieces
                numbers[at + STRIP_STIFFNESS] = stiffness * pieces
                numbers[at + DAMPING] = dashpot * pieces
                numbers[at + THREAD_MASS] = mass / pieces
                thread += int(row[SPAN])
                a = b

    @kernel
    def lay_out(p, work):
        """Write strips, corners, apex and faces, and every place in the net as meant.

        Checked  tests/net_capture/test_own_net.py
        """
        lay_strips(p, strips(p, work), properties(p, work))
        for i in range(p.net_corners):
            corners(p, work)[i] = int(turns(p)[i, 0])
        for i in range(p.apex_nodes):
            apex(p, work)[i] = slot(p, vertex(p)[i, ROW], vertex(p)[i, COLUMN])
        for face in range(p.net_faces):
            for i in range(FACE_WORDS):
                faces(p, work)[FACE_WORDS * face + i] = slot(p, spans(p)[face, 2 * i], spans(p)[face, 2 * i + 1])
        for axis in range(3):
            at = node_plane(p, work, SHOWN + axis)
            for k in range(knots(p).shape[0]):
                at[slot(p, knots(p)[k, ROW], knots(p)[k, COLUMN])] = knots(p)[k, PLACE + axis]
        if p.net_segments > 1:
            place_within(p, work)

    @kernel
    def place_within(p, work):
        """Places of the inner nodes, evenly on the straight way from knot to knot.

        Checked  tests/net_capture/test_own_net.py
        """
        pieces = p.net_segments
        table = strips(p, work)
        for q in range(rows(p).shape[0]):
            a = table[STRIP_WORDS * q * pieces + A]
            b = table[STRIP_WORDS * (q * pieces + pieces - 1) + B]
            for lane in range(MOST_LANES):
                if (table[STRIP_WORDS * q * pieces + LANES] >> lane) & 1:
                    for piece in range(1, pieces):
                        share = piece / pieces
                        for axis in range(3):
                            at = node_plane(p, work, SHOWN + axis)
                            at[inner(p, q, piece) + lane] = (1.0 - share) * at[a + lane] + share * at[b + lane]

    @kernel
    def rim_node(p, n):
        """The n-th node of the rim.

        Checked  tests/net_capture/test_own_net.py
        """
        return slot(p, rim(p)[n, ROW], rim(p)[n, COLUMN])

    @kernel
    def rim_gap(p, n):
        """From the n-th node of the rim to the next [m].

        Checked  tests/net_capture/test_own_net.py
        """
        return rim(p)[n, GAP]

    @kernel
    def thread(p):
        """See `of_kinds`.

        Checked  tests/net_capture/test_own_net.py
        """
        return of_kinds(kinds(p), p.net_youngs_modulus, p.net_density, p.net_damping_ratio, p.net_segments)

    @kernel
    def knot_count(p):
        """Knots of the file [1].

        Checked  tests/net_capture/test_own_order.py
        """
        return knots(p).shape[0]

    @kernel
    def knot_slot(p, k):
        """Slot of the k-th knot of the file.

        Checked  tests/net_capture/test_own_order.py
        """
        return slot(p, knots(p)[k, ROW], knots(p)[k, COLUMN])

    return Net(count, lay_out, rim_node, rim_gap, thread, knot_count, knot_slot)


_OF_MATERIAL = ("net.segments", "net.youngs_modulus", "net.density", "net.damping_ratio")

PART = Term(
    "net of your own, from a file of nodes and one of threads",
    (
        *(row for row in THREAD if row.name in _OF_MATERIAL),
        state("net.mesh", "m", "width of a square mesh that is nowhere narrower than the net's"),
        *BOOKED,
    ),
    faults=(TOO_FINE,),
    tables=TABLES,
    make=make,
    checks=CHECKS,
    refuses=refuses,
    extremes=of_threads(CHECKS),
)
