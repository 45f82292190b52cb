"""The command line. Nothing heavy is imported before a command needs it, so that `dcone --help` answers at once."""

from __future__ import annotations

import gc
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NoReturn

import typer

from dcone_cosim import cli_cases, exits
from dcone_cosim.cli_cache import cache_app
from dcone_cosim.completion import phases_like, scenes_like
from dcone_cosim.errors import BAD_INPUT, DconeError, InputError
from dcone_cosim.exits import complain as _complain
from dcone_cosim.exits import reader_may_leave as _reader_may_leave

if TYPE_CHECKING:
    from rich.console import Console

    from dcone_cosim.progress import Progress

app = typer.Typer(
    help="Net capture and tethered removal of space debris, as a co-simulation of FMI 2.0 units.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,  # plain help takes half the time: rich would load its Markdown reader for it
)
app.add_typer(cache_app, name="cache")

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
    ensemble: Annotated[
        int | None,
        typer.Option(
            "--ensemble", metavar="N", help="Run it N times, each with a start that differs by 1 um: mean and spread."
        ),
    ] = None,
    seed: Annotated[int, typer.Option("--seed", help="Of an ensemble's first run; the others count on.")] = 0,
    jobs: cli_cases.Jobs = None,
    offline: Offline = False,
) -> None:
    """Run a scene and write its results.

    With --ensemble the summary is mean, spread and percentiles of all figures, and a table has every run; the same
    command goes on with the runs that are missing.

    Exit code: 0 success, 1 the results are complete but could not be told, 2 bad input, 3 the capture failed,
    4 the hand-off was refused or violated, 5 an FMU failed, 6 interrupted, and what was reached is kept,
    7 some runs of an ensemble failed; 130 or 143 interrupted, and there was nothing to keep.
    """
    _promise(offline)
    if ensemble is not None:
        if force:
            raise InputError("--force: an ensemble goes on with what is in its folder; choose another with -o")
        done = cli_cases.ensemble(scene, ensemble, seed, out, settings or [], jobs, isolate, _progress())
        raise typer.Exit(cli_cases.tell(done, json, _console(), ensemble=True))
    gc.disable()  # while modules are imported nothing is garbage; `run_and_write` enables it again
    from dcone_cosim.commands import run_and_write

    progress = _progress()
    try:
        with exits.noise_apart():
            written = run_and_write(scene, out, progress, csv, figures, force, settings or (), isolate)
    finally:
        progress.close()
    result = written.result
    from dcone_cosim.reports import summary
    from dcone_cosim.reports.warnings import warnings

    with _reader_may_leave():
        if json:
            from dcone_cosim.run_folder import as_json

            more = {"folder": str(written.folder), "notes": written.notes}
            typer.echo(as_json(summary.as_dict(result) | more))
        else:
            summary.show(result, _console())
            typer.echo(f"results in {written.folder}")
    for note in written.notes:
        _complain(f"note: {note}")
    for warning in warnings(result):
        _complain(f"warning: {warning}")
    if result.message:
        _complain(result.message)
    raise typer.Exit(result.exit_code)


@app.command()
def sweep(
    scene: SceneName,
    vary: cli_cases.Vary = None,
    out: cli_cases.Out = None,
    settings: Settings = None,
    jobs: cli_cases.Jobs = None,
    json: Annotated[bool, typer.Option("--json", help="Print the summary as JSON.")] = False,
    figures: Annotated[bool, typer.Option("--figures/--no-figures", help="Draw the chief figures.")] = True,
    isolate: Annotated[
        bool | None,
        typer.Option(
            "--isolate/--no-isolate", help="As for dcone run; a crash loses one case in any way.", show_default=False
        ),
    ] = None,
    offline: Offline = False,
) -> None:
    """Run a scene with every combination of some values, on all cores, and write one table.

    The folder has table.parquet and table.csv, one row per case with its values, status and figures; timings.parquet;
    summary.json; sweep.png for one or two keys; and the rows themselves. Stop it whenever you like: the same command
    goes on with the cases that are missing. A key that changes nothing is an error.

    Exit code: 0 every case succeeded, 2 bad input, 6 interrupted, and the cases that are done are kept,
    7 some cases failed, and the table has the reason of each.
    """
    _promise(offline)
    done = cli_cases.sweep(scene, vary or [], out, settings or [], jobs, figures, isolate, _progress())
    raise typer.Exit(cli_cases.tell(done, json, _console(), ensemble=False))


@app.command()
def accuracy(
    scene: SceneName,
    out: cli_cases.Out = None,
    settings: Settings = None,
    runs: Annotated[
        int | None, typer.Option("--runs", help="Runs of each setting; a chaotic phase takes 6, any other 3.")
    ] = None,
    quick: Annotated[bool, typer.Option("--quick", help="Fewer settings and runs, for a first look.")] = False,
    peers: Annotated[
        bool, typer.Option("--peers", help="Try other programs too, as far as they are installed and can do it.")
    ] = False,
    jobs: cli_cases.Jobs = None,
    json: Json = False,
    isolate: Annotated[
        bool | None, typer.Option("--isolate/--no-isolate", help="As for dcone run.", show_default=False)
    ] = None,
    offline: Offline = False,
) -> None:
    """Measure what each choice of how to compute a scene costs, and how far off it is.

    Schemes, steps or tolerances, precision, macro steps, coupling steps, pieces of thread: each against a reference
    that a second one judges, with its CPU time. The folder has report.html, a picture for each phase, the table, and
    the rows themselves; the same command goes on with what is missing.

    Exit code: 0 done, 2 bad input, 6 interrupted, and what is done is kept, 7 some settings failed.
    """
    _promise(offline)
    code = cli_cases.accuracy(
        scene, out, settings or [], runs, quick, peers, jobs, isolate, json, _progress(), _console()
    )  # fmt: skip
    raise typer.Exit(code)


@app.command()
def stability(
    scene: Annotated[
        str | None,
        typer.Argument(
            metavar="[SCENE]",
            help="A scene, as for dcone run; without one the shipped table1-capture (with a coarse net) and "
            "table2-deorbit.",
            autocompletion=scenes_like,
        ),
    ] = None,
    out: cli_cases.Out = None,
    settings: Settings = None,
    limit: Annotated[
        float,
        typer.Option("--limit", help="CPU time [s] that a case may take, as it is reckoned; dearer ones are refused."),
    ] = 20.0,
    budget: Annotated[
        float | None,
        typer.Option("--budget", help="Time [s] after which no further case is begun: 1200; with --quick 40."),
    ] = None,
    quick: Annotated[bool, typer.Option("--quick", help="The chief extremes alone, for a first look.")] = False,
    jobs: cli_cases.Jobs = None,
    json: Json = False,
    isolate: Annotated[
        bool | None, typer.Option("--isolate/--no-isolate", help="As for dcone run.", show_default=False)
    ] = None,
    offline: Offline = False,
) -> None:
    """Try every scheme at the ends of the range: what holds, what is refused and why.

    Stiff and soft, light and heavy, fast and slow, macro steps from 1 us: each case is judged by conservation laws
    and closed forms from both sides, and by a finer run. The cost of a case is reckoned before it begins. The folder
    has report.html, a map for each phase, the table, and the rows themselves; the same command goes on with what is
    missing.

    Exit code: 0 no case failed, 2 bad input, 6 interrupted, and what is done is kept, 7 some cases failed.
    """
    _promise(offline)
    code = cli_cases.stability(
        scene, out, settings or [], limit, budget, quick, jobs, isolate, json, _progress(), _console()
    )  # fmt: skip
    raise typer.Exit(code)


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
    _promise(offline)
    from dcone_cosim.commands import write_fmus

    progress = _progress()
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

    progress = _progress()
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
    jobs: cli_cases.Jobs = None,
    offline: Offline = False,
) -> None:
    """Show what is in the FMUs of a scene, what is left out, and what its values come to.

    Terms, nodes, threads, states, variables, bytes; stiffness, masses, periods, momentum and energy of the shot,
    substeps; of an FMU from elsewhere what it tells of itself. With --measure instead what each term changes in the
    results, and what it costs in time, bytes, variables and memory.
    """
    _promise(offline)
    from dcone_cosim.loading import named
    from dcone_cosim.reports import inspection

    if measure:
        cli_cases.physics(scene, settings or [], jobs, json, _progress(), _console())
        return
    progress = _progress()
    try:
        with _reader_may_leave():
            chosen = named(scene, settings or ())
            if json:
                from dcone_cosim.run_folder import as_json

                typer.echo(as_json(inspection.as_dict(chosen, progress)))
            else:
                inspection.show(chosen, _console(), progress)
    finally:
        progress.close()


@app.command()
def new(
    name: Annotated[str, typer.Argument(metavar="NAME", help="File to write; .toml is added when it has no suffix.")],
    origin: Annotated[
        str, typer.Option("--from", metavar="SCENE", help="Scene to begin from.", autocompletion=scenes_like)
    ] = "mission",
) -> None:
    """Write a scene to start from, with every key explained.

    What is left at its default stands there as a comment with that default. Never replaces a file.
    """
    from dcone_cosim.commands import write_scene

    path, next_steps = write_scene(name, origin)
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
            show(phase, _console())
            return
        for path in write_template(phase, template, out if out is not None else Path(f"my_{phase}")):
            typer.echo(path)


def _promise(offline: bool) -> None:
    if offline:
        from dcone_cosim.offline import go_offline

        go_offline()


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


def main() -> NoReturn:
    """Entry point."""
    exits.run(app)


if __name__ == "__main__":
    main()
