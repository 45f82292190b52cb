"""What the commands have in common: options, where results and progress go, how an answer is told."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from dcone_cosim import exits
from dcone_cosim.completion import scenes_like

if TYPE_CHECKING:
    from rich.console import Console

    from dcone_cosim.progress import Progress

SCENE_HELP = "Name of a scene (see `dcone list`), or a .toml file."
SceneName = Annotated[str, typer.Argument(metavar="SCENE", help=SCENE_HELP, autocompletion=scenes_like)]
Settings = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="KEY=VALUE",
        help='Change a key of the scene, such as capture.bullets.speed="4 m/s"; may be given several times.',
    ),
]
FromRun = Annotated[
    Path | None, typer.Option("--from-run", help="Results of this scene: what takes over begins as it did there.")
]
Json = Annotated[bool, typer.Option("--json", help="Answer as JSON.")]
Offline = Annotated[
    bool,
    typer.Option(
        "--offline", help="Promise that nothing is fetched: every connection is refused. Building needs none."
    ),
]
Jobs = Annotated[
    int | None, typer.Option("-j", "--jobs", help="How many cases at a time; one per core if not given.", min=1)
]


def promise(offline: bool) -> None:
    if offline:
        from dcone_cosim.offline import go_offline

        go_offline()


def results() -> Console:
    """Where results go: stdout, for whoever reads it."""
    from rich.console import Console

    class Output(Console):
        def on_broken_pipe(self) -> None:
            raise BrokenPipeError

    return Output(soft_wrap=not sys.stdout.isatty())


def make_progress() -> Progress:
    """What is going on goes to stderr."""
    from dcone_cosim.progress import Bar, Lines

    if not sys.stderr.isatty():
        return Lines()
    from rich.console import Console

    return Bar(Console(stderr=True))


@contextmanager
def at_work() -> Iterator[Progress]:
    """Progress for as long as the work goes on, with the noise of FMUs kept apart."""
    progress = make_progress()
    try:
        with exits.noise_apart():
            yield progress
    finally:
        progress.close()


def answer(
    json: bool, content: Mapping[str, Any], show: Callable[[Console], object], notes: Sequence[str], folder: Path | None
) -> None:
    """Tell what came out: for machines or for a reader, where it is, and what to note."""
    with exits.reader_may_leave():
        if json:
            from dcone_cosim.run_folder import as_json

            place = {} if folder is None else {"folder": str(folder), "notes": list(notes)}
            typer.echo(as_json({**content, **place}))
        else:
            show(results())
            if folder is not None:
                typer.echo(f"results in {folder}")
    for note in notes:
        exits.complain(f"note: {note}")
