"""Of a union whose pieces swing: the box that holds them now, and to which body the point of the surface found last
belongs."""

from __future__ import annotations

import math
from typing import Any

from orbital.kernel import kernel

NOT_ASKED = -1
"""Of whether the piece found last swings."""


@kernel
def close_round(half, rows):
    """half = half the edges of the box about the centre of mass that holds pieces as they are now [m] (3,).

        max over the pieces of |c_i| + sum_j |R_ij| h_j

    rows          the pieces, see `shapes.union.WORDS`               (n, 19)
    c, R, h       of each its middle, matrix to the body axes, and half the edges of its own box

    Valid    kinds as `union.piece_distance` has them; round pieces are held by the boxes round them
    Checked  tests/net_capture/test_hinged_bounds.py
    """
    for i in range(3):
        half[i] = 0.0
    for k in range(rows.shape[0]):
        row = rows[k]
        kind, x, y, z = row[0], row[1], row[2], row[3]
        if kind == 1.0 or kind == 4.0:
            y, z = x, 0.5 * y
        elif kind == 2.0:
            y, z = x, x
        elif kind == 3.0:
            x = max(x, y)
            y, z = x, 0.5 * z
        for i in range(3):
            way = abs(row[8 + 3 * i]) * x + abs(row[9 + 3 * i]) * y + abs(row[10 + 3 * i]) * z
            half[i] = max(half[i], abs(row[5 + i]) + way)


def make_touched(pieces_of: Any, away: Any) -> Any:
    """Kernel `touched(p)` of a union.

    pieces_of    its table;  away   distance of a point from a piece
    """

    @kernel
    def of_swinging(rows, room, distance, normal, point):
        """1 if the face that a point is nearest to is one of a piece that swings, else 0.

        Where that face lies in the open the foot of the point lies on its piece.

        rows         its pieces, and whether each swings             (n, 19)
        room         for vectors                                     (6, 3)
        distance     of the point, and the outward normal       [m]  (3,)
        point        in body axes                               [m]  (3,)

        Checked  tests/net_capture/test_hinge.py
        """
        own, local = room[0], room[1]
        nearest = math.inf
        swings = 0
        for k in range(rows.shape[0]):
            row = rows[k]
            x = point[0] - distance * normal[0] - row[5]
            y = point[1] - distance * normal[1] - row[6]
            z = point[2] - distance * normal[2] - row[7]
            if math.sqrt(x * x + y * y + z * z) - row[17] >= nearest:
                continue
            for i in range(3):
                local[i] = row[8 + i] * x + row[11 + i] * y + row[14 + i] * z
            off = abs(away(row, own, local))
            if off < nearest:
                nearest = off
                swings = 1 if row[row.shape[0] - 1] != 0.0 else 0
        return swings

    @kernel
    def touched(p):
        """Whether the point of the surface found last belongs to the appendage.

        Checked  tests/net_capture/test_hinged_contact.py
        """
        if p.hinge_touched == NOT_ASKED:
            rows = p.hinge_rows[0 : pieces_of(p).shape[0]]
            p.hinge_touched = of_swinging(rows, p.piece_room, p.hinge_gap, p.hinge_found[0], p.hinge_found[1])
        return p.hinge_touched != 0

    return touched
