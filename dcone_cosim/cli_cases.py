"""The commands that run a scene many times: sweeps, ensembles, accuracy, stability, the effects of its physics."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from dcone_cosim.cli_options import Jobs, Json, Offline, SceneName, Settings, answer, at_work, promise
from dcone_cosim.completion import scenes_like
from dcone_cosim.exits import complain

if TYPE_CHECKING:
    from rich.console import Console

    from dcone_cosim.cases.commands import Done

cases_app = typer.Typer(rich_markup_mode=None)
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


@cases_app.command()
def sweep(
    scene: SceneName,
    vary: Vary = None,
    out: Out = None,
    settings: Settings = None,
    jobs: Jobs = None,
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
    promise(offline)
    from dcone_cosim.cases import commands

    with at_work() as progress:
        done = commands.sweep(scene, vary or [], out, progress, settings or [], jobs, figures, isolate)
    raise typer.Exit(tell(done, json, ensemble=False))


@cases_app.command()
def accuracy(
    scene: SceneName,
    out: Out = None,
    settings: Settings = None,
    runs: Annotated[
        int | None, typer.Option("--runs", help="Runs of each setting; a chaotic phase takes 6, any other 3.")
    ] = None,
    quick: Annotated[bool, typer.Option("--quick", help="Fewer settings and runs, for a first look.")] = False,
    peers: Annotated[
        bool, typer.Option("--peers", help="Try other programs too, as far as they are installed and can do it.")
    ] = False,
    jobs: Jobs = None,
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
    promise(offline)
    from dcone_cosim.accuracy import commands, show

    with at_work() as progress:
        done = commands.accuracy(
            scene, out, progress, settings or [], runs, quick, jobs, isolate, peers=peers
        )  # fmt: skip

    def shown(console: Console) -> None:
        for report in done.reports:
            show.show(report, console)

    answer(json, done.content, shown, done.notes, done.folder)
    raise typer.Exit(done.exit_code)


@cases_app.command()
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
    out: Out = None,
    settings: Settings = None,
    limit: Annotated[
        float | None,
        typer.Option(
            "--limit",
            help="CPU time [s] that a case may take, as it is reckoned: 20, dearer ones are refused; with --quick 2, "
            "dearer ones are left out.",
        ),
    ] = None,
    budget: Annotated[
        float | None,
        typer.Option("--budget", help="Time [s] after which no further case is begun: 1200; with --quick 30."),
    ] = None,
    quick: Annotated[bool, typer.Option("--quick", help="The chief extremes alone, for a first look.")] = False,
    jobs: Jobs = None,
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
    promise(offline)
    from dcone_cosim.stability import commands, show

    with at_work() as progress:
        done = commands.stability(scene, out, progress, settings or [], limit, budget, quick, jobs, isolate)

    def shown(console: Console) -> None:
        for matrix in done.matrices:
            show.show(matrix, console)

    answer(json, done.content, shown, done.notes, done.folder)
    raise typer.Exit(done.exit_code)


@cases_app.command()
def size(
    scene: Annotated[
        str | None,
        typer.Argument(metavar="[SCENE]", help="A scene with a tow, as for dcone run.", autocompletion=scenes_like),
    ] = None,
    debris: Annotated[
        str | None,
        typer.Option(
            "--debris",
            metavar="TEXT",
            help='Instead of a scene: a debris, such as "1000 kg, 3.9 m" or "8000 kg, 25 x 10 x 5 m". Proposes net, '
            "bullets, tether and shot; -o FILE.toml writes the scene that tests them.",
        ),
    ] = None,
    paper: Annotated[
        bool, typer.Option("--paper", help="Instead of a scene: Tables 3 and 4 and Fig. 9 of the paper, rebuilt.")
    ] = False,
    out: Annotated[
        Path | None,
        typer.Option(
            "-o", "--out", help="Folder for the report, in which the same command goes on; of --debris the scene."
        ),
    ] = None,
    settings: Settings = None,
    fos: Annotated[
        float | None, typer.Option("--fos", help="Factor of safety on the highest tension; 2 if not given.")
    ] = None,
    ranges: Annotated[
        list[str] | None,
        typer.Option(
            "--range",
            metavar="KEY=LEAST..LARGEST",
            help='How far a value may be off, such as "removal.thrust.level=-0.02 N..-0.005 N"; several times.',
        ),
    ] = None,
    material: Annotated[
        list[str] | None,
        typer.Option(
            "--material",
            metavar="NAME",
            help='What the line is sized of beside the scene\'s own, such as "Kevlar 29 braid"; several times. All '
            "there are if not given.",
        ),
    ] = None,
    samples: Annotated[
        int | None, typer.Option("--samples", help="Runs with all uncertain values at random: 64; with --quick 12.")
    ] = None,
    quick: Annotated[bool, typer.Option("--quick", help="Fewer runs and materials, for a first look.")] = False,
    phase: Annotated[
        str | None, typer.Option("--phase", help="The tow that is sized, where a scene has two: removal if not given.")
    ] = None,
    jobs: Jobs = None,
    json: Json = False,
    isolate: Annotated[
        bool | None, typer.Option("--isolate/--no-isolate", help="As for dcone run.", show_default=False)
    ] = None,
    offline: Offline = False,
) -> None:
    """Size the hardware: how thick the line must be and what governs that, of a scene with a tow.

    Peak and sustained tension over all that is uncertain, the load spectrum, the required line of every material as the
    fixed point that it is, sensitivities, where the tow may be flown, threads, reel, attitude control, propellant. The
    net
    is shot once for all tows. The folder has report.html, pictures, and a table for each part.

    Exit code: 0 done, 2 bad input, 6 interrupted, and what is done is kept.
    """
    promise(offline)
    from dcone_cosim.errors import InputError
    from dcone_cosim.sizing import commands, show

    if [scene is not None, debris is not None, paper].count(True) != 1:
        raise InputError("dcone size: expected one of a SCENE, --debris or --paper")
    of_a_scene = {"--set": settings, "--range": ranges, "--material": material, "--samples": samples, "--phase": phase}
    idle = [option for option, told in of_a_scene.items() if told is not None and told != []]
    idle += ["--quick"] if debris is not None and quick else []
    idle += ["--fos"] if paper and fos is not None else []
    if scene is None and idle:
        instead = "--debris" if debris is not None else "--paper"
        raise InputError(f"dcone size {instead}: {', '.join(idle)} would change nothing of it")
    with at_work() as progress:
        if debris is not None:
            done = commands.of_debris(debris, out, fos)
        elif paper:
            done = commands.of_paper(out, progress, quick, jobs, isolate)
        else:
            assert scene is not None
            done = commands.size(
                scene, out, progress, settings or [], quick, fos, samples, ranges or [], material or [], jobs, isolate,
                phase,
            )  # fmt: skip
    answer(json, done.told(), lambda console: show.show(done, console), done.notes, done.folder)
    raise typer.Exit(done.exit_code)


def ensemble(
    scene: str,
    count: int,
    seed: int,
    out: Path | None,
    settings: list[str],
    jobs: int | None,
    isolate: bool | None,
    json: bool,
) -> int:
    """`dcone run --ensemble`; returns the exit code."""
    from dcone_cosim.cases import commands

    with at_work() as progress:
        done = commands.ensemble(scene, count, seed, out, progress, settings, jobs, isolate)
    return tell(done, json, ensemble=True)


def tell(done: Done, json: bool, ensemble: bool) -> int:
    """What came of a sweep or an ensemble, and which cases failed; returns the exit code."""
    from dcone_cosim.cases import show

    def shown(console: Console) -> None:
        if ensemble:
            show.show_ensemble(done.summary, done.title, console)
        else:
            show.show_sweep(done.entries, done.columns, done.title, console)

    answer(json, done.content, shown, done.notes, done.folder)
    for failure in show.failures(done.entries):
        complain(failure)
    if done.exit_code:
        share = done.summary.succeeded
        complain(f"{share.of - share.count} of {share.of} cases failed")
    return done.exit_code


def physics(scene: str, settings: list[str], jobs: int | None, json: bool) -> None:
    """`dcone inspect --measure`."""
    from dcone_cosim.accuracy import physics as effects

    with at_work() as progress:
        found = effects.measured(scene, settings, progress, jobs)
    notes = [note for one in found for note in one.notes]
    answer(json, effects.as_dict(found), lambda console: effects.show(found, console), notes, None)
