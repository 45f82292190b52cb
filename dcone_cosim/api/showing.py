"""Progress where a notebook, a terminal or nobody looks."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager

from dcone_cosim.progress import Bar, Lines, Progress


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

    notebook = Console()
    if notebook.is_jupyter:
        return Bar(notebook)
    if sys.stderr.isatty():
        return Bar(Console(stderr=True))
    return Lines() if wanted else Progress()
