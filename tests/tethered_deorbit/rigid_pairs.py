"""A pair with a rigid body at one end or both, and the same pair for another integration."""

import math
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fmu_src.instance import Instance
from fmu_src.tethered_deorbit.interface import HANDED_OVER, MODEL
from tests.tethered_deorbit.six_degrees import Body, Line, Tow

uncompiled = pytest.mark.usefixtures("plain")
FIELD_FREE = {"reel": "locked", "environment": "none", "target": "rigid"}
BOTH = FIELD_FREE | {"chaser": "rigid"}
ON_ORBIT = {"reel": "locked", "thrust": "along_track", "target": "rigid"}
REST, DIAMETER, MODULUS = 12.0, 1e-3, 60e9
STIFFNESS = MODULUS * math.pi * DIAMETER**2 / 4.0 / REST
M_C, M_T = 2000.0, 1000.0
REDUCED = M_C * M_T / (M_C + M_T)
INERTIA = np.array([[5000.0, 120.0, -60.0], [120.0, 2400.0, 40.0], [-60.0, 40.0, 6000.0]])
CHASER = np.array([[900.0, -30.0, 10.0], [-30.0, 1100.0, 0.0], [10.0, 0.0, 1300.0]])
ARM = np.array([0.4, -1.8, 0.3])
RADIUS = 7178137.0
MEAN_MOTION = math.sqrt(3.986004418e14 / RADIUS**3)


def six(matrix: np.ndarray) -> list[float]:
    return [matrix[0, 0], matrix[1, 1], matrix[2, 2], matrix[0, 1], matrix[0, 2], matrix[1, 2]]


def pair(terms: dict[str, str], arrays: dict[str, Any] | None = None, **parameters: float) -> Instance:
    """A pair handed over, parameters by name with __ for a dot, arrays by field."""
    given = {"start.condition": HANDED_OVER, "tether.damping_ratio": 0.0}
    i = Instance(MODEL, terms, given | {name.replace("__", "."): value for name, value in parameters.items()})
    i.array("start_relative_position")[:] = 0.5, 11.0, -0.4
    if "thrust" in terms and "thrust__level" not in parameters:
        i["thrust.level"] = 0.0
    if terms.get("target") == "rigid":
        i.array("target_inertia")[:] = six(INERTIA)
        i.array("target_attachment")[:] = ARM
    if terms.get("chaser") == "rigid":
        i.array("chaser_inertia")[:] = six(CHASER)
        i.array("chaser_attachment")[:] = 0.1, 1.1, -0.2
    for field, value in (arrays or {}).items():
        i.array(field)[:] = value
    return i.initialise()


def relative(i: Instance) -> tuple[np.ndarray, np.ndarray]:
    place = i.array("target_position") - i.array("chaser_position")
    return place, i.array("target_velocity") - i.array("chaser_velocity")


def momentum(i: Instance) -> np.ndarray:
    """Angular momentum about the joint centre of mass, spins included, inertial axes [N m s]."""
    place, speed = relative(i)
    spins = sum((i.array(f"{b}_spin") for b in ("target", "chaser") if i.interface.terms[b] == "rigid"), np.zeros(3))
    return np.asarray(REDUCED * np.cross(place, speed) + spins)


def matrix(i: Instance, body: str = "target") -> np.ndarray:
    w, *xyz = i.array(f"{body}_attitude")
    return np.asarray(Rotation.from_quat([*xyz, w]).as_matrix())


TUMBLING = {"target_start_rate": (0.03, 0.06, -0.04), "start_relative_velocity": (0.01, 0.02, 0.0)}


def reference(i: Instance, zeta: float, radius: float = 0.0, thrust: float = 0.0) -> tuple[Tow, np.ndarray]:
    """The same pair for scipy, and its start: an orbit in the plane of axes 1 and 2, from axis 1."""

    def bodies(role: str, mass: float) -> Body:
        if i.interface.terms[role] == "point":
            return Body(mass, np.eye(3), np.zeros(3))
        a, b, c, d, e, f = i.array(f"{role}_inertia")
        return Body(mass, np.array([[a, d, e], [d, b, f], [e, f, c]]), i.array(f"{role}_attachment").copy())

    def along_track(r: np.ndarray, v: np.ndarray) -> np.ndarray:
        along = np.cross(np.cross(r, v), r)
        return np.asarray(thrust * along / np.linalg.norm(along))

    line = Line(REST, STIFFNESS, 2.0 * zeta * math.sqrt(STIFFNESS * REDUCED))
    tow = Tow(bodies("chaser", M_C), bodies("target", M_T), line, radius, along_track if thrust else None)
    turning = MEAN_MOTION if radius else 0.0
    start = np.zeros(36)
    apart = i.array("start_relative_position")
    parting = i.array("start_relative_velocity") + np.cross([0.0, 0.0, turning], apart)
    for k, (body, share) in enumerate((("chaser", -M_T / (M_C + M_T)), ("target", M_C / (M_C + M_T)))):
        start[6 * k : 6 * k + 3], start[6 * k + 3 : 6 * k + 6] = share * apart, share * parting
        start[12 + 9 * k : 21 + 9 * k] = np.eye(3).ravel()
        if i.interface.terms[body] == "rigid":
            start[12 + 9 * k : 21 + 9 * k] = matrix(i, body).ravel()
            start[30 + 3 * k : 33 + 3 * k] = i.array(f"{body}_rate")
    return tow, start


def differences(i: Instance, tow: Tow, after: np.ndarray) -> dict[str, float]:
    """Largest differences: of tugs, relative to their size but for the time [s]; of places and rates, SI."""
    count = int(i["tether.tug_count"])
    assert count == len(tow.tugs)
    found = np.array([[i[f"tug[{count - k}].{what}"] for what in ("time", "speed", "peak")] for k in range(count)])
    wanted = np.array([[tug.time, tug.speed, tug.peak] for tug in tow.tugs])
    off = np.abs(found - wanted)
    place, rate = relative(i)
    return {
        "time": float(off[:, 0].max()),
        "speed": float((off[:, 1] / wanted[:, 1]).max()),
        "peak": float((off[:, 2] / wanted[:, 2]).max()),
        "place": float(np.abs(place - (after[6:9] - after[0:3])).max()),
        "velocity": float(np.abs(rate - (after[9:12] - after[3:6])).max()),
        "attitude": float(np.abs(matrix(i) - after[21:30].reshape(3, 3)).max()),
        "rate": float(np.abs(i.array("target_rate") - after[33:36]).max()),
    }
