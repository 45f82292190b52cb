"""Parameter sets and their mappings: which values a package gives to which variables, in which order."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace

from lxml import etree

from dcone_cosim.ssp.markup import READ, STRUCTURE, TEXT, plain
from dcone_cosim.ssp.package import Mistakes, Package, entry_of
from dcone_cosim.ssp.parsing import flag, linear, read, units
from dcone_cosim.units import Unit


@dataclass(frozen=True)
class Given:
    """A value as a package gives it: target = factor * value + offset, after units are converted.

    owner       component that is meant, "" when the name begins with it
    type        Real, Integer, Boolean or String, as the parameter set has it
    text        of a String, whose value says nothing
    unit        of the value; None when it is that of the variable; without a dimension when the file defines none
    suppress    take the number as it is, whatever the units
    mapped      the name is the target of a mapping, which has to be there; any other that is not is ignored
    """

    owner: str
    name: str
    type: str
    value: float
    unit: Unit | None
    file: str
    line: int
    factor: float = 1.0
    offset: float = 0.0
    suppress: bool = False
    mapped: bool = False
    text: str = ""


def given_values(
    bindings: Iterable[tuple[str, etree._Element]], package: Package, mistakes: Mistakes
) -> Iterator[Given]:
    """Every value of the bindings, a later one to replace an earlier one of the same variable.

    bindings    elements, each with the component it belongs to
    """
    for owner, binding in bindings:
        file, root = _content(binding, "ssd:ParameterValues/ssv:ParameterSet", package, mistakes)
        if root is None:
            continue
        values = {row.name: row for row in _values(owner, binding.get("prefix", ""), root, file, mistakes)}
        mapping = binding.find("ssd:ParameterMapping", READ)
        if mapping is None:
            yield from values.values()
            continue
        file, root = _content(mapping, "ssm:ParameterMapping", package, mistakes)
        if root is not None:
            yield from _mapped(values, root, file, mistakes)


def _content(
    row: etree._Element, inside: str, package: Package, mistakes: Mistakes
) -> tuple[str, etree._Element | None]:
    """Where the content of a binding or mapping stands, and its root: in the file it names, else within itself."""
    source = row.get("source")
    if source is None:
        return STRUCTURE, row.find(inside, READ)
    entry, reason = entry_of(source, package.names, mistakes)
    if reason:
        mistakes.add(STRUCTURE, row.sourceline, f"<{plain(row.tag)}> {reason}")
        return STRUCTURE, None
    return entry, read(package.read(entry), entry, inside.rpartition("/")[2], mistakes)


def _values(owner: str, prefix: str, root: etree._Element, file: str, mistakes: Mistakes) -> Iterator[Given]:
    known = units(root, file, mistakes)
    for row in root.iterfind("ssv:Parameters/ssv:Parameter", READ):
        name, kind, text = prefix + row.get("name"), etree.QName(row[0]).localname, row[0].get("value")
        if kind == TEXT:
            yield Given(owner, name, kind, 0.0, None, file, row.sourceline, text=text)
            continue
        value = float(flag(row[0], "value")) if kind == "Boolean" else float(text)
        if not math.isfinite(value):
            mistakes.add(file, row.sourceline, f"parameter {name!r} = {text!r}: must be finite")
            continue
        unit = row[0].get("unit")
        # of a unit that the file does not define only the name is known: it has to be the one that the FMU knows too
        of = known.get(unit, Unit(unit)) if unit is not None else None
        yield Given(owner, name, kind, value, of, file, row.sourceline)


def _mapped(values: Mapping[str, Given], root: etree._Element, file: str, mistakes: Mistakes) -> Iterator[Given]:
    """The values under the names they are mapped to; those that no entry names are ignored, as SSP 1.0.1 says."""
    targets: dict[str, int] = {}
    used: set[str] = set()
    for row in root.iterfind("ssm:MappingEntry", READ):
        source, target, line = row.get("source"), row.get("target"), row.sourceline
        if target in targets:
            mistakes.add(file, line, f"target {target!r} is mapped to in line {targets[target]} already")
            continue
        targets[target] = line
        if source not in values:
            mistakes.ignore(file, line, f"entry {source!r} of the mapping has no parameter")
            continue
        value, (factor, offset) = values[source], linear(row)
        if value.type != "Real" and (factor, offset) != (1.0, 0.0):
            mistakes.add(file, line, f"{source!r} is {value.type}: a linear transformation is for Real")
            continue
        used.add(source)
        suppress = flag(row, "suppressUnitConversion")
        yield replace(
            value, name=target, file=file, line=line, factor=factor, offset=offset, suppress=suppress, mapped=True
        )
    for name in values.keys() - used:
        mistakes.ignore(values[name].file, values[name].line, f"parameter {name!r} has no entry in its mapping")
