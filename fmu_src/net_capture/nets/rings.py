"""Nets of rings and meridians: the generator that the conical and the radial net share.

M meridians run from the mouth's rim, which is ring 0, inwards over R rings; behind the last the net ends, or its
meridians meet in one knot, the tip. Where the knots of a ring would crowd, only every second meridian goes on, then
every fourth. Nodes come in this order:

    knots                                              ring by ring, the tip last
    p-th inner nodes of the threads along the rings    ring by ring for each p = 1 .. s - 1
    p-th inner nodes of the threads inwards            likewise

A ring of more than `LONGEST_ROW` knots stands in several pieces. Threads are straight, and as long as it is from knot
to knot in the net as meant. Bullets stand a quarter of the rim apart, on its diagonals.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from fmu_src.interface import fault
from fmu_src.net_capture import formulas
from fmu_src.net_capture.nets import LARGEST_MESH, Net
from fmu_src.net_capture.nets.ring_measures import (
    BULLETS,
    Profile,
    chord,
    make_measures,
    meridians_of,
    next_every,
    record_of,
)
from fmu_src.net_capture.nets.weave import THREAD, TOO_FINE, add_strip, even_gap, make_thread
from fmu_src.net_capture.planes import FACE_WORDS, LONGEST_ROW, SHOWN
from fmu_src.net_capture.refusal import Refusal, Scene
from fmu_src.rows import parameter
from orbital.kernel import kernel

UNEVEN = fault("uneven", "net.meridians", "net.meridians must be a multiple of four, or 0 for as many as the mesh asks")
RADIUS, TOP = "net.radius", "net.top_radius"
NO_NARROWER = fault(
    "no_narrower", TOP, "net.top_radius must be less than net.radius: seen along the shot nodes would hide one another"
)

_SAID = {
    "net.mesh": "wanted between knots, along rings and inwards: a design choice; the net keeps its mass",
}
ROWS = (
    parameter(
        "net.meridians",
        "1",
        "lines of thread from the rim inwards, a multiple of four; 0: as many as the mesh asks",
        0,
        0,
        LARGEST_MESH,
        kind="Integer",
    ),
    *(replace(row, description=_SAID.get(row.name, row.description)) for row in THREAD),
)
"""Rows that every such net has."""


def make_rings(composition: Any, profile: Profile) -> Net:
    """Kernels of a net of that profile."""
    memory, width = composition.memory, composition.lanes.width
    node_plane, strips, properties = memory.node_plane, memory.strips, memory.properties
    corners, apex, faces = memory.corners, memory.apex, memory.faces
    rings, has_tip, ring = profile.rings, profile.has_tip, profile.ring
    measures = make_measures(kernel, chord, next_every, profile)
    every_of, along_of, inward_of, total = measures.every_of, measures.along_of, measures.inward_of, measures.total
    uneven, too_fine = composition.code(UNEVEN.name), composition.code(TOO_FINE.name)
    no_narrower = composition.code(NO_NARROWER.name)

    @kernel
    def count(p, work):
        """Counts of the graph and size of the mouth into the record; a fault code or 0.

        Checked  tests/net_capture/test_rings.py
        """
        radius, _ = ring(p, 0)
        meridians = meridians_of(radius, p.net_mesh, p.net_meridians)
        if meridians % BULLETS != 0:
            p.fault_value = meridians
            return uneven
        pieces = p.net_segments
        if max(meridians, rings(p)) * pieces > LARGEST_MESH:
            p.fault_value = max(meridians, rings(p)) * pieces
            return too_fine
        widest = 0.0
        for i in range(1, rings(p)):
            further, _ = ring(p, i)
            widest = max(widest, further)
        if widest >= radius:
            p.fault_value = widest
            return no_narrower
        p.grid_columns = meridians
        p.grid_rows = rings(p)
        p.grid_split = (meridians + LONGEST_ROW - 1) // LONGEST_ROW
        p.grid_piece = (meridians + p.grid_split - 1) // p.grid_split
        p.row_pitch = (p.grid_piece + width - 1) // width * width
        tip = 1 if has_tip(p) else 0
        knots = tip
        threads = 0
        quads = 0
        for i in range(p.grid_rows):
            here = meridians // every_of(p, i)
            knots += here
            threads += here
            if i + 1 < p.grid_rows or tip:
                threads += meridians // every_of(p, i + 1)
                quads += here
        p.net_nodes = knots + (pieces - 1) * threads
        p.net_threads = pieces * threads
        lines = (p.grid_rows + tip) + (pieces - 1) * 2 * p.grid_rows
        p.node_slots = lines * p.grid_split * p.row_pitch
        p.rim_nodes = meridians
        p.rim_mesh = chord(radius, meridians, 1)
        p.knot_slots = (p.grid_rows + tip) * p.grid_split * p.row_pitch
        p.net_corners = BULLETS
        p.apex_nodes = 1 if tip else meridians // every_of(p, p.grid_rows - 1)
        p.net_faces = quads
        p.mouth_flat_area = 2.0 * radius * radius
        for i in range(BULLETS):
            p.mouth_side[i] = meridians // BULLETS * chord(radius, meridians, 1)
        for i in range(2):
            p.mouth_width[i] = 2.0 * radius
        p.strips = lay_strips(p, strips(p, work), properties(p, work), False)
        return 0

    @kernel
    def line_node(p, line, j):
        """Slot of the j-th node of a line of nodes.

        Checked  tests/net_capture/test_rings.py
        """
        return (line * p.grid_split + j // p.grid_piece) * p.row_pitch + j % p.grid_piece

    @kernel
    def line_of(p, i, inward, piece):
        """Line of the nodes that begin the piece-th pieces of the threads of ring i, along it or inwards.

        Checked  tests/net_capture/test_rings.py
        """
        if piece == 0:
            return i
        first = p.grid_rows + (1 if has_tip(p) else 0)
        return first + (inward * (p.net_segments - 1) + piece - 1) * p.grid_rows + i

    @kernel
    def end_node(p, i, j, every, inward, piece):
        """Node where the piece-th piece of the thread from knot j of ring i ends.

        Checked  tests/net_capture/test_rings.py
        """
        if piece < p.net_segments - 1:
            return line_node(p, line_of(p, i, inward, piece + 1), j)
        if inward == 0:
            return line_node(p, i, (j + every) % p.grid_columns)
        return line_node(p, i + 1, j) if i + 1 < p.grid_rows else line_node(p, p.grid_rows, 0)

    @kernel
    def lay_strips(p, table, numbers, write):
        """Write all strips, ordered by the rings they begin in; return how many there are [1].

        Checked  tests/net_capture/test_rings.py
        """
        found = 0
        thread = 0
        area = formulas.thread_area(p.net_mass, p.net_density, total(p))
        tip = has_tip(p)
        for i in range(p.grid_rows):
            for inward in range(2):
                if inward == 1 and i + 1 == p.grid_rows and not tip:
                    continue
                every = every_of(p, i)
                step = every_of(p, i + 1) if inward == 1 else every
                unloaded = inward_of(p, i) if inward == 1 else along_of(p, i, every)
                for piece in range(p.net_segments):
                    line = line_of(p, i, inward, piece)
                    j = 0
                    while j < p.grid_columns:
                        a = line_node(p, line, j)
                        b = end_node(p, i, j, every, inward, piece)
                        bits = 1
                        reach = step
                        while (
                            j + reach < p.grid_columns
                            and line_node(p, line, j + reach) == a + reach
                            and end_node(p, i, j + reach, every, inward, piece) == b + reach
                            and (a + reach) // p.row_pitch == a // p.row_pitch
                            and (b + reach) // p.row_pitch == b // p.row_pitch
                        ):
                            bits |= 1 << reach
                            reach += step
                        add_strip(p, table, numbers, found, thread, a, b, bits, unloaded, area, write)
                        found += 1
                        thread += reach - step + 1
                        j += reach
        if not write:  # rigged threads are counted behind them
            p.thread_numbers = thread
        return found

    @kernel
    def lay_out(p, work):
        """Write strips, corners, apex and faces, and every place in the net as meant.

        Checked  tests/net_capture/test_rings.py
        """
        lay_strips(p, strips(p, work), properties(p, work), True)
        for i in range(BULLETS):
            corners(p, work)[i] = i * (p.rim_nodes // BULLETS)
        last = p.grid_rows - 1
        for k in range(p.apex_nodes):
            apex(p, work)[k] = line_node(p, last + 1, 0) if has_tip(p) else line_node(p, last, k * every_of(p, last))
        lay_faces(p, work)
        place(p, work)

    @kernel
    def rim_node(p, n):
        """The n-th node of the first ring.

        Checked  tests/net_capture/test_rings.py
        """
        return line_node(p, 0, n)

    @kernel
    def lay_faces(p, work):
        """Four knots each, or three where a meridian ends and at the tip; all turn as the rim does.

        Checked  tests/net_capture/test_rings.py
        """
        face = 0
        tip = has_tip(p)
        for i in range(p.grid_rows):
            if i + 1 == p.grid_rows and not tip:
                continue
            to_tip = i + 1 == p.grid_rows
            every = every_of(p, i)
            onward = every_of(p, i + 1)
            for j in range(0, p.grid_columns, onward):
                inner = line_node(p, i + 1, 0 if to_tip else j)
                following = line_node(p, i + 1, 0 if to_tip else (j + onward) % p.grid_columns)
                for k in range(j, j + onward, every):
                    is_last = k + every == j + onward
                    faces(p, work)[face] = line_node(p, i, k)
                    faces(p, work)[face + 1] = line_node(p, i, (k + every) % p.grid_columns)
                    faces(p, work)[face + 2] = following if is_last else inner
                    faces(p, work)[face + 3] = inner
                    face += FACE_WORDS

    @kernel
    def put(p, work, node, j, radius, behind):
        """Place of a node in the net as meant, at a meridian, the first of which is a diagonal [m].

        Checked  tests/net_capture/test_rings.py
        """
        angle = 0.25 * math.pi + 2.0 * math.pi * j / p.grid_columns
        node_plane(p, work, SHOWN)[node] = radius * math.cos(angle)
        node_plane(p, work, SHOWN + 1)[node] = radius * math.sin(angle)
        node_plane(p, work, SHOWN + 2)[node] = -behind

    @kernel
    def put_between(p, work, node, first, last, share):
        """Place of a node on the straight way from one to another [m].

        Checked  tests/net_capture/test_rings.py
        """
        for axis in range(3):
            at = node_plane(p, work, SHOWN + axis)
            at[node] = (1.0 - share) * at[first] + share * at[last]

    @kernel
    def place(p, work):
        """Every node's place in the net as meant.

        Checked  tests/net_capture/test_rings.py
        """
        tip = has_tip(p)
        for i in range(p.grid_rows):
            radius, behind = ring(p, i)
            for j in range(0, p.grid_columns, every_of(p, i)):
                put(p, work, line_node(p, i, j), j, radius, behind)
        if tip:
            radius, behind = ring(p, p.grid_rows)
            put(p, work, line_node(p, p.grid_rows, 0), 0, radius, behind)
        for piece in range(1, p.net_segments):
            share = piece / p.net_segments
            for i in range(p.grid_rows):
                for inward in range(2):
                    if inward == 1 and i + 1 == p.grid_rows and not tip:
                        continue
                    every = every_of(p, i)
                    step = every_of(p, i + 1) if inward == 1 else every
                    for j in range(0, p.grid_columns, step):
                        last = end_node(p, i, j, every, inward, p.net_segments - 1)
                        node = line_node(p, line_of(p, i, inward, piece), j)
                        put_between(p, work, node, line_node(p, i, j), last, share)

    return Net(count, lay_out, rim_node, even_gap, make_thread(total, measures.shortest))


def make_refuses(profile: Profile) -> Any:
    """`refuses(scene)` of a net of that profile."""

    def refuses(scene: Scene) -> Iterator[Refusal]:
        """Why it makes no net with these values."""
        values = scene.values
        given, segments = int(values["net.meridians"]), int(values["net.segments"])
        if given % BULLETS:
            yield Refusal("net.meridians", f"{given}", "must be a multiple of four, or 0 for as many as the mesh asks")
            return
        if values.get(TOP, 0.0) >= values[RADIUS]:
            expected = (
                f"must be less than {RADIUS}, {values[RADIUS]:g} m: seen along the shot nodes would hide one another"
            )
            yield Refusal(TOP, f"{values[TOP]:g} m", expected)
            return
        p = record_of(profile, values)
        most = max(p.grid_columns, p.grid_rows)
        if most * segments > LARGEST_MESH:
            cut = f", each cut into {segments} segments" if segments > 1 else ""
            expected = (
                f"the net has {p.grid_columns} meridians and {p.grid_rows} rings{cut}; at most {LARGEST_MESH} pieces"
            )
            yield Refusal("net.mesh", f"{values['net.mesh']:g} m", expected)
            return

    return refuses
