"""The controller by itself: its law, moving inputs, derivatives, refusals, and where its default gains come from."""

import math

import control
import numpy as np
import pytest

from fmu_src.instance import Instance, ModelFault
from fmu_src.reel_control.interface import (
    BAD_PARAMETER,
    DAMPING,
    FEED_FORWARD,
    MODEL,
    NO_COMMAND,
    NOT_FINITE,
    STIFFNESS,
)
from fmu_src.tethered_deorbit.reel_rows import REEL_DAMPING, REEL_STIFFNESS
from orbital.constants import EARTH_EQUATORIAL_RADIUS, EARTH_MU
from orbital.references import equilibrium_tension
from tests.validation import Validated, closed_form, other_code

RATE = math.sqrt(EARTH_MU / (EARTH_EQUATORIAL_RADIUS + 800e3) ** 3)
REDUCED = 2000.0 / 3.0


def controller(length: float = 0.0, length_rate: float = 0.0, **parameters: float) -> Instance:
    i = Instance(MODEL, {}, {k.replace("__", "."): v for k, v in parameters.items()})
    i["length"], i["length_rate"] = length, length_rate
    return i.initialise()


def test_law() -> None:
    i = controller(12.4, 0.003)
    expected = FEED_FORWARD + STIFFNESS * 0.4 + DAMPING * 0.003
    assert i["tension"] == pytest.approx(expected, rel=1e-14)
    assert controller(12.4, -0.003)["tension"] != pytest.approx(expected, rel=1e-3)
    assert controller()["tension"] == 0.0  # nothing asked
    assert controller(12.0, -0.1)["tension"] == 0.0  # a line never pushes
    other = controller(20.0, 0.0, reel__length=19.0, gain__proportional=2.0, feed_forward=0.5)
    assert other["tension"] == pytest.approx(2.5, rel=1e-14)


def test_an_output_follows_its_inputs_at_once() -> None:
    i = controller(12.0)
    i["length"] = 12.5
    assert i["tension"] == pytest.approx(FEED_FORWARD, rel=1e-14)
    i.refresh()
    assert i["tension"] == pytest.approx(FEED_FORWARD + 0.5 * STIFFNESS, rel=1e-14)
    i.step(10.0)
    assert i["tension"] == pytest.approx(FEED_FORWARD + 0.5 * STIFFNESS, rel=1e-14)


def test_moving_inputs() -> None:
    """The tension after a step is that of the inputs at its end, and its derivative that of the step."""
    i = controller(12.0)
    rates = {"length": 0.01, "length_rate": 2e-4}
    i.set_rates(rates)
    i.step(20.0)
    assert (i["length"], i["length_rate"]) == pytest.approx((12.2, 4e-3), rel=1e-14)
    assert i["tension"] == pytest.approx(FEED_FORWARD + 0.2 * STIFFNESS + 4e-3 * DAMPING, rel=1e-13)
    before = i["tension"]
    i.differentiate()
    slope = i.rate("tension")
    i["length"] = 12.2 + 1e-9
    i.differentiate()
    assert i.rate("tension") == pytest.approx(2e-4 * DAMPING, rel=1e-14)  # the other input still goes on
    i["length"] = 12.2
    i.set_rates(rates)
    i.step(20.0)
    assert slope == pytest.approx((i["tension"] - before) / 20.0, rel=1e-12)
    assert slope != pytest.approx(1.01 * (i["tension"] - before) / 20.0, rel=1e-3)


@pytest.mark.parametrize(("length", "pulls"), [(12.4, True), (2.0, False), (0.0, False)])
def test_derivatives(length: float, pulls: bool) -> None:
    i = controller(length)
    i.differentiate()
    told = [i.partial("tension", name) for name in ("length", "length_rate")]
    assert told == ([STIFFNESS, DAMPING] if pulls else [0.0, 0.0])
    before = i["tension"]
    i["length"], i["length_rate"] = length + 1e-3, 2e-3
    i.refresh()
    change = told[0] * 1e-3 + told[1] * 2e-3
    if length != 0.0:
        assert i["tension"] - before == pytest.approx(change, rel=1e-9, abs=1e-18)


@pytest.mark.parametrize(
    ("code", "name", "value"),
    [
        (BAD_PARAMETER, "reel.length", 0.0),
        (BAD_PARAMETER, "gain.proportional", -1e-3),
        (BAD_PARAMETER, "gain.derivative", math.nan),
        (BAD_PARAMETER, "feed_forward", math.inf),
        (BAD_PARAMETER, "motor.time_constant", 0.0),
        (NOT_FINITE, "length", math.nan),
    ],
)
def test_refusals(code: int, name: str, value: float) -> None:
    terms = {"motor": "lag"} if name.startswith("motor.") else {}
    i = Instance(MODEL, terms, {"length": 12.0, name: value})
    with pytest.raises(ModelFault, match=name.replace(".", r"\.")):
        i.initialise()
    assert i.record["fault_code"][0] == code
    i[name] = 12.0
    assert math.isfinite(i.initialise()["tension"])
    with pytest.raises(ModelFault, match="no such command"):
        i._call(9, 0.0, 0.0)
    assert {NO_COMMAND, BAD_PARAMETER, NOT_FINITE} == {f.code for f in MODEL.faults}


def regulator(thrust: float = -0.01) -> np.ndarray:
    """Gains of the quadratic regulator about the tow's equilibrium, state (l, l', phi, phi') in units l0 and 1/n.

    l''   = l ((1 + phi')^2 - 1 + 3 cos^2 phi) + f sin phi - u,
    phi'' = -2 (l'/l) (1 + phi') - 3 sin phi cos phi + (f/l) cos phi,   f = -F/(m_c n^2 l0) = 3 sin phi_0

    linear about l = 1, phi = phi_0; u the tension over m_r n^2 l0, beyond that at rest.
    """
    s = -thrust / (3.0 * 2000.0 * RATE**2 * 12.0)
    c = math.sqrt(1.0 - s * s)
    a = np.array(
        [
            [0.0, 1.0, 0.0, 0.0],
            [3.0 * c * c, 0.0, -3.0 * s * c, 2.0],
            [0.0, 0.0, 0.0, 1.0],
            [-3.0 * s * c, -2.0, -3.0 * c * c, 0.0],
        ]
    )
    b = np.array([[0.0], [-1.0], [0.0], [0.0]])
    gains, _, _ = control.lqr(a, b, np.eye(4), np.eye(1))
    return np.asarray(gains)[0]


def test_default_gains_are_the_regulators(validated: Validated) -> None:
    """Those on length and rate; its other two gains a reel can not have. Without thrust the gains are others."""
    gains = regulator()
    riccati = other_code("linear-quadratic regulator by python-control")
    # see fmu_src/reel_control/README.md
    validated(riccati, "regulator of the reel: gains K", [-5.78290, -3.41930, 2.93980, -0.21854], gains, abs=1e-4)
    scale = REDUCED * RATE
    validated(riccati, "reel: default gain on the length", STIFFNESS, -gains[0] * scale * RATE, "N/m", rel=2e-4)
    validated(riccati, "reel: default gain on its rate", DAMPING, -gains[1] * scale, "N s/m", rel=2e-4)
    assert pytest.approx(-regulator(0.0)[0] * scale * RATE, rel=2e-4) != STIFFNESS
    assert (STIFFNESS, DAMPING) == (REEL_STIFFNESS, REEL_DAMPING)
    assert pytest.approx(equilibrium_tension(RATE, 12.0, REDUCED), rel=1e-12) == FEED_FORWARD


def lagging(length: float, length_rate: float, time_constant: float) -> Instance:
    i = Instance(MODEL, {"motor": "lag"}, {"motor.time_constant": time_constant})
    i["length"], i["length_rate"] = length, length_rate
    return i.initialise()


def asked(length: float, length_rate: float) -> float:
    return max(0.0, FEED_FORWARD + STIFFNESS * (length - 12.0) + DAMPING * length_rate)


def test_a_motor_follows_held_inputs(validated: Validated) -> None:
    """A step response: what is left of the jump decays as exp(-t / tau), whatever the steps."""
    i = lagging(12.0, 0.0, 5.0)
    assert i["tension"] == pytest.approx(asked(12.0, 0.0), rel=1e-14)
    i["length_rate"] = 0.01
    i.refresh()
    assert i["tension"] == pytest.approx(asked(12.0, 0.0), rel=1e-14), "a motor does not jump"
    i.differentiate()
    assert i.rate("tension") == pytest.approx(DAMPING * 0.01 / 5.0, rel=1e-12)
    assert i.partial("tension", "length_rate") == 0.0
    for size in (1.0, 2.0, 4.0):
        i.step(size)
    expected = asked(12.0, 0.01) - DAMPING * 0.01 * math.exp(-7.0 / 5.0)
    formula = closed_form("1 - exp(-t/tau)")
    validated(formula, "motor of a reel: step response after 7 s", i["tension"], expected, "N", rel=1e-13)
    assert i["tension"] != pytest.approx(asked(12.0, 0.01) - DAMPING * 0.01 * math.exp(-7.0 / 5.05), rel=1e-4)


@pytest.mark.parametrize(("begin", "drift"), [(0.01, -0.004), (-0.03, 0.008), (0.0, 0.002), (-0.02, -0.001)])
def test_a_motor_follows_moving_inputs(begin: float, drift: float) -> None:
    """Against many held steps, also where what is asked comes to zero or leaves it within the step."""
    ramp = lagging(12.0, begin, 3.0)
    ramp.set_rates({"length_rate": drift})
    ramp.step(8.0)
    count = 4000
    held = lagging(12.0, begin, 3.0)
    for k in range(count):
        held["length_rate"] = begin + drift * (k + 0.5) * 8.0 / count
        held.step(8.0 / count)
    assert ramp["tension"] == pytest.approx(held["tension"], abs=1e-7)
    twin = lagging(12.0, begin, 3.0)
    twin.set_rates({"length_rate": 1.01 * drift})
    twin.step(8.0)
    both_slack = asked(12.0, begin) == asked(12.0, begin + drift * 8.0) == 0.0
    assert both_slack or twin["tension"] != pytest.approx(held["tension"], abs=1e-6)


def test_a_motor_is_asked_for_nothing_while_no_length_is_measured() -> None:
    """However fast the line is said to lengthen; once there is a length, it follows."""
    i = Instance(MODEL, {"motor": "lag"}, {"length_rate": 1.0}).initialise()
    i.step(1.0)
    assert i["tension"] == 0.0
    i["length"] = 12.0
    i.step(1.0)
    assert i["tension"] > 0.0
