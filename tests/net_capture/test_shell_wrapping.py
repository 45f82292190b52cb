"""The way of a thread over the rims of a shell and over the joint with its cap, against the shortest of a graph."""

import itertools
import math

import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.sparse.csgraph import dijkstra

from fmu_src.net_capture import near
from fmu_src.net_capture.planes import P
from fmu_src.net_capture.shapes import pieces, union
from fmu_src.net_capture.shapes.hulls import INSET
from fmu_src.net_capture.visit_list import make_visit_list
from tests.net_capture.test_union_wrapping import laid
from tests.net_capture.test_visits import BASE, Seeker
from tests.plain import plainly

RADIUS, THICK, LONG = 1.3, 0.05, 4.5
WALL = {"shape": pieces.SHELL, "radius": RADIUS, "length": LONG, "thickness": THICK, "angle": math.pi, "mass": 180.0}
CAP = WALL | {"length": THICK, "thickness": 1.25, "mass": 40.0, "position": [0.0, 0.0, 2.255]}
FAIRING = laid(WALL, CAP)
"""A wall, and a cap that lies flush in it and reaches out by 3 cm."""
BENDS, AROUND = 24, 0.4
"""Places along an edge at which a way of the graph may bend, and how far from a thread's middle edges count [m]."""
CUTS, HIDDEN = 2e-6, 1e-7
"""Metres deeper than ways lie at which a straight way cuts a body, and at which an edge lies in another."""


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

    def bends(self):
        """Places where the way bends now, ends included, body axes [m] (n, 3)."""
        edges = sum(self.p.visit_edges[: self.p.visits])
        return np.array(self.p.wrap_bends[: edges + 2])


def bodies_and_faces():
    """Faces of every body (n, 4), as deep as ways lie; body axes."""
    numbers = {union.PIECES: FAIRING["target.pieces"]}
    planes = union.planes(numbers)
    found = []
    for first, count, *_ in union.bodies(numbers):
        faces = planes[int(first) : int(first + count), :4].copy()
        faces[:, 3] -= INSET
        found.append(faces)
    return found


def inside(bodies, starts, ends, deeper):
    """How far straight ways (n, 3) run in the bodies, at most [m] (n,)."""
    way = ends - starts
    longest = np.zeros(len(way))
    for faces in bodies:
        rises, below = way @ faces[:, :3].T, faces[:, 3] - deeper - starts @ faces[:, :3].T
        with np.errstate(divide="ignore", invalid="ignore"):
            at = below / rises
        enters = np.where(rises < 0.0, at, -np.inf).max(axis=1).clip(min=0.0)
        leaves = np.where(rises > 0.0, at, np.inf).min(axis=1).clip(max=1.0)
        off = ((rises == 0.0) & (below < 0.0)).any(axis=1)
        within = np.where(off, 0.0, (leaves - enters).clip(min=0.0)) * np.linalg.norm(way, axis=1)
        longest = np.maximum(longest, within)
    return longest


def edges_near(bodies, middle):
    """Edges in the open near a place: a point on each, its direction, and from where to where it goes [m]."""
    found = []
    for number, faces in enumerate(bodies):
        for one, other in itertools.combinations(faces, 2):
            along = np.cross(one[:3], other[:3])
            if np.linalg.norm(along) < 1e-4:
                continue
            along /= np.linalg.norm(along)
            foot = np.linalg.solve(np.array([one[:3], other[:3], along]), [one[3], other[3], along @ middle])
            rises, below = faces[:, :3] @ along, faces[:, 3] - faces[:, :3] @ foot
            if (below[np.abs(rises) < 1e-9] < -1e-9).any():
                continue
            down, up = rises < -1e-9, rises > 1e-9
            low = max([-AROUND, *(below[down] / rises[down])])
            high = min([AROUND, *(below[up] / rises[up])])
            if low >= high or np.linalg.norm(foot - middle) > AROUND:
                continue
            points = foot + np.linspace(low, high, BENDS)[:, None] * along
            others = [b for n, b in enumerate(bodies) if n != number]
            out = [all((b[:, :3] @ x - b[:, 3]).max() > -HIDDEN for b in others) for x in points[1:-1]]
            if any(out):
                found.append((foot, along, low, high))
    return found


def shortest(bodies, a, b):
    """The shortest way from a to b that runs in no body [m]: that of a graph of places on all edges near, by Dijkstra,
    then over its edges that with the least sum of lengths."""
    edges = edges_near(bodies, 0.5 * (a + b))
    owner = np.repeat(np.arange(len(edges)), BENDS)
    taus = np.concatenate([np.linspace(low, high, BENDS) for _, _, low, high in edges])
    places = np.vstack([a, b, [edges[e][0] + tau * edges[e][1] for e, tau in zip(owner, taus, strict=True)]])
    first, second = np.triu_indices(len(places), 1)
    free = inside(bodies, places[first], places[second], CUTS) < 1e-4
    weights = np.zeros((len(places), len(places)))
    weights[first[free], second[free]] = np.linalg.norm(places[first[free]] - places[second[free]], axis=1) + 1e-12
    _, before = dijkstra(weights, directed=False, indices=0, return_predecessors=True)
    chain, at = [], before[1]
    while at != 0:
        chain.append(at - 2)
        at = before[at]
    chain = chain[::-1]

    def way(shares, over):
        inner = [edges[owner[n]][0] + tau * edges[owner[n]][1] for n, tau in zip(over, shares, strict=True)]
        return float(np.linalg.norm(np.diff(np.vstack([a, *inner, b]), axis=0), axis=1).sum())

    def least(over):
        limits = [edges[owner[n]][2:] for n in over]
        found = minimize(way, taus[over], (over,), "L-BFGS-B", bounds=limits, options={"ftol": 1e-15, "gtol": 1e-9})
        return found.fun

    best = least(chain)
    places_of = np.vstack([a, places[2:][chain], b])
    for n in range(len(chain)):  # a bend between two that see each other is none
        if inside(bodies, places_of[n : n + 1], places_of[n + 2 : n + 3], CUTS)[0] < 1e-4 and len(chain) > 1:
            best = min(best, least(chain[:n] + chain[n + 1 :]))
    return best


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


LOW, HIGH = -0.5 * LONG, 2.28
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
    seek, bodies = Drawn(FAIRING), bodies_and_faces()
    for start, end in itertools.pairwise(ends):
        ways = seek.drawn((start, end), 24, 0.02)
        bends = seek.bends()
        assert len(bends) > 2
        assert inside(bodies, bends[:-1], bends[1:], CUTS).max() < 1e-3
        assert seek.lost == (0, 0)
        assert seek.p.visits_passed == 0
        assert ways[-1] == pytest.approx(shortest(bodies, bends[0], bends[-1]), abs=1e-9)


def test_an_end_that_comes_up_past_the_open_end_meets_the_body_that_is_there():
    """The thread lies over an outer edge of one body, beyond that one's inner edge: another's is in its way."""
    seek, bodies, listed = Drawn(FAIRING), bodies_and_faces(), make_visit_list()
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
