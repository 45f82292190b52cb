"""Which setting of a model of ours is exact enough, and the cheapest: from errors and costs that were measured.

`measured.json` has for each model, scheme and step the largest error of each quantity over a number of scenes, and the
cost over that of the default setting. It is made by tests/accuracy/evidence/measured.py, with the same runs as `dcone
accuracy`. An error that was found smaller than what could be told is entered as that.
"""

from __future__ import annotations

import json
import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from dcone_cosim import build

FILE = Path(__file__).with_name("measured.json")
SAME = 1e-9
"""Relative difference of two sizes that are one."""
NEAR = 1.5
"""Ratio of errors up to which settings count as one where none is exact enough."""
ALIKE = 1.05
"""Ratio of costs up to which they count as one."""


@dataclass(frozen=True)
class Entry:
    """A setting that was measured.

    terms     of the groups that are numerics alone
    size      of the step or tolerance over the default one [1]
    errors    by quantity [1]
    cost      CPU time over that of the default setting [1]
    """

    terms: Mapping[str, str]
    size: float
    errors: Mapping[str, float]
    cost: float

    def error(self, quantities: Sequence[str]) -> float:
        """Largest error of those quantities that were measured, of all if none is named [1]; NaN: none of them was."""
        told = [value for key, value in self.errors.items() if not quantities or key in quantities]
        return max(told, default=math.nan)


@dataclass(frozen=True)
class Choice:
    """An entry, and what it sets in a scene: terms by group, and parameters by FMI name, SI."""

    entry: Entry
    parameters: Mapping[str, float]


@cache
def table(model: str) -> tuple[Entry, ...]:
    """All that was measured of a model."""
    content: dict[str, Any] = json.loads(FILE.read_text(encoding="utf-8"))
    return tuple(Entry(**row) for row in content["models"].get(model, ()))


def choose(
    model: str,
    terms: Mapping[str, str],
    values: Mapping[str, float],
    accuracy: float,
    quantities: Sequence[str],
    fixed: Sequence[str],
) -> Choice | None:
    """The cheapest setting that was measured to be as accurate [1]; the most exact one if none was.

    terms, values    of the scene, values SI by FMI name
    fixed            groups whose term the scene names itself

    None for a model of which nothing was measured.
    """
    able = list(_able(model, terms, values, fixed))
    if not able:
        return None
    good = [choice for choice in able if choice.entry.error(quantities) <= accuracy]
    if not good:  # the cheapest of those that are nearest: a run will tell, and refine it
        nearest = min(_or_infinite(choice.entry.error(quantities)) for choice in able)
        good = [choice for choice in able if _or_infinite(choice.entry.error(quantities)) <= NEAR * nearest]
    least = min(choice.entry.cost for choice in good)
    alike = [choice for choice in good if choice.entry.cost <= ALIKE * least]
    return min(alike, key=lambda choice: choice.entry.error(quantities))


def _or_infinite(value: float) -> float:
    return math.inf if math.isnan(value) else value


def _able(model: str, terms: Mapping[str, str], values: Mapping[str, float], fixed: Sequence[str]) -> Iterator[Choice]:
    """What the scene can have."""
    catalogue = build.CATALOGUE[model]
    for entry in table(model):
        wanted = {group: term for group, term in entry.terms.items() if group in catalogue.groups}
        if any(terms.get(group) != term for group, term in wanted.items() if group in fixed):
            continue
        with_it = {**terms, **wanted}
        if build.whole(model, terms) and not build.whole(model, with_it):
            continue
        if any(catalogue.clashing(with_it)) or any(catalogue.unfit(with_it)):
            continue
        full = {**build.defaults(catalogue.interface(with_it)), **values}
        if _refused(model, full, with_it, wanted):
            continue
        for rung in build.rungs(model, full, with_it):
            if math.isclose(rung.size, entry.size, rel_tol=SAME):
                yield Choice(entry, rung.values)


def _refused(model: str, values: Mapping[str, float], terms: Mapping[str, str], groups: Collection[str]) -> bool:
    """Whether a part of the scene refuses what is chosen of these groups."""
    catalogue = build.CATALOGUE[model].groups
    keys = {f"{catalogue[name].table or name}.{catalogue[name].selector}" for name in groups}
    return any(one.variable in keys for one in build.cannot_work(model, values, math.inf, terms, True))
