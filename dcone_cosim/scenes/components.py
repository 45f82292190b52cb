"""Reading a component of a scene: what it is, which keys it has, and what the scene says of them.

A component is a model of ours, whose terms the scene names and whose keys follow from its rows, or an FMU file, whose
keys follow from its model description. Both are read alike: `key` in `[capture.table]` is the variable `table.key`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import suppress
from functools import lru_cache, partial
from pathlib import Path as File
from typing import TYPE_CHECKING, Any

from dcone_cosim import build
from dcone_cosim.scene.data import SHARED, LineScene
from dcone_cosim.scene.expected import LARGEST_INTEGER, TEXT, Unexpected
from dcone_cosim.scene.mistakes import Mistake, unknown
from dcone_cosim.scene.toml_lines import Path, dotted, given_at
from dcone_cosim.scenes.fmus import Offer
from dcone_cosim.scenes.keys import COMPONENT_KEYS, SOLVER, SOLVER_KEYS, Key, Slot, key_of, phase_keys, read_value
from dcone_cosim.scenes.lines import keys_of, read_line
from dcone_cosim.scenes.read_component import ReadComponent
from dcone_cosim.scenes.tables import EXAMPLE, entries_of, table_of
from dcone_cosim.units import by_name
from orbital.materials import Material

if TYPE_CHECKING:
    pass


def of_model(
    part: ReadComponent, model: build.Model, tables: Mapping[str, Any], folder: File, mistakes: list[Mistake]
) -> ReadComponent:
    """The part as this model of ours; a wrong term is noted, and the check goes on with the likeliest."""
    part.model = model
    for group_name, group in model.groups.items():
        path = (*part.path, group.table or group_name)
        table = tables.get(group.table or group_name)
        if group.default and (table is None or (isinstance(table, dict) and group.selector not in table)):
            part.terms[group_name] = _early(part, group_name, model, tables, folder) if group.early else group.default
            part.unnamed.add(group_name)
            continue
        if table is None:
            if not group.optional:
                text = f"expected this table, with {group.selector} = one of {', '.join(group.terms)}"
                mistakes.append(Mistake(path, None, text))
                part.terms[group_name] = next(iter(group.terms))
            continue
        names = [term for term in group.terms if term in group.terms]
        if names:
            part.terms[group_name] = names[0]
        if group.follows is not None and isinstance(table, dict) and group.selector not in table:
            if group.early:
                part.terms[group_name] = _early(part, group_name, model, tables, folder)
                continue
            part.following.append(group_name)
            continue
        if not isinstance(table, dict):
            mistakes.append(Mistake(path, table, f"expected a table [{dotted(path)}]"))
            continue
        given = table.get(group.selector)
        chosen = term_named(given)
        if chosen in group.terms:
            part.terms[group_name] = chosen
            continue
        expected = f"expected {', '.join(group.terms)}"
        path = (*path, group.selector)
        if isinstance(given, str) and names:
            mistakes.append(unknown(path, given, expected, given, names))
        else:
            mistakes.append(Mistake(path, given, expected))
    while lacking := list(model.missing(part.terms)):
        for group_name, needed in lacking:
            if group_name in tables:
                text = f"needs the table [{dotted((*part.path, needed))}], which this scene lacks"
                mistakes.append(Mistake((*part.path, group_name), tables[group_name], text))
            part.terms[needed] = next(iter(model.groups[needed].terms))
    _part_company(part, model, tables, mistakes)
    interface = model.interface(part.terms)
    part.keys = dict(_keys(model.name, tuple(part.terms.items())))
    given = (table for table in build.from_files(interface.tables) if table.name not in interface.laid)
    instead = (model.groups[name].terms[part.terms[name]] for name in part.refused if name in part.terms)
    unasked = {table.name for term in instead for table in (*term.tables, *term.sources)}
    part.files = {table.name: table for table in (*given, *interface.sources) if table.name not in unasked}
    part.lines = {line.table: line for line in build.lines(model.name, part.terms)}
    _offer_slots(part, model)
    return part


def _part_company(part: ReadComponent, model: build.Model, tables: Mapping[str, Any], mistakes: list[Mistake]) -> None:
    """Note the terms that do not go with others, and go on without them; of their keys nothing is said then."""
    for group_name, other, carried in model.unfit(part.terms):
        group = model.groups[group_name]
        table, fit = dotted((*part.path, other)), " or ".join(carried)
        text = f"does not go with the table [{table}]: take {fit}, or leave that out"
        path = (*part.path, group.table or group_name, group.selector)
        mistakes.append(Mistake(path, part.terms[group_name], text))
        part.terms[group_name] = carried[0]
        part.refused.add(group_name)
    clashes: dict[str, list[str]] = {}
    # however many follow
    terms = part.terms | {name: "1" for name in part.following if name in build.FAMILIES}
    for group_name, other in model.clashing(terms):
        clashes.setdefault(group_name, []).append(f"[{dotted((*part.path, other))}]")
    for group_name, others in clashes.items():
        part.refused.add(group_name)
        group = model.groups[group_name]
        text = f"cannot go together with {' and '.join(others)}{group.terms[terms[group_name]].because}"
        if group_name in build.FAMILIES or group_name in part.following:
            mistakes.append(Mistake((*part.path, group_name), tables[group_name], text))
            part.terms.pop(group_name, None)
            part.following = [name for name in part.following if name != group_name]
            continue
        path = (*part.path, group.table or group_name, group.selector)
        mistakes.append(Mistake(path, part.terms[group_name], text))
        part.terms[group_name] = group.default or next(iter(group.terms))
        if group.optional and group_name in (name for name, _ in model.clashing(part.terms)):
            part.terms.pop(group_name)
            part.following = [name for name in part.following if name != group_name]


def _early(part: ReadComponent, group_name: str, model: build.Model, tables: Mapping[str, Any], folder: File) -> str:
    """The term of a group that follows from those before it and from their files; what is wrong with these is told
    where all are read."""
    found = {}
    for name, term in part.terms.items():
        for table in build.from_files(model.groups[name].terms[term].tables):
            given = given_at(tables, tuple(table.name.split(".")))
            if given is not None:
                with suppress(Unexpected):
                    found[table.name] = table_of(table, given, folder, part.path).numbers
    group = model.groups[group_name]
    assert group.follows is not None
    if not group.sure(part.terms, found):
        part.unsure.add(group_name)
    return group.follows(part.terms, found)


def follow(part: ReadComponent, values: Mapping[str, float]) -> None:
    """Take the terms that follow from the values, of which the scene may leave some at their defaults."""
    if part.model is None or not part.following:
        return
    for group_name in part.following:
        follows = part.model.groups[group_name].follows
        assert follows is not None
        part.terms[group_name] = follows(part.terms, {**part.known(), **values})
    _offer_slots(part, part.model)


def _offer_slots(part: ReadComponent, model: build.Model) -> None:
    part.slots = dict(_slots(model.name, tuple(part.terms.items())))


@lru_cache(maxsize=64)
def _keys(model: str, terms: tuple[tuple[str, str], ...]) -> Mapping[str, Key]:
    """Keys of a model of ours with these terms: the same in every case of a sweep."""
    interface = build.CATALOGUE[model].interface(dict(terms))
    return {build.scene_name(row): key_of(row) for row in build.settable(interface)}


@lru_cache(maxsize=64)
def _slots(model: str, terms: tuple[tuple[str, str], ...]) -> Mapping[str, Slot]:
    """What can be connected or given of it."""
    return {
        name: Slot(row.kind, by_name(row.unit), row.causality)
        for row in build.CATALOGUE[model].interface(dict(terms)).variables
        if row.at_interface
        for name in row.element_names()
    }


def of_fmu(part: ReadComponent, offer: Offer) -> ReadComponent:
    """The part as what an FMU file offers."""
    part.keys, part.slots = dict(offer.keys), dict(offer.slots)
    part.lines = {line.table: line for line in build.lines(part.model.name, {})} if part.model is not None else {}
    return part


def term_named(given: object) -> str:
    """Name of the term that a selector's value means: a text, or a whole number where terms are counted."""
    if isinstance(given, int) and not isinstance(given, bool) and 0 <= given <= LARGEST_INTEGER:
        return str(given)
    return given if isinstance(given, str) and not given.isdecimal() else ""


def read_files(part: ReadComponent, tables: Mapping[str, Any], folder: File, mistakes: list[Mistake]) -> None:
    """Read the files of tables that the scene names; one that it does not name is missing."""
    sources = part.model.interface(part.terms).sources if part.model is not None and part.files else ()
    for name, table in part.files.items():
        path = (*part.path, *name.split("."))
        given = given_at(tables, path[len(part.path) :])
        if table.entry:
            numbers = entries_of(table, given, path, mistakes)
            if numbers is not None:
                part.sources[name] = numbers
            continue
        if given is None:
            mistakes.append(
                Mistake(path, None, f'expected the path of a file, such as "{EXAMPLE}": {table.description}')
            )
            continue
        read = read_value(given, partial(table_of, table, folder=folder, path=path), path, mistakes)
        if read is not None:
            part.tables[name] = read
            if table in sources:
                part.sources[name] = read.numbers


def read_lines(
    part: ReadComponent,
    tables: Mapping[str, Any],
    found: Mapping[str, float],
    own: Mapping[str, Material],
    mistakes: list[Mistake],
) -> tuple[dict[str, LineScene], dict[str, float]]:
    """What the scene says its lines are made of, by table, and the parameters that follow, SI.

    found    parameters that the scene says
    own      its own materials
    """
    lines: dict[str, LineScene] = {}
    follows: dict[str, float] = {}
    for name, line in part.lines.items():
        table = tables.get(name)
        if isinstance(table, dict):
            keys = keys_of(line, part.keys)
            at = (*part.path, name)
            read = read_line(line, keys, table, at, part.known(), found, part.terms, own, mistakes)
            if read is not None:
                lines[name], taken = read
                follows |= taken
    return lines, follows


def read_part(
    part: ReadComponent, tables: Mapping[str, Any], orbit: Mapping[str, Any], mistakes: list[Mistake]
) -> dict[str, float]:
    """SI values by FMI name of all that the scene says of the part: in its tables, its parameters, and the orbit."""
    found: dict[str, float] = {}
    for key, value in orbit.items():
        if f"{SHARED}.{key}" in part.keys:
            _take(part, f"{SHARED}.{key}", value, (SHARED, key), found, mistakes)
    for key, value in tables.items():
        if key not in part.reserved:
            _walk(part, (key,), value, found, mistakes)
    parameters = tables.get("parameters", {})
    path = (*part.path, "parameters")
    if not isinstance(parameters, dict):
        mistakes.append(Mistake(path, parameters, f"expected a table [{dotted(path)}]"))
        return found
    for keys, value in _leaves(parameters, part):
        name, at = ".".join(keys), (*path, *keys)
        if name in part.keys:
            _take(part, name, value, at, found, mistakes)
        else:
            mistakes.append(_no_variable(part, name, at, value))
    return found


def _leaves(
    table: Mapping[str, Any], part: ReadComponent, above: tuple[str, ...] = ()
) -> Iterator[tuple[tuple[str, ...], Any]]:
    """Keys and value of everything in a table of names, however it is nested."""
    for key, value in table.items():
        keys = (*above, key)
        if isinstance(value, dict) and value and ".".join(keys) not in part.keys:
            yield from _leaves(value, part, keys)
        else:
            yield keys, value


def _walk(
    part: ReadComponent, names: tuple[str, ...], value: Any, found: dict[str, float], mistakes: list[Mistake]
) -> None:
    """Read what stands under a key, as deep as the names of variables go."""
    joined, path = ".".join(names), (*part.path, *names)
    ours = part.fmu is None
    if joined in part.keys and not (ours and names[0] == SHARED):
        _take(part, joined, value, path, found, mistakes)
    elif joined in part.files:
        return  # looked at by `read_files`
    elif part.of_line(names):
        return  # looked at by `read_lines`
    elif part.selects(names):
        _look_at_choice(part, names, value, mistakes)
    elif ours and joined in part.groups and not isinstance(value, dict):
        return  # looked at by `of_model`
    elif isinstance(value, dict) and (not ours or _is_table(part, names)):
        for key, inner in value.items():
            _walk(part, (*names, key), inner, found, mistakes)
        if not value and not _is_table(part, names):
            mistakes.append(_no_variable(part, joined, path, value))
    elif _is_table(part, names):
        mistakes.append(Mistake(path, value, f"expected a table [{dotted(path)}]"))
    elif not ours:
        mistakes.append(_no_variable(part, joined, path, value))
    elif _group_that_has(part, names) not in part.refused:
        mistakes.append(_unknown(part, names, value))


def _look_at_choice(part: ReadComponent, names: tuple[str, ...], value: Any, mistakes: list[Mistake]) -> None:
    """A term that is named beside an FMU, which has its terms built in: it says nothing, but must be one."""
    if part.fmu is None:
        return  # looked at by `of_model`
    terms = next(g.terms for name, g in part.groups.items() if names == (g.table or name, g.selector))
    if term_named(value) not in terms:
        shown = [term for term in terms if term in terms]
        text = f"names no term; it may be left out, since {part.fmu.name} has its terms built in"
        mistakes.append(unknown((*part.path, *names), value, text, str(value), shown))


def _is_table(part: ReadComponent, names: tuple[str, ...]) -> bool:
    joined = ".".join(names)
    tables = {group.table or name for name, group in part.groups.items()}
    return joined in tables or (part.holds(joined) and not (part.fmu is None and joined == SHARED))


def _take(
    part: ReadComponent, name: str, value: Any, path: Path, found: dict[str, float], mistakes: list[Mistake]
) -> None:
    """Read the value of one key into the variables it sets."""
    key = part.keys[name]
    unsure = name.partition(".")[0] in part.unsure
    given = read_value(value, key.expected.read, path, [] if unsure else mistakes)
    if given is None:
        return
    numbers = given if isinstance(given, list) else [given]
    for variable, number in zip(key.names, numbers, strict=True):
        earlier = part.given.get(variable)
        if earlier is not None and earlier[0] != SHARED:
            mistakes.append(Mistake(path, value, f"is given twice: also as {dotted(earlier)}"))
            return
        part.given[variable] = path
        if key.expected.kind == TEXT:
            part.texts[variable] = number
        else:
            found[variable] = number


def _no_variable(part: ReadComponent, name: str, path: Path, value: object) -> Mistake:
    """Why a name is not one that can be set: an output, or no variable at all."""
    slot = part.slots.get(name) or part.slots.get(f"{name}[1]")
    what = part.fmu.name if part.fmu is not None else f"this {part.model.name if part.model else 'model'}"
    if slot is None:
        names = [
            *part.keys,
            *(f"{table}.{key}" for table, line in part.lines.items() for key in keys_of(line, part.keys)),
        ]
        known = [*names, *part.reserved] if path == (*part.path, name) else names
        return unknown(path, value, f"{what} has no variable {name!r} that can be set", name, known)
    kind = {"output": "an output", "local": "a local variable"}.get(slot.causality, f"a {slot.causality}")
    return Mistake(path, value, f"{name!r} of {what} is {kind}: only parameters and inputs can be set")


def _unknown(part: ReadComponent, names: tuple[str, ...], value: object) -> Mistake:
    """Why a key or table is not known to a model of ours: misspelt, in the wrong place, or of a term not named."""
    path, key = (*part.path, *names), names[-1]
    if names[0] == SHARED:
        return Mistake(path, value, f"the orbit is shared by the phases: write it as [{SHARED}]")
    if names[0] == SOLVER and key in SOLVER_KEYS:
        return Mistake(path, value, f"is that of all phases: write it under [{SOLVER}], outside the phase")
    group_name = _group_that_has(part, names)
    if group_name is not None:
        group = part.groups[group_name]
        term = next(term for term in group.terms if _brings(group, term, names))
        home = f'[{dotted((*part.path, group.table or group_name))}] {group.selector} = "{term}"'
        return Mistake(path, value, f"belongs to the term {home}, which this scene does not name")
    if len(names) == 1:
        tables = {name.partition(".")[0] for name in (*part.keys, *part.files, *part.lines)}
        tables |= set(part.groups) | set(part.reserved)
        return unknown(path, value, "unknown key", key, tables - {SHARED})
    keys = [name.partition(".")[2] for name in (*part.keys, *part.files) if name.startswith(names[0] + ".")]
    keys += list(keys_of(part.lines[names[0]], part.keys)) if names[0] in part.lines else []
    keys += [group.selector for name, group in part.groups.items() if (group.table or name) == names[0]]
    return unknown(path, value, f"unknown key{part.instead(names[0], key, value)}", key, keys)


def _group_that_has(part: ReadComponent, names: tuple[str, ...]) -> str | None:
    """The group of which a term brings a table or key that is not there now."""
    return next(
        (name for name, group in part.groups.items() if any(_brings(group, term, names) for term in group.terms)), None
    )


def _brings(group: build.Group, term: str, names: tuple[str, ...]) -> bool:
    """Whether a term brings a table or key."""
    rows = build.term_rows(group, term)
    return any(row.causality in build.SETTABLE and (row.section, row.key)[: len(names)] == names for row in rows)


def reserved_of(phase: str) -> frozenset[str]:
    """Keys of a phase's table that are no parameters of its component."""
    return frozenset(
        {*phase_keys(phase), *COMPONENT_KEYS, "fmu", "components", "connections", "coupling", "parameters"}
    )


RESERVED = frozenset({*COMPONENT_KEYS, "fmu", "model", "parameters"})
"""Keys of a further component's table that are no parameters."""
