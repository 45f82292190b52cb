"""Rates and partial derivatives of the outputs against differences, for every output that has them."""

from typing import Any

import numpy as np
import pytest

from fmu_src.instance import Instance
from fmu_src.tethered_deorbit.interface import HANDED_OVER, MODEL

CASES: dict[str, tuple[dict[str, float], dict[str, float]]] = {
    "locked": ({"reel.length_offset": -1e-4, "thrust.offset": 2e-3}, {"reel.length_offset": -1e-3}),
    "linear": ({"reel.length_offset": -2e-3, "thrust.offset": 2e-3}, {"reel.length_offset": -0.2}),
    "commanded": ({"reel.tension": 5e-3, "thrust.offset": 2e-3}, {"reel.tension": 0.2}),
}
"""Per law: how the inputs move, and where they stand before."""
LENGTH = {"locked": "tether.rest_length", "linear": "reel.length"}
STEP = 0.02
CHANGING = ("tether.tension", "tether.length_rate", "chaser.velocity[1]", "relative.velocity[2]", "energy.relative")
"""Outputs whose rate is far above what a difference can tell."""


def swinging(reel: str, thrust: str = "along_track", attached: float = 0.0) -> Instance:
    """A taut line, aslant and out of the plane, on an ellipse, all its inputs moving."""
    parameters = {"start.condition": HANDED_OVER, "orbit.eccentricity": 0.05, "orbit.true_anomaly": 1.0}
    parameters["target.attachment_distance"] = attached
    parameters |= {LENGTH[reel]: 12.0 - attached} if reel in LENGTH else {}
    i = Instance(MODEL, {"reel": reel, "thrust": thrust}, parameters | {"thrust.level": -0.5})
    i.array("start_relative_position")[:] = 8.0, 8.5, 3.0
    i.array("start_relative_velocity")[:] = 0.01, -0.01, 0.02
    for name, value in CASES[reel][1].items():
        i[name] = value
    i.initialise()
    return i


def go(i: Instance, reel: str) -> None:
    i.set_rates(CASES[reel][0])
    i.step(STEP)


def values(i: Instance) -> dict[str, float]:
    names = [(n, v) for n, _, v, _ in i.interface.scalars() if v.causality == "output" and v.rate]
    return {name: i[name] for name, _ in names}


@pytest.mark.parametrize("attached", [0.0, 1.0])
@pytest.mark.parametrize("reel", CASES)
def test_rates(reel: str, attached: float) -> None:
    """Differences of fourth order over four steps, in all of which the inputs move alike.

    They can tell rounding of the value over the step, and no more. The rate of relative.position lacks the turning of
    the orbital plane, 1e-8 m/s here.
    """
    i = swinging(reel, attached=attached)
    i.step(0.5)
    seen = []
    rates: dict[str, float] = {}
    for k in range(5):
        go(i, reel)
        assert i["tether.taut"]
        seen.append(values(i))
        if k == 2:
            i.differentiate()
            rates = {name: i.rate(name) for name in seen[0]}
    assert len(rates) > 35
    for name, rate in rates.items():
        v = [s[name] for s in seen]
        difference = (v[0] - 8.0 * v[1] + 8.0 * v[3] - v[4]) / (12.0 * STEP)
        noise = 1e-15 * max(abs(x) for x in v) / STEP * (30.0 if name.startswith(("energy", "center.semi")) else 3.0)
        floor = 2e-8 if name.startswith(("relative.pos", "tether.angle")) else 1e-12
        allowed = 2e-6 * abs(rate) + noise + floor
        assert difference == pytest.approx(rate, abs=allowed), name
        if name in CHANGING:
            assert difference != pytest.approx(1.01 * rate, abs=allowed), name


@pytest.mark.parametrize("attached", [0.0, 1.0])
@pytest.mark.parametrize("reel", CASES)
def test_partials(reel: str, attached: float) -> None:
    """Differences by the input at a standing state, through what a tool sees after it has set the input."""
    i = swinging(reel, attached=attached)
    i.step(0.5)
    (name,) = CASES[reel][1]
    size = {"locked": 1e-7, "linear": 1e-3, "commanded": 1e-3}[reel]
    i.differentiate()
    value, told = i[name], {}
    pairs = [v.name for v in i.interface.variables if v.partials and v.kind == "Real"]
    assert pairs == (["tether.tension"] if reel == "commanded" else ["tether.tension", "energy.relative"])
    for output in pairs:
        told[output] = i.partial(output, name)
    before = {n: i[n] for n in i.interface.references if n not in CASES[reel][0]}
    seen: list[dict[str, float]] = []
    for sign in (-1.0, 1.0):
        i[name] = value + sign * size
        i.refresh()
        seen.append({n: i[n] for n in before})
    i[name] = value
    i.refresh()
    assert {n: i[n] for n in before} == before
    for output in before:
        difference = (seen[1][output] - seen[0][output]) / (2.0 * size)
        if output in told:
            assert difference == pytest.approx(told[output], rel=1e-5), output
            assert difference != pytest.approx(1.01 * told[output], rel=1e-5), output
        else:
            assert difference == 0.0, output


def test_slack_lines_have_no_derivative() -> None:
    i = Instance(MODEL, {"reel": "locked", "thrust": "along_track"}).initialise()
    i.step(10.0)
    i.differentiate()
    assert (i["tether.taut"], i.rate("tether.tension"), i.partial("tether.tension", "reel.length_offset")) == (0, 0, 0)
    assert i.rate("chaser.propellant") == pytest.approx(0.01 / (3000.0 * 9.80665), rel=1e-14)


def test_asking_changes_nothing() -> None:
    """A run in which derivatives are asked for, and outputs after changed inputs, is the same to the last bit."""

    def run(asking: bool) -> Any:
        i = swinging("locked")
        for k in range(6):
            i.set_rates(CASES["locked"][0] if k % 2 else {})
            i.step(0.7)
            if asking:
                i.differentiate()
                kept = i["reel.length_offset"]
                i["reel.length_offset"] = 0.5
                i.refresh()
                i.differentiate()
                assert i["tether.taut"] == 0
                i["reel.length_offset"] = kept
                i.refresh()
        return [i.record[v.field].tobytes() for v in i.interface.variables if v.causality == "output"]

    assert run(True) == run(False)


def test_derivatives_ahead_of_a_step() -> None:
    """Once rates are told for the next step, the derivatives are those of its begin."""
    i = swinging("commanded")
    i.step(0.5)
    i.differentiate()
    assert i.rate("tether.tension") == 0.0
    i.set_rates({"reel.tension": 7e-3})
    i.differentiate()
    assert i.rate("tether.tension") == 7e-3
    i.step(1.0)
    i.differentiate()
    assert i.rate("tether.tension") == 7e-3  # as the step ended
    i["reel.tension"] = 0.3
    i.differentiate()
    assert i.rate("tether.tension") == 0.0
    assert np.isfinite([i.rate(n) for n in values(i)]).all()
