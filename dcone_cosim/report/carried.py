"""An FMU of a run as a page carries it: its library as WebAssembly, its resources, the references of its variables.

The library is that of the FMU, from the same IR, for a browser; it is built if the cache has none. Values and tables
are those that the run began the phase with, what a hand-over gave it among them.
"""

from __future__ import annotations

import base64
import zipfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

from dcone_cosim import build
from dcone_cosim.apart import ours, phases_apart
from dcone_cosim.errors import DconeError
from dcone_cosim.loading import load
from dcone_cosim.progress import Progress
from dcone_cosim.results import RunResult
from dcone_cosim.scene.data import PhaseScene
from dcone_cosim.scratch import Scratch


@dataclass(frozen=True)
class Carried:
    """One such FMU.

    phase        as the run began it
    code         the library
    resources    by name
    guid         of the FMU with these values
    references   reference and type of every variable, by name
    bounds       least and largest value of each Real parameter, SI
    """

    phase: PhaseScene
    code: bytes
    resources: Mapping[str, bytes]
    guid: str
    references: Mapping[str, tuple[int, str]]
    bounds: Mapping[str, tuple[float, float]]

    def told(self, wanted: Callable[[str], bool] = lambda name: True) -> dict[str, Any]:
        """For `fmu.js`, with the references of those variables alone that are wanted."""
        return {
            "code": text_of(self.code),
            "resources": {name: text_of(content) for name, content in self.resources.items()},
            "guid": self.guid,
            "references": {name: list(its) for name, its in self.references.items() if wanted(name)},
        }


def text_of(content: bytes) -> str:
    return base64.b64encode(content).decode()


def carry(folder: Path, run: RunResult, name: str, progress: Progress) -> Carried | str:
    """The FMU of a phase of the run of a folder; or, in a sentence, why a page can have none."""
    phase = next(phase for phase in run.scene.phases if phase.name == name)
    if phase.main.fmu is not None:
        return f"the {name} was run by an FMU from elsewhere, of which there is no library for a page"
    if phase.others:
        return f"the {name} is of several FMUs that are coupled, and a page steps one alone"
    try:
        phase = _as_run(folder, run, name)
        with Scratch(build.cache_folder()) as place:
            (file,) = build.write_fmus([ours(run.scene, phase)[phase.main.name]], [build.PAGE], place, progress.say)
            return _read(file, phase)
    except (DconeError, OSError) as error:
        return f"its library for a page could not be built: {error}"


def _as_run(folder: Path, run: RunResult, name: str) -> PhaseScene:
    """The phase as the run began it, with its own values and those that were handed over."""
    scene = load(str(folder / "scene.toml"))
    phases = scene.phases if len(scene.phases) == 1 else phases_apart(scene, folder, [])
    phase = next(phase for phase in phases if phase.name == name)
    values = {**phase.main.parameters, **run.inputs.get(name, {}), **run.parameters[name]}
    return replace(phase, main=replace(phase.main, parameters=values))


def _read(file: Path, phase: PhaseScene) -> Carried:
    with zipfile.ZipFile(file) as archive:
        names = archive.namelist()
        library = next(name for name in names if name.startswith("binaries/"))
        resources = {Path(name).name: archive.read(name) for name in names if name.startswith("resources/")}
        root = ElementTree.fromstring(archive.read("modelDescription.xml"))
        code = archive.read(library)
    variables = root.findall("ModelVariables/ScalarVariable")
    return Carried(
        phase,
        code,
        resources,
        str(root.get("guid")),
        {str(v.get("name")): (int(str(v.get("valueReference"))), v[0].tag) for v in variables},
        {
            str(v.get("name")): (float(v[0].get("min", "-inf")), float(v[0].get("max", "inf")))
            for v in variables
            if v.get("causality") == "parameter" and v[0].tag == "Real"
        },
    )
