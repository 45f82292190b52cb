"""The reel that pulls by length and angle: its law by itself, and the poles of its loop in the whole model."""

import math
from typing import Any

import numpy as np
import pytest

from fmu_src.instance import ModelFault
from fmu_src.tethered_deorbit.asked import LQR, TOWING
from fmu_src.tethered_deorbit.interface import HANDED_OVER, MODEL
from fmu_src.tethered_deorbit.kinematics import distance_acceleration, distance_rate
from fmu_src.tethered_deorbit.regulator import in_plane, make_regulator
from orbital.constants import EARTH_MU
from orbital.kepler import elements_to_state
from orbital.plain import mean_motion
from tests.plain import PlainInstance, plain
from tests.tethered_deorbit.test_design import loop, scene

__all__ = ["plain"]

TERMS = {"reel": "regulator", "thrust": "along_track"}
uncompiled = pytest.mark.usefixtures("plain")
RATE = 1.0381289e-3


def designed(**asked: float) -> dict[str, float]:
    """The gains of Table 2's pair."""
    from fmu_src.tethered_deorbit import design

    return design.designed(*scene("regulator", **asked))


def placed(length: float, speed: float, angle: float, turn: float, rate: float = RATE) -> dict[str, Any]:
    """A start in the orbital frame by the polar state (l, l', phi, phi')."""
    sine, cosine = math.sin(angle), math.cos(angle)
    return {
        "start.condition": HANDED_OVER,
        "start_relative_position": [length * cosine, length * sine, 0.0],
        "start_relative_velocity": [
            speed * cosine - length * turn * sine,
            speed * sine + length * turn * cosine,
            0.0,
        ],
    }


def polar(i: PlainInstance) -> np.ndarray[Any, Any]:
    """(l, l', phi, phi') in the orbital frame, from the outputs."""
    x, y = (i[f"relative.position[{k}]"] for k in (1, 2))
    u, v = (i[f"relative.velocity[{k}]"] for k in (1, 2))
    length = math.hypot(x, y)
    return np.array([length, (x * u + y * v) / length, math.atan2(y, x), (x * v - y * u) / length**2])


def test_angle_against_the_frame() -> None:
    """On a circle, against differences of the angle in the local frame."""
    position, velocity = np.zeros(3), np.zeros(3)
    rho, drift = np.array([3.0, -7.0, 0.4]), np.array([0.02, 0.01, -0.003])

    def seen(time: float) -> float:
        elements_to_state(
            position, velocity, 8e6, 0.0, 1.0, 0.5, 0.0, 0.3 + time * mean_motion(8e6, EARTH_MU), EARTH_MU
        )
        up = position / np.linalg.norm(position)
        normal = np.cross(position, velocity)
        along = np.cross(normal / np.linalg.norm(normal), up)
        at = rho + time * drift
        return math.atan2(at @ along, at @ up)

    before, after, now = seen(-0.05), seen(0.05), seen(0.0)
    angle, rate, turning = in_plane(np.concatenate([position, velocity, rho, drift]))
    assert angle == pytest.approx(now, abs=1e-12)
    assert rate == pytest.approx((after - before) / 0.1, rel=1e-6)
    assert turning == pytest.approx(mean_motion(8e6, EARTH_MU), rel=1e-12)


@uncompiled
def test_tension_rate_by_differences() -> None:
    """T' = dT/dx x' for any state and rate of it; in axes that turn as in axes at rest."""
    interface = MODEL.interface(TERMS)
    law = make_regulator(interface)
    record = interface.make_record().view(np.recarray)
    r = record[0]
    r.state_mean_motion, r.state_reduced_mass, r.state_effective_mass = RATE, 2000.0 / 3.0, 2000.0 / 3.0
    r.state_pace = RATE
    r.reel_angle_gain, r.reel_angle_rate_gain, r.reel_angle, r.reel_bias = -0.3, 70.0, 0.2, 0.01
    assert law.prepare(record, 0.0, 0.0, 0.0) == 0
    state = np.array([5e6, -4e6, 3e6, 5e3, 5e3, -1e3, 7.0, -3.0, 9.0, 0.01, 0.02, -0.005])
    slope = np.array([5e3, 5e3, -1e3, -5.0, 4.0, -3.0, 0.01, 0.02, -0.005, 3e-5, -2e-5, 1e-5])

    def tension(x: Any) -> float:
        law.see(record, x)
        length = float(np.linalg.norm(x[6:9]))
        return float(law.tension(record, length, distance_rate(x[6:9], x[9:12], length), 0.0))

    h = 1e-2
    expected = (tension(state + h * slope) - tension(state - h * slope)) / (2 * h)
    length = float(np.linalg.norm(state[6:9]))
    speed = distance_rate(state[6:9], state[9:12], length)
    change = distance_acceleration(state[6:9], state[9:12], slope[9:12], length, speed)
    turning = np.array([1e-3, -2e-3, 5e-4])
    r.state_turning[:] = turning
    turned = slope - np.concatenate([np.cross(turning, state[k : k + 3]) for k in range(0, 12, 3)])
    for rate, in_turning_axes in ((slope, 0.0), (turned, 1.0)):
        law.see(record, state)
        law.see_change(record, state, rate, in_turning_axes)
        assert law.tension_rate(record, length, speed, change, 0.0) == pytest.approx(expected, rel=1e-7)
    r.reel_angle_rate_gain = 71.0
    assert law.tension_rate(record, length, speed, change, 0.0) != pytest.approx(expected, rel=1e-4)


@uncompiled
@pytest.mark.parametrize(("about", "size"), [(0, 2e-3), (TOWING, 2e-3)])
def test_small_motion_decays_by_the_poles(about: int, size: float) -> None:
    """The nonlinear pair started along the slowest oscillation of the linear loop keeps to that pole."""
    found = loop("regulator", gains=LQR, about=about)
    poles, left = np.linalg.eig((found.matrix - found.drive @ found.gain).T)
    slow = int(np.argmax(np.where(poles.imag > 0.0, poles.real, -np.inf)))
    right = np.linalg.inv(left.T)[:, slow]
    start = size * (right / np.max(abs(right))).real
    units = np.array([12.0, 12.0 * RATE, 1.0, RATE])
    length, speed, angle, turn = start * units + np.array([12.0, 0.0, found.plant.angle, 0.0])
    i = PlainInstance(MODEL, TERMS, designed(gains=LQR, about=about) | placed(length, speed, angle, turn))
    assert i["tether.taut"]

    def mode() -> complex:
        away = (polar(i) - np.array([12.0, 0.0, found.plant.angle, 0.0])) / units
        return complex(left[:, slow] @ away)

    first, time = mode(), 0.0
    pole = poles[slow] * found.plant.pair.rate
    end = 1.0 / abs(pole.real)
    while time < end:
        i.step(60.0)
        time += 60.0
    assert np.log(abs(mode() / first)) / time == pytest.approx(pole.real, rel=1e-2)
    turned = np.angle(mode() / first * np.exp(-1j * pole.imag * time))
    assert turned == pytest.approx(0.0, abs=1e-2 * abs(pole.imag) * time)
    assert np.log(abs(mode() / first)) / time != pytest.approx(1.05 * pole.real, rel=1e-2)


@uncompiled
def test_without_gains_on_the_angle_it_is_the_linear_law() -> None:
    """The same bits as `linear`, whatever the angle."""
    start = placed(12.5, 1e-3, 0.4, 1e-4)
    both = [PlainInstance(MODEL, TERMS | {"reel": law}, start) for law in ("regulator", "linear")]
    for i in both:
        i.step(300.0)
    assert both[0]["tether.tension"] == both[1]["tether.tension"] > 0.0
    assert both[0]["separation"] == both[1]["separation"]


@uncompiled
def test_it_needs_a_vertical() -> None:
    with pytest.raises(ModelFault, match="need a local vertical, and there is no orbit"):
        PlainInstance(MODEL, {"reel": "regulator", "environment": "none"})
