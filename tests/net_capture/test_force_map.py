"""The force map: which cell a point belongs to, and what a node that rests on the target presses there."""

from types import SimpleNamespace

import numpy as np
import pytest

from dcone_cosim.loading import load
from dcone_cosim.phases.force_map import of_run
from fmu_src.net_capture import force_map
from fmu_src.net_capture.interface import GROUPS
from tests.net_capture.on_target import TERMS, Kernels

HALF = [2.0, 4.0, 2.0]


def test_the_middle_of_a_cell_belongs_to_it():
    found = [force_map.cell_of.py_func(force_map.centre_of(n, HALF), HALF) for n in range(force_map.NUMBER)]
    assert found == list(range(force_map.NUMBER))
    middles = np.array([force_map.centre_of(n, HALF) for n in range(force_map.NUMBER)])
    assert (np.abs(middles) <= HALF).all()
    assert (np.isclose(np.abs(middles), HALF).sum(axis=1) == 1).all()
    # by hand: on face +1, a quarter of the way along axis 2 is its first cell of four, and the third along axis 3
    assert force_map.cell_of.py_func([1.99, -3.0, 0.5], HALF) == 2 * force_map.CELLS
    assert force_map.cell_of.py_func([0.1, -3.99, 1.9], HALF) == 3 * force_map.CELLS**2 + 3 + 2 * force_map.CELLS


def test_a_node_that_is_pressed_on_gives_its_cell_the_impulse():
    kernels = Kernels(TERMS | {"force_map": "plain"})
    scene = kernels.place(target_radius=2.0, target_length=4.0, target_mass=1e9)
    scene.put([0.01], [(1.2, -0.3, 2.0)], [(0.0, 0.0, 0.0)])
    scene.go(1e-4, 5000, [(0.0, 0.0, -3.0)])
    cell = force_map.cell_of.py_func([1.2, -0.3, 2.0], [2.0, 2.0, 2.0])
    given = scene.p["force_map_impulse"]
    assert given[cell] == pytest.approx(3.0 * 0.5, rel=1e-3)
    assert given.sum() == given[cell] == pytest.approx(scene.p["contact_impulse"], rel=1e-12)


class Recorded(dict):
    """Figures of the last instant."""

    def last(self):
        return self


def test_the_cells_of_a_union_are_told():
    """Of one whose sizes its tables alone have: each on the box round the corners that pictures draw."""
    scene = load("upper-stage", ["capture.force_map.kind=plain"])
    figures = Recorded({f"force_map.{of}[{n}]": 1.0 * n for of in ("impulse", "peak") for n in range(1, 97)})
    run = SimpleNamespace(phases={"capture": SimpleNamespace(recorder=figures)}, scene=scene, parameters={})
    cells = of_run(run, "capture")
    assert cells.impulse.tolist() == [1.0 * n for n in range(1, force_map.NUMBER + 1)]
    made = scene.phases[0].main.made
    half = np.abs(np.array(GROUPS["target"].terms["union"].checks.surface(made)[0])).max(axis=0)
    assert np.abs(cells.middle).max(axis=0) == pytest.approx(half, rel=0.01)
