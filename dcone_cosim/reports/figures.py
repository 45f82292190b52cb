"""The figures of a run, as the kinds of its phases have them. matplotlib is imported only when they are drawn."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import partial
from pathlib import Path

from dcone_cosim.phases import kind_of
from dcone_cosim.phases.phase import Figure
from dcone_cosim.plots import side_by_side, style
from dcone_cosim.results import RunResult


def draw_all(run: RunResult, folder: Path, aside: bool = True) -> list[str]:
    """Draw what the run has data for, a PNG each; returns which could not be drawn, and why.

    aside    some may be drawn in a forked process, which suits none that has threads
    """
    style.load()
    figures = list(_figures(run))
    if not aside:
        return [*_without_data(run), *_draw(folder, figures)]
    # The capture in space takes as long as the others together.
    return [*_without_data(run), *side_by_side.halves(partial(_draw, folder), figures[:1], figures[1:])]


def _without_data(run: RunResult) -> Iterator[str]:
    for name, result in run.phases.items():
        yield from kind_of(name).without_figure(run.scene, result)


def _draw(folder: Path, figures: Iterable[Figure]) -> list[str]:
    import matplotlib as mpl

    failed = []
    with mpl.rc_context(style.SETTINGS):
        for name, draw in figures:
            path = folder / name
            try:
                draw(path)
            except Exception as error:
                path.unlink(missing_ok=True)
                failed.append(f"{name} could not be drawn: {type(error).__name__}: {error}")
    return failed


def _figures(run: RunResult) -> Iterator[Figure]:
    for name, result in run.phases.items():
        yield from kind_of(name).figures(run, result)
