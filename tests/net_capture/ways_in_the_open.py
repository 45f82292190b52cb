"""Ways of a thread over the edges of convex bodies, by graphs of places on all edges and by scipy alone."""

import itertools

import numpy as np
from scipy.optimize import minimize
from scipy.sparse.csgraph import dijkstra

from fmu_src.net_capture.shapes import union
from fmu_src.net_capture.shapes.hulls import INSET

AROUND, BENDS = 0.4, 24
"""How far from a thread's middle edges count [m], and places along an edge at which a way may bend."""
CUTS, HIDDEN, SHORT, PAST = 2e-6, 2e-7, 1e-4, 1e-4
"""Metres deeper than ways lie at which a straight way cuts a body, and at which an edge lies in another; how far a way
may run in a body so; and about how far beyond an edge it is looked whether another body goes on there."""
TUBE, PLACES, DENSE = 4e-3, 7, 1e-3
"""Around a way in which another is sought that it may slide to [m], places on an edge there, and how far apart at most
[m]."""


def bodies_and_faces(tables):
    """Faces of every body (n, 4), as deep as ways lie; body axes."""
    numbers = {union.PIECES: tables["target.pieces"]}
    planes = union.planes(numbers)
    found = []
    for first, count, *_ in union.bodies(numbers):
        faces = planes[int(first) : int(first + count), :4].copy()
        faces[:, 3] -= INSET
        found.append(faces)
    return found


def inside(bodies, starts, ends, deeper=CUTS):
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


def within(faces, foot, along, deeper):
    """From where to where a line lies in a body, or in its faces [m]; None: it does not."""
    rises, below = faces[:, :3] @ along, faces[:, 3] - faces[:, :3] @ foot
    level, down, up = np.abs(rises) < 1e-9, rises < -1e-9, rises > 1e-9
    if (below[level] < -HIDDEN).any():
        return None
    at = (below - deeper) / np.where(level, np.nan, rises)
    low, high = max([-AROUND, *at[down]]), min([AROUND, *at[up]])
    return (low, high) if low < high else None


def held(bodies, place):
    """Whether a place lies in one of the bodies, or on it."""
    return any((faces[:, :3] @ place - faces[:, 3]).max() < HIDDEN for faces in bodies)


def in_the_open(others, foot, along, span, beyond):
    """Parts of an edge that stand out of all other bodies: what lies in one is none, nor what goes on flush in one.

    beyond    directions in both faces out over the edge
    """
    cuts = [within(body, foot, along, HIDDEN) for body in others]
    at = np.unique([*span, *(tau for cut in cuts if cut is not None for tau in cut if span[0] < tau < span[1])])
    parts = []
    for low, high in itertools.pairwise(at):
        middle = foot + 0.5 * (low + high) * along
        if high - low < 1e-6 or any(held(others, middle + PAST * way) for way in beyond):
            continue
        if parts and parts[-1][1] > low - 1e-6:
            parts[-1] = (parts[-1][0], high)
        else:
            parts.append((low, high))
    return parts


def edges_near(bodies, middle):
    """Parts of edges in the open near a place: a point on each, its direction, and from where to where it goes [m]."""
    found = []
    for number, faces in enumerate(bodies):
        others = bodies[:number] + bodies[number + 1 :]
        for one, other in itertools.combinations(faces, 2):
            along = np.cross(one[:3], other[:3])
            if np.linalg.norm(along) < 1e-4:
                continue
            along /= np.linalg.norm(along)
            foot = np.linalg.solve(np.array([one[:3], other[:3], along]), [one[3], other[3], along @ middle])
            span = within(faces, foot, along, 0.0)
            if span is None or np.linalg.norm(foot - middle) > AROUND:
                continue
            turn = one[:3] @ other[:3]
            beyond = (other[:3] - turn * one[:3], one[:3] - turn * other[:3])
            for part in in_the_open(others, foot, along, span, beyond):
                alike = (np.abs(np.subtract(foot, e[0])).max() + np.abs(np.subtract(part, e[2:])).max() for e in found)
                if not any(off < 1e-9 for off in alike):
                    found.append((foot, along, *part))
    return found


def points(edges, owner, taus):
    """Places on edges (n, 3)."""
    return np.array([edges[e][0] + tau * edges[e][1] for e, tau in zip(owner, taus, strict=True)]).reshape(-1, 3)


def along_a_graph(bodies, edges, ends, owner, taus):
    """Which of these places on edges the shortest way between two ends bends at that runs in no body."""
    places = np.vstack([ends, points(edges, owner, taus)])
    near = [faces for faces in bodies if (places @ faces[:, :3].T - faces[:, 3]).min(axis=0).max() < 0.0]
    first, second = np.triu_indices(len(places), 1)
    free = inside(near, places[first], places[second]) < SHORT
    weights = np.zeros((len(places), len(places)))
    weights[first[free], second[free]] = np.linalg.norm(places[first[free]] - places[second[free]], axis=1) + 1e-12
    _, before = dijkstra(weights, directed=False, indices=0, return_predecessors=True)
    chain, at = [], before[1]
    while at != 0:
        assert at > 0, "there is a way"
        chain.append(int(at) - 2)
        at = before[at]
    return chain[::-1]


def settled(bodies, edges, ends, owner, taus):
    """A way over these edges, in this order, made the shortest by scipy (n, 3); a bend between two places that see each
    other is none."""

    def way(shares, over):
        bent = np.vstack([ends[0], points(edges, over, shares), ends[1]])
        return float(np.linalg.norm(np.diff(bent, axis=0), axis=1).sum())

    def least(over, start):
        limits = [edges[e][2:] for e in over]
        found = minimize(way, start, (over,), "L-BFGS-B", bounds=limits, options={"ftol": 1e-15, "gtol": 1e-9})
        return found.fun, np.vstack([ends[0], points(edges, over, found.x), ends[1]])

    best = least(owner, taus)
    bent = np.vstack([ends[0], points(edges, owner, taus), ends[1]])
    for n in range(len(owner)):
        if len(owner) > 1 and inside(bodies, bent[n : n + 1], bent[n + 2 : n + 3])[0] < SHORT:
            found = least(np.delete(owner, n), np.delete(taus, n))
            if found[0] < best[0] and inside(bodies, found[1][:-1], found[1][1:]).max() < SHORT:
                best = found
    return best[1]


def length(way):
    """Of a way (n, 3) [m]."""
    return float(np.linalg.norm(np.diff(way, axis=0), axis=1).sum())


def off(way, places):
    """How far places (n, 3) are from a way [m] (n,)."""
    least = np.full(len(places), np.inf)
    for start, end in itertools.pairwise(way):
        line = end - start
        share = ((places - start) @ line / max(line @ line, 1e-30)).clip(0.0, 1.0)
        least = np.minimum(least, np.linalg.norm(places - start - share[:, None] * line, axis=1))
    return least


def beside(bodies, edges, way, tube):
    """The shortest way (n, 3) between the ends of one that bends within so much of it [m]."""
    owner, taus = [], []
    for number, (foot, along, low, high) in enumerate(edges):
        line = np.linspace(low, high, 2 + int((high - low) / (0.25 * tube)))
        places = np.flatnonzero(off(way, foot + line[:, None] * along) < tube)
        for run in np.split(places, np.flatnonzero(np.diff(places) > 1) + 1) if len(places) else ():
            there = np.linspace(line[run[0]], line[run[-1]], max(PLACES, int((line[run[-1]] - line[run[0]]) / DENSE)))
            taus.extend(there)
            owner.extend([number] * len(there))
    owner, taus = np.array(owner, int), np.array(taus)
    ends = way[[0, -1]]
    chain = along_a_graph(bodies, edges, ends, owner, taus)
    return settled(bodies, edges, ends, owner[chain], taus[chain]) if chain else ends


def slid(bodies, edges, way):
    """A way (n, 3) that has slid, a little and a little, to where none beside it is shorter."""
    before = np.inf
    for _ in range(100):
        way = beside(bodies, edges, way, TUBE)
        if length(way) > before - 1e-10:
            break
        before = length(way)
    return way


def followed(bodies, way, ends, steps):
    """How a way (n, 3) slides as its ends go from where they are to others (2, 3) in so many steps."""
    start = way[[0, -1]]
    edges = edges_near(bodies, 0.25 * (start + ends).sum(axis=0))
    for share in np.linspace(0.0, 1.0, steps + 1)[1:]:
        now = start + share * (ends - start)
        way = slid(bodies, edges, np.vstack([now[0], way[1:-1], now[1]]))
    return way


def shortest(bodies, a, b):
    """The shortest way of all from a to b that runs in no body [m]."""
    edges = edges_near(bodies, 0.5 * (a + b))
    owner = np.repeat(np.arange(len(edges)), BENDS)
    taus = np.concatenate([np.linspace(low, high, BENDS) for _, _, low, high in edges])
    chain = along_a_graph(bodies, edges, (a, b), owner, taus)
    return length(slid(bodies, edges, settled(bodies, edges, (a, b), owner[chain], taus[chain])))
