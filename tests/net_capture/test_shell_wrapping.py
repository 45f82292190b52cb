"""The way of a thread over the rims of a shell and over the joint with its cap, against the shortest of a graph."""

import itertools
import math

import numpy as np
import pytest

from fmu_src.net_capture import near
from fmu_src.net_capture.planes import P
from fmu_src.net_capture.shapes import pieces, union
from fmu_src.net_capture.shapes.hulls import INSET
from fmu_src.net_capture.visit_list import make_visit_list
from tests.net_capture.test_union_wrapping import box, laid
from tests.net_capture.test_visits import BASE, BOOM, Seeker
from tests.net_capture.ways_in_the_open import (
    HIDDEN,
    bodies_and_faces,
    edges_near,
    followed,
    inside,
    length,
    shortest,
    slid,
)
from tests.plain import plainly

RADIUS, THICK, LONG = 1.3, 0.05, 4.5
WALL = {"shape": pieces.SHELL, "radius": RADIUS, "length": LONG, "thickness": THICK, "angle": math.pi, "mass": 180.0}
CAP = WALL | {"length": THICK, "thickness": 1.25, "mass": 40.0, "position": [0.0, 0.0, 2.255]}
FAIRING = laid(WALL, CAP)
"""A wall, and a cap that lies flush in it and reaches out by 3 cm."""


class Drawn(Seeker):
    """A thread whose ends are drawn along, at the speeds that go with it; in design axes."""

    def drawn(self, ends, steps, length):
        """From ends to others (n, 2, 3) in so many steps each; the lengths of all its ways [m]."""
        found = []
        before = np.array(ends[0])
        for start, end in itertools.pairwise(np.array(ends)):
            for share in np.linspace(0.0, 1.0, steps + 1)[1:]:
                now = start + share * (end - start)
                self.planes[P : P + 3, :2] = self.turn @ (now - before).T / self.p.solver_substep
                found.append(self(*(now + BASE), length=length))
                before = now
        return np.array(found)

    def lies(self, visits, way):
        """Let it lie as by a list of visits (body, faces, first bend, last bend), over that length [m]."""
        p, listed = self.p, make_visit_list()
        p.visits, p.visits_passed = len(visits), 0
        for v, (body, faces, first, last) in enumerate(visits):
            p.visit_body[v], p.visit_edges[v] = body, len(faces) - 1
            p.visit_chain[v, : len(faces)] = faces
            p.visit_ends[v] = self.body_axes(np.array((first, last)) + BASE).ravel()
        plainly(listed.keep.py_func)(p, self.words, near.KEPT)
        self.words[near.STATE], self.words[near.WAY] = near.BENT, round(way / near.FINE)

    def bends(self):
        """Places where the way bends now, ends included, body axes [m] (n, 3)."""
        edges = sum(self.p.visit_edges[: self.p.visits])
        return np.array(self.p.wrap_bends[: edges + 2])

    def body_axes(self, points):
        """Of places in design axes (n, 3) [m]."""
        return self.place + (np.array(points) - BASE) @ self.turn.T


SHELLS = {
    "cap": CAP | {"position": [0.0, 0.0, 0.0]},
    "thin": WALL | {"thickness": 0.01, "angle": 1.5},
    "thick": WALL | {"thickness": 0.5, "angle": 4.0},
    "tube": WALL | {"angle": 2.0 * math.pi},
    "nearly solid": WALL | {"thickness": 1.29, "angle": 2.5},
}


@pytest.mark.parametrize("shell", SHELLS.values(), ids=SHELLS)
def test_bodies_of_a_shell_lie_in_it_and_fill_it(shell):
    """But for what a chord and a tangent lie within it."""
    row = laid(shell)["target.pieces"]
    numbers, draw = {union.PIECES: row}, np.random.default_rng(4)
    planes = union.planes(numbers)
    bodies = [planes[int(first) : int(first + count)] for first, count, *_ in union.bodies(numbers)]

    def body_axes(points):
        return row[0, 5:8] + points @ row[0, 8:17].reshape(3, 3).T

    assert not np.vstack(bodies)[:, 4].any(), "none is covered"
    radius, length, thickness, angle = (shell[of] for of in ("radius", "length", "thickness", "angle"))
    within = min(0.2 * thickness, 0.009 * radius)
    away = np.sqrt(draw.uniform((radius - thickness) ** 2, radius**2, 20000))
    turn, height = draw.uniform(-0.5 * angle, 0.5 * angle, 20000), draw.uniform(-0.5 * length, 0.5 * length, 20000)
    points = np.column_stack([away * np.cos(turn), away * np.sin(turn), height])
    held = np.zeros(len(points), bool)
    for faces in bodies:
        held |= (body_axes(points) @ faces[:, :3].T <= faces[:, 3] + 1e-9).all(axis=1)
    deep = (away < radius - within) & (away > radius - thickness + within)
    assert held[deep].all()
    around = np.column_stack([draw.uniform(-1.1, 1.1, (20000, 2)) * radius, draw.uniform(-0.6, 0.6, 20000) * length])
    far, beside = np.hypot(around[:, 0], around[:, 1]), np.abs(np.arctan2(around[:, 1], around[:, 0])) > 0.5 * angle
    out = (far > radius) | (far < radius - thickness) | beside | (np.abs(around[:, 2]) > 0.5 * length)
    for faces in bodies:
        inner = (body_axes(around) @ faces[:, :3].T <= faces[:, 3] - 1e-9).all(axis=1)
        assert not (inner & out).any()


def turned(angle, away, height):
    """A place by its angle about the shell's axis, its distance from that, and along it."""
    return np.array([away * math.cos(angle), away * math.sin(angle), height])


LOW, HIGH, STEPS = -0.5 * LONG, 2.28, 60
DRAWN = {
    "over the open end": (
        (turned(0.1, 1.35, LOW - 0.05), turned(0.15, 1.2, LOW - 0.05)),
        (turned(0.05, 1.31, LOW + 0.1), turned(0.25, 1.22, LOW + 0.15)),
        (turned(0.35, 1.305, LOW + 0.2), turned(0.1, 1.24, LOW + 0.05)),
    ),
    "over an end of the angle": (
        (np.array([-0.05, 1.35, 0.1]), np.array([-0.05, 1.2, 0.2])),
        (turned(1.48, 1.31, 0.3), turned(1.45, 1.23, 0.1)),
        (turned(1.3, 1.31, 0.0), turned(1.4, 1.2, 0.25)),
    ),
    "over cap and wall": (
        (turned(0.2, 1.35, 2.4), turned(0.25, 1.35, 2.1)),
        (turned(0.1, 1.2, 2.32), turned(0.3, 1.305, 2.0)),
        (turned(0.35, 1.1, 2.4), turned(0.15, 1.305, 2.1)),
    ),
    "over the cap's straight rim": (
        (np.array([-0.05, 0.3, 2.4]), np.array([-0.05, 0.35, 2.1])),
        (np.array([0.1, 0.2, 2.35]), np.array([0.15, 0.45, 2.1])),
        (np.array([0.2, 0.5, 2.32]), np.array([0.15, 0.3, 2.15])),
    ),
    "over the corner of cap and wall": (
        (np.array([-0.05, 1.2, 2.35]), np.array([-0.05, 1.15, 2.1])),
        (np.array([0.1, 1.15, 2.35]), np.array([0.1, 1.2, 2.1])),
        (np.array([0.05, 1.22, 2.31]), np.array([0.1, 1.22, 2.05])),
    ),
    "round the wall from chord to chord": (
        (turned(-0.25, 1.4, 2.15), turned(0.25, 1.4, 2.2)),
        (turned(-0.25, 1.305, 2.2), turned(0.3, 1.305, 2.1)),
    ),
}


@pytest.mark.parametrize("ends", DRAWN.values(), ids=DRAWN)
def test_a_thread_drawn_over_a_rim_takes_the_shortest_way(ends):
    """It is let down on it, and its ends are drawn on, aslant and across joints of the bodies; it is taut, so that what
    is not gone round is told."""
    seek, bodies = Drawn(FAIRING), bodies_and_faces(FAIRING)
    for start, end in itertools.pairwise(ends):
        ways = seek.drawn((start, end), 24, 0.02)
        bends = seek.bends()
        assert len(bends) > 2
        assert inside(bodies, bends[:-1], bends[1:]).max() < 1e-3
        assert seek.lost == (0, 0)
        assert seek.p.visits_passed == 0
        assert ways[-1] == pytest.approx(shortest(bodies, bends[0], bends[-1]), abs=1e-9)


ON_A_SIDE = {
    "past a corner of the rim": (
        (turned(-0.25, 1.4, 2.15), turned(0.25, 1.4, 2.2)),
        (turned(-0.25, 1.305, 2.2), turned(0.3, 1.305, 2.1)),
        (turned(-0.3, 1.305, 2.3), turned(0.25, 1.305, 2.1)),
        (turned(-0.3, 1.25, 2.35), turned(0.2, 1.302, 2.1)),
    ),
    "held between cap and wall": (
        (turned(1.5, 1.4, 2.4), np.array([-0.05, 1.35, 2.15])),
        (turned(1.5, 1.4, 2.4), np.array([-0.05, 1.2, 2.15])),
        (turned(1.45, 1.27, 2.35), turned(1.45, 1.2, 2.1)),
        (turned(1.42, 1.25, 2.33), turned(1.4, 1.1, 2.15)),
    ),
    "past the end of the wall's edge": (
        (np.array([-0.13, 1.301, 2.211]), np.array([-0.038, 1.378, 2.402])),
        (np.array([-0.03, 1.201, 2.111]), np.array([0.062, 1.278, 2.302])),
        (np.array([-0.037, 1.199, 2.204]), np.array([0.027, 1.109, 2.309])),
    ),
    "into the cap's notch": (
        (np.array([-0.05, 0.3, 2.4]), np.array([-0.05, 0.35, 2.1])),
        (np.array([0.1, 0.2, 2.35]), np.array([0.15, 0.45, 2.1])),
        (np.array([0.2, 0.02, 2.32]), np.array([0.15, -0.1, 2.15])),
    ),
}
"""Ends as in `DRAWN`; the shortest way of all is on another side in the end, or nearly there."""


@pytest.mark.parametrize("ends", ON_A_SIDE.values(), ids=ON_A_SIDE)
def test_a_thread_keeps_the_side_on_which_it_came_to_lie(ends):
    """Its way is that to which one slides, by a graph beside it and scipy alone, as the ends are drawn along; and
    none beside it is shorter. Where edges run into another body, and hold it, is known to 0.2 micrometres."""
    seek, bodies = Drawn(FAIRING), bodies_and_faces(FAIRING)
    way = seek.body_axes(np.array(ends[0]) + BASE)
    assert inside(bodies, way[:1], way[1:]) == 0.0
    for start, end in itertools.pairwise(ends):
        ways = seek.drawn((start, end), STEPS, 0.02)
        bends = seek.bends()
        way = followed(bodies, way, seek.body_axes(np.array(end) + BASE), STEPS)
        assert seek.lost == (0, 0)
        assert seek.p.visits_passed == 0
        assert inside(bodies, bends[:-1], bends[1:]).max() < 1e-3
        known = 1e-9 + HIDDEN * sum(held > 0 for held in seek.p.visit_barred[: seek.p.visits])
        assert ways[-1] == pytest.approx(length(way), abs=known)
        beside = slid(bodies, edges_near(bodies, 0.5 * (bends[0] + bends[-1])), bends)
        assert ways[-1] == pytest.approx(length(beside), abs=known)


def at(degrees, away, height):
    return turned(math.radians(degrees), away, height)


def bent(body, faces, place):
    """A visit over one edge, see `Drawn.lies`."""
    return body, faces, place, place


OVER_CORNERS = {
    "of one body": (
        [bent(4, (4, 1), at(-22.0, 1.2955, 2.278)), bent(4, (1, 2), at(-20.771, 1.298, 2.25))],
        ((0.55, -0.5, 2.28), at(-13.91, 1.3, 1.95)),
        ((0.5, -0.35, 2.28), at(-13.91, 1.3, 2.05)),
    ),
    "of two bodies": (
        [bent(9, (4, 1), at(45.23, 1.2912, 2.278)), bent(10, (0, 1), at(48.46, 1.298, 2.2146))],
        (at(30.93, 1.0656, 2.2845), at(60.91, 1.3039, 1.9707)),
        (at(45.6, 1.2218, 2.279), at(61.25, 1.33, 2.02)),
    ),
}


@pytest.mark.parametrize(("visits", "before", "after"), OVER_CORNERS.values(), ids=OVER_CORNERS)
def test_a_way_that_slides_over_the_corner_between_two_visits_is_not_lost(visits, before, after):
    """It becomes shorter at once, as it does over a corner of one visit; it has gone through nothing."""
    seek, bodies = Drawn(FAIRING), bodies_and_faces(FAIRING)
    seek.lies(visits, 0.8)
    seek(*(np.array(end) + BASE for end in before), length=1.0)
    seek.p.wrap_passed_slack = 0
    ways = seek.drawn((before, after), 100, 1.0)
    bends = seek.bends()
    assert np.diff(ways).min() < -1e-3
    assert seek.p.visits == 1
    assert inside(bodies, bends[:-1], bends[1:]).max() < 1e-3
    beside = slid(bodies, edges_near(bodies, 0.5 * (bends[0] + bends[-1])), bends)
    assert ways[-1] == pytest.approx(length(beside), abs=1e-9)
    assert seek.lost == (0, 0)


def test_a_way_held_at_the_end_of_an_edge_goes_over_to_no_body_through_others():
    """It comes from beneath the cap round its straight rim to above it; over that of another body at the same place it
    would be shorter, through the cap."""
    seek, bodies = Drawn(FAIRING), bodies_and_faces(FAIRING)
    low, high = at(-89.91, 1.261, 2.232), at(-89.91, 1.2923, 2.278)
    seek.lies([bent(0, (2, 3), low), bent(0, (3, 4), high)], 0.99502)
    way = seek(np.array((0.83583, -0.84831, 2.2297)) + BASE, at(-89.8722, 1.2974, 2.2854) + BASE, length=1.0)
    bends = seek.bends()
    assert way == pytest.approx(0.99502, abs=1e-4)
    assert inside(bodies, bends[:-1], bends[1:]).max() < 1e-3


def test_round_one_body_more_a_way_is_no_shorter():
    """It comes down past the cap's straight rim, and then bends there too: the wall, which it then runs into first,
    would have it leave the rim over which it lies, and be shorter on another side."""
    seek, bodies, rim = Drawn(FAIRING), bodies_and_faces(FAIRING), at(59.09, 1.2912, 2.278)
    ends = np.array((at(98.88, 0.7762, 2.2781), at(55.67, 1.3063, 2.1554)))
    seek.lies([bent(11, (4, 0), rim)], 1.0)
    ways = seek.drawn((ends, ends - [[0.0, 0.0, 4e-4], [0.0, 0.0, 0.0]]), 4, 0.9)
    bends = seek.bends()
    assert seek.lost == (0, 0)
    assert np.ptp(ways) < 1e-5
    assert len(bends) == 4
    assert inside(bodies, bends[:-1], bends[1:]).max() < 1e-3


@pytest.mark.parametrize(
    ("fallen", "length", "counted"), [(0.0, 1.5, (0, 0)), (0.0, 0.5, (0, 0)), (0.01, 1.5, (0, 1)), (0.01, 0.5, (1, 0))]
)
def test_a_thread_that_is_lost_is_counted_where_it_becomes_shorter(fallen, length, counted):
    """An edge that it can not go on over, since one end does not see its face: it is sought anew, and is as long as it
    was, or shorter by a centimetre; it is slack, or taut."""
    seek = Drawn(laid(box((1.6, 1.8, 2.0)), box((0.1, 0.1, 0.1), (0.0, 0.0, 1.04))))
    a, b = np.array((-0.798 + 1e-9, -0.9118, -0.7548)) + BASE, np.array((-0.798, 0.0512, -0.9981)) + BASE
    lost = [bent(0, (1, 5), np.array((-0.798, 0.0433, -0.998)))]
    seek.lies(lost, 1.0)
    way = seek(a, b, length=1.5)
    seek.p.wrap_passed = seek.p.wrap_passed_slack = 0
    seek.lies(lost, way + fallen)
    assert seek(a, b, length=length) == pytest.approx(way, abs=1e-12)
    assert seek.p.visits_lost == 1
    assert seek.lost == counted


def test_a_way_whose_bend_lies_as_deep_in_a_plate_as_ways_do_goes_round_that():
    """It has slid over a corner of the boom, past the ledge beside the plate's edge, and is held where its edge runs
    into that: as deep in the plate as ways lie, so whether that is in or out is rounding."""
    tables = laid(BOOM, box((1.6, 0.04, 1.0), (0.1, 0.0, 0.5)))
    seek, up, bodies = Drawn(tables), np.array(BOOM["position"]), bodies_and_faces(tables)
    first, last = np.array((-0.0145, 0.035, 0.018)) - up, np.array((-0.035, -0.0145, -0.0314)) - up
    b = np.array((0.0224, -0.1146, -0.1296)) - up + BASE
    others = 0
    for high in np.linspace(0.477, 0.51, 30):
        seek.lies([(0, (2, 3, 4, 5), first, last)], 0.93)
        seek(np.array((0.4914, 0.2077, high)) - up + BASE, b, length=0.9)
        bends = seek.bends()
        assert seek.lost == (0, 0)
        assert inside(bodies, bends[:-1], bends[1:]).max() < 1e-3
        others += 1 in seek.p.visit_body[: seek.p.visits]
    assert others == 30


def test_an_end_that_comes_up_past_the_open_end_meets_the_body_that_is_there():
    """The thread lies over an outer edge of one body, beyond that one's inner edge: another's is in its way."""
    seek, bodies, listed = Drawn(FAIRING), bodies_and_faces(FAIRING), make_visit_list()
    p, a = seek.p, turned(-0.2985, 1.3367, LOW + 0.0966)
    p.visits, p.visits_passed, p.visit_body[0], p.visit_edges[0] = 1, 0, 5, 1
    p.visit_chain[0, :2] = 0, 5
    p.visit_ends[0, :3] = p.visit_ends[0, 3:] = seek.place + seek.turn @ turned(-0.454, 1.2891, LOW + INSET)
    plainly(listed.keep.py_func)(p, seek.words, near.KEPT)
    seek.words[near.STATE], seek.words[near.WAY] = near.BENT, round(0.5 / near.FINE)
    ends = [(a, turned(-0.6576, 1.1915, LOW + INSET + up)) for up in (-1e-4, -1e-6, 3e-6, 0.03)]
    ways = seek.drawn(ends, 60, 0.02)
    bends = seek.bends()
    assert seek.lost == (0, 0)
    assert len(bends) == 4
    assert np.abs(np.diff(ways)).max() < 0.03 / 60
    assert ways[-1] == pytest.approx(shortest(bodies, bends[0], bends[-1]), abs=1e-9)
