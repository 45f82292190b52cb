"""Gravity of the ground and of a parabolic flight, against closed forms, quadrature and equivalence."""

import math

import numpy as np
import pytest

from fmu_src.instance import Instance
from fmu_src.net_capture.gravity.history import read
from fmu_src.net_capture.interface import MODEL, refusals
from tests.conftest import FREE

AIR = {**FREE, "gravity": "uniform", "air": "quadratic", "nodes": "169"}
"""Of the scene breadboard-nylon."""
HISTORY = {**FREE, "gravity": "history", "target": "box", "contact": "inelastic"}
PARABOLA = [[0.5, 0.0, 0.0, 0.0], [1.0, -3.0, 0.5, 1.0], [1.7, 0.2, 0.1, 0.0], [2.0, 1.0, -0.3, 0.0]]
"""A pull-out and what is left after it: time [s], acceleration [m/s2]."""
FAR = {"net.mesh": 2.0, "chaser.start_position[2]": -40.0}


def falling(rows, parameters=None, terms=HISTORY):
    return Instance(MODEL, terms, {**FAR, **(parameters or {})}, {"gravity.history": rows}).initialise()


def advance(net, until, step=0.1):
    while net.time < until - 1e-9:
        net.step(step)
    return net


def integral(rows, until):
    """Gain of speed [m/s] and way [m] under the straight lines between the rows, by quadrature."""
    t = np.linspace(0.0, until, 300_001)
    table = np.array(rows)
    g = np.stack([np.interp(t, table[:, 0], table[:, axis]) for axis in (1, 2, 3)])
    return np.trapezoid(g, t), np.trapezoid(g * (until - t), t)


def test_the_centre_of_mass_follows_the_history(shoot):
    """v0 t and the double integral of gravity, while rows of the net sleep; the momentum of all by M int g dt."""
    net, still = falling(PARABOLA), shoot(FAR)
    start = net.array("momentum").copy()
    for until in (0.4, 1.3, 3.0):
        advance(net, until)
        advance(still, until)
        speed, way = integral(PARABOLA, until)
        assert net.array("momentum") - start == pytest.approx(net["catch.mass"] * speed, abs=2e-8)
        fallen = net.array("catch_position") - still.array("catch_position")
        assert fallen == pytest.approx(way, abs=5e-8)
    other = [[t, 1.01 * x, y, z] for t, x, y, z in PARABOLA]
    assert integral(other, 3.0)[1][0] != pytest.approx(fallen[0], rel=1e-3)


def test_what_falls_freely_opens_as_if_nothing_pulled(shoot):
    """The principle of equivalence: the same mouth, and every tension, seen from beside it."""
    net, still = falling([[0.0, -9.81, 2.0, 0.5]]), shoot(FAR)
    for _ in range(4):  # until the first threads snap taut; from then on rounding grows
        net.step(0.5)
        still.step(0.5)
        assert net["mouth.area"] == pytest.approx(still["mouth.area"], rel=1e-7)
        assert net["thread.tension_max"] == pytest.approx(still["thread.tension_max"], rel=1e-5)
    assert net.array("catch_position") - still.array("catch_position") == pytest.approx(
        0.5 * 4.0 * np.array([-9.81, 2.0, 0.5]), rel=1e-9
    )


def test_when_outputs_are_read_changes_no_bit():
    """Rows that sleep are flown from where they stand, whenever that is."""
    often, seldom = falling(PARABOLA), falling(PARABOLA)
    advance(often, 2.0, 0.01)
    seldom.step(2.0)
    assert np.array_equal(often.array("bullet_position"), seldom.array("bullet_position"))
    assert often["mouth.area"] == seldom["mouth.area"]


def test_the_energy_book_closes_over_a_history():
    """What the change of gravity gives is booked; without it the book would be off by as much."""
    net = advance(falling(PARABOLA, {"net.damping_ratio": 0.106}), 3.0)
    work, left = net["gravity.work"], net["energy.remainder"]
    assert abs(work) > 1.0
    assert abs(left) < 0.02 * abs(work)
    # the same of a point of that mass on the way of the centre of mass, by quadrature
    t = np.linspace(0.0, 3.0, 30_001)
    table = np.array(PARABOLA)
    g = np.stack([np.interp(t, table[:, 0], table[:, axis]) for axis in (1, 2, 3)])
    speed = np.cumsum(g, axis=1) * t[1]
    way = np.cumsum(speed, axis=1) * t[1]
    way[1] += -40.0 + (net["catch.velocity[2]"] - speed[1, -1]) * t
    expected = -net["catch.mass"] * float((way[:, 1:] * np.diff(g)).sum())
    assert work == pytest.approx(expected, rel=2e-3)


DROP = {
    "net.mesh": 2.0,
    "chaser.start_position[1]": 3.0,
    "chaser.start_position[2]": 0.0,
    "bullets.angle": 0.0,
    "bullets.speed": 1.0,
}
"""Shot straight down from 1 m above the box's upper face, at a metre a second."""


@pytest.mark.parametrize(("falls", "expected"), [(False, (-1.0 + math.sqrt(1.0 + 2.0 * 9.81)) / 9.81), (True, 1.0)])
def test_a_net_falls_onto_a_target_that_is_carried(falls, expected):
    """1 m = v t + g t2/2 onto one that is carried, v t onto one that falls as well."""
    net = falling([[0.0, -9.81, 0.0, 0.0]], {**DROP, "gravity.on_target": falls})
    advance(net, expected + 0.05, 0.05)
    assert net["contact.first_time"] == pytest.approx(expected, abs=2.0 * net["solver.substep"])
    fallen = -0.5 * 9.81 * net.time**2 if falls else 0.0
    assert net["target.position[1]"] == pytest.approx(fallen, abs=0.003)


def test_uniform_gravity_pulls_what_it_is_told_to():
    """m g t of the catch, of the chaser only if asked."""
    g, time = np.array([0.1, -0.2, -9.7]), 1.0
    still = {"air.thread_drag": 0.0, "air.bullet_drag": 0.0}
    parameters = {"net.mesh": 12.0, **still, **{f"gravity.acceleration[{i}]": float(x) for i, x in enumerate(g, 1)}}
    moved = {}
    for falls in (False, True):
        net = Instance(MODEL, AIR, {**parameters, "gravity.on_chaser": falls}).initialise()
        start = net.array("momentum").copy()
        net.step(time)
        moved[falls] = net.array("momentum") - start
        assert net["energy.remainder"] == pytest.approx(0.0, abs=1e-3 * 9.0)
    assert moved[False] == pytest.approx(2.48 * g * time, rel=1e-9)
    assert moved[True] - moved[False] == pytest.approx(2000.0 * g * time, rel=1e-9)


def test_a_history_may_have_a_head(tmp_path):
    file = tmp_path / "g.csv"
    rows = "0, 0, 0, -9.81\n1.5, 0, 0, 0\n"
    for head in ("", "# measured\ntime [s], x [m/s2], y [m/s^2], z [m/s2]\n"):
        file.write_text(head + rows)
        assert read(file) == [[0.0, 0.0, 0.0, -9.81], [1.5, 0.0, 0.0, 0.0]]


def test_a_history_that_is_none_is_refused(tmp_path):
    file = tmp_path / "g.csv"
    for text, told in (("0, 1, 2", "4: time"), ("0, 1, 2, 3\n0, 1, 2, 3", "expected one after 0 s")):
        file.write_text(text)
        with pytest.raises(ValueError, match=told):
            read(file)
    for head in ("t [ms], x [m/s2], y [m/s2], z [m/s2]", "t [s], x [m/s2]", "t, x, y, z"):
        file.write_text(f"{head}\n0, 1, 2, 3\n")
        with pytest.raises(ValueError, match="line 1: "):
            read(file)
    values = {v: s for v, _, _, s in MODEL.interface({**FREE, "gravity": "uniform"}).scalars()}
    found = refusals({**FREE, "gravity": "history", "solver": "rk4"}, values)
    assert any(refusal.name == "solver.scheme" and "leapfrog" in refusal.expected for refusal in found)
