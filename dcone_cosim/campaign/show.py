"""A campaign's answers in words, on the terminal, and as plain data for machines."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from dcone_cosim.campaign import intervals
from dcone_cosim.campaign.answers import ROUNDING, Answers, Distribution
from dcone_cosim.campaign.spec import RANDOM, Spec
from dcone_cosim.cases.statistics import Share
from dcone_cosim.findings import Reading, reading

if TYPE_CHECKING:
    from rich.console import Console

MOST_FIGURES = 30
"""Figures whose percentiles are printed."""
HEADS = ("cases", "mean", "spread", "5 %", "median", "95 %", "99 %")
WIDEST = 1000
"""Characters of a line that is as wide as can be."""
PLACES = 11
"""Characters of a number with the space before it."""


def probability(found: Share) -> str:
    """ "0.949 (0.923 to 0.966)"."""
    return f"{found.share:.4g}{intervals.bounds(found)}"


def sentences(spec: Spec, found: Answers) -> Iterator[str]:
    """What came out, in words."""
    if found.success is not None:
        one = found.success
        what = intervals.told(spec)
        yield f"{spec.success.text}: {one.count} of {one.of} cases, probability {probability(one)}, {what}"
        width = 0.5 * (one.interval[1] - one.interval[0])
        if spec.until is not None and width > spec.until.within:
            yield f"the interval is not as narrow as asked ({spec.until.text}): {found.cases} cases are all so far"
    elif found.cases and spec.sampler in RANDOM:
        what = f"has {spec.success.figure}" if spec.success.figure and found.outcomes else "gives an answer"
        yield f"{spec.success.text}: none of {found.cases} cases {what}: no probability follows"
    elif found.cases:
        yield f"{spec.success.text}: {found.good} of {found.cases} cases; they are no sample: no probability follows"
    after = spec.success.judged.after
    for outcomes, when in ((found.at_capture, "at capture"), (found.outcomes, f"{after:g} s after it")):
        for word, one in outcomes.items():
            said = f"{word}{f', {when}' if found.at_capture else ''}: {one.count} cases"
            yield said + (f", {probability(one)}" if found.success is not None else "")
    for words, one_of in found.by.items():
        yield f"{', '.join(words)}: {_of_some(spec, one_of)}"
    if found.unanswered:
        told = ", ".join(f"{count} {status}" for status, count in found.unanswered.items())
        yield f"no answer from {sum(found.unanswered.values())} of {found.cases} cases: {told}"
    judged = found.cases if found.success is None else found.success.of
    lacking = found.cases - judged - sum(found.unanswered.values())
    if lacking > 0:
        yield f"{lacking} of {found.cases} cases do not have {spec.success.figure}: neither success nor failure"
    if judged < found.cases:
        low, high = found.bounds
        yield f"had all of them failed, the share were {low:.4g}, had all succeeded {high:.4g}"


def _of_some(spec: Spec, found: Answers) -> str:
    """Of the cases with certain values."""
    if found.success is None:
        return f"{found.cases} cases, none that gives an answer" if found.cases else "no case"
    others = [f"{one.count} {word}" for word, one in found.outcomes.items() if word != spec.success.text]
    said = f"{found.success.count} of {found.success.of}, {probability(found.success)}"
    return "; ".join([said, *([", ".join(others)] if others else [])])


def show(title: str, said: Sequence[str], figures: Mapping[str, Mapping[str, Any]], console: Console) -> None:
    """Print sentences and percentiles."""
    from rich.table import Table
    from rich.text import Text

    console.print(Text(title, style="bold"))
    for line in said:
        console.print(Text(f"  {line}"), highlight=False)
    if not figures:
        return
    table = Table(title_justify="left", box=None, pad_edge=False)
    table.add_column("", overflow="fold", min_width=20)
    for head in HEADS:
        table.add_column(head, justify="right", no_wrap=True)
    figures = {name: one for name, one in figures.items() if one["standard_deviation"] > ROUNDING * abs(one["mean"])}
    rows = [(_headed(name, one), _cells(one)) for name, one in list(figures.items())[:MOST_FIGURES]]
    for name, cells in rows:
        table.add_row(Text(name), *cells)
    needs = console.measure(table, options=console.options.update(max_width=WIDEST)).minimum
    if console.soft_wrap or needs <= console.width:
        console.print(table)
    else:  # no digit is lost where a line has no room for name and numbers
        for name, cells in [("", list(HEADS)), *rows]:
            console.print(Text(name), highlight=False)
            console.print(Text("".join(f"{cell:>{PLACES}}" for cell in cells)), highlight=False)
    if len(figures) > MOST_FIGURES:
        console.print(f"and {len(figures) - MOST_FIGURES} more figures in summary.json", highlight=False)


def _read(one: Mapping[str, Any]) -> Reading:
    return reading(one["unit"], one.get("shown_in", ""), one["mean"])


def _headed(name: str, one: Mapping[str, Any]) -> str:
    unit = _read(one).name
    return f"{name} [{unit}]" if unit else name


def _cells(one: Mapping[str, Any]) -> list[str]:
    told = [one["mean"], one["standard_deviation"], *(p["value"] for p in one["percentiles"].values())]
    numbers = [_read(one).from_si(value) if isinstance(value, float) else value for value in told]
    return [cases(one["count"], one["lacking"]), *map(_number, numbers)]


def cases(count: int, lacking: int) -> str:
    """Of how many cases that give an answer a figure is: "60", or "58 of 60" where some do not have it."""
    return f"{count} of {count + lacking}" if lacking else str(count)


def _number(value: Any) -> str:
    return f"{value:.4g}" if isinstance(value, int | float) else str(value)


def as_dict(spec: Spec, found: Answers) -> dict[str, Any]:
    """For machines, numbers with all their digits."""
    return {
        "cases": found.cases,
        "confidence": found.confidence,
        "success": spec.success.text,
        "succeeded": found.good,
        "probability": None if found.success is None else _share(found.success),
        "outcomes": {word: _share(one) for word, one in found.outcomes.items()},
        "outcomes_at_capture": {word: _share(one) for word, one in found.at_capture.items()},
        "no_answer": dict(found.unanswered),
        "figures": {name: _distribution(one) for name, one in found.figures.items()},
        **({"by": [_of_values(spec, words, one) for words, one in found.by.items()]} if found.by else {}),
    }


def _of_values(spec: Spec, words: Sequence[str], found: Answers) -> dict[str, Any]:
    told = as_dict(spec, found)
    kept = ("cases", "succeeded", "probability", "outcomes", "no_answer", "figures")
    return {"values": dict(zip(spec.by, words, strict=True)), **{name: told[name] for name in kept}}


def _share(one: Share) -> dict[str, Any]:
    return {"count": one.count, "of": one.of, "share": one.share, "interval": _interval(one.interval)}


def _interval(given: Sequence[float]) -> list[float | None]:
    return [None if math.isnan(x) else x for x in given]


def _distribution(one: Distribution) -> dict[str, Any]:
    return {
        "unit": one.unit,
        **({"shown_in": one.own_unit} if one.own_unit else {}),
        "count": one.of,
        "lacking": one.lacking,
        "mean": one.mean,
        "standard_deviation": one.deviation,
        "percentiles": {
            f"{p.percent:g}": {"value": p.value, "interval": _interval(p.interval)} for p in one.percentiles
        },
    }
