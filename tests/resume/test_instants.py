"""What `--save-at` and `--from` say, read by hand."""

from __future__ import annotations

import pytest

from dcone_cosim.loading import load
from dcone_cosim.resume.instants import Place, go_on_at, save_at


def test_times_by_phase() -> None:
    mission, tow = load("mission"), load("table2-deorbit")
    assert save_at(["capture:2.5 s", 'removal:"1 h"', "removal:90 min"], mission) == {
        "capture": [2.5],
        "removal": [3600.0, 5400.0],
    }
    assert save_at(["1 h"], tow) == {"removal": [3600.0]}
    assert save_at([], mission) == {}


@pytest.mark.parametrize(
    ("text", "place"),
    [("removal", Place("removal")), ("removal:2 min", Place("removal", 120.0)), ("capture: 3s", Place("capture", 3.0))],
)
def test_places(text: str, place: Place) -> None:
    assert go_on_at(text, load("mission")) == place


def test_a_scene_of_one_phase_needs_no_name() -> None:
    assert go_on_at("2 h", load("table2-deorbit")) == Place("removal", 7200.0)
