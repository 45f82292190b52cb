"""Nets of straight rows and columns of knots: the generator that square, rectangle and pyramid share.

K columns and M rows of knots, each thread cut into s pieces, in this order of nodes:

    knots                                                            row by row
    p-th inner nodes of the threads along rows, p = 1 .. s - 1       row by row for each p
    p-th inner nodes of the threads across rows                      likewise

A row of more than `LONGEST_ROW` nodes stands in several pieces. A strip runs along a row of nodes or from one to the
next, and ends where the rest length changes.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

from fmu_src.interface import fault
from fmu_src.net_capture import formulas
from fmu_src.net_capture.nets import LARGEST_MESH, Checks, Net, Values
from fmu_src.net_capture.nets.uniform import Lengths, uniform
from fmu_src.net_capture.nets.weave import (
    TOO_FINE,
    add_strip,
    even_gap,
    first_lanes,
    make_thread,
)
from fmu_src.net_capture.planes import FACE_WORDS, LONGEST_ROW, SHOWN
from fmu_src.net_capture.refusal import Refusal, Scene
from orbital.kernel import kernel

WHOLE = 1e-6
"""Share of a mesh by which a side may miss a whole number of them."""

NO_WHOLE_MESHES = "no_whole_meshes"

Sides = Callable[[Values], dict[str, float]]


def checks(sides: Sides, total: Callable[[Values], float], steeper: Callable[[Values], float] | None = None) -> Checks:
    """What a net of a grid says: of its sides by the name of their variable, along the rows first, one name if equal;
    of the length of all its threads [m]; and by how much those up its walls are longer than a mesh, None for flat."""

    def lengths(values: Values) -> Lengths:
        mesh, up = values["net.mesh"], 1.0 if steeper is None else steeper(values)
        has_top = all(round(side / mesh) % 2 == 0 for side in sides(values).values())
        return (2.0 * up if has_top else 1.0 + up) * mesh, (1.0 + 0.5 * up) * mesh, mesh

    return uniform(
        corner=lambda values: _halves(sides(values)),
        widths=lambda values: _both(sides(values)),
        sides=lambda values: [*_both(sides(values))] * 2,
        narrow=lambda values: min(sides(values), key=lambda name: sides(values)[name]),
        knots=lambda values: round(min(sides(values).values()) / values["net.mesh"]) - 1,
        gap=lambda values: values["net.mesh"],
        total=total,
        shortest=lambda values: values["net.mesh"],
        lengths=lengths,
        even=steeper is None,
        nodes=lambda values: nodes_of(values, sides(values)),
        drawing=lambda values: _drawing(sides(values), values["net.mesh"]),
    )


def make_refuses(sides: Sides) -> Callable[[Scene], Iterator[Refusal]]:
    """`refuses(scene)` of a net of a grid with such sides."""
    return lambda scene: _refused(scene, sides(scene.values))


def _both(sides: dict[str, float]) -> tuple[float, float]:
    """Along the rows and across them [m]."""
    along, across = (list(sides.values()) * 2)[:2]
    return along, across


def _halves(sides: dict[str, float]) -> tuple[float, float]:
    along, across = _both(sides)
    return 0.5 * along, 0.5 * across


def _drawing(sides: dict[str, float], mesh: float) -> tuple[list[list[int]], list[int]]:
    columns, rows = (round(side / mesh) + 1 for side in _both(sides))
    along = [[i * columns + j for j in range(columns)] for i in range(rows)]
    across = [[i * columns + j for i in range(rows)] for j in range(columns)]
    rim = [*along[0], *across[-1][1:], *along[-1][-2::-1], *across[0][-2::-1]]
    return [*along, *across], rim


class Grid(NamedTuple):
    """What makes one such net of the grid.

    sides(p)              lengths of the mouth along the rows and across them [m]
    blames                variables of these lengths
    total(p)              length of all threads [m]
    length(p, i, j, d)    unloaded length of the thread from knot (row i, column j) along the row (d = 0) or to the next
                          row (d = 1) [m]
    depth(p, i, j)        how far a knot lies behind the mouth in the net as meant [m]
    """

    sides: Any
    blames: tuple[str, str]
    total: Any
    length: Any
    depth: Any


def whole_meshes(name: str) -> Any:
    """The fault of a side that is no whole number of meshes."""
    return fault(f"{NO_WHOLE_MESHES}_{name}", name, f"{name} must be a whole number of net.mesh, at least 2")


def make_grid(composition: Any, grid: Grid) -> Net:
    """Kernels of a net of that grid."""
    memory, width = composition.memory, composition.lanes.width
    node_plane, strips, properties = memory.node_plane, memory.strips, memory.properties
    corners, apex, faces = memory.corners, memory.apex, memory.faces
    sides, total, length, depth = grid.sides, grid.total, grid.length, grid.depth
    across_fault, along_fault = (composition.code(f"{NO_WHOLE_MESHES}_{name}") for name in grid.blames)
    too_fine = composition.code(TOO_FINE.name)

    @kernel
    def is_whole(meshes):
        """Whether a side holds a whole number of meshes, at least two.

        Checked  tests/net_capture/test_nets.py
        """
        return abs(meshes - round(meshes)) <= WHOLE * round(meshes) and round(meshes) >= 2

    @kernel
    def count(p, work):
        """Counts of the graph and size of the mouth into the record; a fault code or 0.

        Checked  tests/net_capture/test_nets.py
        """
        along, across = sides(p)
        if not is_whole(along / p.net_mesh):
            p.fault_value = along / p.net_mesh
            return across_fault
        if not is_whole(across / p.net_mesh):
            p.fault_value = across / p.net_mesh
            return along_fault
        columns = round(along / p.net_mesh) + 1
        rows = round(across / p.net_mesh) + 1
        pieces = p.net_segments
        if (max(columns, rows) - 1) * pieces > LARGEST_MESH:
            p.fault_value = (max(columns, rows) - 1) * pieces
            return too_fine
        p.grid_columns = columns
        p.grid_rows = rows
        p.grid_split = (columns + LONGEST_ROW - 1) // LONGEST_ROW
        p.grid_piece = (columns + p.grid_split - 1) // p.grid_split
        p.row_pitch = (p.grid_piece + width - 1) // width * width
        whole = rows * (columns - 1) + (rows - 1) * columns
        p.net_nodes = rows * columns + (pieces - 1) * whole
        p.net_threads = pieces * whole
        lines = rows + (pieces - 1) * (rows + rows - 1)
        p.node_slots = lines * p.grid_split * p.row_pitch
        p.rim_nodes = 2 * (rows + columns) - 4
        p.rim_mesh = p.net_mesh
        p.knot_slots = rows * p.grid_split * p.row_pitch
        p.net_corners = 4
        p.apex_nodes = 4
        p.net_faces = (rows - 1) * (columns - 1)
        p.mouth_flat_area = along * across
        for i in range(4):
            p.mouth_side[i] = along if i % 2 == 0 else across
        p.mouth_width[0] = along
        p.mouth_width[1] = across
        p.strips = lay_strips(p, strips(p, work), properties(p, work), False)
        return 0

    @kernel
    def line_node(p, line, j):
        """Slot of the j-th node of a line of nodes.

        Checked  tests/net_capture/test_nets.py
        """
        return (line * p.grid_split + j // p.grid_piece) * p.row_pitch + j % p.grid_piece

    @kernel
    def line_of(p, i, direction, piece):
        """Line of the nodes that begin the piece-th pieces of the threads of row i along a direction.

        Checked  tests/net_capture/test_nets.py
        """
        if piece == 0:
            return i
        if direction == 0:
            return p.grid_rows + (piece - 1) * p.grid_rows + i
        first = p.grid_rows + (p.net_segments - 1) * p.grid_rows
        return first + (piece - 1) * (p.grid_rows - 1) + i

    @kernel
    def end_node(p, i, j, direction, piece):
        """Node where the piece-th piece of the thread from knot (i, j) ends.

        Checked  tests/net_capture/test_nets.py
        """
        if piece < p.net_segments - 1:
            return line_node(p, line_of(p, i, direction, piece + 1), j)
        return line_node(p, i, j + 1) if direction == 0 else line_node(p, i + 1, j)

    @kernel
    def lay_strips(p, table, numbers, write):
        """Write all strips, ordered by the rows they begin in; return how many there are [1].

        Checked  tests/net_capture/test_nets.py
        """
        found = 0
        thread = 0
        pieces = p.net_segments
        area = formulas.thread_area(p.net_mass, p.net_density, total(p))
        for i in range(p.grid_rows):
            for direction in range(2):
                columns = p.grid_columns - 1 if direction == 0 else p.grid_columns
                if direction == 1 and i == p.grid_rows - 1:
                    columns = 0
                for piece in range(pieces):
                    line = line_of(p, i, direction, piece)
                    j = 0
                    while j < columns:
                        a = line_node(p, line, j)
                        b = end_node(p, i, j, direction, piece)
                        unloaded = length(p, i, j, direction)
                        lanes = 1
                        while (
                            j + lanes < columns
                            and line_node(p, line, j + lanes) == a + lanes
                            and end_node(p, i, j + lanes, direction, piece) == b + lanes
                            and (a + lanes) // p.row_pitch == a // p.row_pitch
                            and (b + lanes) // p.row_pitch == b // p.row_pitch
                            and length(p, i, j + lanes, direction) == unloaded
                        ):
                            lanes += 1
                        held = first_lanes(lanes)
                        add_strip(p, table, numbers, found, thread, a, b, held, unloaded, area, write)
                        found += 1
                        thread += lanes
                        j += lanes
        if not write:  # rigged threads are counted behind them
            p.thread_numbers = thread
        return found

    @kernel
    def lay_out(p, work):
        """Write strips, corners, apex and faces, and every place in the net as meant.

        Checked  tests/net_capture/test_nets.py
        """
        lay_strips(p, strips(p, work), properties(p, work), True)
        for i in range(4):
            corners(p, work)[i] = (i + 1) // 2 * (p.grid_columns - 1) + i // 2 * (p.grid_rows - 1)
        last = p.grid_columns - 1
        for i in range(4):
            row = (p.grid_rows - 1 + i // 2) // 2 if p.grid_rows % 2 == 0 else p.grid_rows // 2
            column = (last + i % 2) // 2 if p.grid_columns % 2 == 0 else p.grid_columns // 2
            apex(p, work)[i] = line_node(p, row, column)
        face = 0
        for i in range(p.grid_rows - 1):
            for j in range(last):
                faces(p, work)[face] = line_node(p, i, j)
                faces(p, work)[face + 1] = line_node(p, i, j + 1)
                faces(p, work)[face + 2] = line_node(p, i + 1, j + 1)
                faces(p, work)[face + 3] = line_node(p, i + 1, j)
                face += FACE_WORDS
        place(p, work)

    @kernel
    def rim_node(p, n):
        """The n-th node of the grid's edge, once round from knot (0, 0) along its row.

        Checked  tests/net_capture/test_nets.py
        """
        columns = p.grid_columns - 1
        rows = p.grid_rows - 1
        if n < columns:
            return line_node(p, 0, n)
        if n < columns + rows:
            return line_node(p, n - columns, columns)
        if n < 2 * columns + rows:
            return line_node(p, rows, 2 * columns + rows - n)
        return line_node(p, 2 * (columns + rows) - n, 0)

    @kernel
    def put(p, work, node, row, column, behind):
        """Place of a node in the net as meant, by its row and column [m].

        Checked  tests/net_capture/test_nets.py
        """
        along, across = sides(p)
        node_plane(p, work, SHOWN)[node] = along * (column / (p.grid_columns - 1) - 0.5)
        node_plane(p, work, SHOWN + 1)[node] = across * (row / (p.grid_rows - 1) - 0.5)
        node_plane(p, work, SHOWN + 2)[node] = -behind

    @kernel
    def place(p, work):
        """Every node's place in the net as meant.

        Checked  tests/net_capture/test_nets.py
        """
        pieces = p.net_segments
        for i in range(p.grid_rows):
            for j in range(p.grid_columns):
                here = depth(p, i, j)
                put(p, work, line_node(p, i, j), i, j, here)
                for s in range(1, pieces):
                    share = s / pieces
                    if j < p.grid_columns - 1:
                        there = depth(p, i, j + 1)
                        node = line_node(p, line_of(p, i, 0, s), j)
                        put(p, work, node, i, j + share, here + share * (there - here))
                    if i < p.grid_rows - 1:
                        there = depth(p, i + 1, j)
                        node = line_node(p, line_of(p, i, 1, s), j)
                        put(p, work, node, i + share, j, here + share * (there - here))

    return Net(count, lay_out, rim_node, even_gap, make_thread(total, mesh))


@kernel
def mesh(p):
    """No knot has shorter threads than one of square meshes [m].

    Checked  tests/net_capture/test_nets.py
    """
    return p.net_mesh


@kernel
def flat_length(p, i, j, direction):
    """Every thread is as long as a mesh is wide [m].

    Checked  tests/net_capture/test_nets.py
    """
    return p.net_mesh


@kernel
def no_depth(p, i, j):
    """A flat net lies in its mouth [m]."""
    return 0.0


def node_count(columns: int, rows: int, segments: int) -> int:
    """Nodes of a grid of so many meshes along and across: its knots, and the inner nodes of every thread."""
    threads = (rows + 1) * columns + rows * (columns + 1)
    return (rows + 1) * (columns + 1) + (segments - 1) * threads


def meshes(side: float, mesh: float) -> int | None:
    """Meshes along a side [m]; None where they are no whole number of at least two."""
    count = side / mesh
    whole = round(count) if math.isfinite(count) else 0
    return whole if whole >= 2 and abs(count - whole) <= WHOLE * whole else None


def _refused(scene: Scene, sides: dict[str, float]) -> Iterator[Refusal]:
    """Why a net of a grid makes none with these values."""
    mesh, segments = float(scene.values["net.mesh"]), int(scene.values["net.segments"])
    cut = f", each cut into {segments} segments" if segments > 1 else ""
    for name, side in sides.items():
        if side / mesh * segments > LARGEST_MESH + 0.5:
            expected = (
                f"{name} = {side:g} m holds {side / mesh:.4g} meshes{cut}; at most {LARGEST_MESH} pieces per side"
            )
            yield Refusal("net.mesh", f"{mesh:g} m", expected)
            return
        if meshes(side, mesh) is None:
            expected = f"must be a whole number of net.mesh, {mesh:g} m, and at least 2; it is {side / mesh:.6g}"
            yield Refusal(name, f"{side:g} m", expected)
            return


def nodes_of(parameters: Values, sides: dict[str, float]) -> int:
    """Nodes of a grid with these sides [m]; 1 where there is no such net."""
    mesh, segments = float(parameters["net.mesh"]), int(parameters["net.segments"])
    counts = [meshes(side, mesh) for side in _both(sides)]
    if any(count is None or count > LARGEST_MESH for count in counts):
        return 1
    columns, rows = (count or 0 for count in counts)
    return node_count(columns, rows, segments)
