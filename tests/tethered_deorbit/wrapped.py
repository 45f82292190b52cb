"""Tows whose line wraps round a box or a cylinder, in no field."""

import math
from typing import Any

import numpy as np
import pytest

from fmu_src.instance import Instance
from fmu_src.tethered_deorbit.interface import HANDED_OVER, MODEL
from tests.plain import PlainInstance

uncompiled = pytest.mark.usefixtures("plain")
BOX = {"reel": "locked", "environment": "none", "target": "box", "thrust": "along_track"}
CYLINDER = {"reel": "locked", "environment": "none", "target": "cylinder", "thrust": "along_track"}
SIZE = np.array([2.5, 3.9, 2.2])
M_C, M_T = 2000.0, 1000.0
REDUCED = M_C * M_T / (M_C + M_T)
STIFFNESS = 60e9 * math.pi * 1e-6 / 4.0


def pair(terms: dict[str, str], arrays: dict[str, Any] | None = None, **parameters: float) -> Instance:
    """A field-free pair handed over, parameters by name with __ for a dot, arrays by field."""
    given = {
        "start.condition": HANDED_OVER,
        "tether.damping_ratio": 0.0,
        "tether.rest_length": 14.0,
        "thrust.level": 0.0,
    }
    i = Instance(MODEL, terms, given | {name.replace("__", "."): value for name, value in parameters.items()})
    i.array("start_relative_position")[:] = 0.0, 12.0, 0.0
    if terms["target"] == "box":
        i.array("target_size")[:] = SIZE
        i.array("target_attachment")[:] = 0.0, -0.5 * SIZE[1], 0.0
    i.array("target_inertia")[:] = 1671.0, 924.0, 1788.0, 30.0, -20.0, 10.0
    for field, value in (arrays or {}).items():
        i.array(field)[:] = value
    return i.initialise()


def momentum(i: Instance) -> np.ndarray:
    place = i.array("target_position") - i.array("chaser_position")
    speed = i.array("target_velocity") - i.array("chaser_velocity")
    return np.asarray(REDUCED * np.cross(place, speed) + i.array("target_spin"))


TUMBLING = {
    "target_start_rate": (0.05, -0.02, 0.06),
    "start_relative_velocity": (0.01, 0.02, 0.015),
    "target_attachment": (0.4, -0.5 * SIZE[1], -0.3),
}


def wrapped_and_taut(zeta: float) -> PlainInstance:
    """A box that the line comes round from its far face, over two edges, stretched by half a millimetre."""
    values = {
        "start.condition": HANDED_OVER,
        "start_relative_position": [0.0, 12.0, 0.0],
        "target_size": SIZE.tolist(),
        "target_attachment": [0.3, 0.5 * SIZE[1], 0.2],
        "target_inertia": [1671.0, 924.0, 1788.0, 30.0, -20.0, 10.0],
        "thrust.level": 0.0,
        "tether.damping_ratio": zeta,
    }
    slack = PlainInstance(MODEL, BOX, values | {"tether.rest_length": 100.0})
    assert slack["tether.bends"] == 2
    return PlainInstance(MODEL, BOX, values | {"tether.rest_length": slack["tether.length"] - 5e-4})
