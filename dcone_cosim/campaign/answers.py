"""What a campaign comes to: how probable each outcome is, and how figures are distributed, with what is known of it."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import product

import numpy as np

from dcone_cosim.campaign import intervals
from dcone_cosim.campaign.engine import Made
from dcone_cosim.campaign.figures import OPTIONAL
from dcone_cosim.campaign.outcomes import TOLD_BY, answered, outcome, succeeded
from dcone_cosim.campaign.spec import RANDOM, Spec
from dcone_cosim.cases.rows import unit_of
from dcone_cosim.cases.statistics import Share
from dcone_cosim.cases.vary import in_si
from dcone_cosim.findings import Reading, reading
from dcone_cosim.scene.data import Scene

PERCENTS = (5.0, 50.0, 95.0, 99.0)
"""Percentiles that are told."""
ROUNDING = 1e-12
"""Spread over mean of a figure that is the same in all cases [1]."""
MARGIN, DIAMETER, REQUIRED = "line.margin_of_safety", "tether.diameter", "line.diameter_required"


@dataclass(frozen=True)
class Percentile:
    """A percentile of a figure, and the interval that holds it; NaN where there are too few cases to bound it."""

    percent: float
    value: float
    interval: tuple[float, float]


@dataclass(frozen=True)
class Distribution:
    """A figure over the cases that have it.

    of        cases that have it;  lacking   those that give an answer and do not
    own_unit  in which a person reads it, "" for none of its own
    """

    unit: str
    of: int
    lacking: int
    mean: float
    deviation: float
    percentiles: tuple[Percentile, ...]
    own_unit: str = ""

    @property
    def varies(self) -> bool:
        """Whether its spread is more than rounding."""
        return self.deviation > ROUNDING * abs(self.mean)

    @property
    def shown_in(self) -> Reading:
        """The unit in which a person reads it."""
        return reading(self.unit, self.own_unit, self.mean)


@dataclass
class Answers:
    """All of it.

    success      share of the cases that give an answer; None where the cases are no sample
    bounds       the share, had every case without an answer failed, and had it succeeded
    outcomes     of the cases that give an answer
    at_capture   the same, judged as the target was caught; empty where the campaign names no later instant
    unanswered   statuses of the others, and how many there are
    by           the same of the cases with each combination of the values that the campaign names
    """

    confidence: float
    cases: int
    success: Share | None = None
    good: int = 0
    bounds: tuple[float, float] = (math.nan, math.nan)
    outcomes: Mapping[str, Share] = field(default_factory=dict)
    at_capture: Mapping[str, Share] = field(default_factory=dict)
    unanswered: Mapping[str, int] = field(default_factory=dict)
    figures: Mapping[str, Distribution] = field(default_factory=dict)
    by: Mapping[tuple[str, ...], Answers] = field(default_factory=dict)


def answers(
    spec: Spec, made: Sequence[Made], derived: Mapping[str, Sequence[float]], names: Sequence[str] = ()
) -> Answers:
    """What the cases come to.

    derived    figures that follow from a case's others, one for each case, in m
    names      of the values that the cases have

    Checked  tests/campaign/test_answers.py
    """
    found = _answers(spec, made, derived)
    if spec.by and names:
        found.by = dict(_by(spec, made, derived, names))
    return found


def _by(
    spec: Spec, made: Sequence[Made], derived: Mapping[str, Sequence[float]], names: Sequence[str]
) -> Iterator[tuple[tuple[str, ...], Answers]]:
    """Answers of the cases with each combination of values: cases that are independent are so among these, too."""
    texts = [next(one.values for one in spec.dispersions if one.key == key) for key in spec.by]
    places = [names.index(key) for key in spec.by]
    for chosen in product(*(range(len(one)) for one in texts)):
        of = [at for at, one in enumerate(made) if tuple(int(one.values[place]) for place in places) == chosen]
        some = {name: [column[at] for at in of] for name, column in derived.items()}
        words = tuple(in_si(one[place]).given for one, place in zip(texts, chosen, strict=True))
        yield words, _answers(spec, [made[at] for at in of], some)


def _answers(spec: Spec, made: Sequence[Made], derived: Mapping[str, Sequence[float]]) -> Answers:
    confidence = spec.confidence
    verdicts = [succeeded(one.row, spec.success) for one in made]
    known = [verdict for verdict in verdicts if verdict is not None]
    good, lost = sum(known), len(made) - len(known)
    judged = spec.success.judged
    words = Counter(outcome(one.row, judged) for one in made if answered(one.row))
    sample = spec.sampler in RANDOM
    count = sum(words.values())
    found = Answers(confidence, len(made), good=good)
    found.unanswered = dict(Counter(one.row.status for one in made if not answered(one.row)).most_common())
    found.outcomes = {word: intervals.of_share(spec, number, count) for word, number in words.most_common()}
    if math.isfinite(judged.after):
        then = Counter(outcome(one.row, judged.at_capture()) for one in made if answered(one.row))
        found.at_capture = {word: intervals.of_share(spec, number, count) for word, number in then.most_common()}
    if known and sample:
        found.success = intervals.of_share(spec, good, len(known))
        found.bounds = (good / len(made), (good + lost) / len(made))
    if sample:
        bounded = confidence if spec.sampler in intervals.HAVE else math.nan
        found.figures = dict(_figures(made, bounded, derived, _beside(spec)))
    return found


def _beside(spec: Spec) -> set[str]:
    """Figures that are kept for the verdicts alone, and that the campaign does not name."""
    kept = {name.removesuffix(OPTIONAL) for name in spec.record}
    return set(TOLD_BY) - kept if kept else set()


def _figures(
    made: Sequence[Made], confidence: float, derived: Mapping[str, Sequence[float]], beside: set[str]
) -> Iterator[tuple[str, Distribution]]:
    rows = [one.row for one in made if answered(one.row)]
    names = dict.fromkeys(name for row in rows for name, value in row.figures.items() if isinstance(value, int | float))
    for name in (name for name in names if name not in beside):
        values = [row.figures.get(name) for row in rows]
        numbers = [float(value) for value in values if isinstance(value, int | float) and math.isfinite(value)]
        unit, own = unit_of(rows, name)
        if numbers:
            yield name, replace(distribution(numbers, unit, len(rows) - len(numbers), confidence), own_unit=own)
    for name, column in derived.items():
        numbers = [value for value in column if math.isfinite(value)]
        if numbers:
            yield name, distribution(numbers, "m", len(rows) - len(numbers), confidence)


def distribution(numbers: Sequence[float], unit: str, lacking: int, confidence: float) -> Distribution:
    """Mean, spread and percentiles of a figure.

    confidence   of the intervals of percentiles [1]; NaN for none

    Checked  tests/campaign/test_answers.py
    """
    ordered = np.sort(np.asarray(numbers, dtype=float))
    found = tuple(percentile(ordered, percent, confidence) for percent in PERCENTS)
    deviation = float(np.std(ordered, ddof=1)) if len(ordered) > 1 else math.nan
    return Distribution(unit, len(ordered), lacking, float(np.mean(ordered)), deviation, found)


def percentile(ordered: np.ndarray, percent: float, confidence: float) -> Percentile:
    """A percentile with an interval that asks nothing of the distribution: two of the ordered values, such that

        P(B <= l - 1) <= (1 - c)/2,   P(B >= u) <= (1 - c)/2,   B ~ binomial(n, p)

    Source   H. A. David and H. N. Nagaraja, Order Statistics, 3rd edition, section 7.1
    Checked  tests/campaign/test_answers.py
    """
    from scipy.stats import binom

    if math.isnan(confidence):
        return Percentile(percent, float(np.percentile(ordered, percent)), intervals.NONE)
    n, p, tail = len(ordered), percent / 100.0, 0.5 * (1.0 - confidence)
    low = int(binom.ppf(tail, n, p))  # the largest l with P(B <= l - 1) <= tail, counted from 1
    high = int(binom.ppf(1.0 - tail, n, p)) + 1
    interval = (
        float(ordered[low - 1]) if low >= 1 else math.nan,
        float(ordered[high - 1]) if high <= n else math.nan,
    )
    return Percentile(percent, float(np.percentile(ordered, percent)), interval)


def required_diameters(spec: Spec, base: Scene, names: Sequence[str], made: Sequence[Made]) -> dict[str, list[float]]:
    """Diameter [m] that a tow's line would have to have to bear its largest tug of each case with the factor of safety.

        T ~ d,   sigma = T / A ~ 1/d,   so   d_req = d F / (1 + MS)

    Valid    the largest tug is a snap whose preload is small beside it, its speed that of the case
    Source   as `report.told.diameters`
    Checked  tests/campaign/test_answers.py
    """
    found = {}
    for phase in base.phases:
        own, key = phase.setting(DIAMETER), f"{phase.name}.{DIAMETER}"
        figure = f"{phase.name}.{MARGIN}"
        if not own or not any(figure in one.row.figures for one in made):
            continue
        place = names.index(key) if key in names else None
        column = []
        for one in made:
            margin = one.row.figures.get(figure)
            diameter = own if place is None else one.values[place]
            known = isinstance(margin, int | float) and answered(one.row)
            column.append(diameter * spec.factor_of_safety / (1.0 + float(margin)) if known else math.nan)  # type: ignore[arg-type]
        found[f"{phase.name}.{REQUIRED}"] = column
    return found
