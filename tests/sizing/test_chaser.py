"""Reel, attitude control and disposal against sums by hand and against the scenes they are taken from."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import pytest

from dcone_cosim.cases.rows import Row
from dcone_cosim.sizing.chaser import of_attitude, ways
from dcone_cosim.sizing.ground import Found
from dcone_cosim.sizing.options import Options
from dcone_cosim.sizing.result import Sizing

NOTHING: dict[str, Any] = {"extremes": {}}


def test_reel(done: Sizing) -> None:
    assert done.study is not None
    found = done["reel"].set_index("what").value
    every = [run for _, run in done.study.all]
    assert found["holding force"] == max(run.peak for run in every)
    fastest = max(abs(tug[2]) for run in every for tug in run.tugs)
    assert found["energy of a tug"] == pytest.approx(0.5 * 2000.0 / 3.0 * fastest**2)
    assert found["rate"] >= fastest
    peak, speed = max(((tug[1], tug[2]) for run in every for tug in run.tugs), key=lambda one: one[0])
    assert found["power of a brake"] == pytest.approx(peak * speed)


def test_attitude(done: Sizing) -> None:
    """The hardest tug's momentum is its tension over its time, and so is that beside the centre."""
    assert done.study is not None
    found = done["attitude"].set_index("what").value
    tug = done.study.nominal.worst
    assert tug is not None
    zeta, stiffness, mass = 0.05, 60e9 * math.pi * 1e-6 / 4.0 / 12.0, 2000.0 / 3.0
    w = math.sqrt(stiffness / mass)
    lasts = 2.0 * math.acos(zeta) / (w * math.sqrt(1.0 - zeta**2))
    steps = 20000
    place, speed, given = 0.0, tug[2], 0.0
    for _ in range(steps):  # the snap itself, step by step
        tension = stiffness * place + 2.0 * zeta * math.sqrt(stiffness * mass) * speed
        given += max(tension, 0.0) * lasts / steps
        speed -= tension / mass * lasts / steps
        place += speed * lasts / steps
    assert found["momentum it leaves"] == pytest.approx(0.1 * given, rel=2e-3)
    assert found["torque of the hardest tug"] == pytest.approx(0.1 * tug[1])
    assert found["time to take that up"] == pytest.approx(found["momentum it leaves"] / 0.2)


@pytest.mark.parametrize("orbits", [0.5, 1.01])
def test_what_is_steady_has_no_tug_in_it(orbits: float) -> None:
    """A run that ends with a tug of 30 N and keeps 0.03 N: by hand, 0.2 m aside, over an orbit of 7178.137 km."""
    period = 2.0 * math.pi * math.sqrt(7178137.0**3 / 3.986004418e14)
    figures = {"removal.tension_mean": 0.02, "removal.tension_largest": 30.0, "removal.tension_window": orbits * period}
    run = Found(30.0, [(10.0, 30.0, 0.02)], Row("key", "completed", figures=figures, samples={"removal": NOTHING}))
    values = {
        "orbit.altitude": 800e3, "chaser.mass": 2000.0, "target.mass": 1000.0, "tether.rest_length": 12.0,
        "tether.damping_ratio": 0.05, "tether.diameter": 1e-3, "tether.youngs_modulus": 60e9,
    }  # fmt: skip
    ground: Any = SimpleNamespace(values=values)
    found = {one.what: one.value for one in of_attitude(ground, run, 0.03, Options(offset=0.2, torque=0.5))}
    assert found["steady torque"] == pytest.approx(0.006)
    assert found["share of the authority"] == pytest.approx(0.012)
    assert found["torque of the hardest tug"] == pytest.approx(6.0)
    assert found["share of the authority, in it"] == pytest.approx(12.0)
    mean = 0.03 if orbits < 1.0 else 0.02
    assert found["momentum per orbit"] == pytest.approx(mean * 0.2 * period)


def test_a_plume_that_the_scene_names_is_taken_off() -> None:
    """Newton for both: m_c a = F - T and m_t a = T - b F; the rocket equation with what is left of the thrust."""
    values = {
        "orbit.altitude": 800e3, "chaser.mass": 2000.0, "target.mass": 1000.0, "tether.rest_length": 12.0,
        "plume.half_angle": 0.26, "plume.face": 4.0, "thrust.level": -0.25, "thrust.specific_impulse": 3000.0,
    }  # fmt: skip
    found = {}
    for terms in ({}, {"plume": "beam"}):
        phase = SimpleNamespace(main=SimpleNamespace(terms=terms))
        found[len(terms)] = ways(SimpleNamespace(values=values, phase=phase))[0]  # type: ignore[arg-type]
    plain, plumed = found[0], found[1]
    b, force = plumed.beam, 0.25
    assert 0.1 < b < 0.9
    speed_up = (force - plumed.tension) / 2000.0
    assert speed_up == pytest.approx((plumed.tension - b * force) / 1000.0, rel=1e-12)
    exhaust = 3000.0 * 9.80665
    assert (1.0 - b) * exhaust * math.log(3000.0 / (3000.0 - plumed.propellant)) == pytest.approx(plumed.speed)
    assert plumed.time == pytest.approx(plumed.propellant * exhaust / force)
    assert (plain.beam, plain.tension) == (b, pytest.approx(force / 3.0))
    assert plumed.propellant > 1.1 * plain.propellant


def test_disposal_is_that_of_the_scenes(done: Sizing) -> None:
    """33.8 kg and 46 days by `electric-tug`, 212 kg by `chemical-tug`, whose long burn loses a seventh to gravity."""
    found = done["disposal"].set_index("way")
    electric = found.loc["electric, as `electric-tug`"]
    assert electric.propellant == pytest.approx(33.8, rel=0.01)
    assert electric.time / 86400.0 == pytest.approx(46.0, rel=0.02)
    assert electric.power == pytest.approx(6.1e3, rel=0.02)
    chemical = found.loc["chemical, as `chemical-tug`"]
    assert 0.8 * 212.0 < chemical.propellant < 212.0
    assert math.isnan(chemical.power)
    own = found.loc["the scene's own"]
    assert own.time / (365.25 * 86400.0) == pytest.approx(3.16, rel=0.01)
    assert own.tension == pytest.approx(0.01 / 3.0)
