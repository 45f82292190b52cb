"""A scene: what is to be simulated, as it is once it has been read and has passed every check. All values are SI."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from dcone_cosim.coupling.options import Connection, Coupling
from dcone_cosim.scene.mistakes import Places
from dcone_cosim.scene.toml_lines import Path as KeyPath
from orbital.materials import Material

SHARED = "orbit"
"""Section of a scene that goes to every component that has it."""


@dataclass(frozen=True)
class HandoffOptions:
    """How a capture hands over.

    point_tolerance          largest change of the first tug's time and peak, by a bound, with which the target is a
                             point; one that can only be a point is refused above it                      [1]
    compare_without_recoil   run the removal once more without the shot's recoil
    net_compliance           by how much the captured net gives: as the scene gives it, or measured by a pull, see
                             `pulled.HOW`
    specific_impulse         of the chaser's engine between two shots                                     [s]
    propellant               of the chaser at the first shot; infinite where that is not asked            [kg]
    """

    point_tolerance: float = 0.01
    compare_without_recoil: bool = True
    net_compliance: str = "given"
    specific_impulse: float = math.inf
    propellant: float = math.inf


@dataclass(frozen=True)
class Accuracy:
    """How exact a run is to be.

    asked        largest error, relative to what each quantity's error is relative to                  [1]
    quantities   what it is the accuracy of, by their names; empty: those that each phase means by it
    runs         how many runs may be made where one scatters too much                                 [1]
    """

    asked: float
    quantities: tuple[str, ...] = ()
    runs: int = 1


@dataclass(frozen=True)
class Chosen:
    """The setting that an accuracy has chosen for a phase.

    label      of the setting, as a person reads it
    changes    `KEY=VALUE`, as `--set` would make it
    error      that was measured with it, the largest of the quantities meant; NaN: not known   [1]
    """

    label: str
    changes: tuple[str, ...]
    error: float


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
class LineScene:
    """What a scene says a line is made of.

    material    that it names, in the form that it names; None for none
    strength    tensile stress at which it breaks, of the scene or the material; None: not known   [Pa]
    diameter    that the model does not have; None: not told                                       [m]
    follows     parameters of the model that follow from these
    apart       parameters that the scene says otherwise than the material does, with what this has, SI
    """

    material: Material | None = None
    strength: float | None = None
    diameter: float | None = None
    follows: tuple[str, ...] = ()
    apart: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class ComponentScene:
    """One FMU of a phase: a model of ours to be built, or a file.

    name         of the instance; that of the phase for its main component
    model        name of a model of ours, "" when `fmu` is given
    terms        of a model of ours: group and the term of it that the scene names
    unnamed      groups of which the scene names no term: the default one is among `terms`
    fmu          path of an FMU file, None for a model of ours
    isolate      run it in a child process; None: unless it was built here
    timeout      longest time one call to an isolated FMU may take [s]
    parameters   FMI name: value, SI, of what the scene says; inputs may be among them
    defaults     FMI name: start value, SI, of every parameter and input there is
    choices      FMI name: names of the values of an Integer choice
    tolerance    that the FMU's own solver is told; None for that of its default experiment
    texts        FMI name: value of each String that the scene gives
    tables       of a model of ours, by name
    asked        of a model of ours: what only the scene knows, and parameters are designed by, as `defaults`
    designed     parameters that are
    lines        by table: what the scene says a line is made of
    sources      tables that only the scene knows, from which `laid` are made
    laid         tables of a model of ours that its parts make of them
    shown        what they make of them for pictures and reports alone
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
    unnamed: tuple[str, ...] = ()
    asked: Mapping[str, float] = field(default_factory=dict)
    designed: tuple[str, ...] = ()
    lines: Mapping[str, LineScene] = field(default_factory=dict)
    sources: Mapping[str, Any] = field(default_factory=dict, repr=False, compare=False)
    laid: Mapping[str, Any] = field(default_factory=dict, repr=False, compare=False)
    shown: Mapping[str, Any] = field(default_factory=dict, repr=False, compare=False)

    @property
    def made(self) -> dict[str, Any]:
        """All tables that its parts take, and what they make of files."""
        return {**self.numbers, **self.shown}

    @property
    def values(self) -> dict[str, Any]:
        """Every parameter and input by FMI name, SI, and the tables that its parts make."""
        return {**self.defaults, **self.parameters, **self.made}

    @property
    def numbers(self) -> dict[str, Any]:
        """Numbers of each table of its FMU, by name."""
        given = {name: table.numbers for name, table in self.tables.items() if name not in self.sources}
        return given | dict(self.laid)

    @property
    def given(self) -> dict[str, Any]:
        """What the scene gives: parameters and inputs by FMI name, SI, and tables."""
        return {**self.parameters, **self.made}


@dataclass(frozen=True)
class PhaseScene:
    """One phase of a scene, all values SI.

    main         the component that the phase is about: it offers what `contract` asks of the phase
    others       further components, connected to it and to one another
    options      what concerns the master, of the class that its kind has for them
    keeps        what has to be there for as long as the phase is, such as a folder of unpacked FMUs
    start        when it begins [s], unless another phase hands over to it
    chosen       what the scene's accuracy has chosen for it, None where it asks for none or nothing was measured
    """

    name: str
    main: ComponentScene
    macro_step: float
    duration: float
    options: Any = None
    others: tuple[ComponentScene, ...] = ()
    connections: tuple[Connection, ...] = ()
    coupling: Coupling = field(default_factory=Coupling)
    start: float = 0.0
    keeps: object = field(default=None, repr=False, compare=False)
    chosen: Chosen | None = field(default=None, compare=False)

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
    source     where it was read from, for messages
    places     where each key was written
    notes      what is no mistake, and may be one all the same
    cautions   what it means that its user may not expect, as far as its values tell it
    sizing     what its hardware is sized for, as far as it says
    """

    name: str
    title: str
    text: str
    phases: tuple[PhaseScene, ...]
    handoff: HandoffOptions = HandoffOptions()
    source: str = ""
    places: Places = field(default_factory=lambda: Places("", ""))
    notes: tuple[str, ...] = ()
    cautions: tuple[str, ...] = ()
    accuracy: Accuracy | None = None
    sizing: Mapping[str, Any] = field(default_factory=dict)

    def with_phase(self, phase: PhaseScene) -> Scene:
        """The same with a phase in the place of the one of its name."""
        return replace(self, phases=tuple(phase if p.name == phase.name else p for p in self.phases))

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
