"""A net with its bullets on leads against a published code, and against that code's equations solved here.

15 x 15 knots, mesh 0.25 m, threads of 12,566 N/m and 0.784 g with a dashpot of 0.2 N s/m, bullets of 0.3 kg on leads
like them, the whole shrunk to half, 2 m/s at 30 deg: its mouth is largest, with 0.912 of the flat net, at 2.53 s.
"""

import math

import numba
import numpy as np
import pytest

from fmu_src.instance import Instance
from fmu_src.net_capture.interface import MODEL
from tests.conftest import FREE
from tests.validation import other_code

KNOTS, MESH, STIFFNESS, MASS, DASHPOT, BULLET = 15, 0.25, 12566.0, 0.784e-3, 0.2, 0.3
SOURCE = "Dynamical-simulation-of-tethered-net-capture-of-space-debris (Yitao-LIN, C++)"
FLAT = (MESH * (KNOTS - 1) + math.sqrt(2.0) * MESH) ** 2
"""Of the bullets' square in the flat net [m2]."""


@numba.njit
def pull(x, v, ends, slack_damped, force):
    """Forces of all threads [N]."""
    force[:] = 0.0
    for e in range(len(ends)):
        a, b = ends[e, 0], ends[e, 1]
        rx, ry, rz = x[b, 0] - x[a, 0], x[b, 1] - x[a, 1], x[b, 2] - x[a, 2]
        length = math.sqrt(rx * rx + ry * ry + rz * rz)
        if length > MESH or slack_damped:
            along = (v[b, 0] - v[a, 0]) * rx + (v[b, 1] - v[a, 1]) * ry + (v[b, 2] - v[a, 2]) * rz
            tension = STIFFNESS * max(length - MESH, 0.0) + DASHPOT * along / length
            for axis, r in ((0, rx), (1, ry), (2, rz)):
                force[a, axis] += tension / length * r
                force[b, axis] -= tension / length * r


@numba.njit
def largest(place, rate, ends, mass, slack_damped):
    """Largest area between the last four nodes over `FLAT`, and when, by that code's scheme: Runge-Kutta of order 4
    with 0.1 ms over 3 s."""
    best, when, step = 0.0, 0.0, 1e-4
    weights, ways = (1.0, 2.0, 2.0, 1.0), (0.5, 0.5, 1.0, 0.0)
    force, x, v = np.zeros_like(place), place.copy(), rate.copy()
    dx, dv = np.zeros_like(place), np.zeros_like(place)
    for n in range(30000):
        dx[:] = 0.0
        dv[:] = 0.0
        for stage in range(4):
            pull(x, v, ends, slack_damped, force)
            for i in range(len(place)):
                for axis in range(3):
                    speed, accelerated = v[i, axis], force[i, axis] / mass[i]
                    dx[i, axis] += weights[stage] / 6.0 * speed
                    dv[i, axis] += weights[stage] / 6.0 * accelerated
                    x[i, axis] = place[i, axis] + ways[stage] * step * speed
                    v[i, axis] = rate[i, axis] + ways[stage] * step * accelerated
        place += step * dx
        rate += step * dv
        x[:] = place
        v[:] = rate
        c = place[-4:]
        area = 0.5 * abs((c[3, 0] - c[0, 0]) * (c[2, 1] - c[1, 1]) - (c[2, 0] - c[1, 0]) * (c[3, 1] - c[0, 1]))
        if area / FLAT > best:
            best, when = area / FLAT, (n + 1) * step
    return best, when


def net():
    """Places, rates, ends and masses of that code's net, the four bullets last."""
    grid = MESH * (np.arange(KNOTS) - 0.5 * (KNOTS - 1))
    knots = np.array([(x, y, 0.0) for x in grid for y in grid])
    number = np.arange(KNOTS**2).reshape(KNOTS, KNOTS)
    ends = [*zip(number[:, :-1].ravel(), number[:, 1:].ravel(), strict=True)]
    ends += zip(number[:-1].ravel(), number[1:].ravel(), strict=True)
    signs = np.array([(-1, -1), (-1, 1), (1, -1), (1, 1)])
    corners = [number[0, 0], number[0, -1], number[-1, 0], number[-1, -1]]
    out = np.column_stack([signs / math.sqrt(2.0), np.zeros(4)])
    place = 0.5 * np.vstack([knots, knots[corners] + MESH * out])
    ends += [(corner, KNOTS**2 + k) for k, corner in enumerate(corners)]
    mass = np.zeros(len(place))
    for end in np.array(ends).T:
        np.add.at(mass, end, 0.5 * MASS)
    mass[-4:] = BULLET
    rate = np.zeros_like(place)
    rate[-4:] = out
    rate[-4:, 2] = math.sqrt(3.0)
    return place, rate, np.array(ends), mass


def by_the_model(seed):
    """The same of our net, nodes jittered by a micrometre."""
    density = 1000.0
    area = MASS / (density * MESH)
    modulus, ratio = STIFFNESS * MESH / area, DASHPOT / (2.0 * math.sqrt(STIFFNESS * 2.0 * MASS))
    side = MESH * (KNOTS - 1)
    values = {
        "net.side": side,
        "net.mesh": MESH,
        "net.mass": 2 * KNOTS * (KNOTS - 1) * MASS,
        "net.fold_side": 0.5 * side,
        "leads.length": MESH,
        "leads.diameter": math.sqrt(4.0 * area / math.pi),
        "bullets.mass": BULLET - 0.5 * MASS,
        "bullets.speed": 2.0,
        "bullets.angle": math.radians(30.0),
        "vertex.mass": 0.0,
        "chaser.mass": 1e6,
        "solver.jitter[3]": 1e-6,
        "solver.seed": seed,
    }
    for part in ("net", "leads"):
        values |= {f"{part}.youngs_modulus": modulus, f"{part}.density": density, f"{part}.damping_ratio": ratio}
    shot = Instance(MODEL, FREE | {"leads": "plain"}, values).initialise()
    axes, best, when = shot.array("axes").reshape(3, 3), 0.0, 0.0
    for n in range(150):
        shot.step(0.02)
        x, y = axes[:2] @ shot.array("bullet_position").T
        area = 0.5 * abs(sum(x[k] * y[k - 1] - x[k - 1] * y[k] for k in range(4)))
        if area / FLAT > best:
            best, when = area / FLAT, 0.02 * (n + 1)
    return best, when


@pytest.fixture(scope="module")
def shots():
    return np.array([by_the_model(seed) for seed in range(8)])


def by_its_equations(slack_damped):
    """Means over four starts that differ by a micrometre: one alone, quite symmetric, is another sample."""
    found = []
    for seed in range(4):
        place, rate, ends, mass = net()
        place += 1e-6 * np.random.default_rng(seed).uniform(-1.0, 1.0, place.shape)
        found.append(largest(place, rate, ends, mass, slack_damped))
    return np.mean(found, axis=0)


def test_that_codes_equations_give_its_figures():
    best, when = by_its_equations(False)
    assert best == pytest.approx(0.912, abs=4e-3)
    assert when == pytest.approx(2.53, abs=0.03)


def test_the_mouth_is_as_wide_as_published(shots, validated):
    """The mean of eight shots; one scatters by half a per cent."""
    area, when = shots.mean(axis=0)
    validated(other_code(SOURCE), "15 x 15 net on leads: largest mouth area", area, 0.912, "1", rel=0.01)
    validated(other_code(SOURCE), "15 x 15 net on leads: when the mouth is largest", when, 2.53, "s", rel=0.02)


def test_slack_threads_that_are_damped_are_another_net(shots):
    """Where the dashpots of loose threads pull and push, the net opens wider, and later."""
    best, when = by_its_equations(True)
    assert best > 0.93
    assert abs(best - shots[:, 0].mean()) > 0.01 * 0.912
    assert when > 2.6
