"""`dcone size` from beginning to end: a scene's line, a debris's hardware, the paper's tables.

study.json rows/                  of a scene: the result store, with which the same command goes on
PART.csv                          each part of the report as a table, SI
table.parquet table.csv           all numbers: part, row, quantity, value, unit
summary.json                      the same for machines, with the sentences
*.png report.html                 pictures; all of it as one page
provenance.json scene.toml        what made it
"""

from __future__ import annotations

import shlex
import shutil
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from datetime import UTC, datetime
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from dcone_cosim import interrupts
from dcone_cosim.cases.alone import Alone
from dcone_cosim.cases.case import code, content, digest
from dcone_cosim.cases.commands import TOLD
from dcone_cosim.cases.report import write_report
from dcone_cosim.cases.runner import Memory, Rows, Runner
from dcone_cosim.cases.store import Store
from dcone_cosim.cases.workers import Workers, cores
from dcone_cosim.commands import write_new
from dcone_cosim.errors import InputError
from dcone_cosim.loading import load
from dcone_cosim.progress import Progress
from dcone_cosim.run_folder import default_folder
from dcone_cosim.scene.data import Scene
from dcone_cosim.scenes.reading import parse
from dcone_cosim.sizing import bullets, closed_net, page, paper, plot, report, section, work
from dcone_cosim.sizing.debris import read
from dcone_cosim.sizing.ground import Ground
from dcone_cosim.sizing.headline import headline
from dcone_cosim.sizing.options import Options, factor_of, options_of
from dcone_cosim.sizing.proposal import SAFETY, propose, scene_text
from dcone_cosim.sizing.result import Sizing
from dcone_cosim.sizing.section import Section, long_table
from dcone_cosim.sizing.study import study
from dcone_cosim.sizing.uncertain import uncertain
from dcone_cosim.units import by_name, spoken

KIND = "a sizing"
PAPER = "The mass budgets of Benvenuto and Lavagna, rebuilt"
SHOTS = ("capture.bullets.speed", 0.95, 1.05)
"""Key of the shot that is dispersed, and by how much: momentum of the net that is handed over [1]."""


def of_scene(
    scene: str | Scene,
    options: Options | None = None,
    progress: Progress | None = None,
    settings: Sequence[str] = (),
    jobs: int | None = None,
    isolate: bool | None = None,
) -> Sizing:
    """The sizing of a scene, or of one by its name or path; nothing is written.

    options    None: what the scene asks, else the defaults; see `options_of`
    progress   None: silent
    """
    if isinstance(scene, Scene):
        with TemporaryDirectory() as folder:
            path = Path(folder) / f"{scene.name}.toml"
            path.write_text(scene.text, encoding="utf-8")
            return of_scene(str(path), options, progress, settings, jobs, isolate)
    progress = progress or Progress()
    alone = Alone(scene, settings, isolate)
    chosen = options or options_of(alone.scene)
    alone, others = _begun(scene, settings, isolate, progress, alone, chosen.phase)
    ground = Ground(alone, progress, chosen.phase)
    with Workers(jobs or cores()) as workers:
        memory = Memory()
        ahead = 2 * (jobs or cores())
        return _sized(
            ground, others, chosen, Runner(memory, workers, ahead, work.run),
            Runner(memory, workers, ahead, closed_net.run), progress,
        )  # fmt: skip


def size(
    name: str,
    out: Path | None,
    progress: Progress,
    settings: Sequence[str] = (),
    quick: bool = False,
    factor_of_safety: float | None = None,
    samples: int | None = None,
    ranges: Sequence[str] = (),
    materials: Sequence[str] = (),
    jobs: int | None = None,
    isolate: bool | None = None,
    phase: str | None = None,
) -> Sizing:
    """Size the hardware of a scene and write the folder. Bad input raises and leaves nothing."""
    started = datetime.now(UTC)
    alone = Alone(name, settings, isolate)
    options = options_of(alone.scene, quick, factor_of_safety, samples, ranges, materials, phase)
    uncertain(
        Ground(alone, progress, options.phase), options.ranges
    )  # what is wrong with them is told before anything is run
    alone, others = _begun(name, settings, isolate, progress, alone, options.phase)
    ground = Ground(alone, progress, options.phase)
    scene = alone.scene
    folder = out if out is not None else default_folder(f"{scene.name}-size")
    asked = repr(options)
    told = {"kind": KIND, "scene": scene.name, "varied": [], "fmus": {}, "code": code()}
    told["content"] = digest(content(scene), asked)
    count = jobs or cores()
    with ExitStack() as stack:
        if not folder.exists():
            stack.push(partial(_leave_nothing, folder))
        stack.enter_context(interrupts.heeded(TOLD))
        store = stack.enter_context(Store(folder, told))
        interrupts.arm()
        with Workers(count) as workers:
            done = _sized(
                ground, others, options, Runner(store, workers, 2 * count, work.run),
                Runner(store, workers, 2 * count, closed_net.run), progress,
            )  # fmt: skip
        store.gather_if_many()
        done.folder = folder
        assert done.study is not None
        command = _command(name, settings, quick, factor_of_safety, samples, ranges, materials, phase)
        pictures = partial(plot.draw, done.study)
        write(done, [scene], pictures, folder, started, command)
    return done


def _leave_nothing(folder: Path, kind: type[BaseException] | None, error: BaseException | None, _: object) -> None:
    """Remove a folder that this command has made, where its input turns out to be bad."""
    if isinstance(error, InputError):
        shutil.rmtree(folder, ignore_errors=True)


def _begun(
    name: str, settings: Sequence[str], isolate: bool | None, progress: Progress, alone: Alone, phase: str
) -> tuple[Alone, list[tuple[str, Ground]]]:
    """The scene begun, and as other shots hand it over."""
    alone.begin(progress)
    key, low, high = SHOTS
    others = []
    first = alone.scene.phases[0]
    speed = first.setting("bullets.speed") if first.name == "capture" and len(alone.phases) > 1 else None
    for share in (low, high) if speed is not None else ():
        assert speed is not None
        other = Alone(name, [*settings, f"{key}={share * speed:.9g} m/s"], isolate)
        try:
            other.begin(progress)
        except InputError as error:
            progress.say(f"a shot at {share:g} of its speed is left out: {error}")
            continue
        others.append((f"shot at {share:g} of its speed", Ground(other, progress, phase)))
    return alone, others


def _sized(
    ground: Ground, others: Sequence[tuple[str, Ground]], options: Options, runner: Runner, nets: Runner,
    progress: Progress,
) -> Sizing:  # fmt: skip
    found = study(ground, others, options, runner, nets, progress)
    notes = [*ground.scene.notes, *found.notes]
    return Sizing(f"Sizing: {ground.scene.title}", headline(found), report.sections(found), found, None, notes)


def write(
    done: Sizing,
    scenes: Sequence[Scene],
    pictures: Callable[[Path], None],
    folder: Path,
    started: datetime,
    command: str,
) -> None:
    """The folder of a report."""

    def draw(draft: Path, about: Mapping[str, Any]) -> None:
        import pyarrow.csv

        from dcone_cosim.cases.table import as_arrow
        from dcone_cosim.run_folder import csv_head

        for part in done.sections:
            table = as_arrow(part.columns())
            pyarrow.csv.write_csv(table.rename_columns([csv_head(f) for f in table.schema]), draft / f"{part.key}.csv")
        pictures(draft)
        page.write(done, about, draft)

    write_report(folder, scenes, long_table(done.sections), done.told(), draw, started, done.exit_code, command)


def _command(
    name: str, settings: Sequence[str], quick: bool, factor: float | None, samples: int | None, ranges: Sequence[str],
    materials: Sequence[str], phase: str | None,
) -> str:  # fmt: skip
    """What makes the report again."""
    parts = ["dcone", "size", name, *(part for setting in settings for part in ("--set", setting))]
    parts += [part for text in ranges for part in ("--range", text)]
    parts += [part for name in materials for part in ("--material", name)]
    parts += [] if factor is None else ["--fos", f"{factor:g}"]
    parts += [] if samples is None else ["--samples", str(samples)]
    parts += [] if phase is None else ["--phase", phase]
    return shlex.join([*parts, *(["--quick"] if quick else [])])


def of_paper(
    out: Path | None, progress: Progress, quick: bool = False, jobs: int | None = None, isolate: bool | None = None
) -> Sizing:
    """The paper's tables and Fig. 9; written to a folder where one is named. `quick` leaves out the flights."""
    started = datetime.now(UTC)
    scene = load(bullets.SCENE, bullets.COARSE).isolating(isolate)
    if out is None:
        openings = [] if quick else _flights(Memory(), progress, jobs)
        return Sizing(PAPER, paper.said(openings), paper.sections(openings))
    told = {"kind": KIND, "scene": PAPER, "varied": [], "content": digest(quick), "fmus": {}, "code": code()}
    with interrupts.heeded(TOLD), Store(out, told) as store:
        interrupts.arm()
        openings = [] if quick else _flights(store, progress, jobs)
        done = Sizing(PAPER, paper.said(openings), paper.sections(openings), folder=out)

        def pictures(draft: Path) -> None:
            plot.net_masses(draft / paper.FIG_9)
            if openings:
                plot.openings(openings, draft / paper.OPENINGS)

        write(done, [scene], pictures, out, started, "dcone size --paper" + (" --quick" if quick else ""))
    return done


def _flights(rows: Rows, progress: Progress, jobs: int | None) -> list[bullets.Opening]:
    count = jobs or cores()
    with Workers(count) as workers:
        return bullets.flights(Runner(rows, workers, 2 * count), progress)


def of_debris(text: str, out: Path | None, factor_of_safety: float | None = None) -> Sizing:
    """What is proposed for a debris; the scene that tests it is written to a file where one is named."""
    proposal = propose(read(text), SAFETY if factor_of_safety is None else factor_of(factor_of_safety))
    heads = (section.text("what", "what"), section.Head("value", "value", section.ROW), section.text("unit", "unit"),
             section.text("reason", "from"))  # fmt: skip
    rows = [
        (one.name, by_name(one.shown_in or one.unit).from_si(one.value), spoken(one.shown_in or one.unit), one.why)
        for one in proposal.figures()
    ]
    purpose = (
        "Net, bullets, tether and shot by the paper's scalings; the scene tests them, and `dcone size` sizes its line."
    )
    part = Section("proposal", "Proposal", purpose, heads, rows)
    done = Sizing(f"Proposal for {proposal.debris.text}", [], [part])
    if out is None:
        done.notes.append("-o FILE.toml writes the scene that tests it")
        return done
    if out.suffix != ".toml":
        raise InputError(f"-o {out}: expected the scene to write, a file that ends in .toml")
    content = scene_text(proposal)
    parse(content, out.stem, str(out))
    write_new(out, content)
    done.folder = out
    return done
