"""The XML of a phase: its structure, and its parameters as a set of their own. Bytes depend on the content alone."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from importlib.metadata import version

from lxml import etree

from dcone_cosim.ssp.markup import (
    FMU_TYPE,
    NAMESPACES,
    OMS_TYPE,
    OSP_TYPE,
    OUR_TYPE,
    PARAMETER_SET,
    SSC,
    SSV,
    VERSION,
    tag,
)
from dcone_cosim.units import Unit

MASTER = "master"
"""Name of the stepping in OMSimulator's annotations."""


@dataclass(frozen=True)
class Port:
    """A connector of a component; `unit` is "" when there is none to tell."""

    name: str
    kind: str
    type: str
    unit: str = ""


@dataclass(frozen=True)
class Value:
    """A start value in the unit of its variable."""

    name: str
    type: str
    value: float
    unit: str = ""

    def text(self) -> str:
        if self.type == "Real":
            return repr(float(self.value))
        return str(int(self.value)) if self.type == "Integer" else str(bool(self.value)).lower()


@dataclass(frozen=True)
class ComponentElement:
    """One component as it is written.

    source      path of its FMU in the archive
    values_at   path of the .ssv file that is bound, "" for values inline
    """

    name: str
    source: str
    ports: Sequence[Port]
    values: Sequence[Value]
    units: Mapping[str, Unit]
    values_at: str = ""


@dataclass(frozen=True)
class Wire:
    """A connection: target = factor * source + offset, each in its own unit.

    The factor has the conversion of units in it where they differ, and tools are told not to convert: some would not.
    """

    source: tuple[str, str]
    target: tuple[str, str]
    factor: float = 1.0
    offset: float = 0.0


@dataclass(frozen=True)
class Structure:
    """A phase as it is written: times [s], and what only our own master reads (`ours`, attributes by element)."""

    name: str
    description: str
    parts: Sequence[ComponentElement]
    wires: Sequence[Wire]
    start: float
    stop: float
    step: float
    ours: Mapping[str, Mapping[str, str]] = field(default_factory=dict)


def tool() -> str:
    return f"dcone-cosim {version('dcone-cosim')}"


def structure(content: Structure) -> bytes:
    """`SystemStructure.ssd`."""
    about = {"version": VERSION, "name": content.name, "generationTool": tool()}
    root = etree.Element(tag("ssd", "SystemStructureDescription"), about, nsmap=NAMESPACES)
    system = _add(root, "ssd", "System", name=content.name, description=content.description)
    elements = _add(system, "ssd", "Elements")
    for part in content.parts:
        _add_part(elements, part, content.step)
    if content.wires:
        connections = _add(system, "ssd", "Connections")
        for wire in content.wires:
            _add_wire(connections, wire)
    stepping = {"name": MASTER, "method": "oms_ma", "fixedStepSize": repr(content.step)}
    _add_oms(_add(system, "ssd", "Annotations"), **stepping)
    _add_units(root, "ssd", _units_named(content.parts))
    experiment = _add(root, "ssd", "DefaultExperiment", startTime=repr(content.start), stopTime=repr(content.stop))
    algorithm = _add(_annotation(_add(experiment, "ssd", "Annotations"), OSP_TYPE), "osp", "Algorithm")
    _add(algorithm, "osp", "FixedStepAlgorithm", baseStepSize=repr(content.step))
    if content.ours:
        phase = _add(_annotation(_add(root, "ssd", "Annotations"), OUR_TYPE), "dcone", "Phase")
        for name, attributes in content.ours.items():
            _add(phase, "dcone", name, **attributes)
    return _bytes(root)


def parameter_set(values: Sequence[Value], units: Mapping[str, Unit]) -> bytes:
    """An .ssv file."""
    namespaces = {"ssv": SSV, "ssc": SSC}
    root = etree.Element(tag("ssv", "ParameterSet"), nsmap=namespaces)
    _fill_set(root, values, units)
    root.set("generationTool", tool())
    return _bytes(root)


def _add(parent: etree._Element, prefix: str, element: str, /, **attributes: str) -> etree._Element:
    return etree.SubElement(parent, tag(prefix, element), attributes)


def _annotation(parent: etree._Element, kind: str) -> etree._Element:
    return _add(parent, "ssc", "Annotation", type=kind)


def _add_oms(annotations: etree._Element, **attributes: str) -> None:
    inner = _add(_annotation(annotations, OMS_TYPE), "oms", "Annotations")
    _add(inner, "oms", "SimulationInformation", **attributes)


def _add_part(elements: etree._Element, part: ComponentElement, step: float) -> None:
    component = _add(
        elements, "ssd", "Component", name=part.name, type=FMU_TYPE, source=part.source, implementation="CoSimulation"
    )
    if part.ports:
        connectors = _add(component, "ssd", "Connectors")
        for port in part.ports:
            connector = _add(connectors, "ssd", "Connector", name=port.name, kind=port.kind)
            _add(connector, "ssc", port.type, **({"unit": port.unit} if port.unit else {}))
    if part.values:
        bindings = _add(component, "ssd", "ParameterBindings")
        if part.values_at:
            _add(bindings, "ssd", "ParameterBinding", source=part.values_at)
        else:
            inline = _add(_add(bindings, "ssd", "ParameterBinding"), "ssd", "ParameterValues")
            _fill_set(_add(inline, "ssv", "ParameterSet"), part.values, part.units)
    annotations = _add(component, "ssd", "Annotations")
    _add(_annotation(annotations, OSP_TYPE), "osp", "StepSizeHint", value=repr(step))
    _add_oms(annotations, name=MASTER)


def _fill_set(root: etree._Element, values: Sequence[Value], units: Mapping[str, Unit]) -> None:
    root.set("version", VERSION)
    root.set("name", PARAMETER_SET)
    rows = _add(root, "ssv", "Parameters")
    for row in values:
        unit = {"unit": row.unit} if row.unit else {}
        _add(_add(rows, "ssv", "Parameter", name=row.name), "ssv", row.type, value=row.text(), **unit)
    _add_units(root, "ssv", {row.unit: units[row.unit] for row in values if row.unit})


def _add_wire(connections: etree._Element, wire: Wire) -> None:
    ends = {
        "startElement": wire.source[0],
        "startConnector": wire.source[1],
        "endElement": wire.target[0],
        "endConnector": wire.target[1],
    }
    row = _add(connections, "ssd", "Connection", **ends)
    if wire.factor != 1.0 or wire.offset != 0.0:
        row.set("suppressUnitConversion", "true")
        _add(row, "ssc", "LinearTransformation", factor=repr(wire.factor), offset=repr(wire.offset))


def _units_named(parts: Iterable[ComponentElement]) -> dict[str, Unit]:
    named = [(row.unit, part) for part in parts for row in part.ports if row.unit]
    named += [(row.unit, part) for part in parts for row in part.values if row.unit]
    return {name: part.units[name] for name, part in named}


def _add_units(root: etree._Element, prefix: str, units: Mapping[str, Unit]) -> None:
    if not units:
        return
    rows = _add(root, prefix, "Units")
    for name, unit in sorted(units.items()):
        _add(_add(rows, "ssc", "Unit", name=name), "ssc", "BaseUnit", **unit.definition)


def _bytes(root: etree._Element) -> bytes:
    written: bytes = etree.tostring(root, encoding="UTF-8", xml_declaration=True, pretty_print=True)
    return written
