"""A scene to start from: every key there is, with its unit, bounds and meaning, as the models' own tables tell them.

What the scene it is begun from says stands as it is. What is left at its default is there as a comment with that
default, and so are the terms that are left out: take the mark away, and it counts.
"""

from __future__ import annotations

import textwrap
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from typing import Any

from dcone_cosim import build
from dcone_cosim.errors import InputError
from dcone_cosim.phases import kind_of, kinds
from dcone_cosim.scene.data import SHARED
from dcone_cosim.scene.expected import ANY, Expected
from dcone_cosim.scene.toml_lines import Path, dotted, given_at
from dcone_cosim.scenes.alike import filled
from dcone_cosim.scenes.components import term_named
from dcone_cosim.scenes.keys import (
    COMPONENT_KEYS,
    COUPLING_KEYS,
    MEANING,
    OWN_MATERIALS,
    RANGES,
    SIZING,
    SIZING_KEYS,
    SOLVER,
    SOLVER_KEYS,
    Key,
    handoff_keys,
    key_of,
    orbit_keys,
    phase_keys,
)
from dcone_cosim.scenes.lines import LINE_MEANING, OWN_KEYS, OWN_MEANING, keys_of
from dcone_cosim.scenes.tables import EXAMPLE, entry_keys
from dcone_cosim.scenes.text import put

WIDTH = 120
PARAMETERS = "parameters"
RESERVED = ("components", "coupling", PARAMETERS)
"""Tables of a phase that are none of its model's."""
INPUT = "an input, held at this value"
SCHEMA = "dcone-schema.json"
"""Name under which a schema beside the scene is found."""


def new_scene(text: str, origin: str, name: str, schema: str = "", comments: Sequence[str] = ()) -> str:
    """Text of a scene begun from another.

    What its table `parameters` says of a variable stands in the variable's own table here.

    text      of that other, which has passed every check
    origin    its name
    name      of the file this will be, for the advice at its top
    schema    path of a JSON schema for editors, "" for none
    comments  what else is to be known of it
    Raises    `InputError` for a key of it that would be lost
    """
    document = {
        key: _in_place(table) if key in kinds() else table for key, table in filled(tomllib.loads(text), []).items()
    }
    lines = [f"#:schema {schema}"] if schema else []
    lines += [
        f"# A scene begun from {origin!r}. Check it with `dcone validate {name}`, run it with `dcone run {name}`.",
        '# A dimensional value is a text with its unit, such as "24 m"; a pure number is bare.',
        "# A line that begins with a # and a key shows what counts when nothing is said; a table that is marked so is",
        "# left out of the FMU altogether.",
        *(["#"] if comments else []),
        *(f"# {line}" for line in comments),
        "",
        _line("title", _toml(document.get("title", "")), MEANING["title"]),
    ]
    present = [phase for phase in kinds() if phase in document]
    lines.append(_line("phases", _toml(document.get("phases", present)), MEANING["phases"]))
    given = document.get(SHARED, {})
    orbit = {k: known for k, known in orbit_keys().items() if k in given or _somewhere(document, f"{SHARED}.{k}")}
    lines += ["", f"[{SHARED}]", *_table(given, orbit)]
    lines += _top(SOLVER, document, SOLVER_KEYS)
    lines += _materials(document.get(OWN_MATERIALS, {}))
    lines += [*_top(SIZING, document, SIZING_KEYS), *_ranges(document.get(SIZING, {}).get(RANGES))]
    for place, phase in enumerate(present):
        lines += ["", *_phase(phase, document[phase], skip=kind_of(phase).taken_over if place else ())]
    given = document.get("handoff", {})
    keys = {**handoff_keys(present[1:]), **{key: known for key, known in handoff_keys().items() if key in given}}
    if keys:
        lines += ["", "[handoff]", *(_option(key, given.get(key), known) for key, known in keys.items())]
    text = "\n".join(line.rstrip() for line in lines) + "\n"
    lost = sorted(dotted(path) for path in {*_leaves(document)} - {*_leaves(tomllib.loads(text))})
    if lost:
        raise InputError(f"{origin}: a scene begun from it would lose {', '.join(lost)}; copy the file instead")
    return text


def _leaves(table: Mapping[str, Any], above: Path = ()) -> Iterator[Path]:
    """Paths of all that a table says. One that is empty says that a part is there, unless it is none of a model's."""
    for key, value in table.items():
        if isinstance(value, dict) and value:
            yield from _leaves(value, (*above, key))
        elif value not in ({}, []) or (above and key not in (*RESERVED, "connections", RANGES)):
            yield (*above, key)


def _in_place(tables: Mapping[str, Any]) -> dict[str, Any]:
    """A component's tables, with what its table `parameters` says put into the tables that have these keys; what it
    says of the shared orbit holds for this component alone, and stays."""
    found = {name: dict(table) if isinstance(table, dict) else table for name, table in tables.items()}
    for name, inner in found.get("components", {}).items():
        found["components"][name] = _in_place(inner)
    told = found.pop(PARAMETERS, {})
    for path in _leaves(told):
        name = ".".join(map(str, path))
        of_orbit = name.startswith(f"{SHARED}.")
        put(found, (PARAMETERS, name) if of_orbit else tuple(name.split(".")), given_at(told, path))
    return found


def _top(name: str, document: Mapping[str, Any], keys: Mapping[str, Expected]) -> Iterator[str]:
    """A table at the top; a comment where the scene does not have it."""
    given, mark = document.get(name, {}), "" if name in document else "# "
    yield from ("", f"{mark}[{name}]")
    for key, known in keys.items():
        if known.size != ANY:
            yield _option(key, given.get(key), known)
        elif key in given:
            yield _line(key, _toml(given[key]), MEANING[key])


def _ranges(given: Mapping[str, Any] | None) -> Iterator[str]:
    if given is not None:
        yield from ("", f"# {MEANING[RANGES]}", f"[{SIZING}.{RANGES}]", *_plain(given))


def _plain(given: Mapping[str, Any]) -> Iterator[str]:
    """Keys that no table describes."""
    yield from (f"{dotted((key,))} = {_toml(value)}" for key, value in given.items())


def _materials(given: Mapping[str, Any]) -> Iterator[str]:
    """The scene's own materials, or one as an example."""
    for name, table in (given or {"mine": {}}).items():
        yield from ("", f"{'' if given else '# '}[{OWN_MATERIALS}.{name}]")
        yield from (_said(key, table.get(key), known, OWN_MEANING[key]) for key, known in OWN_KEYS.items())


def _somewhere(document: Mapping[str, Any], name: str) -> bool:
    """Whether a phase of the document has this variable."""
    return any(
        build.scene_name(row) == name
        for phase in kinds()
        if phase in document
        for row in build.settable(_model(phase).interface(_terms(_model(phase), document[phase])))
    )


def _model(phase: str) -> build.Model:
    return build.CATALOGUE[kind_of(phase).model]


def _terms(model: build.Model, tables: Mapping[str, Any]) -> dict[str, str]:
    """By group: the term that a scene names, that follows from those before it, the default, or the only one there is
    of a table that the scene has."""
    found = {}
    for name, group in model.groups.items():
        table = tables.get(group.table or name)
        if table is not None and group.selector in table:
            found[name] = term_named(table[group.selector])
        elif table is not None and group.early and group.follows is not None:
            # from the net's files, where it has them, which are not read here: then as if it had not
            with suppress(KeyError):
                found[name] = group.default
                found[name] = group.follows({k: v for k, v in found.items() if k != name}, {})
        elif group.default:
            found[name] = group.default
        elif table is not None and isinstance(group.terms, dict) and len(group.terms) == 1:
            found[name] = next(iter(group.terms))
    return found


def _phase(phase: str, tables: Mapping[str, Any], skip: Sequence[str]) -> Iterator[str]:
    connections = tables.get("connections", [])
    yield f"[{phase}]"
    for key, expected in phase_keys(phase).items():
        if expected.size != ANY:
            yield _option(key, tables.get(key), expected)
        elif key in tables:
            yield _line(key, _toml(tables[key]), MEANING[key])
    if connections:
        yield "connections = ["
        yield from (f"    {_toml(connection)}," for connection in connections)
        yield "]"
    yield from _component((phase,), _model(phase), tables, (*skip, *_set_by(connections, phase)))
    if "coupling" in tables:
        yield from ("", f"[{phase}.coupling]")
        coupling = tables["coupling"]
        of_control = () if coupling.get("control") == "error" else ("tolerance", "smallest_step")
        yield from (_option(k, coupling.get(k), known) for k, known in COUPLING_KEYS.items() if k not in of_control)
    for name, inner in tables.get("components", {}).items():
        yield from ("", f"[{phase}.components.{name}]", _line("model", _toml(inner["model"]), MEANING["model"]))
        model = build.CATALOGUE[inner["model"]]
        yield from _component((phase, "components", name), model, inner, _set_by(connections, name))


def _set_by(connections: Sequence[str], component: str) -> tuple[str, ...]:
    """Inputs of a component that connections set."""
    targets = (connection.partition("->")[2].strip() for connection in connections)
    return tuple(target.removeprefix(f"{component}.") for target in targets if target.startswith(f"{component}."))


def _component(
    path: tuple[str, ...], model: build.Model, tables: Mapping[str, Any], skip: Sequence[str]
) -> Iterator[str]:
    """What a component of our models can be told, under the header of its table."""
    above, terms = dotted(path), _terms(model, tables)
    yield from (_option(key, tables[key], known) for key, known in COMPONENT_KEYS.items() if key in tables)
    interface = model.interface(terms)
    rows = [row for row in build.settable(interface) if row.section != SHARED and row.name not in interface.follows]
    rows = [row for row in rows if _given(tables, row) or not build.scene_name(row).startswith(tuple(skip) or ("\0",))]
    own = {build.scene_name(row): _described(row) for row in rows if not row.key}
    yield from _table(tables, own)
    if PARAMETERS in tables:
        yield from ("", f"# {MEANING[PARAMETERS]}", f"[{above}.{PARAMETERS}]", *_plain(tables[PARAMETERS]))
    tables = {name: table for name, table in tables.items() if isinstance(table, dict) and name not in RESERVED}
    homes = {name: model.groups[name].table or name for name in terms}
    made = {
        line.table: keys_of(line, {build.scene_name(row) for row in rows}) for line in build.lines(model.name, terms)
    }
    for section in dict.fromkeys((*tables, *homes.values(), *made, *(row.section for row in rows if row.key))):
        keys = {row.key: _described(row) for row in rows if row.section == section}
        given = tables.get(section)
        yield ""
        yield f"[{above}.{section}]" if given is not None else f"# [{above}.{section}]"
        for name in (name for name, home in homes.items() if home == section):
            group = model.groups[name]
            yield _selection(group, terms[name], "" if group.selector in (given or {}) else "# ")
        selectors = {model.groups[name].selector for name in homes if homes[name] == section}
        kept = [table for table in interface.tables if table.name not in interface.laid]
        yield from _files(section, given or {}, (*kept, *interface.sources))
        for key, expected in made.get(section, {}).items():
            yield _said(key, (given or {}).get(key), expected, LINE_MEANING[key])
        yield from _table({key: value for key, value in (given or {}).items() if key not in selectors}, keys)
        yield from _entries(f"{above}.{section}", given or {}, interface.sources)
    for name, group in model.groups.items():
        if name not in terms and name not in tables:
            yield from ("", *_left_out(above, name, group))


def _given(tables: Mapping[str, Any], row: build.Variable) -> bool:
    return given_at(tables, tuple(build.scene_name(row).split("."))) is not None


def _selection(group: build.Group, term: str, mark: str = "") -> str:
    """The key that names a term, with what it adds and what else it could be."""
    if term not in list(group.terms):
        return _line(group.selector, term, group.terms[term].summary)
    shown = {name: name if name.isdecimal() else f'"{name}"' for name in group.terms}
    others = [text for name, text in shown.items() if name != term]
    text = group.terms[term].summary + (f"; or {', '.join(others)}" if others else "")
    return _line(group.selector, shown[term], text, mark)


def _left_out(above: str, name: str, group: build.Group) -> Iterator[str]:
    """A group of terms as a comment: its first term with all its keys, and the names of the others."""
    first = next(iter(group.terms))
    if first not in group.terms:
        yield f"# {above}.{name} is left out; a table [{above}.{name}] with {group.selector} = {first} brings it in"
        return
    yield f"# [{above}.{name}]"
    yield _selection(group, first, "# ")
    part = group.terms[first]
    yield from _files(name, {}, () if part.lay is not None else part.tables, "# ")
    for row in build.term_rows(group, first):
        if row.causality in build.SETTABLE and row.section == name:
            yield _default(row.key, _described(row))


def _files(section: str, given: Mapping[str, Any], tables: Sequence[build.Table], mark: str = "") -> Iterator[str]:
    """The keys of a section that name files, with what is given or an example."""
    for table in build.from_files(tables):
        home, _, key = table.name.partition(".")
        if home == section and not table.entry:
            yield _line(key, _toml(given.get(key, EXAMPLE)), f"path of a file: {table.description}", mark)


def _entries(path: str, given: Mapping[str, Any], tables: Sequence[build.Table]) -> Iterator[str]:
    """The entries of tables that a section says one by one."""
    for table in tables:
        home, _, name = table.name.partition(".")
        if table.entry and path.endswith(f".{home}"):
            yield from ("", *textwrap.wrap(table.description, WIDTH, initial_indent="# ", subsequent_indent="#   "))
            keys = entry_keys(table)
            for key, known in keys.items():
                yield f"#   {key}: {_meaning(known.description, known.expected)}"
            for entry in given.get(name, ()):
                yield from ("", f"[[{path}.{name}]]")
                yield from (f"{key} = {_toml(value)}" for key, value in entry.items())


def _described(row: build.Variable) -> Key:
    key = key_of(row)
    return Key(
        key.names, key.expected, key.starts, key.description + (f" ({INPUT})" if row.causality == "input" else "")
    )


def _table(given: Mapping[str, Any], keys: Mapping[str, Key]) -> Iterator[str]:
    """What is given as it is, the rest as comments."""
    for name, key in keys.items():
        if name in given:
            yield _line(name, _toml(given[name]), _meaning(key.description, key.expected))
    for name, key in keys.items():
        if name not in given:
            yield _default(name, key)


def _default(name: str, key: Key) -> str:
    return _line(name, key.expected.written(key.starts), _meaning(key.description, key.expected), "# ")


def _option(name: str, given: Any, expected: Expected) -> str:
    return _said(name, given, expected, MEANING[name])


def _said(name: str, given: Any, expected: Expected, meaning: str) -> str:
    """A key with what is given, or an example of it as a comment."""
    text = _meaning(meaning, expected)
    if given is not None:
        return _line(name, _toml(given), text)
    example = f'"{expected.choices[0]}"' if expected.choices else _toml(_parsed(expected.example or "true"))
    return _line(name, example, f"for example; {text}", "# ")


def _parsed(text: str) -> Any:
    """An example as a value: a number, a flag, or a text with a unit."""
    try:
        return tomllib.loads(f"x = {text}")["x"]
    except tomllib.TOMLDecodeError:
        return text


def _meaning(description: str, expected: Expected) -> str:
    others = f"one of {', '.join(expected.choices)}" if expected.choices else ""
    return "; ".join(part for part in (description, expected.bounds(), others) if part)


def _line(key: str, value: str, comment: str, mark: str = "") -> str:
    """A key with its meaning behind it, or above it when the line would be too long; `mark` makes it a comment."""
    line = f"{mark}{key} = {value}"
    whole = f"{line}  # {comment}"
    if len(whole) <= WIDTH:
        return whole
    return "\n".join([*textwrap.wrap(comment, WIDTH, initial_indent="# ", subsequent_indent="#   "), line])


def _toml(value: Any) -> str:
    """A value of a scene as TOML: texts, numbers, flags and lists of them."""
    import tomlkit

    return str(tomlkit.item(value).as_string())
