"""A winch whose line slips off a corner of the target, or parts: its book of energy closes, and it winds no more."""

from __future__ import annotations

from typing import Any

import pytest

from fmu_src.tethered_deorbit.interface import HANDED_OVER, MODEL
from orbital.oscillators import line_stiffness
from tests.plain import PlainInstance, plain
from tests.validation import Validated, closed_form

__all__ = ["plain"]
pytestmark = pytest.mark.usefixtures("plain")
ROUND_A_BOX: dict[str, Any] = {
    "start.condition": HANDED_OVER,
    "start_relative_position": (0.0, 12.0, 0.0),
    "start_relative_velocity": (0.0, 0.02, 0.0),
    "target_size": (2.5, 3.9, 2.2),
    "target_inertia": (1671.0, 924.0, 1788.0, 0.0, 0.0, 0.0),
    "tether.rest_length": 14.0,
    "tether.youngs_modulus": 6e9,
    "reel.held_tension": 2.0,
    "reel.sample_time": 0.1,
    "reel.take_up": 0.05,
}
SLIPS = {"target_attachment": (0.12, 1.95, -1.04), "target_start_rate": (0.067, -0.081, 0.087)}
MEETS_AN_EDGE = {"target_attachment": (-0.597, 1.95, -0.9345), "target_start_rate": (-0.1597, 0.0559, -0.101)}


def winch(values: dict[str, Any], **terms: str) -> PlainInstance:
    chosen = {"reel": "constant_tension", "environment": "none", "target": "box", **terms}
    return PlainInstance(MODEL, chosen, ROUND_A_BOX | values)


@pytest.mark.parametrize("zeta", [0.05, 1.0])
def test_the_book_of_a_line_that_slips(validated: Validated, zeta: float) -> None:
    """Off the corner it is shorter at once. The work of the motor is what pair and line gain, the dashpot takes and
    slipping loses: once each, also of a line damped so hard that it pulls no more while it is still stretched."""
    i = winch(SLIPS | {"tether.damping_ratio": zeta})
    before, shorter = i["energy.relative"], 0.0
    for _ in range(14):
        last = i["tether.length"]
        i.step(0.5)
        shorter = max(shorter, last - i["tether.length"])
    lost = i["tether.heat"] + i["tether.slip_loss"]
    assert shorter > 0.02
    assert i["tether.slip_loss"] > 1e-3
    book, gained = closed_form("what pair and line gain, dashpot and slips take"), i["energy.relative"] - before
    what = "winch whose line slips off a corner of a box: work of its motor"
    validated(book, what, i["reel.work"], gained + lost, "J", abs=1e-5 * lost)


def test_what_slipping_loses_is_no_matter_of_macro_steps() -> None:
    """An edge that the line comes over within a macro step, while the motor winds: the loss goes by the length that is
    wound out just then."""
    losses = []
    for step, count in ((0.5, 2), (0.05, 20)):
        i = winch(MEETS_AN_EDGE)
        for _ in range(count):
            i.step(step)
        losses.append(i["tether.slip_loss"])
    assert losses[0] == losses[1] < 1e-6


def test_a_winch_winds_no_line_that_has_parted() -> None:
    """Cut after 2 s: the motor comes to rest, follows nothing, and no limit is met any more."""
    base = {name: value for name, value in ROUND_A_BOX.items() if not name.startswith("target")}
    receding = {"start_relative_velocity": (0.0, 0.3, 0.0), "start_relative_position": (0.0, 13.9, 0.0)}
    terms = {"reel": "constant_tension", "environment": "none", "release": "time"}
    i = PlainInstance(MODEL, terms, base | receding | {"release.at": 2.0})
    i.step(1.95)
    assert i["reel.rate"] > 0.1
    assert i["tether.taut"]
    limited = i["reel.limited"]
    i.step(5.0)
    wound = i["reel.paid_out"]
    assert i["reel.rate"] == pytest.approx(0.0, abs=1e-12)
    i.step(60.0)
    assert (i["reel.paid_out"], i["reel.rate"]) == pytest.approx((wound, 0.0), abs=1e-12)
    assert i["reel.limited"] == limited
    assert i["tether.length"] > wound + 10.0


def test_a_cut_line_gives_what_it_had_stored() -> None:
    """Round a corner, under a pull: the stretch of its way round the box counts, not that of the straight way which it
    is told to go from then on."""
    far = {"target_attachment": (0.3, 1.95, 0.2), "target_start_rate": (0.0, 0.0, 0.0), "tether.damping_ratio": 0.0}
    slack = winch(far | {"tether.rest_length": 100.0})
    rest = slack["tether.length"] - 5e-4
    assert slack["tether.wrapped"] > 1.0
    cut = {"tether.rest_length": rest, "release.at": 0.05, "reel.sample_time": 10.0}
    i = winch(far | cut, release="time")
    i.step(0.04999)
    stretch = i["tether.length"] - i["reel.paid_out"]
    stored = 0.5 * line_stiffness(6e9, 1e-3, rest) * stretch * stretch
    heat = i["tether.heat"]
    assert stored > 1e-5
    i.step(0.05)
    assert i["tether.wrapped"] == 0.0
    assert i["tether.heat"] - heat == pytest.approx(stored, rel=1e-2)
