"""The planar rectangular net of square meshes."""

from __future__ import annotations

from fmu_src.implied import formula
from fmu_src.interface import Term
from fmu_src.net_capture import formulas
from fmu_src.net_capture.nets import Values
from fmu_src.net_capture.nets.extremes import extremes
from fmu_src.net_capture.nets.grid import Grid, checks, flat_length, make_grid, make_refuses, no_depth, whole_meshes
from fmu_src.net_capture.nets.weave import THREAD, TOO_FINE
from fmu_src.rows import positive
from orbital.kernel import kernel

WIDTH, HEIGHT = "net.width", "net.height"


@kernel
def sides(p):
    """Width and height of the mouth [m].

    Checked  tests/net_capture/test_nets.py
    """
    return p.net_width, p.net_height


@kernel
def total(p):
    """Length of all threads [m].

    Checked  tests/net_capture/test_nets.py
    """
    return formulas.grid_length(p.net_width, p.net_height, p.net_mesh)


def named(values: Values) -> dict[str, float]:
    """Sides of the mouth by the name of their variable [m]."""
    return {WIDTH: values[WIDTH], HEIGHT: values[HEIGHT]}


CHECKS = checks(
    named,
    lambda values: formula(formulas.grid_length)(values[WIDTH], values[HEIGHT], values["net.mesh"]),
)

PART = Term(
    "planar rectangular net of square meshes",
    (
        positive(WIDTH, "m", "of the flat net, along the first transverse axis of the shot", 30.0),
        positive(HEIGHT, "m", "of the flat net, along the second transverse axis of the shot", 26.0),
        *THREAD,
    ),
    faults=(whole_meshes(WIDTH), whole_meshes(HEIGHT), TOO_FINE),
    make=lambda composition: make_grid(composition, Grid(sides, (WIDTH, HEIGHT), total, flat_length, no_depth)),
    checks=CHECKS,
    refuses=make_refuses(named),
    extremes=extremes(CHECKS),
)
