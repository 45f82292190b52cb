"""A force map on a page, of a table that is written here: the page shows it where it is there, and nothing without."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from dcone_cosim.report.forces import ForceMap
from dcone_cosim.report.page import of_folder
from tests.report.conftest import Page
from tests.report.test_packing import decoded, newtons


@pytest.fixture
def pressed(bare: Path, tmp_path: Path) -> Path:
    """A run with three cells, one of which bore nothing."""
    folder = shutil.copytree(bare, tmp_path / "pressed")
    cells = {
        "cell": [1, 2, 3],
        "face": [1, 1, -2],
        "position[1]": [1.25, 1.25, 0.0],
        "position[2]": [0.5, 0.0, -1.95],
        "position[3]": [0.0, 0.0, 0.25],
        "impulse": [2.5, 0.0, 7.125],
        "peak": [40.0, 0.0, 12.5],
    }
    pd.DataFrame(cells).to_parquet(folder / "force_map.parquet")
    return folder


def test_cells_are_those_of_the_table_that_bore_anything(pressed: Path) -> None:
    page = Page(of_folder(pressed, pressed / "report.html"))
    told = page.data["clips"][0]["forces"]
    np.testing.assert_allclose(decoded(told["places"]), [[1.25, 0.5, 0.0], [0.0, -1.95, 0.25]], rtol=1e-6)
    assert newtons(told["peaks"]) == pytest.approx([40.0, 12.5], rel=0.014)
    assert told["size"] == pytest.approx(0.4), "cells are half a metre apart"
    assert page.row("1.25, 0.5, 0") == ["1.25, 0.5, 0", "40", "2.5"]
    assert "Forces on the target" in page.text


def test_nothing_of_it_without_a_table(bare: Path) -> None:
    assert ForceMap.read(bare) is None
    page = Page(of_folder(bare, bare / "report.html"))
    assert "forces" not in page.data["clips"][0]
    assert "Forces on the target" not in page.text
