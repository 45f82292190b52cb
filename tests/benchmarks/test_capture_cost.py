"""What a capture costs beside the same flight with nothing to catch.

    pytest -m bench -n 0 -s tests/benchmarks/test_capture_cost.py

Table 1 with meshes of 0.5 m, from the shot to the paper's last picture at 15 s: contact with friction and the closing
cord, and threads that bend round edges with friction too, over the bare net that is shot alike, each at its own default
substep. All fly side by side in this process, half a second of flight each in turn.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pytest

from dcone_cosim.loading import load
from fmu_src.instance import Instance
from fmu_src.net_capture.interface import MODEL
from tests.benchmarks.test_net_speed import Make, head, race, row, spread
from tests.conftest import FREE

pytestmark = pytest.mark.bench
MESH, LEG, LEGS, PAIRS = 0.5, 0.5, 30, 3
CAUGHT = FREE | {"target": "box", "closing": "winches"}
ALONE, FRICTION, WRAPPED = "no target", "law B with friction", "law A, wrap with friction"
CHOICES: Mapping[str, Mapping[str, str]] = {
    ALONE: FREE,
    FRICTION: CAUGHT | {"contact": "penalty"},
    WRAPPED: CAUGHT | {"contact": "inelastic", "wrap": "friction"},
}


def test_a_capture_beside_its_flight():
    values = {**load("table1-capture").phases[0].main.parameters, "net.mesh": MESH}

    def make(terms: Mapping[str, str]) -> Make:
        known = {name for variable in MODEL.interface(terms).variables for name in variable.element_names()}
        given = {name: value for name, value in values.items() if name in known}
        return lambda: Instance(MODEL, terms, given).initialise()

    taken, flown = race({name: make(terms) for name, terms in CHOICES.items()}, [LEG] * LEGS, PAIRS)
    alone = taken[ALONE].sum(1)
    head("Table 1, meshes of 0.5 m, 15 s", "CPU [s]", "substeps", "substep [s]", "over no target")
    for name, seconds in taken.items():
        net = flown[name]
        cells = (f"{np.median(seconds.sum(1)):.2f}", f"{net['solver.steps']:.0f}", f"{net['solver.substep']:.3g}")
        row(name, *cells, spread(seconds.sum(1) / alone))
    for name in (FRICTION, WRAPPED):
        net = flown[name]
        assert net["contact.first_time"] > 0.0, "it touches"
        assert net["closing.work"] > 1.0, "its mouth is drawn"
        print(f"{name}: contact took {net['contact.loss']:.1f} J, cord out {net['mouth.cord_length']:.1f} m")
