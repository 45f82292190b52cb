"""The whole entry run as plain Python, in a process of its own: what would be dear to compile anew.

There every choice of terms costs nothing to build, and a limit of the code can be lowered to be reached. It is also a
check that compilation changes no result.
"""

import json
import math
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fmu_src.instance import Instance, ModelFault
from fmu_src.tethered_deorbit import model
from fmu_src.tethered_deorbit.interface import HANDED_OVER, MODEL, TOO_MANY_EVENTS, VBAR
from orbital import references
from orbital.constants import EARTH_EQUATORIAL_RADIUS, EARTH_MU
from orbital.oscillators import reduced_mass

RADIUS = EARTH_EQUATORIAL_RADIUS + 800e3
RATE = math.sqrt(EARTH_MU / RADIUS**3)
FORCE, CHASER = 0.01, 2000.0
TERMS = {"reel": "locked", "thrust": "along_track"}
SEMI, ECCENTRICITY = EARTH_EQUATORIAL_RADIUS + 10e6, 0.3
PERIOD = math.tau * math.sqrt(SEMI**3 / EARTH_MU)
ON_ELLIPSE = {
    "orbit.altitude": 10e6,
    "orbit.eccentricity": ECCENTRICITY,
    "tether.rest_length": 1e5,
    "thrust.level": FORCE,
}
ALONG_LINE = {"start.condition": VBAR, "tether.rest_length": 1e3, "thrust.level": FORCE}


def make(terms: dict[str, str], parameters: dict[str, Any]) -> Instance:
    """An instance at its start; a parameter may be a whole array, by its field's name."""
    i = Instance(MODEL, terms)
    i.record = i.record.view(np.recarray)  # plain Python reads the fields of a record as attributes only from these
    for name, value in parameters.items():
        if isinstance(value, list):
            i.array(name)[:] = value
        else:
            i[name] = value
    return i.initialise()


def work_done(terms: dict[str, str], parameters: dict[str, Any], time: float) -> float:
    """What the thrust adds to the chaser's orbital energy [J] in a time [s]."""

    def energy(i: Instance) -> float:
        r, v = i.array("chaser_position"), i.array("chaser_velocity")
        return float(CHASER * (0.5 * v @ v - EARTH_MU / np.linalg.norm(r)))

    i = make(terms, parameters)
    begin = energy(i)
    i.step(time)
    assert i["tether.tug_count"] == 0
    return energy(i) - begin


def bouncing() -> dict[str, Any]:
    """A hard pull on a line that is nearly taut and keeps its energy: it goes slack and taut every second."""
    return {
        "thrust.level": -10.0,
        "tether.damping_ratio": 0.0,
        "start.condition": HANDED_OVER,
        "start_relative_position": [0.0, 11.9999, 0.0],
        "start_relative_velocity": [0.0, 1e-3, 0.0],
    }


def hanging_tension(terms: dict[str, str], level: float) -> float:
    """Tension [N] of a vertical line after the first vibration has died out."""
    i = make(
        terms,
        {
            "thrust.level": level,
            "tether.damping_ratio": 0.5,
            "start.condition": HANDED_OVER,
            "start_relative_position": [12.000007, 0.0, 0.0],
        },
    )
    i.step(20.0)
    return i["tether.tension"]


def results() -> dict[str, Any]:
    """Everything the tests below ask of the other process."""
    velocity, tether = {"reel": "locked", "thrust": "velocity"}, {"reel": "locked", "thrust": "tether"}
    out: dict[str, Any] = {
        "velocity": work_done(velocity, ON_ELLIPSE, PERIOD),
        "ahead": work_done(tether, ALONG_LINE, 50.0),
        "behind": work_done(tether, ALONG_LINE | {"start.leading": 1}, 50.0),
        "hanging": [hanging_tension(tether, level) for level in (-FORCE, 0.0, FORCE)],
    }
    i = make(TERMS, bouncing())
    i.step(4.0)
    out["tugs"] = [i.array("tug_" + f).tolist() for f in ("time", "peak", "speed")]
    for limit, name in ((3, "fault"), (100, "no fault")):
        model.EVENT_LIMIT = limit
        i = make(TERMS, bouncing())
        try:
            i.step(6.0)
        except ModelFault as fault:
            out[name + " text"] = str(fault)
        out[name] = int(i.record["fault_code"][0])
    return out


@pytest.fixture(scope="module")
def uncompiled() -> Any:
    run = subprocess.run(
        [sys.executable, "-m", "tests.tethered_deorbit.test_uncompiled"],
        cwd=Path(__file__).parents[2],
        env=os.environ | {"NUMBA_DISABLE_JIT": "1"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0, run.stderr
    return json.loads(run.stdout)


def test_same_tugs_as_compiled(uncompiled: Any) -> None:
    i = make(TERMS, bouncing())
    i.step(4.0)
    assert i["tether.tug_count"] > 1
    for field, got in zip(("time", "peak", "speed"), uncompiled["tugs"], strict=True):
        assert i.array("tug_" + field) == pytest.approx(got, rel=1e-9)
    i = make(TERMS, bouncing() | {"start_relative_velocity": [0.0, 1.01e-3, 0.0]})
    i.step(4.0)
    assert i.array("tug_time") != pytest.approx(uncompiled["tugs"][0], rel=1e-9)


def test_too_many_changes(uncompiled: Any) -> None:
    assert uncompiled["fault"] == TOO_MANY_EVENTS
    assert "too often" in uncompiled["fault text"]
    assert uncompiled["no fault"] == 0


def test_work_of_a_thrust_round_an_ellipse(uncompiled: Any) -> None:
    """Force times the way: the circumference 4 a E(e) along the velocity, 2 pi b along-track."""
    angle = np.linspace(0.0, math.tau, 4096, endpoint=False)
    circumference = math.tau * SEMI * float(np.sqrt(1.0 - (ECCENTRICITY * np.cos(angle)) ** 2).mean())
    across = math.tau * SEMI * math.sqrt(1.0 - ECCENTRICITY**2)
    along_track = work_done(TERMS, ON_ELLIPSE, PERIOD)
    assert uncompiled["velocity"] == pytest.approx(FORCE * circumference, rel=1e-4)
    assert along_track == pytest.approx(FORCE * across, rel=1e-4)
    assert along_track != pytest.approx(FORCE * circumference, rel=1e-2)


def test_thrust_along_the_line(uncompiled: Any) -> None:
    """On V-bar it works along the orbit, forwards when the target leads: F v t. Hanging, it loads the line.

    T = 3 n^2 m_r l - F m_t/M, where thrust along-track leaves the tension as it is.
    """
    work = FORCE * math.sqrt(EARTH_MU / RADIUS) * 50.0
    assert uncompiled["ahead"] == pytest.approx(work, rel=1e-3)
    assert uncompiled["behind"] == pytest.approx(-work, rel=1e-3)
    free = references.equilibrium_tension(RATE, 12.0, reduced_mass(CHASER, 1000.0))
    for level, tension in zip((-FORCE, 0.0, FORCE), uncompiled["hanging"], strict=True):
        assert tension == pytest.approx(free - level / 3.0, rel=2e-3)
    assert hanging_tension(TERMS, -FORCE) != pytest.approx(free + FORCE / 3.0, rel=1e-2)


if __name__ == "__main__":
    print(json.dumps(results()))
