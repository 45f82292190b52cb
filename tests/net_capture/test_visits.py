"""The way of a thread over several bodies of a union at once."""

import itertools
import math

import numpy as np
import pytest

from fmu_src.net_capture import bodies as among
from fmu_src.net_capture import near
from fmu_src.net_capture.contact.edges import make_way
from fmu_src.net_capture.lying import make_lie
from fmu_src.net_capture.planes import X
from fmu_src.net_capture.shapes import pieces, union
from fmu_src.net_capture.shapes.hulls import INSET
from fmu_src.net_capture.visit_list import VISITS, make_visit_list
from fmu_src.net_capture.visits import make_visits
from tests.net_capture.memory import Bench, planes_of
from tests.net_capture.test_union_wrapping import THICK, box, laid
from tests.plain import plain, plainly

__all__ = ["plain"]

TERMS = {"net": "square", "gravity": "none", "target": "union", "contact": "inelastic", "wrap": "plain"}
LONG, WIDE = 6.0, 1e3
"""Of a box along the third axis, and of a thread that is slack however it lies [m]."""


BASE = np.array((0.0, -0.2, 0.0))


def towers(*entries):
    """Long boxes that stand side by side on y = 0, from their middles, widths and heights, on a base beneath them all
    into which they reach 2 cm."""
    entries = [box((wide, high + 0.02, LONG), (x, 0.5 * high - 0.01, 0.0)) for x, wide, high in entries]
    return laid(box((3.0, 0.4, LONG), tuple(BASE)), *entries)


class Seeker:
    """A thread among the bodies of a union, between two places in design axes."""

    def __init__(self, tables, terms=TERMS):
        self.bench = Bench(terms, tables)
        parts, p = self.bench.parts, self.bench.p
        self.p, self.lie, self.hulls = p, make_lie(parts, None), parts.target.shape.hulls
        self.rounds = among.make_bodies(parts, near.KEPT, self.lie, None)
        p.wrap_body, p.wrap_numbers, p.solver_substep, p.envelope_radius = -1, 1, 5e-5, 5.0
        p.target_pose[:] = 1.0, 0.0, 0.0, 0.0
        self.words = np.zeros(near.KEPT + among.KEPT, np.int64)
        self.planes = planes_of(p, self.bench.work, parts.terms)
        base = tables["target.pieces"][0]
        self.place, self.turn = base[5:8], base[8:17].reshape(3, 3)

    def __call__(self, a, b, length=WIDE):
        """Length of its way [m]."""
        self.planes[X : X + 3, :2] = np.transpose([self.place + self.turn @ (end - BASE) for end in (a, b)])
        edges, way, *_ = plainly(self.rounds.seek.py_func)(self.p, self.bench.work, self.words, 0, 0, 1, length)
        self.words[near.STATE], self.words[near.WAY] = near.BENT if edges else near.FREE, round(way / near.FINE)
        return way

    @property
    def lost(self):
        return int(self.p.wrap_passed), int(self.p.wrap_passed_slack)


def above(first, middle, last):
    """Whether the straight way from the first to the last of three points goes above the one between."""
    (x, y), (u, v), (s, t) = first, middle, last
    return (u - x) * (t - y) >= (v - y) * (s - x)


def over(a, b, corners):
    """Length of the shortest way from a to b above all corners, whose edges are along the third axis: laid flat it is
    straight, and across them it is the upper hull."""
    inner = sorted(tuple(c) for c in corners if min(a[0], b[0]) < c[0] < max(a[0], b[0]))
    ends = sorted([(a[0], a[1]), (b[0], b[1])])
    hull = []
    for point in [ends[0], *inner, ends[1]]:
        while len(hull) > 1 and above(hull[-2], hull[-1], point):
            hull.pop()
        hull.append(point)
    across = sum(math.dist(p, q) for p, q in itertools.pairwise(hull))
    return math.hypot(across, a[2] - b[2])


STEPS = {
    "two that stand apart": ((-0.5, 0.3, 0.5), (0.4, 0.2, 0.7)),
    "a stair of three": ((-0.4, 0.4, 0.3), (0.0, 0.4, 0.6), (0.4, 0.4, 0.5)),
    "a low one between two": ((-0.6, 0.2, 0.6), (0.0, 0.3, 0.35), (0.7, 0.2, 0.5)),
    "one inside another": ((0.0, 1.0, 0.4), (0.1, 0.3, 0.55)),
}


@pytest.mark.parametrize("stand", STEPS.values(), ids=STEPS)
def test_over_several_bodies_it_is_the_upper_hull_of_all(stand):
    """It is let down on them from above, and then its ends wander on both sides, askew."""
    seek, draw = Seeker(towers(*stand)), np.random.default_rng(5)
    corners = [(x + side * (0.5 * wide - INSET), high - INSET) for x, wide, high in stand for side in (-1.0, 1.0)]
    goals = [(np.array((-1.1, 1.0, -0.3)), np.array((1.2, 1.0, 0.2)))]
    goals += [
        (np.array((-1.1, 0.1, -0.3)), np.array((1.2, 0.2, 0.2))),
        *(
            (
                np.array((-draw.uniform(0.85, 1.4), *draw.uniform((0.05, -0.5), (0.9, 0.5)))),
                draw.uniform((0.9, 0.05, -0.5), (1.4, 0.9, 0.5)),
            )
            for _ in range(4)
        ),
    ]
    bends = set()
    for one, other in itertools.pairwise(goals):
        for share in np.linspace(0.0, 1.0, 40):
            a, b = (start + share * (end - start) for start, end in zip(one, other, strict=True))
            assert seek(a, b) == pytest.approx(over(a, b, corners), abs=1e-9)
            bends.add(int(seek.p.visits))
    assert max(bends) > 1
    assert seek.lost == (0, 0)


def test_an_edge_ends_where_it_runs_into_another_body():
    """Round the upright edge of a block, between ends that would have it cross that below the base on which it stands:
    there it is held as deep in the base as ways lie."""
    seek = Seeker(towers((0.0, 0.6, 0.8)))
    p, depths = seek.p, []
    take = make_visits(seek.hulls, seek.lie, make_visit_list()).take
    for others in (0, 1):
        p.wrap_others_near, p.wrap_others[0] = others, 0
        plainly(take.py_func)(p, 1)
        ends = (np.array((0.4, 0.0, 0.5 * LONG - 0.5)), np.array((0.0, -0.022, 0.5 * LONG + 0.3)))
        p.wrap_a[:], p.wrap_b[:] = (seek.place + seek.turn @ (end - BASE) for end in ends)
        assert int(plainly(seek.lie.find.py_func)(p, 0)) == 1
        depths.append((seek.turn.T @ (p.wrap_bends[1] - seek.place) + BASE)[1])
    assert depths[1] == pytest.approx(-INSET, abs=1e-6)
    assert depths[0] < depths[1] - 1e-3, "alone it reaches 2 cm into the base"


@pytest.mark.parametrize("high", [0.1, 0.2, 0.3])
def test_an_edge_that_goes_on_as_that_of_a_lower_block_is_followed_on_it(high):
    """The end of the first block stands above the second: there the edge has an end over which a way could slide. Both
    ends of the thread lie on the faces, so that nothing else brings it over to the second."""
    seek = Seeker(laid(box((1.0, 0.4, 1.0), tuple(BASE)), box((0.5, high, 1.0), (0.75, 0.5 * high - 0.4, 0.0))))
    edge, aslant = np.array((-0.4 + INSET, 0.5 - INSET)), 0.15
    a, b = np.array((-0.4005, 0.3)), np.array((-0.4 + 0.5 * high, 0.5005))
    way = math.hypot(np.linalg.norm(a - edge) + np.linalg.norm(b - edge), aslant)
    seek(np.array((-0.3, *a)), np.array((aslant - 0.3, *b)))
    for x in [*np.linspace(-0.3, 0.75, 70), *np.linspace(0.75, -0.3, 60)]:
        assert seek(np.array((x, *a)), np.array((x + aslant, *b)), 0.1) == pytest.approx(way, abs=1e-9)
        assert seek.lost == (0, 0)


@pytest.mark.parametrize("back", [False, True])
def test_a_way_that_is_held_in_a_corner_goes_over_to_an_edge_that_turns_off_there(back):
    """Two blocks stand in an angle, their tops in one plane; the thread comes over the edge of one, and its upper end
    goes round to above the other."""
    first, second = box((1.0, 2.02, 1.0), (-0.5, -0.99, 0.5)), box((1.0, 1.0, 3.0), (-0.5, 0.5, -0.5))
    seek = Seeker(laid(first, second))
    low, held = np.array((-0.2, -0.3, -0.2)), []
    up = 5e-4
    goals = [(up, -0.3, 0.3), (up, -0.02, 0.3), (up, 0.3, 0.3), (up, 0.3, -0.1), (up, 0.3, -0.25)]
    for one, other in itertools.pairwise(np.array(goals)):
        for share in np.linspace(0.0, 1.0, 60):
            ends = np.array((low, one + share * (other - one))) - first["position"] + BASE
            way = seek(*(ends[::-1] if back else ends), 0.1 if held else WIDE)
            held.append(bool(seek.p.visit_barred[: seek.p.visits].any()))
            assert seek.lost == (0, 0)
    assert any(held)
    assert not held[-1]
    aside = np.linalg.norm(low[:2] - (-INSET, INSET)) + np.linalg.norm(goals[-1][:2] - np.array((-INSET, INSET)))
    assert way == pytest.approx(math.hypot(aside, goals[-1][2] - low[2]), abs=1e-9)


@pytest.mark.parametrize(("stands", "visits"), [(1.5e-6, 2), (1e-5, 3)])
def test_a_body_is_visited_that_stands_more_than_two_micrometres_into_the_way(stands, visits):
    seek = Seeker(towers((-0.5, 0.1, 0.4), (0.0, 0.1, 0.4 + stands), (0.5, 0.1, 0.4)))
    for y in np.linspace(1.0, 0.1, 30):
        seek(np.array((-1.1, y, 0.0)), np.array((1.1, y, 0.0)))
    assert int(seek.p.visits) == visits
    assert seek.lost == (0, 0)


@pytest.mark.parametrize(("stands", "passed"), [(5e-5, 0), (2e-4, 1)])
def test_a_body_that_can_not_be_visited_counts_where_it_is_more_than_a_tenth_of_a_millimetre_deep(stands, passed):
    """The thread has gone through as many others, elsewhere, as are kept. What is not counted is asked again."""
    seek, listed, others = Seeker(towers((0.0, 0.6, 0.5))), make_visit_list(), VISITS - 1
    seek.p.visits, seek.p.visits_passed, seek.p.visit_passed[:others] = 0, others, range(100, 100 + others)
    plainly(listed.keep.py_func)(seek.p, seek.words, near.KEPT)
    for high in (0.6, 0.5 - INSET - stands):
        seek(np.array((-1.0, high, 0.0)), np.array((1.0, high, 0.0)), 0.1)
    assert int(seek.p.visits) == 0
    assert seek.lost == (passed, 0)
    assert seek.p.visits_passed == others + passed
    assert seek.p.wrap_clear == 0.0


BOOM = {"shape": pieces.CYLINDER, "radius": 0.04, "length": 0.84, "mass": 4.0, "position": [0.0, 0.0, -0.4]}
STANDING = laid(BOOM, box((1.6, THICK, 1.0), (0.0, 0.0, 0.5)))
"""A plate whose lower edge is at z = 0, and a boom that reaches 2 cm into it and is thicker."""


ROUND_AND_BACK = [
    *((0.5, 0.041, -0.022), (-2.4, 0.041, -0.022), (-2.4, 0.041, 0.005), (-2.4, 0.032, 0.005)),
    *((-0.8, 0.032, 0.005), (-0.8, 0.041, 0.005), (-0.8, 0.041, -0.022), (0.5, 0.041, -0.022)),
]
ACROSS = [(math.atan2(-0.021, x), math.hypot(0.021, x), 0.001) for x in np.linspace(-0.045, 0.04, 30)]
ACROSS = [(*ACROSS[0][:2], -0.022), *ACROSS, (*ACROSS[-1][:2], -0.01)]
"""Ways of an end about the end of the boom: angle, distance from its axis, height above its end."""


@pytest.mark.parametrize(
    ("aside", "corners", "straight"), [((0.4, 0.27), ROUND_AND_BACK, True), ((-0.63, 0.0417), ACROSS, False)]
)
def test_a_way_over_the_covered_end_of_a_boom_goes_round_with_its_end(plain, aside, corners, straight):
    """One end goes round the boom beneath the plate, comes up onto the ledge that the boom leaves beside it, goes back
    over that, and down; or across it, and down. Its way is never longer than it was by more than the end has moved, is
    never lost, and in the end is straight as it was; of one that stays at a corner of the ledge it is none of these."""
    bench = Bench(TERMS | {"wrap": "friction"}, STANDING)
    find = make_way(bench.parts.target.shape.hulls)
    p, rows = bench.p, STANDING["target.pieces"]
    numbers = {union.PIECES: rows}
    (first, number, *_), planes = union.bodies(numbers)[0], union.planes(numbers)
    faces = planes[int(first) : int(first + number)]
    p.wrap_faces, p.wrap_planes[: len(faces)], p.wrap_covered[: len(faces)] = len(faces), faces[:, :4], faces[:, 4]
    top = rows[0][7] + 0.5 * rows[0][2]
    path = np.vstack([np.linspace(*pair, 60) for pair in itertools.pairwise(corners)])
    ends = np.column_stack([path[:, 1] * np.cos(path[:, 0]), path[:, 1] * np.sin(path[:, 0]), top + path[:, 2]])
    far, edges, bent, over = np.array((*aside, top - 0.6)), 0, 0, 0
    p.wrap_leans = 0
    way = np.linalg.norm(ends[0] - far)
    for end, before in zip(ends[1:], ends, strict=False):
        p.wrap_a[:], p.wrap_b[:] = end, far
        edges, longest = int(find(p, edges)), way + np.linalg.norm(end - before) + 1e-9
        way = p.wrap_pieces[: edges + 1, 3].sum() if edges > 0 else np.linalg.norm(end - far)
        assert p.wrap_lost == 0
        assert way < longest
        bent += edges > 0
        over += edges > 0 and len(faces) - 1 in p.wrap_chain[: edges + 1]
    assert bent > 100
    assert over > 30
    assert (edges == 0) is straight
