"""Several shots in one mission: the probability that at least one of n takes the target, against its closed form."""

from __future__ import annotations

from pathlib import Path

import pyarrow.parquet
import pytest

from dcone_cosim.campaign.commands import campaign
from dcone_cosim.cases.statistics import share
from dcone_cosim.progress import Progress
from tests.cosim.fmus.build import build
from tests.cosim.test_second_shot import SHOTS as THREE

P = 0.4
"""Probability of one shot: its chaser is faster sideways than 0.6 m/s, uniform from 0 to 1 m/s."""
SHOTS = ("capture", "second_shot", "third_shot")
HEAD = """
title = "Three shots"
scene = "shots.toml"
seed = 18
n = {cases}
success = "captured"
record = ["capture.outcome", "second_shot.outcome?", "third_shot.outcome?"]
"""
DRAWN = """
[[dispersion]]
key = "{shot}.chaser.start_velocity[1]"
distribution = "uniform"
least = "0 m/s"
most = "1 m/s"
"""


@pytest.mark.parametrize(("cases", "most"), [(60, 0.12), pytest.param(250, 0.06, marks=pytest.mark.evidence)])
def test_at_least_one_of_n_shots(tmp_path: Path, cases: int, most: float) -> None:
    """Of one, two and three shots 1 - (1 - p)^n is within the interval, and each is made where all before it failed."""
    build(tmp_path, "capture", f"MISSES={1.0 - P}")
    (tmp_path / "shots.toml").write_text(THREE, encoding="utf-8")
    file = tmp_path / "campaign.toml"
    file.write_text(HEAD.format(cases=cases) + "".join(DRAWN.format(shot=shot) for shot in SHOTS), encoding="utf-8")
    done = campaign(file, tmp_path / "out", Progress(), scheduler="processes", jobs=1, with_figures=False)
    assert done.content["probability"]["share"] == pytest.approx(0.784, abs=most)
    table = pyarrow.parquet.read_table(tmp_path / "out" / "table.parquet").to_pydict()
    missed = [True] * cases
    for count, shot in enumerate(SHOTS, 1):
        missed = [m and u < 1.0 - P for m, u in zip(missed, table[f"{shot}.chaser.start_velocity[1]"], strict=True)]
        low, high = share(cases - sum(missed), cases).interval
        assert low <= 1.0 - (1.0 - P) ** count <= high
        told = [word == "missed" for word in table[f"{shot}.outcome"]]
        assert told == missed
    assert [word == "missed" for word in table["outcome"]] == missed
