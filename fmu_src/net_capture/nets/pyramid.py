"""The pyramidal net: a square mouth, and four walls that come together at the vertex.

Seen along the shot it is the square net. A knot lies behind the mouth by the depth of the pyramid's wall there,

    z = D (1 - 2 max(|a|, |b|) / s)

so that a thread is as long as a mesh is wide where it runs round the pyramid, and longer by sqrt(1 + (2 D / s)^2) where
it runs up a wall. All knots of the ridges are knots of the grid, so no thread bends over one.
"""

from __future__ import annotations

import math

from fmu_src.implied import formula
from fmu_src.interface import Term
from fmu_src.net_capture.nets import Values
from fmu_src.net_capture.nets.extremes import extremes
from fmu_src.net_capture.nets.grid import Grid, checks, make_grid, make_refuses, whole_meshes
from fmu_src.net_capture.nets.weave import THREAD, TOO_FINE
from fmu_src.rows import positive
from orbital.kernel import kernel

SIDE = "net.side"


@kernel
def sides(p):
    """Both sides of the mouth [m].

    Checked  tests/net_capture/test_nets.py
    """
    return p.net_side, p.net_side


@kernel
def slope(side, depth):
    """How much longer a thread is that runs up a wall [1]: sqrt(1 + (2 D / s)^2).

    Checked  tests/net_capture/test_nets.py
    """
    return math.sqrt(1.0 + 4.0 * depth * depth / (side * side))


@kernel
def pyramid_length(side, slope, mesh):
    """Length of all threads of a pyramid [m]; of n meshes along a side half of n^2, twice, run up the walls.

        l (2 n (n + 1) + 2 floor(n^2 / 2) (q - 1)),   q of `slope`

    Checked  tests/net_capture/test_nets.py
    """
    n = round(side / mesh)
    return mesh * (2.0 * n * (n + 1.0) + 2.0 * (n * n // 2) * (slope - 1.0))


@kernel
def total(p):
    """Length of all threads [m].

    Checked  tests/net_capture/test_nets.py
    """
    return pyramid_length(p.net_side, slope(p.net_side, p.net_depth), p.net_mesh)


@kernel
def length(p, i, j, direction):
    """Unloaded length of a thread [m]: up a wall where its middle is farther out along its way than beside it.

    Checked  tests/net_capture/test_nets.py
    """
    half = 0.5 * (p.grid_columns - 1)
    along = j + 0.5 - half if direction == 0 else i + 0.5 - half
    beside = i - half if direction == 0 else j - half
    return p.net_mesh * (slope(p.net_side, p.net_depth) if abs(along) > abs(beside) else 1.0)


@kernel
def depth(p, i, j):
    """How far a knot lies behind the mouth [m].

    Checked  tests/net_capture/test_nets.py
    """
    half = 0.5 * (p.grid_columns - 1)
    return p.net_depth * (1.0 - max(abs(i - half), abs(j - half)) / half)


def named(values: Values) -> dict[str, float]:
    """Sides of the mouth by the name of their variable [m]."""
    return {SIDE: values[SIDE]}


CHECKS = checks(
    named,
    lambda values: formula(pyramid_length)(
        values[SIDE], formula(slope)(values[SIDE], values["net.depth"]), values["net.mesh"]
    ),
    lambda values: float(formula(slope)(values[SIDE], values["net.depth"])),
)

PART = Term(
    "pyramidal net: a square mouth, four walls of square meshes, the vertex at their top",
    (
        positive(SIDE, "m", "side of the mouth", 24.0),
        positive("net.depth", "m", "from the mouth to the top", 12.0),
        *THREAD,
    ),
    faults=(whole_meshes(SIDE), TOO_FINE),
    make=lambda composition: make_grid(composition, Grid(sides, (SIDE, SIDE), total, length, depth)),
    checks=CHECKS,
    refuses=make_refuses(named),
    extremes=extremes(CHECKS),
)
