"""Threads that bend round the target: the way over its edges, nodes that swing round them, corners, momenta."""

import math
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.optimize import minimize

from fmu_src.implied import formula
from fmu_src.net_capture.contact.edges import make_way
from fmu_src.net_capture.contact.section import INSET
from fmu_src.net_capture.interface import MODEL, refusals
from fmu_src.net_capture.planes import U, X
from fmu_src.net_capture.refusal import Scene
from fmu_src.net_capture.shapes import box, cylinder, frustum, sphere
from fmu_src.net_capture.wrap_rows import OF_UNIONS
from orbital.kernel import kernel
from tests.net_capture.on_target import Kernels
from tests.validation import closed_form, other_code

BOX = {"net": "square", "gravity": "none", "target": "box", "contact": "inelastic", "wrap": "plain"}
SIDES = {"target_size": (4.0, 8.0, 4.0), "target_mass": 1e9}
HALF = np.array([2.0, 4.0, 2.0]) - INSET
NODE, LENGTH = 5e-4, 1.0
STIFFNESS = 13368.0


@pytest.fixture(scope="module")
def kernels():
    return Kernels(BOX)


@pytest.fixture(scope="module")
def find(kernels):
    search = make_way()

    @kernel
    def found(record, edges):
        return search(record[0], edges)

    return found


class Ways:
    """Ways round a body from end to end; each goes on from the side of the one before, unless it begins anew.

    part, sizes    kernels of a shape, and what they read of the record
    """

    def __init__(self, kernels, find, part, **sizes):
        self.scene, self.find, self.edges = kernels.place(**SIDES), find, 0
        self.p = self.scene.p
        body = SimpleNamespace(**sizes, half_size=np.zeros(3), shape_half=np.zeros(3))
        formula(part.measure)(body)
        self.p["wrap_faces"] = formula(part.faces)(body, self.p["wrap_planes"])
        self.p["envelope_radius"] = body.envelope_radius
        self.away = lambda point: float(formula(part.distance)(body, np.zeros(3), point))

    def __call__(self, a, b, anew=True):
        """Points of the way; None where it is straight."""
        self.p["wrap_a"], self.p["wrap_b"] = a, b
        self.edges = int(self.find(self.scene.record, 0 if anew else self.edges))
        return self.p["wrap_bends"][: self.edges + 2].copy() if self.edges else None

    def outside(self, direction, share):
        """Where a ray from the centre leaves the body, and a share farther [m]."""
        reach, step = 0.0, 2.0
        for _ in range(40):
            step *= 0.5
            reach += step if self.away((reach + step) * direction) < 0.0 else 0.0
        return (1.0 + share) * (reach + 1e-9) * direction

    def deepest(self, points):
        """How deep below the surface the pieces of a way come [m]."""
        shares = np.linspace(0.0, 1.0, 23)[:, None]
        pieces = [p + shares * (q - p) for p, q in pairwise(points)]
        return -min(self.away(point) for piece in pieces for point in piece)


@pytest.fixture(scope="module")
def ways(kernels, find):
    return Ways(kernels, find, box, target_size=(4.0, 8.0, 4.0))


def length_of(points):
    return float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())


@pytest.mark.parametrize("seed", range(6))
def test_a_way_over_an_edge_is_the_shortest(ways, validated, seed):
    """Of all points of that edge, by minimising."""
    draw = np.random.default_rng(seed)
    a = np.array([draw.uniform(1.4, 1.95), draw.uniform(-1.0, 1.0), 2.0 + draw.uniform(0.0, 0.3)])
    b = np.array([2.0 + draw.uniform(0.0, 0.3), draw.uniform(-1.0, 1.0), draw.uniform(1.2, 1.7)])
    over = lambda t: np.array([a, (HALF[0], t[0], HALF[2]), b])  # noqa: E731
    shortest = minimize(lambda t: length_of(over(t)), [0.0], tol=1e-14)
    found = ways(a, b)
    if found is None:
        assert not any(np.all(np.abs(a + s * (b - a)) < HALF) for s in np.linspace(0.0, 1.0, 2001)), "it cuts the box"
    else:
        source = other_code("the shortest by scipy's minimize")
        validated(source, "thread over an edge of a box: its way", found, over(shortest.x), "m", abs=1e-6)
        assert length_of(found) <= shortest.fun + 1e-12


def shortest_over(planes, faces, a, b):
    """Length of the shortest way from end to end over the edges between these faces, each on it, by scipy [m]."""
    ends = []
    for one, other in pairwise(faces):
        along = np.cross(planes[one, :3], planes[other, :3])
        foot = np.linalg.lstsq(planes[[one, other], :3], planes[[one, other], 3] - INSET, rcond=None)[0]
        others = np.delete(planes, [one, other], axis=0)
        rises, below = others[:, :3] @ along, others[:, 3] - INSET - others[:, :3] @ foot
        reach = (below / rises)[rises < 0.0].max(), (below / rises)[rises > 0.0].min()
        ends.append([foot + t * along for t in reach])
    low, high = np.swapaxes(ends, 0, 1)
    shares = np.full(len(low), 0.5)

    def length(shares, soft):
        points = np.vstack([a, low + shares[:, None] * (high - low), b])
        return np.sqrt((np.diff(points, axis=0) ** 2).sum(axis=1) + soft**2).sum()

    for soft in (1e-2, 1e-3, 1e-4, 1e-5, 1e-7):
        bounds = [(0.0, 1.0)] * len(low)
        shares = minimize(length, shares, (soft,), "L-BFGS-B", bounds=bounds, options={"ftol": 1e-15, "gtol": 1e-10}).x
    return length(shares, 0.0)


@pytest.mark.parametrize(
    ("a", "b", "faces"),
    [
        ((0.23372003, 1.34417444, -0.16023094), (-0.05806457, 1.06261469, 0.74664491), (142, 108, 87, 74)),
        ((0.39265285, 0.50686272, 1.13101479), (-0.43813043, -0.00709385, 1.22393842), (24, 11, 3, 6, 1, 9)),
        ((0.95607028, 0.80162859, 0.36513758), (1.05126002, 0.56235842, -0.58845843), (126, 139, 160, 173, 194, 207)),
        ((0.49579279, -0.48728208, 1.09853669), (0.46827283, 0.49335104, 1.10785632), (18, 26, 13, 21, 8, 16)),
        ((-1.12000116, -0.17054159, -0.64282028), (-0.40006173, -0.737941, -0.99674), (237, 258, 279, 266, 287, 274)),
    ],
    ids=["to and fro", "to and fro, from six faces", "two corners at once", "creases", "zigzag"],
)
def test_near_corners_a_way_is_no_longer_than_over_the_edges_where_it_lay(kernels, find, a, b, faces):
    """Of threads that netted a ball of 1.3 m: where such a way seemed to grow, they were let through it."""
    ways = Ways(kernels, find, sphere, target_radius=1.3)
    ways.edges = len(faces) - 1
    ways.p["wrap_chain"][: len(faces)] = faces
    planes = ways.p["wrap_planes"][: int(ways.p["wrap_faces"])].copy()
    wanted = shortest_over(planes, faces, a, b)
    assert 0.9 * math.dist(a, b) < wanted < 1.05 * math.dist(a, b), "the twin finds a way"
    assert length_of(ways(a, b, anew=False)) <= wanted + 1e-7


def test_over_two_edges_it_is_straight_on_the_faces_laid_flat(ways, validated):
    """From above to below, over a side of 4 m; and over a corner, on the side where the thread lay."""
    found = ways((1.0, -0.3, 2.0), (1.0, 0.9, -2.0))
    ends = math.hypot(HALF[0] - 1.0, INSET)
    assert len(found) == 4
    flat, what = closed_form("straight on the faces laid flat"), "thread over two edges of a box: length of its way"
    validated(flat, what, length_of(found), math.hypot(2.0 * (ends + HALF[2]), 1.2), "m", abs=1e-12)
    a, b = np.array([1.0, 3.8, 2.0]), np.array([2.0, 3.5, 1.0])
    one = ways(a, b)
    ways((1.0, 4.0, 1.9), b)
    two = ways(a, b, anew=False)
    assert (len(one), len(two)) == (3, 4)
    assert length_of(one) == pytest.approx(math.hypot(2.0 * math.hypot(HALF[0] - 1.0, INSET), 0.3), abs=1e-12)
    over = lambda t: np.array([a, (t[0], HALF[1], HALF[2]), (HALF[0], HALF[1], t[1]), b])  # noqa: E731
    shortest = minimize(lambda t: length_of(over(t)), [1.3, 1.3], tol=1e-14)
    np.testing.assert_allclose(two, over(shortest.x), atol=1e-6)


@pytest.mark.parametrize(
    ("a", "b", "chain", "length"),
    [
        ((1.0484, 2.1504, -1.1275), (1.2818, 1.7937, -1.1398), (2, 5, 0), 0.4999284),
        ((1.2152, 1.7943, -1.3374), (1.0818, 2.1401, -1.0542), (5, 0, 2), 0.4997701),
    ],
)
def test_near_a_corner_it_is_not_held_there(kernels, find, a, b, chain, length):
    """As met in the mission: over both edges it is shorter than through their corner, 14 and 20 mm away."""
    ways = Ways(kernels, find, box, target_size=(2.5, 3.9, 2.5))
    ways.edges, ways.p["wrap_chain"][:3] = 2, chain
    found = ways(np.array(a), np.array(b), anew=False)
    corner = 0.5 * np.array((2.5, 3.9, -2.5)) - INSET * np.array((1, 1, -1))
    assert length_of(found) == pytest.approx(length, abs=2e-7)
    assert length_of(found) < length_of(np.array([a, corner, b])) - 2e-4


PLATE = 0.5 * np.array((1.0, 1.6, 0.3)) - INSET


def test_a_way_that_has_come_to_a_corner_draws_back_where_it_is_shorter_over_both_edges(kernels, find):
    """As ends that wandered over a plate met it: over three edges, two of which meet at a corner."""
    ways = Ways(kernels, find, box, target_size=(1.0, 1.6, 0.3))
    ways.edges, ways.p["wrap_chain"][:4] = 3, (4, 1, 3, 5)
    a, b = np.array((-0.283095, -0.219012, 0.175618)), np.array((-0.158829, -0.510481, -0.15))
    found = ways(a, b, anew=False)
    x, y, z = PLATE
    over = lambda t: np.array([a, (-x, t[0], z), (-x, -y, t[1]), (t[2], -y, -z), b])  # noqa: E731
    shortest = minimize(lambda t: length_of(over(t)), [-0.4, 0.0, -0.3], tol=1e-14)
    assert len(found) == 5
    assert length_of(found) == pytest.approx(shortest.fun, abs=1e-7)


def test_a_way_that_has_come_to_a_corner_slides_over_it_where_it_is_not(kernels, find):
    """The same plate: over the side between, the faces take more than half a turn, and one edge is left."""
    ways = Ways(kernels, find, box, target_size=(1.0, 1.6, 0.3))
    ways.edges, ways.p["wrap_chain"][:3] = 2, (5, 1, 3)
    a, b = np.array((-0.331748, -0.579109, -0.15)), np.array((-0.135303, -0.972276, 0.141359))
    found = ways(a, b, anew=False)
    over = lambda t: np.array([a, (t[0], -PLATE[1], -PLATE[2]), b])  # noqa: E731
    shortest = minimize(lambda t: length_of(over(t)), [-0.2], tol=1e-14)
    assert len(found) == 3
    assert length_of(found) == pytest.approx(shortest.fun, abs=1e-7)


def test_what_does_not_cut_an_edge_stays_straight(ways):
    assert ways((0.0, 0.0, 2.0), (1.0, 0.0, 2.0)) is None, "both on one face"
    assert ways((0.0, 0.0, 2.5), (1.0, 0.0, 2.1)) is None, "above it"
    assert ways((2.5, 0.0, 2.5), (3.5, 0.0, 1.0)) is None, "beside it"
    assert ways((1.9, 0.0, 2.0), (2.0, 0.0, 1.9)) is not None, "round a corner from face to face"
    assert len(ways((0.0, 3.9, 2.1), (0.0, 3.9, -2.1))) == 4, "round two edges, over the nearest side"


BODIES = {
    box: {"target_size": (1.0, 1.6, 0.3)},
    cylinder: {"target_radius": 0.6, "target_length": 0.9},
    frustum: {"target_radius_bottom": 0.7, "target_radius_top": 0.2, "target_length": 0.8},
    sphere: {"target_radius": 0.6},
}


@pytest.mark.parametrize("part", BODIES, ids=lambda part: part.__name__.rpartition(".")[2])
def test_a_way_never_grows_at_once_and_never_goes_through(kernels, find, part):
    """Both ends wander over the body, so that the thread slides over corners, off and on again."""
    ways = Ways(kernels, find, part, **BODIES[part])
    draw = np.random.default_rng(7)
    longest, slid, bent, most = 0.0, 0, 0, 0
    for _ in range(4):
        waves, phases = draw.uniform(0.3, 1.5, (2, 4)), draw.uniform(0.0, 2.0 * math.pi, (2, 4))
        before = None
        for step in range(600):
            swings = np.sin(0.02 * step * waves + phases)
            swings[1, :3] = swings[0, :3] + 0.8 * swings[1, :3]
            ends = [ways.outside(s[:3] / np.linalg.norm(s[:3]), max(0.3 * s[3], 0.0)) for s in swings]
            points = ways(*ends, anew=before is None)
            if points is None:
                before = None
                continue
            bent, most = bent + 1, max(most, len(points) - 2)
            if before is not None:
                moved = sum(np.linalg.norm(end - old) for end, old in zip(ends, before[0], strict=True))
                grown = length_of(points) - length_of(before[1])
                slid += grown < -moved - 1e-3
                longest = max(longest, grown - moved)
            if step % 5 == 0:
                assert ways.deepest(points) < INSET + 0.013 * 0.6
            before = ends, points
    assert longest < 1e-9
    assert bent > 600
    assert most >= 3 or part is box
    assert slid > 0 or part is not box


def swung(kernels, **values):
    """Two nodes that fall at 1 m/s with a taut thread across an edge: energy [J] of both and in the thread after 0.3 s,
    over that at the start."""
    scene = kernels.place(**SIDES | values)
    edge = np.array([2.0, 0.0, 2.0])
    across, down = np.array([-1.0, 0.0, 1.0]) / math.sqrt(2.0), np.array([-1.0, 0.0, -1.0]) / math.sqrt(2.0)
    places = [edge + 0.5 * LENGTH * side * across - 0.01 * down for side in (1.0, -1.0)]
    scene.put([NODE] * 2, places, [down] * 2).join(2, LENGTH, STIFFNESS, 0.0)
    before = momenta(scene)
    scene.go(2e-5, 15000)
    speeds = scene.planes[U : U + 3, :2].T
    return scene, 0.5 * NODE * (speeds**2).sum() / NODE, before


def momenta(scene):
    places, speeds = (scene.planes[first : first + 3, :2].T for first in (X, U))
    held = scene.p["target_mass"] * scene.p["target_drift"]
    turning = np.cross(places, NODE * speeds).sum(axis=0) + np.cross(scene.p["target_place"], held)
    return NODE * speeds.sum(axis=0) + held, turning + scene.p["target_spin"]


def test_nodes_swing_round_an_edge_and_keep_what_they_have(kernels, validated):
    """A contact point in the middle of a straight thread would have left them nothing."""
    scene, share, _ = swung(kernels)
    kept = closed_form("what both had: the edge does no work")
    validated(kept, "two nodes on a thread round an edge: energy over that at the start", share, 1.0, abs=1e-6)
    assert scene.p["wrap_impulse"] > 0.2 * NODE
    # they go round: what fell now comes from both sides
    assert np.linalg.norm(scene.planes[X : X + 3, 0] - scene.planes[X : X + 3, 1]) < 0.9 * LENGTH


def test_a_light_target_takes_the_opposite_of_all(kernels):
    scene, _, before = swung(kernels, target_mass=0.05, target_start_rate=(0.2, 0.1, 0.4))
    for now, then in zip(momenta(scene), before, strict=True):
        assert now == pytest.approx(then, abs=1e-12 * np.abs(then).max() + 1e-15)
    assert np.linalg.norm(scene.p["target_drift"]) > 1e-3


def test_the_pull_along_the_way_takes_the_place_of_the_straight_one(kernels):
    """Both are taut: each node is pulled towards the edge alone, by k (l - L)."""
    edge, places = np.array([HALF[0], 0.0, HALF[2]]), np.array([(1.5, 0.0, 2.02), (2.02, 0.0, 1.995)])
    scene = kernels.place(**SIDES).put([NODE] * 2, places, np.zeros((2, 3))).join(2, 0.5, 13368.0, 0.0)
    scene.go(1e-6, 1)
    far = np.linalg.norm(places - edge, axis=1)
    towards = (edge - places) / far[:, None]
    pull = 13368.0 * (far.sum() - 0.5)
    np.testing.assert_allclose(scene.planes[U : U + 3, :2].T, 1e-6 * pull / NODE * towards, rtol=1e-6, atol=1e-9)


def test_a_taut_thread_that_is_through_already_stays_straight(kernels):
    """The pull of a way that is there at once would come from nowhere."""
    scene = kernels.place(**SIDES)
    places = [(1.4, 0.0, 2.001), (2.001, 0.0, 1.4)]
    scene.put([NODE] * 2, places, np.zeros((2, 3))).join(2, 1.1, 13368.0, 0.0)
    scene.go(2e-5, 10)
    assert scene.p["wrap_passed"] == 1
    assert scene.p["wrap_impulse"] == 0.0
    # were it slack, it would have its way at once, and pull once that is longer than it is
    scene = kernels.place(**SIDES).put([NODE] * 2, places, [(-1.0, 0.0, 0.0), (0.0, 0.0, -1.0)])
    scene.join(2, 1.21, 13368.0, 0.0).go(2e-5, 1000)
    assert scene.p["wrap_passed"] == 0
    assert scene.p["wrap_impulse"] > 0.2 * NODE


def test_a_thread_that_slides_off_the_end_of_an_edge_loses_what_it_held(kernels):
    """Its nodes draw it taut, and along the edge past the corner: what they have lost is told to be lost."""
    places = np.array([(1.6, 3.9, 2.05), (2.05, 3.9, 1.6)])
    length, heavy = 2.0 * math.hypot(2.0 - INSET - 1.6, 0.05 + INSET) + 0.005, 50.0
    drawn = np.array([(-0.25, 1.0, 0.0), (0.0, 1.0, -0.25)])
    scene = kernels.place(**SIDES).put([heavy] * 2, places, drawn).join(2, length, 1000.0, 0.0)
    scene.go(1e-4, 1500)
    lost = 0.5 * heavy * ((drawn**2).sum() - (scene.planes[U : U + 3, :2] ** 2).sum())
    assert (scene.p["wrap_slipped"], scene.p["wrap_passed"]) == (1, 0)
    assert scene.p["wrap_slip_loss"] == pytest.approx(lost, rel=2e-3)
    assert lost > 0.3


def test_nodes_swing_round_two_edges_of_a_panel(kernels):
    """Thinner than the thread is long: over its rim the way bends twice, and it holds both nodes."""
    scene = kernels.place(target_size=(4.0, 8.0, 0.2), target_mass=1e9)
    places = [(1.6, 0.0, 0.15), (1.6, 0.0, -0.15)]
    scene.put([NODE] * 2, places, [(-1.0, 0.0, 0.0)] * 2).join(2, 1.05, STIFFNESS, 0.0)
    scene.go(1e-5, 20000)
    assert scene.p["wrap_impulse"] > NODE
    assert scene.p["wrap_passed"] == 0
    assert 0.5 * (scene.planes[U : U + 3, :2] ** 2).sum() == pytest.approx(1.0, abs=4e-4)
    assert (scene.planes[U, :2] > 0.5).all()


@pytest.mark.parametrize("bends", ["plain", "friction"])
def test_round_one_body_there_is_nothing_of_visits(bends):
    """What ways among several bodies scribble on, 12 kB, stands in the record of a union alone."""
    one, several = (MODEL.interface(BOX | {"wrap": bends, "target": shape}) for shape in ("box", "union"))
    names = {v.name for v in one.variables}
    assert names.isdisjoint(v.name for v in OF_UNIONS)
    assert not any(name.startswith(("visit", "joint")) for name in names)
    assert {v.name for v in several.variables} > {v.name for v in OF_UNIONS}
    numbers = sum(v.size for v in OF_UNIONS)
    assert several.make_record().nbytes - one.make_record().nbytes >= 8 * numbers > 12000


def test_what_no_thread_bends_with_is_refused():
    terms = dict(BOX)
    interface = MODEL.interface(terms | {"precision": "single"})
    start = {n: s for v in interface.variables for n, s in zip(v.element_names(), v.starts(), strict=True)}
    assert [r.name for r in refusals(terms | {"precision": "single"}, start)] == ["solver.precision"]
    hollow = MODEL.interface(terms | {"target": "mesh"}).terms
    found = MODEL.groups["wrap"].terms["plain"].refuses(Scene(hollow, {}, 1.0, {}))
    assert [r.name for r in found] == ["target.shape"]
    with pytest.raises(ValueError, match="break"):
        MODEL.interface(terms | {"break": "breaks"})
