"""The thruster's beam on the target: against an integral of its density, and the momentum of both bodies."""

import math
from typing import Any

import numpy as np
import pytest
from scipy.integrate import dblquad

from fmu_src.tethered_deorbit.interface import HANDED_OVER, MODEL
from tests.plain import PlainInstance, plain
from tests.validation import Validated, closed_form, other_code

__all__ = ["plain"]
pytestmark = pytest.mark.usefixtures("plain")


def pair(place: tuple[float, float, float], **more: Any) -> PlainInstance:
    return PlainInstance(
        MODEL,
        {"reel": "commanded", "environment": "none", "thrust": "along_track", "plume": "beam"},
        {"start.condition": HANDED_OVER, "start_relative_position": place, "thrust.level": -0.01, **more},
    )


def test_three_quarters_on_a_face_of_four_metres() -> None:
    """A beam of 15 degrees at 12 m: the chaser trails and brakes."""
    i = pair((0.0, 12.0, 0.0))
    assert i["plume.share"] == pytest.approx(0.7606, abs=1e-4)
    assert i["plume.force"] == pytest.approx(0.01 * i["plume.share"])
    assert i["plume.on_line"]


@pytest.mark.parametrize("angle", [0.0, 0.1, 0.25, 0.6])
def test_share_beside_the_axis(validated: Validated, angle: float) -> None:
    """The density of a beam that is normal across, integrated over the square."""
    d, w = 12.0, 4.0
    i = pair((d * math.sin(angle), d * math.cos(angle), 0.0))
    along, aside = d * math.cos(angle), d * math.sin(angle)
    # 95 % lie within r: 1 - exp(-r^2/(2 sigma^2))
    sigma = along * math.tan(math.radians(15.0)) / math.sqrt(-2.0 * math.log(0.05))
    expected, _ = dblquad(
        lambda y, x: math.exp(-0.5 * (x * x + y * y) / sigma**2) / (math.tau * sigma**2),
        aside - 0.5 * w, aside + 0.5 * w, -0.5 * w, 0.5 * w,
    )  # fmt: skip
    what = "plume: share of the beam on a face of 4 m at 12 m"
    validated(other_code("scipy dblquad of the beam's density"), what, i["plume.share"], expected, "1", abs=1e-7)
    assert bool(i["plume.on_line"]) == (angle < math.radians(15.0))


def test_what_is_behind_meets_nothing() -> None:
    for place, level in (((0.0, -12.0, 0.0), -0.01), ((0.0, 12.0, 0.0), 0.01), ((0.0, 12.0, 0.0), 0.0)):
        i = pair(place, **{"thrust.level": level})
        assert (i["plume.share"], i["plume.on_line"]) == (0.0, 0)


def test_the_push_is_what_the_pair_loses(validated: Validated) -> None:
    """Far away the share hardly changes: each body has its own acceleration, and the pair is slowed by the rest."""
    share, time = pair((0.0, 12.0, 0.0))["plume.share"], 1.0
    pushed, told = (pair((0.0, 12.0, 0.0), **{"plume.pushes": pushes}) for pushes in (True, False))
    for i in (pushed, told):
        i.step(time)
    assert np.allclose(told.array("target_velocity"), 0.0, atol=1e-18)
    assert pushed["chaser.velocity[2]"] == pytest.approx(told["chaser.velocity[2]"], rel=1e-9)
    target, center = share * 0.01 * time / 1000.0, -(1.0 - share) * 0.01 * time / 3000.0
    what, found = "plume that pushes the target: its speed", pushed["target.velocity[2]"]
    validated(closed_form("s F t/m_t"), what, found, target, "m/s", rel=1e-6)
    what, found = "plume that pushes the target: speed of the pair", pushed["center.velocity[2]"]
    validated(closed_form("(1 - s) F t/(m_c + m_t)"), what, found, center, "m/s", rel=1e-6)
