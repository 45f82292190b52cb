"""The stored matrix has no red cell, none without a reason, and refusals that name a bound or a cost."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

import pytest

from dcone_cosim.stability.judge import ACCURATE, EXCLUDED, FAILED, LEFT, REFUSED, STABLE, names_bound
from tests.stability.matrix import COMMAND, RESULTS


def cells(result: dict[str, Any]) -> Iterator[tuple[str, str, dict[str, Any]]]:
    for phase in result["phases"].values():
        for extreme, schemes in phase["cells"].items():
            for scheme, cell in schemes.items():
                yield extreme, scheme, cell


def not_compared(cell: dict[str, Any]) -> bool:
    return bool(cell["asked"] == "agrees" and cell["why"].startswith("not compared with a finer run: "))


def unexplained(result: dict[str, Any]) -> list[str]:
    """Cells that failed, were left out, or lack what they must say."""
    found = []
    for extreme, scheme, cell in cells(result):
        right = {
            ACCURATE: cell["why"] == "" and cell["asked"] in cell["measured"],
            # what is asked to agree with a finer run may say why there is none to agree with
            STABLE: cell["why"] != "" and (cell["asked"] in cell["measured"] or not_compared(cell)),
            REFUSED: names_bound(cell["why"]),
            EXCLUDED: cell["why"].startswith("goes without"),
            FAILED: False,
            LEFT: False,
        }[cell["kind"]]
        if not right:
            found.append(f"{extreme}, {scheme}: {cell['kind']} {cell['why']}")
    return found


@pytest.fixture(params=["table1-capture", "table2-deorbit"])
def stored(request: pytest.FixtureRequest) -> dict[str, Any]:
    result: dict[str, Any] = json.loads((RESULTS / f"{request.param}.json").read_text(encoding="utf-8"))
    assert result["command"] == f"{COMMAND} {request.param}"
    return result


def test_no_cell_is_red_or_unexplained(stored: dict[str, Any]) -> None:
    assert unexplained(stored) == []
    assert sum(1 for _ in cells(stored)) > 100


def test_a_red_cell_is_noticed(stored: dict[str, Any]) -> None:
    """The twin."""
    extreme, scheme, cell = next(cells(stored))
    phase = next(iter(stored["phases"].values()))
    for change in ({"kind": FAILED}, {"kind": REFUSED, "why": "no"}, {"kind": STABLE, "why": ""}, {"kind": LEFT}):
        phase["cells"][extreme][scheme] = {**cell, **change}
        assert len(unexplained(stored)) == 1, change
