"""Axes that turn with a taut line: the transformation itself, that no law notices it, and how far a step may reach."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fmu_src.instance import Instance
from fmu_src.integrators.dop853 import DAMPED_REACH, UNDAMPED_REACH, make_dop853
from fmu_src.integrators.dop853 import reach as reach_of_dop853
from fmu_src.tethered_deorbit import kinematics, turning
from fmu_src.tethered_deorbit.bodies import points
from fmu_src.tethered_deorbit.bodies.attached import FURTHER
from fmu_src.tethered_deorbit.environment import make_environment
from fmu_src.tethered_deorbit.environment.central import add_gravity
from fmu_src.tethered_deorbit.interface import HANDED_OVER, MODEL
from fmu_src.tethered_deorbit.layout import state_layout
from fmu_src.tethered_deorbit.thrust import make_thrust
from fmu_src.tethered_deorbit.tolerances import make_longest_taut_step
from orbital.kernel import kernel
from orbital.oscillators import line_stiffness, natural_frequency, reduced_mass

TERMS = {"reel": "locked", "thrust": "along_track"}
STATE = np.array([5e6, -4e6, 3e6, 5e3, 5e3, -1e3, 7.0, -3.0, 9.0, 0.01, 0.02, -0.005])
TURNING = np.array([0.02, -0.03, 0.01])
FREQUENCY = natural_frequency(line_stiffness(60e9, 1e-3, 12.0), reduced_mass(2000.0, 1000.0))


def taut_record(rate: Any = (0.0, 0.0, 0.0)) -> Any:
    record = MODEL.interface(TERMS).make_record()
    record["state_turning"][0] = rate
    record["state_taut"] = 1
    record["state_frequency"] = FREQUENCY
    record["state_total_mass"], record["state_thrust"] = 3000.0, -0.01
    record["state_chaser_share"], record["state_target_share"] = 2.0 / 3.0, 1.0 / 3.0
    return record


def rotated(state: Any, by: Any) -> Any:
    return Rotation.from_rotvec(by).apply(state.reshape(-1, 3)).ravel()


@pytest.mark.parametrize("time", [0.0, 0.5, 7.0])
def test_turned_back(time: float) -> None:
    state = STATE.copy()
    turning.turn_back(taut_record(TURNING), time, state)
    assert state == pytest.approx(rotated(STATE, TURNING * time), rel=1e-14)
    assert time == 0.0 or state != pytest.approx(rotated(STATE, -TURNING * time), rel=1e-6)


def test_lengths_are_kept() -> None:
    """A hundred thousand turns leave the orbit's radius within a random walk of its last digit, without a drift."""
    record, state = taut_record([0.0, 2e-4, 1e-3]), STATE.copy()
    for _ in range(100_000):
        turning.turn_back(record, 1.2, state)
    for first in range(0, 12, 3):
        length = np.linalg.norm(STATE[first : first + 3])
        assert np.linalg.norm(state[first : first + 3]) == pytest.approx(length, rel=2e-13)


def test_rates_in_turning_axes() -> None:
    record, rate = taut_record(TURNING), np.zeros(12)
    turning.add_turning(record, STATE, rate, -1.0)
    expected = np.cross(STATE.reshape(-1, 3), TURNING).ravel()  # -w x v
    assert rate == pytest.approx(expected, rel=1e-14)
    assert rate != pytest.approx(-expected, rel=1e-2)
    turning.add_turning(record, STATE, rate, 1.0)
    assert np.abs(rate).max() == 0.0


def test_second_derivative_of_the_length() -> None:
    position, velocity = STATE[6:9].copy(), STATE[9:].copy()
    length = float(np.linalg.norm(position))
    share = kinematics.turning_share(taut_record(TURNING), position, velocity, length)
    assert share == pytest.approx(position @ np.cross(TURNING, velocity) / length, rel=1e-13)
    assert kinematics.turning_share(taut_record(TURNING), np.zeros(3), velocity, 0.0) == 0.0


def test_axes_follow_a_taut_line() -> None:
    record, state = taut_record(), STATE.copy()
    expected = np.cross(STATE[6:9], STATE[9:]) / (STATE[6:9] @ STATE[6:9])
    turning.set_turning(record, state)
    assert record["state_turning"][0] == pytest.approx(expected, rel=1e-14)
    for change in ("slack", "too fast", "no line"):
        record, state = taut_record(TURNING), STATE.copy()
        if change == "slack":
            record["state_taut"] = 0
        state[9:] *= 1e3 if change == "too fast" else 1.0
        state[6:9] *= 0.0 if change == "no line" else 1.0
        turning.set_turning(record, state)
        assert not record["state_turning"].any(), change


@kernel
def _uneven(record: Any, state: Any, rate: Any) -> None:
    rate[9] += 0.01


@pytest.mark.parametrize("direction", ["along_track", "velocity", "tether"])
def test_laws_look_the_same_from_any_axes(direction: str) -> None:
    """f(Q x) = Q f(x) for gravity and every thrust; a force fixed in space would not be so."""
    by, record = np.array([0.3, -1.0, 0.7]), taut_record()
    interface = MODEL.interface(TERMS | {"thrust": direction})
    environment = make_environment("central", interface)
    push = make_thrust(
        interface.terms, environment.place, environment.along_track, points.along, state_layout(0), interface
    ).add

    def add(record: Any, state: Any, rate: Any) -> None:
        push(record, state, rate, 0.0, 0.0)

    def difference(*laws: Callable[..., Any]) -> Any:
        here, there = np.zeros(12), np.zeros(12)
        for law in laws:
            law(record, STATE, here)
            law(record, rotated(STATE, by), there)
        return np.abs(rotated(here, by) - there)[9:].max()

    assert difference(add_gravity, add) < 1e-14
    assert difference(add_gravity, add, _uneven) > 1e-3


def hanging(**parameters: float) -> Instance:
    i = Instance(MODEL, TERMS, {k.replace("__", "."): v for k, v in parameters.items()})
    i["start.condition"] = HANDED_OVER
    i.array("start_relative_position")[:] = 12.00001, 0.0, 0.0
    return i.initialise()


def test_a_line_at_rest_is_stepped_by_its_vibration_alone() -> None:
    """After the first vibration the error control has no say: steps as long as allowed, an error far below."""
    i = hanging()
    i.step(300.0)
    before = i["solver.steps"]
    i.step(3600.0)
    assert i["solver.steps"] - before <= 1.0 + 3600.0 * FREQUENCY / DAMPED_REACH
    assert i.record["state_error"][0] < 0.05
    apart, parting = (i.array(f"target_{x}") - i.array(f"chaser_{x}") for x in ("position", "velocity"))
    assert i.array("state_turning") == pytest.approx(np.cross(apart, parting) / (apart @ apart), rel=1e-2)
    spinning = hanging(tether__damping_ratio=0.0)
    spinning.step(300.0)
    before = spinning["solver.steps"]
    spinning.step(3600.0)
    assert spinning["solver.steps"] - before >= 3600.0 * FREQUENCY / UNDAMPED_REACH - 1.0


@kernel
def _oscillator(context: Any, state: Any, rate: Any, elapsed: float) -> None:
    rate[0] = state[1]
    rate[1] = -state[0] - 2.0 * context[0] * state[1]


@kernel
def _size(context: Any, state: Any, error: Any) -> float:
    return float(error[0] * error[0] + error[1] * error[1])


def test_longest_step() -> None:
    """The scheme's own damping is at most a hundredth of the line's, at the longest step that each damping allows; of a
    body that turns an eighth, where its dashpot is strong, and no more than of points where there is none."""
    scheme, longest_taut_step = make_dop853(_oscillator, _size, 2), make_longest_taut_step(reach_of_dop853, 1.0)
    of_turning = make_longest_taut_step(reach_of_dop853, FURTHER)

    def excess(zeta: float, reach: float) -> float:
        """Damping of the scheme beyond the line's, in units of the line's."""
        columns = []
        for start in np.eye(2):
            end, stages = np.zeros(2), np.zeros(scheme.stages)
            _oscillator(np.array([zeta]), start, stages[:2], 0.0)
            scheme.attempt(np.array([zeta]), start, reach, stages, end)
            columns.append(end.copy())
        growth = float(abs(np.linalg.eigvals(np.array(columns).T)).max())
        return -math.log(growth) / (zeta * reach) - 1.0

    for zeta, reach in ((0.05, 3.0), (0.01, 2.453), (1e-3, 1.840), (1e-5, 1.034)):
        record = taut_record()
        record["state_effective_mass"] = 1.0
        record["state_damping"] = 2.0 * zeta * FREQUENCY
        longest = float(longest_taut_step(record, 1.0)) * FREQUENCY
        assert longest == pytest.approx(reach, abs=1e-3)
        assert abs(excess(zeta, longest)) < 0.01
        assert abs(excess(zeta, 1.2 * longest)) > 0.01
        further = float(of_turning(record, 1.0)) * FREQUENCY
        assert further == pytest.approx(reach * (1.0 + min(1.0, zeta / 0.05) / 3.0), abs=2e-3)
        assert abs(excess(zeta, further)) < 0.125
    record["state_damping"] = 0.0
    assert longest_taut_step(record, 1.0) * FREQUENCY == pytest.approx(UNDAMPED_REACH, rel=1e-15)
    assert of_turning(record, 1.0) == longest_taut_step(record, 1.0)
    record["state_damping"] = 100.0
    assert longest_taut_step(record, 1.0) * FREQUENCY == DAMPED_REACH
