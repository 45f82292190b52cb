"""Threads that bend round the pieces of a union: thin plates, walls and what they stand on."""

import math

import numpy as np
import pytest

from dcone_cosim.loading import load
from fmu_src.implied import formula
from fmu_src.instance import Instance
from fmu_src.net_capture import bodies as among
from fmu_src.net_capture import near
from fmu_src.net_capture.contact.edges import make_way
from fmu_src.net_capture.contact.section import INSET
from fmu_src.net_capture.interface import MODEL
from fmu_src.net_capture.planes import U, X
from fmu_src.net_capture.shapes import pieces, union
from orbital.kernel import kernel
from tests.conftest import CAPTURE
from tests.net_capture.memory import Bench
from tests.net_capture.on_target import Kernels
from tests.plain import plain

__all__ = ["plain"]

TERMS = {"net": "square", "gravity": "none", "target": "union", "contact": "inelastic", "wrap": "friction"}
THICK, NODE, STIFFNESS = 0.04, 5e-4, 13368.0
HEAVY = {"target_mass": 1e9, "target_inertia": (1e9, 1e9, 1e9)}
"""A target that nothing moves."""


def box(size, position=(0.0, 0.0, 0.0), mass=100.0):
    return {"shape": pieces.BOX, "size": list(size), "position": list(position), "mass": mass}


def laid(*entries):
    """Tables of a union, in whose design axes it turns and moves."""
    made = union.lay({}, {union.PARTS: np.array(pieces.gather(entries))})
    return made.tables


PLATE = laid(box((2.0, THICK, 3.0)), box((0.5, 0.5, 0.5), (0.0, 0.0, -1.5)), box((0.5, 0.5, 0.5), (0.0, 0.0, 1.5)))
"""A plate across the second axis between two blocks, its rim at x = 1 m; all in the middle."""


@pytest.fixture(scope="module")
def kernels():
    return Kernels(TERMS, PLATE)


def momenta(scene, number, mass):
    places, speeds = (scene.planes[first : first + 3, :number].T for first in (X, U))
    held = scene.p["target_mass"] * scene.p["target_drift"]
    turning = np.cross(places, mass * speeds).sum(axis=0) + np.cross(scene.p["target_place"], held)
    return mass * speeds.sum(axis=0) + held, turning + scene.p["target_spin"]


def energy(scene, number, mass):
    return 0.5 * mass * float((scene.planes[U : U + 3, :number] ** 2).sum())


def test_a_thread_that_falls_centred_on_the_rim_keeps_what_its_nodes_have(kernels):
    """A contact point on a straight thread would have taken all of it. The error is the scheme's, and falls with it."""
    lost = []
    for substep in (4e-5, 2e-5):
        scene = kernels.place(**HEAVY | {"wrap_friction": 0.0})
        scene.put([NODE] * 2, [(1.02, 0.499, 0.0), (1.02, -0.499, 0.0)], [(-1.0, 0.0, 0.0)] * 2)
        scene.join(2, 1.0, STIFFNESS, 0.0).go(substep, round(0.4 / substep))
        assert (scene.p["wrap_passed"], scene.p["wrap_slipped"]) == (0, 0)
        assert scene.p["wrap_impulse"] > 0.4 * NODE
        assert np.linalg.norm(scene.planes[X : X + 3, 0] - scene.planes[X : X + 3, 1]) < 0.8, "they go round it"
        lost.append(abs(energy(scene, 2, NODE) / NODE - 1.0))
    assert lost[1] < 1e-4
    assert lost[1] < 0.6 * lost[0]


def test_all_momenta_are_kept_with_a_light_plate_that_turns(kernels):
    values = {"target_mass": 0.5, "target_inertia": (0.1, 0.2, 0.15), "wrap_friction": 0.2}
    scene = kernels.place(**values, target_start_rate=(0.3, 0.2, 0.5))
    scene.put([0.05] * 2, [(1.02, 0.499, 0.3), (1.02, -0.499, 0.1)], [(-1.0, 0.0, 0.0)] * 2)
    scene.join(2, 1.02, STIFFNESS, 1.0)
    before = momenta(scene, 2, 0.05)
    scene.go(2e-5, 20000)
    assert scene.p["wrap_impulse"] > 0.01
    for now, then in zip(momenta(scene, 2, 0.05), before, strict=True):
        assert now == pytest.approx(then, abs=1e-12)


class Chain:
    """Four nodes on three threads of one length over the rim of the plate, along it on both sides, a little slack.

    turn    angle by which the thread in the middle turns over both edges of the rim
    """

    MASS, LENGTH, SLACK = 0.1, 0.3, 1e-4

    def __init__(self, kernels, friction):
        self.scene = kernels.place(**HEAVY | {"wrap_friction": friction})
        self.p, self.planes = self.scene.p, self.scene.planes
        y, edge = 0.5 * THICK, 0.5 * THICK - INSET
        near = math.sqrt((0.5 * (self.LENGTH - self.SLACK) - edge) ** 2 - INSET**2)
        self.turn = math.pi - 2.0 * math.atan2(INSET, near)
        side = [(1.0 - INSET - near - (self.LENGTH - self.SLACK) * i, y, 0.0) for i in (1, 0)]
        places = side + [(x, -y, 0.0) for x, y, _ in side[::-1]]
        self.scene.put([self.MASS] * 4, places, np.zeros((4, 3))).join(4, self.LENGTH, 2e5, 100.0)

    def pulled(self, first, last, steps):
        """Speed of the first node along its pull after so many substeps of 0.1 ms [m/s]."""
        pulls = np.array([(-first, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (-last, 0.0, 0.0)])
        _, speeds = self.scene.go(1e-4, steps, pulls)
        return -float(speeds[-1, 0])

    def raised(self, start, end):
        """Slowly from pulls to others: a jerk would ring, and slide."""
        for share in 0.5 - 0.5 * np.cos(np.linspace(0.0, math.pi, 41)):
            self.pulled(*(np.array(start) + share * (np.array(end) - start)), 50)


def test_without_friction_a_chain_over_the_rim_pulls_alike_on_both_sides(kernels):
    chain = Chain(kernels, 0.0)
    chain.raised((0.0, 0.0), (20.0, 20.0))
    assert abs(chain.pulled(20.0, 20.0, 100)) < 1e-4
    pulls = chain.p["wrap_pulls"][:3]
    assert pulls == pytest.approx(np.full(3, 20.0), rel=5e-3)
    assert np.ptp(pulls) < 1e-5
    speed = chain.pulled(20.2, 20.0, 1000)
    assert speed == pytest.approx(0.2 / (4.0 * Chain.MASS) * 0.1, rel=0.02), "two ends of one cord"


def test_with_friction_it_holds_as_the_capstan_does(kernels):
    """Over both edges of the rim, by the sum of their angles: exp(mu phi)."""
    friction = 0.3
    chain = Chain(kernels, friction)
    most = 10.0 * math.exp(friction * chain.turn)
    chain.raised((0.0, 0.0), (10.0, 10.0))
    slid = float(chain.p["wrap_slide"])
    chain.raised((10.0, 10.0), (0.985 * most, 10.0))
    held = chain.p["wrap_slide"] - slid
    assert held < 2e-5
    assert chain.p["wrap_pulls"][0] / chain.p["wrap_pulls"][2] == pytest.approx(0.985 * most / 10.0, rel=0.01)
    chain.raised((0.985 * most, 10.0), (1.1 * most, 10.0))
    chain.pulled(1.1 * most, 10.0, 500)
    assert chain.p["wrap_slide"] - slid > 20.0 * held + 1e-3
    assert chain.p["wrap_friction_loss"] > 0.0


JOINED = laid(box((2.0, THICK, 1.0), (0.0, 0.0, -0.5)), box((2.0, THICK, 1.0), (0.0, 0.0, 0.5)))
"""Two plates that stand edge to edge at z = 0."""


def drawn_along(kernels, tables, places, velocity, length, steps):
    """Two nodes of 0.5 kg that draw a thread along an edge, in substeps of 0.1 ms; first it is slack."""
    scene = kernels.place(tables, **HEAVY | {"wrap_friction": 0.0})
    scene.put([0.5] * 2, places, [velocity] * 2).join(2, length, 1000.0, 0.0)
    scene.go(1e-4, steps)
    return scene


@pytest.mark.parametrize("aslant", [0.0, 0.05, 0.15])
def test_a_thread_goes_over_from_one_plate_to_the_next(kernels, aslant):
    """It comes over the rim, however aslant, is drawn across the joint, and moves as on a plate of one piece."""
    whole = laid(box((2.0, THICK, 2.0)))
    places = [(1.02, y, -0.1 - math.copysign(0.5 * aslant, y)) for y in (0.5 * THICK + 0.001, -0.5 * THICK - 0.001)]
    length = math.hypot(0.2, aslant)
    found = [drawn_along(kernels, tables, places, (-0.5, 0.0, 0.6), length, 3000) for tables in (JOINED, whole)]
    for scene in found:
        assert (scene.p["wrap_passed"], scene.p["wrap_passed_slack"], scene.p["wrap_slipped"]) == (0, 0, 0)
        assert scene.planes[X + 2, 0] > 0.0
        assert scene.p["wrap_impulse"] > 0.1
    one, other = (scene.planes[U : U + 3, :2] for scene in found)
    np.testing.assert_allclose(one, other, atol=1e-9)


def test_a_thread_that_comes_off_one_body_still_lies_over_the_other(kernels):
    """Over the edge of a block, in which that of a smaller one lies beneath it: its nodes go apart along both sides and
    spring back, and it is clear of the smaller one while it is taut."""
    larger, alone = box((2.0, 1.0, 1.0), (0.0, 0.0, -0.5)), box((2.0, 1.0, 2.0))
    both = laid(larger, box((1.94, 0.94, 1.0), (0.0, 0.0, 0.5)))
    found = []
    for tables in (both, laid(alone)):
        scene = kernels.place(tables, **HEAVY | {"wrap_friction": 0.0})
        scene.put([0.5] * 2, [(0.98, 0.505, -0.1), (1.005, 0.48, -0.1)], [(-1.5, 0.0, 0.0), (0.0, -1.5, 0.0)])
        ways, speeds = scene.join(2, 0.1, 1000.0, 0.0).go(1e-4, 1000)
        assert (scene.p["wrap_passed"], scene.p["wrap_passed_slack"]) == (0, 0)
        assert ways[:, 0].min() < 0.93, "then the straight way cuts the smaller one"
        assert speeds[-1, 0] > 1.4
        found.append((ways, speeds))
    np.testing.assert_allclose(*found, atol=1e-9)


def test_of_two_bodies_it_bends_round_that_which_asks_more(kernels):
    """A narrower plate reaches into the wider one, over whose rim the thread lies; its nodes come down past both."""
    stepped = laid(box((2.0, THICK, 1.0), (0.0, 0.0, -0.5)), box((1.94, THICK, 1.0), (0.0, 0.0, 0.5)))
    whole = laid(box((2.0, THICK, 2.0)))
    places = [(1.02, y, -0.1) for y in (0.5 * THICK + 0.001, -0.5 * THICK - 0.001)]
    found = [drawn_along(kernels, tables, places, (-0.6, 0.0, 0.0), 0.2, 2500) for tables in (stepped, whole)]
    one, other = (scene.planes[U : U + 3, :2] for scene in found)
    assert found[1].p["wrap_impulse"] > 0.1
    assert found[0].p["wrap_passed"] == 0
    np.testing.assert_allclose(one, other, atol=1e-9)


APART = laid(
    box((3.0, 0.4, 2.0), (0.0, -0.2, 0.0)),
    box((0.3, 0.52, 2.0), (-0.5, 0.25, 0.0)),
    box((0.2, 0.72, 2.0), (0.4, 0.35, 0.0)),
)
"""Two blocks on a plate, one higher than the other."""


def test_a_thread_over_two_bodies_at_once_keeps_what_its_nodes_have(kernels):
    """Its light nodes swing down on both sides, bends come and go at either, and it springs back: no kink, no gain."""
    lost = []
    for substep in (4e-5, 2e-5):
        scene = kernels.place(APART, **HEAVY | {"wrap_friction": 0.0})
        row = APART["target.pieces"][0]
        places = [row[5:8] + row[8:17].reshape(3, 3) @ np.array(x) for x in ((-1.0, 1.0, 0.1), (1.0, 1.0, -0.1))]
        speeds = [row[8:17].reshape(3, 3) @ np.array(v) for v in ((0.1, -1.5, 0.2), (-0.2, -1.2, -0.3))]
        scene.put([NODE] * 2, places, speeds).join(2, 2.02, STIFFNESS, 0.0)
        before, visits = energy(scene, 2, NODE), set()
        for _ in range(40):
            scene.go(substep, round(0.02 / substep))
            visits.add(int(scene.p["visits"]))
        assert max(visits) > 1
        assert (scene.p["wrap_passed"], scene.p["wrap_passed_slack"]) == (0, 0)
        assert scene.p["wrap_impulse"] > NODE
        lost.append(abs(energy(scene, 2, NODE) + scene.p["wrap_slip_loss"] + scene.p["contact_loss"] - before) / before)
    assert lost[1] < 1e-3
    assert lost[1] < 0.6 * lost[0]


WALL = {"shape": pieces.SHELL, "radius": 1.3, "length": 4.0, "thickness": 0.05, "angle": math.pi, "mass": 100.0}
CAP = WALL | {"length": 0.05, "thickness": 1.25, "mass": 20.0, "position": [0.0, 0.0, 2.025]}
SHELL = laid(WALL, CAP)


@pytest.mark.parametrize(("terms", "brought"), [({}, 0), ({"wrap": "plain"}, 2), ({"wrap": "friction"}, 2)])
def test_a_union_has_bodies_where_threads_bend_and_else_nothing_of_them(terms, brought):
    of_union = MODEL.interface(CAPTURE | {"target": "union"} | terms)
    names = [table.name for table in of_union.tables]
    assert names == ["target.pieces", "target.solid", "target.samples", "target.bodies", "target.planes"][: 3 + brought]
    assert MODEL.interface(CAPTURE | terms).tables == (), "a box has no pieces"


@pytest.mark.parametrize("tables", [PLATE, JOINED, SHELL], ids=["plate", "joined", "shell"])
def test_bodies_lie_within_the_union_and_fill_it(tables):
    """But for what a chord and a tangent lie within a shell, and what a covered face may stand out."""
    away, room = formula(union.union_distance), np.empty((3, 3))
    rows, draw = tables["target.pieces"], np.random.default_rng(3)
    numbers = {union.PIECES: rows}
    bodies, planes = union.bodies(numbers), union.planes(numbers)
    found = 0
    for first, number, *middle, radius in bodies:
        faces = planes[int(first) : int(first + number)]
        points = np.array(middle) + radius * draw.uniform(-1.0, 1.0, (4000, 3))
        inside = points[(points @ faces[:, :3].T <= faces[:, 3]).all(axis=1)]
        assert np.linalg.norm(inside - middle, axis=1).max() <= radius + 1e-12
        assert max(away(rows, *room, point) for point in inside) < INSET, "as deep as ways lie"
        found += len(inside)
    assert found > 50
    half = tables["target.solid"][10:13]
    points = draw.uniform(-half, half, (4000, 3))
    deep = points[[away(rows, *room, point) < -0.013 for point in points]]
    held = [
        any((planes[int(f) : int(f + n), :3] @ x <= planes[int(f) : int(f + n), 3]).all() for f, n, *_ in bodies)
        for x in deep
    ]
    assert len(deep) > 50
    assert all(held)


def test_a_thread_is_drawn_along_the_rim_of_a_shell_from_body_to_body(kernels):
    """Over the open end of its wall: its nodes hang on both sides, and it goes through nothing."""
    center = union.body_of(np.array(pieces.gather([WALL, CAP]))).center
    out = np.array([math.cos(-0.2), math.sin(-0.2), 0.0])
    places = [away * out + (0.0, 0.0, -2.02) - center for away in (1.302, 1.248)]
    along = np.array([-0.5 * out[1], 0.5 * out[0], 0.6])
    scene = drawn_along(kernels, SHELL, places, along, 0.45, 5000)
    at = scene.planes[X : X + 3, :2].T + center
    assert scene.p["wrap_passed"] == 0
    assert scene.p["wrap_impulse"] > 0.1
    assert (np.arctan2(at[:, 1], at[:, 0]) > -0.1).all(), "past the inner edge of a body, which ends at -0.121"
    assert (at[:, 2] > -1.95).all()
    assert (at[:, 2] < -1.7).all(), "held by the end of the wall"
    away = np.hypot(at[:, 0], at[:, 1])
    assert away[0] > 1.299
    assert away[1] < 1.251
    held = energy(scene, 2, 0.5) + scene.p["contact_loss"] + scene.p["wrap_slip_loss"]
    assert held == pytest.approx(0.305, rel=1e-4), "kinetic energy at the start [J]; it is not taut in the end"


def test_no_way_lies_on_edges_that_a_body_has_not():
    """Between faces that lie in other bodies there may be no edge left, and a way over one would be anywhere."""
    bench, draw = Bench(TERMS, SHELL), np.random.default_rng(1)
    search, record = make_way(bench.parts.target.shape.hulls), bench.record

    @kernel
    def found(record):
        return search(record[0], 0)

    numbers = {union.PIECES: SHELL["target.pieces"]}
    bodies, planes = union.bodies(numbers), union.planes(numbers)
    bent = 0
    for _ in range(8000):
        first, number, *middle, radius = bodies[draw.integers(len(bodies))]
        faces = planes[int(first) : int(first + number)]
        record["wrap_faces"], record["wrap_planes"][0, : len(faces)] = len(faces), faces[:, :4]
        record["wrap_covered"][0, : len(faces)] = faces[:, 4]
        middle, half = middle + 0.9 * radius * draw.uniform(-1.0, 1.0, 3), draw.normal(size=3)
        half *= draw.uniform(0.05, 0.5) / np.linalg.norm(half)
        record["wrap_a"], record["wrap_b"] = middle - half, middle + half
        edges = int(found(record))
        if edges > 0:
            bent += 1
            out = record["wrap_bends"][0, 1 : edges + 1] @ faces[:, :3].T - faces[:, 3]
            assert out.max() < -0.5 * INSET
            assert record["wrap_pieces"][0, : edges + 1, 3].sum() > 2.0 * np.linalg.norm(half)
    assert bent > 10


NETTED = laid(box((1.0, 1.6, 1.0), mass=20.0), box((3.0, 1.2, THICK), (0.0, 0.0, 0.1), 5.0))
"""A block in the middle of a plate."""
DRAWN_IN = {
    "target.mass": 25.0,
    "target.start_rate[1]": 0.02,
    "target.start_rate[3]": 0.03,
    "net.side": 6.0,
    "net.mesh": 1.0,
    "net.mass": 0.3,
    "net.youngs_modulus": 7e10,
    "bullets.mass": 0.4,
    "chaser.mass": 200.0,
    "chaser.start_position[2]": -6.0,
    "closing.time": 2.6,
    "closing.speed": 5.0,
    "closing.stall_force": 6.0,
    "closing.rings": 0,
    "closing.axial_stiffness": 90.0,
}
"""A small net round it; its cord is soft, so that it holds much."""


def stretches_bent(net):
    """How many stretches of the cord bend round the target now."""
    p = net.record[0]
    numbers, kept = int(p["wrap_numbers"]), 1 + near.KEPT + among.KEPT
    states = net.work.view(np.int64)[int(p["work_size"]) - (kept - 1) * numbers :][:numbers]
    return int((states[int(p["thread_numbers"]) :] == near.BENT).sum())


@pytest.mark.parametrize("slack", [0, 1], ids=["taken in", "wound"])
def test_a_cord_that_bends_keeps_all_momenta_and_tells_what_it_loses_where_it_slides_off(slack):
    terms = load("big-panel-wrapped").phases[0].main.terms  # other tests build an FMU of them
    net = Instance(MODEL, terms, DRAWN_IN | {"closing.slack": slack}, NETTED).initialise()
    linear, angular = net.array("momentum").copy(), net.array("angular_momentum").copy()
    most, shot = 0, 4.0 * 0.4 * 3.0
    net.step(3.5)
    before = net["energy.remainder"]
    for _ in range(10):
        net.step(0.05)
        most = max(most, stretches_bent(net))
        np.testing.assert_allclose(net.array("momentum"), linear, atol=1e-9 * shot, rtol=0.0)
        np.testing.assert_allclose(net.array("angular_momentum"), angular, atol=1e-9 * shot * 6.0, rtol=0.0)
    assert most >= 2
    assert net["wrap.passed"] == 0
    assert net["wrap.slip_loss"] > 1.0
    assert abs(net["energy.remainder"] - before) < 0.01 * net["wrap.slip_loss"]
