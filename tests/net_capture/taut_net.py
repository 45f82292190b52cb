"""A net with every thread taut, hung between four heavy bullets: the model's own loop, and an independent one."""

import math

import numpy as np
from scipy.integrate import solve_ivp

from fmu_src.net_capture.planes import FX, INVERSE_MASS, MASS, P, U, X
from tests.net_capture.memory import nodes, planes

SIDE, MESH = 4.0, 1.0
STRETCH = 1.02
TERMS = {"net": "square", "gravity": "none"}
PARAMETERS = {
    "net.side": SIDE,
    "net.mesh": MESH,
    "net.mass": 0.011,
    "net.youngs_modulus": 7e7,
    "net.fold_side": 0.9 * SIDE,
    "bullets.speed": 0.0,
    "bullets.mass": 0.5,
    "vertex.mass": 0.001,
}
"""Soft threads: omega is about 440 rad/s, so that a hundredth of a second, the grid's unit, is less than a swing."""


def threads_of(knots):
    """Pairs of knots that a thread joins."""
    rows = [(i * knots + j, i * knots + j + 1) for i in range(knots) for j in range(knots - 1)]
    return np.array(rows + [(i * knots + j, (i + 1) * knots + j) for i in range(knots - 1) for j in range(knots)])


class Reference:
    """The same net in numpy, from mass, stiffness and dashpot of its own."""

    def __init__(self, ratio):
        knots = round(SIDE / MESH) + 1
        self.pairs = threads_of(knots)
        self.length = MESH
        thread = PARAMETERS["net.mass"] / len(self.pairs)
        area = PARAMETERS["net.mass"] / (1440.0 * len(self.pairs) * MESH)
        self.stiffness = PARAMETERS["net.youngs_modulus"] * area / MESH
        self.damping = 2.0 * ratio * math.sqrt(self.stiffness * 2.0 * thread)
        self.mass = np.zeros(knots * knots)
        for pair in self.pairs:
            self.mass[pair] += 0.5 * thread
        self.mass[[0, knots - 1, knots * (knots - 1), knots * knots - 1]] += PARAMETERS["bullets.mass"]
        self.mass[knots * knots // 2] += PARAMETERS["vertex.mass"]

    def parts(self, x, v):
        """Unit vectors, lengths and rates of all threads."""
        a, b = self.pairs.T
        d = x[b] - x[a]
        length = np.linalg.norm(d, axis=1)
        unit = d / length[:, None]
        return unit, length, np.einsum("ij,ij->i", v[b] - v[a], unit)

    def acceleration(self, x, v):
        unit, length, rate = self.parts(x, v)
        tension = self.stiffness * (length - self.length) + self.damping * rate
        assert length.min() > self.length
        assert tension.min() > 0.0
        force = np.zeros_like(x)
        np.add.at(force, self.pairs[:, 0], tension[:, None] * unit)
        np.add.at(force, self.pairs[:, 1], -tension[:, None] * unit)
        return force / self.mass[:, None]

    def power(self, x, v):
        return self.damping * float(np.sum(self.parts(x, v)[2] ** 2))

    def energy(self, x, v):
        stretch = self.parts(x, v)[1] - self.length
        return 0.5 * float(np.sum(self.mass[:, None] * v**2)) + 0.5 * self.stiffness * float(np.sum(stretch**2))

    def start(self):
        """Stretched evenly, each node moved and moving a little."""
        rng = np.random.default_rng(3)
        knots = round(SIDE / MESH) + 1
        grid = STRETCH * MESH * (np.arange(knots) - 0.5 * (knots - 1))
        x = np.array([(a, 0.0, b) for a in grid for b in grid])
        return x + rng.uniform(-1e-3, 1e-3, x.shape), rng.uniform(-0.1, 0.1, x.shape)

    def at(self, time):
        """Positions and velocities after a time, by DOP853."""
        x, v = self.start()

        def rate(_, y):
            x, v = y.reshape(2, -1, 3)
            return np.concatenate([v, self.acceleration(x, v)]).ravel()

        y = np.concatenate([x, v]).ravel()
        return solve_ivp(rate, (0.0, time), y, "DOP853", rtol=1e-12, atol=1e-14).y[:, -1].reshape(2, -1, 3)


def begin(net, reference):
    """Put the reference's start into the model: positions, velocities half a substep back, and those predicted."""
    x, v = reference.start()
    memory, slots = planes(net), nodes(net)
    back = 0.5 * net["solver.substep"] * reference.acceleration(x, v)
    memory[X : X + 3, slots] = x.T
    memory[P : P + 3, slots] = v.T
    memory[U : U + 3, slots] = (v - back).T
    memory[FX : FX + 3] = 0.0
    np.testing.assert_allclose(memory[MASS, slots], reference.mass, rtol=1e-12)
    np.testing.assert_allclose(memory[INVERSE_MASS, slots], 1.0 / reference.mass, rtol=1e-12)
    net.record["thread_loss"] = -0.5 * net["solver.substep"] * reference.power(x, v)
    net.step(0.0)
    return net


def with_substeps(shoot, count, ratio):
    """An instance of `count` substeps in a hundredth of a second."""
    probe = shoot(PARAMETERS | {"net.damping_ratio": ratio}, terms=TERMS)
    wanted = 0.01 / count / probe["solver.stability_bound"] * (1.0 + 1e-6)
    net = shoot(PARAMETERS | {"net.damping_ratio": ratio, "solver.step_ratio": wanted}, terms=TERMS)
    assert net["solver.substep"] == 0.01 / count
    return net
