"""The command line. Nothing heavy is imported before a command needs it, so that `dcone --help` answers at once."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, NoReturn

import typer

from dcone_cosim import cli_cases, exits
from dcone_cosim.cli_cache import cache_app
from dcone_cosim.cli_campaign import campaign_app
from dcone_cosim.cli_cases import cases_app
from dcone_cosim.cli_options import (
    SCENE_HELP,
    FromRun,
    Jobs,
    Json,
    Offline,
    SceneName,
    Settings,
    make_progress,
    promise,
    results,
)
from dcone_cosim.cli_pages import pages_app
from dcone_cosim.cli_runs import runs_app
from dcone_cosim.cli_tracks import tracks_app
from dcone_cosim.completion import phases_like, scenes_like
from dcone_cosim.errors import BAD_INPUT, DconeError
from dcone_cosim.exits import complain as _complain
from dcone_cosim.exits import reader_may_leave as _reader_may_leave

app = typer.Typer(
    help="Net capture and tethered removal of space debris, as a co-simulation of FMI 2.0 units.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,  # plain help takes half the time: rich would load its Markdown reader for it
)
app.add_typer(cache_app, name="cache")
app.add_typer(runs_app)
app.add_typer(cases_app)
app.add_typer(campaign_app, name="campaign")
app.add_typer(tracks_app)
app.add_typer(pages_app)


def _version(asked: bool) -> None:
    if asked:
        from importlib.metadata import version

        typer.echo(f"dcone {version('dcone-cosim')}")
        raise typer.Exit


@app.callback()
def common(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Show the version and leave.")
    ] = False,
) -> None:
    """Net capture and tethered removal of space debris, as a co-simulation of FMI 2.0 units."""


@app.command()
def build(
    scene: SceneName,
    out: Annotated[Path, typer.Option("-o", "--out", help="Folder for the .fmu files.")],
    platforms: Annotated[
        str,
        typer.Option(
            "--platforms",
            metavar="LIST",
            help="all, or some of linux64,win64,darwin64,linux-aarch64; this machine's alone.",
        ),
    ] = "",
    from_run: FromRun = None,
    settings: Settings = None,
    offline: Offline = False,
) -> None:
    """Write the FMUs of a scene, for use in other tools.

    Each starts with the scene's values, and its default experiment is the phase. Values cost no build.
    """
    promise(offline)
    from dcone_cosim.commands import write_fmus

    progress = make_progress()
    try:
        paths, notes = write_fmus(scene, out, progress, platforms, settings or (), from_run)
    finally:
        progress.close()
    with _reader_may_leave():
        for path in paths:
            typer.echo(path)
    for note in notes:
        _complain(f"note: {note}")


@app.command(name="export-ssp")
def export_ssp(
    scene: SceneName,
    out: Annotated[Path, typer.Option("-o", "--out", help="Folder for the .ssp files.")] = Path(),
    from_run: FromRun = None,
    parameters: Annotated[
        str, typer.Option("--parameters", help="Where the structure has its values: inline, or in the ssv files.")
    ] = "inline",
    open_inputs: Annotated[
        bool, typer.Option("--open-inputs/--no-open-inputs", help="List inputs that nothing is connected to.")
    ] = True,
    settings: Settings = None,
) -> None:
    """Write one package in the format SSP 1.0 per phase of a scene, for use in other tools."""
    from dcone_cosim.loading import named
    from dcone_cosim.ssp.export import export_scene

    progress = make_progress()
    try:
        done = export_scene(named(scene, settings or ()), out, progress, from_run, parameters, open_inputs)
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
    from dcone_cosim.loading import shipped, title_of

    scenes = shipped()
    width = max(len(name) for name in scenes)
    with _reader_may_leave():
        for name, path in scenes.items():
            typer.echo(f"{name:{width}}  {title_of(path)}")


@app.command()
def inspect(
    scene: SceneName,
    settings: Settings = None,
    json: Json = False,
    measure: Annotated[
        bool, typer.Option("--measure", help="Run with and without each piece of physics: what it changes and costs.")
    ] = False,
    jobs: Jobs = None,
    offline: Offline = False,
) -> None:
    """Show what is in the FMUs of a scene, what is left out, and what its values come to.

    Terms, nodes, threads, states, variables, bytes; stiffness, masses, periods, momentum and energy of the shot,
    substeps; of an FMU from elsewhere what it tells of itself. With --measure instead what each term changes in the
    results, and what it costs in time, bytes, variables and memory.
    """
    promise(offline)
    from dcone_cosim.loading import named
    from dcone_cosim.reports import inspection

    if measure:
        cli_cases.physics(scene, settings or [], jobs, json)
        return
    progress = make_progress()
    try:
        with _reader_may_leave():
            chosen = named(scene, settings or ())
            if json:
                from dcone_cosim.run_folder import as_json

                typer.echo(as_json(inspection.as_dict(chosen, progress)))
            else:
                inspection.show(chosen, results(), progress)
    finally:
        progress.close()


@app.command()
def new(
    name: Annotated[str, typer.Argument(metavar="NAME", help="File to write; .toml is added when it has no suffix.")],
    origin: Annotated[
        str, typer.Option("--from", metavar="SCENE", help="Scene to begin from.", autocompletion=scenes_like)
    ] = "mission",
    scaled: Annotated[
        str,
        typer.Option(
            "--scaled", metavar="SHARE", help="Write a breadboard similar to its capture, such as 1/16 as large."
        ),
    ] = "",
) -> None:
    """Write a scene to start from, with every key explained.

    What is left at its default stands there as a comment with that default. With --scaled every length and time of its
    capture is so much smaller at the same speeds, and masses, forces and stiffness follow; comments name what can not
    be kept. Never replaces a file.
    """
    from dcone_cosim.commands import write_scene

    path, next_steps = write_scene(name, origin, scaled)
    with _reader_may_leave():
        typer.echo(path)
    for step in next_steps:
        _complain(step)


@app.command()
def validate(
    scenes: Annotated[list[str], typer.Argument(metavar="SCENE...", help=SCENE_HELP, autocompletion=scenes_like)],
    settings: Settings = None,
    json: Json = False,
) -> None:
    """Check scenes and tell all mistakes at once.

    FMUs that a scene names are opened; none is built or run.

    Exit code: 0 all are good, 2 there is a mistake.
    """
    from dcone_cosim.loading import named

    answers = []
    for name in scenes:
        answer: dict[str, object] = {"scene": name, "ok": True}
        try:
            scene = named(name, settings or ())
            phases = ", ".join(phase.name for phase in scene.phases)
            answer["notes"], answer["warnings"] = list(scene.notes), list(scene.cautions)
        except DconeError as error:
            answer |= {"ok": False, "error": str(error), **exits.details(error)}
            if not json:
                _complain(str(error))
        else:
            if not json:
                with _reader_may_leave():
                    typer.echo(f"{name}: ok ({phases})")
                for note in scene.notes:
                    _complain(f"note: {note}")
                for caution in scene.cautions:
                    _complain(f"warning: {caution}")
        answers.append(answer)
    if json:
        import json as writer

        with _reader_may_leave():
            typer.echo(writer.dumps(answers, indent=1))
    raise typer.Exit(0 if all(answer["ok"] for answer in answers) else BAD_INPUT)


@app.command()
def schema(
    out: Annotated[Path | None, typer.Option("-o", "--out", help="File to write; printed if not given.")] = None,
) -> None:
    """Give the JSON schema of scenes, for editors.

    With it an editor completes keys, explains them and marks mistakes. For editors that use taplo (such as VS Code
    with Even Better TOML) put `#:schema ./dcone-schema.json` at the top of a scene; `dcone new` does so when there is a
    file of that name beside it.
    """
    from dcone_cosim.commands import write_schema

    text = write_schema(out)
    with _reader_may_leave():
        typer.echo(text if out is None else out)


@app.command()
def interface(
    phase: Annotated[
        str, typer.Argument(metavar="PHASE", help="such as capture or removal", autocompletion=phases_like)
    ],
    template: Annotated[
        str | None, typer.Option("--template", metavar="KIND", help="Write an empty FMU too: c or pythonfmu.")
    ] = None,
    out: Annotated[
        Path | None, typer.Option("-o", "--out", help="Folder for the template; my_PHASE if not given.")
    ] = None,
) -> None:
    """Show what a phase asks of its FMU, or write an empty one.

    The table has name, unit, causality and meaning of everything that the master looks for.
    """
    from dcone_cosim.interface_kit import show, write_template

    with _reader_may_leave():
        if template is None:
            show(phase, results())
            return
        for path in write_template(phase, template, out if out is not None else Path(f"my_{phase}")):
            typer.echo(path)


def main() -> NoReturn:
    """Entry point."""
    exits.run(app)


if __name__ == "__main__":
    main()
