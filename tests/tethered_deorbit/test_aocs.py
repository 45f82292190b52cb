"""Attitude control of the chaser: the loop against its closed form, limits, momentum, and a pull beside the centre."""

import math
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fmu_src.instance import ModelFault
from fmu_src.tethered_deorbit.interface import HANDED_OVER, MODEL
from tests.plain import PlainInstance, plain
from tests.validation import Validated, closed_form

__all__ = ["plain"]
pytestmark = pytest.mark.usefixtures("plain")

MOMENTS = (900.0, 1100.0, 1300.0)
FREE = {"reel": "commanded", "environment": "none", "chaser": "rigid", "aocs": "wheels"}


def chaser(terms: dict[str, str] = FREE, **more: Any) -> PlainInstance:
    values = {
        "start.condition": HANDED_OVER,
        "start_relative_position": (0.0, 20.0, 0.0),
        "chaser_inertia": (*MOMENTS, 0.0, 0.0, 0.0),
        "chaser_attachment": (0.0, 1.0, 0.0),
        "aocs.frequency": 0.05,
        "aocs.torque_limit": 1e3,
        "aocs.momentum_limit": 1e6,
        **more,
    }
    return PlainInstance(MODEL, terms, values)


def attitude(i: PlainInstance) -> Any:
    w, *xyz = i.array("chaser_attitude")
    return Rotation.from_quat([*xyz, w])


def test_a_small_turn_swings_back_as_the_loop_says(validated: Validated) -> None:
    """theta'' + 2 zeta w theta' + w^2 theta = 0 from a rate: theta = theta'_0 exp(-zeta w t) sin(w_d t)/w_d."""
    rate, zeta, pace = 1e-6, 0.7, 0.05
    i = chaser(chaser_start_rate=(rate, -2.0 * rate, 3.0 * rate))
    damped = pace * math.sqrt(1.0 - zeta**2)
    for t in (10.0, 30.0, 60.0):
        i.step(t - i.time)
        expected = rate * math.exp(-zeta * pace * t) * math.sin(damped * t) / damped
        found = attitude(i).as_rotvec()
        loop = closed_form("t'_0 exp(-z w t) sin(w_d t)/w_d")
        what = "attitude control: deviation of a chaser with a rate"
        validated(loop, what, found, np.array([1.0, -2.0, 3.0]) * expected, "rad", rel=1e-4)
        assert i["aocs.deviation"] == pytest.approx(abs(expected) * math.sqrt(14.0), rel=1e-4)


def test_bodies_and_wheels_keep_their_momentum(validated: Validated) -> None:
    """A large turn, a pull beside the centre, a chaser with its products of inertia: nothing comes from outside."""
    i = chaser(
        chaser_start_rate=(0.05, -0.08, 0.02),
        chaser_inertia=(900.0, 1100.0, 1300.0, -30.0, 10.0, 40.0),
        chaser_attachment=(0.3, 1.0, -0.2),
        **{"reel.tension": 5.0},
    )

    def momentum() -> Any:
        place = i.array("target_position") - i.array("chaser_position")
        speed = i.array("target_velocity") - i.array("chaser_velocity")
        own = i.array("chaser_spin") + attitude(i).apply(i.array("aocs_momentum"))
        return 2000.0 / 3.0 * np.cross(place, speed) + own

    begin, largest = momentum(), 0.0
    for _ in range(20):
        i.step(3.0)
        largest = max(largest, float(np.linalg.norm(i.array("aocs_momentum"))))
        size = float(np.linalg.norm(begin)) + largest
        kept, what = closed_form("nothing comes from outside"), "attitude control: momentum of bodies and wheels"
        validated(kept, what, momentum(), begin, "N.m.s", abs=1e-11 * size)
    assert largest > 50.0


def test_a_pull_beside_the_centre_fills_the_wheels(validated: Validated) -> None:
    """T a of torque turns the chaser by T a/(I w_c^2) against its loop and fills the wheels; full, they let go."""
    tension, arm, pace = 0.02, 0.5, 0.05
    i = chaser(
        start_relative_position=(0.0, 100.0, 0.0),
        chaser_attachment=(arm, 0.0, 0.0),
        **{"reel.tension": tension, "aocs.momentum_limit": 8.0, "aocs.frequency": pace, "aocs.torque_limit": 0.1},
    )
    i.step(600.0)
    torque = tension * arm
    turned = attitude(i).as_rotvec()
    # the arm turns with the chaser, by little
    what = "attitude control, a pull beside the centre"
    angle = torque / (MOMENTS[2] * pace**2)
    validated(closed_form("T a/(I w^2)"), f"{what}: deviation", turned[2], angle, "rad", rel=2e-2)
    held = i["aocs.momentum[3]"]
    validated(closed_form("T a t"), f"{what}: momentum of the wheels", held, torque * 600.0, "N.m.s", rel=5e-2)
    assert not i["aocs.limited"]
    i.step(900.0)
    assert i["aocs.limited"]
    assert np.linalg.norm(i.array("aocs_momentum")) <= 8.0 * (1.0 + 1e-9)
    assert i["aocs.deviation"] > 2.0 * abs(turned[2])


def test_torque_is_limited(validated: Validated) -> None:
    i = chaser(chaser_start_rate=(0.0, 0.0, 0.05), **{"aocs.torque_limit": 0.5})
    i.step(20.0)
    assert i["aocs.limited"]
    assert np.linalg.norm(i.array("aocs_torque")) == pytest.approx(0.5, rel=1e-12)
    what, rate = "attitude control at its largest torque", 0.05 - 0.5 / MOMENTS[2] * 20.0
    validated(closed_form("w_0 - M t/I"), f"{what}: rate", i["chaser.rate[3]"], rate, "rad/s", rel=1e-6)
    validated(closed_form("M t"), f"{what}: momentum of the wheels", i["aocs.momentum[3]"], 10.0, "N.m.s", rel=1e-6)


def test_the_attitude_is_held_in_the_orbital_frame() -> None:
    """It turns once an orbit, without torque on a body that gravity does not turn; without control it would not."""
    terms = {"reel": "commanded", "chaser": "rigid", "aocs": "wheels"}
    values = {
        "start.condition": 1,
        "chaser.rate_frame": 1,
        "chaser_inertia": (1000.0, 1000.0, 1000.0, 0.0, 0.0, 0.0),
    }
    held = PlainInstance(MODEL, terms, values)
    held.step(1500.0)
    assert held["aocs.deviation"] < 1e-8
    assert np.linalg.norm(held.array("aocs_momentum")) < 1e-4
    start = PlainInstance(MODEL, terms, {**values, "chaser.rate_frame": 0})
    start.step(1500.0)
    # begun at rest in inertial space, it has come round with the frame
    assert start["aocs.deviation"] < 1e-6
    assert start.array("chaser_rate")[2] == pytest.approx(held.array("chaser_rate")[2], rel=1e-6)


def test_a_chaser_that_points_along_its_line() -> None:
    """The attachment swings round to where the line goes, and stays."""
    i = chaser(**{"aocs.points": 1, "reel.tension": 1e-6}, start_relative_position=(12.0, 16.0, 0.0))
    i.step(400.0)
    pointing = attitude(i).apply([0.0, 1.0, 0.0])
    end = i.array("chaser_position") + pointing
    line = i.array("target_position") - end
    assert pointing == pytest.approx(line / np.linalg.norm(line), abs=1e-4)
    assert i["aocs.deviation"] < 1e-4


def test_a_thruster_off_the_centre(validated: Validated) -> None:
    """F p of torque on the chaser, and the wheels that hold it take it up; through the centre there is none."""
    terms = FREE | {"thrust": "along_track"}
    beside, through = (
        chaser(terms, chaser_thruster=place, **{"thrust.level": 0.1}) for place in ((0.2, 0.0, 0.0), (0.0, -1.0, 0.0))
    )
    for i in (beside, through):
        i.step(600.0)
    assert beside["aocs.momentum[3]"] == pytest.approx(0.02 * 600.0, rel=6e-2)
    what = "thruster beside the centre"
    validated(closed_form("F p"), f"{what}: torque of the wheels", beside["aocs.torque[3]"], -0.02, "N.m", rel=1e-3)
    assert abs(through["aocs.momentum[3]"]) < 1e-9
    free = PlainInstance(
        MODEL,
        {"reel": "commanded", "environment": "none", "chaser": "rigid", "thrust": "along_track"},
        {
            "start.condition": HANDED_OVER,
            "start_relative_position": (0.0, 20.0, 0.0),
            "chaser_inertia": (*MOMENTS, 0.0, 0.0, 0.0),
            "chaser_thruster": (0.2, 0.0, 0.0),
            "thrust.level": 0.1,
        },
    )
    free.step(10.0)
    rate = 0.02 / MOMENTS[2] * 10.0
    validated(closed_form("F p t/I"), f"{what}, no control: rate", free["chaser.rate[3]"], rate, "rad/s", rel=1e-6)


def test_what_is_held_in_space_does_not_turn_with_the_line() -> None:
    """A pair that whirls on a taut line, in steps whose axes turn with it: the chaser stands still, its wheels idle."""
    i = chaser(
        {**FREE, "reel": "locked"},
        start_relative_position=(0.0, 12.0, 0.0),
        start_relative_velocity=(0.06, 0.0, 0.0),
        chaser_attachment=(0.0, 0.0, 0.0),
    )
    i.step(40.0)
    assert i["tether.taut"]
    assert i.record[0].state_turning[2] != 0.0
    assert i["aocs.deviation"] < 1e-12
    assert np.linalg.norm(i.array("aocs_momentum")) < 1e-9


def test_a_point_has_no_attitude_to_control() -> None:
    with pytest.raises(ModelFault, match="needs a chaser that turns"):
        PlainInstance(
            MODEL,
            {"reel": "commanded", "environment": "none", "aocs": "wheels"},
            {"start.condition": HANDED_OVER, "start_relative_position": (0.0, 20.0, 0.0)},
        )


@pytest.mark.parametrize("points", [0, 1])
def test_large_deviations_are_told_as_angles(points: int) -> None:
    """A chaser that turns on, held by next to nothing, to 2.5 rad off: the angle itself, where the law takes a sine."""
    i = chaser(
        chaser_inertia=(1000.0, 1000.0, 1000.0, 0.0, 0.0, 0.0),
        chaser_start_rate=(0.01 if points else 0.006, 0.0, 0.0 if points else 0.008),
        **{"aocs.points": points, "aocs.torque_limit": 1e-9},
    )
    for _ in range(5):
        i.step(50.0)
        turned = attitude(i)
        arm = turned.apply([0.0, 1.0, 0.0])
        line = i.array("target_position") - i.array("chaser_position") - arm
        to_line = math.acos(arm @ line / np.linalg.norm(line))
        expected = to_line if points else np.linalg.norm(turned.as_rotvec())
        assert i["aocs.deviation"] == pytest.approx(expected, abs=1e-6)
    assert i["aocs.deviation"] > 2.4
