"""One command from beginning to end: scene, FMUs, run, results."""

from __future__ import annotations

import contextlib
import os
import shutil
import tempfile
import threading
from collections.abc import Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path

from dcone_cosim import build
from dcone_cosim.archives import Archives
from dcone_cosim.errors import InputError
from dcone_cosim.master import RunResult, run_scene
from dcone_cosim.progress import Progress
from dcone_cosim.reports import style, summary
from dcone_cosim.run import atomic_folder, check_free, default_folder, fill
from dcone_cosim.scene import Scene, load


@dataclass
class Written:
    """What a run left, where, and what to tell of the writing."""

    result: RunResult
    folder: Path
    notes: list[str] = field(default_factory=list)


def named(scene: str, settings: Sequence[str] = ()) -> Scene:
    """The scene of that name or file, with settings `KEY.KEY=VALUE` in the place of what it says."""
    if not scene.strip():
        raise InputError("the name of the scene is empty; `dcone list` shows the scenes there are")
    return load(scene, settings)


def run_and_write(
    name: str,
    out: Path | None,
    progress: Progress,
    with_csv: bool = False,
    with_figures: bool = True,
    force: bool = False,
    settings: Sequence[str] = (),
) -> Written:
    """Run a scene and write its folder. Bad input, or a place that cannot be written, raises and leaves nothing."""
    started = datetime.now(UTC)
    scene = named(name, settings)
    folder = out if out is not None else default_folder(scene.name)
    check_free(folder, force and out is not None)
    threading.Thread(target=_load, args=(with_figures,), daemon=True).start()
    notes: list[str] = []
    with atomic_folder(folder, force and out is not None) as draft:
        with Archives(scene, progress) as archives:
            result = run_scene(scene, archives.instantiate, progress)
            facts = archives.facts()

        def draw(path: Path) -> None:
            progress.say("drawing")
            notes.extend(_draw(result, path))

        fill(draft.path, result, facts, summary.as_dict(result), started, with_csv, draw if with_figures else None)
    if out is not None and draft.folder != folder:
        notes.append(f"{folder} came to be while the scene ran and was not touched; the results are in {draft.folder}")
    return Written(result, draft.folder, notes)


def _load(with_figures: bool) -> None:
    """Import while the FMUs compute what is needed after them. What fails here fails again where it is needed."""
    with contextlib.suppress(Exception):
        import pyarrow.parquet  # noqa: F401

        if with_figures:
            style.load()


def _draw(result: RunResult, folder: Path) -> list[str]:
    """Draw; returns what could not be drawn. The numbers are there already and are worth more."""
    try:
        from dcone_cosim.reports.figures import draw_all

        return draw_all(result, folder)
    except Exception as error:
        return [f"no figure could be drawn: {type(error).__name__}: {error}"]


def write_fmus(name: str, out: Path, progress: Progress, settings: Sequence[str] = ()) -> list[Path]:
    """Copy the FMUs of a scene to a folder under readable names; files that the scene names are there already."""
    scene = named(name, settings)
    if out.exists() and not out.is_dir():
        raise InputError(f"{out} is not a folder")
    ours = [(c.model, c.terms) for phase in scene.phases for c in phase.components if c.fmu is None]
    made = [p for p in (out.absolute(), *out.absolute().parents) if not p.exists()]
    try:
        out.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(prefix=".dcone-", dir=out) as draft:
            built = build.ensure(ours, progress.say)
            copies = {out / build.readable_name(*wanted): fmu for wanted, fmu in zip(ours, built, strict=True)}
            for path, fmu in copies.items():
                os.replace(shutil.copyfile(fmu, Path(draft) / path.name), path)
    except BaseException:
        for folder in made:
            with contextlib.suppress(OSError):
                folder.rmdir()
        raise
    return list(copies)
