"""Gains by python-control, and what a loop is found to be: against Riccati's equation, eigenvalues, Nyquist's curve."""

import math
from typing import Any

import numpy as np
import pytest

from fmu_src.interface import Undesigned
from fmu_src.tethered_deorbit import design
from fmu_src.tethered_deorbit.asked import EQUILIBRIUM, LQR, POLES, TOWING
from fmu_src.tethered_deorbit.cautions import before
from fmu_src.tethered_deorbit.interface import MODEL

LAWS = ("regulator", "sampled_linear")
KNOWN = [-5.78290, -3.41930, 2.93980, -0.21854]
"""Gains of Table 2's pair about its equilibrium, unit weights, found apart from this project."""
STEP = 30.0


def scene(law: str, **asked: float) -> tuple[dict[str, float], dict[str, float], dict[str, str]]:
    """Values, what is asked of the gains, and terms of Table 2's pair."""
    interface = MODEL.interface({"reel": law, "thrust": "along_track"})
    values = {
        name: float(start)
        for v in interface.variables
        if v.causality in ("parameter", "input")
        for name, start in zip(v.element_names(), v.starts(), strict=True)
    }
    if law == "sampled_linear":
        values["reel.sample_time"] = STEP
    wanted = {
        name: float(start) for v in interface.asked for name, start in zip(v.element_names(), v.starts(), strict=True)
    }
    return values, wanted | {f"reel.{name}": value for name, value in asked.items()}, dict(interface.terms)


def loop(law: str, **asked: float) -> design.Loop:
    values, wanted, terms = scene(law, **asked)
    found = design.loop_of(values | design.designed(values, wanted, terms), terms)
    assert found is not None
    return found


def test_known_gains() -> None:
    found = loop("regulator", gains=LQR)
    assert found.gain[0] == pytest.approx(KNOWN, abs=1e-4)
    assert math.degrees(found.plant.angle) == pytest.approx(7.40452, abs=1e-4)
    assert found.plant.tension == pytest.approx(0.0258651, abs=1e-7)
    values, asked, terms = scene("regulator", gains=LQR)
    told = design.designed(values, asked, terms)
    # T = k x, in SI: K is in units of m_r l n^2, l and 1/n
    mass, n, length = 2000.0 / 3.0, 1.0381289e-3, 12.0
    assert told["reel.proportional_gain"] == pytest.approx(5.78290 * mass * n * n, rel=1e-5)
    assert told["reel.derivative_gain"] == pytest.approx(3.41930 * mass * n, rel=1e-5)
    assert told["reel.angle_gain"] == pytest.approx(-2.93980 * mass * length * n * n, rel=1e-5)
    assert told["reel.angle_rate_gain"] == pytest.approx(0.21854 * mass * length * n, rel=1e-4)
    twice = loop("regulator", gains=LQR, effort_weight=2.0)
    assert twice.gain[0] != pytest.approx(KNOWN, abs=1e-2)


def test_units_of_a_winch() -> None:
    """a = -k x, in SI: K is in units of l n^2, l and 1/n."""
    values, asked, terms = scene("sampled_linear", gains=LQR)
    told, found = design.designed(values, asked, terms), loop("sampled_linear", gains=LQR)
    n, length = 1.0381289e-3, 12.0
    sizes = (n * n, n, length * n * n, length * n)
    names = design.GAIN_NAMES["sampled_linear"]
    assert [told[name] for name in names] == pytest.approx(
        [k * size for k, size in zip(found.gain[0], sizes, strict=True)], rel=1e-6
    )


def test_given_gains_stay() -> None:
    values, asked, terms = scene("regulator")
    assert design.designed(values, asked, terms) == {}


@pytest.mark.parametrize("about", [EQUILIBRIUM, TOWING])
def test_regulator_solves_riccati(about: int) -> None:
    """K = B'P/r, where A'P + P A - P B B'P/r + Q = 0 has the one P >= 0: found here from the stable subspace."""
    weights = {"length_weight": 2.0, "rate_weight": 0.5, "angle_weight": 3.0, "angle_rate_weight": 0.1}
    found = loop("regulator", gains=LQR, about=about, effort_weight=0.7, **weights)
    a, b = found.plant.matrix, found.plant.drive
    hamilton = np.block([[a, -b @ b.T / 0.7], [-np.diag(list(weights.values())), -a.T]])
    values, vectors = np.linalg.eig(hamilton)
    stable = vectors[:, values.real < 0]
    p = (stable[4:] @ np.linalg.inv(stable[:4])).real
    assert found.gain == pytest.approx(b.T @ p / 0.7, rel=1e-9, abs=1e-9)
    assert found.slowest() < 0.0


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("about", [EQUILIBRIUM, TOWING])
def test_poles_are_where_they_are_asked(law: str, about: int) -> None:
    wanted = [-0.5 + 1j, -0.5 - 1j, -1.0, -2.0]
    asked = {f"poles[{k}]": pole.real for k, pole in enumerate(map(complex, wanted), 1)}
    asked |= {f"poles_imaginary[{k}]": pole.imag for k, pole in enumerate(map(complex, wanted), 1)}
    found = loop(law, gains=POLES, about=about, **asked)
    rate = found.plant.pair.rate
    assert found.poles() / rate == pytest.approx(np.array(wanted), rel=1e-6)


def test_all_poles_in_one_place() -> None:
    found = loop("regulator", gains=POLES, **{f"poles[{k}]": -1.0 for k in range(1, 5)})
    a, b = found.plant.matrix, found.plant.drive
    # (s + 1)^4
    assert np.poly(a - b @ found.gain) == pytest.approx([1, 4, 6, 4, 1], rel=1e-6)


def test_sampled_plant() -> None:
    """A and B of a sample against many small steps of the plant with its input held."""
    found = loop("sampled_linear", gains=LQR)
    small, drive = found.plant.matrix.copy(), np.array([0.0, 1.0, 0.0, 0.0])
    small[1] = 0.0
    steps, h = 20000, STEP * found.plant.pair.rate
    for state, held in ((np.array([0.3, -0.2, 0.5, 0.1]), 0.0), (np.zeros(4), 1.0)):
        x = state
        for _ in range(steps):
            middle = x + 0.5 * h / steps * (small @ x + drive * held)
            x = x + h / steps * (small @ middle + drive * held)
        assert found.matrix @ state + found.drive[:, 0] * held == pytest.approx(x, abs=1e-9)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("about", [EQUILIBRIUM, TOWING])
def test_margins(law: str, about: int) -> None:
    """Gains times the factors stand on the edge of stability; so does a loop that is turned by the phase margin."""
    found = loop(law, gains=LQR, about=about)
    values, asked, terms = scene(law, gains=LQR, about=about)
    told = {row.key: row.value for row in design.rows(values | design.designed(values, asked, terms), terms)}

    def edge(factor: float) -> float:
        poles = np.linalg.eigvals(found.matrix - factor * found.drive @ found.gain)
        return float(np.max(poles.real) if found.step is None else np.max(abs(poles)) - 1.0)

    for key in ("reel.gain_margin", "reel.gain_reduction"):
        if key in told:
            assert edge(told[key]) == pytest.approx(0.0, abs=1e-6)
            assert (edge(told[key] * 1.01) > 0.0) == (key == "reel.gain_margin")
            assert (edge(told[key] * 0.99) > 0.0) == (key == "reel.gain_reduction")
    assert ("reel.gain_margin" in told) == (law == "sampled_linear")
    turns = np.concatenate([np.linspace(1e-3, 10.0, 400001), np.linspace(10.0, 200.0, 100001)])

    def response(w: Any) -> complex:
        s = 1j * w if found.step is None else np.exp(1j * w * found.step * found.plant.pair.rate)
        return complex((found.gain @ np.linalg.solve(s * np.eye(4) - found.matrix, found.drive))[0, 0])

    coarse = turns[::50]
    curve = np.array([response(w) for w in coarse])
    crossing = np.nonzero(np.diff(np.sign(abs(curve) - 1.0)))[0]
    margins = [abs(math.pi - abs(float(np.angle(curve[k])))) for k in crossing]
    assert told["reel.phase_margin"] == pytest.approx(min(margins), rel=2e-2)


def test_what_cannot_be_designed() -> None:
    values, asked, terms = scene("regulator", gains=LQR)
    with pytest.raises(Undesigned, match=r"reel\.about.*3 n\^2 l m_c = 0\.0776 N.*towing"):
        design.designed(values | {"thrust.level": -0.1}, asked, terms)
    with pytest.raises(Undesigned, match=r"reel\.about = towing: needs a thrust"):
        design.designed(values | {"thrust.level": 0.0}, asked | {"reel.about": TOWING}, terms)
    with pytest.raises(Undesigned, match=r"reel\.gains = lqr: needs an orbit"):
        design.designed({k: v for k, v in values.items() if k != "orbit.altitude"}, asked, terms)
    with pytest.raises(Undesigned, match=r"reel\.poles_imaginary = \[1, 0, 0, 0\].*conjugate"):
        design.designed(values, asked | {"reel.gains": POLES, "reel.poles_imaginary[1]": 1.0}, terms)


def test_towing_has_a_tension_of_its_own() -> None:
    """Along the track the line pulls by the thrust alone, m_r F/m_c, and the bias makes the difference good."""
    values, asked, terms = scene("regulator", gains=LQR, about=TOWING)
    found = design.designed(values, asked, terms)
    tide = 3.0 * 1.0381289e-3**2 * 2000.0 / 3.0 * 12.0
    assert found["reel.bias"] + tide == pytest.approx(2000.0 / 3.0 * 5e-6, rel=1e-6)
    assert found["reel.angle"] == pytest.approx(0.5 * math.pi)


def test_a_loop_is_designed_for_the_thrust_there_is() -> None:
    """-0.01 N asked of an electric engine whose power makes a quarter of it: rest, gains and loop are those of that
    thrust, and the scene is told; of one with power enough nothing changes."""
    values, asked, terms = scene("regulator", gains=LQR, about=TOWING)
    power = 0.0025 * values["thrust.specific_impulse"] * 9.80665 / (2.0 * 0.6)
    electric = terms | {"engine": "electric"}
    weak = values | {"engine.efficiency": 0.6, "engine.power_limit": power}
    right = design.designed(values | {"thrust.level": -0.0025}, asked, terms)
    assert design.designed(weak, asked, electric) == pytest.approx(right, rel=1e-9)
    assert right["reel.bias"] != pytest.approx(design.designed(values, asked, terms)["reel.bias"], rel=1e-3)
    assert design.designed(weak, asked, terms | {"engine": "chemical"}) == design.designed(values, asked, terms)
    told = [c.sentence for c in before(weak, ("thrust.specific_impulse",), electric) if c.about == "thrust.level"]
    assert told == ["-0.01 N is more than the power allows: 0.0025 N by engine.power_limit"]
    strong = weak | {"engine.power_limit": 5.0 * power}
    assert design.designed(strong, asked, electric) == design.designed(values, asked, terms)
    assert not [c for c in before(strong, ("thrust.specific_impulse",), electric) if c.about == "thrust.level"]


def test_an_unstable_loop_is_told() -> None:
    values, _, terms = scene("regulator")
    told = [c for c in before(values, (), terms) if c.about.startswith("reel.")]
    assert not told
    weak = values | {"reel.proportional_gain": 2.9 * 1.0381289e-3**2 * 2000.0 / 3.0}
    (caution,) = [c for c in before(weak, (), terms) if c.about.startswith("reel.")]
    assert "leaves its rest near the vertical" in caution.sentence
    asked = {f"poles[{k}]": value for k, value in enumerate((0.2, -1.0, -2.0, -3.0), 1)}
    values, wanted, terms = scene("sampled_linear", gains=POLES, **asked)
    (caution,) = [c for c in before(values | design.designed(values, wanted, terms), (), terms) if "pole" in c.sentence]
    assert f"{0.2 * 1.0381289e-3:.3g} /s" in caution.sentence
