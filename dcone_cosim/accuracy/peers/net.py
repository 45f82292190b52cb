"""A square net that opens freely, by scipy, CVODE and MuJoCo: point masses and threads, nothing else.

    m_i x_i'' = sum of T n,   T = max(0, k (r - l) + d r')  when r > l, otherwise 0

MuJoCo's threads are spatial tendons that are springs beyond their length; their damping acts on slack ones too.
"""

from __future__ import annotations

import math
import time as clock
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from dcone_cosim.accuracy.peers.peer import Found, Peer
from dcone_cosim.quantities import Quantity
from dcone_cosim.scene.data import PhaseScene

Array = npt.NDArray[np.float64]
LEAVES_OUT = ("target", "contact", "closing", "tether", "settling", "knots", "edge", "leads")
MOST_OF_MUJOCO = 700
"""Nodes of the largest net that MuJoCo is asked for: its time goes with their number, and more."""


class Problem(NamedTuple):
    """A net at the moment of the shot.

    nodes, rates     positions and velocities [m], [m/s]                         (n, 3)
    masses           [kg]                                                        (n,)
    first, second    nodes that each thread joins                                (m,)
    length, stiffness, damping    of every thread [m], [N/m], [N s/m]
    axis             of the shot; corners: nodes with the bullets, round the mouth
    """

    nodes: Array
    rates: Array
    masses: Array
    first: npt.NDArray[np.int64]
    second: npt.NDArray[np.int64]
    length: float
    stiffness: float
    damping: float
    axis: Array
    corners: list[int]


def able(phase: PhaseScene) -> bool:
    """A square net by itself, without gravity, of uncut threads, whose nodes its FMU shows."""
    terms = phase.main.terms
    return (
        terms.get("net") == "square"
        and terms.get("gravity") == "none"
        and "nodes" in terms
        and not any(name in terms for name in LEAVES_OUT)
        and phase.setting("net.segments") == 1
    )


def small(phase: PhaseScene) -> bool:
    """One that MuJoCo gets through."""
    side, mesh = phase.setting("net.side"), phase.setting("net.mesh")
    return able(phase) and side is not None and mesh is not None and (side / mesh + 1.0) ** 2 <= MOST_OF_MUJOCO


def problem(values: Mapping[str, float]) -> Problem:
    """From parameters, and outputs at the start, of our FMU: the knots row by row, and the bullets."""
    count = round(values["net.nodes"])
    side = math.isqrt(count)
    nodes = np.array([[values[f"node[{n}].position[{i}]"] for i in (1, 2, 3)] for n in range(1, count + 1)])
    grid = np.arange(count).reshape(side, side)
    first = np.concatenate([grid[:, :-1].ravel(), grid[:-1].ravel()])
    second = np.concatenate([grid[:, 1:].ravel(), grid[1:].ravel()])
    length = values["net.side"] / (side - 1)
    area = values["net.mass"] / (values["net.density"] * length * len(first))
    piece = values["net.density"] * area * length
    masses = np.zeros(count)
    np.add.at(masses, first, 0.5 * piece)
    np.add.at(masses, second, 0.5 * piece)
    middle = grid[(side - 1) // 2 : side // 2 + 1, (side - 1) // 2 : side // 2 + 1].ravel()
    masses[middle] += values["vertex.mass"] / len(middle)
    corners = [int(grid[0, 0]), int(grid[0, -1]), int(grid[-1, -1]), int(grid[-1, 0])]
    rates = np.zeros((count, 3))
    bullets = np.array([[values[f"bullet[{b}].position[{i}]"] for i in (1, 2, 3)] for b in (1, 2, 3, 4)])
    speeds = np.array([[values[f"bullet[{b}].velocity[{i}]"] for i in (1, 2, 3)] for b in (1, 2, 3, 4)])
    for corner in corners:
        bullet = int(np.argmin(np.linalg.norm(bullets - nodes[corner], axis=1)))
        rates[corner] = speeds[bullet]
        masses[corner] += values["bullets.mass"]
    stiffness = values["net.youngs_modulus"] * area / length
    damping = 2.0 * values["net.damping_ratio"] * math.sqrt(stiffness * 2.0 * piece)
    axis = speeds.sum(axis=0) / np.linalg.norm(speeds.sum(axis=0))
    return Problem(nodes, rates, masses, first, second, length, stiffness, damping, axis, corners)


@cache
def compiled() -> Any:
    """Accelerations `(x, v, masses, first, second, length, stiffness, damping, out)`."""
    from numba import njit

    @njit
    def accelerate(
        x: Array, v: Array, masses: Array, first: Any, second: Any, length: float, k: float, d: float, out: Array
    ) -> None:
        out[:] = 0.0
        limit = length * length
        for e in range(first.size):
            a, b = first[e], second[e]
            dx, dy, dz = x[b, 0] - x[a, 0], x[b, 1] - x[a, 1], x[b, 2] - x[a, 2]
            squared = dx * dx + dy * dy + dz * dz
            if squared > limit:
                r = math.sqrt(squared)
                along = (v[b, 0] - v[a, 0]) * dx + (v[b, 1] - v[a, 1]) * dy + (v[b, 2] - v[a, 2]) * dz
                tension = k * (r - length) + d * along / r
                if tension > 0.0:
                    pull = tension / r
                    out[a, 0] += pull * dx
                    out[a, 1] += pull * dy
                    out[a, 2] += pull * dz
                    out[b, 0] -= pull * dx
                    out[b, 1] -= pull * dy
                    out[b, 2] -= pull * dz
        for i in range(masses.size):
            for axis in range(3):
                out[i, axis] /= masses[i]

    one = np.zeros((2, 3))
    accelerate(one, one, np.ones(2), np.array([0]), np.array([1]), 1.0, 1.0, 0.0, one.copy())
    return accelerate


def told(given: Problem, places: Array) -> list[Quantity]:
    """The quantities of an opening, from the corners at the instants, shape (instants, 4, 3)."""
    diagonals = places[:, 2] - places[:, 0], places[:, 3] - places[:, 1]
    areas = 0.5 * np.abs(np.cross(*diagonals) @ given.axis)
    return [Quantity("mouth_area", "", areas.tolist(), "m2", 1.0)]


def derivative_of(given: Problem) -> Callable[[Array, Array], None]:
    """Rate of the state (positions, then velocities), written into the second argument."""
    accelerate, count = compiled(), len(given.masses)

    def derivative(y: Array, rate: Array) -> None:
        x, v = y[: 3 * count].reshape(count, 3), y[3 * count :].reshape(count, 3)
        rate[: 3 * count] = y[3 * count :]
        accelerate(
            x, v, given.masses, given.first, given.second, given.length, given.stiffness, given.damping,
            rate[3 * count :].reshape(count, 3),
        )  # fmt: skip

    return derivative


def by_scipy(method: str) -> Callable[[Mapping[str, float], float, Sequence[float]], Found]:
    """scipy's explicit schemes with a compiled right-hand side."""

    def run(values: Mapping[str, float], size: float, instants: Sequence[float]) -> Found:
        from scipy.integrate import solve_ivp

        given = problem(values)
        derivative = derivative_of(given)

        def rhs(_: float, y: Array) -> Array:
            rate = np.empty_like(y)
            derivative(y, rate)
            return rate

        start = np.concatenate([given.nodes.ravel(), given.rates.ravel()])
        began = clock.process_time()
        made = solve_ivp(rhs, (0.0, instants[-1]), start, method, t_eval=instants, rtol=size, atol=size)
        cpu = clock.process_time() - began
        return Found(told(given, _corners(given, made.y.T)), cpu)

    return run


def _corners(given: Problem, states: Array) -> Array:
    count = len(given.masses)
    return np.asarray(states[:, : 3 * count].reshape(-1, count, 3)[:, given.corners])


def by_cvode(method: str) -> Callable[[Mapping[str, float], float, Sequence[float]], Found]:
    """CVODE with a compiled right-hand side; its BDF with GMRES, since the matrix is large."""

    def run(values: Mapping[str, float], size: float, instants: Sequence[float]) -> Found:
        from sksundae.cvode import CVODE

        given = problem(values)
        derivative = derivative_of(given)
        solver = CVODE(
            lambda _, y, rate: derivative(y, rate), method=method, rtol=size, atol=size, linsolver="gmres",
            max_num_steps=100_000_000,
        )  # fmt: skip
        start = np.concatenate([given.nodes.ravel(), given.rates.ravel()])
        began = clock.process_time()
        made = solver.solve(np.concatenate([[0.0], instants]), start)
        cpu = clock.process_time() - began
        return Found(told(given, _corners(given, made.y[1:])), cpu)

    return run


def by_mujoco(values: Mapping[str, float], size: float, instants: Sequence[float]) -> Found:
    """MuJoCo's semi-implicit Euler, each node a body on three slides, each thread a tendon; size: its step [s]."""
    import mujoco

    given = problem(values)
    bodies = "".join(
        f'<body pos="{x!r} {y!r} {z!r}"><joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 1 0"/>'
        f'<joint type="slide" axis="0 0 1"/><inertial pos="0 0 0" mass="{m!r}" diaginertia="1e-9 1e-9 1e-9"/>'
        f'<site name="s{n}"/></body>'
        for n, ((x, y, z), m) in enumerate(zip(given.nodes.tolist(), given.masses.tolist(), strict=True))
    )
    tendons = "".join(
        f'<spatial stiffness="{given.stiffness!r}" damping="{given.damping!r}" springlength="0 {given.length!r}">'
        f'<site site="s{a}"/><site site="s{b}"/></spatial>'
        for a, b in zip(given.first.tolist(), given.second.tolist(), strict=True)
    )
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><compiler boundmass="1e-12" boundinertia="1e-15"/><option timestep="{size!r}" gravity="0 0 0" '
        'jacobian="sparse"><flag contact="disable"/></option>'
        f"<worldbody>{bodies}</worldbody><tendon>{tendons}</tendon></mujoco>"
    )
    data = mujoco.MjData(model)
    data.qvel[:] = given.rates.ravel()
    places = np.full((len(instants), 4, 3), math.nan)
    began = clock.process_time()
    for row, instant in enumerate(instants):
        mujoco.mj_step(model, data, round(instant / size) - round(data.time / size))
        places[row] = (given.nodes + data.qpos.reshape(-1, 3))[given.corners]
    return Found(told(given, places), clock.process_time() - began)


TOLERANCES = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6)
PEERS = (
    Peer("scipy RK45", "scipy", TOLERANCES[1:], able, by_scipy("RK45")),
    Peer("scipy DOP853", "scipy", TOLERANCES[1:], able, by_scipy("DOP853")),
    Peer("CVODE Adams", "sksundae", TOLERANCES[1:], able, by_cvode("Adams")),
    Peer("CVODE BDF", "sksundae", TOLERANCES[1:-1], able, by_cvode("BDF")),
    Peer("MuJoCo", "mujoco", (2e-4, 1e-4, 5e-5), small, by_mujoco),
)
