"""One command from beginning to end: scene, FMUs, run, results."""

from __future__ import annotations

import contextlib
import gc
import os
import sys
import threading
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path

from dcone_cosim import build, interrupts, placed
from dcone_cosim.apart import ours, phases_apart
from dcone_cosim.drafts import atomic_folder, check_folder, check_free
from dcone_cosim.errors import InputError
from dcone_cosim.loading import find, load, named
from dcone_cosim.plots import style
from dcone_cosim.progress import Progress
from dcone_cosim.replaying import replay_settings
from dcone_cosim.reports import summary
from dcone_cosim.results import Attained, RunResult
from dcone_cosim.resume import instants
from dcone_cosim.resume.begin import Origin
from dcone_cosim.run_folder import default_folder, fill
from dcone_cosim.running import run_once
from dcone_cosim.scene.toml_lines import Path as KeyPath
from dcone_cosim.scenes.kept import unlike
from dcone_cosim.scenes.reading import parse, read_text
from dcone_cosim.scenes.text import beside, with_values
from dcone_cosim.scratch import Scratch, clear_left

LEFT_BEHIND = (
    "an earlier run in this place ended without a word, and what it had left was removed; "
    "if an FMU that is not isolated crashed it, --isolate makes the crash an error that keeps the results"
)


@dataclass
class Written:
    """What a run left, where, and what to tell of the writing."""

    result: RunResult
    folder: Path
    notes: list[str] = field(default_factory=list)


def run_and_write(
    name: str,
    out: Path | None,
    progress: Progress,
    with_csv: bool = False,
    with_figures: bool = True,
    force: bool = False,
    settings: Sequence[str] = (),
    isolate: bool | None = None,
    save_at: Sequence[str] = (),
    go_on: str = "",
    replay: bool = False,
) -> Written:
    """Run a scene and write its folder. Bad input, or a place that cannot be written, raises and leaves nothing.

    save_at    instants at which states are kept
    go_on      where the run of the folder that `name` is goes on; "" to run it from its beginning
    replay     keep the net in full, see `replaying`
    """
    started = datetime.now(UTC)
    origin = Origin(Path(name), go_on, settings) if go_on else None
    if replay and origin is not None:
        raise InputError(
            "--replay: what a run goes on from has kept of its net what it has; leave out --replay or --from"
        )
    if replay:
        settings = (*settings, *replay_settings(named(name, settings)))
    scene = (named(name, settings) if origin is None else origin.scene).isolating(isolate)
    keep = instants.save_at(save_at, scene)
    if keep and scene.accuracy is not None:
        raise InputError("--save-at: the scene asks for an accuracy, for which it is run several times; leave one out")
    folder = out if out is not None else default_folder(scene.name)
    left = clear_left(folder.absolute().parent)
    check_free(folder, force and out is not None)
    attained: Mapping[str, Attained] = {}
    if scene.accuracy is not None:
        from dcone_cosim.accuracy.attain import as_asked

        with interrupts.heeded():
            scene, attained = as_asked(name, settings, scene, isolate, progress)

    def meanwhile() -> None:
        gc.freeze()  # what has been imported by now stays
        gc.enable()
        threading.Thread(target=_load, args=(with_figures,), daemon=True).start()

    with interrupts.heeded(), atomic_folder(folder, force and out is not None) as draft:
        begin = None if origin is None else origin.begun
        ran = run_once(scene, progress, begin, keep, attained, meanwhile)
        result, notes = ran.result, [*([LEFT_BEHIND] if left + draft.removed else []), *ran.notes]
        if origin is None and Path(name) == Path(scene.source).parent:
            notes += unlike(Path(name), ran.facts)

        def draw(path: Path) -> None:
            if interrupts.noted():
                notes.append("no figure was drawn: the run was interrupted")
                return
            with progress.working("drawing"):
                progress.say("drawing")
                notes.extend(_draw(result, path))

        fill(draft.path, result, ran.facts, summary.as_dict(result), started, with_csv, draw if with_figures else None)
    if out is not None and draft.folder != folder:
        notes.append(f"{folder} came to be while the scene ran and was not touched; the results are in {draft.folder}")
    return Written(result, draft.folder, notes)


def _load(with_figures: bool) -> None:
    """Import while the FMUs compute what is needed after them. What fails here fails again where it is needed."""
    patience = sys.getswitchinterval()
    sys.setswitchinterval(GIVES_WAY)
    with contextlib.suppress(Exception):
        import pyarrow.parquet  # noqa: F401

        if with_figures:
            style.load()
    sys.setswitchinterval(patience)


GIVES_WAY = 1e-4
"""How long the thread that imports lets the master wait after a step [s]: Python's 5 ms are as long as the step."""


def _draw(result: RunResult, folder: Path) -> list[str]:
    """Draw; returns what could not be drawn. The numbers are there already and are worth more."""
    try:
        from dcone_cosim.reports.figures import draw_all

        return draw_all(result, folder)
    except Exception as error:
        return [f"no figure could be drawn: {type(error).__name__}: {error}"]


def write_fmus(
    name: str,
    out: Path,
    progress: Progress,
    platforms: str = "",
    settings: Sequence[str] = (),
    from_run: Path | None = None,
) -> tuple[list[Path], list[str]]:
    """Write the FMUs of a scene to a folder, for the platforms named or for this machine's; paths, and what to tell.

    Each starts with the scene's values. Files that the scene names itself are there already.

    from_run     folder of a run of the scene: what takes over begins as it did there
    """
    chosen = build.platform_names(platforms) if platforms else ()
    scene = named(name, settings)
    check_folder(out)
    notes: list[str] = []
    wanted = [fmu for phase in phases_apart(scene, from_run, notes) for fmu in ours(scene, phase).values()]
    made = [p for p in (out.absolute(), *out.absolute().parents) if not p.exists()]
    try:
        out.mkdir(parents=True, exist_ok=True)
        with Scratch(out) as draft:
            with progress.working("building"):
                drafts = build.write_fmus(wanted, chosen, draft, progress.say)
            paths = [placed.put(path, out / path.name) for path in drafts]
    except BaseException:
        for folder in made:
            with contextlib.suppress(OSError):
                folder.rmdir()
        raise
    return paths, notes


def write_scene(name: str, origin: str, share: str = "") -> tuple[Path, list[str]]:
    """Write a scene begun from another; returns where, and what to do next. Never replaces a file.

    share    of its lengths and times, as told, for a breadboard that is similar to it; "" for none
    """
    from dcone_cosim.scenes.new import SCHEMA, new_scene

    if not name.strip():
        raise InputError("the name of the new scene is empty; expected a file to write, such as mine.toml")
    path = Path(name)
    if not path.suffix:
        path = path.with_name(f"{path.name}.toml")
    if path.suffix != ".toml":
        raise InputError(f"{path} is not a name for a scene: expected one that ends in .toml")
    source = find(origin)
    scene = load(origin)
    if any(component.fmu is not None for phase in scene.phases for component in phase.components):
        raise InputError(f"{source} names FMU files: only a scene of our models can be begun from; copy the file")
    schema = f"./{SCHEMA}" if (path.parent / SCHEMA).is_file() else ""
    given, comments, files = read_text(source), list[str](), dict[KeyPath, tuple[str, str]]()
    given = with_values(given, beside(given, {table.path: table.file for table in scene.tables}, path.parent))
    if share:
        from dcone_cosim.scenes.scaled import scaled, share_of

        given, comments, files = scaled(given, scene, share_of(share), path.stem)
    text = new_scene(given, origin, str(path), schema, comments)
    _put_scene(path, text, files, f"{origin} scaled by {share}" if share else str(path))
    steps = [f"next: edit {path}, then `dcone validate {path}` and `dcone run {path}`"]
    if not schema:
        steps.append(f"for an editor that completes and checks it: `dcone schema -o {path.parent / SCHEMA}`")
    return path, steps


def _put_scene(path: Path, text: str, files: Mapping[KeyPath, tuple[str, str]], source: str) -> None:
    """Write a scene with the files of its tables beside it, once it has passed every check; none may be there yet.

    files     name and text by the key that names each
    source    of what is checked, for messages: the scene is not written yet
    """
    with Scratch.temporary() as folder:
        for name, content in files.values():
            (folder / name).write_text(content, encoding="utf-8")
        drafts = {key: str(folder / name) for key, (name, _) in files.items()}
        parse(with_values(text, drafts), path.stem, source, path.parent)
    wanted = {path.with_name(name): content for name, content in files.values()} | {path: text}
    taken = next((each for each in wanted if os.path.lexists(each)), None)
    if taken is not None:
        raise InputError(f"{taken} is there already and was not touched; choose another name")
    for place, content in wanted.items():
        write_new(place, content)


def write_new(path: Path, text: str) -> None:
    """Write a file that must not be there yet."""
    try:
        with Scratch(path.absolute().parent) as folder:
            draft = folder / path.name
            draft.write_text(text, encoding="utf-8")
            placed.put_new(draft, path)
    except FileExistsError:
        raise InputError(f"{path} is there already and was not touched; choose another name") from None
    except OSError as error:
        raise InputError(f"{path} cannot be written: {error.strerror or error}") from None


def write_schema(out: Path | None) -> str:
    """The JSON schema of scenes as text, written to a file if one is named; only an earlier schema is replaced."""
    import json

    from dcone_cosim.scenes.schema import schema

    content = schema()
    text = json.dumps(content, indent=1, ensure_ascii=False)
    if out is None:
        return text
    if out.exists():
        try:
            replaces = json.loads(out.read_text(encoding="utf-8")).get("title") == content["title"]
        except (OSError, ValueError, AttributeError):
            replaces = False
        if not replaces:
            raise InputError(f"{out} is there already and is not a schema of scenes; choose another name")
    try:
        with Scratch(out.absolute().parent) as folder:
            draft = folder / "schema"
            draft.write_text(text + "\n", encoding="utf-8")
            placed.put(draft, out)
    except OSError as error:
        raise InputError(f"{out} cannot be written: {error.strerror or error}") from None
    return text
