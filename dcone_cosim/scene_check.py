"""Checks a scene against the models' tables and gathers every mistake into one message.

The pydantic models are made from the rows of `Variable`: a table of the scene per section, a field per key, each with a
validator that reads the unit and asks the row for its bounds. So a new parameter of a model is at once a new key.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Annotated, Any

from pydantic import BaseModel, BeforeValidator, ConfigDict, ValidationError, create_model
from pydantic_core import PydanticCustomError

from dcone_cosim import build
from dcone_cosim.contract import CAPTURE_NEEDS, HAND_OVER, LINE, NEVER
from dcone_cosim.errors import InputError
from dcone_cosim.handoff import REMOVAL_SETS
from dcone_cosim.mistakes import Mistake, message, shown
from dcone_cosim.names import did_you_mean
from dcone_cosim.scene import PHASES, ComponentScene, PhaseScene, Scene
from dcone_cosim.toml_lines import Path
from dcone_cosim.units import LARGEST_INTEGER, Expected, Unexpected, example_of

SHARED = "orbit"
"""Section that stands at the top of a scene and goes to every phase that has it."""
STRICT = ConfigDict(extra="forbid", arbitrary_types_allowed=True)


def _positive(unit: str, example: str) -> Expected:
    return Expected(unit, example=example, minimum=0.0, open_minimum=True)


def _not_negative(unit: str, example: str) -> Expected:
    return Expected(unit, example=example, minimum=0.0)


PHASE_KEYS: Mapping[str, Mapping[str, Expected]] = {
    "capture": {
        "macro_step": _positive("s", "0.02 s"),
        "duration": _positive("s", "30 s"),
        "hand_over": Expected("1", choices=HAND_OVER),
        "after_capture": _not_negative("s", "1 s"),
    },
    "removal": {
        "macro_step": _positive("s", "60 s"),
        "duration": _positive("s", "1 day"),
    },
}
REQUIRED = ("macro_step", "duration")
MOST_STEPS = 5_000_000
"""Macro steps of a phase: each leaves a row, and a run keeps all rows in memory."""
SNAPSHOTS = _not_negative("s", "5.32 s")
HANDOFF_KEYS: Mapping[str, Expected] = {
    "spin_tolerance": _not_negative("1", "0.1"),
    "compare_without_recoil": Expected("1", kind="Boolean"),
}


@dataclass
class _Phase:
    """One phase while it is being checked.

    named      groups of terms that have a table in the scene, whether or not it names a term there is
    """

    name: str
    interface: build.Interface
    named: set[str] = field(default_factory=set)
    rows: dict[tuple[str, str], build.Variable] = field(default_factory=dict)
    selectors: dict[str, str] = field(default_factory=dict)


def check(document: dict[str, Any], text: str, name: str, source: str) -> Scene:
    """The scene, or an `InputError` that lists all mistakes with their lines."""
    mistakes = [
        Mistake((phase,), document[phase], f"expected a table [{phase}]")
        for phase in PHASES
        if phase in document and not isinstance(document[phase], dict)
    ]
    present = [phase for phase in PHASES if isinstance(document.get(phase), dict)]
    phases = {phase: _choose_terms(phase, document[phase], mistakes) for phase in present}
    model = _scene_model(phases)
    values: Any = None
    try:
        values = model.model_validate(_without_selectors(document, phases))
    except ValidationError as error:
        mistakes += [_from_pydantic(row, phases) for row in error.errors()]
    chosen = _phases_to_run(document, present, mistakes)
    if len(chosen) == len(PHASES):
        mistakes += _set_by_handoff(document)
    mistakes += _about_hand_over(document, phases, chosen)
    if not mistakes and not chosen:
        raise InputError(f"{source} holds no phase; expected [capture], [removal] or both")
    if not mistakes:
        scene = _assemble(values, phases, chosen, text, name, source)
        mistakes = [*_about_steps(scene, document), *_about_values(scene, document), *_about_line(scene, document)]
        if not mistakes:
            return scene
    raise InputError(message(mistakes, text, source))


def _choose_terms(phase: str, tables: dict[str, Any], mistakes: list[Mistake]) -> _Phase:
    """Terms the phase names; a wrong one is noted, and the check goes on with the likeliest."""
    model = build.MODELS[phase]
    terms: dict[str, str] = {}
    for group_name, group in model.groups.items():
        known = ", ".join(group.terms)
        path = (phase, group_name, group.selector)
        table = tables.get(group_name)
        if table is None:
            if not group.optional:
                mistakes.append(Mistake(path[:2], None, f"expected this table, with {group.selector} = one of {known}"))
                terms[group_name] = next(iter(group.terms))
            continue
        names = [term for term in group.terms if term in group.terms]
        if names:
            terms[group_name] = names[0]
        if not isinstance(table, dict):
            mistakes.append(Mistake(path[:2], table, f"expected a table [{phase}.{group_name}]"))
            continue
        given = table.get(group.selector)
        chosen = _term_named(given)
        if chosen in group.terms:
            terms[group_name] = chosen
            continue
        hint = did_you_mean(given, names) if isinstance(given, str) and names else ""
        mistakes.append(Mistake(path, given, f"expected {known}{hint}"))
    interface = model.interface(terms)
    rows = {(v.section, v.key): v for v in build.parameters(interface)}
    named = {name for name in model.groups if name in tables}
    return _Phase(phase, interface, named, rows, {name: group.selector for name, group in model.groups.items()})


def _term_named(given: object) -> str:
    """Name of the term that a selector's value means: a text, or a whole number where terms are counted."""
    if isinstance(given, int) and not isinstance(given, bool) and 0 <= given <= LARGEST_INTEGER:
        return str(given)
    return given if isinstance(given, str) and not given.isdecimal() else ""


def _without_selectors(document: dict[str, Any], phases: Mapping[str, _Phase]) -> dict[str, Any]:
    """The document without the keys that name terms: those are checked already."""
    rest = {key: value for key, value in document.items() if key not in PHASES}
    for name, phase in phases.items():
        tables = dict(document[name])
        for group, selector in phase.selectors.items():
            if group in tables and not isinstance(tables[group], dict):
                del tables[group]
            elif group in tables:
                tables[group] = {k: v for k, v in tables[group].items() if k != selector}
        rest[name] = tables
    return rest


def _refused(reason: str) -> PydanticCustomError:
    return PydanticCustomError("unexpected", "{reason}", {"reason": reason})


def _field(expected: Expected) -> Any:
    """Type of a pydantic field that reads a value as expected."""

    def read(value: object) -> float | list[float]:
        try:
            return expected.read(value)
        except Unexpected as error:
            raise _refused(str(error)) from None

    return Annotated[Any, BeforeValidator(read)]


def expected_of(row: build.Variable) -> Expected:
    """What a scene may write for a row of a model's table."""
    starts = [float(s) for s in row.starts()]
    start = next((s for s in starts if s), 0.0)
    example = f"{start:g}" if row.kind == "Integer" else example_of(start, row.unit, row.display_unit)
    size = row.size if row.shape else 0
    return Expected(
        row.unit, row.kind, size, row.choices, example, row.minimum, row.maximum, row.open_minimum, row.refusal
    )


def _table_model(name: str, rows: Iterable[tuple[str, Expected]], required: Iterable[str] = ()) -> type[BaseModel]:
    fields: dict[str, Any] = {key: (_field(expected), ... if key in required else None) for key, expected in rows}
    return create_model(name, __config__=STRICT, **fields)


def _read_snapshots(value: object) -> list[float]:
    if not isinstance(value, list):
        raise _refused('expected a list of times, such as ["0 s", "5 s"]')
    try:
        return SNAPSHOTS.read_each(value)
    except Unexpected as error:
        raise _refused(str(error)) from None


def _read_title(value: object) -> str:
    if not isinstance(value, str):
        raise _refused('expected a text, such as "A net of 24 m"')
    return value


def _scene_model(phases: Mapping[str, _Phase]) -> type[BaseModel]:
    """The pydantic model of a scene with these terms."""
    shared: dict[str, build.Variable] = {}
    fields: dict[str, Any] = {
        "title": (Annotated[Any, BeforeValidator(_read_title)], ""),
        "phases": (Any, None),
        "handoff": (_table_model("handoff", HANDOFF_KEYS.items()), None),
    }
    for name, phase in phases.items():
        sections: dict[str, dict[str, build.Variable]] = {group: {} for group in (*phase.interface.terms, *phase.named)}
        for (section, key), row in phase.rows.items():
            if section == SHARED:
                shared.setdefault(key, row)
            else:
                sections.setdefault(section, {})[key] = row
        tables: dict[str, Any] = {
            section: (_table_model(section, ((key, expected_of(row)) for key, row in keys.items())), None)
            for section, keys in sections.items()
        }
        for key, expected in PHASE_KEYS[name].items():
            tables[key] = (_field(expected), ... if key in REQUIRED else None)
        if name == "capture":
            tables["snapshots"] = (Annotated[Any, BeforeValidator(_read_snapshots)], None)
        fields[name] = (create_model(name, __config__=STRICT, **tables), ...)
    orbit = _orbit_rows() | shared
    fields[SHARED] = (_table_model(SHARED, ((key, expected_of(row)) for key, row in orbit.items())), None)
    return create_model("scene", __config__=STRICT, **fields)


def _orbit_rows() -> dict[str, build.Variable]:
    """Every key the shared orbit may have, whatever phases a scene has."""
    rows: dict[str, build.Variable] = {}
    for model in build.MODELS.values():
        named = [v for group in model.groups.values() for term in group.terms for v in _term_rows(group, term)]
        rows |= {v.key: v for v in (*named, *model.base) if v.section == SHARED and v.causality == "parameter"}
    return rows


def _term_rows(group: build.Group, term: str) -> tuple[build.Variable, ...]:
    return group.terms[term].variables if term in group.terms else ()


def _from_pydantic(row: Any, phases: Mapping[str, _Phase]) -> Mistake:
    path = tuple(str(part) for part in row["loc"])
    if row["type"] == "extra_forbidden":
        return Mistake(path, row["input"], _about_unknown(path, phases))
    if row["type"] == "missing":
        expected = PHASE_KEYS.get(path[0], {}).get(path[-1])
        return Mistake(path, None, f'expected, such as "{expected.example}"' if expected else "expected")
    if row["type"] == "unexpected":
        return Mistake(path, row["input"], str(row["ctx"]["reason"]))
    if row["type"] in ("model_type", "model_attributes_type", "dict_type"):
        return Mistake(path, row["input"], f"expected a table [{'.'.join(path)}]")
    return Mistake(path, row["input"], str(row["msg"]))


def _about_unknown(path: Path, phases: Mapping[str, _Phase]) -> str:
    """Why a key or table is not known here: misspelt, in the wrong place, or of a term that is not named."""
    phase, key = phases.get(path[0]), path[-1]
    if len(path) == 1:
        return f"unknown key{did_you_mean(key, ('title', 'phases', 'orbit', 'handoff', *PHASES))}"
    if phase is None:
        known = {SHARED: list(_orbit_rows()), "handoff": list(HANDOFF_KEYS)}.get(path[0], [])
        return f"unknown key{did_you_mean(key, known)}"
    if path[1] == SHARED:
        return f"the orbit is shared by the phases: write it as [{SHARED}]"
    home = _term_that_has(phase, path[1:])
    if home is not None:
        return f"belongs to the term {home}, which this scene does not name"
    if len(path) == 2:
        tables = {section for section, _ in phase.rows} | set(phase.selectors) | set(PHASE_KEYS[phase.name])
        return f"unknown key{did_you_mean(key, tables - {SHARED})}"
    return f"unknown key{did_you_mean(key, [k for section, k in phase.rows if section == path[1]])}"


def _term_that_has(phase: _Phase, path: Path) -> str | None:
    """The term, as a scene would name it, that brings a table or key which is not there now."""
    model = build.MODELS[phase.name]
    for group_name, group in model.groups.items():
        for term in group.terms:
            for row in _term_rows(group, term):
                if row.causality == "parameter" and (row.section, row.key)[: len(path)] == path:
                    return f'[{phase.name}.{group_name}] {group.selector} = "{term}"'
    return None


def _phases_to_run(document: dict[str, Any], present: list[str], mistakes: list[Mistake]) -> list[str]:
    given = document.get("phases")
    if given is None:
        return present
    path = ("phases",)
    if not isinstance(given, list) or not given or not all(isinstance(name, str) for name in given):
        mistakes.append(Mistake(path, given, 'expected a list such as ["capture", "removal"]'))
        return present
    for name in dict.fromkeys(given):
        if name not in PHASES:
            mistakes.append(Mistake(path, given, f"unknown phase {name!r}{did_you_mean(name, PHASES)}"))
        elif name not in document:
            mistakes.append(Mistake(path, given, f"the phase has no table; expected [{name}]"))
    known = [name for name in given if name in PHASES]
    in_order = [name for name in PHASES if name in given]
    if len(known) > len(in_order):
        mistakes.append(Mistake(path, given, f"names a phase twice; expected {shown(in_order)}"))
    elif known != in_order:
        mistakes.append(Mistake(path, given, f"the capture comes before the removal; expected {shown(in_order)}"))
    return [name for name in in_order if name in present]


NEEDED_TERM = {"settled": "settling", "tether_taut": "tether"}


def _about_hand_over(document: dict[str, Any], phases: Mapping[str, _Phase], chosen: list[str]) -> list[Mistake]:
    """A condition for handing over that no term of the scene can ever report, or none although a removal follows."""
    if "capture" not in phases:
        return []
    terms, given, path = phases["capture"].interface.terms, document["capture"].get("hand_over"), "hand_over"
    found = []
    group = NEEDED_TERM.get(given) if isinstance(given, str) else None
    if group is not None and group not in terms:
        text = f"needs the table [capture.{group}], which this scene lacks"
        found.append(Mistake(("capture", path), given, text))
    if len(chosen) == len(PHASES):
        if given == NEVER:
            text = f"a removal follows: expected one of {', '.join(HAND_OVER[:-1])}"
            found.append(Mistake(("capture", path), given, text))
        text = "expected this table: a removal follows, and without it no capture is ever reported"
        found += [Mistake(("capture", name), None, text) for name in CAPTURE_NEEDS if name not in terms]
    return found


def _given(document: Any, path: Path) -> Any:
    """What a scene says at that place, or None."""
    for part in path:
        document = document.get(part) if isinstance(document, dict) else None
    return document


def _about_steps(scene: Scene, document: dict[str, Any]) -> Iterator[Mistake]:
    """Macro steps that are too long or too many."""
    for phase in scene.phases:
        path = (phase.name, "macro_step")
        given, duration = _given(document, path), shown(document[phase.name]["duration"])
        steps = phase.duration / phase.macro_step
        if phase.macro_step > phase.duration:
            yield Mistake(path, given, f"must be at most {phase.name}.duration, {duration}")
        elif steps > MOST_STEPS:
            text = f"with {phase.name}.duration = {duration} makes {steps:.4g} steps; at most {MOST_STEPS:,}"
            yield Mistake(path, given, text)


def _about_values(scene: Scene, document: dict[str, Any]) -> Iterator[Mistake]:
    """Values, each within its bounds, with which a phase cannot work."""
    for phase in scene.phases:
        values = {**phase.main.defaults, **phase.main.parameters}
        handed_over = phase is not scene.phases[0]
        must_arrive_in = math.inf if phase.options.get("hand_over") == NEVER else phase.duration
        for refusal in build.cannot_work(phase.name, values, must_arrive_in, phase.main.terms, handed_over):
            section, _, key = refusal.variable.partition(".")
            path = (section, key) if section == SHARED else (phase.name, section, key.partition("[")[0])
            yield Mistake(path, _given(document, path), refusal.expected, refusal.given)


def _about_line(scene: Scene, document: dict[str, Any]) -> Iterator[Mistake]:
    """The one line of two phases: the same length in both, and more than the distance it has to span at the shot."""
    if len(scene.phases) < len(PHASES):
        return
    capture, removal = ({**phase.main.defaults, **phase.main.parameters} for phase in scene.phases)
    paths = {phase: (phase, *name.split(".")) for phase, name in LINE.items()}
    told = {phase: _given(document, path) for phase, path in paths.items()}
    length = removal.get(LINE["removal"])
    if length is None:
        return
    at = "removal" if told["removal"] is not None or told["capture"] is None else "capture"
    other = capture.get(LINE["capture"], length)
    if not math.isclose(length, other, rel_tol=1e-9):
        if told["removal"] is None:
            yield Mistake(paths["removal"], None, "expected the length of the line, here or as capture.tether.length")
            return
        text = f"must equal capture.tether.length = {shown(told['capture'])}: both phases have the same line"
        yield Mistake(paths["removal"], told["removal"], text)
    distance, speed = (
        math.hypot(*(capture[f"chaser.start_{what}[{i}]"] for i in (1, 2, 3))) for what in ("position", "velocity")
    )
    if length <= distance - speed * scene.phases[0].duration:
        text = f"must exceed {distance:.6g} m, the distance from chaser to target at the shot: a locked line would "
        yield Mistake(paths[at], told[at], text + "start stretched", f"{length:g} m")


def _set_by_handoff(document: dict[str, Any]) -> list[Mistake]:
    """Keys of the removal that the hand-off sets, and orbits on which the two phases do not fit together."""
    mistakes = []
    removal = document["removal"] if isinstance(document.get("removal"), dict) else {}
    owned = {tuple(name.partition("[")[0].split(".")) for name in REMOVAL_SETS} | {("start", "condition")}
    for section, keys in removal.items():
        for key in keys if isinstance(keys, dict) else ():
            if (section, key) in owned or section == "start":
                text = "is set by the hand-off from the capture; leave it out, or run the removal alone"
                mistakes.append(Mistake(("removal", section, key), keys[key], text))
    orbit = document.get(SHARED)
    eccentricity = orbit.get("eccentricity", 0.0) if isinstance(orbit, dict) else 0.0
    if eccentricity and isinstance(eccentricity, int | float):
        text = "must be 0 when a capture hands over: its frame turns evenly, as on a circular orbit"
        mistakes.append(Mistake((SHARED, "eccentricity"), eccentricity, text))
    return mistakes


def _assemble(values: Any, phases: Mapping[str, _Phase], chosen: list[str], text: str, name: str, source: str) -> Scene:
    """The scene from values that have passed every check."""
    made = []
    for phase_name in chosen:
        phase, tables = phases[phase_name], getattr(values, phase_name)
        parameters: dict[str, float] = {}
        for (section, key), row in phase.rows.items():
            table = getattr(values if section == SHARED else tables, section, None)
            value = getattr(table, key, None)
            if value is not None:
                numbers = value if isinstance(value, list) else [value]
                parameters |= dict(zip(row.element_names(), numbers, strict=True))
        options = {key: getattr(tables, key) for key in PHASE_KEYS[phase_name] if key not in REQUIRED}
        if phase_name == "capture":
            options["snapshots"] = tables.snapshots or []
            can_capture = all(group in phase.interface.terms for group in CAPTURE_NEEDS)
            told = options["hand_over"]
            options["hand_over"] = HAND_OVER[int(told)] if told is not None else HAND_OVER[0] if can_capture else NEVER
            options["after_capture"] = math.inf if options["after_capture"] is None else options["after_capture"]
        made.append(
            PhaseScene(
                phase_name,
                ComponentScene(
                    phase_name,
                    phase.interface.model.name,
                    dict(phase.interface.terms),
                    parameters=parameters,
                    defaults=build.defaults(phase.interface),
                    choices={v.name: v.choices for v in phase.rows.values() if v.choices},
                ),
                tables.macro_step,
                tables.duration,
                options,
            )
        )
    if len(made) == len(PHASES):
        _share_line(made)
    handoff = {
        key: bool(value) if HANDOFF_KEYS[key].kind == "Boolean" else value
        for key in HANDOFF_KEYS
        if (value := getattr(values.handoff, key, None)) is not None
    }
    return Scene(name, values.title, text, tuple(made), handoff, source)


def _share_line(phases: list[PhaseScene]) -> None:
    """Give the phase that does not tell the line's length what the other tells."""
    given = [phase.main.parameters.get(LINE[phase.name]) for phase in phases]
    for i, (phase, length, other) in enumerate(zip(phases, given, reversed(given), strict=True)):
        name = LINE[phase.name]
        if length is None and other is not None and name in phase.main.defaults:
            main = replace(phase.main, parameters={**phase.main.parameters, name: other})
            phases[i] = replace(phase, main=main)
