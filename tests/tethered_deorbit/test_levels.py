"""What levels of detail cost and err by on five scenes, as it is stored: within what each tells of itself.

`python -m tests.tethered_deorbit.evidence.levels` makes the result again.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

import pytest

from tests.tethered_deorbit.evidence.levels import COMMAND, LEVELS, RESULT, SCENES

Row = dict[str, Any]
UNDAMPED = "table2-deorbit, undamped"
"""Its tugs are a sample each: they are compared as distributions."""


@pytest.fixture
def stored() -> dict[str, Any]:
    found: dict[str, Any] = json.loads(RESULT.read_text(encoding="utf-8"))
    return found


def rows(stored: dict[str, Any]) -> Iterator[tuple[str, str, Row]]:
    """Of every scene each level that tells a bound."""
    for scene, levels in stored["scenes"].items():
        yield from ((scene, level, row) for level, row in levels.items() if row["bounds told"])


def beyond(stored: dict[str, Any]) -> set[tuple[str, str, str]]:
    """Errors larger than the sum of the bounds told."""
    found = set()
    for scene, level, row in rows(stored):
        bound = sum(row["bounds told"].values())
        for name in ("error of the end [1]", "error of the impulse [1]", "error of the lowering [1]",
                     "error of their peaks [1]"):  # fmt: skip
            if scene != UNDAMPED and abs(row.get(name, 0.0)) > bound:
                found.add((scene, level, name))
    return found


def test_it_is_of_these_scenes_and_was_made_by_its_command(stored: dict[str, Any]) -> None:
    assert stored["command"] == COMMAND
    assert list(stored) == ["command", "dcone-cosim", "speed", "axis", "arrivals", "scenes", "remade"]
    assert list(stored["scenes"]) == list(SCENES)
    assert all(list(levels) == list(LEVELS) for levels in stored["scenes"].values())


def test_no_level_errs_by_more_than_it_tells(stored: dict[str, Any]) -> None:
    """A twentieth of the bounds would be exceeded."""
    assert beyond(stored) == set()
    for _, _, row in rows(stored):
        row["bounds told"] = {name: 0.05 * bound for name, bound in row["bounds told"].items()}
    assert beyond(stored)


def test_a_level_costs_less_than_what_it_leaves_out(stored: dict[str, Any]) -> None:
    """Of damped tows an eighth at most; undamped ones fly freely for most of their steps."""
    for scene, _, row in rows(stored):
        assert row["over the followed"] < (1.0 if scene == UNDAMPED else 0.125), scene
