"""A closed net in series with a massless line: springs in series, its first tug, what moves it, what is told of it."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from fmu_src.tethered_deorbit.implied import rows
from fmu_src.tethered_deorbit.interface import MODEL
from fmu_src.tethered_deorbit.model import make_entry
from orbital import oscillators
from tests.plain import PlainInstance, plain
from tests.tethered_deorbit import lumped as pair
from tests.validation import Validated, closed_form

__all__ = ["plain"]

pytestmark = pytest.mark.usefixtures("plain")
TERMS = {"reel": "locked", "environment": "none"}
IN_SERIES = TERMS | {"net": "series"}
COMPLIANCE, SPEED = 0.3, 0.2
LINE = pair.AXIAL / pair.LENGTH
"""Stiffness of the line alone [N/m]."""
BOTH = 1.0 / (1.0 / LINE + COMPLIANCE)
HALF = math.pi * math.sqrt(pair.REDUCED / BOTH)
"""Half a period of the pair on line and net [s]."""


def parting(values: dict[str, Any] | None = None, terms: dict[str, str] = IN_SERIES) -> PlainInstance:
    """The pair as its line gets tight, parting at `SPEED`."""
    net = {"net.compliance": COMPLIANCE} if "net" in terms else {}
    own = pair.apart(pair.LENGTH, 0.0, SPEED, 0.0)
    return PlainInstance(MODEL, terms, pair.VALUES | net | own | (values or {}))


def test_the_first_tug_is_that_of_springs_in_series(validated: Validated) -> None:
    """v sqrt(k m_r) over half a period pi sqrt(m_r/k), 1/k = l/EA + C, and the stretch is T/k; without damping."""
    i = parting()
    i.step(0.5 * HALF)
    expected = SPEED * math.sqrt(BOTH * pair.REDUCED)
    law = closed_form("v sqrt(k m_r), 1/k = l/EA + C")
    validated(law, "a net in series with the line: peak of a tug", i["tug[1].peak"], expected, "N", rel=1e-6)
    assert expected < 0.7 * SPEED * math.sqrt(LINE * pair.REDUCED)
    assert i["tether.length"] - pair.LENGTH == pytest.approx(expected / BOTH, rel=1e-6)
    assert i["energy.relative"] == pytest.approx(0.5 * pair.REDUCED * SPEED**2, rel=1e-9)
    i.step(0.4999 * HALF)
    assert i["tether.taut"]
    i.step(0.0002 * HALF)
    assert not i["tether.taut"]
    back = pair.LENGTH - i["tether.length"]
    ended = i.time - back / SPEED
    law = closed_form("pi sqrt(m_r/k), 1/k = l/EA + C")
    validated(law, "a net in series with the line: how long a tug lasts", ended, HALF, "s", rel=1e-6)


def test_a_net_that_does_not_give_is_none() -> None:
    """Zero compliance: the same bits as without."""
    rigid, none = parting({"net.compliance": 0.0}), parting(terms=TERMS)
    for one in (rigid, none):
        one.step(1.0)
    for name in ("tug[1].peak", "tether.length", "tether.tension", "energy.relative"):
        assert rigid[name] == none[name] > 0.0


@pytest.mark.parametrize("zeta", [0.05, 0.3])
def test_the_damping_ratio_is_that_of_the_pair_on_line_and_net(zeta: float) -> None:
    i = parting({"tether.damping_ratio": zeta})
    i.step(0.9 * HALF)
    expected = oscillators.damped_snap_peak(SPEED, BOTH, pair.REDUCED, zeta)
    assert i["tug[1].peak"] == pytest.approx(expected, rel=1e-6)


def test_a_line_that_is_hauled_in_keeps_its_book() -> None:
    """The reel's work is (T + T_e^2/(2 EA)) times what is hauled in, and the line left is stiffer, the net is not."""
    rate, span, count = -0.05, 2.0, 100
    i = parting()
    i.step(1.0)
    before, pulls = i["energy.relative"], [i["tether.tension"]]
    for _ in range(count):
        i.set_rates({"reel.length_offset": rate})
        i.step(span / count)
        pulls.append(i["tether.tension"])
    force = np.array(pulls)
    power = -(force + force**2 / (2.0 * pair.AXIAL)) * rate
    work = float(np.sum(0.5 * (power[1:] + power[:-1]))) * span / count
    assert i["energy.relative"] - before == pytest.approx(work, rel=1e-5)
    rest = pair.LENGTH + rate * span
    firm = 1.0 / (rest / pair.AXIAL + COMPLIANCE)
    assert i["tether.tension"] == pytest.approx(firm * (i["tether.length"] - rest), rel=1e-9)


def test_tension_by_the_offset_against_differences() -> None:
    """Partial derivative of a damped line with a net in series."""
    values = {"tether.damping_ratio": 0.2}
    step = 1e-5

    def at(offset: float) -> PlainInstance:
        i = parting(values)
        i.step(1.0)
        i["reel.length_offset"] = offset
        i.refresh()
        return i

    low, middle, high = at(-step), at(0.0), at(step)
    slope = (high["tether.tension"] - low["tether.tension"]) / (2.0 * step)
    middle.differentiate()
    assert middle.partial("tether.tension", "reel.length_offset") == pytest.approx(slope, rel=1e-5)


def test_it_is_told_beforehand() -> None:
    i = parting()
    names = ("chaser.mass", "target.mass", "tether.rest_length", "tether.diameter", "tether.youngs_modulus")
    values = {name: i[name] for name in (*names, "tether.damping_ratio", "net.compliance", "reel.length_offset")}
    told = {row.key: row for row in rows(values, IN_SERIES)}
    assert told["line.stiffness"].value == pytest.approx(BOTH)
    assert "net" in told["line.stiffness"].label
    assert told["line.period"].value == pytest.approx(2.0 * HALF)


@pytest.mark.parametrize("reel", ["linear", "brake", "commanded"])
def test_reels_without_such_a_line_are_refused(reel: str) -> None:
    with pytest.raises(ValueError, match=f"net in series goes with reel = locked, not '{reel}'"):
        make_entry(IN_SERIES | {"reel": reel})
