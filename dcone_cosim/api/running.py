"""Scenes run, and runs read back."""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from dcone_cosim import interrupts
from dcone_cosim.accuracy.attain import as_asked
from dcone_cosim.api.result import Run
from dcone_cosim.api.said import settings_of
from dcone_cosim.api.scene import Scene, as_scene
from dcone_cosim.api.showing import shown
from dcone_cosim.errors import SUCCESS, InputError
from dcone_cosim.resume import instants
from dcone_cosim.resume.begin import Origin
from dcone_cosim.run_reading import provenance_of, read_run
from dcone_cosim.running import Ran, run_once

INTERRUPTED = (
    b"interrupted; what was reached is kept as soon as the step ends (once more: leave at once, keep nothing)\n"
)


def run(
    scene: Scene | str | Path,
    *,
    save_at: Sequence[str] = (),
    progress: bool | None = None,
    isolate: bool | None = None,
) -> Run:
    """Run a scene; the run is in memory until `Run.save`.

    scene       a scene, or what `load_scene` takes
    save_at     instants at which the state of a phase is kept, so that `go_on` can begin there: "removal:10 min"
    progress    show it (True), be quiet (False), or show it in a notebook and on a terminal (None)
    isolate     run every FMU in a process of its own, or none; those that were not built here for None

    A run that fails on the way comes back with what it reached: see `Run.status`. `InputError` for bad input.
    """
    given = as_scene(scene)
    checked = given.checked.isolating(isolate)
    keep = instants.save_at([save_at] if isinstance(save_at, str) else save_at, checked)
    with interrupts.heeded(INTERRUPTED), shown(progress) as told:
        checked, attained = as_asked(given.source, given.settings, checked, isolate, told)
        ran = run_once(checked, told, keep=keep, attained=attained)
    return as_run(ran)


def go_on(
    run: Run | str | Path,
    at: str,
    changes: Mapping[str, Any] | None = None,
    /,
    *,
    save_at: Sequence[str] = (),
    progress: bool | None = None,
    isolate: bool | None = None,
    **tables: Any,
) -> Run:
    """Go on from an earlier run, with the same bits where nothing is changed.

    run       folder of the run, or a run that is in one
    at        "removal": from the hand-over to that phase; "removal:10 min": from the state that it kept there
    changes   what is other from there on, and `tables` the same, as in `Scene.with_`; what is over cannot change
    """
    folder = run.folder if isinstance(run, Run) else Path(run)
    if folder is None:
        raise InputError("this run is in no folder, and what it kept is not on disk; save it first: run.save(folder)")
    origin = Origin(folder, at, list(settings_of({**(changes or {}), **tables})))
    scene = origin.scene.isolating(isolate)
    keep = instants.save_at([save_at] if isinstance(save_at, str) else save_at, scene)
    with interrupts.heeded(INTERRUPTED), shown(progress) as told:
        ran = run_once(scene, told, origin.begun, keep)
    return as_run(ran)


def as_run(ran: Ran) -> Run:
    """The run for its user, who is warned where it did not come to its end."""
    if ran.result.exit_code != SUCCESS:
        warnings.warn(f"{ran.result.status}: {ran.result.message}", stacklevel=3)
    return Run(ran.result, ran.facts, ran.started, tuple(ran.notes))


def load_run(folder: str | Path) -> Run:
    """The run that left this folder, as it was; `InputError` where it is none."""
    path = Path(folder)
    told: dict[str, Any] = provenance_of(path)
    return Run(read_run(path), told["phases"], folder=path)
