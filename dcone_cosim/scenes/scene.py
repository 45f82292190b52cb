"""A scene: what is to be simulated, read from TOML and checked as a whole before anything is built or written.

    title = "..."               phases = ["capture", "removal"]
    [orbit]                     shared by both phases
    [capture]  [capture.net] shape = "square" ...       a table per part; a table that names a term brings the term in
    [removal]  [removal.reel] law = "locked" ...
    [handoff]

Which tables and keys there are follows from the models' own tables of variables, through `build`; where an FMU file
takes a model's place (`fmu = "path.fmu"`), from its model description.
"""

from __future__ import annotations

import hashlib
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from dcone_cosim.coupling.options import Connection, Coupling
from dcone_cosim.errors import InputError
from dcone_cosim.files import no_file, regular
from dcone_cosim.names import did_you_mean
from dcone_cosim.scenes.mistakes import Places
from dcone_cosim.scenes.toml_lines import DEEPEST, deep_key
from dcone_cosim.scenes.toml_lines import Path as KeyPath

SHIPPED = Path(__file__).parent
PHASES = ("capture", "removal")
UTF_16 = (b"\xff\xfe", b"\xfe\xff")
"""Byte order marks of UTF-16."""


@dataclass(frozen=True)
class TableFile:
    """A table of a part of ours, and the file it is from.

    path       of the key that names the file
    sha256     of the file, as it was read
    """

    path: KeyPath
    file: Path
    sha256: str
    numbers: Any = field(repr=False, compare=False)


@dataclass(frozen=True)
class ComponentScene:
    """One FMU of a phase: a model of ours to be built, or a file.

    name         of the instance; that of the phase for its main component
    model        name of a model of ours, "" when `fmu` is given
    terms        of a model of ours: group and the term of it that the scene names
    fmu          path of an FMU file, None for a model of ours
    isolate      run it in a child process; None: unless it was built here
    timeout      longest time one call to an isolated FMU may take [s]
    parameters   FMI name: value, SI, of what the scene says; inputs may be among them
    defaults     FMI name: start value, SI, of every parameter and input there is
    choices      FMI name: names of the values of an Integer choice
    tolerance    that the FMU's own solver is told; None for that of its default experiment
    texts        FMI name: value of each String that the scene gives
    tables       of a model of ours, by name
    """

    name: str
    model: str = ""
    terms: Mapping[str, str] = field(default_factory=dict)
    fmu: Path | None = None
    isolate: bool | None = None
    timeout: float = 60.0
    parameters: Mapping[str, float] = field(default_factory=dict)
    defaults: Mapping[str, float] = field(default_factory=dict)
    choices: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    tolerance: float | None = None
    texts: Mapping[str, str] = field(default_factory=dict)
    tables: Mapping[str, TableFile] = field(default_factory=dict)


@dataclass(frozen=True)
class PhaseScene:
    """One phase of a scene, all values SI.

    main         the component that the phase is about: it offers what `contract` asks of the phase
    others       further components, connected to it and to one another
    options      what concerns the master: hand_over, after_capture, snapshots
    start        when it begins [s], unless another phase hands over to it
    """

    name: str
    main: ComponentScene
    macro_step: float
    duration: float
    options: Mapping[str, Any] = field(default_factory=dict)
    others: tuple[ComponentScene, ...] = ()
    connections: tuple[Connection, ...] = ()
    coupling: Coupling = field(default_factory=Coupling)
    start: float = 0.0

    @property
    def components(self) -> tuple[ComponentScene, ...]:
        return (self.main, *self.others)

    def setting(self, name: str) -> float | None:
        """What a parameter of the main component is, here or by default; None when it has none of that name."""
        return self.main.parameters.get(name, self.main.defaults.get(name))

    def choice(self, name: str, label: str) -> float:
        """Value of an Integer choice of the main component by its name."""
        return float(self.main.choices[name].index(label))


@dataclass(frozen=True)
class Scene:
    """A scene that has passed every check.

    name       its file's name without the suffix
    text       the scene as run, kept with the results: the file, with what the command line changed
    handoff    options of the hand-off: spin_tolerance, compare_without_recoil
    source     where it was read from, for messages
    places     where each key was written
    notes      what is no mistake, and may be one all the same
    cautions   what it means that its user may not expect, as far as its values tell it
    """

    name: str
    title: str
    text: str
    phases: tuple[PhaseScene, ...]
    handoff: Mapping[str, Any] = field(default_factory=dict)
    source: str = ""
    places: Places = field(default_factory=lambda: Places("", ""))
    notes: tuple[str, ...] = ()
    cautions: tuple[str, ...] = ()

    def isolating(self, isolate: bool | None) -> Scene:
        """The same with every FMU run in a child process, or none; as it is for None."""
        if isolate is None:
            return self
        phases = []
        for phase in self.phases:
            main, *others = (replace(component, isolate=isolate) for component in phase.components)
            phases.append(replace(phase, main=main, others=tuple(others)))
        return replace(self, phases=tuple(phases))

    @property
    def tables(self) -> list[TableFile]:
        """Those of all components."""
        return [table for phase in self.phases for c in phase.components for table in c.tables.values()]

    @property
    def sha256(self) -> str:
        """Of the text, by which a run knows its scene again."""
        return hashlib.sha256(self.text.encode()).hexdigest()


def shipped() -> dict[str, Path]:
    """The scenes that come with the program, by name."""
    return {path.stem: path for path in sorted(SHIPPED.glob("*.toml"))}


def find(name: str) -> Path:
    """Path of a scene given by its name or as a path."""
    known = shipped()
    if name in known:
        return known[name]
    path = Path(name)
    try:
        is_file, is_folder, other = path.is_file(), path.is_dir(), no_file(path)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise InputError(f"{name[:60]} cannot be looked for: {reason}") from error
    if is_file:
        return path
    if is_folder:
        raise InputError(f"{name} is a folder; expected a scene: a .toml file, or one of {', '.join(known)}")
    if other:
        raise InputError(f"{name} is {other}; expected a file")
    if path.suffix == ".toml" or len(path.parts) > 1:
        beside = [str(p) for p in path.parent.glob("*.toml")] if path.parent.is_dir() else []
        raise InputError(f"scene file {name} does not exist{did_you_mean(name, beside or known)}")
    raise InputError(f"no scene named {name!r}{did_you_mean(name, known)}")


def load(name: str, settings: Sequence[str] = ()) -> Scene:
    """The scene of that name or path, or of the run whose folder that is; a `SceneError` lists every mistake found.

    settings     `KEY.KEY=VALUE`, each in the place of what the file says
    """
    from dcone_cosim.scenes.kept import Kept, kept_in

    kept = kept_in(Path(name)) if name not in shipped() else None
    if kept is None:
        path = find(name)
        kept = Kept(path, path.stem, ())
    settings = (*kept.settings, *settings)
    if kept.path.suffix.lower() == ".ssp":
        from dcone_cosim.ssp import system

        return system.load(kept.path, settings, kept.name)
    return parse(read_text(kept.path), kept.name, str(kept.path), kept.path.parent, settings)


def read_text(path: Path) -> str:
    """Text of a scene file, in UTF-8 with or without a byte order mark."""
    try:
        content = regular(path).read_bytes()
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror or error}") from error
    try:
        return content.decode("utf-8-sig").replace("\r\n", "\n")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        what = "it is in UTF-16" if content.startswith(UTF_16) else f"byte {content[error.start]:#x} in line {line}"
        raise InputError(f"{path} cannot be read as text: {what}; save it as UTF-8") from error


def parse(text: str, name: str, source: str, folder: Path = Path(), settings: Sequence[str] = ()) -> Scene:
    """A scene from its text.

    source       names it in messages
    folder       paths of FMUs are relative to it
    """
    if not text.strip():
        raise InputError(f"{source} is empty; expected a scene with at least [capture] or [removal]")
    line = deep_key(text)
    if line is not None:
        raise InputError(f"{source} line {line}: a key of more than {DEEPEST} parts; no scene has one")
    try:
        document = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        last = len(text.splitlines())
        said = str(error).replace("(at end of document)", f"(line {last}, at the end of the file)")
        raise InputError(f"{source} is not valid TOML, or cut short: {said}") from error
    except RecursionError as error:
        raise InputError(f"{source} is no scene: its lists or tables are nested too deeply") from error
    except ValueError as error:
        raise InputError(f"{source} is no scene: a number in it has thousands of digits") from error
    from dcone_cosim.scenes.check import check  # astropy is loaded only for a text that parses
    from dcone_cosim.scenes.text import as_run, name_changes, override

    overrides = override(document, settings)
    name_changes(text, document, overrides)
    places = Places(source, text, tuple(overrides))
    scene = check(document, name, places, folder)
    tables = {table.path: table.file for table in scene.tables}
    return replace(scene, text=as_run(text, document, overrides, folder, tables))


def title_of(path: Path) -> str:
    """The title of a scene file, without checking the rest."""
    return str(tomllib.loads(read_text(path)).get("title", ""))
