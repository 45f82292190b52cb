"""A part of the net capture that brings a table: it asks the composition for it, and its kernels read it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from fmu_src import instance
from fmu_src.instance import Instance
from fmu_src.interface import Term
from fmu_src.net_capture import model
from fmu_src.net_capture.composition import Composition
from fmu_src.net_capture.gravity import none
from fmu_src.net_capture.interface import MODEL
from fmu_src.tables import Table
from orbital.kernel import kernel
from tests.conftest import FREE

TERMS = {**FREE, "gravity": "steady"}


def make_steady(composition):
    """A steady acceleration of the bodies, a row of a table for each time span; nodes feel none."""
    spans = composition.table("spans")

    @kernel
    def kick_body(p, place, velocity, pull, h):
        rows = spans(p)
        k = 0
        while k < rows.shape[0] - 1 and p.grid * p.solver_substep >= rows[k, 0]:
            k += 1
        for i in range(3):
            velocity[i] += h * (pull[i] + rows[k, 1 + i])

    return none.make(composition)._replace(kick_chaser=kick_body)


@pytest.fixture
def steady(monkeypatch):
    """Net capture with a gravity made here."""
    part = Term("steady", tables=(Table("spans", "1", "end [s] and acceleration [m/s2]", 2),), make=make_steady)
    group = replace(MODEL.groups["gravity"], terms={**MODEL.groups["gravity"].terms, "steady": part})
    made = replace(MODEL, groups={**MODEL.groups, "gravity": group})
    monkeypatch.setattr(model, "MODEL", made)
    instance._compiled.cache_clear()
    yield made
    instance._compiled.cache_clear()


def moved(made, rows, time):
    """Way of the chaser beside that without acceleration [m], and its other velocity [m/s]."""
    ends = []
    for numbers in (rows, np.zeros((1, 4))):
        net = Instance(made, TERMS, {"net.mesh": 4.0}, {"spans": numbers}).initialise()
        net.step(time)
        ends.append(np.array([*net.array("chaser_position"), *net.array("chaser_velocity")]))
    return ends[0] - ends[1]


def test_a_part_reads_its_table(steady):
    """x = a t^2 / 2 and v = a t, exact for the scheme; another table with the same kernels."""
    a, time = np.array([0.02, -0.01, 0.03]), 1.0
    assert moved(steady, [[0.0, *a]], time) == pytest.approx([*(a * time**2 / 2), *(a * time)], rel=1e-9)
    halves = [[0.5, *a], [9.9, *(-a)]]
    way = moved(steady, halves, time)
    assert way[:3] == pytest.approx(a * 0.25, rel=0.02)
    assert abs(way[3:]) == pytest.approx([0.0] * 3, abs=2e-4)
    with pytest.raises(ValueError, match="this net_capture needs the table spans"):
        Instance(steady, TERMS)


def test_a_table_that_no_part_brings_is_told():
    composition = Composition(MODEL, MODEL.interface(FREE).terms)
    with pytest.raises(ValueError, match="no part of this model brings a table 'spans'"):
        composition.table("spans")
