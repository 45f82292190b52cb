"""A line of lumped nodes that breaks in one of its pieces, or is cut at the chaser: what is conserved, and where."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

import numpy as np
import pytest

from tests.plain import PlainInstance, plain
from tests.tethered_deorbit import lumped as pair
from tests.tethered_deorbit.lumped import Floats, apart, lumped

__all__ = ["plain"]

pytestmark = pytest.mark.usefixtures("plain")
STRENGTH, CUT = 1.3, 0.31
START = apart(11.95, 0.3, 0.6, 0.1)


def parting(values: Mapping[str, Any] = MappingProxyType({}), **terms: str) -> PlainInstance:
    """Three heavy nodes on a line that is about to snap, undamped; the centre of mass moves."""
    return lumped(3, 60e3, {"start_center_velocity": (0.1, 0.0, 0.0)} | dict(values) | START, **terms)


def momentum_before(i: PlainInstance, piece: int) -> Floats:
    """Of the chaser and the nodes up to a piece [kg m/s]."""
    state, (_, rates) = pair.state_of(i), pair.nodes_of(i)
    share = pair.CHASER / (pair.CHASER + pair.TARGET)
    target = state[3:6] + share * state[9:12]
    node = i["lumped.mass"] / 3
    found: Floats = pair.CHASER * (target - state[9:12]) + node * (target + rates[: piece - 1]).sum(axis=0)
    return found


def held_to(i: PlainInstance, linear: Floats, angular: Floats, energy: float) -> None:
    """Momenta to 1e-12, energy to 1e-9 with what the parted piece had stored."""
    after, turned = pair.momenta(i)
    assert np.abs(after - linear).max() <= 1e-12 * np.abs(linear).max()
    assert np.abs(turned - angular).max() <= 1e-12 * np.abs(angular).max()
    assert i["energy.relative"] + i["lumped.parted_energy"] == pytest.approx(energy, rel=1e-9)


def test_the_piece_that_bears_most_breaks() -> None:
    """Where and when a whole line of the same motion first pulls that hard; then each side keeps its momentum."""
    i = parting({"break.strength": STRENGTH}, **{"break": "breaks"})
    book = (*pair.momenta(i), i["energy.relative"])
    i.step(0.6)
    assert i["break.broken"]
    piece, when = int(i["lumped.parted_piece"]), i["break.time"]
    whole = parting()
    whole.step(when)
    assert whole["lumped.most_tension"] == pytest.approx(STRENGTH, rel=1e-6)
    assert whole["lumped.most_piece"] == piece
    stretch = (STRENGTH / (4.0 * pair.AXIAL / pair.LENGTH)) ** 2 * 2.0 * pair.AXIAL / pair.LENGTH
    assert i["lumped.parted_energy"] == pytest.approx(stretch, rel=1e-5)
    held_to(i, *book)
    before, first = momentum_before(i, piece), i["tether.tension"]
    i.step(0.3)
    assert momentum_before(i, piece) == pytest.approx(before, abs=1e-12)
    assert i["tether.tension"] != first
    assert not i["tether.taut"]
    held_to(i, *book)


def test_a_line_that_bears_its_load_stays_whole() -> None:
    i, whole = parting({"break.strength": 50.0}, **{"break": "breaks"}), parting()
    for one in (i, whole):
        one.step(0.3)
    assert (i["break.broken"], i["lumped.parted_piece"], i["lumped.parted_energy"]) == (0, 0, 0.0)
    assert pair.state_of(i) == pytest.approx(pair.state_of(whole), rel=1e-12, abs=1e-13)


def test_a_line_is_cut_at_the_chaser() -> None:
    """The chaser flies straight on, and the nodes stay with the target."""
    i = parting({"release.at": CUT}, release="time")
    book = (*pair.momenta(i), i["energy.relative"])
    i.step(CUT)
    before = momentum_before(i, 1)
    i.step(0.2)
    assert (i["release.released"], i["lumped.parted_piece"], i["tether.tension"]) == (1, 1, 0.0)
    assert i["lumped.parted_energy"] > 0.0
    assert i["lumped.most_tension"] > 0.0
    assert momentum_before(i, 1) == pytest.approx(before, abs=1e-12)
    held_to(i, *book)
