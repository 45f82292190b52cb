"""Threads that resist being bent: forces against their energy, beams against Euler's, a flight's books."""

import math

import numpy as np
import pytest
from scipy.linalg import eigh

from fmu_src.instance import Instance
from fmu_src.net_capture.composition import Composition
from fmu_src.net_capture.implied import substeps
from fmu_src.net_capture.interface import MODEL, refusals
from fmu_src.net_capture.joints import JOINT_WORDS
from fmu_src.net_capture.planes import FX, MASS, SHOWN, SHOWN_RATE, X
from fmu_src.net_capture.planes import work_size as size_of
from orbital.kernel import kernel
from tests.conftest import FREE
from tests.net_capture.memory import graph_of, nodes, planes, planes_of
from tests.validation import closed_form

BENT = FREE | {"gravity": "uniform", "bending": "plain", "knots": "plain"}
STILL = {f"gravity.acceleration[{i}]": 0.0 for i in (1, 2, 3)}
RIGIDITY, TAU = 3e-3, 0.02


class Joined:
    """The joints of nets of one shape, and their forces, from the kernels of the part alone."""

    def __init__(self, shape):
        self.terms = MODEL.interface(FREE | {"net": shape, "bending": "plain"}).terms
        parts = Composition(MODEL, self.terms)
        graph, bending, own_words = parts.graph, parts.bending, parts.scheme.own_words
        count_of, lay, words_of, find_of, pull_of = (
            graph.count,
            graph.lay_out,
            bending.words,
            bending.find,
            bending.pull_shown,
        )

        @kernel
        def count(record, work):
            p = record[0]
            fault = count_of(p, work)
            return fault, own_words(p) + words_of(p)

        @kernel
        def find(record, work):
            lay(record[0], work)
            find_of(record[0], work)

        @kernel
        def pull(record, work):
            pull_of(record[0], work)

        self.count, self.find, self.pull = count, find, pull

    def lay(self, values):
        return Net(self, values)


class Net:
    """One such net: nodes by their slots, joints (n, 3) and the unloaded lengths of their pieces (n, 2)."""

    def __init__(self, joined, values):
        self.joined, self.record = joined, MODEL.interface(joined.terms).make_record()
        for name, value in values.items():
            self.record[name.replace(".", "_")] = value
        self.p = self.record[0]
        fault, own = joined.count(self.record, np.zeros(0))
        assert fault == 0
        self.work = np.zeros(size_of(self.record.view(np.recarray)[0], 1, own))
        self.record["work_size"] = self.work.size
        joined.find(self.record, self.work)
        self.planes = planes_of(self.p, self.work, joined.terms)
        self.graph = graph_of(self.p, self.work, joined.terms)
        self.mass = self.planes[MASS].copy()
        self.places = self.planes[SHOWN : SHOWN + 3].T.copy()
        at = self.work.size - own + (own - int(self.p["thread_numbers"]) * 10 - int(self.p["node_slots"]))
        words = self.work[at : at + JOINT_WORDS * int(self.p["bending_joints"])].reshape(-1, JOINT_WORDS)
        self.joints, self.lengths = words[:, :3].view(np.int64), words[:, 3:]

    def forces(self, places, speeds):
        """Of all slots (n, 3) [N]; what is stored [J] and taken [W] stands in the record."""
        self.planes[SHOWN : SHOWN + 3], self.planes[SHOWN_RATE : SHOWN_RATE + 3] = places.T, speeds.T
        self.planes[FX : FX + 3] = 0.0
        self.joined.pull(self.record, self.work)
        return self.planes[FX : FX + 3].T.copy()


@pytest.fixture(scope="module")
def square():
    return Joined("square")


def chain(square, pieces, rigidity=RIGIDITY, tau=0.0):
    """The rim's first thread of a net, in so many pieces of 1/pieces [m]; its nodes in order."""
    net = square.lay(
        {
            "net.side": 2.0,
            "net.mesh": 1.0,
            "net.segments": pieces,
            "bending.rigidity": rigidity,
            "bending.damping_time": tau,
        }
    )
    first = net.graph.rim[0]
    line, at = [first], first
    ends = {frozenset(pair) for pair in net.graph.ends.tolist()}
    while len(line) <= pieces:
        (at,) = (
            b
            for b in range(len(net.mass))
            if b not in line and frozenset((at, b)) in ends and net.places[b, 1] == net.places[first, 1]
        )
        line.append(at)
    return net, line


def test_joints_are_where_the_thread_goes_straight_on(square):
    """Counted by hand: a line of 4 meshes has 3 knots inside, cut in two 7 nodes; and each is straight and its own."""
    for pieces, inside in ((1, 3), (2, 7)):
        net = square.lay({"net.side": 4.0, "net.mesh": 1.0, "net.segments": pieces})
        assert len(net.joints) == 10 * inside
        assert len({tuple(sorted(joint)) for joint in net.joints.tolist()}) == len(net.joints)
        a, b, c = (net.places[nodes] for nodes in net.joints.T)
        np.testing.assert_allclose(b - a, c - b, atol=1e-12)
        np.testing.assert_allclose(net.lengths, 1.0 / pieces, rtol=1e-15)


def any_shape(net, seed, speed=1.0):
    """Nodes anywhere, so that a half of the pieces is slack, and moving."""
    rng = np.random.default_rng(seed)
    places = 0.8 * net.places + rng.uniform(-0.3, 0.3, net.places.shape)
    return places * (net.mass > 0)[:, None], rng.normal(0.0, speed, net.places.shape) * (net.mass > 0)[:, None]


def test_forces_are_the_gradient_of_what_is_stored(square):
    """And neither they nor their moments sum to anything; nor does the damping, whose power is what it takes."""
    net = square.lay(
        {"net.side": 4.0, "net.mesh": 1.0, "net.segments": 2, "bending.rigidity": RIGIDITY, "bending.damping_time": TAU}
    )
    for seed in range(3):
        places, speeds = any_shape(net, seed)
        lengths = np.linalg.norm(np.diff(places[net.joints], axis=1), axis=2)
        assert 0.1 < np.mean(lengths > net.lengths) < 0.9
        still = net.forces(places, 0.0 * speeds)
        stored = float(net.p["bending_energy"])
        assert float(net.p["bending_power"]) == 0.0
        step = 1e-6
        ahead, behind = (
            net.forces(places + sign * step * speeds, speeds * 0.0) is None or float(net.p["bending_energy"])
            for sign in (1.0, -1.0)
        )
        assert -np.sum(still * speeds) == pytest.approx((ahead - behind) / (2.0 * step), rel=1e-6)
        moving = net.forces(places, speeds)
        assert float(net.p["bending_energy"]) == stored > 0.0
        assert np.sum((still - moving) * speeds) == pytest.approx(float(net.p["bending_power"]), rel=1e-12)
        assert float(net.p["bending_power"]) > 0.0
        size = np.abs(moving).sum()
        assert np.abs(moving.sum(axis=0)).max() < 1e-14 * size
        assert np.abs(np.cross(places, moving).sum(axis=0)).max() < 1e-14 * size * 4.0


def test_turning_and_stretching_are_free(square):
    """A bent net that turns as one body is damped by nothing, and a straight one may stretch and shrink."""
    net = square.lay({"net.side": 4.0, "net.mesh": 1.0, "bending.rigidity": RIGIDITY, "bending.damping_time": TAU})
    places, _ = any_shape(net, 5)
    still = net.forces(places, 0.0 * places)
    turning = net.forces(places, np.cross([0.3, -0.2, 0.5], places) + np.array([1.0, 2.0, 3.0]))
    np.testing.assert_allclose(turning, still, atol=1e-15)
    assert float(net.p["bending_power"]) < 1e-30
    for share in (0.5, 1.5):
        assert np.abs(net.forces(share * net.places, net.places)).max() < 1e-14
        assert float(net.p["bending_energy"]) < 1e-30
    # what is taut throughout may grow as a whole: directions stay
    places, _ = any_shape(net, 6)
    places *= 4.0
    forces = net.forces(places, 0.0 * places)
    pieces = np.diff(places[net.joints], axis=1)
    assert (np.linalg.norm(pieces, axis=2) > net.lengths).all()
    assert abs(np.sum(forces * places)) < 1e-13 * np.sum(np.abs(forces)) * 4.0
    first, second = (piece / np.linalg.norm(piece, axis=1)[:, None] for piece in np.swapaxes(pieces, 0, 1))
    angles = np.arccos(np.sum(first * second, axis=1))
    assert float(net.p["bending_energy"]) == pytest.approx(np.sum(RIGIDITY * (1.0 - np.cos(angles))), rel=1e-12)


def matrix(square, pieces):
    """Stiffness [N/m] of a thread of 1 m against small deflections of its nodes, and their masses in shares of it."""
    net, line = chain(square, pieces)
    alone = np.isin(net.joints, line).all(axis=1)
    assert alone.sum() == pieces - 1
    net.joints[~alone] = line[0]  # no joint at all
    found = []
    for node in line:
        places = net.places.copy()
        places[node, 2] += 1e-7
        found.append(-net.forces(places, 0.0 * places)[line, 2] / 1e-7)
    masses = np.full(pieces + 1, 1.0 / pieces)
    masses[[0, -1]] *= 0.5
    return np.array(found), masses


def slopes(errors):
    """Of their logarithms, over twice as many pieces each."""
    return np.log2(np.abs(errors[:-1]) / np.abs(errors[1:]))


COUNTS = (8, 16, 32)


def test_a_thread_sags_as_a_beam(square, validated):
    """Supported at both ends under its weight: 5 q L^4 / 384 B, to second order in its pieces."""
    found = []
    for pieces in COUNTS:
        stiffness, masses = matrix(square, pieces)
        inner = slice(1, pieces)
        found.append(np.linalg.solve(stiffness[inner, inner], masses[inner])[pieces // 2 - 1])
    expected = 5.0 / (384.0 * RIGIDITY)
    np.testing.assert_allclose(slopes(np.array(found) - expected), 2.0, atol=0.1)
    at_none = (4.0 * found[-1] - found[-2]) / 3.0
    source = closed_form("5 q L^4 / 384 B, of a beam supported at both ends")
    validated(source, "thread that resists bending, to ever more pieces: sag", at_none, expected, "m", rel=1e-5)
    assert found[-1] != pytest.approx(expected, rel=1e-5)


@pytest.mark.parametrize(("ends", "root"), [("supported", math.pi), ("free", 4.730040744862704)])
def test_a_thread_swings_as_a_beam(square, validated, ends, root):
    """At root^2 sqrt(B / mu L^4) with cos root cosh root = 1 if its ends are free, to second order in its pieces."""
    found = []
    for pieces in COUNTS:
        stiffness, masses = matrix(square, pieces)
        inner = slice(1, pieces) if ends == "supported" else slice(0, pieces + 1)
        modes = eigh(stiffness[inner, inner], np.diag(masses[inner]), eigvals_only=True)
        if ends == "free":
            assert np.abs(modes[:2]).max() < 1e-5 * modes[2]
        found.append(math.sqrt(modes[0 if ends == "supported" else 2]))
    expected = root**2 * math.sqrt(RIGIDITY)
    np.testing.assert_allclose(slopes(np.array(found) - expected), 2.0, atol=0.1)
    at_none = (4.0 * found[-1] - found[-2]) / 3.0
    what = f"thread that resists bending, its ends {ends}, to ever more pieces: first swing"
    validated(closed_form("root^2 sqrt(B / mu L^4)"), what, at_none, expected, "rad/s", rel=2e-4)


def all_values(terms, values):
    """Every parameter by FMI name, these among them."""
    rows = [v for v in MODEL.interface(terms).variables if v.causality == "parameter"]
    return {name: start for v in rows for name, start in zip(v.element_names(), v.starts(), strict=True)} | values


NETS = {
    "square": {"net.side": 8.0, "net.mesh": 1.0, "net.segments": 3},
    "cone": {"net.radius": 3.0, "net.depth": 2.0, "net.top_radius": 1.0, "net.mesh": 0.5},
}


@pytest.mark.parametrize("shape", ["square", pytest.param("cone", marks=pytest.mark.evidence)])
def test_no_joint_is_stiffer_than_the_step_allows(square, shape):
    """Twice what bending is said to add bounds every swing of it; of the lengths and masses that a scene tells."""
    joined = square if shape == "square" else Joined(shape)
    values = NETS[shape] | {"bending.rigidity": RIGIDITY}
    net = joined.lay(values)
    rows, weights = [], []
    for joint, (one, other) in zip(net.joints, net.lengths, strict=True):
        row = np.zeros(len(net.mass))
        row[joint] = 1.0 / one, -1.0 / one - 1.0 / other, 1.0 / other
        rows.append(row)
        weights.append(2.0 * RIGIDITY / (one + other))
    held = np.flatnonzero(net.mass)
    gradients = np.array(rows)[:, held] / np.sqrt(net.mass[held])
    most = np.linalg.eigvalsh(gradients.T @ (np.array(weights)[:, None] * gradients))[-1]
    told = 2.0 * float(net.p["bending_stiffening"])
    assert most * 2.0 / math.sqrt(3.0) <= told * (1.0 + 1e-12)
    terms = {**joined.terms}
    plain = {name: term for name, term in terms.items() if name != "bending"}
    every = all_values(terms, values)
    for tau in (0.0, 1e-3):
        bound, _ = substeps(
            every | {"bending.damping_time": tau, "net.youngs_modulus": 1.0, "net.damping_ratio": 0.0}, terms
        )
        # where the leapfrog's eigenvalue is -1, see `explicit_step_limit`
        assert bound**2 * told + 4.0 * bound * tau * told == pytest.approx(4.0, rel=1e-3)
    assert substeps(every, terms)[0] < substeps(every, plain)[0]


SWING = {
    **STILL,
    "net.side": 2.0,
    "net.mesh": 1.0,
    "net.segments": 8,
    "net.mass": 0.012,
    "net.youngs_modulus": 1e6,
    "net.fold_side": 2.0 - 2e-5,
    "knots.mass": 1e6,
    "bullets.speed": 0.0,
    "vertex.mass": 0.0,
    "bending.rigidity": RIGIDITY,
}
"""Threads of 1 g and 1 m between knots that stand still, a hundred-thousandth longer than these are apart."""


@pytest.mark.parametrize("tau", [0.0, 0.01])
def test_a_thread_of_a_net_swings_and_calms(tau):
    """Two threads of the rim, one up and one down: each a beam with supported ends, of omega and a ratio omega tau / 2
    by the closed form for so many hinges."""
    net = Instance(MODEL, BENT, SWING | {"bending.damping_time": tau}).initialise()
    memory, slots = planes(net), nodes(net)
    places = memory[X : X + 3, slots].T
    rim = places[:, 2].min()
    on = np.flatnonzero(np.abs(places[:, 2] - rim) < 1e-9)
    assert len(on) == 17
    at = places[on, 0]
    height = 1e-4 * np.sin(math.pi * (at + 1.0) / (1.0 - 1e-5))
    memory[X + 1, slots[on]] += height
    middle = slots[on[np.argmin(np.abs(at - 0.5))]]
    start = memory[X + 1, middle] - memory[X + 1, slots[0]]
    omega = 4.0 * math.sin(math.pi / 16.0) ** 2 * 64.0 * math.sqrt(RIGIDITY / 1e-3)
    zeta = 0.5 * omega * tau
    ringing = omega * math.sqrt(1.0 - zeta**2)
    period = 2.0 * math.pi / ringing
    found = []
    for _ in range(3):
        net.step(period)
        found.append((memory[SHOWN + 1, middle] - memory[SHOWN + 1, slots[0]]) / start)
    assert net["thread.tension_max"] == 0.0
    np.testing.assert_allclose(found, np.exp(-zeta * omega * period * np.arange(1, 4)), rtol=2e-3)
    assert net["bending.dissipated"] + net["bending.energy"] > 0.0


SHOT = {**STILL, "net.side": 8.0, "net.mesh": 2.0, "net.segments": 2, "solver.jitter[3]": 1e-3, "shot.roll": 0.3}


@pytest.mark.parametrize("tau", [0.0, 0.02])
def test_a_shot_keeps_its_books(tau):
    """Momenta to rounding and the energy book within 1 % of the shot, of which bending takes a part that counts."""
    net = Instance(MODEL, BENT, SHOT | {"bending.rigidity": 0.05, "bending.damping_time": tau}).initialise()
    start, spin = net["energy.total"], net.array("angular_momentum").copy()
    stored = 0.0
    for _ in range(8):
        net.step(0.5)
        assert np.abs(net.array("momentum")).max() < 1e-12 * 6.0
        assert np.abs(net.array("angular_momentum") - spin).max() < 1e-12 * 120.0
        stored = max(stored, net["bending.energy"])
    assert abs(net["energy.remainder"]) < 0.01 * start
    assert stored > 0.03 * start
    assert net["bending.dissipated"] > 0.03 * start if tau else net["bending.dissipated"] == 0.0


def test_a_scene_without_it_has_nothing_of_it():
    assert not any(v.name.startswith("bending") for v in MODEL.interface(FREE).variables)


def test_schemes_without_a_bound_know_none():
    found = refusals({**BENT, "solver": "ros2"}, all_values(BENT, {}), 10.0)
    assert [r.name for r in found] == ["solver.scheme"]
    assert not refusals({**BENT, "solver": "rk4"}, all_values(BENT, {}), 10.0)
