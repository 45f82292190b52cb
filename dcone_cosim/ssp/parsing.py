"""From the XML of a structure to rows, each with its line; what lies outside the subset is noted as a mistake."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

import fmpy.ssp
from lxml import etree

from dcone_cosim.fmu.units import BASE, Unit
from dcone_cosim.ssp.markup import FMU_TYPE, KINDS, OMS_TYPE, OSP_TYPE, OUR_TYPE, READ, TEXT, VERSION, plain, tag
from dcone_cosim.ssp.package import Mistakes

SCHEMA = Path(fmpy.ssp.__file__).parent / "schema"
"""Schema files of SSP 1.0, as fmpy brings them."""
PORT_KINDS = ("input", "output", "parameter", "calculatedParameter")


@dataclass(frozen=True)
class PortRow:
    name: str
    kind: str
    type: str
    unit: str
    line: int


@dataclass(frozen=True)
class BindingRow:
    """A parameter binding: `element` is its XML, to be read with the files it names."""

    owner: str
    prefix: str
    element: etree._Element
    line: int


@dataclass(frozen=True)
class ComponentRow:
    name: str
    source: str
    ports: Mapping[str, PortRow]
    bindings: tuple[BindingRow, ...]
    step: float | None
    line: int


@dataclass(frozen=True)
class ConnectionRow:
    """As it stands: which end is the output follows from the connectors."""

    start: tuple[str, str]
    end: tuple[str, str]
    factor: float
    offset: float
    suppress: bool
    line: int


@dataclass(frozen=True)
class Document:
    """A structure; times [s], None where it tells none. `ours`: attributes of our own annotation by element."""

    name: str
    description: str
    components: tuple[ComponentRow, ...]
    connections: tuple[ConnectionRow, ...]
    bindings: tuple[BindingRow, ...]
    units: Mapping[str, Unit]
    start: float | None
    stop: float | None
    step: float | None
    ours: Mapping[str, Mapping[str, str]] = field(default_factory=dict)


def document(root: etree._Element, file: str, mistakes: Mistakes) -> Document | None:
    """The structure, or None with mistakes noted: first what is outside of the subset, then what the schema refuses."""
    if not _is(root, "ssd", "SystemStructureDescription", file, mistakes):
        return None
    _refuse_beyond(root, file, mistakes)
    if mistakes.rows:
        return None
    validate(root, "SystemStructureDescription.xsd", file, mistakes)
    if mistakes.rows:
        return None
    system = root.find("ssd:System", READ)
    assert system is not None, "the schema asks for it"
    components = tuple(_component(row) for row in system.iterfind("ssd:Elements/ssd:Component", READ))
    _refuse_twice(components, file, mistakes)
    if not components:
        mistakes.add(file, system.sourceline, "the system holds no component")
    connections = tuple(_connection(row) for row in system.iterfind("ssd:Connections/ssd:Connection", READ))
    experiment = root.find("ssd:DefaultExperiment", READ)
    return Document(
        system.get("name", ""),
        system.get("description") or root.get("name", ""),
        components,
        connections,
        tuple(_bindings(system, "")),
        units(root, "ssd"),
        _number(experiment, "startTime"),
        _number(experiment, "stopTime"),
        _step(root, system),
        _ours(root),
    )


def _is(root: etree._Element, prefix: str, name: str, file: str, mistakes: Mistakes) -> bool:
    """Whether a root is the element and version expected."""
    if root.tag != tag(prefix, name):
        mistakes.add(file, root.sourceline, f"<{plain(str(root.tag))}> is not <{prefix}:{name}> of SSP {VERSION}")
    elif root.get("version") != VERSION:
        text = f"<{prefix}:{name}> has version = {root.get('version')!r}; expected {VERSION!r}, the one read here"
        mistakes.add(file, root.sourceline, text)
    else:
        return True
    return False


def validate(root: etree._Element, schema: str, file: str, mistakes: Mistakes) -> None:
    """Note what the schema of SSP 1.0 says against a tree."""
    rules = _schema(schema)
    if not rules.validate(root):
        for entry in rules.error_log:
            text = entry.message
            for prefix, uri in READ.items():
                text = text.replace(f"{{{uri}}}", f"{prefix}:")
            mistakes.add(file, entry.line, text)


@cache
def _schema(name: str) -> etree.XMLSchema:
    return etree.XMLSchema(file=str(SCHEMA / name))


def check_file(root: etree._Element, prefix: str, name: str, schema: str, file: str, mistakes: Mistakes) -> bool:
    """Whether a parameter set or mapping is one, of this version and by the schema."""
    if not _is(root, prefix, name, file, mistakes):
        return False
    before = len(mistakes.rows)
    validate(root, schema, file, mistakes)
    return len(mistakes.rows) == before


def _refuse_beyond(root: etree._Element, file: str, mistakes: Mistakes) -> None:
    """Note what SSP has and the subset has not."""

    def refuse(row: etree._Element, text: str) -> None:
        name = f" {row.get('name')!r}" if row.get("name") else ""
        mistakes.add(file, row.sourceline, f"<{plain(str(row.tag))}>{name}: {text}")

    system = "ssd:System"
    for row in root.iterfind(f".//ssd:Elements/{system}", READ):
        refuse(row, "a system within a system is not read; put its components into the one system")
    for row in root.iterfind(f".//{system}/ssd:Elements/ssd:SignalDictionaryReference", READ):
        refuse(row, "signal dictionaries are not read; connect the components to one another")
    for row in root.iterfind(f".//{system}/ssd:SignalDictionaries", READ):
        refuse(row, "signal dictionaries are not read")
    for row in root.iterfind(f"./{system}/ssd:Connectors/ssd:Connector", READ):
        refuse(row, "a connector of the system itself is not read; connect and set the components")
    for component in root.iterfind(f"./{system}/ssd:Elements/ssd:Component", READ):
        if component.get("type", FMU_TYPE) != FMU_TYPE:
            refuse(component, f"type = {component.get('type')!r}; expected an FMU, {FMU_TYPE!r}")
        if component.get("implementation") == "ModelExchange":
            refuse(component, "implementation = 'ModelExchange'; expected co-simulation")
        for port in component.iterfind("ssd:Connectors/ssd:Connector", READ):
            kind, kinds = _port_type(port), " or ".join((", ".join(KINDS), TEXT))
            if kind and kind not in (*KINDS, TEXT):
                refuse(port, f"of {component.get('name')!r} is of the type {kind}; expected {kinds}")
            if port.get("kind") not in PORT_KINDS:
                refuse(
                    port, f"of {component.get('name')!r} has kind = {port.get('kind')!r}; expected {PORT_KINDS[0]}, ..."
                )
    for row in root.iterfind(f"./{system}/ssd:Connections/ssd:Connection", READ):
        for end in ("start", "end"):
            if row.get(f"{end}Element") is None:
                refuse(row, f"{end}Connector = {row.get(f'{end}Connector')!r} is one of the system; name a component")
        for child in row:
            if child.tag in [tag("ssc", f"{kind}MappingTransformation") for kind in (*KINDS, "Enumeration")]:
                refuse(child, "only a linear transformation is read")


def _port_type(port: etree._Element) -> str:
    for child in port:
        name = plain(str(child.tag))
        if name.startswith("ssc:"):
            return name[len("ssc:") :]
    return ""


def _refuse_twice(components: tuple[ComponentRow, ...], file: str, mistakes: Mistakes) -> None:
    seen: dict[str, int] = {}
    for row in components:
        if row.name in seen:
            text = f"<ssd:Component> {row.name!r}: line {seen[row.name]} has one of that name"
            mistakes.add(file, row.line, text)
        seen.setdefault(row.name, row.line)


def _component(row: etree._Element) -> ComponentRow:
    name = row.get("name", "")
    ports = {}
    for port in row.iterfind("ssd:Connectors/ssd:Connector", READ):
        kind = _port_type(port)
        typed = port.find(f"ssc:{kind}", READ) if kind else None
        unit = typed.get("unit", "") if typed is not None else ""
        ports[port.get("name", "")] = PortRow(port.get("name", ""), port.get("kind", ""), kind, unit, _line(port))
    hint = _annotated(row, OSP_TYPE, "osp:StepSizeHint")
    return ComponentRow(
        name, row.get("source", ""), ports, tuple(_bindings(row, name)), _number(hint, "value"), _line(row)
    )


def _bindings(row: etree._Element, owner: str) -> Iterator[BindingRow]:
    for binding in row.iterfind("ssd:ParameterBindings/ssd:ParameterBinding", READ):
        yield BindingRow(owner, binding.get("prefix", ""), binding, _line(binding))


def _connection(row: etree._Element) -> ConnectionRow:
    linear = row.find("ssc:LinearTransformation", READ)
    factor, offset = _number(linear, "factor"), _number(linear, "offset")
    return ConnectionRow(
        (row.get("startElement", ""), row.get("startConnector", "")),
        (row.get("endElement", ""), row.get("endConnector", "")),
        1.0 if factor is None else factor,
        offset or 0.0,
        row.get("suppressUnitConversion") in ("true", "1"),
        _line(row),
    )


def _line(row: etree._Element) -> int:
    return int(row.sourceline or 0)


def _number(row: etree._Element | None, name: str) -> float | None:
    given = row.get(name) if row is not None else None
    try:
        return float(given) if given is not None else None
    except ValueError:
        return None


def units(root: etree._Element, prefix: str) -> dict[str, Unit]:
    """Units that a file defines, by name."""
    found = {}
    for row in root.iterfind(f"{prefix}:Units/ssc:Unit", READ):
        base = row.find("ssc:BaseUnit", READ)
        if base is not None:
            name, factor, offset = row.get("name", ""), _number(base, "factor"), _number(base, "offset")
            dimension = tuple(int(base.get(key, 0)) for key in BASE)
            found[name] = Unit(name, dimension, 1.0 if factor is None else factor, offset or 0.0)
    return found


def _annotated(row: etree._Element | None, kind: str, path: str) -> etree._Element | None:
    """The element of that path in an annotation of that type."""
    if row is None:
        return None
    for annotation in row.iterfind("ssd:Annotations/ssc:Annotation", READ):
        if annotation.get("type") == kind:
            return annotation.find(path, READ)
    return None


def _step(root: etree._Element, system: etree._Element) -> float | None:
    """Step size that libcosim's or OMSimulator's annotation tells."""
    experiment = root.find("ssd:DefaultExperiment", READ)
    osp = _annotated(experiment, OSP_TYPE, "osp:Algorithm/osp:FixedStepAlgorithm")
    oms = _annotated(system, OMS_TYPE, "oms:Annotations/oms:SimulationInformation")
    step = _number(osp, "baseStepSize")
    return step if step is not None else _number(oms, "fixedStepSize")


def _ours(root: etree._Element) -> dict[str, dict[str, str]]:
    phase = _annotated(root, OUR_TYPE, "dcone:Phase")
    rows = phase if phase is not None else ()
    return {plain(str(row.tag)).partition(":")[2]: {str(k): str(v) for k, v in row.attrib.items()} for row in rows}
