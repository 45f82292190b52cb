"""The models inside a page: the tow of a run and its shot, to be simulated anew there as values are moved.

`templates/worker` steps them, `templates/scripts/live.js` and `shot.js` show them. A tow is shown by its tugs, a shot
by its net in space.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from dcone_cosim import build, loads
from dcone_cosim.contract import FAILED_OUTCOMES, NODE_PREFIX, OUTCOMES, THREAD_PREFIX, bullets
from dcone_cosim.phases import kind_of
from dcone_cosim.phases.capture_clip import drawn_threads
from dcone_cosim.plots.style import time_axis
from dcone_cosim.progress import Progress
from dcone_cosim.report import packing
from dcone_cosim.report.carried import Carried, carry
from dcone_cosim.report.knobs import Knob, knobs_of, knobs_of_shot
from dcone_cosim.report.links import named
from dcone_cosim.results import RunResult
from dcone_cosim.scene.data import PhaseScene
from dcone_cosim.transaction import HandoffRecord
from orbital.tethers import DASHPOT_GOVERNS

TOW, NET = "tethered_deorbit", "net_capture"
LONGEST = 86400.0
"""Of a tow, what is simulated in a page [s]."""
FACTOR = 2.0
"""Factor of safety where the scene has none [1]."""
DRAWN = ("tether.tension", "separation")
LARGEST = ("lumped.peak_tension", "tether.tension_peak", "tether.tension")
"""Outputs of which the first that there is tells the largest tension."""
PER_SECOND = 25.0
"""Frames of a shot."""
SPREADS = {"tugs": "tugs", "first": "first_tug", "peak": "first_tug_peak", "largest": "largest_tug_peak"}
"""Figures of the tow, and what tells how far they are one sample of many."""
FIGURES = ("mouth.area", "t_capture")
"""What is told of a shot, where its FMU tells it, beside what each of its lines bore."""
WORKER = Path(__file__).parents[1] / "templates" / "worker"
SCRIPTS = {"tow": ("fmu", "tow", "tower"), "shot": ("fmu", "net", "shooter")}
"""Of each worker, in order: they are one script there, since an import map does not reach into a worker."""


@dataclass(frozen=True)
class Live:
    """What of a phase can be simulated in its page.

    phase      which
    told       for its script: the model, the plan, what may be moved
    knobs      what may be moved
    duration   that is simulated, in words;  whole   whether that is all of it
    sizing     the command that tells what else sizes the line
    lines      of a shot: each line of the net, by the output that tells its largest tension, and its label
    """

    phase: str
    told: Mapping[str, Any]
    knobs: tuple[Knob, ...]
    duration: str
    whole: bool
    sizing: str = ""
    lines: tuple[tuple[str, str], ...] = ()


def of_tow(folder: Path, run: RunResult, progress: Progress) -> Live | str:
    """The tow of a run as a page can simulate it, its library built first if it is not in the cache; or why it cannot,
    "" where there is none by a model of ours.

    Checked  tests/report/test_live.py: the page's tugs are the FMU's
    """
    name = _of(run, TOW)
    if not name:
        return ""
    carried = carry(folder, run, name, progress)
    if isinstance(carried, str):
        return carried
    knobs = tuple(knobs_of(carried.phase, carried.bounds, run))
    plan, told = _tow(carried, run)
    told["knobs"] = [knob.told() for knob in knobs]
    return Live(name, told, knobs, *_lasting(plan, carried.phase), f"dcone size {named(folder)}/scene.toml")


def of_shot(folder: Path, run: RunResult, progress: Progress) -> Live | str:
    """The shot of a run in the same way.

    Checked  tests/report/test_live.py: the page's net is the FMU's
    """
    name = _of(run, NET)
    if not name:
        return ""
    if not any(output.startswith(NODE_PREFIX) for output in _outputs(run, name)):
        return f"the FMU of its {name} tells no places of its nodes: make it with `dcone run ... --replay`"
    carried = carry(folder, run, name, progress)
    if isinstance(carried, str):
        return carried
    knobs = tuple(knobs_of_shot(carried.phase, carried.bounds))
    plan, told = _shot(carried, run)
    told["knobs"] = [knob.told() for knob in knobs]
    lines = tuple((line["output"], line["label"]) for line in told["lines"])
    return Live(name, told, knobs, *_lasting(plan, carried.phase), lines=lines)


def _of(run: RunResult, model: str) -> str:
    """The first phase by a model that was run; "" for none."""
    phases = {phase.name: phase.main for phase in run.scene.phases}
    return next(
        (name for name, result in run.phases.items() if len(result.recorder) and phases[name].model == model), ""
    )


def _outputs(run: RunResult, name: str) -> tuple[str, ...]:
    """Prefixes of the families of outputs that the FMU of a phase tells."""
    terms = next(phase.main.terms for phase in run.scene.phases if phase.name == name)
    known = {"nodes": NODE_PREFIX, "threads": THREAD_PREFIX}
    return tuple(prefix for family, prefix in known.items() if family in terms)


def _lasting(plan: Mapping[str, Any], phase: PhaseScene) -> tuple[str, bool]:
    divisor, unit = time_axis(plan["duration"])
    return f"{plan['duration'] / divisor:.4g} {unit}", phase.duration <= plan["duration"]


def _tow(carried: Carried, run: RunResult) -> tuple[dict[str, Any], dict[str, Any]]:
    """Times, outputs and line of the tow."""
    phase, references = carried.phase, carried.references
    result = run.phases[phase.name]
    load = next((one for one in loads.of_run(run) if one.phase == phase.name and one.line.name == "line"), None)
    given = run.scene.sizing.get("factor_of_safety")
    spreads = kind_of(phase.name).spreads(run, result)
    whole = phase.duration if result.error is None else result.end - result.start
    duration = min(whole, LONGEST)
    divisor, unit = time_axis(duration)
    rows = [] if result.tugs is None else [result.tugs.rows[number] for number in sorted(result.tugs.rows)]
    plan = {
        "start": phase.start,
        "step": phase.macro_step,
        "duration": duration,
        "whole": whole,
        "outputs": [name for name in DRAWN if name in references],
        "largest": next(name for name in LARGEST if name in references),
    }
    return plan, {
        "phase": phase.name,
        "model": carried.told(),
        "plan": plan,
        "handed": isinstance(run.handovers.get(phase.name), HandoffRecord),
        "clock": f"time {kind_of(phase.name).clock(run).partition(',')[0]}",
        "divisor": divisor,
        "unit": unit,
        "tugs": packing.doubles(np.array(rows, dtype=float).reshape(-1, 3)),
        "line": {
            "strength": None if load is None else load.strength,
            "factor": FACTOR if given is None else float(given),
            "dashpot": DASHPOT_GOVERNS,
            "nodes": plan["largest"] == LARGEST[0],
            "reach": float(result.recorder["tether.length"][0]) if "tether.length" in result.recorder else None,
        },
        "spreads": {name: spreads[key] for name, key in SPREADS.items() if key in spreads},
        "native": {"cpu": result.cpu, "duration": result.end - result.start},
    }


def _shot(carried: Carried, run: RunResult) -> tuple[dict[str, Any], dict[str, Any]]:
    """Times and outputs of the shot, and how its net is drawn."""
    phase, references = carried.phase, carried.references
    result = run.phases[phase.name]
    values = {**run.parameters[phase.name], **phase.main.made}
    spreads = kind_of(phase.name).spreads(run, result)
    last = result.recorder.last()
    nodes = int(last["net.nodes"])
    drawing = build.net_drawing(values, phase.main.terms)
    frames = result.frames
    taut = frames is not None and len(frames.ends) > 0
    ends = frames.ends - 1 if frames is not None and taut else drawn_threads(drawing, nodes)
    bodies = _bodies(references)
    lines = [
        {"output": output, "label": load.line.label, "breaksAt": load.breaks_at}
        for load in loads.of_phase(run, phase.name)
        for output in load.line.tension[:1]
        if output in references
    ]
    shown = [name for name in FIGURES if name in references] + [str(line["output"]) for line in lines]
    plan = {
        "start": phase.start,
        "step": phase.macro_step,
        "duration": phase.duration,
        "every": max(phase.macro_step, 1.0 / PER_SECOND),
        "bodies": [name for part in bodies.values() for name in part],
        "figures": shown,
        "nodes": [references[f"{NODE_PREFIX}{n}].position[{i}]"][0] for n in range(1, nodes + 1) for i in (1, 2, 3)],
        "threads": [references[f"{THREAD_PREFIX}{n}].tension"][0] for n in range(1, len(ends) + 1)] if taut else [],
        "stop": _ends_with(carried, run),
        "after": _goes_on(carried),
        "outcomes": list(OUTCOMES),
        "failed": [number for number, outcome in enumerate(OUTCOMES) if outcome in FAILED_OUTCOMES],
    }
    wanted = {"captured", "settled", "outcome", *shown, *(name for part in bodies.values() for name in part)}
    return plan, {
        "phase": phase.name,
        "model": carried.told(lambda name: name in wanted or name in carried.bounds),
        "plan": plan,
        "bodies": {name: len(part) for name, part in bodies.items()},
        "rim": [] if drawing is None else list(map(int, drawing[1])),
        "most": float(max(map(np.max, frames.tensions))) if frames is not None and taut else 0.0,
        "floor": packing.FLOOR,
        "ends": packing.wholes(ends),
        "lines": lines,
        "spreads": {name: spreads[name] for name in shown if name in spreads}
        | ({"mouth.area": spreads["mouth.area_max"]} if "mouth.area_max" in spreads else {}),
        "run": {name: float(np.max(result.recorder[name])) for name in shown if name in result.recorder},
        "native": {"cpu": result.cpu, "duration": result.end - result.start},
    }


def _ends_with(carried: Carried, run: RunResult) -> str:
    """The Boolean output with which the phase ends, "" for one that goes on to its end."""
    trigger = carried.phase.options.hand_over
    followed = run.scene.phases[-1].name != carried.phase.name
    return trigger if followed and trigger in carried.references else ""


def _goes_on(carried: Carried) -> float | None:
    """How long the phase goes on once the target is captured [s], None for as long as there is time."""
    options = carried.phase.options
    known = options.hand_over == "captured" and "captured" in carried.references
    return options.after_capture if known and math.isfinite(options.after_capture) else None


def _bodies(references: Mapping[str, Any]) -> dict[str, list[str]]:
    """Outputs of the bodies that are drawn, as far as they are told, by the names that `bodies.js` has for them."""
    numbers = bullets(list(references))
    parts = {
        "chaser": [f"chaser.position[{i}]" for i in (1, 2, 3)],
        "target": [f"target.position[{i}]" for i in (1, 2, 3)],
        "attitude": [f"target.attitude[{i}]" for i in (1, 2, 3, 4)],
        "angle": ["hinge.angle"],
        "line": [f"vertex.position[{i}]" for i in (1, 2, 3)],
        "bullets": [f"bullet[{b}].position[{i}]" for b in numbers for i in (1, 2, 3)],
    }
    return {name: part for name, part in parts.items() if part and all(one in references for one in part)}


def worker(which: str) -> str:
    """The script of a worker."""
    return "\n".join((WORKER / f"{name}.js").read_text(encoding="utf-8") for name in SCRIPTS[which])
