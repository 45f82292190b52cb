"""Sweeps in Python: a frame that knows its units, the rows of the command line, and a folder to go on in."""

from __future__ import annotations

from pathlib import Path

import pandas as pd
import pytest
from astropy import units

import dcone_cosim as dc
from dcone_cosim.errors import InputError
from tests.runs import COARSE

KEY = "removal.tether.diameter"


@pytest.fixture(scope="module")
def scene() -> dc.Scene:
    return dc.Scene("mission", COARSE)


def test_a_sweep(scene: dc.Scene, tmp_path: Path) -> None:
    frame = dc.sweep(scene, {KEY: ["1 mm", 2.0 * units.mm]}, tmp_path / "sweep", jobs=1)
    assert frame[KEY].tolist() == [1e-3, 2e-3]
    assert frame.attrs["units"][KEY] == "m"
    assert frame.attrs["units"]["removal.first_tug_peak"] == "N"
    assert (frame["status"] == "completed").all()
    pd.testing.assert_frame_equal(frame, pd.read_parquet(tmp_path / "sweep" / "table.parquet"))
    rows = {path.name: path.stat().st_mtime_ns for path in (tmp_path / "sweep" / "rows").iterdir()}
    longer = dc.sweep(scene, {KEY: ["1 mm", 2.0 * units.mm, "3 mm"]}, tmp_path / "sweep", jobs=1)
    assert len(longer) == 3
    assert rows.items() <= {p.name: p.stat().st_mtime_ns for p in (tmp_path / "sweep" / "rows").iterdir()}.items()


def test_a_value_of_the_scene_gives_way(scene: dc.Scene) -> None:
    """What is varied is not fixed; without a folder nothing is kept."""
    before = set(Path.cwd().iterdir())
    frame = dc.sweep(scene.with_({KEY: "5 mm"}), {KEY: ["1 mm"]}, jobs=1)
    assert frame[KEY].tolist() == [1e-3]
    assert set(Path.cwd().iterdir()) == before


@pytest.mark.parametrize(
    ("values", "said"),
    [
        ({}, "nothing is varied"),
        ({KEY: []}, "nothing is varied"),
        ({KEY: "1 mm"}, "expected several values"),
        ({KEY: ["1 kg", "2 kg"]}, "length"),
        ({"removal.tether.diametre": ["1 mm", "2 mm"]}, "did you mean"),
    ],
)
def test_what_is_refused(scene: dc.Scene, values: dict[str, object], said: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=said):
        dc.sweep(scene, values, tmp_path / "out")  # type: ignore[arg-type]
    assert not (tmp_path / "out").exists()
