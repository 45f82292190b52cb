"""Which level of target a hand-over needs: the bound of a point against runs of both, and what is handed over."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from dcone_cosim.errors import HandoffError
from dcone_cosim.handoff import Body, Handoff, pair_parameters
from dcone_cosim.level import body_rate, held_turning, point_bound, turning_parameters
from dcone_cosim.line import line_of
from dcone_cosim.loading import load
from dcone_cosim.transaction import HandoffRecord, check_before
from fmu_src.instance import Instance
from fmu_src.tethered_deorbit.interface import HANDED_OVER, MODEL
from orbital.plain import mean_motion

RATE = float(mean_motion(7178137.0, 3.986004418e14))
LENGTH = 14.0
INERTIA = np.diag([1788.0, 1042.0, 1788.0])
ON_ORBIT = {"reel": "locked", "thrust": "along_track"}


def handed(rate: np.ndarray, arm: np.ndarray, apart: np.ndarray, parting: np.ndarray) -> Handoff:
    """What a capture may leave: body axes along the orbital ones, `rate` relative to inertial space."""
    chaser = Body(2000.0, np.zeros(3), np.zeros(3))
    joint = Body(1006.0, apart, parting, INERTIA @ rate, INERTIA)
    turning = np.array([0.0, 0.0, RATE])
    target = Body(1000.0, apart, parting, joint.spin, INERTIA)
    catch = Body(6.0, apart, parting)
    parameters = pair_parameters(chaser, joint)
    attitude = np.array([1.0, 0.0, 0.0, 0.0])
    return Handoff(chaser, target, catch, 0.0, joint, apart + arm, 2.6, turning, parameters, attitude)


def first_tug(terms: dict[str, str], values: dict[str, float]) -> tuple[float, float]:
    i = Instance(MODEL, ON_ORBIT | terms, {"start.condition": HANDED_OVER, "tether.rest_length": LENGTH})
    for name, value in values.items():
        i[name] = value
    i.initialise()
    while i["tether.tug_count"] == 0 or i["tether.taut"]:
        i.step(5.0)
        assert i.time < 3000.0
    k = int(i["tether.tug_count"])
    return i[f"tug[{k}].time"], i[f"tug[{k}].peak"]


def test_the_bound_holds_for_what_both_levels_give() -> None:
    """Forty pairs that part at 5 to 60 mm/s with targets that turn a little: no point's first tug, in time or peak, is
    farther off that of a body that turns than its bound says."""
    rng = np.random.default_rng(4)
    names = set(Instance(MODEL, ON_ORBIT | {"target": "rigid"}).interface.references)
    bounds = []
    for _ in range(40):
        apart = np.array([0.0, 11.5, 0.0]) + rng.normal(size=3) * 0.2
        parting = np.array([0.0, rng.uniform(0.005, 0.06), 0.0])
        # of a line that stays along-track as the frame turns: it turns with the frame
        rate = np.array([0.0, 0.0, RATE]) + rng.normal(size=3) * 10.0 ** rng.uniform(-5.0, -3.3)
        arm = np.array([0.0, -1.95, 0.0]) + rng.normal(size=3) * 0.05
        found = handed(rate, arm, apart, parting)
        line = line_of(found, LENGTH)
        assert line.slack is not None
        bound = point_bound(found, line, line.slack, -0.01, 0.01)
        if not bound.largest < 0.5:
            continue
        values = found.parameters
        point = first_tug({}, values | {"target.attachment_distance": line.attachment})
        turning = first_tug({"target": "rigid"}, values | turning_parameters(found, {}, names, 0.0))
        time, peak = (abs(a / b - 1.0) for a, b in zip(point, turning, strict=True))
        assert time <= bound.time
        assert peak <= bound.peak
        bounds.append(bound.largest)
    assert len(bounds) > 12
    assert min(bounds) < 0.03


def test_spin_counts_relative_to_the_line() -> None:
    """A target that stands still in the orbital frame turns at n in inertial space, and so does its line."""
    apart, arm = np.array([0.0, 11.0, 0.0]), np.array([0.0, -1.9, 0.0])
    still = handed(np.array([0.0, 0.0, RATE]), arm, apart, np.array([0.0, 0.02, 0.0]))
    bound = point_bound(still, line_of(still, LENGTH), 4.9, -0.01, 0.01)
    assert bound.rate == pytest.approx(0.0, abs=1e-12)
    inertial = handed(np.zeros(3), arm, apart, np.array([0.0, 0.02, 0.0]))
    assert point_bound(inertial, line_of(inertial, LENGTH), 4.9, -0.01, 0.01).rate == pytest.approx(RATE, rel=1e-12)


def test_the_bound_is_arithmetic_one_can_follow() -> None:
    """20 mm/s over 4 m without thrust: 200 s. An arm of 2 m that turns at 0.1 deg/s goes round by 20 deg and, by the
    gravity gradient, 3 n^2 t^2/4; the line by n v t^2/s of the Coriolis force."""
    apart, arm = np.array([0.0, 12.0, 0.0]), np.array([0.0, -2.0, 0.0])
    w = np.array([math.radians(0.1), 0.0, RATE])
    found = handed(w, arm, apart, np.array([0.0, 0.02, 0.0]))
    bound = point_bound(found, line_of(found, LENGTH), 4.0, 0.0, 0.01)
    assert bound.tug_time == pytest.approx(200.0, rel=1e-12)
    assert bound.tug_speed == pytest.approx(0.02, rel=1e-12)
    angle = math.radians(20.0) + 0.75 * (RATE * 200.0) ** 2 + RATE * 0.02 * 200.0**2 / 12.0
    assert bound.angle == pytest.approx(angle, rel=1e-9)
    assert bound.time == pytest.approx(2.0 * (1.0 - math.cos(angle)) / 4.0, rel=1e-9)
    reduced = 2000.0 * 1006.0 / 3006.0
    lever = 2.0 * math.sin(angle)
    peak = math.radians(0.1) * lever / 0.02 + 0.5 * reduced * lever**2 / 1042.0
    assert bound.peak == pytest.approx(peak, rel=1e-9)
    assert not bound.accepted
    assert replace(bound, tolerance=1.01 * bound.largest).accepted


@pytest.mark.parametrize(
    ("change", "why"),
    [
        ({"parting": np.array([0.0, -0.01, 0.0])}, "they approach, without thrust"),
        ({"arm": np.array([0.0, 1.9, 0.0])}, "the attachment is out of sight"),
        ({"rate": np.array([0.1, 0.0, RATE])}, "it turns out of sight"),
    ],
)
def test_what_has_no_bound(change: dict[str, Any], why: str) -> None:
    usual = {
        "rate": np.array([0.0, 0.0, RATE]),
        "arm": np.array([0.0, -1.9, 0.0]),
        "apart": np.array([0.0, 11.0, 0.0]),
        "parting": np.array([0.0, 0.02, 0.0]),
    }
    found = handed(**(usual | change))
    assert point_bound(found, line_of(found, LENGTH), 4.9, 0.0, 0.01).largest == math.inf, why


SETTINGS = {
    "open": (),
    "a point": ('removal.target.body="point"',),
    "wider": ('handoff.point_tolerance="100 %"',),
    "of points": ('removal.level.detail="event_map"',),
}


@pytest.mark.parametrize("which", SETTINGS)
def test_the_level_that_is_needed_is_taken(which: str) -> None:
    """Of a scene that leaves it open; one that asks for a point is refused, one with a wider tolerance gets it, and one
    with a part that carries two points alone is refused in place of being built."""
    scene = load("tumbling-mission", SETTINGS[which])
    capture, removal = scene.phases
    spin = 1e-6 if which == "wider" else 0.03
    found = handed(
        np.array([0.0, 0.0, RATE + spin]),
        np.array([0.0, -1.9, 0.0]),
        np.array([0.0, 11.0, 0.0]),
        np.array([0, 0.02, 0]),
    )
    record = HandoffRecord(10.0, 10.0, "told", removal, found, line_of(found, LENGTH))
    refused = {
        "a point": r'\[removal\.target\] body = "box", or none, would carry it',
        "of points": "level.detail = event_map: does not go with target = box: it carries two points",
    }
    if which in refused:
        with pytest.raises(HandoffError, match=refused[which]):
            check_before(record, scene.handoff, capture.main.terms["target"])
        return
    check_before(record, scene.handoff, capture.main.terms["target"])
    assert record.level == ("point" if which == "wider" else "box")
    assert record.turns == (which != "wider")
    assert ("wraps" in record.reason) == (which != "wider")
    assert (record.phase is removal) == (which == "wider")


def test_all_of_it_comes_over_in_the_target_s_axes() -> None:
    """Read back, spin, inertia and attachment are those along orbital axes, whatever the attitude."""
    turned = Rotation.from_euler("xyz", (0.4, -0.9, 1.3))
    x, y, z, w = turned.as_quat()
    usual = handed(np.array([0.01, -0.02, 0.03]), np.array([0.3, -1.9, 0.2]), np.array([1.0, 11.0, 0.5]), np.zeros(3))
    inertia = turned.as_matrix() @ INERTIA @ turned.as_matrix().T + np.diag([1.0, 2.0, 3.0])
    joint = replace(usual.joint, inertia=inertia, spin=inertia @ np.array([0.01, -0.02, 0.03]))
    found = replace(usual, joint=joint, attitude=np.array([w, x, y, z]))
    names = set(Instance(MODEL, ON_ORBIT | {"target": "box"}).interface.references)
    given = turning_parameters(found, {"target.size[1]": 2.0, "target.length": 9.0}, names, 0.0)
    assert "target.length" not in given
    assert given["target.size[1]"] == 2.0
    held = held_turning(given)
    assert held is not None
    assert held.spin == pytest.approx(joint.spin, rel=1e-12)
    assert held.inertia == pytest.approx(inertia, rel=1e-12)
    assert held.attachment == pytest.approx([0.3, -1.9, 0.2], rel=1e-12)
    assert body_rate(found) == pytest.approx([0.01, -0.02, 0.03], rel=1e-12)
    i = Instance(MODEL, ON_ORBIT | {"target": "box"}, {"start.condition": HANDED_OVER, "orbit.inclination": 0.0})
    for name, value in (found.parameters | given).items():
        i[name] = value
    i.initialise()
    assert i.array("target_spin") == pytest.approx(joint.spin, rel=1e-12)
