"""A JSON schema of scenes, for editors: every key with its meaning, unit, bounds and default, from the models' tables.

An editor that knows it completes keys, shows their meaning and marks what is misspelt while it is typed. It cannot know
what `dcone validate` does: whether a unit fits, and whether values go together. A phase or component with an `fmu`
takes any key, since a schema does not look into files.
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Mapping
from typing import Any

from dcone_cosim import build
from dcone_cosim.phases import kind_of, kinds
from dcone_cosim.scene.data import SHARED
from dcone_cosim.scene.expected import ANY, TEXT, Expected
from dcone_cosim.scenes.alike import LIKE
from dcone_cosim.scenes.keys import (
    COMPONENT_KEYS,
    COUPLING_KEYS,
    MEANING,
    OWN_MATERIALS,
    RANGES,
    REQUIRED,
    SIZING,
    SIZING_KEYS,
    SOLVER,
    SOLVER_KEYS,
    handoff_keys,
    key_of,
    orbit_keys,
    phase_keys,
)
from dcone_cosim.scenes.lines import LINE_MEANING, MATERIAL, NEEDED, OWN_KEYS, OWN_MEANING, keys_of
from dcone_cosim.scenes.tables import entry_keys
from orbital.materials import ALSO, MATERIALS

QUANTITY = r"^\s*[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?\s*[^\d\s].*$"
"""A number and a unit."""
PERCENT = r"^\s*[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?\s*%\s*$"
CONNECTION = r"^\s*[^.\s]+\..+->\s*[^.\s]+\..+$"
Schema = dict[str, Any]


def schema() -> Schema:
    """The schema, draft 7."""
    orbit = {name: _value(key.expected, key.description, key.starts) for name, key in orbit_keys().items()}
    properties = {
        "title": {"type": "string", "description": MEANING["title"]},
        "phases": {
            "type": "array",
            "items": {"enum": list(kinds())},
            "minItems": 1,
            "uniqueItems": True,
            "description": MEANING["phases"],
        },
        SHARED: _table(orbit, "the orbit, shared by the phases"),
        **{phase: _phase(phase) for phase in kinds()},
        OWN_MATERIALS: _materials(),
        SOLVER: _table(_options(SOLVER_KEYS), "how exact the run is to be"),
        SIZING: _table({**_options(SIZING_KEYS), RANGES: _ranges()}, MEANING[SIZING]),
        "handoff": _table(_options(handoff_keys()), "how a capture hands over to a removal"),
    }
    return {
        "$schema": "http://json-schema.org/draft-07/schema#",
        "title": "Scene of the D-CoNe co-simulation",
        "type": "object",
        "properties": properties,
        "additionalProperties": False,
        "anyOf": [{"required": [phase]} for phase in kinds()],
    }


def _table(properties: Mapping[str, Schema], description: str) -> Schema:
    return {
        "type": "object",
        "description": description,
        "properties": dict(properties),
        "additionalProperties": False,
    }


def _materials() -> Schema:
    """A scene's own materials, a table each."""
    own = _table({key: _value(expected, OWN_MEANING[key]) for key, expected in OWN_KEYS.items()}, "a material")
    return {
        "type": "object",
        "description": MEANING[OWN_MATERIALS],
        "additionalProperties": own | {"required": list(NEEDED)},
    }


def _ranges() -> Schema:
    """Ranges of what is uncertain, by key of the scene."""
    ends: Schema = {"type": "array", "minItems": 2, "maxItems": 2}
    return {"type": "object", "description": MEANING[RANGES], "additionalProperties": ends}


def _options(keys: Mapping[str, Expected]) -> dict[str, Schema]:
    return {key: _value(expected, MEANING[key]) for key, expected in keys.items()}


def _value(expected: Expected, description: str, starts: tuple[float, ...] = ()) -> Schema:
    """What one key takes; without start values there is no default."""
    single = _scalar(expected)
    found: Schema = single
    if expected.size:
        found = {"type": "array", "items": single}
        if expected.size != ANY:
            found |= {"minItems": 1 if expected.fills else expected.size, "maxItems": expected.size}
    found["description"] = "; ".join(part for part in (description, expected.bounds()) if part)
    if starts:
        found["default"] = tomllib.loads(f"x = {expected.written(starts)}")["x"]
    return found


def _scalar(expected: Expected) -> Schema:
    if expected.choices:
        return {"enum": list(expected.choices)}
    if expected.kind == "Boolean":
        return {"type": "boolean"}
    if expected.kind == TEXT:
        return {"type": "string"}
    if expected.share:
        return {"anyOf": [{"type": "number"}, {"type": "string", "pattern": PERCENT}], "examples": [expected.example]}
    if expected.unit != "1":
        return {"type": "string", "pattern": QUANTITY, "examples": [expected.example]}
    found: Schema = {"type": "integer" if expected.kind == "Integer" else "number"}
    if math.isfinite(expected.minimum):
        found["exclusiveMinimum" if expected.open_minimum else "minimum"] = expected.minimum
    if math.isfinite(expected.maximum):
        found["maximum"] = expected.maximum
    return found


def _phase(phase: str) -> Schema:
    """A phase: with a model of ours only the keys that this has, with an FMU in its place any."""
    model = build.CATALOGUE[kind_of(phase).model]
    tables, own = _tables(model), _own(phase)
    needed = [name for name, group in model.groups.items() if not group.optional and not group.default]
    strict = {name: {"properties": dict.fromkeys(t["properties"], True), "additionalProperties": False}
              for name, t in tables.items()}  # fmt: skip
    own_only: Schema = {"properties": {**dict.fromkeys(own, True), **strict}, "additionalProperties": False}
    found: Schema = {
        "type": "object",
        "description": model.summary,
        "properties": {**own, **tables},
        "if": {"required": ["fmu"]},
    }
    if LIKE not in own:
        return {**found, "required": list(REQUIRED), "else": {**own_only, "required": needed}}
    for table in tables.values():  # what a table must have may be said by the phase that this one is like
        table.pop("required", None)
    whole = {"if": {"required": [LIKE]}, "else": {"required": [*REQUIRED, *needed]}}
    return {**found, "else": {**own_only, **whole}}


def _tables(model: build.Model) -> dict[str, Schema]:
    """A table per part of the model, with the keys of every term it can have."""
    tables: dict[str, dict[str, Schema]] = {}
    for name, group in model.groups.items():
        tables.setdefault(group.table or name, {})[group.selector] = _selector(group)
    for row in build.all_rows(model):
        if row.causality in build.SETTABLE and row.section != SHARED:
            key = key_of(row)
            value = _value(key.expected, key.description, key.starts)
            known = tables.setdefault(row.section, {}).setdefault(row.key, value)
            if "maxItems" in value and known is not value:  # as long as another term makes it
                known["minItems"] = min(known["minItems"], value["minItems"])
                known["maxItems"] = max(known["maxItems"], value["maxItems"])
            if key.description not in known["description"]:
                known["description"] += f"; or {key.description}"  # it means something else with another term
    for line in build.lines(model.name, {}):
        of_line = tables.setdefault(line.table, {})
        offered = {f"{line.table}.{key}" for key in of_line}
        of_line |= {key: _value(expected, LINE_MEANING[key]) for key, expected in keys_of(line, offered).items()}
        of_line[MATERIAL] |= {"anyOf": [{"enum": [*MATERIALS, *ALSO]}, {"type": "string"}]}
    for table in build.all_tables(model):
        home, _, name = table.name.partition(".")
        tables.setdefault(home, {})[name] = _table_of(table)
    found = {}
    for name, properties in tables.items():
        described: Schema = {"type": "object", "properties": properties}
        if name in model.groups:
            if model.groups[name].follows is None and not model.groups[name].default:
                described["required"] = [model.groups[name].selector]
            described["description"] = "; ".join(f"{term}: {text}" for term, text in _terms(model.groups[name]))
        found[name] = described
    return found


def _table_of(table: build.Table) -> Schema:
    """The path of a file, or the entries themselves."""
    if not table.entry:
        return {"type": "string", "description": f"path of a file: {table.description}"}
    keys = {name: _value(key.expected, key.description) for name, key in entry_keys(table).items()}
    return {"type": "array", "minItems": 1, "items": _table(keys, "an entry"), "description": table.description}


def _terms(group: build.Group) -> list[tuple[str, str]]:
    return [(term, group.terms[term].summary) for term in group.terms if term in group.terms]


def _selector(group: build.Group) -> Schema:
    terms = _terms(group)
    if not terms:
        return {"type": "integer", "minimum": 1, "description": next(iter(group.terms))}
    names = [int(term) if term.isdecimal() else term for term, _ in terms]
    return {"enum": names, "description": "; ".join(f"{term}: {text}" for term, text in terms)}


def _own(phase: str) -> dict[str, Schema]:
    """Keys of a phase that are no parameters of its model."""
    found = _options(phase_keys(phase))
    component = _component()
    found |= {key: value for key, value in component["properties"].items() if key != "model"}
    found["components"] = {
        "type": "object",
        "description": MEANING["components"],
        "additionalProperties": component,
    }
    found["connections"] = {
        "type": "array",
        "items": {"type": "string", "pattern": CONNECTION},
        "description": MEANING["connections"],
    }
    names: Schema = {"type": "array", "items": {"type": "string"}, "description": MEANING["order"]}
    found["coupling"] = _table({**_options(COUPLING_KEYS), "order": names}, MEANING["coupling"])
    return found


def _component() -> Schema:
    """A further component; its tables are those of its own model or FMU."""
    return {
        "type": "object",
        "properties": {
            "fmu": {"type": "string", "minLength": 1, "description": MEANING["fmu"]},
            "model": {"enum": list(build.CATALOGUE), "description": MEANING["model"]},
            **_options(COMPONENT_KEYS),
            "parameters": {"type": "object", "description": MEANING["parameters"]},
        },
        "oneOf": [{"required": ["fmu"]}, {"required": ["model"]}],
    }
