"""Where the net presses on the target: impulse and largest force, cell by cell.

The cells are those of the box round the target: of each of its six faces CELLS by CELLS. A point of the surface belongs
to the face that it is nearest to, in half edges of the box. Faces are in the order +1, -1, +2, -2, +3, -3 of the body
axes; within one the next axis runs faster than the one after it. Of a target with a hinge both box and points are those
with the hinge at angle 0, as the target is drawn: what presses on the appendage counts at one place of it, however it
swings.

The force of a cell is the mean over `stepping.MEASURE_INTERVAL`: so it is told alike under every law of contact, and of
impacts too.

Checked  tests/net_capture/test_force_map.py
"""

from __future__ import annotations

from typing import Any, NamedTuple

from fmu_src.interface import Term, Variable
from fmu_src.net_capture.shapes.solids import HALF
from fmu_src.net_capture.stepping import MEASURE_INTERVAL
from fmu_src.rows import state
from orbital.kernel import kernel

CELLS = 4
"""Along either edge of a face."""
NUMBER = 6 * CELLS * CELLS
SOLID = "target.solid"
"""Table of a union, with half the edges of its box."""


class ForceMap(NamedTuple):
    """Kernels of the map.

    start(p)                   nothing pressed yet
    add(p, point, impulse)     an impulse on the target [N s] at a point in body axes [m]
    look(p)                    a measure interval is over
    """

    start: Any
    add: Any
    look: Any


@kernel
def cell_of(point, half):
    """Number of the cell that a point belongs to, from 0 [1].

    point         in body axes                    [m]  (3,)
    half          half the edges of the box       [m]  (3,)

    Checked  tests/net_capture/test_force_map.py
    """
    axis = 0
    for i in range(1, 3):
        if abs(point[i]) / half[i] > abs(point[axis]) / half[axis]:
            axis = i
    face = 2 * axis + (1 if point[axis] < 0.0 else 0)
    number = 0
    for i in range(2, 0, -1):
        other = (axis + i) % 3
        share = 0.5 + 0.5 * point[other] / half[other]
        number = CELLS * number + min(max(int(CELLS * share), 0), CELLS - 1)
    return CELLS * CELLS * face + number


def centre_of(number: int, half: list[float]) -> list[float]:
    """Middle of a cell in body axes [m], of a box with these half edges [m]."""
    face, within = divmod(number, CELLS * CELLS)
    axis, below = divmod(face, 2)
    point = [0.0, 0.0, 0.0]
    point[axis] = -half[axis] if below else half[axis]
    for i in (1, 2):
        other, (within, place) = (axis + i) % 3, divmod(within, CELLS)
        point[other] = ((place + 0.5) * 2.0 / CELLS - 1.0) * half[other]
    return point


def make(composition: Any) -> ForceMap:
    """Kernels of the map."""
    hinge = composition.target.hinge
    swings = hinge is not None
    as_drawn, solid_of = (hinge.as_drawn, composition.table(SOLID)) if swings else [None] * 2

    @kernel
    def start(p):
        """Nothing pressed yet.

        Checked  tests/net_capture/test_force_map.py
        """
        for i in range(NUMBER):
            p.force_map_impulse[i] = 0.0
            p.force_map_peak[i] = 0.0
            p.force_map_before[i] = 0.0

    @kernel
    def add(p, point, impulse):
        """An impulse on the target [N s] at a point in body axes [m]; its size counts.

        Checked  tests/net_capture/test_force_map.py
        """
        if swings:
            as_drawn(p, point, p.hinge_room[5])
            p.force_map_impulse[cell_of(p.hinge_room[5], solid_of(p)[HALF : HALF + 3])] += impulse
            return
        p.force_map_impulse[cell_of(point, p.half_size)] += impulse

    @kernel
    def look(p):
        """Mean forces of the interval that is over; the largest are kept [N].

        Checked  tests/net_capture/test_force_map.py
        """
        for i in range(NUMBER):
            force = (p.force_map_impulse[i] - p.force_map_before[i]) / MEASURE_INTERVAL
            p.force_map_before[i] = p.force_map_impulse[i]
            p.force_map_peak[i] = max(p.force_map_peak[i], force)

    return ForceMap(start, add, look)


def _cells(name: str, unit: str, text: str) -> Variable:
    return Variable(f"force_map.{name}[#]", unit, "output", text, shape=(NUMBER,), discrete=True)


PART = Term(
    "impulse and largest force on the target, cell by cell",
    (
        _cells("impulse", "N.s", "sum of the sizes of all impulses on a cell so far"),
        _cells("peak", "N", "largest force on a cell so far, the mean of 10 ms"),
        state("force_map_before[#]", "N.s", "sums at the last look", shape=(NUMBER,)),
    ),
    needs=("target", "contact"),
    make=make,
)
