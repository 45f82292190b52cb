"""The model description of one FMU, from its table of variables."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from dataclasses import dataclass

from fmu_src.interface import Interface, Model, Value, Variable
from fmu_src.packaging.dependence import inputs_at_start, inputs_of, rates

GENERATOR = "D-CoNe co-simulation"
LOG_CATEGORIES = (
    ("logStatusError", "why a call was refused, or the model failed"),
    ("logStatusDiscard", "why a step was discarded, or that the model came to its own end"),
    ("logStatusWarning", "what is to be taken with care"),
    (
        "logEvents",
        "what the instance does: initialised, terminated, reset, put back into a state; where it is in long steps",
    ),
)
"""Name and meaning of each category, in the order the shim counts them."""
LONGEST_LISTED = 1000
"""Elements of an output, beyond which its initial dependencies are left out: that means all, which holds too."""
SI_BASE = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")


@dataclass(frozen=True)
class Experiment:
    """What an FMU is written for.

    start, stop, step     of the run that a tool makes which is told of no other [s]
    scene                 whose values it starts with; "" for the model's own
    """

    start: float
    stop: float
    step: float
    scene: str = ""

    @classmethod
    def of(cls, model: Model) -> Experiment:
        """The model's own."""
        return cls(0.0, model.stop_time, model.macro_step)


def number(value: Value) -> str:
    """A value as FMI writes it, to the last bit."""
    if isinstance(value, bool):
        return "true" if value else "false"
    return repr(float(value)) if isinstance(value, float) else str(value)


def _unit_definitions(root: ET.Element, variables: list[Variable]) -> None:
    from astropy import units

    displays: dict[str, set[str]] = {}
    for v in variables:
        if v.unit != "1" and v.kind == "Real":
            displays.setdefault(v.unit, set()).update({v.display_unit} - {""})
    definitions = ET.SubElement(root, "UnitDefinitions")
    for name in sorted(displays):
        unit = ET.SubElement(definitions, "Unit", name=name)
        base = units.Unit(python_unit(name)).decompose(bases=[getattr(units, b) for b in SI_BASE])
        exponents = {b.to_string(): int(p) for b, p in zip(base.bases, base.powers, strict=True)}
        attributes = {b: str(exponents[b]) for b in SI_BASE if b in exponents}
        if not math.isclose(base.scale, 1.0):
            attributes["factor"] = repr(float(base.scale))
        ET.SubElement(unit, "BaseUnit", attributes)
        for display in sorted(displays[name]):
            factor = (1.0 * units.Unit(python_unit(name))).to_value(units.Unit(python_unit(display)))
            ET.SubElement(unit, "DisplayUnit", name=display, factor=repr(float(factor)))


def python_unit(name: str) -> str:
    """An FMI unit name as astropy reads it: `kg.m2` is `kg m2`."""
    return name.replace(".", " ")


def _scalars(interface: Interface) -> Iterator[tuple[str, int, Variable, Value]]:
    return (row for row in interface.scalars() if row[2].at_interface)


def summary(interface: Interface, scene: str = "") -> str:
    """What the model is, the terms that are in this FMU and left out of it, and whose values it starts with."""
    left_out = [name for name in interface.model.groups if name not in interface.terms]
    terms = ", ".join(f"{group} {term}" for group, term in interface.terms.items())
    text = interface.model.summary
    if terms:
        text += f" Built with: {terms}."
    if left_out:
        text += f" Left out: {', '.join(left_out)}."
    if scene:
        text += f" Start values: those of the scene {scene}."
    return text


def model_description(
    interface: Interface, identifier: str, guid: str, version: str, experiment: Experiment | None = None
) -> bytes:
    """modelDescription.xml of an FMI 2.0 co-simulation unit; its experiment is the model's own if none is given.

    Checked  tests/packaging/test_description.py
    """
    model = interface.model
    experiment = experiment or Experiment.of(model)
    root = ET.Element(
        "fmiModelDescription",
        fmiVersion="2.0",
        modelName=model.name,
        guid=guid,
        description=summary(interface, experiment.scene),
        version=version,
        generationTool=GENERATOR,
        variableNamingConvention="structured",
        numberOfEventIndicators="0",
    )
    ET.SubElement(root, "CoSimulation", {"modelIdentifier": identifier} | _capabilities(interface))
    _unit_definitions(root, [v for v in interface.variables if v.at_interface])
    categories = ET.SubElement(root, "LogCategories")
    for name, meaning in (*LOG_CATEGORIES, ("logAll", "all of these")):
        ET.SubElement(categories, "Category", name=name, description=meaning)
    times = {"startTime": experiment.start, "stopTime": experiment.stop, "stepSize": experiment.step}
    ET.SubElement(root, "DefaultExperiment", {name: number(float(time)) for name, time in times.items()})
    variables = ET.SubElement(root, "ModelVariables")
    for name, slot, v, start in _scalars(interface):
        scalar = ET.SubElement(variables, "ScalarVariable", _attributes(v, name, slot))
        ET.SubElement(scalar, v.kind, _type_attributes(v, start))
    _structure(root, interface)
    ET.indent(root)
    return bytes(ET.tostring(root, encoding="utf-8", xml_declaration=True)) + b"\n"


def _capabilities(interface: Interface) -> dict[str, str]:
    """What the shim can do for this model."""
    moving = [r for r in rates(interface) if r.is_input]
    growing = [r for r in rates(interface) if not r.is_input]
    return {
        "canHandleVariableCommunicationStepSize": "true",
        "canInterpolateInputs": number(bool(moving)),
        "maxOutputDerivativeOrder": str(int(bool(growing))),
        "canBeInstantiatedOnlyOncePerProcess": "false",
        "canNotUseMemoryManagementFunctions": "true",
        "canGetAndSetFMUstate": "true",
        "canSerializeFMUstate": "true",
        "providesDirectionalDerivative": number(interface.model.differentiable),
    }


def _attributes(v: Variable, name: str, slot: int) -> dict[str, str]:
    """Name, causality and variability of one scalar."""
    attributes = {"name": name, "valueReference": str(slot), "description": sentence(v), "causality": v.causality}
    if v.causality == "parameter":
        return attributes | {"variability": "fixed", "initial": "exact"}
    attributes["variability"] = "continuous" if v.kind == "Real" and not v.discrete else "discrete"
    return attributes if v.causality == "input" else attributes | {"initial": "calculated"}


def _type_attributes(v: Variable, start: Value) -> dict[str, str]:
    """Unit, bounds, typical size and start value of one scalar."""
    typed: dict[str, str] = {}
    if v.kind == "Real" and v.unit != "1":
        typed["unit"] = v.unit
        if v.display_unit:
            typed["displayUnit"] = v.display_unit
    if v.kind != "Boolean":
        for key, bound in (("min", v.minimum), ("max", v.maximum)):
            if math.isfinite(bound):
                typed[key] = number(float(bound) if v.kind == "Real" else int(bound))
    if v.kind == "Real" and v.nominal:
        typed["nominal"] = number(float(v.nominal))
    if v.causality != "output":
        typed["start"] = number(as_typed(v, start))
    return typed


def _structure(root: ET.Element, interface: Interface) -> None:
    """Which inputs each output depends on directly; and what it depends on at the start: inputs, all parameters."""
    indices = {slot: index for index, (_, slot, _, _) in enumerate(_scalars(interface), 1)}
    parameters = [indices[slot] for _, slot, v, _ in _scalars(interface) if v.causality == "parameter"]
    direct, at_start = inputs_of(interface), inputs_at_start(interface)
    structure = ET.SubElement(root, "ModelStructure")
    outputs = ET.SubElement(structure, "Outputs")
    unknowns = ET.SubElement(structure, "InitialUnknowns")
    for _, slot, v, _ in _scalars(interface):
        if v.causality != "output":
            continue
        ET.SubElement(outputs, "Unknown", _dependencies(indices[slot], [indices[s] for s in direct.get(slot, ())]))
        unknown = {"index": str(indices[slot])}
        if v.size <= LONGEST_LISTED:
            inputs = [indices[s] for s in at_start.get(slot, ())]
            unknown = _dependencies(indices[slot], sorted(parameters + inputs))
        ET.SubElement(unknowns, "Unknown", unknown)


def _dependencies(index: int, on: list[int]) -> dict[str, str]:
    attributes = {"index": str(index), "dependencies": " ".join(map(str, on))}
    return attributes | {"dependenciesKind": " ".join(["dependent"] * len(on))} if on else attributes


def as_typed(v: Variable, value: Value) -> Value:
    """A start value in the type of its variable."""
    return float(value) if v.kind == "Real" else bool(value) if v.kind == "Boolean" else int(value)


def sentence(v: Variable) -> str:
    """Meaning of a variable, with the names of its choices."""
    if not v.choices:
        return v.description
    return f"{v.description}: " + ", ".join(f"{i} {choice}" for i, choice in enumerate(v.choices))
