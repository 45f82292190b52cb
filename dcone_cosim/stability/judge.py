"""What became of a case.

accurate   every criterion is met closely, and a finer run agrees
stable     every criterion is met
refused    it was not run, or did not begin, and a bound or an estimate of its cost says why
excluded   there is no such case: its scheme goes without what it is about
failed     anything else
left out   the time allowed was over before its turn
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from dcone_cosim.criteria import Criterion
from dcone_cosim.quantities import Quantity

ACCURATE, STABLE, REFUSED, EXCLUDED, FAILED, LEFT = "accurate", "stable", "refused", "excluded", "failed", "left out"
AGREE, AGREE_STABLE = 0.01, 0.05
"""Shares by which a finer run may differ from an accurate one, and from one that is stable."""
SAME, SAME_STABLE = 1e-9, 1e-6
"""The same of a run with other macro steps."""
PARTED = 0.002
"""Share from which on a jittered twin of a chaotic run counts as having parted from it."""
IN_THE = ", in the "
"""Before the quantity that differs most."""
ORDER = "order"
"""Criterion that compares the energy books of two steps."""
NOTHING = "there is nothing that both tell"
BOOK = ("energy_gained", "energy_lost")
SECOND_ORDER = 1.0 / 8.0
"""Share of an error that a four times finer step may leave: that of order 3/2."""
COVERED = 0.25
"""Share of a run's instants up to which, at least, it must stay with its twin to be compared at all."""
BOUND = re.compile(r"\d|zero")
_PLACE = re.compile(
    r"^(?:line \d+: )?(?:--set \S+?=(?:\[[^]]*\]|\"[^\"]*\"|[^:]*): )?(?:[\w.\[\]]+ = (?:\[[^]]*\]|\"[^\"]*\"|\S+): )?"
)
_VALUE = re.compile(r"\([^()]*, value [^()]*\)\s*$")
"""What a message says of where it is and what was given: the numbers in these are no bound."""


@dataclass(frozen=True)
class Verdict:
    """What became of a case, and by which criteria.

    text       why, in words
    criteria   with what was measured
    """

    kind: str
    text: str
    criteria: Sequence[Criterion] = ()

    @property
    def red(self) -> bool:
        return self.kind == FAILED

    def told(self) -> dict[str, Any]:
        """As plain data."""
        return asdict(self) | {"criteria": [one._asdict() for one in self.criteria]}


def verdict(criteria: Sequence[Criterion], asked: str) -> Verdict:
    """Of a run that came to its end.

    asked    key of the criterion that its extreme is about: it must have been looked at
    """
    found = {one.key for one in criteria}
    if asked and asked not in found:
        return Verdict(FAILED, f"{asked} was not looked at; the run tells {', '.join(sorted(found))}", criteria)
    broken = [one for one in criteria if not one.value <= one.stable]
    if broken:
        worst = max(broken, key=lambda one: _over(one.value, one.stable))
        return Verdict(FAILED, f"{worst.label}: {size(worst)}, more than {size(worst, worst.stable)}", criteria)
    loose = [one for one in criteria if not one.value <= one.accurate]
    if loose:
        worst = max(loose, key=lambda one: _over(one.value, one.accurate))
        text = worst.label if math.isinf(worst.value) else f"{worst.label}: {size(worst)}"
        return Verdict(STABLE, text, criteria)
    return Verdict(ACCURATE, "", criteria)


def suited(
    criteria: Iterable[Criterion], instead: Mapping[str, str], within: Mapping[str, tuple[float, float]]
) -> list[Criterion]:
    """Those that mean something with a scheme, with its own limits where they are wider.

    instead    criteria that mean nothing with it, and those in their place
    within     criteria that hold less closely with it: what counts as accurate and as stable
    """
    found = []
    for one in criteria:
        accurate, stable = within.get(one.key, (one.accurate, one.stable))
        if one.key not in instead:
            found.append(one._replace(accurate=max(accurate, one.accurate), stable=max(stable, one.stable)))
    return found


def refusal(message: str, asked: str = "") -> Verdict:
    """Of a case that was refused: the reason counts only with a bound in it."""
    text = message.strip()
    if not names_bound(text):
        return Verdict(FAILED, f"refused without a bound: {text}")
    return Verdict(REFUSED, text)


def names_bound(message: str) -> bool:
    """Whether a refusal has a number that is neither where it stands nor what was given, or says what is zero."""
    return BOUND.search(_VALUE.sub("", _PLACE.sub("", message))) is not None


def _over(value: float, limit: float) -> float:
    return math.inf if not math.isfinite(value) or limit <= 0.0 else value / limit


def size(criterion: Criterion, value: float | None = None) -> str:
    """A value of it as a person reads it."""
    number = criterion.value if value is None else value
    if criterion.unit != "1":
        return f"{number:.2g} {criterion.unit}"
    return f"{number:.0f}" if criterion.key == "finite" else f"{100.0 * number:.2g} %"


def agreement(
    here: Sequence[Quantity], finer: Sequence[Quantity], jittered: Sequence[Quantity] | None, count: int = 0
) -> Criterion:
    """By how much a finer run differs [1], in what an accuracy means, or in all that there is where it means nothing of
    it; of a chaotic one as long as a twin that began a micrometre beside it stays with it.

    jittered   the same of that twin, None for a run that is not chaotic
    count      values of a curve, where of a chaotic one only curves are compared; 0: all that its twin comes to too
    """
    others = {q.key: q for q in finer}
    twins = None if jittered is None else {q.key: q for q in jittered}
    worst, label = 0.0, ""
    compared = False
    both = [one for one in here if one.key in others]
    for one in [one for one in both if one.meant] or both:
        mine, other = np.asarray(one.values, dtype=float), np.asarray(others[one.key].values, dtype=float)
        length = min(len(mine), len(other))
        if twins is not None:
            if one.key not in twins or (count and len(mine) != count):
                continue
            length = _together(mine, np.asarray(twins[one.key].values, dtype=float), one.scale)
            if length < COVERED * len(mine):
                continue
        sizes = np.abs(other[:length]) if one.scale == 0.0 else np.full(length, one.scale)
        there = np.isfinite(mine[:length]) & np.isfinite(other[:length]) & (sizes > 0.0)
        if there.any():
            compared = True
            off = float((np.abs(mine[:length] - other[:length])[there] / sizes[there]).max())
            if off >= worst:
                worst, label = off, one.label
    if not compared:
        return unlike("chaos parts even its twin from it too early" if twins is not None else NOTHING)
    return Criterion("agrees", f"difference from a finer run{IN_THE}{label}", worst, "1", AGREE, AGREE_STABLE)


def falls(here: Sequence[Criterion], finer: Sequence[Criterion], rounding: float) -> Criterion:
    """What a four times finer step leaves of the error of the energy book [1]: a sixteenth at second order, a quarter
    at first.

    rounding    share of the energy below which an error may be nothing else
    """
    mine, other = (
        max((abs(one.value) for one in criteria if one.key in BOOK), default=math.nan) for criteria in (here, finer)
    )
    left = 0.0 if other < rounding else other / mine if mine > 0.0 else math.inf
    label = "what a four times finer step leaves of the energy book's error"
    return Criterion(ORDER, label, left, "1", SECOND_ORDER, SECOND_ORDER)


def unlike(why: str) -> Criterion:
    """The agreement of a run that is not compared: it does not count as accurate, whatever the other criteria say."""
    return Criterion("agrees", f"not compared with a finer run: {why}", math.inf, "1", AGREE, math.inf)


def _together(mine: Any, twin: Any, scale: float) -> int:
    """For how many instants a curve stays with its twin."""
    length = min(len(mine), len(twin))
    apart = np.abs(mine[:length] - twin[:length]) > PARTED * (scale or np.abs(mine[:length]))
    return int(np.argmax(apart)) if apart.any() else length


def sameness(here: Sequence[Quantity], other: Sequence[Quantity]) -> Criterion:
    """By how much a run with the scene's own macro steps differs at its end [1]: by nothing."""
    others = {q.key: q for q in other}
    worst, label, compared = 0.0, "", False
    for one in here:
        if one.scale > 0.0 and one.key in others and len(one.values) == 1 == len(others[one.key].values):
            off = abs(one.values[0] - others[one.key].values[0]) / one.scale
            compared = compared or math.isfinite(off)
            if off >= worst:
                worst, label = off, one.label
    if not compared:
        return Criterion("same", "nothing to compare at the end", math.inf, "1", SAME, SAME_STABLE)
    return Criterion("same", f"difference from other macro steps{IN_THE}{label}", worst, "1", SAME, SAME_STABLE)
