"""A removal whose reel is told its tension by the controller, against the removal with the same law inside."""

import numpy as np
import pytest

from fmu_src.instance import Instance
from fmu_src.reel_control.interface import MODEL as CONTROL
from fmu_src.tethered_deorbit.interface import HANDED_OVER
from fmu_src.tethered_deorbit.interface import MODEL as REMOVAL

START = {"start.condition": HANDED_OVER, "thrust.level": -0.01}
GAINS = {"reel.proportional_gain": 0.02, "reel.derivative_gain": 4.0}
END = 640.0


def removal(reel: str, parameters: dict[str, float]) -> Instance:
    i = Instance(REMOVAL, {"reel": reel, "thrust": "along_track"}, START | parameters)
    i.array("start_relative_position")[:] = 12.5, 1.0, 0.0
    return i


def coupled(step: float, ramp: bool, derivative_gain: float = 4.0) -> float:
    """Length at the end; the controller sees the line and says a tension, held or moving over the coupling step."""
    control = Instance(CONTROL, {}, {"gain.proportional": 0.02, "gain.derivative": derivative_gain}).initialise()
    line = removal("commanded", {}).initialise()
    for _ in range(round(END / step)):
        # twice: the rate of the line's rate depends on the tension, which is only known then
        for _ in range(2):
            control["length"], control["length_rate"] = line["tether.length"], line["tether.length_rate"]
            control.refresh()
            line["reel.tension"] = control["tension"]
            line.differentiate()
        if ramp:
            control.set_rates({"length": line.rate("tether.length"), "length_rate": line.rate("tether.length_rate")})
            control.differentiate()
            line.set_rates({"reel.tension": control.rate("tension")})
        line.step(step)
        control.step(step)
    assert line["tether.tug_count"] == 1
    return line["tether.length"]


@pytest.fixture(scope="module")
def inside() -> float:
    line = removal("linear", GAINS).initialise()
    line.step(END)
    assert line["tether.tug_count"] == 1
    return line["tether.length"]


@pytest.mark.parametrize(("ramp", "order", "size"), [(False, 1.0, 2e-2), (True, 2.0, 2e-3)])
def test_coupled_comes_to_the_law_inside(inside: float, ramp: bool, order: float, size: float) -> None:
    """Error against coupling step: order 1 with the tension held, order 2 with it moving at its rate."""
    steps = [16.0, 8.0, 4.0, 2.0]
    errors = [abs(coupled(step, ramp) - inside) for step in steps]
    slope = float(np.polyfit(np.log(steps), np.log(errors), 1)[0])
    assert slope == pytest.approx(order, abs=0.1)
    assert errors[-1] < size


def test_another_law_does_not(inside: float) -> None:
    """Twin: a gain 1 % off shows at a step at which the right one agrees."""
    wrong, right = (abs(coupled(2.0, True, gain) - inside) for gain in (4.04, 4.0))
    assert wrong > 5.0 * right
