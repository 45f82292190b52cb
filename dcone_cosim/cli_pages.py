"""The commands that make pages: of a run, of its replay alone, of many scenes."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from dcone_cosim.cli_options import at_work
from dcone_cosim.cli_runs import RunFolder
from dcone_cosim.completion import scenes_like
from dcone_cosim.exits import complain, reader_may_leave

pages_app = typer.Typer(rich_markup_mode=None)
Page = Annotated[
    Path | None, typer.Option("-o", "--out", help="The file; in the folder of the run if not given.", metavar="FILE")
]
Open = Annotated[bool, typer.Option("--open", help="Show it in the browser.")]


def _told(paths: list[Path], show: bool) -> None:
    with reader_may_leave():
        for path in paths:
            typer.echo(path)
    if show:
        import webbrowser

        if not webbrowser.open(paths[0].absolute().as_uri()):
            complain("note: no browser was found to show it in")


@pages_app.command()
def report(
    run: RunFolder,
    out: Page = None,
    sizing: Annotated[
        Path | None, typer.Option("--sizing", help="Folder that `dcone size` left, to tell its answer and link to it.")
    ] = None,
    accuracy: Annotated[Path | None, typer.Option("--accuracy", help="The same of `dcone accuracy`.")] = None,
    stability: Annotated[Path | None, typer.Option("--stability", help="The same of `dcone stability`.")] = None,
    pdf: Annotated[bool, typer.Option("--pdf", help="Print it too, with a Chromium that is installed.")] = False,
    csv: Annotated[
        bool | None,
        typer.Option(
            "--csv/--no-csv",
            help="Write the histories and tugs beside it as CSV, every column with all digits. If not given, where the "
            "page is in the folder of the run, but for tables of more than a million values.",
            show_default=False,
        ),
    ] = None,
    live: Annotated[
        bool, typer.Option("--live/--no-live", help="Put the model of the tow into it, to move its values there.")
    ] = True,
    show: Open = False,
) -> None:
    """Write a run as one page that opens from disk without a network.

    It has the capture and the tow as clips to turn and play, the histories to zoom into, what every line bore and what
    governs it, all figures, the ledger of the hand-over, and the command that makes the run again. Of the net it shows
    what the run has kept: all with `dcone run --replay`.

    Exit code: 0 success, 2 bad input.
    """
    from dcone_cosim.report.commands import linked, write_page

    with at_work() as progress:
        paths = write_page(run, out, progress, linked(sizing, accuracy, stability), pdf=pdf, live=live, csv=csv)
    _told(paths, show)


@pages_app.command()
def replay(run: RunFolder, out: Page = None, show: Open = False) -> None:
    """Write the replay of a run alone as a page: its clips, and the tugs.

    Exit code: 0 success, 2 bad input.
    """
    from dcone_cosim.report.commands import write_page

    with at_work() as progress:
        paths = write_page(run, out, progress, whole=False)
    _told(paths, show)


@pages_app.command()
def gallery(
    scenes: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="[SCENE]...",
            help="Scenes to show; all that are shipped if none is named.",
            autocompletion=scenes_like,
        ),
    ] = None,
    out: Annotated[
        Path, typer.Option("-o", "--out", help="Folder for the pages; goes on with what is missing.")
    ] = Path("gallery"),
    full: Annotated[
        bool, typer.Option("--full", help="Run long phases to their end; a day of them if not given.")
    ] = False,
) -> None:
    """Run scenes and write a page of each, with an index.

    Exit code: 0 success, 2 bad input, 7 some scenes could not be run.
    """
    from dcone_cosim.report.gallery import make

    with at_work() as progress:
        index, failed = make(scenes or [], out, progress, full)
    with reader_may_leave():
        typer.echo(index)
    for name, reason in failed.items():
        complain(f"note: {name} has no page: {reason}")
    raise typer.Exit(7 if failed else 0)
