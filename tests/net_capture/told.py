"""What a scene is told of its knots before a run, against a net that is laid out."""

import numpy as np
import pytest

from fmu_src.net_capture.implied import rows
from fmu_src.net_capture.interface import MODEL

JOINED = 3
"""Threads at a knot, at least; within a thread that is cut two pieces meet."""


EVEN = ("square", "rectangle")
"""Nets whose knots inside all hold as much, whatever their values."""


def every(terms, values):
    """All parameters by FMI name, these among them."""
    variables = [v for v in MODEL.interface(terms).variables if v.causality == "parameter"]
    starts = {name: start for v in variables for name, start in zip(v.element_names(), v.starts(), strict=True)}
    assert set(values) <= set(starts)
    return starts | values


def knots_are_as_told(terms, values, laid):
    """The heaviest knot inside, on the edge and at a bullet; knots that differ are never called alike."""
    values = every(terms, values)
    told = {row.key: row for row in rows(values, terms)}
    rim = laid.graph.rim
    corners = rim[laid.graph.corners]
    joined = np.bincount(laid.graph.ends.ravel(), minlength=len(laid.mass)) >= JOINED
    inside = laid.mass[np.setdiff1d(laid.slots[joined[laid.slots]], rim)]
    edge = laid.mass[np.setdiff1d(rim[joined[rim]], corners)]
    assert told["knot.mass"].value == pytest.approx(inside.max(), rel=1e-9)
    if edge.size:
        assert told["edge.mass"].value == pytest.approx(edge.max(), rel=1e-9)
    assert told["corner.mass"].value == pytest.approx(laid.mass[corners].max() + values["bullets.mass"], rel=1e-9)
    alike = np.ptp(inside) < 1e-9 * inside.max()
    heaviest = "the heaviest knot" in told["knot.mass"].label
    assert heaviest or alike
    assert not (heaviest and terms["net"] in EVEN)
