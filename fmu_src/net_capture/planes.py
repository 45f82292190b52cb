"""The memory of an instance: planes of node quantities, and the graph of the net as tables.

Nodes stand in *rows* of `row_pitch` slots; node i is in row i // row_pitch, and slots that no node uses have no mass
and stay where they are. Node quantities are planes, one after another, each `node_slots` long, in the precision the
scene asks for.

Threads stand in *strips*: one joins the nodes a + j and b + j, for each bit j that is set in `lanes`, so that every
loop runs over slices with unit stride and a net of any shape is data. A strip has one rest length, stiffness, damping
and mass of a thread, and each of its ends lies in one row; a thread unlike all others is a strip of one lane.

Beside them the graph says which nodes make the mouth's rim, in order, which of these are its corners, which nodes are
bullets, which hold the vertex, and which are the four corners of each face (the last twice for a triangle): all that
asks for the mouth, the hull or a picture looks there, and knows no shape.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from orbital.kernel import kernel, view

X, Y, Z, P, Q, R, U, V, W, FX, FY, FZ, INVERSE_MASS, MASS, SHOWN, SHOWN_RATE, SHOWN_BACK = (
    *range(14),
    14,
    17,
    20,
)
"""Node planes: position [m], velocity at the same instant, for dashpots [m/s], velocity that the scheme keeps [m/s],
force [N], 1/m [1/kg] (zero: unused slot), m [kg]; position, velocity and velocity half a substep back as
shown, three planes each."""
NODE_PLANES = 23

MOST_BULLETS = 8
LONGEST_ROW = 64
"""Slots: a bit each of one word."""

A, B, LANES, FIRST, STRIP_WORDS = range(5)
"""Columns of the strips, whole numbers: node of lane 0 at either end, lanes that are threads, number of the first
thread. The others of a strip are numbered by their lanes, and the next strip goes on after its last."""
LENGTH, STIFFNESS, DAMPING, THREAD_MASS, SQUARED, PER_SQUARED, DAMPING_PER_SQUARED, STRIP_NUMBERS = range(8)
"""Columns of the strips' properties: rest length [m], stiffness [N/m], dashpot [N s/m], mass of a thread [kg]; a net
writes these, and `complete_strips` the others: L2 [m2], 1/L2 [1/m2] and d/L2 [N s/m3]."""
FACE_WORDS = 4


class Memory(NamedTuple):
    """Kernels that find what lies in the work memory; each returns a slice, to be used where it was called.

    node_plane(p, work, plane)     one plane of node quantities
    strips(p, work)                strip table, STRIP_WORDS whole numbers each
    properties(p, work)            their properties, STRIP_NUMBERS numbers each
    rim(p, work)                   nodes of the rim in order, `rim_nodes` of them
    corners(p, work)               numbers of the rim's nodes that are corners of the mouth, in order
    bullets(p, work)               nodes that are bullets, one for each corner
    apex(p, work)                  nodes that share the vertex
    faces(p, work)                 nodes of every face, FACE_WORDS each
    own(p, work)                   the scheme's own, `scheme_words` whole numbers
    reals(work)                    the planes as one array
    """

    node_plane: Any
    strips: Any
    properties: Any
    rim: Any
    corners: Any
    bullets: Any
    apex: Any
    faces: Any
    own: Any
    reals: Any


def make_memory(precision: str) -> Memory:
    """The memory of a model of that precision."""
    from fmu_src.lanes import of, whole

    reals = of(precision).reals
    per_double = {"double": 1, "single": 2}[precision]

    @view
    def node_plane(p, work, plane):
        """One plane of node quantities.

        Checked  tests/net_capture/test_nets.py
        """
        return reals(work)[plane * p.node_slots : (plane + 1) * p.node_slots]

    @kernel
    def base(p):
        """Where the planes end [doubles].

        Checked  tests/net_capture/test_nets.py
        """
        return p.node_planes * p.node_slots // per_double

    @view
    def strips(p, work):
        """Strip table, STRIP_WORDS whole numbers each.

        Checked  tests/net_capture/test_nets.py
        """
        return whole(work)[base(p) : base(p) + STRIP_WORDS * p.strips]

    @kernel
    def properties_at(p):
        """Where the strips' properties begin [doubles].

        Checked  tests/net_capture/test_nets.py
        """
        return base(p) + STRIP_WORDS * p.strips

    @view
    def properties(p, work):
        """Properties of the strips, STRIP_NUMBERS numbers each.

        Checked  tests/net_capture/test_nets.py
        """
        return work[properties_at(p) : properties_at(p) + STRIP_NUMBERS * p.strips]

    @kernel
    def rim_at(p):
        """Where the rim begins [doubles].

        Checked  tests/net_capture/test_nets.py
        """
        return properties_at(p) + STRIP_NUMBERS * p.strips

    @view
    def rim(p, work):
        """Nodes of the rim, in order.

        Checked  tests/net_capture/test_nets.py
        """
        return whole(work)[rim_at(p) : rim_at(p) + p.rim_nodes]

    @kernel
    def corners_at(p):
        """Where the corners begin [doubles].

        Checked  tests/net_capture/test_nets.py
        """
        return rim_at(p) + p.rim_nodes

    @view
    def corners(p, work):
        """Numbers of the rim's nodes with bullets, in order.

        Checked  tests/net_capture/test_nets.py
        """
        return whole(work)[corners_at(p) : corners_at(p) + p.net_corners]

    @view
    def bullets(p, work):
        """Nodes that are bullets, one for each corner.

        Checked  tests/net_capture/test_nets.py
        """
        return whole(work)[corners_at(p) + p.net_corners : corners_at(p) + 2 * p.net_corners]

    @view
    def apex(p, work):
        """Nodes that share the vertex.

        Checked  tests/net_capture/test_nets.py
        """
        return whole(work)[corners_at(p) + 2 * p.net_corners : corners_at(p) + 2 * p.net_corners + p.apex_nodes]

    @kernel
    def faces_at(p):
        """Where the faces begin [doubles].

        Checked  tests/net_capture/test_nets.py
        """
        return corners_at(p) + 2 * p.net_corners + p.apex_nodes

    @view
    def faces(p, work):
        """Nodes of every face, FACE_WORDS each.

        Checked  tests/net_capture/test_nets.py
        """
        return whole(work)[faces_at(p) : faces_at(p) + FACE_WORDS * p.net_faces]

    @view
    def own(p, work):
        """The scheme's own words.

        Checked  tests/net_capture/test_nets.py
        """
        return whole(work)[faces_at(p) + FACE_WORDS * p.net_faces : p.work_size]

    return Memory(node_plane, strips, properties, rim, corners, bullets, apex, faces, own, reals)


@kernel
def work_size(p, per_double, own_words):
    """Doubles of work memory [1]: planes, tables of the graph, the scheme's own words.

    Checked  tests/net_capture/test_nets.py
    """
    graph = (STRIP_WORDS + STRIP_NUMBERS) * p.strips + p.rim_nodes + 2 * p.net_corners + p.apex_nodes
    return p.node_planes * p.node_slots // per_double + graph + FACE_WORDS * p.net_faces + own_words


@kernel
def complete_strips(p, numbers):
    """Work out what follows from the strips' properties.

    Checked  tests/net_capture/test_nets.py
    """
    for q in range(0, STRIP_NUMBERS * p.strips, STRIP_NUMBERS):
        squared = numbers[q + LENGTH] * numbers[q + LENGTH]
        numbers[q + SQUARED] = squared
        numbers[q + PER_SQUARED] = 1.0 / squared
        numbers[q + DAMPING_PER_SQUARED] = numbers[q + DAMPING] / squared
