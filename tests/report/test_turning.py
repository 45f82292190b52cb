"""How far a point target is off in the first tug: beside a run that tows a body, and within its bound."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pandas as pd
import pytest

from dcone_cosim.commands import run_and_write
from dcone_cosim.progress import Progress
from dcone_cosim.report import tiles, turning
from dcone_cosim.run_reading import read_run


def test_it_is_off_as_a_run_with_that_body_says(kept: Path, tmp_path: Path) -> None:
    run = read_run(kept)
    found = turning.of_run(kept, run, Progress())
    assert found is not None
    settings = ['removal.target.body="box"', "removal.duration=30 min"]
    done = run_and_write(
        str(kept), tmp_path / "box", Progress(), with_figures=False, settings=settings, go_on="removal"
    )
    point, box = (pd.read_parquet(folder / "tugs.parquet").iloc[0] for folder in (kept, done.folder))
    level = json.loads((kept / "ledger.json").read_text())["level"]
    for key, column, bound in (("first_tug", "time", "bound_time"), ("first_tug_peak", "peak", "bound_peak")):
        off = point[column] / box[column] - 1.0
        assert found.share[key] == pytest.approx(off, rel=1e-6)
        assert 0.0 < abs(off) < level[bound]
        assert any(
            f"off by {100.0 * abs(off):.2g} %, bounded by" in tile["since"] for tile in tiles.chief(run, found.share)
        )
    above = point["peak"] > box["peak"]
    assert re.search(rf"peak is [\d.]+ % too {'high' if above else 'low'} and its time", found.said)


def test_without_it_the_bound_alone_is_told_and_called_one(kept: Path) -> None:
    found = turning.of_run(kept, read_run(kept), None)
    assert found is not None
    assert found.share == {}
    assert "was not computed for this page" in found.said
    assert "off by at most" in str(tiles.chief(read_run(kept)))
