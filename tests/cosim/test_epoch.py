"""When a tow begins: a date in the scene, the same instant in its FMU, and air that is made of it."""

from __future__ import annotations

from datetime import UTC, datetime
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from astropy.time import Time

from dcone_cosim.errors import InputError
from dcone_cosim.line import line_of
from dcone_cosim.loading import find, load
from dcone_cosim.phases.second_tow import TowHandover
from dcone_cosim.scene.expected import Expected, Unexpected
from dcone_cosim.scenes.reading import parse
from dcone_cosim.transaction import HandoffRecord
from tests.cosim.test_level import LENGTH, handed

DATE = Expected("s", date=True, minimum=-1.6e9, maximum=1.6e9)
TABLE_2 = find("table2-deorbit").read_text(encoding="utf-8")
EPOCH = ("[orbit]\n", '[orbit]\nepoch = "2026-03-20 14:46"\n')
RIGID = ('[removal.chaser]\nmass = "2000 kg"', '[removal.chaser]\nbody = "rigid"\nmass = "2000 kg"')


@pytest.mark.parametrize(
    "text", ["2026-03-20 14:46", "2026-03-20T14:46:00Z", "2026-03-20T15:46:00+01:00", "9575.115277777777 day"]
)
def test_a_date_is_the_days_since_j2000(text: str) -> None:
    """By astropy's Julian dates, which count days of 86400 s as well."""
    day = Time("2026-03-20 14:46", scale="utc").jd - 2451545.0
    assert DATE.read(text) == pytest.approx(day * 86400.0, abs=1e-3)


@pytest.mark.parametrize("value", [0.0, 827203560.0, 827203560.25, -1e9 / 3.0])
def test_a_date_is_written_as_it_is_read(value: float) -> None:
    assert DATE.read(DATE.written([value])[1:-1]) == value


@pytest.mark.parametrize(
    "value", ["2026-13-20", "tomorrow", "12 m", 2026, datetime(2026, 3, 20, tzinfo=UTC), "1900-01-01"]
)
def test_what_is_no_date_is_told(value: object) -> None:
    with pytest.raises(Unexpected, match=r"2026-03-20 14:46|time|at least"):
        DATE.read(value)


def test_bounds_of_a_date_are_dates() -> None:
    with pytest.raises(InputError, match=r'orbit.epoch = "2051-01-01": must be at most 2050-01-01 00:00:00;'):
        load("eclipse-powered", ('orbit.epoch="2051-01-01"',))
    assert Expected("s", date=True, minimum=0.0).bounds() == "at least 2000-01-01 12:00:00"


def test_a_scene_has_its_air_made_at_its_epoch() -> None:
    pytest.importorskip("pymsis")
    air = '\n[removal.air]\nlaw = "nrlmsis"\nf107 = 150.0\nf107_average = 145.0\nap = 12.0\n'
    found = []
    for date in ("2026-03-20 14:46", "2026-07-01"):
        scene = parse(TABLE_2.replace(EPOCH[0], f'[orbit]\nepoch = "{date}"\n') + air, "air", "air.toml")
        main = scene.phases[0].main
        assert main.parameters["orbit.epoch"] == DATE.read(date)
        assert not {"air.f107", "air.f107_average", "air.ap"} & main.defaults.keys() - main.asked.keys()
        found.append(main.laid["air.harmonics"])
    assert found[0].shape == (93, 49)
    assert abs(found[0] - found[1]).max() > 1e-2
    with pytest.raises(InputError, match=r"removal\.air\.ap"):
        parse(TABLE_2 + air.replace("12.0", "-1.0"), "air", "air.toml")


def test_a_line_that_conducts_spans_two_points() -> None:
    text = TABLE_2.replace(*EPOCH) + '\n[removal.electrodynamic]\nfield = "dipole"\n'
    parse(text, "points", "points.toml")
    with pytest.raises(InputError, match=r"(?s)removal\.electrodynamic\.field = \"dipole\".*spans two points"):
        parse(text.replace(*RIGID), "rigid", "rigid.toml")


def test_a_second_tow_begins_when_the_first_has_ended() -> None:
    phase = SimpleNamespace(
        setting=lambda name: 5000.0, choice=lambda *_: 3, main=SimpleNamespace(defaults=dict[str, float]())
    )
    component: Any = SimpleNamespace(variables={"orbit.epoch": None})
    place, speed = (7e6, 0.0, 0.0), (0.0, 7e3, 1e3)
    left = {f"center.{what}[{i}]": x for what, xs in (("position", place), ("velocity", speed))
            for i, x in enumerate(xs, 1)}  # fmt: skip
    left |= {f"relative.{what}[{i}]": 1.0 for what in ("position", "velocity") for i in (1, 2, 3)}
    left |= {"chaser.mass": 1.0, "target.mass": 1.0}
    for begun, expected in (({}, 5600.0), ({"orbit.epoch": 7000.0}, 7600.0)):
        record = TowHandover(600.0, 0.0, cast("Any", phase), left | begun, None)
        assert record.parameters(component)["orbit.epoch"] == expected


def test_a_tow_begins_when_the_capture_has_ended() -> None:
    scene = load("mission", ('removal.third_bodies.which="moon"', 'orbit.epoch="2026-03-20 14:46"'))
    removal = scene.phases[1]
    turning = np.array([0.0, 0.0, 1e-3])
    found = handed(turning, np.array([0.0, -1.9, 0.0]), np.array([0.0, 11.0, 0.0]), np.array([0.0, 0.02, 0.0]))
    record = HandoffRecord(12.5, 12.5, "told", removal, found, line_of(found, LENGTH))
    component: Any = SimpleNamespace(variables={"orbit.epoch": None})
    assert record.parameters(component)["orbit.epoch"] == DATE.read("2026-03-20 14:46") + 12.5
    assert "orbit.epoch" not in record.parameters(cast("Any", SimpleNamespace(variables={})))
