"""A tether drawn off against friction and a brake: impulse, work, and where the net stops."""

import numpy as np
import pytest

from fmu_src.net_capture.interface import MODEL, refusals
from tests.net_capture.released import COARSE, RELEASED

LINE = COARSE | {"net.damping_ratio": 0.3, "vertex.mass": 0.5, "tether.friction": 0.3}


def test_friction_takes_its_force_times_what_is_drawn_off(shoot):
    """And gives the chaser its force times the time, once the vertex has been drawn off for good."""
    net = shoot(LINE, RELEASED)
    net.step(3.0)
    speed, out = net["chaser.velocity[2]"], net["tether.paid_out"]
    loss = net["tether.friction_loss"]
    assert out > 1.0
    net.step(2.0)
    assert net["chaser.velocity[2]"] - speed == pytest.approx(0.3 * 2.0 / 40.0, rel=1e-9)
    assert net["tether.friction_loss"] - loss == pytest.approx(0.3 * (net["tether.paid_out"] - out), rel=1e-9)
    assert np.abs(net.array("momentum")).max() < 1e-9 * 6.0
    assert abs(net["energy.remainder"]) < 0.01 * 9.0 < 2.0 * net["tether.friction_loss"] + 9.0


def test_no_friction_is_a_free_line(shoot):
    net = shoot(LINE | {"tether.friction": 0.0}, RELEASED)
    speed = net["chaser.velocity[2]"]
    net.step(5.0)
    assert net["tether.friction_loss"] == 0.0 < net["tether.paid_out"]
    assert net["chaser.velocity[2]"] == pytest.approx(speed, abs=1e-12)


def test_a_brake_stops_the_vertex(shoot):
    """At 3 m on: then nothing more is drawn off, what the line takes is booked, and the momenta are kept."""
    net = shoot(LINE | {"tether.brake_at": 3.0, "tether.brake_force": 20.0}, RELEASED)
    while net["tether.paid_out"] < 3.0:
        net.step(0.05)
        assert net.time < 10.0
    net.step(2.0)
    stopped = net["tether.paid_out"]
    loss = net["tether.friction_loss"]
    assert 3.0 < stopped < 4.0
    # what the friction alone takes on the way, and no more than all of it at the brake's force
    assert 0.3 * 3.0 < loss < 0.3 * stopped + 20.0 * (stopped - 3.0) + 0.3 * 0.05
    assert abs(net["energy.remainder"]) < 0.02 * 9.0 < loss
    assert np.abs(net.array("momentum")).max() < 1e-9 * 6.0
    assert np.abs(net.array("angular_momentum")).max() < 1e-9 * 120.0


def test_it_goes_with_the_leapfrog():
    variables = [v for v in MODEL.interface(RELEASED).variables if v.causality == "parameter"]
    values = {n: s for v in variables for n, s in zip(v.element_names(), v.starts(), strict=True)}
    found = refusals({"net": "square", "gravity": "none", "tether": "dragging", "solver": "rk4"}, values, 10.0)
    assert [r.name for r in found] == ["solver.scheme"]


def test_what_would_throw_the_vertex_back_is_refused(shoot):
    """At the bound the energy book stays within 1 % of the shot's 9 J; at twenty times that it is open by all of it."""
    variables = [v for v in MODEL.interface(RELEASED).variables if v.causality == "parameter"]
    start = {n: s for v in variables for n, s in zip(v.element_names(), v.starts(), strict=True)}
    light = COARSE | {"vertex.mass": 0.05}
    terms = MODEL.interface(RELEASED).terms
    bounds = []
    for name in ("tether.friction", "tether.brake_force"):
        (found,) = refusals(terms, start | light | {name: 1e6}, 10.0)
        assert found.name == name
        bounds.append(float(found.expected.split(" at most ")[1].split()[0]))
    most = bounds[0] - start["tether.brake_force"]
    assert refusals(terms, start | light | {"tether.friction": 0.99 * most}, 10.0) == []
    for share, open_by in ((0.99, 0.01), (20.0, 1.0)):
        net = shoot(light | {"tether.friction": share * most}, RELEASED)
        net.step(3.0)
        assert (abs(net["energy.remainder"]) < open_by * 9.0) is (share < 1.0)
