"""`dcone sweep`, and what `dcone run --ensemble` tells: many runs of a scene."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from dcone_cosim import exits
from dcone_cosim.exits import complain

if TYPE_CHECKING:
    from rich.console import Console

    from dcone_cosim.cases.commands import Done
    from dcone_cosim.progress import Progress

Vary = Annotated[
    list[str] | None,
    typer.Option(
        "--vary",
        metavar="KEY=VALUES",
        help='A key of the scene and its values, such as removal.tether.rest_length="50 m,100 m" or ="10 m..100 m:10" '
        "(ten values, evenly spread; :10:log in their logarithm). Several times: every value with every other.",
    ),
]
Out = Annotated[
    Path | None,
    typer.Option("-o", "--out", help="Folder for the results; the same command goes on there with what is missing."),
]
Jobs = Annotated[
    int | None, typer.Option("-j", "--jobs", help="How many cases at a time; one per core if not given.", min=1)
]


def tell(done: Done, json: bool, console: Console, ensemble: bool) -> int:
    """Show what came out and where it is; returns the exit code."""
    from dcone_cosim.cases import show

    with exits.reader_may_leave():
        if json:
            from dcone_cosim.run_folder import as_json

            typer.echo(as_json({**done.content, "folder": str(done.folder), "notes": done.notes}))
        else:
            if ensemble:
                show.show_ensemble(done.summary, done.title, console)
            else:
                show.show_sweep(done.entries, done.columns, done.title, console)
            typer.echo(f"results in {done.folder}")
    for note in done.notes:
        complain(f"note: {note}")
    for failure in show.failures(done.entries):
        complain(failure)
    if done.exit_code:
        share = done.summary.succeeded
        complain(f"{share.of - share.count} of {share.of} cases failed")
    return done.exit_code


def ensemble(
    scene: str,
    count: int,
    seed: int,
    out: Path | None,
    settings: list[str],
    jobs: int | None,
    isolate: bool | None,
    progress: Progress,
) -> Done:
    """Run the ensemble, with its progress."""
    from dcone_cosim.cases import commands

    try:
        with exits.noise_apart():
            return commands.ensemble(scene, count, seed, out, progress, settings, jobs, isolate)
    finally:
        progress.close()


def sweep(
    scene: str,
    vary: list[str],
    out: Path | None,
    settings: list[str],
    jobs: int | None,
    figures: bool,
    isolate: bool | None,
    progress: Progress,
) -> Done:
    """Run the sweep, with its progress."""
    from dcone_cosim.cases import commands

    try:
        with exits.noise_apart():
            return commands.sweep(scene, vary, out, progress, settings, jobs, figures, isolate)
    finally:
        progress.close()


def accuracy(
    scene: str,
    out: Path | None,
    settings: list[str],
    runs: int | None,
    quick: bool,
    peers: bool,
    jobs: int | None,
    isolate: bool | None,
    json: bool,
    progress: Progress,
    console: Console,
) -> int:
    """Measure, and show what came out and where it is; returns the exit code."""
    from dcone_cosim.accuracy import commands, show

    try:
        with exits.noise_apart():
            done = commands.accuracy(scene, out, progress, settings, runs, quick, jobs, isolate, peers=peers)
    finally:
        progress.close()
    with exits.reader_may_leave():
        if json:
            from dcone_cosim.run_folder import as_json

            typer.echo(as_json({**done.content, "folder": str(done.folder), "notes": done.notes}))
        else:
            for report in done.reports:
                show.show(report, console)
            typer.echo(f"results in {done.folder}")
    for note in done.notes:
        complain(f"note: {note}")
    return done.exit_code


def physics(
    scene: str, settings: list[str], jobs: int | None, json: bool, progress: Progress, console: Console
) -> None:
    """Measure what each piece of physics changes and costs, and show it."""
    from dcone_cosim.accuracy import physics as effects

    try:
        with exits.noise_apart():
            found = effects.measured(scene, settings, progress, jobs)
    finally:
        progress.close()
    with exits.reader_may_leave():
        if json:
            from dcone_cosim.run_folder import as_json

            typer.echo(as_json(effects.as_dict(found)))
        else:
            effects.show(found, console)
    for note in (note for one in found for note in one.notes):
        complain(f"note: {note}")


def stability(
    scene: str | None,
    out: Path | None,
    settings: list[str],
    limit: float,
    budget: float | None,
    quick: bool,
    jobs: int | None,
    isolate: bool | None,
    json: bool,
    progress: Progress,
    console: Console,
) -> int:
    """Try the extremes, and show what became of them and where it is; returns the exit code."""
    from dcone_cosim.stability import commands, show

    try:
        with exits.noise_apart():
            done = commands.stability(scene, out, progress, settings, limit, budget, quick, jobs, isolate)
    finally:
        progress.close()
    with exits.reader_may_leave():
        if json:
            from dcone_cosim.run_folder import as_json

            typer.echo(as_json({**done.content, "folder": str(done.folder), "notes": done.notes}))
        else:
            for one in done.matrices:
                show.show(one, console)
            typer.echo(f"results in {done.folder}")
    for note in done.notes:
        complain(f"note: {note}")
    return done.exit_code
