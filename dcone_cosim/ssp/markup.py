"""Names of the format: namespaces, media types, annotations."""

from __future__ import annotations

import re

SSD = "http://ssp-standard.org/SSP1/SystemStructureDescription"
SSC = "http://ssp-standard.org/SSP1/SystemStructureCommon"
SSV = "http://ssp-standard.org/SSP1/SystemStructureParameterValues"
SSM = "http://ssp-standard.org/SSP1/SystemStructureParameterMapping"
OSP = "http://opensimulationplatform.com/SSP/OSPAnnotations"
OMS = "https://raw.githubusercontent.com/OpenModelica/OMSimulator/master/schema/oms.xsd"
OURS = "urn:dcone-cosim:ssp:1"

NAMESPACES = {"ssd": SSD, "ssc": SSC, "ssv": SSV, "osp": OSP, "oms": OMS, "dcone": OURS}
"""Prefixes of what is written; libcosim and ecos know the elements by these."""
READ = {**NAMESPACES, "ssm": SSM}
"""Prefixes for looking things up."""

STRUCTURE = "SystemStructure.ssd"
RESOURCES = "resources"
VERSION = "1.0"

FMU_TYPE = "application/x-fmu-sharedlibrary"
VALUES_TYPE = "application/x-ssp-parameter-set"
MAPPING_TYPE = "application/x-ssp-parameter-mapping"

OSP_TYPE = "com.opensimulationplatform"
OMS_TYPE = "org.openmodelica"
OUR_TYPE = "urn:dcone-cosim"
"""Types of annotations: who reads them."""

PARAMETER_SET = "initialValues"
"""Name of the parameter set; the one that users of libcosim and ecos give at the start."""

TEXT = "String"


def tag(prefix: str, name: str) -> str:
    """An element's name as lxml has it."""
    return f"{{{READ[prefix]}}}{name}"


def plain(text: str) -> str:
    """A name or a message of lxml's as the file has it: prefixes in place of namespaces."""
    prefixes = {uri: f"{prefix}:" for prefix, uri in READ.items()}
    return re.sub(r"{(\w+:[^}]*)}", lambda found: prefixes.get(found[1], ""), text)
