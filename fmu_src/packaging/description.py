"""The model description, the generated C header and the documentation page of one FMU, from its table of variables."""

from __future__ import annotations

import math
import re
import struct
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from fmu_src.interface import Interface, Value, Variable

GENERATOR = "D-CoNe co-simulation"
STYLE = (
    "body{font:16px/1.5 sans-serif;max-width:60em;margin:2em auto;padding:0 1em}"
    "td,th{padding:.1em .6em;text-align:left}"
)
SI_BASE = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")


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


def model_description(interface: Interface, identifier: str, guid: str, version: str) -> bytes:
    """modelDescription.xml of an FMI 2.0 co-simulation unit."""
    left_out = [name for name in interface.model.groups if name not in interface.terms]
    terms = ", ".join(f"{group} {term}" for group, term in interface.terms.items())
    text = f"{interface.model.summary} Built with: {terms}."
    if left_out:
        text += f" Left out: {', '.join(left_out)}."
    root = ET.Element(
        "fmiModelDescription",
        fmiVersion="2.0",
        modelName=interface.model.name,
        guid=guid,
        description=text,
        version=version,
        generationTool=GENERATOR,
        variableNamingConvention="structured",
        numberOfEventIndicators="0",
    )
    ET.SubElement(
        root,
        "CoSimulation",
        modelIdentifier=identifier,
        canHandleVariableCommunicationStepSize="true",
        canInterpolateInputs="false",
        maxOutputDerivativeOrder="0",
        canBeInstantiatedOnlyOncePerProcess="false",
        canNotUseMemoryManagementFunctions="true",
        canGetAndSetFMUstate="true",
        canSerializeFMUstate="true",
        providesDirectionalDerivative="false",
    )
    _unit_definitions(root, [v for v in interface.variables if v.at_interface])
    categories = ET.SubElement(root, "LogCategories")
    ET.SubElement(categories, "Category", name="logStatusError", description="why a call was refused")
    ET.SubElement(categories, "Category", name="logStatusDiscard", description="why a step was discarded")
    model = interface.model
    experiment = {"startTime": "0.0", "stopTime": number(model.stop_time), "stepSize": number(model.macro_step)}
    ET.SubElement(root, "DefaultExperiment", experiment)
    variables = ET.SubElement(root, "ModelVariables")
    outputs: list[int] = []
    for index, (name, slot, v, start) in enumerate(_scalars(interface), 1):
        attributes = {"name": name, "valueReference": str(slot), "description": _sentence(v)}
        continuous = v.kind == "Real" and not v.discrete
        if v.causality == "parameter":
            attributes |= {"causality": "parameter", "variability": "fixed", "initial": "exact"}
        elif v.causality == "input":
            attributes |= {"causality": "input", "variability": "continuous" if continuous else "discrete"}
        else:
            outputs.append(index)
            attributes |= {"causality": "output", "variability": "continuous" if continuous else "discrete"}
            attributes["initial"] = "calculated"
        scalar = ET.SubElement(variables, "ScalarVariable", attributes)
        typed: dict[str, str] = {}
        if v.kind == "Real" and v.unit != "1":
            typed["unit"] = v.unit
            if v.display_unit:
                typed["displayUnit"] = v.display_unit
        if v.kind != "Boolean":
            if math.isfinite(v.minimum):
                typed["min"] = number(float(v.minimum) if v.kind == "Real" else int(v.minimum))
            if math.isfinite(v.maximum):
                typed["max"] = number(float(v.maximum) if v.kind == "Real" else int(v.maximum))
        if v.causality != "output":
            typed["start"] = number(_typed(v, start))
        ET.SubElement(scalar, v.kind, typed)
    structure = ET.SubElement(root, "ModelStructure")
    for tag in ("Outputs", "InitialUnknowns"):
        element = ET.SubElement(structure, tag)
        for index in outputs:
            ET.SubElement(element, "Unknown", index=str(index))
    ET.indent(root)
    return bytes(ET.tostring(root, encoding="utf-8", xml_declaration=True)) + b"\n"


def _typed(v: Variable, value: Value) -> Value:
    return float(value) if v.kind == "Real" else bool(value) if v.kind == "Boolean" else int(value)


def _sentence(v: Variable) -> str:
    if not v.choices:
        return v.description
    return f"{v.description}: " + ", ".join(f"{i} {choice}" for i, choice in enumerate(v.choices))


def _c_string(text: str) -> str:
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'


def header(interface: Interface, identifier: str, guid: str) -> str:
    """The C header that tells the shim about one model: slots, start values, bounds, faults."""
    rows = list(interface.scalars())
    lines = [
        "/* generated from the model's table of variables */",
        f"#define DCONE_IDENTIFIER {_c_string(identifier)}",
        f"#define DCONE_GUID {_c_string(guid)}",
        f"#define DCONE_SLOTS {len(rows)}",
    ]
    kinds = {"Real": 1, "Integer": 2, "Boolean": 3}
    access = {"state": 0, "output": 1, "parameter": 2, "input": 3}
    codes, starts = [], []
    for _, _, v, start in rows:
        codes.append(str(kinds[v.kind] + 4 * access[v.causality]))
        raw = struct.pack("<d", float(start)) if v.kind == "Real" else struct.pack("<q", int(start))
        starts.append(f"0x{struct.unpack('<Q', raw)[0]:x}u")
    lines.append("static const unsigned char slot_code[DCONE_SLOTS] = {" + ",".join(codes) + "};")
    lines.append("static const uint64_t slot_start[DCONE_SLOTS] = {" + ",".join(starts) + "};")
    lines.append("static const struct bound slot_bound[] = {")
    for name, slot, v, _ in rows:
        if v.causality in ("parameter", "input") and v.kind != "Boolean":
            low, high = (_c_number(bound) for bound in (v.minimum, v.maximum))
            entries = [str(slot), low, high, str(int(v.open_minimum)), _c_string(name), _c_string(v.unit)]
            lines.append("    {" + ", ".join(entries) + "},")
    lines.append('    {-1, 0, 0, 0, "", ""}};')
    lines.append("static const struct fault fault_table[] = {")
    for fault in interface.model.faults:
        lines.append(f"    {{{fault.code}, {int(fault.severity == 'discard')}, {_c_string(fault.text)}}},")
    lines.append('    {0, 0, "the kernel gave a fault that is not in its table"}};')
    return "\n".join(lines) + "\n"


def _c_number(value: float) -> str:
    if math.isinf(value):
        return "INFINITY" if value > 0 else "-INFINITY"
    return repr(float(value))


def documentation(interface: Interface, folder: Path) -> str:
    """Documentation page: the model's README and the table of this FMU's variables, as HTML."""
    from markdown_it import MarkdownIt

    text = (folder / "README.md").read_text() if (folder / "README.md").exists() else interface.model.summary
    table = [
        "\n## Variables of this FMU\n",
        "| name | unit | causality | start | meaning |",
        "| --- | --- | --- | --- | --- |",
    ]
    for v in interface.variables:
        if v.at_interface:
            size = "".join(f"[1..{n}]" for n in v.shape[:1]) if v.shape else ""
            start = "" if v.causality == "output" else number(_typed(v, v.starts()[0]))
            name = re.sub(r"\[#\]", "[i]", v.name) + (f" {size}" if size else "")
            table.append(f"| `{name}` | {v.unit} | {v.causality} | {start} | {_sentence(v)} |")
    body: Any = MarkdownIt("commonmark").enable("table").render(text + "\n".join(table))
    head = f'<meta charset="utf-8"><title>{interface.model.name}</title><style>{STYLE}</style>'
    return f"<!DOCTYPE html><html><head>{head}</head><body>{body}</body></html>\n"
