"""The lattice of a hexagonal net: which knots and threads there are.

Its knots are those of equilateral triangles within a hexagon of n meshes a side, in rows from the lowest on. With axial
coordinates q along 0 deg and r along 60 deg they are those of which q, r and q + r are none beyond n. Threads are of
three families, along 0, 60 and 120 deg; a sector between two spokes has those along both of them, and the rim is whole.
"""

from __future__ import annotations

import math
from typing import Any

from fmu_src.implied import formula
from fmu_src.net_capture.nets import LARGEST_MESH, Values
from orbital.kernel import kernel


@kernel
def is_thread(n, q, r, family):
    """Whether the net has the thread along 0, 60 or 120 deg, family 0, 1 or 2, whose middle is at these doubled axial
    coordinates.

    n    meshes of a side

    Checked  tests/net_capture/test_hexagon.py
    """
    if max(abs(q), abs(r), abs(q + r)) == 2 * n:
        return True  # along the rim
    if r < 0 or (r == 0 and q < 0):
        q = -q
        r = -r
    if q >= 0:
        return family != 2
    return family != 0 if q + r >= 0 else family != 1


@kernel
def knots_of(n, i):
    """Knots of the i-th row [1].

    Checked  tests/net_capture/test_hexagon.py
    """
    return 2 * n + 1 - abs(i - n)


@kernel
def other_end(n, i, j, family):
    """Row and place in it of the knot to which the thread along 0, 60 or 120 deg leads from a knot.

    Checked  tests/net_capture/test_hexagon.py
    """
    if family == 0:
        return i, j + 1
    # below the middle the next row begins half a mesh farther to the left, above it farther to the right
    return i + 1, j + (1 if i < n else 0) - (family - 1)


def make_leads_on(is_thread: Any, other_end: Any, knots_of: Any) -> Any:
    """Function `leads_on(n, i, j, family)` of the three above, as kernels or as plain Python.

    Checked  tests/net_capture/test_hexagon.py
    """

    def leads_on(n, i, j, family):
        """Whether a thread of that family leads on from a knot.

        Checked  tests/net_capture/test_hexagon.py
        """
        row, place = other_end(n, i, j, family)
        if row > 2 * n or place < 0 or place >= knots_of(n, row):
            return False
        q = j - n + max(n - i, 0)
        end_q = place - n + max(n - row, 0)
        return is_thread(n, q + end_q, i + row - 2 * n, family)

    return leads_on


leads_on = kernel(make_leads_on(is_thread, other_end, knots_of))


def meshes_of(values: Values) -> int:
    """Meshes of a side [1]."""
    return round(values["net.radius"] / values["net.mesh"])


def nodes(values: Values) -> int:
    """Nodes with the inner ones of all threads; 1 where there is no such net [1]."""
    n = meshes_of(values) if 0.0 < values["net.mesh"] < math.inf else 0
    if not 2 <= n <= LARGEST_MESH:
        return 1
    return 3 * n * (n + 1) + 1 + (int(values["net.segments"]) - 1) * 6 * n * (n + 1)


def drawing(values: Values) -> tuple[list[list[int]], list[int]]:
    """Every thread as a line, and the rim, closed, in numbers of knots."""
    n = meshes_of(values)
    count = [2 * n + 1 - abs(i - n) for i in range(2 * n + 1)]
    first = [sum(count[:i]) for i in range(2 * n + 1)]
    ends = formula(other_end)
    leads = make_leads_on(formula(is_thread), ends, formula(knots_of))
    lines = []
    for i in range(2 * n + 1):
        for j in range(count[i]):
            for family in range(3):
                if leads(n, i, j, family):
                    row, place = ends(n, i, j, family)
                    lines.append([first[i] + j, first[row] + place])
    right = [first[i] + count[i] - 1 for i in range(2 * n + 1)]
    rim = [*range(first[0], count[0]), *right[1:], *range(right[-1] - 1, first[-1] - 1, -1), *first[-2::-1]]
    return lines, rim
