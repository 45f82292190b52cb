"""What is drawn at random: between the ends of each value, evenly, and the same every time."""

from __future__ import annotations

import numpy as np
import pytest

from dcone_cosim.cases.alone import Alone
from dcone_cosim.progress import Progress
from dcone_cosim.sizing.ground import Ground
from dcone_cosim.sizing.uncertain import Uncertain, at_random, ends, uncertain

THRUST = Uncertain("a", "thrust", ({"x": -2.0}, {"x": -1.0}), ("-2", "-1"), "")
SPIN = Uncertain("b", "spin", ({"y": 0.0, "z": 1.0}, {"y": 1.0, "z": 3.0}), ("x 0", "x 2"), "")
START = Uncertain("c", "start", ({"s": 0.0}, {"s": 2.0}), ("here", "there"), "", smooth=False)


def test_at_random() -> None:
    found = at_random([THRUST, SPIN, START], 100)
    thrusts = np.sort([one.values["x"] for one in found])
    assert np.all((thrusts >= -2.0) & (thrusts <= -1.0))
    assert np.max(np.diff(thrusts)) <= 0.02, "one in every hundredth"
    assert all(one.values["z"] == pytest.approx(1.0 + 2.0 * one.values["y"]) for one in found), "what goes together"
    assert sum("s" in one.values for one in found) == 50
    assert {one.values.get("s", 2.0) for one in found} == {2.0}
    assert found == at_random([THRUST, SPIN, START], 100)
    assert at_random([THRUST], 0) == []


def test_ends() -> None:
    found = [(sample.label, sample.values) for _, sample in ends([THRUST, START])]
    assert found == [("thrust -2", {"x": -2.0}), ("thrust -1", {"x": -1.0}), ("start there", {"s": 2.0})]


def test_of_table_2() -> None:
    ground = Ground(Alone("table2-deorbit", (), None), Progress())
    found = {one.label: one for one in uncertain(ground, {})}
    assert found["line stiffness E"].ends[0] == pytest.approx({"tether.youngs_modulus": 48e9})
    assert found["separation at the start"].ends[1]["start.separation"] < 12.0, "no start is stretched"
    assert {"start", "who leads"} <= set(found)
    ends = {label: [next(iter(end.values())) for end in one.ends] for label, one in found.items()}
    for label, low, high in (
        ("thrust", -0.009, -0.011), ("line length", 11.76, 12.24), ("line diameter", 0.95e-3, 1.05e-3),
        ("line damping", 0.025, 0.1), ("chaser mass", 1900.0, 2100.0), ("debris mass", 900.0, 1100.0),
        ("separation at the start", 9.0, 11.0),
    ):  # fmt: skip
        assert ends[label] == pytest.approx([low, high]), label
    near = Ground(Alone("table2-deorbit", ("removal.start.separation=11.5 m",), None), Progress())
    far = next(one for one in uncertain(near, {}) if one.key == "start.separation")
    assert far.ends[1]["start.separation"] == pytest.approx(11.988), "as far as the line reaches, nearly"
    told = uncertain(ground, {"removal.tether.diameter": ["0.5 mm", "2 mm"]})
    (own,) = (one for one in told if "tether.diameter" in one.ends[0])
    assert own.ends == ({"tether.diameter": 0.5e-3}, {"tether.diameter": 2e-3})


def test_a_spin_goes_from_none_to_twice() -> None:
    """All of its components together, each by the same share of the scene's."""
    ground = Ground(Alone("tumbling-target", (), None), Progress())
    (spin,) = (one for one in uncertain(ground, {}) if one.label == "debris spin")
    rates = {name: ground.values[name] for name in spin.ends[0]}
    assert any(rates.values())
    assert spin.ends == (dict.fromkeys(rates, 0.0), {name: 2.0 * rate for name, rate in rates.items()})
    assert spin.at(0.5) == pytest.approx(rates)
