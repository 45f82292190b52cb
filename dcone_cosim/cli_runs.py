"""The commands that run a scene, draw a run again, and set two side by side."""

from __future__ import annotations

import gc
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from dcone_cosim import cli_cases, exits
from dcone_cosim.cli_options import (
    Jobs,
    Json,
    Offline,
    SceneName,
    Settings,
    answer,
    at_work,
    make_progress,
    promise,
    results,
)
from dcone_cosim.errors import InputError
from dcone_cosim.exits import complain as _complain
from dcone_cosim.exits import reader_may_leave as _reader_may_leave

if TYPE_CHECKING:
    from rich.console import Console

runs_app = typer.Typer(rich_markup_mode=None)
RunFolder = Annotated[Path, typer.Argument(metavar="RUN", help="Folder of a run.")]


@runs_app.command()
def run(
    scene: SceneName,
    out: Annotated[
        Path | None, typer.Option("-o", "--out", help="Folder for the results; runs/SCENE-TIME if not given.")
    ] = None,
    settings: Settings = None,
    csv: Annotated[bool, typer.Option("--csv", help="Write the columns as CSV too.")] = False,
    json: Annotated[bool, typer.Option("--json", help="Print the summary as JSON.")] = False,
    figures: Annotated[bool, typer.Option("--figures/--no-figures", help="Draw the figures.")] = True,
    force: Annotated[bool, typer.Option("--force", help="Replace the results in the folder.")] = False,
    isolate: Annotated[
        bool | None,
        typer.Option(
            "--isolate/--no-isolate",
            help="Run every FMU in a process of its own, or none; those that were not built here if not given.",
            show_default=False,
        ),
    ] = None,
    save_at: Annotated[
        list[str] | None,
        typer.Option(
            "--save-at",
            metavar="PHASE:TIME",
            help="Keep the state there, such as removal:1h, by the phase's own time; may be given several times.",
        ),
    ] = None,
    go_on: Annotated[
        str,
        typer.Option(
            "--from",
            metavar="PHASE[:TIME]",
            help="Go on from there: SCENE is the folder of a run, which kept that state, or handed over to that phase.",
            show_default=False,
        ),
    ] = "",
    ensemble: Annotated[
        int | None,
        typer.Option(
            "--ensemble", metavar="N", help="Run it N times, each with a start that differs by 1 um: mean and spread."
        ),
    ] = None,
    seed: Annotated[int, typer.Option("--seed", help="Of an ensemble's first run; the others count on.")] = 0,
    replay: Annotated[
        bool, typer.Option("--replay", help="Keep the net in full, for `dcone replay` and `dcone report`.")
    ] = False,
    jobs: Jobs = None,
    offline: Offline = False,
) -> None:
    """Run a scene and write its results.

    With --ensemble the summary is mean, spread and percentiles of all figures, and a table has every run; the same
    command goes on with the runs that are missing.

    A run may go on from another: `dcone run FOLDER --from removal` runs the removal anew from that run's hand-over,
    `--from removal:1h` goes on from the state kept by `--save-at removal:1h`, with the same bits. With --set, what is
    not over may change: later phases, how long the phase lasts, its inputs and tunable parameters.

    Exit code: 0 success, 1 the results are complete but could not be told, 2 bad input, 3 the capture failed,
    4 the hand-off was refused or violated, 5 an FMU failed, 6 interrupted, and what was reached is kept,
    7 some runs of an ensemble failed, 8 a line bore more than it can; 130 or 143 interrupted, and there was nothing to
    keep.
    """
    promise(offline)
    if ensemble is not None:
        if force:
            raise InputError("--force: an ensemble goes on with what is in its folder; choose another with -o")
        if replay:
            raise InputError("--replay: an ensemble keeps figures alone; leave it out")
        if save_at or go_on:
            raise InputError("--ensemble: its runs keep no states and go on from none; leave --save-at and --from out")
        raise typer.Exit(cli_cases.ensemble(scene, ensemble, seed, out, settings or [], jobs, isolate, json))
    gc.disable()  # while modules are imported nothing is garbage; `run_and_write` enables it again
    from dcone_cosim.commands import run_and_write

    progress = make_progress()
    try:
        with exits.noise_apart():
            written = run_and_write(
                scene, out, progress, csv, figures, force, settings or (), isolate, save_at or (), go_on, replay
            )
    finally:
        progress.close()
    result = written.result
    from dcone_cosim import loads
    from dcone_cosim.reports import summary
    from dcone_cosim.reports.warnings import warnings

    with _reader_may_leave():
        if json:
            from dcone_cosim.run_folder import as_json

            more = {"folder": str(written.folder), "notes": written.notes}
            typer.echo(as_json(summary.as_dict(result) | more))
        else:
            summary.show(result, results())
            typer.echo(f"results in {written.folder}")
    for note in written.notes:
        _complain(f"note: {note}")
    headlines = loads.headlines(result)
    for warning in warnings(result):
        if warning not in headlines:
            _complain(f"warning: {warning}")
    for line in result.message.splitlines():
        if json or line not in headlines:  # which the summary begins with
            _complain(line)
    raise typer.Exit(result.exit_code)


@runs_app.command()
def plot(
    run: RunFolder,
    out: Annotated[
        Path | None, typer.Option("-o", "--out", help="Folder for the figures; that of the run if not given.")
    ] = None,
) -> None:
    """Draw the figures of a run again, from the tables in its folder; nothing is run.

    Figures that are there give way.

    Exit code: 0 success, 2 bad input.
    """
    from dcone_cosim.redrawing import draw_again

    with at_work() as progress:
        paths, notes = draw_again(run, out, progress)
    with _reader_may_leave():
        for path in paths:
            typer.echo(path)
    for note in notes:
        _complain(f"note: {note}")


@runs_app.command()
def compare(
    first: Annotated[Path, typer.Argument(metavar="RUN", help="Folder of a run.")],
    second: Annotated[Path, typer.Argument(metavar="RUN", help="Folder of another.")],
    out: Annotated[
        Path | None,
        typer.Option(
            "-o", "--out", help="Folder for compare.csv, compare.json, compare.png and report.html; must be new."
        ),
    ] = None,
    json: Json = False,
) -> None:
    """Set two runs side by side: the keys in which their scenes differ, and every figure with its difference.

    Differences are those of the second from the first. With -o there is a picture too, of
    tensions and mouth areas, and a page with all histories of both.

    Exit code: 0 success, whether they differ or not, 2 bad input.
    """
    from dcone_cosim.comparing import commands, show

    with at_work() as progress:
        progress.say("reading both runs")
        found = commands.compare(first, second)
        content = show.as_dict(found)
        folder = None if out is None else commands.write(found, out, content)

    def shown(console: Console) -> None:
        show.show(found, console)

    answer(json, content, shown, found.notes, folder)
