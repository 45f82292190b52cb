"""The hexagonal net: six bullets, six spokes, and between two spokes a mesh of rhombi along both.

Which knots and threads there are, `lattice` says. Nodes come in this order, rows from the lowest on:

    knots                                                        row by row
    p-th inner nodes of the threads along 0 deg, p = 1 .. s - 1  row by row for each p
    those of the threads along 60 deg, then along 120 deg        likewise
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from fmu_src.interface import Term
from fmu_src.net_capture import formulas
from fmu_src.net_capture.nets import LARGEST_MESH, Net
from fmu_src.net_capture.nets.extremes import extremes
from fmu_src.net_capture.nets.grid import whole_meshes
from fmu_src.net_capture.nets.lattice import drawing, knots_of, leads_on, meshes_of, nodes, other_end
from fmu_src.net_capture.nets.uniform import uniform
from fmu_src.net_capture.nets.weave import THREAD, TOO_FINE, add_strip, even_gap, make_thread
from fmu_src.net_capture.planes import FACE_WORDS, LONGEST_ROW, SHOWN
from fmu_src.net_capture.refusal import Refusal, Scene
from fmu_src.rows import positive
from orbital.kernel import kernel

RADIUS = "net.radius"
CORNERS = 6
RISE = math.sqrt(0.75)
"""From row to row, in meshes."""
WHOLE = 1e-6


@kernel
def meshes(p):
    """Meshes of a side [1].

    Checked  tests/net_capture/test_hexagon.py
    """
    return round(p.net_radius / p.net_mesh)


@kernel
def total(p):
    """Length of all threads [m]: 6 n (n + 1) of them.

    Checked  tests/net_capture/test_hexagon.py
    """
    n = round(p.net_radius / p.net_mesh)
    return 6.0 * n * (n + 1) * p.net_mesh


@kernel
def mesh(p):
    """All threads are as long as a mesh is wide [m].

    Checked  tests/net_capture/test_hexagon.py
    """
    return p.net_mesh


def make(composition: Any) -> Net:
    """Kernels of the net."""
    memory, width = composition.memory, composition.lanes.width
    node_plane, strips, properties = memory.node_plane, memory.strips, memory.properties
    corners, apex, faces = memory.corners, memory.apex, memory.faces
    no_whole_meshes, too_fine = (composition.code(fault.name) for fault in (WHOLE_RADIUS, TOO_FINE))

    @kernel
    def count(p, work):
        """Counts of the graph and size of the mouth into the record; a fault code or 0.

        Checked  tests/net_capture/test_hexagon.py
        """
        n = meshes(p)
        if n < 2 or abs(p.net_radius / p.net_mesh - n) > WHOLE * n:
            p.fault_value = p.net_radius / p.net_mesh
            return no_whole_meshes
        pieces = p.net_segments
        if 2 * n * pieces > LARGEST_MESH:
            p.fault_value = 2 * n * pieces
            return too_fine
        p.grid_columns = 2 * n + 1
        p.grid_rows = 2 * n + 1
        p.grid_split = (p.grid_columns + LONGEST_ROW - 1) // LONGEST_ROW
        p.grid_piece = (p.grid_columns + p.grid_split - 1) // p.grid_split
        p.row_pitch = (p.grid_piece + width - 1) // width * width
        threads = 6 * n * (n + 1)
        p.net_nodes = 3 * n * (n + 1) + 1 + (pieces - 1) * threads
        p.net_threads = pieces * threads
        p.node_slots = (1 + 3 * (pieces - 1)) * p.grid_rows * p.grid_split * p.row_pitch
        p.knot_slots = p.grid_rows * p.grid_split * p.row_pitch
        p.rim_nodes = CORNERS * n
        p.rim_mesh = p.net_mesh
        p.net_corners = CORNERS
        p.apex_nodes = 1
        p.net_faces = 6 * n * n
        p.mouth_flat_area = 3.0 * RISE * p.net_radius * p.net_radius
        for i in range(CORNERS):
            p.mouth_side[i] = p.net_radius
        for i in range(2):
            p.mouth_width[i] = 2.0 * p.net_radius
        p.strips = lay_strips(p, strips(p, work), properties(p, work), False)
        return 0

    @kernel
    def line_node(p, line, j):
        """Slot of the j-th node of a line of nodes.

        Checked  tests/net_capture/test_hexagon.py
        """
        return (line * p.grid_split + j // p.grid_piece) * p.row_pitch + j % p.grid_piece

    @kernel
    def line_of(p, i, family, piece):
        """Line of the nodes that begin the piece-th pieces of the threads of row i along a direction.

        Checked  tests/net_capture/test_hexagon.py
        """
        if piece == 0:
            return i
        return (1 + family * (p.net_segments - 1) + piece - 1) * p.grid_rows + i

    @kernel
    def end_node(p, i, j, family, piece):
        """Node where the piece-th piece of the thread from knot (i, j) ends.

        Checked  tests/net_capture/test_hexagon.py
        """
        if piece < p.net_segments - 1:
            return line_node(p, line_of(p, i, family, piece + 1), j)
        row, place = other_end(meshes(p), i, j, family)
        return line_node(p, row, place)

    @kernel
    def lay_strips(p, table, numbers, write):
        """Write all strips, ordered by the rows they begin in; return how many there are [1].

        Checked  tests/net_capture/test_hexagon.py
        """
        n = meshes(p)
        found = 0
        thread = 0
        area = formulas.thread_area(p.net_mass, p.net_density, total(p))
        for i in range(p.grid_rows):
            knots = knots_of(n, i)
            for family in range(3):
                for piece in range(p.net_segments):
                    line = line_of(p, i, family, piece)
                    j = 0
                    while j < knots:
                        if not leads_on(n, i, j, family):
                            j += 1
                            continue
                        a = line_node(p, line, j)
                        b = end_node(p, i, j, family, piece)
                        bits = 0
                        reach = 0
                        last = 0
                        while (
                            j + reach < knots
                            and (
                                not leads_on(n, i, j + reach, family)
                                or end_node(p, i, j + reach, family, piece) == b + reach
                            )
                            and line_node(p, line, j + reach) == a + reach
                            and (a + reach) // p.row_pitch == a // p.row_pitch
                            and (b + reach) // p.row_pitch == b // p.row_pitch
                        ):
                            if leads_on(n, i, j + reach, family):
                                if end_node(p, i, j + reach, family, piece) != b + reach:
                                    break
                                bits |= 1 << reach
                                last = reach
                            reach += 1
                        add_strip(p, table, numbers, found, thread, a, b, bits, p.net_mesh, area, write)
                        found += 1
                        thread += last + 1
                        j += reach
        if not write:  # rigged threads are counted behind them
            p.thread_numbers = thread
        return found

    @kernel
    def rim_node(p, m):
        """The m-th node of the rim, once round from the first knot of the lowest row.

        Checked  tests/net_capture/test_hexagon.py
        """
        n = meshes(p)
        side = m // n
        on = m % n
        if side == 0:
            return line_node(p, 0, on)
        if side < 3:
            row = (side - 1) * n + on
            return line_node(p, row, knots_of(n, row) - 1)
        if side == 3:
            return line_node(p, 2 * n, n - on)
        return line_node(p, (6 - side) * n - on, 0)

    @kernel
    def lay_out(p, work):
        """Write strips, corners, apex and faces, and every place in the net as meant.

        Checked  tests/net_capture/test_hexagon.py
        """
        lay_strips(p, strips(p, work), properties(p, work), True)
        n = meshes(p)
        for i in range(CORNERS):
            corners(p, work)[i] = i * n
        apex(p, work)[0] = line_node(p, n, n)
        face = 0
        for i in range(2 * n):
            for j in range(knots_of(n, i)):
                here = line_node(p, i, j)
                up, right = other_end(n, i, j, 1)
                _, left = other_end(n, i, j, 2)
                if j + 1 < knots_of(n, i):
                    face = lay_face(p, work, face, here, line_node(p, i, j + 1), line_node(p, up, right))
                if left >= 0 and right < knots_of(n, up):
                    face = lay_face(p, work, face, here, line_node(p, up, right), line_node(p, up, left))
        place(p, work)

    @kernel
    def lay_face(p, work, face, first, second, third):
        """Write a triangle of the lattice; where the next begins. Two of them make a rhombus.

        Checked  tests/net_capture/test_hexagon.py
        """
        faces(p, work)[face] = first
        faces(p, work)[face + 1] = second
        faces(p, work)[face + 2] = third
        faces(p, work)[face + 3] = third
        return face + FACE_WORDS

    @kernel
    def put(p, work, node, i, j, on, family):
        """Place of a node in the flat net, that share of a thread away from a knot [m].

        Checked  tests/net_capture/test_hexagon.py
        """
        n = meshes(p)
        turn = family * math.pi / 3.0
        x = j - 0.5 * (knots_of(n, i) - 1) + on * math.cos(turn)
        y = RISE * (i - n) + on * math.sin(turn)
        node_plane(p, work, SHOWN)[node] = p.net_mesh * x
        node_plane(p, work, SHOWN + 1)[node] = p.net_mesh * y
        node_plane(p, work, SHOWN + 2)[node] = 0.0

    @kernel
    def place(p, work):
        """Every node's place in the net as meant.

        Checked  tests/net_capture/test_hexagon.py
        """
        n = meshes(p)
        for i in range(p.grid_rows):
            for j in range(knots_of(n, i)):
                put(p, work, line_node(p, i, j), i, j, 0.0, 0)
                for family in range(3):
                    if leads_on(n, i, j, family):
                        for piece in range(1, p.net_segments):
                            node = line_node(p, line_of(p, i, family, piece), j)
                            put(p, work, node, i, j, piece / p.net_segments, family)

    return Net(count, lay_out, rim_node, even_gap, make_thread(total, mesh))


CHECKS = uniform(
    corner=lambda values: (values[RADIUS], 0.0),
    widths=lambda values: (2.0 * values[RADIUS], 2.0 * values[RADIUS]),
    sides=lambda values: [values[RADIUS]] * CORNERS,
    narrow=lambda values: RADIUS,
    knots=lambda values: meshes_of(values) - 1,
    gap=lambda values: values["net.mesh"],
    total=lambda values: 6.0 * meshes_of(values) * (meshes_of(values) + 1) * values["net.mesh"],
    shortest=lambda values: values["net.mesh"],
    lengths=lambda values: (3.0 * values["net.mesh"], 2.0 * values["net.mesh"], 1.5 * values["net.mesh"]),
    nodes=nodes,
    drawing=drawing,
    bullets=lambda values: CORNERS,
)


def refuses(scene: Scene) -> Iterator[Refusal]:
    """Why it makes no net with these values."""
    values = scene.values
    radius, width, segments = values[RADIUS], values["net.mesh"], int(values["net.segments"])
    if 2.0 * radius / width * segments > LARGEST_MESH + 0.5:
        held = f"{RADIUS} = {radius:g} m holds {radius / width:.4g} meshes, each cut into {segments}"
        expected = f"{held}; at most {LARGEST_MESH} pieces across"
        yield Refusal("net.mesh", f"{width:g} m", expected)
    elif meshes_of(values) < 2 or abs(radius / width - meshes_of(values)) > WHOLE * meshes_of(values):
        expected = f"must be a whole number of net.mesh, {width:g} m, and at least 2; it is {radius / width:.6g}"
        yield Refusal(RADIUS, f"{radius:g} m", expected)


WHOLE_RADIUS = whole_meshes(RADIUS)

PART = Term(
    "hexagonal net: six bullets, six spokes, and rhombi along two spokes in each sector between them",
    (
        positive(RADIUS, "m", "from the middle to a corner, as long as a side; a whole number of meshes", 12.0),
        *THREAD,
    ),
    faults=(WHOLE_RADIUS, TOO_FINE),
    make=make,
    checks=CHECKS,
    refuses=refuses,
    extremes=extremes(CHECKS),
)
