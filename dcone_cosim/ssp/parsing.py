"""Reads the XML of a package.

The schemas of SSP 1.0 say what may stand where, `BEYOND` what of it is not read here: a file that has passed both is
walked without further checks.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

import fmpy.ssp
from lxml import etree

from dcone_cosim.fmu.steppable import NUMBERS
from dcone_cosim.ssp.markup import (
    FMU_TYPE,
    MAPPING_TYPE,
    OMS_TYPE,
    OSP_TYPE,
    OUR_TYPE,
    READ,
    TEXT,
    VALUES_TYPE,
    VERSION,
    plain,
    tag,
)
from dcone_cosim.ssp.package import Mistakes
from dcone_cosim.units import Unit

SCHEMAS = {"ssd": "Description", "ssc": "Common", "ssv": "ParameterValues", "ssm": "ParameterMapping"}
"""Schema of every namespace: `SystemStructure....xsd`, as fmpy brings it."""

BEYOND = {
    "//ssd:Elements/ssd:System": "a system within a system is not read; put its components into the one system",
    "//ssd:SignalDictionaries | //ssd:SignalDictionaryReference": (
        "signal dictionaries are not read; connect the components to one another"
    ),
    "/*/ssd:System/ssd:Connectors/ssd:Connector": (
        "a connector of the system itself is not read; connect and set the components"
    ),
    f"//ssd:Component[@type != '{FMU_TYPE}']": f"type = {{type!r}}; expected an FMU, {FMU_TYPE!r}",
    "//ssd:Component[@implementation = 'ModelExchange']": "implementation = {implementation!r}; expected co-simulation",
    "//ssd:Connector[@kind = 'inout']": "kind = {kind!r}; expected input, output, parameter or calculatedParameter",
    **{
        f"//ssd:Connector[ssc:{kind}] | //ssv:Parameter[ssv:{kind}]": (
            f"the type {kind} is not read; expected {', '.join(NUMBERS)} or {TEXT}"
        )
        for kind in ("Enumeration", "Binary")
    },
    **{
        f"//ssd:Connection[not(@{end}Element)]": (
            f"{end}Connector = {{{end}Connector!r}} is one of the system; name a component as {end}Element"
        )
        for end in ("start", "end")
    },
    "//ssc:*[contains(local-name(), 'MappingTransformation')]": "only a linear transformation is read",
    f"//ssd:ParameterBinding[@type != '{VALUES_TYPE}']": f"type = {{type!r}}; expected {VALUES_TYPE!r}",
    f"//ssd:ParameterMapping[@type != '{MAPPING_TYPE}']": f"type = {{type!r}}; expected {MAPPING_TYPE!r}",
    "//ssd:*[@source and @sourceBase = 'component']": "sourceBase = {sourceBase!r}; expected a file of the package",
    "//ssd:ParameterBinding[not(@source) and not(ssd:ParameterValues/ssv:ParameterSet)]": (
        "neither a source nor a <ssv:ParameterSet> in it"
    ),
    "//ssd:ParameterMapping[not(@source) and not(ssm:ParameterMapping)]": (
        "neither a source nor a <ssm:ParameterMapping> in it"
    ),
    f"//*[self::ssv:ParameterSet or self::ssm:ParameterMapping][@version != '{VERSION}']": (
        f"version = {{version!r}}; expected {VERSION!r}, the one read here"
    ),
}
"""What SSP has and the subset has not: where it stands, and what is said of it, with the values of its attributes."""

BINDING = "ssd:ParameterBindings/ssd:ParameterBinding"


@dataclass(frozen=True)
class Document:
    """A structure; times [s], None where it tells none.

    components, connections    their elements
    bindings                   elements, each with the name of its component, "" for the system; a later one counts more
    ours                       attributes of our own annotation by element
    """

    name: str
    description: str
    components: Mapping[str, etree._Element]
    connections: Sequence[etree._Element]
    bindings: Sequence[tuple[str, etree._Element]]
    units: Mapping[str, Unit]
    start: float | None
    stop: float | None
    step: float | None
    ours: Mapping[str, Mapping[str, str]] = field(default_factory=dict)


def read(content: bytes, file: str, root_name: str, mistakes: Mistakes) -> etree._Element | None:
    """Root of an XML file, such as `ssv:ParameterSet`, that has passed the schema and `BEYOND`; None with mistakes.

    Neither entities nor a document type definition are resolved, and nothing is fetched.
    """
    parser = etree.XMLParser(
        resolve_entities=False, no_network=True, load_dtd=False, remove_comments=True, remove_pis=True
    )
    try:
        root = etree.fromstring(content, parser)
    except etree.XMLSyntaxError as error:
        mistakes.add(file, error.lineno, f"not well-formed XML: {error.msg}")
        return None
    before = len(mistakes.rows)
    if root.getroottree().docinfo.doctype:
        mistakes.add(file, 1, "a document type definition is not read; leave it out")
    elif root.tag != tag(*root_name.split(":")):
        mistakes.add(file, root.sourceline, f"<{plain(root.tag)}> is not the <{root_name}> of SSP {VERSION}")
    elif root.get("version") != VERSION:
        text = f"<{root_name}> has version = {root.get('version')!r}; expected {VERSION!r}, the one read here"
        mistakes.add(file, root.sourceline, text)
    elif not _schema().validate(root):
        for entry in _schema().error_log:
            mistakes.add(file, entry.line, plain(entry.message))
    else:
        for path, text in BEYOND.items():
            for row in root.xpath(path, namespaces=READ):
                name = f" {row.get('name')!r}" if row.get("name") else ""
                mistakes.add(file, row.sourceline, f"<{plain(row.tag)}>{name}: {text.format_map(row.attrib)}")
    return root if len(mistakes.rows) == before else None


@cache
def _schema() -> etree.XMLSchema:
    """All of SSP 1.0 at once, so that a parameter set within a structure is checked with it."""
    folder = Path(fmpy.ssp.__file__).parent / "schema"
    rules = etree.Element("{http://www.w3.org/2001/XMLSchema}schema")
    for prefix, name in SCHEMAS.items():
        at = (folder / f"SystemStructure{name}.xsd").as_uri()
        etree.SubElement(rules, "{http://www.w3.org/2001/XMLSchema}import", namespace=READ[prefix], schemaLocation=at)
    return etree.XMLSchema(rules)


def document(root: etree._Element, file: str, mistakes: Mistakes) -> Document:
    """The structure that a file holds; components of the same name, or none, are noted as mistakes."""
    system = root.find("ssd:System", READ)
    experiment = root.find("ssd:DefaultExperiment", READ)
    components: dict[str, etree._Element] = {}
    bindings = []
    for row in system.iterfind("ssd:Elements/ssd:Component", READ):
        name = row.get("name")
        if components.setdefault(name, row) is not row:
            text = f"<ssd:Component> {name!r}: line {components[name].sourceline} has one of that name"
            mistakes.add(file, row.sourceline, text)
        bindings += [(name, binding) for binding in row.iterfind(BINDING, READ)]
    if not components:
        mistakes.add(file, system.sourceline, "the system holds no component")
    steps = (
        "osp:Algorithm/osp:FixedStepAlgorithm/@baseStepSize",
        "oms:Annotations/oms:SimulationInformation/@fixedStepSize",
    )
    step = annotated(experiment, OSP_TYPE, steps[0])
    ours = root.xpath(f"ssd:Annotations/ssc:Annotation[@type = '{OUR_TYPE}'][1]/dcone:Phase/*", namespaces=READ)
    return Document(
        system.get("name"),
        system.get("description") or root.get("name"),
        components,
        system.findall("ssd:Connections/ssd:Connection", READ),
        [*bindings, *(("", binding) for binding in system.iterfind(BINDING, READ))],
        units(root, file, mistakes),
        decimal(experiment.get("startTime")) if experiment is not None else None,
        decimal(experiment.get("stopTime")) if experiment is not None else None,
        annotated(system, OMS_TYPE, steps[1]) if step is None else step,
        {etree.QName(row).localname: dict(row.attrib) for row in ours},
    )


def linear(row: etree._Element) -> tuple[float, float]:
    """Factor and offset of the linear transformation within an element, 1 and 0 without one."""
    found = row.find("ssc:LinearTransformation", READ)
    return (1.0, 0.0) if found is None else (float(found.get("factor", 1.0)), float(found.get("offset", 0.0)))


def flag(row: etree._Element, name: str) -> bool:
    """An attribute of the type xs:boolean, false where there is none."""
    return row.get(name, "false").strip() in ("true", "1")


def units(root: etree._Element, file: str, mistakes: Mistakes) -> dict[str, Unit]:
    """Units that a structure or a parameter set defines, by name."""
    found = {}
    for base in root.xpath("(ssd:Units | ssv:Units)/ssc:Unit/ssc:BaseUnit", namespaces=READ):
        name = base.getparent().get("name")
        try:
            found[name] = Unit.defined(name, base.attrib)
        except ValueError as error:
            mistakes.add(file, base.sourceline, f"<ssc:Unit> {name!r}: {error}")
    return found


def annotated(row: etree._Element | None, kind: str, path: str) -> float | None:
    """The number at that path in the first annotation of a type, which no schema has checked."""
    if row is None:
        return None
    found = row.xpath(f"ssd:Annotations/ssc:Annotation[@type = '{kind}'][1]/{path}", namespaces=READ)
    return decimal(found[0]) if found else None


def decimal(text: object) -> float | None:
    """A number of an attribute, None when there is none or it is none."""
    try:
        return float(str(text)) if text is not None else None
    except ValueError:
        return None
