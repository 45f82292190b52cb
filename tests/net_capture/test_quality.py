"""The mouth measures, and mass properties of the net."""

import numpy as np
import pytest

from fmu_src.net_capture.planes import MASS
from tests.net_capture.memory import nodes, planes, shown


def test_mouth_area_of_the_folded_net_is_its_square(shoot):
    net = shoot({"net.fold_side": 0.5})
    assert net["mouth.area"] == pytest.approx(0.25, rel=1e-12)
    assert net["mouth.depth"] == pytest.approx(0.0, abs=1e-12)
    turned = shoot({"shot.axis[1]": 1.0, "shot.axis[3]": 2.0, "shot.roll": 0.7})
    assert turned["mouth.area"] == pytest.approx(0.25, rel=1e-12)


def test_mass_properties_are_those_of_the_nodes(shoot):
    net = shoot({"net.mesh": 2.0})
    net.step(5.0)
    mass, places = planes(net)[MASS, nodes(net)], shown(net)
    centre = mass @ places / mass.sum()
    assert net.array("catch_position") == pytest.approx(centre, rel=1e-12)
    arms = places - centre
    tensor = sum(m * (np.dot(r, r) * np.eye(3) - np.outer(r, r)) for m, r in zip(mass, arms, strict=True))
    told = net.array("catch_inertia")
    assert told == pytest.approx([tensor[i, j] for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))], abs=1e-9)
