"""Pairs on lines of lumped nodes for the tests: soft and heavy, so that plain Python gets through them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from fmu_src.tethered_deorbit.bodies import make_bodies
from fmu_src.tethered_deorbit.environment import make_environment
from fmu_src.tethered_deorbit.idle import nothing
from fmu_src.tethered_deorbit.interface import HANDED_OVER, MODEL
from fmu_src.tethered_deorbit.layout import WIDTH, StateLayout, layout_of
from fmu_src.tethered_deorbit.nodes.chain import Noded, make_nodes
from fmu_src.tethered_deorbit.reel import components, make_reel
from fmu_src.tethered_deorbit.sights import Sights
from tests.plain import PlainInstance

LENGTH, DIAMETER, CHASER, TARGET = 12.0, 1e-3, 20.0, 10.0
SECTION = 0.25 * math.pi * DIAMETER**2
AXIAL = 50.0
"""EA [N]."""
REDUCED = CHASER * TARGET / (CHASER + TARGET)
TERMS = {"reel": "locked", "lumped": "nodes", "environment": "none", "solver": "dop853"}
VALUES: dict[str, Any] = {
    "chaser.mass": CHASER,
    "target.mass": TARGET,
    "tether.rest_length": LENGTH,
    "tether.diameter": DIAMETER,
    "tether.youngs_modulus": AXIAL / SECTION,
    "tether.damping_ratio": 0.0,
    "start.condition": HANDED_OVER,
}
Floats = npt.NDArray[np.float64]


def lumped(count: int, density: float, values: Mapping[str, Any], **terms: str) -> PlainInstance:
    """A pair on a line of so many nodes, of a density [kg/m3]."""
    own = {"lumped.nodes": count, "lumped.density": density}
    return PlainInstance(MODEL, TERMS | terms, VALUES | own | dict(values))


def apart(length: float, *velocity: float) -> dict[str, Any]:
    """Target and chaser so far apart along axis 2 [m], and how the target moves from the chaser [m/s]."""
    return {"start_relative_position": (0.0, length, 0.0), "start_relative_velocity": velocity}


def layout(terms: Mapping[str, str] | None = None) -> StateLayout:
    """Where things lie in the state of such a pair."""
    return layout_of(terms or MODEL.interface(TERMS).terms, *components("locked"))


def state_of(i: PlainInstance) -> Floats:
    """The state at the last communication point, inertial axes."""
    size = layout(i.interface.terms).size
    i.refresh()
    found: Floats = np.array(i.work[2 * size : 3 * size])
    return found


def nodes_of(i: PlainInstance) -> tuple[Floats, Floats]:
    """Places from the target [m] and velocities relative to it [m/s] of the nodes, (N, 3) each."""
    first, count = layout(i.interface.terms).reel, int(i["lumped.nodes"])
    rows = state_of(i)[first : first + WIDTH * count].reshape(count, WIDTH)
    return rows[:, :3], rows[:, 3:]


def kernels() -> Noded:
    """Law, bodies and watch of such a pair, for its record."""
    interface = MODEL.interface(TERMS)
    environment, where = make_environment("none", interface), layout()
    bodies = make_bodies(interface.terms, environment.place, environment.gradient, where.size, interface)
    reel = make_reel("locked", interface, Sights(where.reel, -1, bodies.line, environment.frame))
    return make_nodes(reel, bodies, environment, nothing, where, interface)


def put_nodes(i: PlainInstance, places: Floats, rates: Floats | float = 0.0) -> None:
    """Nodes elsewhere at the start; places and velocities from the target (N, 3) [m], [m/s]."""
    where, size = layout(), layout().size
    for row in range(3):
        state = i.work[row * size : (row + 1) * size]
        nodes = state[where.reel : where.reel + WIDTH * len(places)].reshape(-1, WIDTH)
        nodes[:, :3], nodes[:, 3:] = places, rates


def momenta(i: PlainInstance) -> tuple[Floats, Floats]:
    """Linear [kg m/s] and angular momentum [kg m2/s] of bodies and nodes, in inertial axes about their origin; spins of
    bodies that turn included."""
    state, (places, rates) = state_of(i), nodes_of(i)
    center, velocity, apart_by, parting = state[:12].reshape(4, 3)
    whole, node = CHASER + TARGET, i["lumped.mass"] / len(places)
    target, its_rate = center + CHASER / whole * apart_by, velocity + CHASER / whole * parting
    x = np.vstack([target - apart_by, target, target + places])
    v = np.vstack([its_rate - parting, its_rate, its_rate + rates])
    mass = np.array([CHASER, TARGET, *[node] * len(places)])[:, None]
    angular = np.cross(x, mass * v).sum(axis=0)
    for role in ("chaser", "target"):
        if i.interface.terms[role] != "point":
            angular += [i[f"{role}.spin[{axis}]"] for axis in (1, 2, 3)]
    return (mass * v).sum(axis=0), angular
