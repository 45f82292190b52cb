"""Progress where a notebook, a terminal or nobody looks."""

from __future__ import annotations

import sys
import time as clock
from collections.abc import Iterator
from contextlib import contextmanager
from html import escape
from typing import Any

from dcone_cosim.progress import Bar, Lines, Progress

INTERVAL = 0.2
"""Least wall time between two updates in a notebook [s]."""


class Cell(Progress):
    """One line under the cell of a notebook, with a bar, that is written anew as things go on; it needs no widgets."""

    def __init__(self, display: Any, html: Any) -> None:
        self._html = html
        self._handle = display(html(""), display_id=True)
        self._shown = self._start = self._stop = 0.0
        self._phase = ""

    def _show(self, text: str, done: float | None = None, at_once: bool = False) -> None:
        now = clock.perf_counter()
        if at_once or now - self._shown >= INTERVAL:
            self._shown = now
            bar = "" if done is None else f'<progress value="{done:.4f}"></progress> '
            self._handle.update(self._html(f"{bar}<code>{escape(text)}</code>"))

    def say(self, text: str) -> None:
        self._show(text, at_once=True)

    def begin(self, phase: str, start: float, stop: float) -> None:
        self._phase, self._start, self._stop = phase, start, stop
        self._show(phase, 0.0, at_once=True)

    def at(self, time: float) -> None:
        share = (time - self._start) / max(self._stop - self._start, 1e-12)
        self._show(f"{self._phase}: {time:,.1f} of {self._stop:,.0f} s", share)

    def count(self, what: str, done: int, total: int, state: str) -> None:
        self._show(f"{what}: {state}", done / max(total, 1), at_once=done == total)

    def close(self) -> None:
        self._handle.update(self._html(""))


@contextmanager
def shown(wanted: bool | None) -> Iterator[Progress]:
    """Progress as it is wanted: a bar in a notebook or on a terminal, plain lines elsewhere; None shows it only where
    there is a notebook or a terminal."""
    progress = _made(wanted)
    try:
        yield progress
    finally:
        progress.close()


def _made(wanted: bool | None) -> Progress:
    if wanted is False:
        return Progress()
    from rich.console import Console

    if Console().is_jupyter:
        from IPython.display import HTML, display

        return Cell(display, HTML)
    if sys.stderr.isatty():
        return Bar(Console(stderr=True))
    return Lines() if wanted else Progress()
