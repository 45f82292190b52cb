"""Pictures of a campaign: the estimate as it narrows, outcomes, figures, the map, what the spread comes from."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from dcone_cosim.campaign.answers import Answers
from dcone_cosim.campaign.engine import Made
from dcone_cosim.campaign.explained import NOTHING, Explained
from dcone_cosim.campaign.inputs import Inputs
from dcone_cosim.campaign.intervals import HAVE, of_share
from dcone_cosim.campaign.outcomes import succeeded
from dcone_cosim.campaign.spec import ADAPTIVE, GRID, Spec
from dcone_cosim.plots import style
from dcone_cosim.units import spoken

ESTIMATE, FIGURES, MAP, SENSITIVITY = "estimate.png", "figures.png", "map.png", "sensitivity.png"
MOST_FIGURES = 6
DRAWN = 400
"""Numbers of cases at which the estimate is drawn."""
BINS = 30


def draw(
    spec: Spec, inputs: Inputs, made: Sequence[Made], found: Answers, spread: Explained, folder: Path
) -> list[tuple[str, str]]:
    """Draw to a folder; returns names of the pictures with what each shows."""
    from matplotlib import rc_context

    drawn = []
    with rc_context(style.SETTINGS):
        for name, text, make in (
            (ESTIMATE, "The probability as it narrows, and the outcomes", _estimate),
            (MAP, "Where it succeeds and where it fails", _map),
            (SENSITIVITY, "What the spread comes from", _sensitivity),
            (FIGURES, "Figures over all cases", _figures),
        ):
            figure = make(spec, inputs, made, found, spread)
            if figure is not None:
                style.head(figure, spec.title)
                style.save(figure, folder / name)
                drawn.append((name, text))
    return drawn


def _estimate(spec: Spec, inputs: Inputs, made: Sequence[Made], found: Answers, spread: Explained) -> Any:
    if found.success is None:
        return None
    verdicts = [v for v in (succeeded(one.row, spec.success) for one in made) if v is not None]
    sums = np.cumsum(verdicts)
    places = np.unique(np.geomspace(1, len(verdicts), DRAWN).astype(int))
    shares = [of_share(spec, int(sums[n - 1]), int(n)) for n in places]
    bounded = spec.sampler in HAVE
    figure = style.new_figure(9.2, 3.4)
    left, right = figure.subplots(1, 2, width_ratios=(3, 2))
    figure.subplots_adjust(left=0.075, right=0.98, bottom=0.15, top=0.82, wspace=0.45)
    low, high = ([one.interval[i] for one in shares] for i in (0, 1))
    if bounded:
        label = f"{100 * found.confidence:g} % interval"
        left.fill_between(places, low, high, color=style.NET, alpha=0.25, lw=0, label=label)
    left.plot(
        places, [one.share for one in shares], color=style.CHASER, lw=1.3, label=f"probability of: {spec.success.text}"
    )
    left.set_xscale("log")
    left.set_xlim(1, max(len(verdicts), 2))
    left.set_ylim(-0.02, 1.02)
    left.set_xlabel("cases")
    style.legend(left, 2)
    words = list(found.outcomes.items())[::-1]
    for place, (_, one) in enumerate(words):
        right.barh(place, one.share, color=style.NET, alpha=0.8, height=0.6)
        if bounded:
            right.plot(one.interval, (place, place), color="black", lw=1.0, marker="|", ms=7)
    right.set_yticks(range(len(words)), [f"{word} ({one.count})" for word, one in words], parse_math=False)
    right.set_xlim(0.0, 1.02)
    right.set_xlabel("share of the cases" + (", with its interval" if bounded else ""))
    return figure


def _figures(spec: Spec, inputs: Inputs, made: Sequence[Made], found: Answers, spread: Explained) -> Any:
    kept = {name for one in made for name in one.row.figures}
    shown = [(name, one) for name, one in found.figures.items() if one.varies and name in kept][:MOST_FIGURES]
    if not shown:
        return None
    rows = math.ceil(len(shown) / 3)
    figure = style.new_figure(9.2, 2.3 * rows + 0.6)
    grid = figure.subplots(rows, 3, squeeze=False)
    height = 2.3 * rows + 0.6
    figure.subplots_adjust(left=0.06, right=0.98, bottom=0.5 / height, top=1 - 0.55 / height, wspace=0.25, hspace=0.5)
    for axes, (name, one) in zip(grid.flat, shown, strict=False):
        values = [one_of.row.figures.get(name) for one_of in made]
        read = one.shown_in.from_si
        numbers = [read(float(v)) for v in values if isinstance(v, int | float) and math.isfinite(v)]
        axes.hist(numbers, bins=min(BINS, max(5, round(math.sqrt(len(numbers))))), color=style.NET, alpha=0.8)
        for p in one.percentiles[:3]:
            axes.axvline(read(p.value), color=style.BULLET, lw=0.9, ls="--")
        unit = spoken(one.shown_in.name)
        axes.set_xlabel(f"{name} [{unit}]" if unit else name, fontsize=8, parse_math=False)
    for axes in list(grid.flat)[len(shown) :]:
        axes.set_visible(False)
    return figure


def _map(spec: Spec, inputs: Inputs, made: Sequence[Made], found: Answers, spread: Explained) -> Any:
    numbers = [place for place, one in enumerate(inputs.inputs) if not one.texts]
    if spec.sampler not in (ADAPTIVE, GRID) or len(numbers) < 2 or len(inputs.inputs) > 3:
        return None
    pairs = [(i, j) for i in numbers for j in numbers if i < j]
    figure = style.new_figure(4.6 * len(pairs) + 0.6, 4.4)
    grid = figure.subplots(1, len(pairs), squeeze=False)
    figure.subplots_adjust(left=0.95 / (4.6 * len(pairs) + 0.6), right=0.97, bottom=0.13, top=0.84, wspace=0.3)
    verdicts = [succeeded(one.row, spec.success) for one in made]
    for axes, (i, j) in zip(grid.flat, pairs, strict=True):
        x, y = ([inputs.inputs[place].read(one.values[place]) for one in made] for place in (i, j))
        if len(inputs.inputs) == 2 and spec.sampler == ADAPTIVE and len({v for v in verdicts if v is not None}) == 2:
            levels = [float(v is True) for v in verdicts]
            axes.tricontourf(
                _triangles(x, y), levels, levels=[-0.01, 0.5, 1.01], colors=[style.BULLET, style.ACCENT], alpha=0.18
            )
        for verdict, colour, label, mark in (
            (True, style.ACCENT, spec.success.text, "o"),
            (False, style.BULLET, "not", "x"),
            (None, style.MUTED, "no answer", "s"),
        ):
            chosen = [n for n, v in enumerate(verdicts) if v is verdict]
            if chosen:
                places = [x[n] for n in chosen], [y[n] for n in chosen]
                axes.plot(*places, mark, color=colour, ms=3.5, label=label, clip_on=False, zorder=3)
        for place, put in ((i, axes.set_xlabel), (j, axes.set_ylabel)):
            axes.locator_params(nbins=5)
            put(inputs.inputs[place].label, fontsize=8, parse_math=False)
        style.legend(axes)
    return figure


def _triangles(x: Sequence[float], y: Sequence[float]) -> Any:
    """Triangles between points whose axes have units of their own: each is as long as the other for them."""
    from matplotlib.tri import Triangulation
    from scipy.spatial import Delaunay

    scaled = np.column_stack([(np.asarray(v) - min(v)) / np.ptp(v) for v in (x, y)])
    return Triangulation(x, y, Delaunay(scaled).simplices)


def _sensitivity(spec: Spec, inputs: Inputs, made: Sequence[Made], found: Answers, spread: Explained) -> Any:
    bars: list[tuple[str, list[tuple[str, float, float, float, float]]]] = [
        (one.figure, [(x.name, x.first, x.first_error, x.total, x.total_error) for x in one.inputs])
        for one in spread.indices
    ]
    for name, fitted in spread.surrogates.items():
        chaos = next((one for one in fitted if one.indices), None)
        if chaos is not None and chaos.error < NOTHING:
            left = 1.0 - chaos.error  # indices are shares of what the polynomial explains
            rows = [(key, left * first, 0.0, left * total, 0.0) for key, (first, total) in chaos.indices.items()]
            bars.append((name, [*rows, ("not explained", chaos.error, 0.0, chaos.error, 0.0)]))
    bars = bars[:3]
    if not bars:
        return None
    names = max((len(rows) for _, rows in bars), default=1)
    height = 1.05 + 0.32 * names + 0.5
    figure = style.new_figure(9.2, height)
    grid = figure.subplots(1, len(bars), squeeze=False)
    figure.subplots_adjust(left=0.22, right=0.98, bottom=0.65 / height, top=1 - 0.85 / height, wspace=0.9)
    for axes, (figure_name, rows) in zip(grid.flat, bars, strict=True):
        places = np.arange(len(rows))[::-1]
        axes.barh(places + 0.18, [r[3] for r in rows], 0.34, xerr=[r[4] for r in rows], color=style.NET, label="total")
        axes.barh(
            places - 0.18, [r[1] for r in rows], 0.34, xerr=[r[2] for r in rows], color=style.ACCENT, label="alone"
        )
        axes.set_yticks(places, [r[0] for r in rows], fontsize=7, parse_math=False)
        axes.set_xlabel(f"share of the variance of\n{figure_name}", fontsize=8, parse_math=False)
        axes.set_xlim(left=0.0)
        style.legend(axes, 2)
    return figure
