"""Nets whose threads touch each other: two crossed threads, a tangle, and what numpy finds of all their pairs."""

import numpy as np

from fmu_src.instance import Instance
from fmu_src.net_capture.interface import MODEL
from fmu_src.net_capture.planes import FX, P, U, X
from tests.conftest import FREE
from tests.net_capture.memory import graph, nodes, planes

TOUCHING = FREE | {"knots": "plain", "self_contact": "plain"}
"""One choice of terms, and so one build, for all tests of it."""
THICKNESS = 1e-3
LIGHT = {"bullets.mass": 1e-9, "vertex.mass": 0.0, "bullets.speed": 0.0}
"""Without a shot."""
PAIR = LIGHT | {
    "net.side": 2.0,
    "net.mesh": 1.0,
    "net.mass": 1.2e-6,
    "knots.mass": 0.01,
    "net.youngs_modulus": 1e6,
    "net.fold_side": 0.5,
    "self_contact.thickness": THICKNESS,
    "self_contact.duration": 1e-3,
}
"""Nine knots of 10 g each."""
ONE, OTHER = (0, 1), (7, 8)
"""Nodes of the two that cross."""
ASIDE = {2: (0.3, 0.5, 0.6), 3: (-0.1, -0.4, 0.5), 4: (0.05, 0.2, 0.62), 5: (0.4, 0.15, 0.55), 6: (-0.33, -0.2, 0.58)}
SPAN = 0.8
"""Way between the ends of a slack thread of 1 m."""


def put(net, places, speeds):
    """Put all nodes (n, 3) there, at these velocities half a substep ago; the list of pairs is made anew before it is
    used, and the energy book begins a substep later."""
    memory, slots = planes(net), nodes(net)
    memory[X : X + 3, slots] = places.T
    for first in (U, P):
        memory[first : first + 3, slots] = speeds.T
    memory[FX : FX + 3] = 0.0
    if "self_contact" in net.interface.terms:
        net.record["self_contact_way"] = 2.0
        net.record["self_contact_gone"] = -1
    net.step(net["solver.substep"])
    net.record["energy_start"] -= net["energy.remainder"]
    net.step(0.0)


def crossed(speed, height, shares=(0.5, 0.5), **changes):
    """Two threads at right angles, slack, one of which falls on the other from a height [m] between their middles, at a
    speed [m/s]; `shares` say where they cross, and all other knots rest aside."""
    net = Instance(MODEL, TOUCHING, PAIR | changes).initialise()
    places, speeds = np.zeros((2, 9, 3))
    for node, place in ASIDE.items():
        places[node] = place
    s, t = shares
    places[ONE, 0] = -s * SPAN, (1.0 - s) * SPAN
    places[ONE, 2] = height
    places[OTHER, 1] = -t * SPAN, (1.0 - t) * SPAN
    speeds[ONE, 2] = -speed
    put(net, places, speeds)
    return net


def tangle(seed, parameters, terms=TOUCHING, speed=1.0, size=0.5):
    """A net whose nodes lie anywhere in a ball-like heap of a size [m], each with a velocity of its own [m/s]."""
    net = Instance(MODEL, terms, LIGHT | parameters).initialise()
    rng = np.random.default_rng(seed)
    count = len(nodes(net))
    put(net, size * rng.normal(size=(count, 3)), speed * rng.normal(size=(count, 3)))
    return net


class Pairs:
    """All pairs of a net's threads that share no node; nodes by the order of the outputs."""

    def __init__(self, net):
        slots = nodes(net)
        number = np.full(slots[-1] + 1, -1)
        number[slots] = np.arange(len(slots))
        ends = number[graph(net).ends]
        i, j = np.triu_indices(len(ends), 1)
        apart = ~(ends[i][:, :, None] == ends[j][:, None, :]).any(axis=(1, 2))
        self.one, self.other = ends[i[apart]], ends[j[apart]]

    def shapes(self, places):
        """Spans of both threads and the way between their first ends, (3, n, 3)."""
        a, b = places[self.one[:, 0]], places[self.one[:, 1]]
        c, d = places[self.other[:, 0]], places[self.other[:, 1]]
        return np.stack([b - a, d - c, a - c])

    def gaps(self, places):
        """Distance of every pair [m]: the least over the whole lines' closest points, if inside, and over all four ends
        against the other thread."""
        u, v, w = self.shapes(places)
        with np.errstate(divide="ignore", invalid="ignore"):
            found = []
            for start, span in ((w, v), (w + u, v), (-w, u), (v - w, u)):
                share = np.clip(np.sum(start * span, axis=1) / np.sum(span * span, axis=1), 0.0, 1.0)
                found.append(np.linalg.norm(start - share[:, None] * span, axis=1))
            least = np.min(found, axis=0)
            normal = np.cross(u, v)
            size = np.sum(normal * normal, axis=1)
            s = np.sum(np.cross(v, w) * normal, axis=1) / size
            t = np.sum(np.cross(u, w) * normal, axis=1) / size
            inside = (size > 0.0) & (s > 0.0) & (s < 1.0) & (t > 0.0) & (t < 1.0)
            across = np.abs(np.sum(w * normal, axis=1)) / np.sqrt(size)
            return np.where(inside, np.minimum(across, least), least)

    def passes(self, before, now):
        """How many pairs met as all nodes went straight on: at roots of their volume's cubic."""
        first, last = self.shapes(before), self.shapes(now)

        def volume(time):
            u, v, w = (1.0 - time) * first + time * last
            return np.sum(w * np.cross(u, v), axis=1)

        times = np.array([0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0])
        cubics = np.linalg.solve(np.vander(times), np.array([volume(time) for time in times]))
        turned = np.flatnonzero(np.sign(volume(0.0)) != np.sign(volume(1.0)))
        count = 0
        for pair in turned:
            for root in np.roots(cubics[:, pair]):
                if abs(root.imag) < 1e-9 and 0.0 <= root.real <= 1.0:
                    u, v, w = (1.0 - root.real) * first[:, pair] + root.real * last[:, pair]
                    shares, *_ = np.linalg.lstsq(np.column_stack([u, -v]), -w, rcond=None)
                    off = np.linalg.norm(w + shares[0] * u - shares[1] * v)
                    count += bool(off < 1e-6 and ((shares >= 0.0) & (shares <= 1.0)).all())
        return count
