"""`like = "capture"` in the table of a phase: it is as that one, but for what its own table says.

What a hand-over to it sets is not taken from there.
"""

from __future__ import annotations

from collections.abc import Mapping
from copy import deepcopy
from typing import Any

from dcone_cosim.phases import kinds
from dcone_cosim.phases.phase import Phase
from dcone_cosim.scene.mistakes import Mistake, unknown

LIKE = "like"


def filled(document: Mapping[str, Any], mistakes: list[Mistake]) -> dict[str, Any]:
    """The document with each phase that is like another one written out; it is not changed itself.

    One that is like none that it can be is written out as the first of these, so that it lacks nothing because of that.

    Checked  tests/cosim/test_alike.py
    """
    found = dict(document)
    for name, kind in kinds().items():
        table = document.get(name)
        if not isinstance(table, dict) or LIKE not in table or LIKE not in kind.keys:
            continue
        given, path = table[LIKE], (name, LIKE)
        alike = [one for one, other in kinds().items() if other.model == kind.model and one != name and one in found]
        if not isinstance(given, str) or given not in alike:
            mistakes.append(unknown(path, given, "expected a phase of this scene of the same kind", str(given), alike))
            if not alike:
                continue
            given = alike[0]
        found[name] = _over(_without_taken(found[given], kind), table)
    return found


def _without_taken(table: Mapping[str, Any], kind: Phase) -> dict[str, Any]:
    """A phase's table without what a hand-over to another kind of phase sets."""
    kept: dict[str, Any] = {}
    for key, value in table.items():
        if isinstance(value, dict):
            kept[key] = {name: one for name, one in value.items() if not kind.takes_over(f"{key}.{name}")}
        else:
            kept[key] = value
    return deepcopy(kept)


def _over(below: dict[str, Any], above: Mapping[str, Any]) -> dict[str, Any]:
    """The values of `above`, and those of `below` for what it does not say, table by table."""
    for key, value in above.items():
        here = below.get(key)
        below[key] = _over(here, value) if isinstance(value, dict) and isinstance(here, dict) else value
    return below
