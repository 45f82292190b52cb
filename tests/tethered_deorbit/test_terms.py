"""Each term by itself: gravity against 50 digits, the line, the three thrusts, the reel, and what is compiled."""

import math
import re
from decimal import Decimal, getcontext
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fmu_src.instance import Instance, ModelFault
from fmu_src.packaging import compile
from fmu_src.tethered_deorbit import kinematics
from fmu_src.tethered_deorbit.bodies import points
from fmu_src.tethered_deorbit.environment import make_environment
from fmu_src.tethered_deorbit.environment.central import add_gravity
from fmu_src.tethered_deorbit.interface import HANDED_OVER, MODEL
from fmu_src.tethered_deorbit.layout import state_layout
from fmu_src.tethered_deorbit.thrust import make_thrust
from orbital.constants import EARTH_EQUATORIAL_RADIUS, EARTH_MU
from tests.validation import Validated, other_code

TERMS = {"reel": "locked", "thrust": "along_track"}
STATE = np.array([5e6, -4e6, 3e6, 5e3, 5e3, -1e3, 7.0, -3.0, 9.0, 0.01, 0.02, -0.005])


def masses() -> Any:
    """A record with the derived masses of Table 2 and 0.01 N backwards."""
    record = MODEL.interface(TERMS).make_record()
    record["state_total_mass"] = 3000.0
    record["state_chaser_share"], record["state_target_share"] = 2.0 / 3.0, 1.0 / 3.0
    record["state_reduced_mass"] = 2000.0 / 3.0
    record["state_thrust"] = -0.01
    return record


def gravity(r: list[Decimal]) -> list[Decimal]:
    square = sum((x * x for x in r), Decimal(0))
    return [-Decimal(EARTH_MU) * x / (square * square.sqrt()) for x in r]


def test_gravity(validated: Validated) -> None:
    getcontext().prec = 50
    rate = np.zeros(12)
    add_gravity(masses(), STATE, rate)
    center, rho = [Decimal(float(x)) for x in STATE[:3]], [Decimal(float(x)) for x in STATE[6:9]]
    chaser = gravity([c - x / 3 for c, x in zip(center, rho, strict=True)])
    target = gravity([c + 2 * x / 3 for c, x in zip(center, rho, strict=True)])
    relative = np.array([float(t - c) for t, c in zip(target, chaser, strict=True)])
    mean = np.array([float((2 * c + t) / 3) for t, c in zip(target, chaser, strict=True)])
    exactly = other_code("fifty digits by Python's decimal")
    for what, found, expected, allowed in (
        ("relative acceleration", rate[9:], relative, 5e-15),
        ("acceleration of the centre of mass", rate[3:6], mean, 1e-15),
    ):
        error = np.linalg.norm(found - expected) / np.linalg.norm(expected)
        validated(exactly, f"gravity of a pair: {what}, relative error", error, 0.0, abs=allowed)
    assert np.array_equal(rate[:3], STATE[3:6])
    assert np.array_equal(rate[6:9], STATE[9:])
    naive = np.array([float(x) for x in target]) - np.array([float(x) for x in chaser])
    assert np.linalg.norm(naive - relative) > 1e-12 * np.linalg.norm(relative)


def test_line_kinematics() -> None:
    """Rates of |rho| by finite differences of a smooth path, compiled and not."""

    def path(t: float) -> Any:
        return np.array([7 + math.sin(t), 3 * math.cos(t), t * t])

    h, t = 1e-3, 0.4
    at = [path(t + k * h) for k in (-2, -1, 0, 1, 2)]
    lengths = [float(np.linalg.norm(x)) for x in at]

    def first(x: list[Any]) -> Any:
        return (x[0] - 8 * x[1] + 8 * x[3] - x[4]) / (12 * h)

    def second(x: list[Any]) -> Any:
        return (-x[0] + 16 * x[1] - 30 * x[2] + 16 * x[3] - x[4]) / (12 * h * h)

    for rate, acceleration in (
        (kinematics.distance_rate, kinematics.distance_acceleration),
        (kinematics.distance_rate.py_func, kinematics.distance_acceleration.py_func),  # type: ignore[attr-defined]
    ):
        speed = rate(at[2], first(at), lengths[2])
        assert speed == pytest.approx(first(lengths), rel=1e-10)
        assert acceleration(at[2], first(at), second(at), lengths[2], speed) == pytest.approx(second(lengths), rel=1e-6)
        assert rate(np.zeros(3), np.array([3.0, 0.0, 4.0]), 0.0) == 5.0
        assert acceleration(np.zeros(3), np.ones(3), np.ones(3), 0.0, 1.0) == 0.0


@pytest.mark.parametrize("direction", ["along_track", "velocity", "tether"])
def test_thrust_directions(direction: str) -> None:
    r, v = STATE[:3] - STATE[6:9] / 3, STATE[3:6] - STATE[9:] / 3
    way = {"along_track": np.cross(np.cross(r, v), r), "velocity": v, "tether": STATE[6:9]}[direction]
    force = -0.01 * way / np.linalg.norm(way)
    rate = np.zeros(12)
    interface = MODEL.interface(TERMS | {"thrust": direction})
    environment = make_environment("central", interface)
    make_thrust(
        interface.terms, environment.place, environment.along_track, points.along, state_layout(0), interface
    ).add(masses(), STATE, rate, 0.0, 0.0)
    assert rate[3:6] == pytest.approx(force / 3000.0, rel=1e-12)
    assert rate[9:] == pytest.approx(-force / 2000.0, rel=1e-12)
    assert not rate[:3].any()
    assert not rate[6:9].any()


def test_tension_pulls_together() -> None:
    rate = np.zeros(12)
    points.pull(masses(), STATE, rate, 3.0, float(np.linalg.norm(STATE[6:9])))
    assert rate[9:] == pytest.approx(-3.0 / (2000.0 / 3.0) * STATE[6:9] / np.linalg.norm(STATE[6:9]), rel=1e-14)
    assert not rate[:9].any()


def code(terms: dict[str, str], folder: Path) -> str:
    """What goes into an FMU with these terms, as LLVM IR."""
    compile.emit(MODEL, MODEL.interface(terms).terms, folder / "model.ll", folder / "kernels")
    return (folder / "model.ll").read_text()


def test_nothing_of_the_process_that_compiles_is_compiled_in(tmp_path: Path) -> None:
    """No address of a process in the code, and no thruster where none was named."""
    with_thrust = code(TERMS, tmp_path)
    assert "inttoptr" not in with_thrust
    assert "NRT_" not in re.sub(r"declare[^\n]*", "", with_thrust)
    assert "make_thrust" in with_thrust
    assert "make_thrust" not in code({"reel": "locked"}, tmp_path)


def test_without_a_thruster() -> None:
    i = Instance(MODEL, {"reel": "locked"}, {"start.condition": HANDED_OVER})
    assert "thrust.level" not in i.interface.references
    assert "chaser.propellant" not in i.interface.references
    i.array("start_relative_position")[:] = 12.001, 0.0, 0.0
    i.initialise()
    semi = i["center.semi_major_axis"]
    i.step(6000.0)
    assert i["center.semi_major_axis"] == pytest.approx(semi, abs=1e-3)
    assert i["tether.tension"] == pytest.approx(0.0258651, rel=5e-3)  # it swings a little


LINEAR = {"reel": "linear", "thrust": "along_track"}


def test_reel_holds_its_tension() -> None:
    """T = T_ff + k_p (l - l_c) + k_d dl/dt; at rest about the vertical the feed-forward alone carries the pair."""
    n = math.sqrt(EARTH_MU / (EARTH_EQUATORIAL_RADIUS + 800e3) ** 3)
    gains = {"reel.proportional_gain": 0.02, "reel.derivative_gain": 4.0, "start.condition": HANDED_OVER}
    i = Instance(MODEL, LINEAR, gains | {"thrust.level": 0.0})
    i.array("start_relative_position")[:] = 12.0, 0.0, 0.0
    i.initialise()
    feed = 3.0 * n * n * 2000.0 / 3.0 * 12.0
    assert i["tether.tension"] == pytest.approx(feed, rel=1e-14)
    i.step(6000.0)
    assert i["separation"] == pytest.approx(12.0, abs=1e-4)
    i["reel.length_offset"] = 0.5
    i.refresh()
    wanted = feed * 12.5 / 12.0 + 0.02 * (i["tether.length"] - 12.5) + 4.0 * i["tether.length_rate"]
    assert i["tether.tension"] == pytest.approx(wanted, rel=1e-12)
    assert wanted > 0.01
    i["reel.proportional_gain"] = 0.0202
    i.refresh()
    assert i["tether.tension"] != pytest.approx(wanted, rel=1e-3)
    i["reel.proportional_gain"] = 0.02
    i["reel.length_offset"] = 2.0
    i.refresh()
    assert i["tether.tension"] == 0.0  # such a haul asks for a push
    i.step(40000.0)
    assert i["separation"] == pytest.approx(14.0, abs=0.05)
    assert i["separation"] != pytest.approx(12.0, abs=0.05)


def test_reel_goes_slack_and_taut() -> None:
    """Onset of a reel is its own tension's zero, before the commanded length; the same bits for any macro step."""
    runs = []
    for step in (50.0, 4000.0):
        i = Instance(MODEL, LINEAR, {"reel.proportional_gain": 0.05, "reel.derivative_gain": 0.5}).initialise()
        assert i["tether.taut"] == 0
        for _ in range(round(4000.0 / step)):
            i.step(step)
        runs.append(i)
    assert runs[0]["tether.tug_count"] > 0
    for field in ("tug_time", "tug_peak", "tug_speed", "relative_position"):
        assert np.array_equal(runs[0].record[field], runs[1].record[field])
    i = Instance(MODEL, LINEAR, {"reel.proportional_gain": 0.05, "reel.derivative_gain": 0.5}).initialise()
    i.step(float(runs[0].array("tug_time")[int(runs[0]["tether.tug_count"]) - 1]))
    residual = (
        (3.0 * i.record["state_mean_motion"][0] ** 2 * 2000.0 / 3.0 * 12.0)
        + 0.05 * (i["tether.length"] - 12.0)
        + 0.5 * i["tether.length_rate"]
    )
    assert residual == pytest.approx(0.0, abs=1e-12)
    assert residual + 0.01 * 0.5 * i["tether.length_rate"] != pytest.approx(0.0, abs=1e-12)  # a gain off by 1 %
    assert residual + 0.01 * 0.05 * (i["tether.length"] - 12.0) != pytest.approx(0.0, abs=1e-12)
    for name in ("reel.proportional_gain", "reel.derivative_gain", "reel.length"):
        with pytest.raises(ModelFault, match="not positive" if name == "reel.length" else "bounds"):
            Instance(MODEL, LINEAR, {name: -0.1}).initialise()


def test_default_gains_hold_the_commanded_length() -> None:
    """Table 2 on a working reel with the default gains settles at l_c with the tide's tension; without gains not."""
    i = Instance(MODEL, LINEAR).initialise()
    for _ in range(24):
        i.step(3600.0)
    assert i["tether.length"] == pytest.approx(12.0, abs=0.01)
    assert i["tether.tension"] == pytest.approx(0.025865, rel=2e-3)
    i = Instance(MODEL, LINEAR, {"reel.proportional_gain": 0.0, "reel.derivative_gain": 0.0}).initialise()
    i.step(86400.0)
    assert i["tether.length"] > 100.0
