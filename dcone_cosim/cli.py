"""The command line. Nothing heavy is imported before a command needs it, so that `dcone --help` answers at once."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NoReturn

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
        Path | None, typer.Option("-o", "--out", help="Folder for the results; runs/SCENE-TIME if not given.")
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

    progress = _progress()
    try:
        written = run_and_write(scene, out, progress, with_csv=csv, with_figures=figures, force=force)
    finally:
        progress.close()
    result = written.result
    from dcone_cosim.reports import summary

    with _reader_may_leave():
        if json:
            from dcone_cosim.run import as_json

            more = {"folder": str(written.folder), "notes": written.notes}
            typer.echo(as_json(summary.as_dict(result) | more))
        else:
            summary.show(result, _console())
            typer.echo(f"results in {written.folder}")
    for note in written.notes:
        _complain(f"note: {note}")
    if result.message:
        _complain(result.message)
    raise typer.Exit(result.exit_code)


@app.command()
def build(
    scene: SceneName,
    out: Annotated[Path, typer.Option("-o", "--out", help="Folder for the .fmu files.")],
) -> None:
    """Write the FMUs of a scene, for use in other tools."""
    from dcone_cosim.commands import write_fmus

    progress = _progress()
    try:
        paths = write_fmus(scene, out, progress)
    finally:
        progress.close()
    with _reader_may_leave():
        for path in paths:
            typer.echo(path)


@app.command(name="export-ssp")
def export_ssp(
    scene: SceneName,
    out: Annotated[Path, typer.Option("-o", "--out", help="Folder for the .ssp files.")] = Path(),
    from_run: Annotated[
        Path | None, typer.Option("--from-run", help="Results of this scene: begin the removal as handed over there.")
    ] = None,
    parameters: Annotated[
        str, typer.Option("--parameters", help="Where the structure has its values: inline, or in the ssv files.")
    ] = "inline",
    open_inputs: Annotated[
        bool, typer.Option("--open-inputs/--no-open-inputs", help="List inputs that nothing is connected to.")
    ] = True,
) -> None:
    """Write one package in the format SSP 1.0 per phase of a scene, for use in other tools."""
    from dcone_cosim.ssp.export import export_scene

    progress = _progress()
    try:
        done = export_scene(scene, out, progress, from_run, parameters, open_inputs)
    finally:
        progress.close()
    with _reader_may_leave():
        for path in done.paths:
            typer.echo(path)
    for note in done.notes:
        _complain(f"note: {note}")


@app.command(name="list")
def list_scenes() -> None:
    """Name the scenes that come with the program."""
    from dcone_cosim.scene import shipped, title_of

    scenes = shipped()
    width = max(len(name) for name in scenes)
    with _reader_may_leave():
        for name, path in scenes.items():
            typer.echo(f"{name:{width}}  {title_of(path)}")


@app.command()
def inspect(scene: SceneName) -> None:
    """Show what a scene puts into its FMUs, what it leaves out, and how large they are."""
    from dcone_cosim.commands import named
    from dcone_cosim.reports.inspection import show

    progress = _progress()
    try:
        with _reader_may_leave():
            show(named(scene), _console(), progress)
    finally:
        progress.close()


@app.command()
def interface(
    phase: Annotated[str, typer.Argument(metavar="PHASE", help="capture or removal")],
    template: Annotated[
        str | None, typer.Option("--template", metavar="KIND", help="Write an empty FMU too: c or pythonfmu.")
    ] = None,
    out: Annotated[
        Path | None, typer.Option("-o", "--out", help="Folder for the template; my_PHASE if not given.")
    ] = None,
) -> None:
    """Show what the master looks for in the FMU of a phase, or write an empty FMU that has it."""
    from dcone_cosim.interface_kit import show, write_template

    with _reader_may_leave():
        if template is None:
            show(phase, _console())
            return
        for path in write_template(phase, template, out if out is not None else Path(f"my_{phase}")):
            typer.echo(path)


def _console() -> Console:
    """Where results go: stdout, for whoever reads it."""
    from rich.console import Console

    class Output(Console):
        def on_broken_pipe(self) -> None:
            raise BrokenPipeError

    return Output(soft_wrap=not sys.stdout.isatty())


def _progress() -> Progress:
    """What is going on goes to stderr."""
    from dcone_cosim.progress import Bar, Lines

    if not sys.stderr.isatty():
        return Lines()
    from rich.console import Console

    return Bar(Console(stderr=True))


@contextmanager
def _reader_may_leave() -> Iterator[None]:
    """Output that nobody reads any more (`dcone run mission | head -1`) is dropped: the work itself is done."""
    try:
        yield
        sys.stdout.flush()
    except BrokenPipeError:
        _to_nowhere()


def _to_nowhere() -> None:
    """What is still buffered for stdout goes nowhere, so that closing it at the end does not fail."""
    with suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _complain(text: str) -> None:
    with suppress(OSError):
        typer.echo(text, err=True)


def _fail(text: str, exit_code: int) -> NoReturn:
    """One message on stderr, and with --json the same as an object on stdout."""
    _complain(f"dcone: {text}")
    _answer(text, exit_code)
    sys.exit(exit_code)


def _answer(text: str, exit_code: int) -> None:
    if "--json" in sys.argv[1:]:
        import json

        with _reader_may_leave():
            typer.echo(json.dumps({"error": text, "exit_code": exit_code}))


INTERRUPTED, TERMINATED = 130, 143


def _terminate(*_: object) -> NoReturn:
    sys.exit(TERMINATED)


def main() -> None:
    """Entry point: expected failures become one message and an exit code, never a traceback."""
    before = _on_terminate(_terminate)
    try:
        code = app(standalone_mode=False)
    except DconeError as error:
        _fail(str(error), error.exit_code)
    except KeyboardInterrupt:
        code = INTERRUPTED
    except OSError as error:
        _fail(_of_system(error), BAD_INPUT)
    except Exception as error:
        code = _of_arguments(error)
    except SystemExit as stop:
        if stop.code == TERMINATED:
            _fail("terminated; nothing was written", TERMINATED)
        if stop.code != 1:
            raise
        # typer ends so when the reader of a help text has left
        _to_nowhere()
        code = 0
    finally:
        _on_terminate(before)
    if code == INTERRUPTED:
        _fail("interrupted; nothing was written", INTERRUPTED)
    sys.exit(code or 0)


def _on_terminate(handler: Any) -> Any:
    """Set what SIGTERM does, so that temporary folders are removed then too; returns what it did before."""
    try:
        return signal.signal(signal.SIGTERM, handler)
    except ValueError:
        return signal.SIG_DFL


def _of_system(error: OSError) -> str:
    """What the system refused, in one line that names the file."""
    files = " -> ".join(str(f) for f in (error.filename, error.filename2) if f is not None)
    reason = error.strerror or str(error) or type(error).__name__
    return f"{files}: {reason}; nothing was written" if files else f"{reason}; nothing was written"


def _of_arguments(error: Exception) -> int:
    """Exit code of a wrong command line, once it is told; any other exception is a fault of ours and goes on."""
    show, message = getattr(error, "show", None), getattr(error, "format_message", None)
    if show is None or message is None:
        raise error
    show()
    code = int(getattr(error, "exit_code", BAD_INPUT))
    _answer(message(), code)
    return code
