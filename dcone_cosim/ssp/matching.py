"""Elements of a structure against the FMUs they are about: connectors, values and connections, all SI afterwards."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from lxml import etree

from dcone_cosim.coupling.options import Connection
from dcone_cosim.fmu.steppable import NUMBERS, VariableInfo
from dcone_cosim.ssp.markup import OSP_TYPE, READ, STRUCTURE, TEXT
from dcone_cosim.ssp.package import Mistakes
from dcone_cosim.ssp.parsing import annotated, flag, linear
from dcone_cosim.ssp.values import Given
from dcone_cosim.units import Unit, misfit, same_dimension


@dataclass(frozen=True)
class PackageComponent:
    """A component, `row`, beside its FMU; `experiment` is the FMU's own default, as fmpy reads it."""

    name: str
    row: etree._Element
    fmu: Path
    variables: Mapping[str, VariableInfo]
    experiment: Any

    @cached_property
    def ports(self) -> dict[str, etree._Element]:
        """Connectors by name."""
        return {row.get("name"): row for row in self.row.iterfind("ssd:Connectors/ssd:Connector", READ)}

    @property
    def step(self) -> float | None:
        """The step size that libcosim's annotation suggests [s]."""
        return annotated(self.row, OSP_TYPE, "osp:StepSizeHint/@value")

    def defaults(self) -> dict[str, float]:
        """Start value of every numeric parameter and input, SI."""
        return {
            info.name: info.start
            for info in self.variables.values()
            if info.causality in ("parameter", "input") and info.kind in NUMBERS and info.start is not None
        }


def check_ports(part: PackageComponent, units: Mapping[str, Unit], mistakes: Mistakes) -> None:
    """Note connectors that the FMU has not, or has otherwise."""
    for name, port in part.ports.items():
        what, line = f"connector {name!r} of {part.name!r}", port.sourceline
        info = part.variables.get(name)
        if info is None:
            hint = mistakes.near(name, part.variables)
            mistakes.add(STRUCTURE, line, f"{what}: its FMU has no such variable{hint}")
            continue
        typed = port.find("ssc:*", READ)
        if typed is not None and etree.QName(typed).localname != info.kind:
            mistakes.add(STRUCTURE, line, f"{what} is {etree.QName(typed).localname}; the FMU has it as {info.kind}")
        if port.get("kind") != info.causality:
            text = f"{what} has kind = {port.get('kind')!r}; in the FMU it is {info.causality!r}"
            mistakes.add(STRUCTURE, line, text)
        unit = typed.get("unit") if typed is not None else None
        if unit and _other_unit(unit, info.own, units):
            mistakes.add(STRUCTURE, line, f"{what} is in {unit!r}; the FMU has it in {info.own.name!r}")


def _other_unit(name: str, own: Unit, units: Mapping[str, Unit]) -> bool:
    """Whether a connector tells another unit than the FMU, be it by another name."""
    if own.dimension is None or name == own.name:
        return False
    told = units.get(name)
    if told is not None and own.relative:
        told = told.of_differences()
    return told is None or (told.dimension, told.factor, told.offset) != (own.dimension, own.factor, own.offset)


def parameters(
    values: Iterable[Given], parts: Mapping[str, PackageComponent], mistakes: Mistakes
) -> dict[str, dict[str, float | str]]:
    """Values by component and variable, SI, and texts; a later one replaces an earlier one."""
    found: dict[str, dict[str, float | str]] = {name: {} for name in parts}
    for given in values:
        owner, name = (given.owner, given.name) if given.owner else owner_of(given.name, parts)
        if owner not in parts:
            hint = mistakes.near(given.name.partition(".")[0], parts)
            text = f"parameter {given.name!r} of the system: expected COMPONENT.NAME{hint}"
            _not_found(given, text, mistakes)
            continue
        info = parts[owner].variables.get(name)
        if info is None:
            hint = mistakes.near(name, parts[owner].variables)
            _not_found(given, f"parameter {name!r} of {owner!r} is not a variable of its FMU{hint}", mistakes)
            continue
        problem = _problem(given, info)
        if problem:
            mistakes.add(given.file, given.line, f"parameter {name!r} of {owner!r} {problem}")
        else:
            found[owner][name] = given.text if info.kind == TEXT else _in_si(given, info)
    return found


def _not_found(given: Given, text: str, mistakes: Mistakes) -> None:
    """A name that is not there: by SSP 1.0.1 a parameter set may hold more than is taken; a mapping names what is."""
    (mistakes.add if given.mapped else mistakes.ignore)(given.file, given.line, text)


def owner_of(name: str, parts: Mapping[str, PackageComponent]) -> tuple[str, str]:
    """Component and variable of a name such as `reel.gain.proportional`; names of components may have dots."""
    for part in sorted(parts, key=len, reverse=True):
        if name.startswith(f"{part}."):
            return part, name[len(part) + 1 :]
    return "", name


def _problem(given: Given, info: VariableInfo) -> str:
    """Why a variable cannot take a value, or ""."""
    if info.kind != given.type and (info.kind, given.type) != ("Real", "Integer"):
        return f"is given as {given.type}; the FMU has it as {info.kind}"
    if info.variability == "constant":
        return "cannot be set: in the FMU it is a constant"
    if info.causality not in ("parameter", "input") and info.initial not in ("exact", "approx"):
        return f"cannot be set: in the FMU its causality is {info.causality!r}, without a start value of its own"
    if given.unit is None or given.suppress or info.own.dimension is None or given.unit.name == info.own.name:
        return ""
    if given.unit.dimension is None:
        return f"is given in {given.unit.name!r}, which <ssv:Units> does not define"
    if same_dimension(given.unit.dimension, info.own.dimension):
        return ""
    return f"is given in {given.unit.name!r}; the FMU has it in {info.own.name!r}"


def _in_si(given: Given, info: VariableInfo) -> float:
    """The SI value of a variable: first the unit is converted, then the mapping's transformation applied."""
    value, unit, own = given.value, given.unit, info.own
    if unit is not None and own.relative:
        unit = unit.of_differences()
    if unit is None or unit.name == own.name or own.dimension is None or given.suppress:
        unit = own
    if (given.factor, given.offset) == (1.0, 0.0):
        return unit.to_si(value)
    if unit is not own:
        value = own.from_si(unit.to_si(value))
    return own.to_si(given.factor * value + given.offset)


def connections(
    rows: Iterable[etree._Element], parts: Mapping[str, PackageComponent], mistakes: Mistakes
) -> tuple[Connection, ...]:
    """The connections from outputs to inputs, with the factor and offset between SI values."""
    made: list[Connection] = []
    taken: dict[tuple[str, str], etree._Element] = {}
    for row in rows:
        start, end = _end(row, "start", parts, mistakes), _end(row, "end", parts, mistakes)
        if start is None or end is None:
            continue
        # SSP has no direction in `start` and `end`: it follows from what the connectors are
        (source, out), (target, to) = (start, end) if start[1].get("kind") == "output" else (end, start)
        output, into = source.variables.get(out.get("name")), target.variables.get(to.get("name"))
        if output is None or into is None:
            continue  # told with the connector
        first = taken.setdefault((target.name, into.name), row)
        if (out.get("kind"), to.get("kind")) != ("output", "input"):
            problem = f"{out.get('kind')} to {to.get('kind')}; expected an output and an input"
        else:
            problem = _mismatch(row, output, into)
        if not problem and first is not row:
            problem = f"the input is connected in line {first.sourceline} already"
        if problem:
            what = f"connection {source.name}.{output.name} -> {target.name}.{into.name}"
            mistakes.add(STRUCTURE, row.sourceline, f"{what}: {problem}")
            continue
        made.append(
            Connection(source.name, output.name, target.name, into.name, *_si_transformation(row, output, into))
        )
    return tuple(made)


def _end(
    row: etree._Element, end: str, parts: Mapping[str, PackageComponent], mistakes: Mistakes
) -> tuple[PackageComponent, etree._Element] | None:
    """Component and connector at an end of a connection."""
    element, connector = row.get(f"{end}Element"), row.get(f"{end}Connector")
    if element not in parts:
        mistakes.add(STRUCTURE, row.sourceline, f"connection: no component {element!r}{mistakes.near(element, parts)}")
        return None
    part = parts[element]
    if connector not in part.ports:
        hint = mistakes.near(connector, part.ports)
        mistakes.add(STRUCTURE, row.sourceline, f"connection: no connector {connector!r} of {element!r}{hint}")
        return None
    return part, part.ports[connector]


def _mismatch(row: etree._Element, out: VariableInfo, to: VariableInfo) -> str:
    """Why a value cannot go from the one to the other, or ""."""
    if out.kind != to.kind:
        return f"{out.kind} to {to.kind}"
    if out.kind != "Real" and linear(row) != (1.0, 0.0):
        return f"both are {out.kind}; a linear transformation is for Real"
    why = misfit(out.own, to.own)
    return f"{out.own.name!r} cannot be converted to {to.own.name!r}: {why}" if why else ""


def _si_transformation(row: etree._Element, out: VariableInfo, to: VariableInfo) -> tuple[float, float]:
    """Factor and offset between the SI values of the ends of a connection.

    In the units of the ends t = factor s + offset, where s is in the target's unit already, or as it is when the
    conversion is suppressed.
    """
    factor, offset = linear(row)
    of = out.own if flag(row, "suppressUnitConversion") else to.own
    if of is not to.own:
        factor = factor * to.own.factor / of.factor
    if to.own.is_si and of.is_si:
        return factor, offset
    return factor, to.own.to_si(offset) - factor * of.offset
