"""The map: extremes down, schemes across, a colour and a letter for what became of each."""

from __future__ import annotations

from pathlib import Path

from dcone_cosim.plots import style
from dcone_cosim.stability.judge import ACCURATE, EXCLUDED, FAILED, LEFT, REFUSED, STABLE
from dcone_cosim.stability.show import LETTERS, MEANINGS, Matrix, by_extreme

COLOURS = {
    ACCURATE: "#009e73",
    STABLE: "#56b4e9",
    REFUSED: "#f0e442",
    EXCLUDED: "#e4e4e4",
    FAILED: "#d55e00",
    LEFT: "#ffffff",
}
"""Okabe and Ito (2008): told apart by colour-blind readers too; the letters say the same."""
ROW, COLUMN = 0.21, 1.25
"""Size of a cell [inch]."""


def draw(one: Matrix, path: Path) -> None:
    """The map of one phase."""
    from matplotlib import rc_context

    with rc_context({**style.SETTINGS, "axes.grid": False}):
        _draw(one, path)


def _draw(one: Matrix, path: Path) -> None:
    from matplotlib.patches import Patch, Rectangle

    rows = list(by_extreme(one))
    names = [extreme.name for extreme, _ in rows]
    left = 0.075 * max(len(name) for name in names) + 0.2
    width, height = left + COLUMN * len(one.plan.schemes) + 0.2, ROW * len(rows) + 1.5
    width = max(width, 6.0)
    figure = style.new_figure(width, height)
    across, down = COLUMN * len(one.plan.schemes), ROW * len(rows)
    axes = figure.add_axes((left / width, 0.15 / height, across / width, down / height))
    for y, (_, cells) in enumerate(rows):
        for x, cell in enumerate(cells):
            kind = cell.verdict.kind
            axes.add_patch(Rectangle((x, y), 1, 1, facecolor=COLOURS[kind], edgecolor="white", lw=1.2))
            axes.text(x + 0.5, y + 0.52, LETTERS[kind], ha="center", va="center", fontsize=8)
    axes.set_xlim(0, len(one.plan.schemes))
    axes.set_ylim(len(rows), 0)
    axes.set_yticks([y + 0.5 for y in range(len(rows))], names, fontsize=7.5, parse_math=False)
    axes.set_xticks([x + 0.5 for x in range(len(one.plan.schemes))], [s.name for s in one.plan.schemes], fontsize=8)
    axes.tick_params(length=0, labeltop=True, labelbottom=False)
    for side in ("left", "bottom"):
        axes.spines[side].set_visible(False)
    there = {cell.verdict.kind for cell in one.cells}
    marks = [
        Patch(facecolor=COLOURS[kind], edgecolor=style.MUTED, lw=0.5, label=f"{LETTERS[kind]}  {MEANINGS[kind]}")
        for kind in LETTERS
        if kind in there
    ]
    figure.legend(
        handles=marks, loc="upper left", bbox_to_anchor=(0.02, 1.0 - 0.5 / height), ncols=2, fontsize=7.5, frameon=False
    )
    style.head(figure, f"{one.plan.scene.title}: {one.plan.phase}")
    style.save(figure, path)
