"""The planar square net of square meshes."""

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

SIDE = "net.side"


@kernel
def sides(p):
    """Both sides of the mouth [m].

    Checked  tests/net_capture/test_nets.py
    """
    return p.net_side, p.net_side


@kernel
def total(p):
    """Length of all threads [m].

    Checked  tests/net_capture/test_nets.py
    """
    return formulas.grid_length(p.net_side, p.net_side, p.net_mesh)


def named(values: Values) -> dict[str, float]:
    """Sides of the mouth by the name of their variable [m]."""
    return {SIDE: values[SIDE]}


CHECKS = checks(
    named,
    lambda values: formula(formulas.grid_length)(values[SIDE], values[SIDE], values["net.mesh"]),
)

PART = Term(
    "planar square net of square meshes",
    (positive(SIDE, "m", "side of the mouth", 24.0), *THREAD),
    faults=(whole_meshes(SIDE), TOO_FINE),
    make=lambda composition: make_grid(composition, Grid(sides, (SIDE, SIDE), total, flat_length, no_depth)),
    checks=CHECKS,
    refuses=make_refuses(named),
    extremes=extremes(CHECKS),
)
