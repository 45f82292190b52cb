"""`dcone campaign`: run one, look at one, run a case of one again."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from typer.core import TyperGroup

from dcone_cosim.cli_options import Jobs, Json, Offline, answer, at_work, promise, results
from dcone_cosim.exits import complain

if TYPE_CHECKING:
    from rich.console import Console


class _RunByDefault(TyperGroup):
    """`dcone campaign FILE` is `dcone campaign run FILE`."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        if args and args[0] not in self.commands and args[0] not in ("--help", "-h"):
            args = ["run", *args]
        return super().parse_args(ctx, args)


campaign_app = typer.Typer(
    rich_markup_mode=None,
    cls=_RunByDefault,
    no_args_is_help=True,
    help="Run a scene whose values are uncertain until its probabilities are known: dcone campaign CAMPAIGN.toml.",
)
Folder = Annotated[Path, typer.Argument(metavar="DIR", help="Folder of a campaign.")]


@campaign_app.command()
def run(
    campaign: Annotated[Path, typer.Argument(metavar="CAMPAIGN", help="A campaign's file or name.")],
    out: Annotated[
        Path | None,
        typer.Option("-o", "--out", help="Folder for the results; the same command goes on there."),
    ] = None,
    cases: Annotated[
        int | None,
        typer.Option(
            "--cases",
            metavar="N",
            min=1,
            help="How many cases, in place of n or until of the file: a first look, or more of them.",
        ),
    ] = None,
    scheduler: Annotated[
        str | None,
        typer.Option(
            "--scheduler",
            metavar="ADDRESS",
            help="tcp://... of a dask scheduler that is there already; processes for plain ones. If not given, a local "
            "cluster of dask where the extra campaign is installed.",
        ),
    ] = None,
    jobs: Jobs = None,
    check: Annotated[
        bool,
        typer.Option(
            "--check",
            help="Hold the file against its scene: keys, values, names of figures, units of bounds. Runs nothing; "
            "which figures the scene as it is has shows as the campaign begins.",
        ),
    ] = False,
    json: Json = False,
    figures: Annotated[bool, typer.Option("--figures/--no-figures", help="Draw pictures.")] = True,
    replays: Annotated[
        bool,
        typer.Option(
            "--replays",
            help="Run the cases worth looking at again once all are there, each with a page and its replay.",
        ),
    ] = False,
    isolate: Annotated[
        bool | None, typer.Option("--isolate/--no-isolate", help="As for dcone run.", show_default=False)
    ] = None,
    offline: Offline = False,
) -> None:
    """Run a campaign: cases drawn from its dispersions, as many as asked, or until the interval is as narrow as asked.

    The folder has report.html, pictures, table.parquet and table.csv with a row for each case, and the rows themselves.
    Stop it or kill it whenever you like: the same command goes on with the cases that are missing, to the same bits.

    Exit code: 0 done, 2 bad input, 6 interrupted, and the cases that are done are kept, 7 some cases gave no answer,
    and the table has the reason of each.
    """
    promise(offline)
    from dcone_cosim.campaign import commands, show
    from dcone_cosim.campaign.shipped import find

    path = find(campaign)
    if check:
        with at_work():
            content, said = commands.told_of_check(path, cases)
        answer(json, content, lambda console: show.show(content["title"], said, {}, console), [], None)
        return
    with at_work() as progress:
        done = commands.campaign(path, out, progress, scheduler, jobs, isolate, figures, replays=replays, cases=cases)

    def shown(console: Console) -> None:
        show.show(done.title, done.said, done.content["figures"], console)

    answer(json, done.content, shown, done.notes, done.folder)
    raise typer.Exit(done.exit_code)


@campaign_app.command()
def show(folder: Folder, json: Json = False) -> None:
    """Tell what a campaign came to, or how far it is."""
    from dcone_cosim.campaign import commands
    from dcone_cosim.campaign import show as showing

    title, said, figures, content = commands.shown(folder)
    answer(json, content, lambda console: showing.show(title, said, figures, console), [], None)


@campaign_app.command()
def rerun(
    folder: Folder,
    case: Annotated[int, typer.Argument(metavar="CASE", help="Number of a case; 0 for the scene as it is.", min=0)],
    out: Annotated[Path | None, typer.Option("-o", "--out", help="Folder for the run.")] = None,
    figures: Annotated[bool, typer.Option("--figures/--no-figures", help="Draw pictures.")] = True,
) -> None:
    """Run a case of a campaign again, and write the full folder of a run, with its replay.

    Exit code: that of dcone run.
    """
    from dcone_cosim.campaign import commands
    from dcone_cosim.reports import summary

    with at_work() as progress:
        written = commands.rerun(folder, case, out, progress, figures)
    summary.show(written.result, results())
    typer.echo(f"results in {written.folder}")
    for note in written.notes:
        complain(f"note: {note}")
    raise typer.Exit(written.result.exit_code)
