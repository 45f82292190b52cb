"""How the net turns as a whole, and a moment on it as on a rigid body."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from fmu_src.net_capture.planes import FX, MASS
from fmu_src.rows import state
from orbital.kernel import kernel
from orbital.rigid import invert_symmetric
from orbital.vectors import cross, matrix_vector

FLATTEST = 1e-9
"""Least determinant of the inertia, over that of a ball of the same trace: below, the nodes all but lie in a line."""
ROWS = (
    state("turn_centre[#]", "m", "centre of mass of all nodes", shape=(3,)),
    state("turn_rate[#]", "rad/s", "of the rigid body that has their angular momentum", shape=(3,)),
    state("turn_inertia[#][#]", "kg.m2", "of all nodes about it", shape=(3, 3)),
    state("turn_inverse[#][#]", "1/(kg.m2)", "inverse of that", shape=(3, 3)),
    state("turn_moment[#]", "N.m", "on the net as a whole", shape=(3,)),
    state("turn_vectors[#]", "1", "two vectors", shape=(6,)),
)


class WholeTurn(NamedTuple):
    """Kernels of the net as one rigid body.

    measure(p, work) -> sound    centre, inertia and rate of turn [rad/s] into the record; False where the nodes lie in
                                 a line or a point
    load(p, work)                add the forces [N] of the moment in `turn_moment`, as of a rigid body that it speeds up
    """

    measure: Any
    load: Any


def make_whole_turn(composition: Any, place: int, rate: int) -> WholeTurn:
    """Kernels by the planes of positions and velocities from these on."""
    node_plane = composition.memory.node_plane

    @kernel
    def measure(p, work):
        """w = I^-1 sum m (x - c) x (v - u); whether there is an inverse.

        Checked  tests/net_capture/test_bending.py
        """
        mass = node_plane(p, work, MASS)
        lever, going = p.turn_vectors[0:3], p.turn_vectors[3:6]
        spin = p.turn_moment
        whole = 0.0
        for axis in range(3):
            p.turn_centre[axis] = 0.0
            p.turn_rate[axis] = 0.0
            spin[axis] = 0.0
            for other in range(3):
                p.turn_inertia[axis, other] = 0.0
        for node in range(p.node_slots):
            m = np.float64(mass[node])
            whole += m
            for axis in range(3):
                p.turn_centre[axis] += m * np.float64(node_plane(p, work, place + axis)[node])
                p.turn_rate[axis] += m * np.float64(node_plane(p, work, rate + axis)[node])
        for axis in range(3):
            p.turn_centre[axis] /= whole
            p.turn_rate[axis] /= whole
        for node in range(p.node_slots):
            m = np.float64(mass[node])
            if m > 0.0:
                squared = 0.0
                for axis in range(3):
                    lever[axis] = np.float64(node_plane(p, work, place + axis)[node]) - p.turn_centre[axis]
                    going[axis] = np.float64(node_plane(p, work, rate + axis)[node]) - p.turn_rate[axis]
                    squared += lever[axis] * lever[axis]
                for i in range(3):
                    j = (i + 1) % 3
                    k = (i + 2) % 3
                    spin[i] += m * (lever[j] * going[k] - lever[k] * going[j])
                    p.turn_inertia[i, i] += m * squared
                    for axis in range(3):
                        p.turn_inertia[i, axis] -= m * lever[i] * lever[axis]
        third = (p.turn_inertia[0, 0] + p.turn_inertia[1, 1] + p.turn_inertia[2, 2]) / 3.0
        determinant = invert_symmetric(p.turn_inverse, p.turn_inertia)
        matrix_vector(p.turn_rate, p.turn_inverse, spin)
        for axis in range(3):
            spin[axis] = 0.0
        return determinant > FLATTEST * third * third * third

    @kernel
    def load(p, work):
        """F = m (I^-1 G) x (x - c): their sum is nothing, and their moment G.

        Checked  tests/net_capture/test_bending.py
        """
        mass = node_plane(p, work, MASS)
        growth, lever = p.turn_vectors[0:3], p.turn_vectors[3:6]
        matrix_vector(growth, p.turn_inverse, p.turn_moment)
        for node in range(p.node_slots):
            m = np.float64(mass[node])
            if m > 0.0:
                for axis in range(3):
                    lever[axis] = np.float64(node_plane(p, work, place + axis)[node]) - p.turn_centre[axis]
                cross(p.turn_rate, growth, lever)
                for axis in range(3):
                    node_plane(p, work, FX + axis)[node] += m * p.turn_rate[axis]

    return WholeTurn(measure, load)
