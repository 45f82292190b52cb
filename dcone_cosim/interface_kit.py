"""What `dcone interface` gives: the interface of a phase's FMU as a table, and an empty FMU to begin with.

The C template is a table of variables, three functions to fill in, and an FMI 2.0 co-simulation interface in C99; the
Python template is a script for PythonFMU. Both are working examples that a scene can run as they are.
"""

from __future__ import annotations

import re
import uuid
import xml.etree.ElementTree as ET
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from dcone_cosim import placed
from dcone_cosim.build import shared_with_template
from dcone_cosim.contract import NEEDS, TUG_PREFIX, Asked, asked
from dcone_cosim.drafts import atomic_folder
from dcone_cosim.errors import InputError
from dcone_cosim.names import did_you_mean
from dcone_cosim.phases import kinds
from dcone_cosim.scratch import Scratch, clear_left
from dcone_cosim.units import by_name

if TYPE_CHECKING:
    from rich.console import Console

TEMPLATES = Path(__file__).parent / "templates"
TEMPLATE_KINDS = ("c", "pythonfmu")
_TEMPLATE_HAS = (
    *("t_capture", "outcome", "separation", "relative.position", "relative.velocity"),
    *("tether.rest_length", "target.attachment_distance", "thrust.level"),
)
"""Optional variables that the templates have, beside all that is needed for something; their target is a point."""
LOG_CATEGORIES = (
    ("logStatusError", "why a call was refused, or the model failed"),
    ("logStatusDiscard", "why a step was discarded, or that the model came to its end"),
    ("logStatusWarning", "what is to be taken with care"),
    ("logEvents", "what the model says with status fmi2OK"),
    ("logAll", "all of these"),
)
"""What fmu.c of the C template sorts its messages into."""


def show(phase: str, console: Console) -> None:
    """Print name, type, unit, causality and meaning of what a phase asks of its FMU, arrays in one line."""
    from rich.table import Table
    from rich.text import Text

    _known("phase", phase, list(kinds()))
    title = Text(f"What the master looks for in the FMU of the {phase}", style="table.title")
    table = Table(title=title, title_justify="left", box=None, pad_edge=False)
    for header in ("name", "type", "unit", "causality"):
        table.add_column(header, no_wrap=True)
    for header in ("needed", "meaning"):
        table.add_column(header, overflow="fold")
    for name, row in _by_array(asked(kinds()[phase])):
        cells = (name, row.kind, row.unit, row.causality, NEEDS[row.need], row.meaning)
        table.add_row(*(Text(cell) for cell in cells))
    console.print(table, width=None if console.is_terminal else 200)
    console.print(
        "Another unit of the same dimension may be declared: values are converted by the FMU's own definition."
    )
    console.print("Every instant it tells counts from its own start, whatever time it is told to start at.")
    if any(row.name.startswith(TUG_PREFIX) for row in asked(kinds()[phase])):
        console.print("tug[1..n] is a ring of the latest tugs, newest first, as long as the FMU likes.")


def _by_array(rows: Sequence[Asked]) -> Iterator[tuple[str, Asked]]:
    """The rows with the elements of an array as one: `chaser.position[1..3]`."""
    grouped: dict[tuple[str, str], list[Asked]] = {}
    for row in rows:
        grouped.setdefault((re.sub(r"\[\d+\]", "[#]", row.name), row.need), []).append(row)
    for (name, _), group in grouped.items():
        if "#" in name:
            last = re.findall(r"\[(\d+)\]", group[-1].name)
            count = "n" if name.startswith("tug[") else last[-1]
            name = name.replace("#", f"1..{count}")
        yield name, group[0]


def write_template(phase: str, kind: str, folder: Path) -> list[Path]:
    """Write an empty FMU of a phase into a folder that is new or empty; returns the files."""
    _known("phase", phase, [name for name in kinds() if (TEMPLATES / "c" / f"{name}.c").is_file()])
    _known("template", kind, TEMPLATE_KINDS)
    for left in (folder.absolute().parent, folder):
        clear_left(left)
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise InputError(f"{folder} already exists; a template is written to a new or an empty folder")
    rows = [r for r in asked(kinds()[phase]) if r.need not in ("spin", "optional") or r.name.startswith(_TEMPLATE_HAS)]
    content = _c_files(phase, rows) if kind == "c" else _python_files(phase, rows)
    if folder.exists():  # somebody may be in it: it stays, and the files come into it
        with Scratch(folder) as draft:
            _fill(draft, content)
            return [placed.put(draft / name, folder / name) for name in content]
    with atomic_folder(folder) as whole:
        _fill(whole.path, content)
    return [whole.folder / name for name in content]


def _fill(folder: Path, content: Mapping[str, str]) -> None:
    for name, text in content.items():
        (folder / name).write_text(text, encoding="utf-8")


def _known(what: str, given: str, known: Sequence[str]) -> None:
    if given not in known:
        raise InputError(f"no {what} named {given!r}{did_you_mean(given, known)}; expected {' or '.join(known)}")


def _number(row: Asked) -> str:
    if row.kind == "Boolean":
        return "true" if row.start else "false"
    return repr(row.start) if row.kind == "Real" else str(int(row.start))


def _c_files(phase: str, rows: Sequence[Asked]) -> dict[str, str]:
    model = f"my_{phase}"
    guid = str(uuid.uuid5(uuid.NAMESPACE_URL, model + "".join(row.name for row in rows)))
    files = {}
    for name in ("fmu.c", "model.h", "CMakeLists.txt", "README.md"):
        text = (TEMPLATES / "c" / name).read_text(encoding="utf-8")
        files[name] = text.replace("@MODEL@", model).replace("@PHASE@", phase)
    files |= shared_with_template()
    places = [_constant(row.name) for row in rows]
    lines = [
        f"/* The model of {model}. The table of variables: the place of a row is its value reference. */",
        "",
        '#include "model.h"',
        "",
        "#include <math.h>",
        "",
        f'const char *const model_guid = "{guid}";',
        "",
        "enum {",
        *(f"    {place}," for place in places),
        "    VARIABLES",
        "};",
        "",
        "const struct variable model_table[] = {",
    ]
    for row, place in zip(rows, places, strict=True):
        start = repr(row.start) if row.causality != "output" else "0.0"
        unit = "" if row.unit == "1" else f"[{row.unit}] "
        note = f"{unit}{row.meaning}".replace("*/", "* /")
        lines.append(f"    /* {note} */")
        lines.append(f'    [{place}] = {{"{row.name}", {row.kind.upper()}, {row.causality.upper()}, {start}}},')
    lines += ["};", "", "const size_t model_variables = VARIABLES;", ""]
    body = (TEMPLATES / "c" / f"{phase}.c").read_text(encoding="utf-8")
    return {
        "model.c": "\n".join(lines) + "\n" + body,
        "modelDescription.xml": _model_description(phase, model, guid, rows),
        **files,
    }


def _constant(name: str) -> str:
    """Name of a variable as a C constant: `chaser.position[1]` is CHASER_POSITION_1."""
    return re.sub(r"\W+", "_", name).strip("_").upper()


def _model_description(phase: str, model: str, guid: str, rows: Sequence[Asked]) -> str:
    root = ET.Element(
        "fmiModelDescription",
        fmiVersion="2.0",
        modelName=model,
        guid=guid,
        description=f"FMU for the {phase} phase, to be filled in",
        variableNamingConvention="structured",
        numberOfEventIndicators="0",
    )
    ET.SubElement(
        root,
        "CoSimulation",
        modelIdentifier=model,
        canHandleVariableCommunicationStepSize="true",
        canGetAndSetFMUstate="true",
        canSerializeFMUstate="true",
        canNotUseMemoryManagementFunctions="true",
    )
    units = ET.SubElement(root, "UnitDefinitions")
    for name in sorted({row.unit for row in rows if row.unit != "1"}):
        ET.SubElement(ET.SubElement(units, "Unit", name=name), "BaseUnit", by_name(name).definition)
    categories = ET.SubElement(root, "LogCategories")
    for category, sorted_in in LOG_CATEGORIES:
        ET.SubElement(categories, "Category", name=category, description=sorted_in)
    variables = ET.SubElement(root, "ModelVariables")
    for place, row in enumerate(rows):
        about = {"name": row.name, "valueReference": str(place), "description": row.meaning, "causality": row.causality}
        if row.causality == "output":
            about |= {"variability": "continuous" if row.kind == "Real" else "discrete", "initial": "calculated"}
        else:
            about |= {"variability": "fixed", "initial": "exact"}
        typed = {"unit": row.unit} if row.unit != "1" else {}
        if row.causality != "output":
            typed["start"] = _number(row)
        ET.SubElement(ET.SubElement(variables, "ScalarVariable", about), row.kind, typed)
    structure = ET.SubElement(root, "ModelStructure")
    for tag in ("Outputs", "InitialUnknowns"):
        element = ET.SubElement(structure, tag)
        for index, row in enumerate(rows, start=1):
            if row.causality == "output":
                ET.SubElement(element, "Unknown", index=str(index))
    ET.indent(root)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ET.tostring(root, encoding="unicode") + "\n"


_SCRIPT = '''"""An FMU for the {phase} phase, to be filled in. Build: pythonfmu build -f {file}"""

from functools import partial

from pythonfmu import Boolean, Fmi2Causality, Fmi2Slave, Fmi2Variability, Integer, Real

# name, type, causality, start; all values are SI: PythonFMU declares no units
VARIABLES = (
{table}
)


class {name}(Fmi2Slave):
{body}
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.time = 0.0
        self.values = {{name: start for name, _, _, start in VARIABLES}}
        for name, kind, causality, _ in VARIABLES:
            variability = "fixed" if causality == "parameter" else "continuous" if kind is Real else "discrete"
            about = {{"causality": Fmi2Causality[causality], "variability": Fmi2Variability[variability]}}
            ways = {{
                "getter": partial(self.values.__getitem__, name),
                "setter": partial(self.values.__setitem__, name),
            }}
            self.register_variable(kind(name, **about, **ways), nested=False)

    def setup_experiment(self, start_time, stop_time, tolerance):
        self.time = start_time

    def exit_initialization_mode(self):
        self.begin(self.values, self.time)

    def do_step(self, current_time, step_size):
        self.advance(self.values, current_time, step_size)
        return True
'''


def _python_files(phase: str, rows: Sequence[Asked]) -> dict[str, str]:
    table = []
    for row in rows:
        start = {"Real": repr(row.start), "Integer": str(int(row.start)), "Boolean": str(bool(row.start))}[row.kind]
        unit = "" if row.unit == "1" else f"[{row.unit}] "
        table.append(f'    ("{row.name}", {row.kind}, "{row.causality}", {start}),  # {unit}{row.meaning}')
    body = (TEMPLATES / "pythonfmu" / f"{phase}.txt").read_text(encoding="utf-8")
    name, file = f"My{phase.capitalize()}", f"my_{phase}.py"
    return {file: _SCRIPT.format(phase=phase, file=file, table="\n".join(table), name=name, body=body)}
