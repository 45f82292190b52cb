"""The stored matrix has no red cell, none without a reason, and refusals that name a bound or a cost."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from dcone_cosim.stability.judge import ACCURATE, BOUND, EXCLUDED, FAILED, LEFT, REFUSED, STABLE
from tests.stability.matrix import COMMAND, RESULT, main

pytestmark = pytest.mark.evidence


def cells(result: dict[str, Any]) -> Iterator[tuple[str, str, dict[str, Any]]]:
    for phase in result["phases"].values():
        for extreme, schemes in phase["cells"].items():
            for scheme, cell in schemes.items():
                yield extreme, scheme, cell


def unexplained(result: dict[str, Any]) -> list[str]:
    """Cells that failed, were left out, or lack what they must say."""
    found = []
    for extreme, scheme, cell in cells(result):
        right = {
            ACCURATE: cell["why"] == "" and cell["asked"] in cell["measured"],
            STABLE: cell["why"] != "" and cell["asked"] in cell["measured"],
            REFUSED: BOUND.search(cell["why"]) is not None,
            EXCLUDED: cell["why"].startswith("goes without"),
            FAILED: False,
            LEFT: False,
        }[cell["kind"]]
        if not right:
            found.append(f"{extreme}, {scheme}: {cell['kind']} {cell['why']}")
    return found


@pytest.fixture(scope="module")
def stored() -> dict[str, Any]:
    result: dict[str, Any] = json.loads(RESULT.read_text(encoding="utf-8"))
    assert result["command"] == COMMAND
    return result


def test_no_cell_is_red_or_unexplained(stored: dict[str, Any]) -> None:
    assert unexplained(stored) == []
    assert sum(1 for _ in cells(stored)) > 150


def test_a_red_cell_is_noticed(stored: dict[str, Any]) -> None:
    """The twin."""
    extreme, scheme, cell = next(cells(stored))
    cell = dict(cell)
    phase = next(iter(stored["phases"].values()))
    kept = phase["cells"][extreme][scheme]
    try:
        for change in ({"kind": FAILED}, {"kind": REFUSED, "why": "no"}, {"kind": STABLE, "why": ""}, {"kind": LEFT}):
            phase["cells"][extreme][scheme] = {**cell, **change}
            assert len(unexplained(stored)) == 1, change
    finally:
        phase["cells"][extreme][scheme] = kept


def test_what_is_refused_is_told_per_scheme(stored: dict[str, Any]) -> None:
    for phase in stored["phases"].values():
        for scheme, share in phase["refused"].items():
            own = [by[scheme]["kind"] for by in phase["cells"].values()]
            assert share == {"refused": own.count(REFUSED), "of": len(own) - own.count(EXCLUDED)}


def test_the_matrix_comes_out_so_again(stored: dict[str, Any], tmp_path: Path) -> None:
    main(tmp_path / "again.json")
    again = json.loads((tmp_path / "again.json").read_text(encoding="utf-8"))
    assert unexplained(again) == []
