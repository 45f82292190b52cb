"""Checks a scene against the models' tables and gathers every mistake into one message.

The pydantic models are made from the rows of `Variable`: a table of the scene per section, a field per key, each with a
validator that reads the unit and asks the row for its bounds. So a new parameter of a model is at once a new key.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Annotated, Any

from pydantic import BaseModel, BeforeValidator, ConfigDict, ValidationError, create_model
from pydantic_core import PydanticCustomError

from dcone_cosim import build
from dcone_cosim.contract import HAND_OVER
from dcone_cosim.errors import InputError
from dcone_cosim.handoff import REMOVAL_SETS
from dcone_cosim.mistakes import Mistake, message
from dcone_cosim.names import did_you_mean
from dcone_cosim.scene import PHASES, PhaseScene, Scene
from dcone_cosim.toml_lines import Path
from dcone_cosim.units import Expected, Unexpected, example_of

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
SNAPSHOTS = _not_negative("s", "5.32 s")
HANDOFF_KEYS: Mapping[str, Expected] = {
    "spin_tolerance": _not_negative("1", "0.1"),
    "compare_without_recoil": Expected("1", kind="Boolean"),
}


@dataclass
class _Phase:
    """One phase while it is being checked."""

    name: str
    interface: build.Interface
    rows: dict[tuple[str, str], build.Variable] = field(default_factory=dict)
    selectors: dict[str, str] = field(default_factory=dict)


def check(document: dict[str, Any], text: str, name: str, source: str) -> Scene:
    """The scene, or an `InputError` that lists all mistakes with their lines."""
    mistakes: list[Mistake] = []
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
    mistakes += _hand_over_without_term(document, phases)
    if not mistakes and not chosen:
        raise InputError(f"{source} holds no phase; expected [capture], [removal] or both")
    if not mistakes:
        scene = _assemble(values, phases, chosen, text, name)
        for phase in scene.phases:
            complete = {**phase.defaults, **phase.parameters}
            for refusal in build.out_of_reach(phase.name, complete, phase.duration):
                section, _, key = refusal.variable.partition(".")
                path = (section, key) if section == SHARED else (phase.name, section, key.partition("[")[0])
                mistakes.append(Mistake(path, refusal.given, refusal.expected))
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
        given = table.get(group.selector) if isinstance(table, dict) else None
        named = str(given) if isinstance(given, int) and not isinstance(given, bool) else given
        if isinstance(named, str) and named in group.terms:
            terms[group_name] = named
            continue
        hint = did_you_mean(named, group.terms) if isinstance(named, str) else ""
        mistakes.append(Mistake(path, given, f"expected {known}{hint}" if given is not None else f"expected {known}"))
        fallback = next(iter(group.terms))
        if fallback in group.terms:
            terms[group_name] = fallback
    interface = model.interface(terms)
    rows = {(v.section, v.key): v for v in build.parameters(interface)}
    return _Phase(phase, interface, rows, {name: group.selector for name, group in model.groups.items()})


def _without_selectors(document: dict[str, Any], phases: Mapping[str, _Phase]) -> dict[str, Any]:
    """The document without the keys that name terms: those are checked already."""
    rest = dict(document)
    for name, phase in phases.items():
        tables = dict(document[name])
        for group, selector in phase.selectors.items():
            if isinstance(tables.get(group), dict):
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
        return [float(SNAPSHOTS.read(element)) for element in value]  # type: ignore[arg-type]
    except Unexpected as error:
        raise _refused(str(error)) from None


def _scene_model(phases: Mapping[str, _Phase]) -> type[BaseModel]:
    """The pydantic model of a scene with these terms."""
    shared: dict[str, build.Variable] = {}
    fields: dict[str, Any] = {
        "title": (str, ""),
        "phases": (list[str], None),
        "handoff": (_table_model("handoff", HANDOFF_KEYS.items()), None),
    }
    for name, phase in phases.items():
        sections: dict[str, dict[str, build.Variable]] = {group: {} for group in phase.interface.terms}
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
    if not isinstance(given, list) or not given:
        mistakes.append(Mistake(("phases",), given, 'expected a list such as ["capture", "removal"]'))
        return present
    for name in given:
        if name not in PHASES:
            mistakes.append(Mistake(("phases",), given, f"unknown phase {name!r}{did_you_mean(str(name), PHASES)}"))
        elif name not in present:
            mistakes.append(Mistake(("phases",), given, f"the phase has no table; expected [{name}]"))
    return [name for name in PHASES if name in given]


NEEDED_TERM = {"settled": "settling", "tether_taut": "tether"}


def _hand_over_without_term(document: dict[str, Any], phases: Mapping[str, _Phase]) -> list[Mistake]:
    """A condition for handing over that no term of the scene can ever report."""
    given = document["capture"].get("hand_over") if "capture" in phases else None
    group = NEEDED_TERM.get(given) if isinstance(given, str) else None
    if group is None or group in phases["capture"].interface.terms:
        return []
    return [Mistake(("capture", "hand_over"), given, f"needs the table [capture.{group}], which this scene lacks")]


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
    if eccentricity:
        text = "must be 0 when a capture hands over: its frame turns evenly, as on a circular orbit"
        mistakes.append(Mistake((SHARED, "eccentricity"), eccentricity, text))
    return mistakes


def _assemble(values: Any, phases: Mapping[str, _Phase], chosen: list[str], text: str, name: str) -> Scene:
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
            options["hand_over"] = HAND_OVER[int(options["hand_over"] or 0)]
            options["after_capture"] = math.inf if options["after_capture"] is None else options["after_capture"]
        made.append(
            PhaseScene(
                phase_name,
                phase.interface.model.name,
                dict(phase.interface.terms),
                parameters,
                tables.macro_step,
                tables.duration,
                options,
                build.defaults(phase.interface),
                {v.name: v.choices for v in phase.rows.values() if v.choices},
            )
        )
    handoff = {
        key: bool(value) if HANDOFF_KEYS[key].kind == "Boolean" else value
        for key in HANDOFF_KEYS
        if (value := getattr(values.handoff, key, None)) is not None
    }
    return Scene(name, values.title, text, tuple(made), handoff)
