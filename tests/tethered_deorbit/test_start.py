"""The four starting conditions, either body leading, circular and not."""

import math

import numpy as np
import pytest

from fmu_src.instance import Instance
from fmu_src.tethered_deorbit.interface import EQUAL_VELOCITY, HANDED_OVER, MODEL, SAME_ORBIT, VBAR
from orbital.constants import EARTH_EQUATORIAL_RADIUS, EARTH_MU
from orbital.kepler import state_to_elements

TERMS = {"reel": "locked", "thrust": "along_track"}


def start(**parameters: float) -> Instance:
    return Instance(MODEL, TERMS, {k.replace("__", "."): v for k, v in parameters.items()}).initialise()


@pytest.mark.parametrize("leading", [0, 1])
@pytest.mark.parametrize("eccentricity", [0.0, 0.05, 0.6])
def test_same_orbit(leading: int, eccentricity: float) -> None:
    altitude, anomaly = (800e3 if eccentricity < 0.1 else 20e6), 1.1
    i = start(
        start__condition=SAME_ORBIT,
        start__leading=leading,
        orbit__eccentricity=eccentricity,
        orbit__altitude=altitude,
        orbit__true_anomaly=anomaly,
    )
    assert i["separation"] == pytest.approx(10.0, rel=1e-14)
    anomalies = {}
    for body in ("chaser", "target"):
        e = state_to_elements(i.array(f"{body}_position"), i.array(f"{body}_velocity"), EARTH_MU)
        assert e.semi_major_axis == pytest.approx(EARTH_EQUATORIAL_RADIUS + altitude, rel=1e-13)
        assert e.eccentricity == pytest.approx(eccentricity, abs=1e-13)
        anomalies[body] = e.true_anomaly
    assert (anomalies["target"] > anomalies["chaser"]) == (leading == 0)
    assert 0.5 * (anomalies["target"] + anomalies["chaser"]) == pytest.approx(anomaly, abs=1e-12)
    if eccentricity == 0.0:
        assert np.abs(i.array("relative_velocity")).max() < 1e-15


def test_same_orbit_notices_another() -> None:
    """Twin: the same offset, but at rest in the turning frame, puts neither body on an ellipse's orbit."""
    common = {"orbit__eccentricity": 0.05, "orbit__true_anomaly": 1.1, "start__separation": 10.0}
    good, other = start(start__condition=SAME_ORBIT, **common), start(start__condition=VBAR, **common)
    longer = start(start__condition=SAME_ORBIT, **(common | {"start__separation": 10.1}))
    assert longer["separation"] != pytest.approx(good["separation"], rel=1e-3)
    semi = EARTH_EQUATORIAL_RADIUS + 800e3
    for body in ("chaser", "target"):
        on, off = (
            state_to_elements(i.array(f"{body}_position"), i.array(f"{body}_velocity"), EARTH_MU) for i in (good, other)
        )
        assert on.semi_major_axis == pytest.approx(semi, rel=1e-13) != off.semi_major_axis
        assert abs(off.semi_major_axis / semi - 1.0) > 1e-8


@pytest.mark.parametrize("leading", [0, 1])
def test_vbar_and_equal_velocity(leading: int) -> None:
    sign = 1.0 - 2.0 * leading
    rate = math.sqrt(EARTH_MU / (EARTH_EQUATORIAL_RADIUS + 800e3) ** 3)
    for condition, x in ((VBAR, 0.0), (EQUAL_VELOCITY, sign * 10.0 * rate)):
        i = start(start__condition=condition, start__leading=leading)
        assert i.array("relative_position") == pytest.approx([0.0, sign * 10.0, 0.0], abs=1e-14)
        assert i.array("relative_velocity") == pytest.approx([x, 0.0, 0.0], abs=1e-16)
        assert i["tether.angle"] == pytest.approx(sign * 0.5 * math.pi)
        other = start(start__condition=condition, start__leading=1 - leading)
        assert other.array("relative_position") != pytest.approx([0.0, sign * 10.0, 0.0], abs=1.0)
    assert start(start__condition=VBAR).array("relative_velocity") != pytest.approx([10.0 * rate, 0.0, 0.0], abs=1e-16)
    assert i.array("target_velocity") == pytest.approx(i.array("chaser_velocity"), abs=0.0)


def test_the_conditions_differ() -> None:
    ends = set()
    for condition in (SAME_ORBIT, VBAR, EQUAL_VELOCITY):
        for leading in (0, 1):
            i = start(start__condition=condition, start__leading=leading)
            i.step(500.0)
            ends.add(tuple(np.round(i.array("relative_position"), 7)))
    # On a circle, 10 m along V-bar is the same orbit to two micrometres.
    assert len(ends) == 6


def test_leading_chaser_comes_back_below() -> None:
    """Retrograde thrust drives the chaser down; a leading one first falls back to the target, a trailing one away."""
    for leading, closer in ((1, True), (0, False)):
        i = start(start__leading=leading, tether__rest_length=1e3)
        i.step(1000.0)
        assert (i["separation"] < 10.0) == closer
        assert i["relative.position[1]"] == pytest.approx(1.6393, abs=1e-3)


def test_handed_over() -> None:
    i = Instance(MODEL, TERMS, {"start.condition": HANDED_OVER, "orbit.eccentricity": 0.02, "orbit.raan": 0.7})
    given = {
        "start_relative_position": (1.0, -8.0, 2.0),
        "start_relative_velocity": (3e-3, 2e-3, -1e-3),
        "start_center_position": (0.0, 0.0, 0.0),
        "start_center_velocity": (0.0, 0.0, 0.0),
    }
    for field, value in given.items():
        i.array(field)[:] = value
    i.initialise(500.0)
    assert i.array("relative_position") == pytest.approx([1.0, -8.0, 2.0], abs=1e-14)
    assert i.array("relative_velocity") == pytest.approx([3e-3, 2e-3, -1e-3], abs=1e-17)
    center = i.array("center_position").copy()
    i.array("start_center_position")[:] = 30.0, 40.0, 0.0
    i.initialise(500.0)
    assert np.linalg.norm(i.array("center_position") - center) == pytest.approx(50.0, abs=1e-8)
    i.array("start_center_position")[:] = 30.0, 40.4, 0.0
    i.array("start_relative_position")[:] = 1.0, -8.08, 2.0
    i.initialise(500.0)
    assert np.linalg.norm(i.array("center_position") - center) != pytest.approx(50.0, abs=0.1)
    assert i.array("relative_position") != pytest.approx([1.0, -8.0, 2.0], abs=1e-2)
    # The rate is one seen in turning axes: read as inertial it would differ by n times the length, 9 mm/s.
    still = i.array("target_velocity") - i.array("chaser_velocity")
    assert np.linalg.norm(still) != pytest.approx(np.linalg.norm(given["start_relative_velocity"]), rel=0.5)


def test_taut_at_the_start_is_a_tug() -> None:
    i = Instance(MODEL, TERMS, {"start.condition": HANDED_OVER})
    i.array("start_relative_position")[:] = 12.001, 0.0, 0.0
    i.initialise(100.0)
    assert (i["tether.tug_count"], i["tether.taut"], i["tug[1].time"]) == (1, 1, 0.0)
    assert i["tether.tension"] == i["tug[1].peak"] == i["tether.tension_peak"] == pytest.approx(3.927, rel=1e-3)
    i.array("start_relative_position")[:] = 11.999, 0.0, 0.0
    i.initialise(100.0)
    assert (i["tether.tug_count"], i["tether.taut"], i["tug[1].time"], i["tether.tension"]) == (0, 0, 0.0, 0.0)


def test_outputs_agree_with_each_other() -> None:
    i = start(start__leading=1)
    i.step(3000.0)
    total = 3000.0
    center = (2000.0 * i.array("chaser_position") + 1000.0 * i.array("target_position")) / total
    assert center == pytest.approx(i.array("center_position"), abs=1e-8)
    assert i["separation"] == pytest.approx(np.linalg.norm(i.array("relative_position")), rel=1e-14)
    assert i["altitude"] == pytest.approx(np.linalg.norm(center) - EARTH_EQUATORIAL_RADIUS, abs=1e-8)
    assert i["energy.orbital"] == pytest.approx(-total * EARTH_MU / (2.0 * i["center.semi_major_axis"]), rel=1e-12)
