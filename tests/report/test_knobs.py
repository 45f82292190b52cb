"""What may be moved in a page: where it lies, what it sets, and its two estimates against what they stand for."""

from __future__ import annotations

import json
import math
from pathlib import Path
from types import SimpleNamespace

import pytest

from dcone_cosim.report import knobs
from dcone_cosim.report.knobs import EACH, SPIN, Row, knobs_of
from dcone_cosim.run_reading import read_run
from tests.runs import COARSE, put

ANY = (-math.inf, math.inf)
BOUNDS = {row.name: ANY for row in knobs.ROWS}


def test_a_value_stands_in_its_own_unit_between_its_bounds() -> None:
    row = Row("tether.diameter", "diameter", "mm", 0.1, 10.0, True)
    knob = knobs._own("removal", row, 0.001, (0.0, 0.005), "")
    assert (knob.value, knob.low, knob.high, knob.unit, knob.factor) == (1.0, 0.1, 5.0, "mm", 1e-3)
    assert knob.sets == {"tether.diameter": (0.0, 1.0)}
    assert knob.key == "removal.tether.diameter"
    thrust = knobs._own("removal", knobs.ROWS[-1], -0.01, ANY, "")
    assert (thrust.low, thrust.value, thrust.high) == (-0.05, -0.01, 0.0)


def test_the_length_of_one_line_is_set_in_both_phases(bare: Path) -> None:
    run = read_run(bare)
    phase = run.scene.phases[1]
    found = {knob.key: knob for knob in knobs_of(phase, BOUNDS, run)}
    length = found["removal.tether.rest_length"]
    assert (length.also, length.again) == (("capture.tether.length",), True)
    assert not found["removal.tether.diameter"].again


def test_speed_of_the_shot_against_a_shot_of_that_speed(bare: Path, tmp_path: Path) -> None:
    """The net is shot again a tenth faster; what its estimate hands over is held against what that hands over."""
    run = read_run(bare)
    knob = next(one for one in knobs_of(run.scene.phases[1], BOUNDS, run) if one.key == "capture.bullets.speed")
    assert knob.estimate
    own = run.parameters["removal"]
    for name, (offset, slope) in knob.sets.items():
        assert offset + slope * knob.value == pytest.approx(own[name], rel=1e-12, abs=1e-15)
    faster = put("mission", tmp_path / "faster", (*COARSE, "capture.bullets.speed=3.3 m/s"))
    told = json.loads((faster / "provenance.json").read_text())["phases"]["removal"]["parameters"]
    name = "start.relative_velocity[2]"
    offset, slope = knob.sets[name]
    assert told[name] != pytest.approx(own[name], rel=0.05)
    assert offset + slope * 3.3 == pytest.approx(told[name], rel=2e-3)


@pytest.mark.parametrize("before", ["", "capture"])
def test_spin_keeps_its_axis(before: str) -> None:
    rate = (0.03, -0.04, 0.12)
    values = dict(zip(SPIN, rate, strict=True))
    run = SimpleNamespace(parameters={"capture": {name: 0.1 for name in SPIN}})
    (knob,) = knobs._spin("removal", values, dict.fromkeys(SPIN, ANY), run, before)  # type: ignore[arg-type]
    assert knob.value == pytest.approx(math.degrees(0.13))
    assert [offset + slope * 0.26 for offset, slope in knob.sets.values()] == pytest.approx([2 * x for x in rate])
    assert knob.key.startswith(before or "removal")
    wanted = [0.1 / 0.13] * len(EACH) if before else [x / 0.13 for x in rate]
    assert knob.shares == pytest.approx(wanted)
    assert bool(knob.estimate) == bool(before)
    assert not list(knobs._spin("removal", dict.fromkeys(SPIN, 0.0), dict.fromkeys(SPIN, ANY), run, before))  # type: ignore[arg-type]
