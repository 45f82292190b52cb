"""What becomes of a tow whose thrust stops or whose line is cut: against Kepler, and against closed forms."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from dcone_cosim.errors import Interrupted
from dcone_cosim.phases import passive
from dcone_cosim.phases.passive import Instant, Nearest, conic, nearest, worst
from orbital.constants import EARTH_EQUATORIAL_RADIUS, EARTH_MU
from orbital.kepler import propagate
from tests.cosim.conftest import Dcone


@pytest.mark.parametrize(("eccentricity", "speed"), [(0.0, 1.0), (0.1, 1.05), (0.9, 1.378)])
def test_conics_are_those_of_kepler(eccentricity: float, speed: float) -> None:
    position = np.array([7178e3, 100.0, -2e3])
    velocity = np.array([30.0, 1.0, 0.5]) + speed * math.sqrt(EARTH_MU / 7178e3) * np.array([0.0, 0.6, 0.8])
    times = np.linspace(0.0, 30000.0, 61)
    found, rates = conic(position, velocity, times)
    for t, r, v in zip(times, found, rates, strict=True):
        there, moving = np.zeros(3), np.zeros(3)
        propagate.py_func(there, moving, position, velocity, float(t), EARTH_MU)  # type: ignore[attr-defined]
        assert np.linalg.norm(r - there) < 1e-5
        assert np.linalg.norm(v - moving) < 1e-8


def test_two_bodies_that_pass_between_two_looks() -> None:
    times = np.arange(5.0)
    position = np.stack([-2.3 + times, np.full(5, 0.4), np.zeros(5)], axis=1)
    velocity = np.tile([1.0, 0.0, 0.0], (5, 1))
    assert nearest(times, position, velocity) == (pytest.approx(0.4), pytest.approx(2.3))
    assert nearest(times[:3], position[:3], velocity[:3]) == (pytest.approx(0.5), 2.0)


@pytest.mark.filterwarnings("error")
def test_of_what_comes_back_to_the_same_place_the_ends_are_nearest() -> None:
    there = np.array([[3.0, 4.0, 0.0], [3.0, 4.0, 0.0]])
    assert nearest(np.array([0.0, 1.0]), there, np.array([[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]])) == (5.0, 0.0)


def test_the_worst_of_the_instants() -> None:
    instants = [
        Instant(0.0, 10.0, Nearest(5.0, 1.0), None),
        Instant(60.0, 10.0, Nearest(3.0, 2.0), Nearest(9.0, 7.0)),
        Instant(120.0, 10.0, None, Nearest(1.0, 8.0)),
    ]
    stopped, cut = worst(instants, 4.0)
    assert (stopped.distance, stopped.time, stopped.after, stopped.meets, stopped.tried) == (3.0, 60.0, 2.0, 1, 2)
    assert (cut.distance, cut.time, cut.after, cut.meets, cut.tried) == (1.0, 120.0, 8.0, 1, 2)


FIELD_FREE = """
title = "A pair that is pulled together"
phases = ["removal"]
[removal]
macro_step = "1 s"
duration = "20 s"
safety_every = "5 s"
safety_horizon = "1000 s"
[removal.environment]
field = "none"
[removal.reel]
law = "locked"
[removal.tether]
rest_length = "12 m"
[removal.start]
condition = "equal_velocity"
leading = "chaser"
separation = "12 m"
[removal.thrust]
direction = "tether"
level = "50 N"
specific_impulse = "300 s"
[removal.target]
mass = "1000 kg"
[removal.chaser]
mass = "2000 kg"
"""


def test_a_chaser_that_flies_at_its_target(dcone: Dcone, tmp_path: Path) -> None:
    """Without a field the chaser gathers speed and coasts into its target: the line stays slack, so that stopped and
    cut come to the same, and at the start it is at rest and stays away."""
    (tmp_path / "pair.toml").write_text(FIELD_FREE)
    code, _, err = dcone("run", "pair.toml", "-o", "out")
    assert code == 0, err
    import pyarrow.parquet

    table = pyarrow.parquet.read_table(tmp_path / "out" / "removal_passive_safety.parquet").to_pandas()
    assert list(table["time"]) == [0.0, 5.0, 10.0, 15.0, 20.0]
    acceleration = 50.0 / 2000.0
    for row in table.itertuples(index=False):
        values: dict[str, Any] = dict(zip(table.columns, row, strict=True))
        speed = acceleration * values["time"]
        apart = 12.0 - 0.5 * acceleration * values["time"] ** 2
        expected = 12.0 if speed == 0.0 else 0.0
        assert values["separation"] == pytest.approx(apart, abs=1e-9)
        # with the thrust on they would meet from the first instant as well
        for what in ("stopped", "cut"):
            assert values[f"{what}.least_distance"] == pytest.approx(expected, abs=1e-6)
        # on its line it comes back, and is as near once more
        if speed:
            assert values["cut.after"] == pytest.approx(apart / speed, rel=1e-6)
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert "may meet" in json.dumps(summary["warnings"])
    assert err.count("may meet: at worst") == 2


def test_a_tow_on_its_orbit_that_lets_go(dcone: Dcone, tmp_path: Path) -> None:
    """Table 2, cut once it swings: what comes of it by Clohessy and Wiltshire from the relative state in the table."""
    setting = ("--set", "removal.duration='2 h'", "--set", "removal.safety_every='20 min'")
    code, _, err = dcone("run", "table2-deorbit", *setting, "-o", "out")
    assert code == 0, err
    import pyarrow.parquet

    rows = pyarrow.parquet.read_table(tmp_path / "out" / "removal.parquet").to_pandas().set_index("time")
    table = pyarrow.parquet.read_table(tmp_path / "out" / "removal_passive_safety.parquet").to_pandas()
    n = math.sqrt(EARTH_MU / (EARTH_EQUATORIAL_RADIUS + 800e3) ** 3)
    t = np.linspace(0.0, 10800.0, 20001)
    c, s = np.cos(n * t), np.sin(n * t)
    for row in table.itertuples(index=False):
        values = dict(zip(table.columns, row, strict=True))
        at = rows.loc[values["time"]]
        x, y, z = (at[f"relative.position[{i}]"] for i in (1, 2, 3))
        u, v, w = (at[f"relative.velocity[{i}]"] for i in (1, 2, 3))
        radial = (4.0 - 3.0 * c) * x + s / n * u + 2.0 / n * (1.0 - c) * v
        along = 6.0 * (s - n * t) * x + y - 2.0 / n * (1.0 - c) * u + (4.0 * s - 3.0 * n * t) / n * v
        across = z * c + w / n * s
        least = float(np.sqrt(radial**2 + along**2 + across**2).min())
        assert values["cut.least_distance"] == pytest.approx(least, rel=2e-3)


def test_an_interrupt_keeps_the_tow(dcone: Dcone, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What has been simulated is written, whatever becomes of the look at its safety."""

    def stop(*_: object) -> None:
        raise Interrupted("asked to end")

    (tmp_path / "pair.toml").write_text(FIELD_FREE)
    monkeypatch.setattr(passive.interrupts, "check", lambda name, time: stop() if time == 0.0 and looking else None)
    looking: list[int] = []
    examine = passive.examine
    monkeypatch.setattr(passive, "examine", lambda *given: looking.append(1) or examine(*given))
    code, _, err = dcone("run", "pair.toml", "-o", "out")
    assert code == Interrupted.exit_code, err
    assert json.loads((tmp_path / "out" / "summary.json").read_text())["status"] == "interrupted"
    assert (tmp_path / "out" / "removal.parquet").is_file()


@pytest.mark.evidence
def test_bodies_that_the_fmu_sees_meet_are_told(dcone: Dcone, tmp_path: Path) -> None:
    """An FMU that ends where they come within the clearance shows them up to there: 1 + 1 + 0.5 m."""
    ends = '[removal.ends]\nchaser_extent = "1 m"\ntarget_extent = "1 m"\nclearance = "0.5 m"\n'
    (tmp_path / "pair.toml").write_text(FIELD_FREE + ends)
    code, _, err = dcone("run", "pair.toml", "-o", "out")
    assert code == 0, err
    import pyarrow.parquet

    table = pyarrow.parquet.read_table(tmp_path / "out" / "removal_passive_safety.parquet").to_pandas()
    assert table["stopped.least_distance"][1:].to_list() == pytest.approx([2.5] * (len(table) - 1), rel=1e-6)
    assert f"the thrust stops at {len(table) - 1} of {len(table)} instants" in err
