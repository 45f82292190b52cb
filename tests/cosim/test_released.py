"""Where two bodies go that no line holds: their nearest return, and their apsides."""

from __future__ import annotations

from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import minimize_scalar

from dcone_cosim.phases import lowering
from dcone_cosim.phases.lowering import axis_of
from dcone_cosim.phases.passive import conic
from dcone_cosim.phases.released import apsides, findings, nearest_return, returning
from orbital.constants import EARTH_EQUATORIAL_RADIUS, EARTH_J2, EARTH_MU


def test_nearest_return_of_two_orbits() -> None:
    """Between rows a minute apart: against a search over the orbits themselves."""
    r = EARTH_EQUATORIAL_RADIUS + 500e3
    v = float(np.sqrt(EARTH_MU / r))
    first = np.array([r, 0.0, 0.0]), np.array([0.0, v, 0.0])
    second = np.array([r + 20.0, 5.0, 3.0]), np.array([0.4, v - 0.03, 0.2])
    time = np.arange(0.0, 12000.0, 60.0)
    (p, u), (q, w) = conic(*first, time), conic(*second, time)

    def apart(t: float) -> float:
        (a, _), (b, _) = conic(*first, np.array([t])), conic(*second, np.array([t]))
        return float(np.linalg.norm(b - a))

    found = nearest_return(time, q - p, w - u)
    assert found is not None
    best = minimize_scalar(
        apart, bounds=(found.after - 90.0, found.after + 90.0), method="bounded", options={"xatol": 1e-6}
    )
    assert found.distance == pytest.approx(best.fun, rel=1e-4)
    assert found.after == pytest.approx(best.x, abs=0.1)
    assert found.after > 100.0
    assert found.distance < min(apart(t) for t in time[2:] if apart(t - 60.0) > apart(t) < apart(t + 60.0))


def test_none_of_what_drifts_apart() -> None:
    time = np.linspace(0.0, 100.0, 11)
    away = np.outer(1.0 + time, [1.0, 0.0, 0.0])
    assert nearest_return(time, away, np.tile([1.0, 0.0, 0.0], (11, 1))) is None


def test_apsides() -> None:
    low, high = EARTH_EQUATORIAL_RADIUS + 200e3, EARTH_EQUATORIAL_RADIUS + 600e3
    axis = 0.5 * (low + high)
    speed = float(np.sqrt(EARTH_MU * (2.0 / high - 1.0 / axis)))
    found = apsides(np.array([0.0, high, 0.0]), np.array([0.0, 0.0, speed]))
    assert found == pytest.approx((axis, (high - low) / (high + low), 200e3, 600e3), rel=1e-9)


class Rows(dict[str, Any]):
    """As much of a recorder as reports look at."""

    @property
    def names(self) -> list[str]:
        return list(self)

    def last(self) -> dict[str, float]:
        return {name: float(column[-1]) for name, column in self.items()}

    def __len__(self) -> int:
        return len(self["time"])


def told(terms: Mapping[str, str], columns: Mapping[str, Any], values: Mapping[str, float]) -> tuple[Any, Any]:
    main = SimpleNamespace(terms=terms, defaults={}, asked={}, fmu=None)
    run = SimpleNamespace(
        scene=SimpleNamespace(phases=[SimpleNamespace(name="removal", main=main)]), parameters={"removal": values}
    )
    rows = Rows(columns)
    return run, SimpleNamespace(recorder=rows, start=0.0, end=float(rows["time"][-1]), name="removal")


def test_a_flattened_earth_lowers_no_orbit_by_itself() -> None:
    """An axis that breathes by 20 km, at an energy that stays; with an engine the pair's mass falls beside it."""
    time = np.linspace(0.0, 6000.0, 101)
    breathing = 7.178e6 + 1e4 * np.cos(2.0 * np.pi * time / 4500.0)
    used = time / 600.0
    for engine in ({}, {"engine": "electric"}):
        mass = 3000.0 - (used if engine else 0.0)
        columns = {
            "time": time, "center.semi_major_axis": breathing, "separation": np.full(101, 12.0), "altitude": time,
            "energy.orbital": -0.5 * EARTH_MU * mass / (7.178e6 - 0.1 * time), "chaser.propellant": used,
        }  # fmt: skip
        values = {"chaser.mass": 2000.0, "target.mass": 1000.0}
        run, result = told({"oblateness": "J2", **engine}, columns, values)
        assert axis_of(run, "removal", result) == pytest.approx(7.178e6 - 0.1 * time, rel=1e-12)
        run, result = told(engine, columns, values)
        assert axis_of(run, "removal", result) == pytest.approx(breathing)


def test_of_an_fmu_from_elsewhere_the_axis_goes_by_energy_or_is_not_told() -> None:
    """Nothing says what its gravity is: 600 m are lost beside a breath of 20 km, by its energy or not at all; without a
    breath, by its axis."""
    time = np.linspace(0.0, 6000.0, 101)
    breath = 1e4 * np.cos(2.0 * np.pi * time / 3000.0)
    columns = {"time": time, "separation": np.full(101, 12.0), "altitude": time}
    energy = {"energy.orbital": -0.5 * EARTH_MU * 3000.0 / (7.178e6 - 0.1 * time)}
    values = {"chaser.mass": 2000.0, "target.mass": 1000.0}
    for axis, known, lowered in (
        (7.178e6 - 0.1 * time + breath, energy, 600.0),
        (7.178e6 - 0.1 * time + breath, {}, None),
        (7.178e6 - 0.1 * time, {}, 600.0),
    ):
        run, result = told({}, {**columns, **known, "center.semi_major_axis": axis}, values)
        run.scene.phases[0].main.fmu = "elsewhere.fmu"
        found = next(iter(lowering.findings(run, "removal", result)))
        if lowered is None:
            assert "not reported: its osculating axis goes up and down by about 2e+04 m" in str(found.value)
        else:
            assert found.value == pytest.approx(lowered, rel=1e-6)


def test_of_an_fmu_from_elsewhere_only_the_time_with_a_line_says_what_its_axis_does() -> None:
    """Cut half-way, after 300 m: 500 km apart at the end, which says nothing of the breath while they were held; and
    the apsides of each body are told as what they are, since its gravity is not known."""
    time = np.linspace(0.0, 6000.0, 101)
    cut = time > 3000.0
    axis = 7.178e6 - 0.1 * time
    columns = {
        "time": time, "altitude": time, "separation": np.where(cut, 500e3, 12.0),
        "center.semi_major_axis": axis + 1e4 * np.cos(2.0 * np.pi * time / 3000.0),
        "energy.orbital": -0.5 * EARTH_MU * 3000.0 / axis,
        "release.released": cut, "release.time": np.where(cut, 3000.0, 0.0),
    }  # fmt: skip
    for body in ("chaser", "target"):
        for k, (place, speed) in enumerate(((7.178e6, 0.0), (0.0, 7500.0), (0.0, 0.0)), start=1):
            columns |= {f"{body}.position[{k}]": np.full(101, place), f"{body}.velocity[{k}]": np.full(101, speed)}
    run, result = told({}, columns, {"chaser.mass": 2000.0, "target.mass": 1000.0})
    run.scene.phases[0].main.fmu = "elsewhere.fmu"
    found = next(iter(lowering.findings(run, "removal", result)))
    assert found.value == pytest.approx(300.0, rel=1e-6)
    labels = {one.key: one.label for one in findings(run, "removal", result)}
    assert labels["chaser_perigee"] == "chaser's perigee at the end, osculating"


def test_what_is_told_of_two_bodies_that_no_line_holds() -> None:
    """The nearest return counts from the cut, a pass before it does not; each body has its apsides and its lifetime."""
    time = np.arange(0.0, 1001.0, 10.0)
    place = np.stack([np.abs(time - 605.0) - 0.0, np.full(101, 30.0), np.zeros(101)], axis=1)
    speed = np.stack([np.sign(time - 605.0), np.zeros(101), np.zeros(101)], axis=1)
    early = time < 300.0
    place[early] = np.stack([time[early] - 100.0, np.full(early.sum(), 3.0), np.zeros(early.sum())], axis=1)
    speed[early] = 1.0, 0.0, 0.0
    radius = EARTH_EQUATORIAL_RADIUS + 250e3
    columns = {"time": time, "release.released": (time >= 320.0).astype(float), "release.time": np.full(101, 320.0)}
    for k in range(3):
        columns[f"relative.position[{k + 1}]"], columns[f"relative.velocity[{k + 1}]"] = place[:, k], speed[:, k]
        for body in ("chaser", "target"):
            columns[f"{body}.position[{k + 1}]"] = np.full(101, (radius, 0.0, 0.0)[k])
            columns[f"{body}.velocity[{k + 1}]"] = np.full(101, (0.0, np.sqrt(EARTH_MU / radius), 0.0)[k])
    values = {
        "chaser.mass": 2000.0, "target.mass": 1000.0, "air.drag_coefficient": 2.2, "air.chaser_area": 0.0,
        "air.target_area": 10.0, "air.base_density": 7e-11, "air.base_altitude": 250e3, "air.scale_height": 45e3,
    }  # fmt: skip
    run, result = told({"air": "exponential", "release": "time"}, columns, values)
    found = {row.key: row for row in findings(run, "removal", result)}
    assert found["released_at"].value == 320.0
    assert 600.0 <= found["return_time"].value <= 610.0
    assert found["return_distance"].label == "nearest return of the bodies (by the rows)"
    assert found["return_distance"].value == pytest.approx(30.0, abs=6.0)
    assert found["chaser_perigee"].value == pytest.approx(250e3, abs=1.0)
    assert "chaser_lifetime" not in found
    assert 1.0 < found["target_lifetime"].value / 86400.0 < 60.0
    assert list(returning("removal", result, 20.0)) == []
    assert "may meet" in next(returning("removal", result, 50.0))
    empty = values | {"chaser.mass": 1000.0, "air.chaser_area": 10.0}
    lives = []
    for terms, full in (({}, {"chaser.mass": 1000.0}), ({"engine": "chemical"}, {"chaser.mass": 1500.0})):
        tank = columns | {"chaser.propellant": np.linspace(0.0, 500.0, 101)}
        run, result = told({"air": "exponential", "release": "time", **terms}, tank, empty | full)
        lives.append({row.key: row.value for row in findings(run, "removal", result)})
    assert lives[0]["chaser_lifetime"] == lives[1]["chaser_lifetime"] == lives[1]["target_lifetime"]
    columns |= {"release.returned": np.ones(101), "release.return_distance": np.full(101, 12.5)}
    columns["release.return_time"] = np.full(101, 611.0)
    run, result = told({}, columns, values)
    found = {row.key: row for row in findings(run, "removal", result)}
    assert found["return_distance"].label == "nearest return of the bodies"
    assert (found["return_distance"].value, found["return_time"].value) == (12.5, 611.0)
    assert "may meet" in next(returning("removal", result, 20.0))
    columns["release.returned"] = np.zeros(101)
    run, result = told({}, columns, values)
    found = {row.key: row for row in findings(run, "removal", result)}
    assert found["return_distance"].value == "none within the run"
    columns["relative.velocity[1]"] = -np.ones(101)
    run, result = told({}, columns, values)
    found = {row.key: row for row in findings(run, "removal", result)}
    assert found["return_distance"].value == "none within the run, which ends as they come nearer"
    columns["release.released"] = np.zeros(101)
    run, result = told({}, columns, values)
    assert [row.value for row in findings(run, "removal", result)] == ["not within the run"]


def test_what_is_told_of_an_orbit_does_not_hang_on_the_instant() -> None:
    """Round a flattened Earth: of states of one revolution, by scipy, the same perigee and lifetime in the mean."""
    radius = EARTH_EQUATORIAL_RADIUS + 250e3
    speed = float(np.sqrt(EARTH_MU / radius))

    def slope(_: float, y: Any) -> Any:
        r, up = np.linalg.norm(y[:3]), np.array([0.0, 0.0, 1.0])
        k = 1.5 * EARTH_J2 * (EARTH_EQUATORIAL_RADIUS / r) ** 2
        return [*y[3:], *(-EARTH_MU / r**3 * ((1.0 + k * (1.0 - 5.0 * (y[2] / r) ** 2)) * y[:3] + 2.0 * k * y[2] * up))]

    begin = [radius, 0.0, 0.0, 0.0, 0.0, speed]
    states = solve_ivp(slope, (0.0, 5400.0), begin, t_eval=np.linspace(0.0, 5400.0, 5), rtol=1e-9, atol=1e-3).y.T
    values = {
        "chaser.mass": 2000.0, "target.mass": 1000.0, "air.drag_coefficient": 2.2, "air.chaser_area": 10.0,
        "air.target_area": 10.0, "air.base_density": 7e-11, "air.base_altitude": 250e3, "air.scale_height": 20e3,
    }  # fmt: skip
    perigees, lives, osculating = [], [], []
    for state in states:
        columns = {"time": np.array([0.0, 1.0]), "release.released": np.ones(2), "release.time": np.zeros(2)}
        for k in range(3):
            columns[f"relative.position[{k + 1}]"] = columns[f"relative.velocity[{k + 1}]"] = np.ones(2)
            for body in ("chaser", "target"):
                columns[f"{body}.position[{k + 1}]"] = np.full(2, state[k])
                columns[f"{body}.velocity[{k + 1}]"] = np.full(2, state[3 + k])
        for terms in ({"oblateness": "J2"}, {}):
            run, result = told({"air": "exponential", "release": "time", **terms}, columns, values)
            found = {row.key: row for row in findings(run, "removal", result)}
            life = found["target_lifetime"].value / 86400.0
            assert float(f"{life:.2g}") == pytest.approx(life, rel=1e-12)
            (lives if terms else osculating).append(life)
            if terms:
                perigees.append(found["target_perigee"].value)
                assert found["target_perigee"].label == "target's perigee at the end, in the mean"
    assert np.ptp(perigees) < 100.0
    assert max(lives) / min(lives) < 1.1
    assert max(osculating) / min(osculating) > 1.3
