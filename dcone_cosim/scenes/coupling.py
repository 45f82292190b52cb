"""What a scene says of several components of a phase: which are connected, and how their steps are taken."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from dcone_cosim.coupling.one_length import divides, one_length, uncontrolled
from dcone_cosim.coupling.options import Connection, Coupling
from dcone_cosim.coupling.wiring import mismatch
from dcone_cosim.scene.mistakes import Mistake, unknown
from dcone_cosim.scene.toml_lines import Path, dotted
from dcone_cosim.scenes.keys import COUPLING_KEYS, phase_keys, read_table, table_in
from dcone_cosim.scenes.read_component import ReadComponent

ARROW = "->"
FORM = '"INSTANCE.VARIABLE -> INSTANCE.VARIABLE"'


def read_connections(
    given: object, path: Path, parts: Sequence[ReadComponent], mistakes: list[Mistake]
) -> tuple[Connection, ...]:
    """The connections of a phase; a list on both sides connects element by element."""
    if not isinstance(given, list):
        mistakes.append(Mistake(path, given, f"expected a list of {FORM}"))
        return ()
    by_name = {part.name: part for part in parts}
    found: dict[tuple[str, str], Path] = {}
    connections = []
    for place, text in enumerate(given):
        at = (*path, place)
        for connection in _read_one(text, at, by_name, mistakes):
            into = (connection.target, connection.input)
            constant = by_name[connection.target].given.get(connection.input)
            if into in found:
                mistakes.append(
                    Mistake(at, text, f"{'.'.join(into)} is connected twice: also by {dotted(found[into])}")
                )
            elif constant is not None:
                also = f"{'.'.join(into)} is connected here, and is given a value as {dotted(constant)}"
                mistakes.append(Mistake(at, text, f"{also}: leave one of them out"))
            else:
                found[into] = at
                connections.append(connection)
    return tuple(connections)


def _read_one(
    text: object, path: Path, parts: Mapping[str, ReadComponent], mistakes: list[Mistake]
) -> list[Connection]:
    sides = [side.strip() for side in text.split(ARROW)] if isinstance(text, str) else []
    if len(sides) != 2 or not all("." in side.strip(".") for side in sides):
        mistakes.append(Mistake(path, text, f"expected {FORM}"))
        return []
    before = len(mistakes)
    (source, output), (target, into) = (side.split(".", 1) for side in sides)
    outputs = _end(text, path, source, output, "output", parts, mistakes)
    inputs = _end(text, path, target, into, "input", parts, mistakes)
    if not outputs or not inputs:
        return []  # told already, or of an FMU that could not be read
    if len(mistakes) == before and source == target:
        mistakes.append(Mistake(path, text, f"connects {source} with itself: expected two components"))
    if len(mistakes) == before and len(outputs) != len(inputs):
        sizes = f"{source}.{output} has {len(outputs)} elements, {target}.{into} has {len(inputs)}"
        mistakes.append(Mistake(path, text, f"{sizes}: expected as many"))
    if len(mistakes) > before:
        return []
    wrong = mismatch(sides[0], parts[source].slots[outputs[0]], sides[1], parts[target].slots[inputs[0]])
    if wrong:
        mistakes.append(Mistake(path, text, wrong))
        return []
    return [Connection(source, o, target, i) for o, i in zip(outputs, inputs, strict=True)]


def _end(
    text: object,
    path: Path,
    name: str,
    variable: str,
    causality: str,
    parts: Mapping[str, ReadComponent],
    mistakes: list[Mistake],
) -> list[str]:
    """The variables at one end of a connection: one, or the elements of a list."""
    part = parts.get(name)
    if part is None:
        mistakes.append(unknown(path, text, f"there is no component {name!r}", name, parts))
        return []
    if not part.slots:
        return []
    elements = [variable] if variable in part.slots else []
    while elements[:1] != [variable] and f"{variable}[{len(elements) + 1}]" in part.slots:
        elements.append(f"{variable}[{len(elements) + 1}]")
    fitting = [n for n, slot in part.slots.items() if slot.causality == causality]
    if not elements:
        mistakes.append(unknown(path, text, f"{name} has no {causality} {variable!r}", variable, fitting))
        return []
    slot = part.slots[elements[0]]
    if slot.causality != causality:
        is_a = f"{slot.causality} of {name}, expected an {causality}"
        article = "an" if slot.causality[0] in "aeiou" else "a"
        mistakes.append(unknown(path, text, f"{variable!r} is {article} {is_a}", variable, fitting))
        return []
    return elements


def read_coupling(
    tables: Mapping[str, Any], path: Path, parts: Sequence[ReadComponent], mistakes: list[Mistake]
) -> Coupling:
    """How the steps are taken; without further components there is nothing to couple."""
    path = (*path, "coupling")
    table = table_in(tables, path, mistakes)
    found = read_table(table, COUPLING_KEYS, path, mistakes, also=("order",))
    for key in ("method", "control", "extrapolation"):
        if key in found:
            found[key] = COUPLING_KEYS[key].choices[int(found[key])]
    if "order" in table:
        found["order"] = _order(table["order"], (*path, "order"), parts, mistakes)
    smallest = found.get("smallest_step")
    if smallest is not None and "step" in found and smallest > found["step"]:
        mistakes.append(Mistake((*path, "smallest_step"), table["smallest_step"], "must be at most coupling.step"))
    for key in ("tolerance", "smallest_step"):
        if key in table and found.get("control", "fixed") != "error":
            mistakes.append(Mistake((*path, key), table[key], 'says nothing to fixed steps; add control = "error"'))
    return Coupling(**found)


def about_components(
    coupling: Coupling, parts: Sequence[ReadComponent], tables: Mapping[str, Any]
) -> Iterator[Mistake]:
    """Components that cannot be stepped as asked, or whose variables could not be told from those of the main one."""
    main, *others = parts
    if coupling.control == "error":
        told = [(p.name, p.archive.can_save, p.archive.can_vary_step) for p in parts if p.archive is not None]
        for text in uncontrolled(told):
            yield Mistake((*main.path, "coupling", "control"), "error", text)
    for part in others:
        alike = next((name for name in part.slots if f"{part.name}.{name}" in main.slots), None)
        if alike is not None:
            text = f"{main.name} has a variable {part.name}.{alike} too: expected another name for this component"
            yield Mistake(part.path, tables["components"][part.name], text)


def about_one_length(
    options: Mapping[str, Any], coupling: Coupling, parts: Sequence[ReadComponent], tables: Mapping[str, Any]
) -> Iterator[Mistake]:
    """Steps that would have to be cut short for an FMU that takes steps of one length.

    options    of the phase, read; those that could not be read are told already
    """
    even = [part.name for part in parts if part.archive is not None and not part.archive.can_vary_step]
    macro_step, path = options.get("macro_step"), parts[0].path
    if not even or macro_step is None:
        return
    times = [k for k, expected in phase_keys(str(path[0])).items() if expected.unit == "s" and not expected.size]
    for key in times:
        length = options.get(key)
        if length is not None and length > 0.0 and not divides(macro_step, length):
            text = f"must be a whole number of macro steps of {macro_step:g} s: {one_length(even)}"
            yield Mistake((*path, key), tables[key], text)
    if coupling.control == "fixed" and coupling.step and not divides(coupling.step, macro_step):
        text = f"must divide the macro step of {macro_step:g} s: {one_length(even)}"
        yield Mistake((*path, "coupling", "step"), tables["coupling"]["step"], text)


def _order(given: object, path: Path, parts: Sequence[ReadComponent], mistakes: list[Mistake]) -> tuple[str, ...]:
    names = [part.name for part in parts]
    if isinstance(given, list) and sorted(map(str, given)) == sorted(names):
        return tuple(given)
    for place, name in enumerate(given if isinstance(given, list) else ()):
        if name not in names:
            mistakes.append(unknown((*path, place), name, "no component of this phase", str(name), names))
            return ()
    listed = ", ".join(f'"{name}"' for name in names)
    mistakes.append(Mistake(path, given, f"expected each component once, such as [{listed}]"))
    return ()
