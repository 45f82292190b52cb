"""Several shots in one mission: the probability that at least one of n takes the target, against its closed form."""

from __future__ import annotations

from pathlib import Path

import pyarrow.parquet
import pytest

from dcone_cosim.campaign.commands import campaign
from dcone_cosim.progress import Progress
from tests.cosim.fmus.build import build
from tests.cosim.test_second_shot import SHOTS

P = 0.4
"""Probability of one shot: its chaser is faster sideways than 0.6 m/s, uniform from 0 to 1 m/s."""
HEAD = """
title = "{count} shots"
scene = "shots.toml"
seed = 18
n = {cases}
success = "captured"
record = ["capture.outcome"]
"""
DRAWN = """
[[dispersion]]
key = "{shot}.chaser.start_velocity[1]"
distribution = "uniform"
least = "0 m/s"
most = "1 m/s"
"""


@pytest.mark.parametrize("count", [1, 2, 3])
def test_at_least_one_of_n_shots(count: int, tmp_path: Path) -> None:
    """1 - (1 - p)^n is within the interval, and each shot is made as often as all before it have failed."""
    build(tmp_path, "capture", f"MISSES={1.0 - P}")
    shots, cases = ("capture", "second_shot", "third_shot")[:count], 250
    text = SHOTS.replace('["capture", "second_shot", "third_shot"]', str(list(shots)).replace("'", '"'))
    (tmp_path / "shots.toml").write_text(text, encoding="utf-8")
    file = tmp_path / "campaign.toml"
    drawn = "".join(DRAWN.format(shot=shot) for shot in shots)
    file.write_text(HEAD.format(count=count, cases=cases) + drawn, encoding="utf-8")
    done = campaign(file, tmp_path / "out", Progress(), scheduler="processes", jobs=1, with_figures=False)
    low, high = done.content["probability"]["interval"]
    assert low <= 1.0 - (1.0 - P) ** count <= high
    table = pyarrow.parquet.read_table(tmp_path / "out" / "table.parquet").to_pydict()
    missed = [all(table[f"{shot}.chaser.start_velocity[1]"][case] < 1.0 - P for shot in shots) for case in range(cases)]
    assert [word == "missed" for word in table["outcome"]] == missed
