"""A low-friction table: sleds that stop, a tow that drags, what friction takes, and a line that lies on it."""

import math
from typing import Any

import numpy as np
import pytest

from dcone_cosim.loading import load
from fmu_src.tethered_deorbit.interface import MODEL
from fmu_src.tethered_deorbit.model import make_entry
from tests.plain import PlainInstance, plain
from tests.tethered_deorbit import lumped as pair
from tests.tethered_deorbit.test_winch import ROOMY, schedule
from tests.validation import Validated, closed_form

__all__ = ["plain"]

pytestmark = pytest.mark.usefixtures("plain")
TERMS = {"reel": "locked", "environment": "none", "friction": "coulomb", "thrust": "along_track"}
MU, GRAVITY, CREEP = 0.02, 9.80665, 1e-3
SLOWING = MU * GRAVITY
MASSES = {"chaser.mass": pair.CHASER, "target.mass": pair.TARGET}
TABLE = {"friction.coefficient": MU, "friction.creep": CREEP, "thrust.level": 0.0}


def on_table(values: dict[str, Any], **terms: str) -> PlainInstance:
    return PlainInstance(MODEL, TERMS | terms, pair.VALUES | TABLE | values)


def moving(chaser: tuple[float, ...], target: tuple[float, ...]) -> dict[str, Any]:
    """A slack line of 12 m, the target 3 m ahead, velocities of both [m/s]."""
    c, t = np.array(chaser), np.array(target)
    mean = (pair.CHASER * c + pair.TARGET * t) / (pair.CHASER + pair.TARGET)
    return {
        "start_relative_position": (0.0, 3.0, 0.0),
        "start_relative_velocity": tuple(t - c),
        "start_center_velocity": tuple(mean),
    }


def kinetic(i: PlainInstance) -> float:
    """Of both bodies [J]."""
    speeds = [float(np.linalg.norm(i.array(f"{body}_velocity"))) for body in ("chaser", "target")]
    return 0.5 * (pair.CHASER * speeds[0] ** 2 + pair.TARGET * speeds[1] ** 2)


def test_a_sled_stops(validated: Validated) -> None:
    """It slows by mu g, stops after v^2/(2 mu g), stays, and has lost mu m g s; the other one never moves."""
    speed = 0.2
    i = on_table(moving((0.0, 0.0, 0.0), (0.12, 0.16, 0.0)))
    start = i.array("target_position").copy()
    i.step(0.5)
    assert np.linalg.norm(i.array("target_velocity")) == pytest.approx(speed - SLOWING * 0.5, rel=1e-3)
    assert i["friction.target_force"] == pytest.approx(MU * pair.TARGET * GRAVITY, rel=1e-3)
    i.step(1.0)
    way = i.array("target_position") - start
    distance = float(np.linalg.norm(way))
    law = closed_form("v^2/(2 mu g)")
    validated(law, "a sled on a table: the way to its stop", distance, speed**2 / (2.0 * SLOWING), "m", rel=1e-3)
    smooth = (speed * math.hypot(speed, CREEP) + CREEP**2 * math.asinh(speed / CREEP)) / (2.0 * SLOWING)
    assert distance == pytest.approx(smooth, rel=1e-7)
    assert way[:2] / distance == pytest.approx([0.6, 0.8])
    i.step(0.5)
    assert np.linalg.norm(i.array("target_position") - start) == pytest.approx(distance, abs=1e-9)
    lost = closed_form("mu m g s")
    what = "a sled on a table: what friction has taken"
    validated(lost, what, i["friction.loss"], MU * pair.TARGET * GRAVITY * distance, "J", rel=1e-3)
    assert i["friction.loss"] == pytest.approx(0.5 * pair.TARGET * speed**2, rel=1e-7)
    assert np.linalg.norm(i.array("chaser_velocity")) < 1e-12


def test_what_pulls_less_than_friction_moves_nothing() -> None:
    """It creeps at c f/sqrt(1 - f^2); what pulls more goes at (F - mu m g)/m."""
    full = MU * pair.CHASER * GRAVITY
    for share in (0.5, 1.5):
        i = on_table({"thrust.level": share * full} | moving((0.0, 0.0, 0.0), (0.0, 0.0, 0.0)))
        i.step(0.4)
        speed = float(i.array("chaser_velocity")[1])
        if share < 1.0:
            assert speed == pytest.approx(CREEP * share / math.sqrt(1.0 - share**2), rel=1e-6)
        else:
            assert speed == pytest.approx((share - 1.0) * SLOWING * 0.4, rel=2.0 * CREEP / 0.04)


def test_a_tow_drags_its_target(validated: Validated) -> None:
    """A steady pull ahead of two sleds on a taut line: T = m_t/M F, friction or not; energy with what it took."""
    force, drawn = 20.0, 12.0 + 1e-9
    values = {"thrust.level": -force, "tether.damping_ratio": 0.7, "start_relative_position": (0.0, drawn, 0.0)}
    i = on_table(
        values | {"start_center_velocity": (0.0, -1.0, 0.0), "tether.youngs_modulus": 40 * 50.0 / pair.SECTION}
    )
    start = i.array("chaser_position").copy()
    i.step(4.0)
    expected = force * pair.TARGET / (pair.CHASER + pair.TARGET)
    validated(closed_form("F m_t/M"), "a tow on a table: tension", i["tether.tension"], expected, "N", rel=1e-3)
    rate = (force / (pair.CHASER + pair.TARGET) - SLOWING) * 4.0
    center = float(i.array("center_velocity")[1])
    law = closed_form("(F/M - mu g) t")
    validated(law, "a tow on a table: what its speed gains", -center - 1.0, rate, "m/s", rel=1e-4)
    work = force * float(start[1] - i.array("chaser_position")[1])
    assert i["friction.loss"] < work
    assert i["friction.loss"] == pytest.approx(MU * GRAVITY * 30.0 * (4.0 + 0.5 * rate * 4.0), rel=2e-3)


def test_a_line_lies_on_the_table() -> None:
    """Nodes of a slack line stop as the bodies do; what all had is what friction took."""
    terms = {"lumped": "nodes"}
    values = moving((0.0, 0.1, 0.0), (0.0, 0.1, 0.0)) | {"lumped.nodes": 2, "lumped.density": 60e3}
    i = on_table(values, **terms)
    node = i["lumped.mass"] / 2
    before = 0.5 * (30.0 + 2 * node) * 0.1**2
    i.step(0.3)
    _, rates = pair.nodes_of(i)
    assert rates == pytest.approx(np.zeros((2, 3)), abs=1e-9)
    slowed = 0.1 - SLOWING * 0.3
    assert i.array("target_velocity")[1] == pytest.approx(slowed, rel=1e-3)
    assert kinetic(i) + node * slowed**2 + i["friction.loss"] == pytest.approx(before, rel=1e-4)


BRAKED = 3.0
"""Friction of a drum [N]."""


def test_a_line_drawn_off_a_brake_stops_its_sled(validated: Validated) -> None:
    """Reel and tether are deployed on the table: a sled flies off at v and draws line against the drum's friction F.

    The heavier sled with the reel stays, as F < mu m_c g; the other stops after v^2/(2 (F/m + mu g)), to what the line
    stretches by. Of its energy the drum has F s, the table mu m g s.
    """
    speed, mass = 0.4, pair.TARGET
    stiff = {"tether.youngs_modulus": 4e3 * pair.AXIAL / pair.SECTION, "reel.brake_force": BRAKED}
    flies = {"start_center_velocity": (0.0, speed * mass / (mass + pair.CHASER), 0.0)}
    i = on_table(stiff | pair.apart(pair.LENGTH, 0.0, speed, 0.0) | flies, reel="brake")
    assert BRAKED < MU * pair.CHASER * GRAVITY
    start = i.array("target_position").copy()
    i.step(1.5)
    assert np.linalg.norm(i.array("chaser_velocity")) < 2.0 * CREEP
    way = float(i.array("target_position")[1] - start[1])
    law, what = closed_form("v^2/(2 (F/m + mu g))"), "a sled that draws line off a brake on a table: its way"
    validated(law, what, way, speed**2 / (2.0 * (BRAKED / mass + SLOWING)), "m", rel=1e-2)
    drawn = i["reel.paid_out"] - pair.LENGTH
    assert drawn == pytest.approx(way, rel=2e-2)
    assert i["reel.heat"] == pytest.approx(BRAKED * drawn, rel=1e-3)
    stretched = BRAKED**2 * pair.LENGTH / (2.0 * 4e3 * pair.AXIAL)
    left = 0.5 * mass * speed**2 - i["reel.heat"] - i["friction.loss"]
    assert left == pytest.approx(0.0, abs=stretched + 0.01 * 0.5 * mass * speed**2)
    assert i["friction.loss"] == pytest.approx(MU * mass * GRAVITY * way, rel=2e-2)


def test_a_winch_hauls_a_sled_over_the_table(validated: Validated) -> None:
    """A schedule hauls at an even rate: the line bears mu m g of the sled it hauls, and the motor gives that times the
    way, to which the other sled, held by its own friction, adds nothing."""
    rate = 0.05
    winch = schedule((0.0, 12.0), (1.0, 12.0), (101.0, 12.0 - 100.0 * rate)) | ROOMY
    winch |= {"reel.sample_time": 0.1, "tether.damping_ratio": 0.7}
    winch["tether.youngs_modulus"] = 40.0 * pair.AXIAL / pair.SECTION
    i = on_table(winch | pair.apart(pair.LENGTH - 1e-3, 0.0, 0.0, 0.0), reel="schedule")
    i.step(4.0)
    before = i["reel.work"]
    at = i.array("target_position").copy()
    i.step(2.0)
    way = float(at[1] - i.array("target_position")[1])
    assert way == pytest.approx(2.0 * rate, rel=2e-2)
    law, what = closed_form("mu m g"), "a sled hauled over a table by a winch: tension"
    validated(law, what, i["tether.tension"], MU * pair.TARGET * GRAVITY, "N", rel=2e-2)
    assert i["reel.work"] - before == pytest.approx(MU * pair.TARGET * GRAVITY * way, rel=3e-2)


def test_the_scene_gets_tight_when_the_closed_form_says(validated: Validated) -> None:
    """The chaser alone, from rest, over the slack: sqrt(2 s/a), at sqrt(2 s a), a = F/m - mu g."""
    main = load("friction-table").phases[0].main
    i = PlainInstance(MODEL, main.terms, dict(main.parameters))
    i.step(4.0)
    pushed = 0.5 / 30.0 - 2e-4 * GRAVITY
    law, what = closed_form("sqrt(2 s/a), a = F/m - mu g"), "friction-table: first tug"
    validated(law, f"{what}, its time", i["tug[1].time"], math.sqrt(2.0 * 0.1 / pushed), "s", rel=1e-3)
    validated(law, f"{what}, its speed", i["tug[1].speed"], math.sqrt(2.0 * 0.1 * pushed), "m/s", rel=1e-4)


@pytest.mark.parametrize(("group", "term"), [("environment", "central"), ("target", "rigid"), ("chaser", "rigid")])
def test_what_no_table_carries_is_refused(group: str, term: str) -> None:
    with pytest.raises(ValueError, match=f"friction on a table needs {group}"):
        make_entry(TERMS | {group: term})
