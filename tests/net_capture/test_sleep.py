"""Rows asleep change nothing: against the plain scheme in numpy, every node in every substep; over macro steps, reads
of outputs, and with tether, cord and target."""

import math
from functools import cache

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.spatial.transform import Rotation

from fmu_src.instance import Instance
from fmu_src.net_capture.interface import MODEL
from fmu_src.net_capture.planes import INVERSE_MASS, SHOWN, SHOWN_BACK, P, U, X
from fmu_src.net_capture.schemes.asleep import ROW_WORDS
from tests.conftest import CAPTURE, FREE
from tests.net_capture.memory import graph, nodes, planes, stamps

SMALL = {
    "net.mesh": 4.0,
    "net.youngs_modulus": 7e8,
    "net.damping_ratio": 0.05,
    "net.fold_side": 6.0,
    "bullets.speed": 10.0,
    "solver.jitter[3]": 1e-3,
}
"""Few nodes, and threads so soft that a substep lasts a millisecond."""
TETHER = FREE | {"gravity": "hill", "tether": "slack"}
RATE = math.sqrt(3.986004418e14 / 7178137.0**3)
"""Of an orbit 800 km above the equator [rad/s]."""


def matrix(n):
    """Hill's equations as a linear system of position and velocity."""
    out = np.zeros((6, 6))
    out[:3, 3:] = np.eye(3)
    out[3, 0], out[3, 4], out[4, 3], out[5, 2] = 3.0 * n * n, 2.0 * n, -2.0 * n, -n * n
    return out


class Plain:
    """The scheme without sleep: what one substep makes of all nodes."""

    def __init__(self, net, rate):
        self.net, self.rate = net, rate
        self.step = net["solver.substep"]
        self.graph = graph(net)
        self.inverse = planes(net)[INVERSE_MASS].copy()
        self.row = int(net.record["row_pitch"][0])
        self.free = matrix(rate)
        self.flown = cache(lambda steps: expm(self.free * steps * self.step))

    def state(self):
        """Positions, velocities half a substep back and at the instant, of all slots; rows that are late are flown."""
        kept = planes(self.net)
        x, p, u = (kept[at : at + 3].copy() for at in (X, P, U))
        late = int(self.net.record["grid"][0]) - stamps(self.net)
        assert late.min() >= 0
        for row in np.flatnonzero(late):
            here = slice(row * self.row, (row + 1) * self.row)
            flown = self.flown(int(late[row])) @ np.vstack([x[:, here], p[:, here]])
            x[:, here], p[:, here] = flown[:3], flown[3:]
            u[:, here] = flown[3:] - 0.5 * self.step * (self.free @ flown)[3:]
        return x, u, p

    def forces(self, x, p):
        a, b = self.graph.ends.T
        d = x[:, b] - x[:, a]
        length = np.sqrt((d * d).sum(axis=0))
        rate = ((p[:, b] - p[:, a]) * d).sum(axis=0) / length
        pull = self.graph.stiffness * (length - self.graph.length) + self.graph.damping * rate
        pull = np.where(length > self.graph.length, np.maximum(pull, 0.0), 0.0) / length * d
        out = np.zeros_like(x)
        for axis in range(3):
            np.add.at(out[axis], a, pull[axis])
            np.add.at(out[axis], b, -pull[axis])
        return out

    def following(self, state, added=0.0):
        """The state a substep on, under the threads' forces and others [N]."""
        x, u, p = state
        n, h = self.rate, self.step
        pull = (self.forces(x, p) + added) * self.inverse
        # v' - v = h (f + C (v' + v) / 2), Coriolis with the mean velocity, solved for
        coriolis = self.free[3:, 3:]
        force = pull + self.free[3:, :3] @ x
        after = np.linalg.solve(np.eye(3) - 0.5 * h * coriolis, (np.eye(3) + 0.5 * h * coriolis) @ u + h * force)
        assert n >= 0.0
        return x + h * after, after, after + 0.5 * (after - u)

    def differences(self, found, expected):
        """Largest difference of positions [m] and of both velocities [m/s]; of nodes, and not of unused slots."""
        used = self.inverse > 0.0
        return [float(np.abs(f - e)[:, used].max()) for f, e in zip(found, expected, strict=True)]


@pytest.mark.parametrize("gravity", ["none", "hill"])
def test_every_substep_is_that_of_the_plain_scheme(gravity):
    terms = FREE if gravity == "none" else TETHER
    net = Instance(MODEL, terms, SMALL).initialise()
    plain = Plain(net, RATE if gravity == "hill" else 0.0)
    before, worst, asleep, taut = plain.state(), np.zeros(3), [], 0
    while net.time < 1.5:
        expected = plain.following(before)
        net.step(plain.step)
        before = plain.state()
        worst = np.maximum(worst, plain.differences(before, expected))
        asleep.append(np.mean(stamps(net) < net["solver.steps"]))
        taut += net["thread.taut"] > 0
    assert worst.max() < 1e-10
    # rows do sleep, and threads do pull, so that there was something to be missed
    assert max(asleep) > 0.6
    assert np.mean(asleep) > 0.2
    assert taut > 100


def test_a_strip_that_slept_too_long_would_be_seen():
    """The twin: one whose length is told longer to the model than to the reference, by a thousandth."""
    net = Instance(MODEL, FREE, SMALL).initialise()
    plain = Plain(net, 0.0)
    plain.graph = plain.graph._replace(length=plain.graph.length * 0.999)
    before, worst = plain.state(), 0.0
    while net.time < 1.0:
        expected = plain.following(before)
        net.step(plain.step)
        before = plain.state()
        worst = max(worst, *plain.differences(before, expected))
    assert worst > 1e-6


def outputs(net):
    """All outputs but the one that is of the last macro step."""
    names = [v.field for v in net.interface.variables if v.causality == "output" and v.name != "thread.tension_peak"]
    return np.concatenate([np.ravel(net.array(name)).astype(float) for name in names])


@pytest.mark.parametrize("terms", [FREE, TETHER], ids=["none", "hill"])
def test_bits_do_not_depend_on_the_macro_step(terms):
    once = Instance(MODEL, terms, SMALL).initialise()
    often = Instance(MODEL, terms, SMALL).initialise()
    oddly = Instance(MODEL, terms, SMALL).initialise()
    for end in (0.5, 1.0, 1.5):
        once.step(0.5)
        for _ in range(50):
            often.step(0.01)
        while end - oddly.time > 0.0137:
            oddly.step(0.0137)
        for net in (often, oddly):
            net.step(end - net.time)
            np.testing.assert_array_equal(outputs(net), outputs(once))
            np.testing.assert_array_equal(net.work, once.work)
    assert np.any(stamps(once) < once["solver.steps"])


@pytest.mark.parametrize("terms", [FREE, TETHER], ids=["none", "hill"])
def test_reading_changes_nothing_but_what_is_shown(terms):
    net = Instance(MODEL, terms, SMALL).initialise()
    net.step(0.7)
    late = stamps(net) < net["solver.steps"]
    assert late.any()
    kept = net.work.copy()
    slots = int(net.record["node_slots"][0])
    shown = slice(SHOWN * slots, (SHOWN_BACK + 3) * slots)
    net.work[shown] = 3.0
    before = outputs(net)
    net.step(0.0)
    np.testing.assert_array_equal(net.work, kept)
    np.testing.assert_array_equal(outputs(net), before)


def test_positions_shown_are_those_of_now():
    net = Instance(MODEL, TETHER, SMALL).initialise()
    net.step(0.7)
    plain = Plain(net, RATE)
    x, _, p = plain.state()
    used = nodes(net)
    assert np.any(stamps(net) < net["solver.steps"])
    assert np.abs(x[:, used] - planes(net)[X : X + 3, used]).max() > 1e-6
    np.testing.assert_allclose(planes(net)[SHOWN : SHOWN + 3, used], x[:, used], rtol=0.0, atol=1e-11)
    # free nodes have the velocity of their flight
    still = np.repeat(stamps(net) < net["solver.steps"] - 1, plain.row)[used]
    np.testing.assert_allclose(
        planes(net)[SHOWN + 3 : SHOWN + 6, used][:, still], p[:, used][:, still], rtol=0.0, atol=1e-9
    )


def test_a_tension_at_the_vertex_rouses_its_rows():
    """The rows of the vertex sleep when the tension sets in; from then on each substep has its force."""
    net = Instance(MODEL, TETHER, SMALL).initialise()
    net.step(0.2)
    plain = Plain(net, RATE)
    apex = plain.graph.apex
    assert np.all(stamps(net)[apex // plain.row] < net["solver.steps"])
    worst, before = np.zeros(3), plain.state()
    for k in range(800):
        net["tether.vertex_tension"] = tension = 0.5 if k % 200 < 100 else 0.0
        way = net.array("chaser_place")[:, None] - before[0][:, apex].mean(axis=1, keepdims=True)
        added = np.zeros_like(before[0])
        for node in apex:
            added[:, node] += tension / len(apex) * way[:, 0] / np.linalg.norm(way)
        expected = plain.following(before, added)
        net.step(plain.step)
        before = plain.state()
        worst = np.maximum(worst, plain.differences(before, expected))
    assert worst.max() < 1e-10
    # and it moved what it pulled
    assert np.abs(before[1][:, apex]).max() > 0.05


CLOSING = {"net.mesh": 3.0, "closing.time": 0.5, "closing.speed": 5.0, "solver.jitter[3]": 1e-3}


@pytest.mark.parametrize("rings", [0, 1])
def test_a_cord_rouses_its_rows(shoot, rings):
    """It closes the mouth long before the net is open, while most rows sleep: momenta are kept, and the energy book
    closes."""
    net = shoot(CLOSING | {"closing.rings": rings}, CAPTURE)
    spin = net.array("angular_momentum").copy()
    asleep = []
    while net.time < 3.0:
        net.step(0.01)
        asleep.append(np.mean(stamps(net) < net["solver.steps"]))
        assert np.abs(net.array("momentum")).max() < 1e-12 * 4.6
        assert net.array("angular_momentum") == pytest.approx(spin, abs=1e-11)
    assert max(asleep[50:]) > 0.2
    assert net["cord.tension_max"] > 1.0
    assert abs(net["energy.remainder"]) < 0.01 * (9.0 + net["closing.work"])


WALL = {"target.size[1]": 3.0, "target.size[2]": 1.0, "target.size[3]": 3.0, "target.mass": 1e3}


def deepest(net):
    """How far any node is inside the box, by its place and attitude as told [m]."""
    w, x, y, z = net.array("target_attitude")
    turn = Rotation.from_quat([x, y, z, w]).as_matrix()
    inside = (planes(net)[SHOWN : SHOWN + 3].T[nodes(net)] - net.array("target_position")) @ turn
    return float(np.max(np.min(0.5 * net.array("target_size") - np.abs(inside), axis=1)))


def clear_until(net):
    """Substeps until which each row is out of the target's reach."""
    p = net.record[0]
    rows = int(p["node_slots"]) // int(p["row_pitch"])
    return graph(net).rest[: ROW_WORDS * rows].reshape(rows, ROW_WORDS)[:, 4]


@pytest.mark.parametrize("speed", [20.0, 500.0])
def test_a_target_that_becomes_fast_meets_rows_that_were_left_alone(shoot, speed):
    """Rows reckoned with a target at rest when something strikes it towards the net."""
    net = shoot({"net.mesh": 3.0, "closing.time": 30.0} | WALL, CAPTURE)
    net.step(0.3)
    assert clear_until(net).min() > net["solver.steps"] + 1000
    net.array("target_drift")[1] = -speed
    worst = -math.inf
    while net.time < 0.3 + 22.0 / speed:
        net.step(net["solver.substep"])
        worst = max(worst, deepest(net))
    assert worst < 1e-6
    assert net["contact.impulse"] > net["catch.mass"] * speed * 0.1
    assert abs(net.array("target_velocity")[1]) < speed


def test_rows_sleep_until_the_target_is_in_reach(shoot):
    """A target at rest that the net flies up to: no node ends inside, and the rows are looked at no sooner than they
    must be."""
    net = shoot({"net.mesh": 3.0, "closing.time": 30.0, "chaser.start_position[2]": -12.0} | WALL, CAPTURE)
    worst, looked = -math.inf, 0
    while net.time < 12.0:
        net.step(0.02)
        worst = max(worst, deepest(net))
        if net["contact.first_time"] < 0.0:
            looked = max(looked, int(np.sum(clear_until(net) > net["solver.steps"])))
    assert looked == len(clear_until(net))
    assert net["contact.first_time"] > 0.0
    assert worst < 1e-3
