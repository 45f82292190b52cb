"""A line of lumped nodes made fast to bodies that turn: what is conserved, and that they are turned by it."""

import numpy as np
import pytest

from fmu_src.tethered_deorbit.node_rows import AS_NODE
from tests.plain import plain
from tests.tethered_deorbit import lumped as pair
from tests.tethered_deorbit.lumped import apart, lumped

__all__ = ["plain"]

pytestmark = pytest.mark.usefixtures("plain")
HEAVY = 60e3
TARGET = {
    "target_inertia": (8.0, 5.0, 7.0, 0.5, 0.2, -0.3),
    "target_attachment": (0.6, -0.8, 0.3),
    "target_start_rate": (0.1, 0.05, -0.2),
}
CHASER = {"chaser_inertia": (9.0, 12.0, 14.0, 0.0, 0.0, 0.0), "chaser_attachment": (0.2, 0.5, 0.0)}


@pytest.mark.parametrize(
    ("terms", "values", "distance"),
    [
        pytest.param({"target": "rigid"}, TARGET, 12.4, marks=pytest.mark.evidence),
        ({"target": "rigid", "chaser": "rigid"}, TARGET | CHASER, 12.9),
    ],
    ids=["target", "both"],
)
def test_momentum_and_energy(terms: dict[str, str], values: dict[str, object], distance: float) -> None:
    """Through a tug both momenta stay to 1e-12, spins included, energy and heat to 1e-6; the spin has changed."""
    own = {"tether.damping_ratio": 0.1, "lumped.damped_as": AS_NODE}
    i = lumped(2, HEAVY, own | values | apart(distance, 0.2, 0.6, 0.1), **terms)
    linear, angular = pair.momenta(i)
    spin = np.array([i[f"target.spin[{axis}]"] for axis in (1, 2, 3)])
    energy = i["energy.relative"]
    i.step(1.25)
    assert i["tug[1].peak"] > 0.5
    after, turned = pair.momenta(i)
    assert np.abs(after - linear).max() <= 1e-12 * pair.TARGET
    assert np.abs(turned - angular).max() <= 1e-12 * np.abs(angular).max()
    assert i["energy.relative"] + i["lumped.heat"] == pytest.approx(energy, rel=1e-6)
    assert np.abs([i[f"target.spin[{axis}]"] for axis in (1, 2, 3)] - spin).max() > 0.1


def test_the_straight_line_is_that_between_the_attachments() -> None:
    """Taut at the start: the nodes lie evenly between the attachments, and both ends pull alike."""
    i = lumped(3, HEAVY, TARGET | CHASER | apart(14.5, 0.0, 0.0, 0.0), target="rigid", chaser="rigid")
    places, _ = pair.nodes_of(i)
    target = np.array(TARGET["target_attachment"])
    chaser = np.array(CHASER["chaser_attachment"]) - [0.0, 14.5, 0.0]
    shares = np.array([0.75, 0.5, 0.25])[:, None]
    assert places == pytest.approx(target + shares * (chaser - target), abs=1e-12)
    length = np.linalg.norm(target - chaser)
    assert i["tether.length"] == pytest.approx(length)
    assert i["tether.tension"] == pytest.approx(pair.AXIAL * (length / 12.0 - 1.0))
    assert i["lumped.target_tension"] == pytest.approx(i["tether.tension"])


def test_outputs_have_their_derivatives() -> None:
    own = {"tether.damping_ratio": 0.05, "lumped.damped_as": AS_NODE}
    values = own | TARGET | CHASER | apart(14.0, 0.1, 0.1, 0.0)
    i = lumped(2, HEAVY, values, target="rigid", chaser="rigid")
    names = ("tether.tension", "lumped.heat", "energy.relative", "tether.length_rate")
    i.step(0.1)
    before, h = {name: i[name] for name in names}, 1e-4
    i.step(h)
    i.differentiate()
    rates = {name: i.rate(name) for name in names}
    i.step(h)
    for name in names:
        assert rates[name] == pytest.approx((i[name] - before[name]) / (2.0 * h), rel=1e-4, abs=1e-6)
