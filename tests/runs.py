"""Runs that tests of reading back, going on and comparing share: coarse nets, short tows, made once."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from dcone_cosim.commands import run_and_write
from dcone_cosim.progress import Progress

COARSE = (
    "capture.net.mesh=2 m",
    "capture.macro_step=0.05 s",
    "removal.macro_step=20 s",
    "removal.duration=30 min",
)
"""The mission with a net of 49 knots, which takes a fifth of a second."""


def put(
    scene: str | Path, out: Path, settings: Sequence[str] = (), save_at: Sequence[str] = (), go_on: str = ""
) -> Path:
    """Run a scene, or go on from a folder, and write its folder without figures."""
    done = run_and_write(
        str(scene), out, Progress(), with_figures=False, settings=settings, save_at=save_at, go_on=go_on
    )
    assert done.result.exit_code == 0, done.result.message
    return done.folder


def tables(folder: Path) -> dict[str, bytes]:
    """Every table of a run, as the bytes of its file."""
    return {path.name: path.read_bytes() for path in sorted(folder.glob("*.parquet"))}
