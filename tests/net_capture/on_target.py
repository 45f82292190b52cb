"""Nodes and threads that meet a target, by their kernels alone: a leapfrog without sleep, and without a net."""

import numpy as np

from fmu_src.net_capture.planes import (
    DAMPING,
    FIRST,
    FX,
    INVERSE_MASS,
    LANES,
    LENGTH,
    MASS,
    STIFFNESS,
    STRIP_WORDS,
    A,
    B,
    P,
    U,
    X,
    complete_strips,
)
from fmu_src.net_capture.schemes.asleep import ROW_WORDS, STAMP
from fmu_src.net_capture.threads import make_threads
from orbital.kernel import kernel
from tests.net_capture.memory import Bench, planes_of

TERMS = {"net": "square", "gravity": "none", "target": "cylinder", "contact": "penalty"}


class Kernels:
    """Parts of such a model, compiled once: `place(values)` gives a target without a node."""

    def __init__(self, terms=TERMS, tables=None):
        self.bench = Bench(terms, tables)
        parts = self.parts = self.bench.parts
        self.terms = terms = parts.terms
        node_plane, properties, own = parts.memory.node_plane, parts.memory.properties, parts.memory.own
        contact, target, pull_threads = parts.contact, parts.target, make_threads(parts, P, U).pull_now
        bends = parts.wrap is not None
        pull_bent, start = (parts.wrap.pull, parts.wrap.start) if bends else (None, None)
        begin, touch, put, drift = contact.begin_step, contact.touch_row, target.place, target.drift

        @kernel
        def place(record, work):
            p = record[0]
            put(p)
            complete_strips(p, properties(p, work))
            if bends:
                start(p)

        @kernel
        def advance(record, work, pulls, steps, ways, speeds):
            """Substeps with these forces on the nodes [N] (n, 3); place and velocity of the first after each."""
            p = record[0]
            h = p.solver_substep
            for n in range(steps):
                if bends:
                    for row in range(p.node_slots // p.row_pitch):
                        own(p, work)[ROW_WORDS * row + STAMP] = p.grid  # awake
                    pull_bent(p, work)
                begin(p, 0.0)
                pull_threads(p, work)
                for i in range(p.node_slots):
                    inverse = node_plane(p, work, INVERSE_MASS)[i]
                    for axis in range(3):
                        force = node_plane(p, work, FX + axis)[i]
                        if i < pulls.shape[0]:
                            force += pulls[i, axis]
                        change = h * force * inverse
                        velocity = node_plane(p, work, U + axis)[i] + change
                        node_plane(p, work, U + axis)[i] = velocity
                        node_plane(p, work, P + axis)[i] = velocity + 0.5 * change
                        node_plane(p, work, X + axis)[i] += h * velocity
                        node_plane(p, work, FX + axis)[i] = 0.0
                for first in range(0, p.node_slots, p.row_pitch):
                    touch(p, work, first)
                drift(p, 0.0, h)
                p.grid += 1
                for axis in range(3):
                    ways[n, axis] = node_plane(p, work, X + axis)[0]
                    speeds[n, axis] = node_plane(p, work, U + axis)[0]

        self._place, self._advance = place, advance

    def place(self, tables=None, **values):
        """A target with these values, and other tables than it was compiled with."""
        return Scene(self, values, tables)


class Scene:
    """A target, and nodes of given masses [kg] at given places [m] and velocities [m/s]."""

    def __init__(self, kernels, values, tables=None):
        self.kernels, bench = kernels, kernels.bench
        self.record, self.work = bench.record.copy(), np.zeros_like(bench.work)
        self.p = self.record[0]
        if tables is not None:
            self._tables = bench.interface.with_tables(tables).table_block
            self.p["tables_at"] = self._tables.ctypes.data
        for name, value in values.items():
            self.record[name] = value
        self.planes = planes_of(self.p, self.work, kernels.terms)
        self.p["strips"], self.p["contact_haste"] = 0, 1e9
        self.p["contact_first_time"] = -1.0
        self.planes[-1] = -1.0
        kernels._place(self.record, self.work)

    def put(self, masses, places, velocities):
        number = len(masses)
        self.planes[MASS, :number], self.planes[INVERSE_MASS, :number] = masses, 1.0 / np.asarray(masses)
        self.planes[X : X + 3, :number] = np.transpose(places)
        for first in (U, P):
            self.planes[first : first + 3, :number] = np.transpose(velocities)
        return self

    def join(self, number, length, stiffness, damping):
        """Threads between so many nodes, one after another."""
        self.p["strips"] = 1
        at = self.planes.nbytes // 8
        words, numbers = self.work[at:].view(np.int64), self.work[at + STRIP_WORDS :]
        words[[A, B, LANES, FIRST]] = 0, 1, (1 << number - 1) - 1, 0
        numbers[[LENGTH, STIFFNESS, DAMPING]] = length, stiffness, damping
        self.kernels._place(self.record, self.work)
        return self

    def go(self, substep, steps, pulls=((0.0, 0.0, 0.0),)):
        self.p["solver_substep"] = substep
        ways, speeds = np.zeros((steps, 3)), np.zeros((steps, 3))
        self.kernels._advance(self.record, self.work, np.array(pulls, float), steps, ways, speeds)
        return ways, speeds
