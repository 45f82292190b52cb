"""What may stand in a scene beside the models' own parameters, and how a table of it is read.

Every key has an `Expected`: it reads the value with its unit, or says what was expected. The keys of a model follow
from its rows of `Variable`, those of a foreign FMU from its model description: a new parameter is at once a new key.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any

from dcone_cosim import build
from dcone_cosim.phases import kind_of, kinds
from dcone_cosim.scene.data import SHARED
from dcone_cosim.scene.expected import ANY, TEXT, Expected, Unexpected, example_of
from dcone_cosim.scene.mistakes import Mistake, unknown
from dcone_cosim.scene.toml_lines import Path, dotted
from dcone_cosim.units import Unit

SOLVER = "solver"
"""Table at the top that says how exact the run is to be."""
OWN_MATERIALS = "materials"
"""Table at the top with a scene's own materials, a table each."""
SIZING, RANGES = "sizing", "ranges"
"""Table at the top that says what the hardware is sized for, and the one in it with what is uncertain."""
TOP = ("title", "phases", SHARED, SOLVER, OWN_MATERIALS, SIZING, "handoff")
"""Keys at the top of a scene, beside the phases."""
MOST_STEPS = 5_000_000
"""Macro steps of a phase: each leaves a row, and a run keeps all rows in memory."""


def _positive(unit: str, example: str) -> Expected:
    return Expected(unit, example=example, minimum=0.0, open_minimum=True)


def _not_negative(unit: str, example: str) -> Expected:
    return Expected(unit, example=example, minimum=0.0)


def _one_of(*names: str) -> Expected:
    return Expected("1", choices=names)


FLAG = Expected("1", kind="Boolean")


def handoff_keys(taking_over: Iterable[str] | None = None) -> dict[str, Expected]:
    """How these phases take over from those before them; all there are, if none are named."""
    chosen = kinds() if taking_over is None else taking_over
    return {key: expected for phase in chosen for key, expected in kind_of(phase).handoff_keys.items()}


def handoff_gone() -> dict[str, str]:
    """Keys that there were for it, and what there is in their place."""
    return {key: text for phase in kinds() for key, text in kind_of(phase).handoff_gone.items()}


def phase_keys(phase: str) -> dict[str, Expected]:
    """What concerns a phase itself, not its components: its times, and what its kind has beside them."""
    kind = kind_of(phase)
    step, duration = kind.examples
    return {"macro_step": _positive("s", step), "duration": _positive("s", duration), **kind.keys}


REQUIRED = ("macro_step", "duration")
COMPONENT_KEYS: Mapping[str, Expected] = {
    "isolate": FLAG,
    "timeout": _positive("s", "60 s"),
    "solver_tolerance": _positive("1", "1e-6"),
}
"""Keys of every component, main or other; `fmu` and `model` say what it is and are read first."""
SOLVER_KEYS: Mapping[str, Expected] = {
    "accuracy": Expected("1", example="1 %", minimum=0.0, maximum=0.5, open_minimum=True, share=True),
    "quantities": Expected("1", TEXT, size=ANY),
    "runs": Expected("1", "Integer", example="16", minimum=1.0, maximum=10000.0),
}
SIZING_KEYS: Mapping[str, Expected] = {
    "factor_of_safety": Expected("1", example="2.0", minimum=1.0),
    "least_breaking_load": _not_negative("N", "200 N"),
    "mission_time": _positive("s", "3 yr"),
    "cut_probability": Expected("1", example="1 %", minimum=0.0, maximum=0.99, open_minimum=True, share=True),
    "flux": _positive("1/m2.s", "0.003 /(m2 yr)"),
    "flux_size": _positive("m", "1 mm"),
    "flux_exponent": Expected("1", example="2.5", minimum=1.0, open_minimum=True),
    "flux_sizes": Expected("m", size=ANY, example="0.1 mm", minimum=0.0, open_minimum=True),
    "flux_values": Expected("1/m2.s", size=ANY, example="0.003 /(m2 yr)", minimum=0.0, open_minimum=True),
    "offset": _not_negative("m", "0.1 m"),
    "torque": _positive("N.m", "0.2 N m"),
}
COUPLING_KEYS: Mapping[str, Expected] = {
    "method": _one_of("gauss_seidel", "jacobi"),
    "step": _positive("s", "1 s"),
    "control": _one_of("fixed", "error"),
    "tolerance": _positive("1", "1e-4"),
    "smallest_step": _positive("s", "1 ms"),
    "extrapolation": _one_of("constant", "linear"),
}

MEANING: Mapping[str, str] = {
    "title": "what the scene is about, for tables and figures",
    "phases": "which phases to run, in order; all that have a table if not given",
    "accuracy": "how exact the run is to be: scheme, step and tolerances are chosen for it, and its error is estimated",
    "quantities": "what it is the accuracy of; those that each phase means by it if not given",
    "runs": "how many runs may be made where a single one scatters more than that; one if not given",
    SIZING: "what the hardware is sized for, see `dcone size`",
    RANGES: "what is uncertain of the tow: a key of the scene, its least and its largest value",
    "factor_of_safety": "of the line, on its highest tension; 2 if not given",
    "least_breaking_load": "that handling asks of the line, whatever it bears in space; 0 N if not given",
    "mission_time": "for which the line is out; until the thrust has brought the pair down to 200 km if not given",
    "cut_probability": "that debris cuts the line in that time, at most; 1 % if not given",
    "flux": "of particles larger than flux_size, through a surface that turns at random, per its area and time",
    "flux_size": "of the particles that flux counts; 1 mm if not given",
    "flux_exponent": "with which the flux falls with their size; 2.5 if not given",
    "flux_sizes": "sizes of a table of fluxes, the least first, in the place of a power law",
    "flux_values": "fluxes of larger particles than each of flux_sizes",
    "offset": "of the pull from the chaser's centre of mass, where the chaser is a point; 0.1 m if not given",
    "torque": "that the chaser's attitude control has, where the scene has none; 0.2 N m if not given",
    OWN_MATERIALS: "materials of your own by name, a table each: [materials.mine]",
    "macro_step": "the grid of the results: every output is recorded this often",
    "duration": "the phase ends after this at the latest",
    "hand_over": "what ends the capture and begins the next phase; none: flown to its end",
    "safety_every": "look every so often what becomes of the pair if the thrust stops or the line is cut",
    "record_every": "keep a row of the results only so often, with the largest and least of every step in it",
    "safety_horizon": "for how long the pair is followed from there",
    "replay_every": "time from frame to frame of a replay of the net, which `dcone run --replay` sets",
    "after_capture": "go on for this long after the capture, when no phase follows",
    "snapshots": "when to keep the positions of the nodes; evenly spread if not given",
    "point_tolerance": "largest change of the first tug's time and peak, by a bound, with which the target is a point; "
    "one that can only be a point is refused above it",
    "like": "the phase of this scene that it is like, but for what its own table says",
    "velocity_change": "that the chaser makes to come to the debris, beside the spiral from one orbit to the other",
    "reload": "from the end of the shot before to this one: the chaser goes back to its place by two burns",
    "specific_impulse": "of the chaser's engine between two shots",
    "propellant": "that the chaser has at the first shot; without end if not given",
    "compare_without_recoil": "run the removal once more without the shot's recoil",
    "net_compliance": "by how much the captured net gives in series with the line: as the removal's table says, or "
    "measured by the pull of [capture.pull_off], after all else has been handed over",
    "fmu": "an FMI 2.0 co-simulation FMU that takes the place of our model; relative to the scene's file",
    "model": "a model of ours, built on demand",
    "isolate": "run the FMU in a child process: its crash or hang is then an error, and ends nothing else; "
    "if not given, every FMU that was not built here is",
    "timeout": "the longest that one call to an isolated FMU may take",
    "solver_tolerance": "that the FMU's own solver is told; that of the file's default experiment if not given",
    "parameters": "start values by variable name, for names that are no table.key",
    "connections": "outputs that set inputs, each as \"INSTANCE.VARIABLE -> INSTANCE.VARIABLE\"",
    "components": "further FMUs of the phase, a table each",
    "coupling": "how the steps of several components are taken",
    "method": "jacobi: all with the values of the step before; gauss_seidel: each with what those before it reached",
    "step": "of the coupling; the macro step if not given",
    "control": "error: steps are halved where they are too long, as far as the FMUs can save their states",
    "tolerance": "of the error control, relative to the size of each connected output",
    "smallest_step": "below which the error control gives up",
    "extrapolation": "linear: inputs go on at the rate of the step before",
    "order": "in which gauss_seidel steps the components; as in the scene if not given",
}  # fmt: skip
"""One sentence for every key that no model's table explains."""


def isolation(options: Mapping[str, Any]) -> bool | None:
    """Whether a component is run in a child process by its `isolate`, or since calls to it have a `timeout`; None when
    neither is told."""
    told = options.get("isolate")
    return bool(told) if told is not None else ("timeout" in options or None)


@dataclass(frozen=True)
class Key:
    """One key of a component: the variables it sets (several for a list), what it takes, and their start values."""

    names: tuple[str, ...]
    expected: Expected
    starts: tuple[float, ...]
    description: str = ""


@dataclass(frozen=True)
class Slot:
    """What a connection has to know of one scalar variable; `own` is the unit its FMU counts it in."""

    kind: str
    own: Unit
    causality: str


def expected_of(row: build.Variable) -> Expected:
    """What a scene may write for a row of a model's table."""
    starts = [float(s) for s in row.starts()]
    start = next((s for s in starts if s), 0.0)
    example = f"{start:g}" if row.kind == "Integer" else example_of(start, row.unit, row.display_unit)
    size = row.size if row.shape else 0
    return Expected(
        row.unit,
        row.kind,
        size,
        row.choices,
        example,
        row.minimum,
        row.maximum,
        row.open_minimum,
        row.refusal,
        row.display_unit,
        fills=row.fills,
        date=row.date,
    )


def key_of(row: build.Variable) -> Key:
    starts = tuple(float(s) for s in row.starts())
    return Key(tuple(row.element_names()), expected_of(row), starts, row.description)


@cache
def orbit_keys() -> Mapping[str, Key]:
    """Every key the shared orbit may have, whatever phases and terms a scene has."""
    models = dict.fromkeys(kind.model for kind in kinds().values())
    return {
        row.key: key_of(row)
        for model in models
        for row in build.all_rows(build.CATALOGUE[model])
        if row.section == SHARED and row.causality in build.SETTABLE
    }


Reader = Callable[[Any], Any]
"""Reads a value, or raises `Unexpected`."""


def read_value(value: Any, reader: Reader, path: Path, mistakes: list[Mistake]) -> Any:
    """What the reader makes of a value; None, and one mistake more, when it does not fit."""
    try:
        return reader(value)
    except Unexpected as error:
        mistakes.append(Mistake(path, value, str(error)))
        return None


def read_table(
    table: Mapping[str, Any],
    keys: Mapping[str, Expected],
    path: Path,
    mistakes: list[Mistake],
    also: tuple[str, ...] = (),
) -> dict[str, Any]:
    """Values of the known keys of a table; every other key is a mistake, save those that are read elsewhere."""
    found = {}
    for key, value in table.items():
        if key in keys:
            given = read_value(value, keys[key].read, (*path, key), mistakes)
            if given is not None:
                found[key] = given
        elif key not in also:
            mistakes.append(unknown((*path, key), value, "unknown key", key, [*keys, *also]))
    return found


def table_in(document: Mapping[str, Any], path: Path, mistakes: list[Mistake]) -> dict[str, Any]:
    """The table at the end of the path, empty when there is none; something else in its place is a mistake."""
    value = document.get(str(path[-1]), {})
    if isinstance(value, dict):
        return value
    mistakes.append(Mistake(path, value, f"expected a table [{dotted(path)}]"))
    return {}


def read_title(value: object) -> str:
    if not isinstance(value, str):
        raise Unexpected('expected a text, such as "A net of 24 m"')
    return value
