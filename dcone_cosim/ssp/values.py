"""Parameter sets and their mappings: which values a package gives to which variables, in which order."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

from lxml import etree

from dcone_cosim.fmu.units import Unit
from dcone_cosim.ssp.markup import KINDS, MAPPING_TYPE, READ, STRUCTURE, TEXT, VALUES_TYPE, plain
from dcone_cosim.ssp.package import Mistakes, Package, entry_of, parsed
from dcone_cosim.ssp.parsing import BindingRow, check_file, units


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


def given_values(bindings: Iterator[BindingRow], package: Package, mistakes: Mistakes) -> Iterator[Given]:
    """Every value of the bindings, a later one to replace an earlier one of the same variable."""
    for binding in bindings:
        found = _parameter_set(binding, package, mistakes)
        if found is None:
            continue
        file, root = found
        values = {row.name: row for row in _values(binding, root, file, mistakes)}
        mapping = binding.element.find("ssd:ParameterMapping", READ)
        if mapping is None:
            yield from values.values()
        else:
            yield from _mapped(values, mapping, package, mistakes)


def _parameter_set(binding: BindingRow, package: Package, mistakes: Mistakes) -> tuple[str, etree._Element] | None:
    """The parameter set of a binding, inline or from its file, and the file it stands in."""
    row = binding.element
    kind = row.get("type", VALUES_TYPE)
    if kind != VALUES_TYPE:
        mistakes.add(STRUCTURE, binding.line, f"<ssd:ParameterBinding> type = {kind!r}; expected {VALUES_TYPE!r}")
        return None
    return _content(row, "ssd:ParameterValues", "ssv", "ParameterSet", "ParameterValues", package, mistakes)


def _content(
    row: etree._Element, inline: str, prefix: str, name: str, schema: str, package: Package, mistakes: Mistakes
) -> tuple[str, etree._Element] | None:
    """What a binding or mapping holds within itself or in the file it names."""
    source, line, what = row.get("source"), int(row.sourceline or 0), plain(str(row.tag))
    schema = f"SystemStructure{schema}.xsd"
    if source is None:
        holder = row if plain(str(row.tag)) == inline else row.find(inline, READ)
        root = holder[0] if holder is not None and len(holder) else None
        if root is None:
            mistakes.add(STRUCTURE, line, f"<{what}> has neither a source nor a <{prefix}:{name}> in it")
            return None
        return (STRUCTURE, root) if check_file(root, prefix, name, schema, STRUCTURE, mistakes) else None
    if row.get("sourceBase", "SSD") != "SSD":
        mistakes.add(
            STRUCTURE, line, f"<{what}> sourceBase = {row.get('sourceBase')!r}; expected a file of the package"
        )
        return None
    entry, reason = entry_of(source, package.names, mistakes)
    if reason:
        mistakes.add(STRUCTURE, line, f"<{what}> {reason}")
        return None
    root = parsed(package.read(entry), entry, mistakes)
    return (entry, root) if root is not None and check_file(root, prefix, name, schema, entry, mistakes) else None


def _values(binding: BindingRow, root: etree._Element, file: str, mistakes: Mistakes) -> Iterator[Given]:
    known = units(root, "ssv")
    for row in root.iterfind("ssv:Parameters/ssv:Parameter", READ):
        name, typed, line = binding.prefix + row.get("name", ""), row[0], int(row.sourceline or 0)
        kind = plain(str(typed.tag)).partition(":")[2]
        if kind not in (*KINDS, TEXT):
            mistakes.add(file, line, f"parameter {name!r} is of the type {kind}; expected {', '.join((*KINDS, TEXT))}")
            continue
        if kind == TEXT:
            yield Given(binding.owner, name, kind, 0.0, None, file, line, text=typed.get("value", ""))
            continue
        value = _number(kind, typed.get("value", ""))
        if not math.isfinite(value):
            mistakes.add(file, line, f"parameter {name!r} = {typed.get('value')!r}: must be finite")
            continue
        unit = typed.get("unit")
        if unit is not None and unit not in known:
            # only its name is known: it has to be the one that the FMU knows too
            known[unit] = Unit(unit)
        yield Given(binding.owner, name, kind, value, known[unit] if unit is not None else None, file, line)


def _number(kind: str, text: str) -> float:
    """A value that has passed the schema, as xs:double, xs:int or xs:boolean."""
    if kind == "Boolean":
        return float(text.strip() in ("true", "1"))
    return float(text)


def _mapped(
    values: Mapping[str, Given], mapping: etree._Element, package: Package, mistakes: Mistakes
) -> Iterator[Given]:
    """The values under the names they are mapped to; those that no entry names are ignored, as SSP 1.0.1 says."""
    kind, line = mapping.get("type", MAPPING_TYPE), int(mapping.sourceline or 0)
    if kind != MAPPING_TYPE:
        mistakes.add(STRUCTURE, line, f"<ssd:ParameterMapping> type = {kind!r}; expected {MAPPING_TYPE!r}")
        return
    inline = "ssd:ParameterMapping"
    found = _content(mapping, inline, "ssm", "ParameterMapping", "ParameterMapping", package, mistakes)
    if found is None:
        return
    file, root = found
    targets: dict[str, int] = {}
    used: set[str] = set()
    for row in root.iterfind("ssm:MappingEntry", READ):
        source, target, line = row.get("source", ""), row.get("target", ""), int(row.sourceline or 0)
        if target in targets:
            mistakes.add(file, line, f"target {target!r} is mapped to in line {targets[target]} already")
            continue
        targets[target] = line
        transformation = next((child for child in row if plain(str(child.tag)).endswith("Transformation")), None)
        factor, offset = 1.0, 0.0
        if transformation is not None:
            name = plain(str(transformation.tag))
            if name != "ssc:LinearTransformation":
                mistakes.add(file, line, f"<{name}>: only a linear transformation is read")
                continue
            factor = float(transformation.get("factor", 1.0))
            offset = float(transformation.get("offset", 0.0))
        if source not in values:
            mistakes.ignore(file, line, f"entry {source!r} of the mapping has no parameter")
            continue
        value = values[source]
        suppress = row.get("suppressUnitConversion") in ("true", "1")
        if transformation is not None and value.type != "Real":
            mistakes.add(file, line, f"{source!r} is {value.type}: a linear transformation is for Real")
            continue
        used.add(source)
        yield replace(
            value, name=target, file=file, line=line, factor=factor, offset=offset, suppress=suppress, mapped=True
        )
    for name in values.keys() - used:
        mistakes.ignore(values[name].file, values[name].line, f"parameter {name!r} has no entry in its mapping")
