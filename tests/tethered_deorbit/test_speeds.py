"""What long tows cost and err by, as it is stored; `python -m tests.tethered_deorbit.evidence.speeds` makes it again.

Times are not asserted: what is checked is that each program and level computes the same tow.
"""

from __future__ import annotations

import json
from typing import Any

import pytest

from tests.tethered_deorbit.evidence.levels import LEVELS
from tests.tethered_deorbit.evidence.speeds import APARTED, COMMAND, PARTS, PEAKS, PROGRAMS, RESULT, STARTS, TIMES

ARRIVAL = 1e-3
"""What is asked of the arrival at 200 km, relative."""


@pytest.fixture
def stored() -> dict[str, Any]:
    found: dict[str, Any] = json.loads(RESULT.read_text(encoding="utf-8"))
    return found


def test_it_was_made_by_its_command(stored: dict[str, Any]) -> None:
    assert list(stored) == ["command", *PARTS]
    assert stored["command"] == COMMAND
    assert all({"dcone-cosim", "heyoka"} == set(stored[name]["of"]) for name in PARTS)


def test_all_compute_the_same_day(stored: dict[str, Any]) -> None:
    assert [*stored["day"]] == [*PROGRAMS, *LEVELS, "of"]
    for name in (*PROGRAMS, *LEVELS):
        row = stored["day"][name]
        assert row["off in time [s]"] <= TIMES
        assert row["off in peak [1]"] <= PEAKS
        assert row["off at the end [m]"] <= APARTED


def test_all_levels_arrive_when_the_followed_tow_does(stored: dict[str, Any]) -> None:
    for level in LEVELS:
        row = stored["spiral"][level]
        assert abs(row["error of the end [1]"]) < ARRIVAL
        assert abs(row["error of the mean tension [1]"]) < ARRIVAL
        assert row["tugs"] == stored["spiral"]["followed"]["tugs"]


def test_tugs_of_undamped_years_are_alike(stored: dict[str, Any]) -> None:
    """A mapped year is no farther from a followed one than two followed ones are from each other."""
    year = stored["year"]
    assert all(len(tugs) == STARTS for tugs in year["tugs above 1 N"].values())
    alike, across = year["distances, both followed [1]"], year["distances, followed and mapped [1]"]
    assert len(alike) == STARTS * (STARTS - 1) // 2
    assert len(across) == STARTS**2
    assert max(across) <= 1.5 * max(alike)
