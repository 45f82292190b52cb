"""The model inside a page: the tow of a run as WebAssembly, with what may be moved, so that it is simulated anew there.

The library is that of the FMU, from the same IR, for a browser; values and tables are those of the run. What a page
needs is made here; `templates/worker` steps it, `templates/scripts/live.js` shows it.
"""

from __future__ import annotations

import base64
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

from dcone_cosim import build, loads
from dcone_cosim.apart import ours, phases_apart
from dcone_cosim.errors import DconeError
from dcone_cosim.loading import load
from dcone_cosim.phases import kind_of
from dcone_cosim.plots.style import time_axis
from dcone_cosim.progress import Progress
from dcone_cosim.report import packing
from dcone_cosim.report.knobs import Knob, knobs_of
from dcone_cosim.results import RunResult
from dcone_cosim.scene.data import PhaseScene
from dcone_cosim.scratch import Scratch
from dcone_cosim.transaction import HandoffRecord

MODEL = "tethered_deorbit"
LONGEST = 86400.0
"""Of a tow, what is simulated in a page [s]."""
FACTOR = 2.0
"""Factor of safety where the scene has none [1]."""
DRAWN = ("tether.tension", "separation")
LARGEST = ("tether.tension_peak", "tether.tension")
"""Outputs of which the first that there is tells the largest tension."""
COUNTED = "tether.tug_count"
WORKER = Path(__file__).parents[1] / "templates" / "worker"
SCRIPTS = ("fmu", "tow", "worker")
"""Of the worker, in order: they are one script there, since an import map does not reach into a worker."""


@dataclass(frozen=True)
class Live:
    """What of a run can be simulated in its page.

    phase     the tow
    told       for `live.js`: the model, the plan of the tow, its line, its tugs, what may be moved
    knobs      what may be moved
    duration   that is simulated, in words;  whole   whether that is all of it
    """

    phase: str
    told: Mapping[str, Any]
    knobs: tuple[Knob, ...]
    duration: str
    whole: bool


def of_folder(folder: Path, run: RunResult, progress: Progress) -> Live | str:
    """The tow of a run as a page can simulate it, its library built first if it is not in the cache; or why it cannot.

    Checked  tests/report/test_live.py: the page's tugs are the FMU's
    """
    name = next((name for name, result in run.phases.items() if len(result.recorder)
                 and next(p for p in run.scene.phases if p.name == name).main.model == MODEL), None)  # fmt: skip
    if name is None:
        return "this run has no tow by our model"
    phase = next(phase for phase in run.scene.phases if phase.name == name)
    if phase.main.fmu is not None:
        return f"the {name} was run by an FMU from elsewhere, of which there is no library for a page"
    if phase.others:
        return f"the {name} is of several FMUs that are coupled; a page steps one alone"
    try:
        phase = _as_run(folder, name)
        with Scratch(build.cache_folder()) as place:
            (file,) = build.write_fmus([ours(run.scene, phase)[phase.main.name]], [build.PAGE], place, progress.say)
            model, bounds = _packed(file)
    except (DconeError, OSError) as error:
        return f"its library for a page could not be built: {error}"
    knobs = tuple(knobs_of(phase, bounds, run))
    plan = _plan(phase, run, model["references"])
    divisor, unit = time_axis(plan["plan"]["duration"])
    told = {"model": model, **plan, "knobs": [knob.told() for knob in knobs]}
    words = f"{plan['plan']['duration'] / divisor:.4g} {unit}"
    return Live(name, told, knobs, words, phase.duration <= LONGEST)


def _as_run(folder: Path, name: str) -> PhaseScene:
    """The phase as the run began it, with the values that were handed over."""
    scene = load(str(folder / "scene.toml"))
    if len(scene.phases) == 1:
        return scene.phases[0]
    return next(phase for phase in phases_apart(scene, folder, []) if phase.name == name)


def _packed(file: Path) -> tuple[dict[str, Any], dict[str, tuple[float, float]]]:
    """What a page has of an FMU: library, resources, GUID, and references of its variables; and bounds of its
    parameters, SI."""
    with zipfile.ZipFile(file) as archive:
        names = archive.namelist()
        library = next(name for name in names if name.startswith("binaries/"))
        resources = {Path(n).name: _text(archive.read(n)) for n in names if n.startswith("resources/")}
        root = ElementTree.fromstring(archive.read("modelDescription.xml"))
        code = archive.read(library)
    variables = root.findall("ModelVariables/ScalarVariable")
    references = {str(v.get("name")): [int(str(v.get("valueReference"))), v[0].tag] for v in variables}
    bounds = {
        str(v.get("name")): (float(v[0].get("min", "-inf")), float(v[0].get("max", "inf")))
        for v in variables
        if v.get("causality") == "parameter" and v[0].tag == "Real"
    }
    told = {"code": _text(code), "resources": resources, "guid": root.get("guid"), "references": references}
    return told, bounds


def _text(content: bytes) -> str:
    return base64.b64encode(content).decode()


def _plan(phase: PhaseScene, run: RunResult, references: Mapping[str, Any]) -> dict[str, Any]:
    """Times, outputs and line of the tow."""
    result = run.phases[phase.name]
    load = next((one for one in loads.of_run(run) if one.phase == phase.name and one.line.name == "line"), None)
    largest = next(name for name in LARGEST if name in references)
    given = run.scene.sizing.get("factor_of_safety")
    duration = min(phase.duration, LONGEST)
    divisor, unit = time_axis(duration)
    rows = [] if result.tugs is None else [result.tugs.rows[number] for number in sorted(result.tugs.rows)]
    return {
        "phase": phase.name,
        "handed": isinstance(run.handovers.get(phase.name), HandoffRecord),
        "clock": f"time {kind_of(phase.name).clock(run).partition(',')[0]}",
        "divisor": divisor,
        "unit": unit,
        "tugs": packing.doubles(np.array(rows, dtype=float).reshape(-1, 3)),
        "plan": {
            "start": phase.start,
            "step": phase.macro_step,
            "duration": duration,
            "whole": phase.duration,
            "outputs": [name for name in DRAWN if name in references],
            "largest": largest,
        },
        "line": {
            "strength": None if load is None else load.strength,
            "factor": FACTOR if given is None else float(given),
        },
        "native": {"wall": result.wall, "duration": result.end - result.start},
    }


def worker() -> str:
    """The worker's script."""
    return "\n".join((WORKER / f"{name}.js").read_text(encoding="utf-8") for name in SCRIPTS)
