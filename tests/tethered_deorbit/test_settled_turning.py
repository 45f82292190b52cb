"""A settled line on a body that sways: the tow is that of one whose vibration is followed, in a fifth of the steps."""

import numpy as np
import pytest
from numpy.polynomial import Polynomial
from scipy.spatial.transform import Rotation

from fmu_src.instance import Instance
from fmu_src.tethered_deorbit.levels.quintic import quintic_course, swaying_solution
from tests.tethered_deorbit.rigid_pairs import ARM, M_C, M_T, ON_ORBIT, REST, STIFFNESS, pair

SEEN = ("tether.tension", "separation", "tether.impulse", "target.attitude[2]", "target.rate[3]")


def swaying(level: bool) -> Instance:
    """10 N tow 1000 kg made fast 1.9 m off their centre, on a line with its load: they sway within two minutes."""
    turned = Rotation.from_euler("xyz", (0.02, 0.05, 0.1))
    x, y, z, w = turned.as_quat()
    taut = REST + 10.0 * M_T / (M_C + M_T) / STIFFNESS
    return pair(
        ON_ORBIT | ({"level": "settled"} if level else {}),
        {
            "start_relative_position": np.array([0.0, taut, 0.0]) - turned.as_matrix() @ ARM,
            "target_start_attitude": (w, x, y, z),
            "target_start_rate": (0.0, 0.0, 0.0010381),
        },
        thrust__level=-10.0,
        tether__damping_ratio=0.2,
    )


def rows(i: Instance, macro_step: float = 7.0) -> np.ndarray:
    found = []
    while i.time < 700.0:
        i.step(macro_step)
        found.append([i[name] for name in SEEN])
    return np.array(found)


def test_a_body_that_sways_is_that_of_a_line_whose_vibration_is_followed() -> None:
    """In 142 steps in place of 716, tension to 2.0e-7 N of 3.4 N; the same bits whatever the macro step."""
    followed, stepped_over, at_once = swaying(False), swaying(True), swaying(True)
    beside, there = rows(followed), rows(stepped_over)
    assert beside[:, 0].min() > 3.0
    assert np.ptp(beside[20:, 0]) > 0.2
    off = np.abs(there - beside).max(axis=0)
    assert (off < [6e-7, 8e-10, 6e-7, 4e-10, 8e-11]).all(), off
    assert stepped_over["level.settled"]
    assert stepped_over["level.times_settled"] == 1
    assert 4 * stepped_over["solver.steps"] < followed["solver.steps"]
    at_once.step(700.0)
    assert [at_once[name] for name in SEEN] == list(there[-1])


def test_swaying_solution() -> None:
    """Put into m(t) x'' + c x' + k x = P(t), a load of fifth degree and a mass of second, it leaves what is of a degree
    above the fifth alone, and that is nothing."""
    damping, stiffness, span = 0.7, 50.0, 3.0
    load = np.array([2.0, 0.3, -0.5, 0.11, -0.04, 0.02])
    mass = np.array([3.0, 0.8, -0.5])
    x = np.full(6, np.nan)
    swaying_solution(x, load, mass, damping, stiffness, span)
    course = Polynomial(x)
    heavy = Polynomial(mass / span ** np.arange(3))
    left = heavy * course.deriv(2) + damping * course.deriv() + stiffness * course
    wanted = load / span ** np.arange(6)
    assert left.coef == pytest.approx(wanted, abs=1e-13)


def test_the_course_and_its_rates() -> None:
    record = np.zeros(1, dtype=[("state_course", "f8", 6)]).view(np.recarray)
    record[0]["state_course"] = [1.0, -0.3, 0.2, -0.07, 0.03, -0.011]
    course = Polynomial(record[0]["state_course"])
    at = getattr(quintic_course, "py_func", quintic_course)
    wanted = [course(1.7), course.deriv()(1.7), course.deriv(2)(1.7)]
    assert at(record, 1.7) == pytest.approx(wanted, rel=1e-14)
