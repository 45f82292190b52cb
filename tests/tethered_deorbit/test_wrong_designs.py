"""Designs that go wrong, as the model shows them: a chaser that tows from ahead, a dashpot that makes the peak."""

import math
from typing import Any

import pytest

from fmu_src.instance import ModelFault
from fmu_src.tethered_deorbit.interface import MODEL
from orbital.constants import EARTH_EQUATORIAL_RADIUS, EARTH_MU
from tests.plain import PlainInstance, plain

__all__ = ["plain"]
pytestmark = pytest.mark.usefixtures("plain")

RATE = math.sqrt(EARTH_MU / (EARTH_EQUATORIAL_RADIUS + 800e3) ** 3)
IMPEDANCE = math.sqrt(60e9 * math.pi * 1e-6 / 4.0 / 12.0 * 2000.0 / 3.0)
"""sqrt(k m_r) of Table 2's pair [N s/m]: what a snap pulls for each metre a second."""


def tow(level: float, leading: int, **more: Any) -> PlainInstance:
    terms = {"reel": "locked", "thrust": "along_track", "ends": "watched"}
    extents = {"ends.chaser_extent": 1.0, "ends.target_extent": 1.5}
    return PlainInstance(MODEL, terms, {"thrust.level": level, "start.leading": leading, **extents, **more})


def test_a_chaser_that_leads_and_brakes_hard_runs_into_its_target() -> None:
    """10 m less 2.5 m at 10 N/2000 kg, as far as the orbit lets it: Clohessy and Wiltshire along-track and radial."""
    i = tow(-10.0, 1)
    with pytest.raises(ModelFault, match="bodies have come within"):
        i.step(200.0)
    a = 10.0 / 2000.0
    met = i.record[0].fault_time
    # the target from the chaser: it begins 10 m behind at rest and is thrust forward, a against n t small
    nt = RATE * met
    along = -10.0 + a / RATE**2 * (4.0 * (1.0 - math.cos(nt)) - 1.5 * nt * nt)
    radial = 2.0 * a / RATE**2 * (nt - math.sin(nt))
    assert math.hypot(along, radial) == pytest.approx(2.5, abs=1e-3)


def test_one_that_trails_pulls_away() -> None:
    i = tow(-10.0, 0)
    i.step(200.0)
    assert i["approach.distance"] == pytest.approx(10.0, rel=1e-12)
    assert i["tether.tug_count"] >= 1


@pytest.mark.parametrize(("ratio", "governs"), [(0.05, "snap"), (0.3, "snap"), (1.0, "dashpot"), (5.0, "dashpot")])
def test_above_half_critical_the_dashpot_makes_the_peak(ratio: float, governs: str) -> None:
    """It jumps to 2 zeta v sqrt(k m_r) as the line goes taut; below, the snap of the spring is more than that."""
    i = tow(-0.01, 0, **{"tether.damping_ratio": ratio})
    i.step(1122.0)
    speed, peak = i["tug[1].speed"], i["tug[1].peak"]
    jump = 2.0 * ratio * speed * IMPEDANCE
    snap = (
        speed * IMPEDANCE * math.exp(-ratio * (3.0 * math.acos(ratio) - math.pi) / math.sqrt(1.0 - ratio**2))
        if ratio < 0.5
        else 0.0
    )
    assert peak == pytest.approx(jump if governs == "dashpot" else snap, rel=5e-3)
    assert (jump > snap) == (governs == "dashpot")
