"""The command line. Nothing heavy is imported before a command needs it, so that `dcone --help` answers at once."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from dcone_cosim.errors import BAD_INPUT, DconeError

if TYPE_CHECKING:
    from rich.console import Console

    from dcone_cosim.progress import Progress

app = typer.Typer(
    help="Net capture and tethered removal of space debris, as a co-simulation of FMI 2.0 units.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)

SceneName = Annotated[str, typer.Argument(metavar="SCENE", help="Name of a scene (see `dcone list`), or a .toml file.")]


@app.command()
def run(
    scene: SceneName,
    out: Annotated[
        Path | None, typer.Option("-o", "--out", help="Folder for the results [default: runs/SCENE-TIME].")
    ] = None,
    csv: Annotated[bool, typer.Option("--csv", help="Write the columns as CSV too.")] = False,
    json: Annotated[bool, typer.Option("--json", help="Print the summary as JSON.")] = False,
    figures: Annotated[bool, typer.Option("--figures/--no-figures", help="Draw the figures.")] = True,
    force: Annotated[bool, typer.Option("--force", help="Replace the results in the folder.")] = False,
) -> None:
    """Run a scene and write its results.

    Exit code: 0 success, 2 bad input, 3 the capture failed, 4 the hand-off was refused or violated, 5 an FMU failed.
    """
    from dcone_cosim.commands import run_and_write

    console = _console(json)
    progress = _progress(console)
    try:
        result, folder = run_and_write(scene, out, progress, with_csv=csv, with_figures=figures, force=force)
    finally:
        progress.close()
    from dcone_cosim.reports import summary

    if json:
        import json as encoder

        typer.echo(encoder.dumps(summary.as_dict(result) | {"folder": str(folder)}, indent=1))
    else:
        summary.show(result, console)
        typer.echo(f"results in {folder}")
    if result.message:
        typer.echo(result.message, err=True)
    raise typer.Exit(result.exit_code)


@app.command()
def build(
    scene: SceneName,
    out: Annotated[Path, typer.Option("-o", "--out", help="Folder for the .fmu files.")],
) -> None:
    """Write the FMUs of a scene, for use in other tools."""
    from dcone_cosim.commands import write_fmus

    progress = _progress(_console(False))
    try:
        paths = write_fmus(scene, out, progress)
    finally:
        progress.close()
    for path in paths:
        typer.echo(path)


@app.command(name="list")
def list_scenes() -> None:
    """Name the scenes that come with the program."""
    from dcone_cosim.scene import shipped, title_of

    scenes = shipped()
    width = max(len(name) for name in scenes)
    for name, path in scenes.items():
        typer.echo(f"{name:{width}}  {title_of(path)}")


@app.command()
def inspect(scene: SceneName) -> None:
    """Show what a scene puts into its FMUs, what it leaves out, and how large they are."""
    from dcone_cosim.reports.inspection import show
    from dcone_cosim.scene import load

    console = _console(False)
    progress = _progress(console)
    try:
        show(load(scene), console, progress)
    finally:
        progress.close()


def _console(to_error: bool) -> Console:
    from rich.console import Console

    return Console(stderr=to_error)


def _progress(console: Console) -> Progress:
    from dcone_cosim.progress import Bar, Lines

    return Bar(console) if console.is_terminal else Lines()


def main() -> None:
    """Entry point: expected failures become one message and an exit code, never a traceback."""
    try:
        app()
    except DconeError as error:
        typer.echo(f"dcone: {error}", err=True)
        sys.exit(error.exit_code)
    except KeyboardInterrupt:
        typer.echo("dcone: stopped", err=True)
        sys.exit(130)
    except BrokenPipeError:
        sys.exit(BAD_INPUT)
