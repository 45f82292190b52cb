"""A line that breaks, and runs that end by themselves: instants against closed forms, and what may not happen."""

import math
import re
from typing import Any

import numpy as np
import pytest

from fmu_src.instance import ModelFault
from fmu_src.tethered_deorbit.interface import (
    BROKE,
    CAME_CLOSE,
    CAME_DOWN,
    ENDS_AT_START,
    HANDED_OVER,
    MODEL,
    PERIGEE_LOW,
    PERIGEE_RAISED,
    WRAPPED_UP,
)
from orbital.constants import EARTH_EQUATORIAL_RADIUS, EARTH_MU
from tests.plain import PlainInstance, plain

__all__ = ["plain"]
pytestmark = pytest.mark.usefixtures("plain")


def ends_by(code: int) -> Any:
    """What is raised where a run ends, or cannot begin, for this reason."""
    return pytest.raises(ModelFault, match=re.escape(next(f.text for f in MODEL.faults if f.code == code)))


STIFFNESS, REDUCED, SPEED = 60e9 * math.pi * 1e-6 / 4.0 / 12.0, 2000.0 / 3.0, 0.01
OMEGA = math.sqrt(STIFFNESS / REDUCED)
SNAP = SPEED * math.sqrt(STIFFNESS * REDUCED)


def snapping(share: float, **more: Any) -> PlainInstance:
    """A pair that flies apart, its undamped line taut after 1 s, its strength a share of the snap's peak."""
    return PlainInstance(
        MODEL,
        {"reel": "locked", "environment": "none", "break": "breaks"},
        {
            "start.condition": HANDED_OVER,
            "start_relative_position": (0.0, 12.0 - SPEED, 0.0),
            "start_relative_velocity": (0.0, SPEED, 0.0),
            "tether.damping_ratio": 0.0,
            "break.strength": share * SNAP,
            **more,
        },
    )


@pytest.mark.parametrize("share", [0.01, 0.5, 0.9999])
def test_a_line_breaks_where_the_tension_reaches_its_strength(share: float) -> None:
    """T = P sin(omega t): broken at asin(share)/omega after it went taut, with sqrt(1 - share^2) of the speed left."""
    i = snapping(share, **{"break.flies_on": True})
    i.step(20.0)
    assert i["break.broken"]
    left = SPEED * math.sqrt(1.0 - share * share)
    # a billionth of the peak in the tension
    within = 1e-9 / OMEGA * SPEED / left
    assert i["break.time"] == pytest.approx(1.0 + math.asin(share) / OMEGA, abs=within)
    assert i["tether.length_rate"] == pytest.approx(left, abs=1e-7 * SPEED)
    assert (i["tether.tension"], i["tether.taut"], i["tether.tug_count"]) == (0.0, 0, 1)
    assert i["tug[1].peak"] == pytest.approx(share * SNAP, rel=1e-6)
    assert i["tether.length"] > 12.0 + 0.9 * left * (20.0 - i["break.time"])


def test_a_line_that_is_strong_enough_holds() -> None:
    i = snapping(1.0001)
    i.step(5.0)
    assert (i["break.broken"], i["break.time"]) == (0, 0.0)
    assert i["tether.length_rate"] == pytest.approx(-SPEED, rel=1e-6)


def test_the_instant_of_the_break_does_not_depend_on_macro_steps() -> None:
    whole, pieces = (snapping(0.7, **{"break.flies_on": True}) for _ in range(2))
    whole.step(4.0)
    for _ in range(40):
        pieces.step(0.1)
    for name in ("break.time", "tether.length", "tether.length_rate", "tug[1].peak"):
        assert whole[name] == pytest.approx(pieces[name], rel=1e-15)


def test_nothing_is_left_of_a_break_in_a_new_run() -> None:
    i = snapping(0.5, **{"break.flies_on": True})
    i.step(5.0)
    i.initialise()
    assert (i["break.broken"], i["break.time"]) == (0, 0.0)
    i.step(1.5)
    assert i["tether.tug_count"] == 1


def test_a_break_ends_the_run_unless_both_fly_on() -> None:
    assert snapping(0.5)["break.flies_on"], "which they do where nothing else is said"
    i = snapping(0.5, **{"break.flies_on": False})
    with ends_by(BROKE):
        i.step(5.0)
    assert i.record[0].fault_time == pytest.approx(1.0 + math.asin(0.5) / OMEGA, abs=1e-8)
    assert (i["break.broken"], i["break.time"]) == (1, i.record[0].fault_time)
    # and its outputs are those of that instant
    assert i["tether.tension"] == pytest.approx(0.5 * SNAP, rel=1e-6)
    assert i["tether.tension_peak"] == pytest.approx(0.5 * SNAP, rel=1e-6)
    assert i["tether.length_rate"] == pytest.approx(SPEED * math.sqrt(0.75), rel=1e-6)


def meeting(speed: float, aside: float, **more: Any) -> PlainInstance:
    """Two spheres, of 1 and 2 m, that pass each other on straight lines."""
    return PlainInstance(
        MODEL,
        {"reel": "commanded", "environment": "none", "ends": "watched"},
        {
            "start.condition": HANDED_OVER,
            "start_relative_position": (aside, 100.0, 0.0),
            "start_relative_velocity": (0.0, -speed, 0.0),
            "ends.chaser_extent": 1.0,
            "ends.target_extent": 2.0,
            "ends.clearance": 0.5,
            **more,
        },
    )


@pytest.mark.parametrize(("speed", "aside"), [(0.01, 0.0), (1.0, 3.0), (1.0, 3.4), (1e4, 0.0)])
def test_bodies_that_come_close_end_the_run(speed: float, aside: float) -> None:
    """Where the distance of the centres is 1 + 2 + 0.5 m."""
    i = meeting(speed, aside)
    with ends_by(CAME_CLOSE):
        i.step(200.0 / speed)
    expected = (100.0 - math.sqrt(3.5**2 - aside**2)) / speed
    assert i.record[0].fault_time == pytest.approx(expected, rel=1e-8)
    assert i["separation"] == pytest.approx(3.5, rel=1e-8)
    assert (i["approach.distance"], i["approach.time"]) == (i["separation"], i.record[0].fault_time)


def test_the_end_is_exact_in_the_shortest_of_steps() -> None:
    """The macro step before ends half a millisecond before the bodies meet, and a changed thrust begins anew there."""
    terms = {"reel": "commanded", "environment": "none", "ends": "watched", "thrust": "along_track"}
    i = PlainInstance(
        MODEL,
        terms,
        {
            "start.condition": HANDED_OVER,
            "start_relative_position": (0.0, 100.0, 0.0),
            "start_relative_velocity": (0.0, -1.0, 0.0),
            "ends.target_extent": 1.0,
            "thrust.level": 0.0,
        },
    )
    i.step(99.0 - 5e-4)
    i["thrust.offset"] = 1e-9
    with ends_by(CAME_CLOSE):
        i.step(1.0)
    assert i.record[0].fault_time == pytest.approx(99.0, abs=1e-9)


def test_bodies_that_pass_go_on() -> None:
    i = meeting(1.0, 3.51)
    i.step(200.0)
    assert i["approach.distance"] == pytest.approx(3.51, rel=1e-9)


@pytest.mark.parametrize(
    ("target", "shape", "place", "gap"),
    [
        ("box", {"target_size": (4.0, 8.0, 2.0)}, (5.0, 8.0, 0.0), math.hypot(3.0, 4.0)),
        ("box", {"target_size": (4.0, 8.0, 2.0), "target_center": (1.0, 0.0, 0.0)}, (7.0, 1.0, 0.5), 4.0),
        ("cylinder", {"target.cylinder_radius": 2.0, "target.cylinder_length": 4.0}, (3.0, 4.0, 6.0), 5.0),
    ],
)
def test_distance_to_a_surface(target: str, shape: dict[str, Any], place: tuple[float, ...], gap: float) -> None:
    """The clearance just below the distance goes on at the start, just above it is refused; body axes are turned."""
    turn = (math.cos(0.4), 0.0, math.sin(0.4), 0.0)
    c, s = math.cos(0.8), math.sin(0.8)
    matrix = np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])
    relative = tuple(-matrix @ np.array(place))
    for clearance, ends in ((gap * (1.0 - 1e-9), False), (gap * (1.0 + 1e-9), True)):
        values = {
            "start.condition": HANDED_OVER,
            "start_relative_position": relative,
            "target_attachment": (0.0, 0.0, 0.0),
            "target_start_attitude": turn,
            "ends.clearance": clearance,
            **shape,
        }
        terms = {"reel": "commanded", "environment": "none", "ends": "watched", "target": target}
        if ends:
            with ends_by(ENDS_AT_START):
                PlainInstance(MODEL, terms, values)
        else:
            PlainInstance(MODEL, terms, values)


def test_more_of_the_line_on_the_target_than_is_let() -> None:
    """A box of 2 m that turns away at 0.1 rad/s: the line lies on a whole face once it has turned past the corner."""
    terms = {"reel": "commanded", "environment": "none", "ends": "watched", "target": "box"}
    values = {
        "start.condition": HANDED_OVER,
        "start_relative_position": (0.0, 20.0, 0.0),
        "target_size": (2.0, 2.0, 2.0),
        "target_attachment": (0.0, -1.0, 0.0),
        "target_start_rate": (0.0, 0.0, 0.1),
        "ends.wrapped": 0.5,
    }
    i = PlainInstance(MODEL, terms, values)
    with ends_by(WRAPPED_UP):
        i.step(60.0)
    # it first lies on the face where it meets the plane of that face, of which 1 m is between attachment and edge
    assert i.record[0].fault_time == pytest.approx(0.5 * math.pi / 0.1, rel=0.06)


ON_ELLIPSE = {"orbit.altitude": 2000e3, "orbit.eccentricity": 0.1, "start.condition": 2, "thrust.level": 0.0}
SEMI = EARTH_EQUATORIAL_RADIUS + 2000e3


def test_down_to_an_altitude() -> None:
    """From the apogee down an ellipse: the instant at which r is passed, by Kepler's equation."""
    altitude = 1500e3
    terms = {"reel": "commanded", "thrust": "along_track", "ends": "watched"}
    i = PlainInstance(MODEL, terms, {**ON_ELLIPSE, "orbit.true_anomaly": math.pi, "ends.altitude": altitude})
    with ends_by(CAME_DOWN):
        i.step(6000.0)
    anomaly = math.acos((1.0 - (EARTH_EQUATORIAL_RADIUS + altitude) / SEMI) / 0.1)
    mean_anomaly = (math.tau - anomaly) - 0.1 * math.sin(math.tau - anomaly)
    seconds = (mean_anomaly - math.pi) / math.sqrt(EARTH_MU / SEMI**3)
    assert i.record[0].fault_time == pytest.approx(seconds, abs=1e-3)


@pytest.mark.parametrize(
    ("level", "key", "code"), [(-40.0, "ends.perigee", PERIGEE_LOW), (40.0, "ends.raised_perigee", PERIGEE_RAISED)]
)
def test_a_perigee_that_thrust_moves(level: float, key: str, code: int) -> None:
    """Short thrust at the apogee: the speed there gives the perigee, by vis-viva."""
    start = SEMI * 0.9 - EARTH_EQUATORIAL_RADIUS
    moved = math.copysign(1e3, level)
    terms = {"reel": "commanded", "thrust": "velocity", "ends": "watched"}
    values = {**ON_ELLIPSE, "orbit.true_anomaly": math.pi, "thrust.level": level, key: start + moved}
    i = PlainInstance(MODEL, terms, values)
    with ends_by(code):
        i.step(3000.0)

    def speed_at_apogee(perigee: float) -> float:
        apogee = SEMI * 1.1
        return math.sqrt(2.0 * EARTH_MU * perigee / (apogee * (apogee + perigee)))

    gained = speed_at_apogee(SEMI * 0.9 + moved) - speed_at_apogee(SEMI * 0.9)
    assert i.record[0].fault_time == pytest.approx(gained * 3000.0 / level, rel=1e-4)


def test_an_end_that_is_met_at_the_start_is_refused() -> None:
    with ends_by(ENDS_AT_START):
        meeting(1.0, 0.0, **{"ends.clearance": 97.5})
