"""syssimx: a system of one FMU component, run in one go; what is looked at comes from its progress callback."""

from __future__ import annotations

import tempfile
import xml.etree.ElementTree as ET
import zipfile
from pathlib import Path

from syssimx import FMUComponent, System

from tests.interop.job import Job, Row, Value, serve


def list_dependencies(description: bytes) -> bytes:
    """The model description with every list of dependencies that it leaves out.

    Left out means all inputs (at the start: and parameters), as FMI allows; syssimx 0.4.3 stops at it with a TypeError.
    """
    root = ET.fromstring(description)
    variables = root.findall("ModelVariables/ScalarVariable")
    for part, known in (("Outputs", ("input",)), ("InitialUnknowns", ("input", "parameter"))):
        everything = [str(i) for i, v in enumerate(variables, 1) if v.get("causality") in known]
        for unknown in root.findall(f"ModelStructure/{part}/Unknown"):
            if unknown.get("dependencies") is None:
                unknown.set("dependencies", " ".join(everything))
    return bytes(ET.tostring(root, encoding="utf-8", xml_declaration=True))


def completed(path: str, folder: Path) -> str:
    """A copy of the FMU with such a description."""
    copy = folder / "completed.fmu"
    with zipfile.ZipFile(path) as old, zipfile.ZipFile(copy, "w") as new:
        for item in old.infolist():
            content = old.read(item)
            new.writestr(item, list_dependencies(content) if item.filename == "modelDescription.xml" else content)
    return str(copy)


def magnitude(value: object) -> Value:
    """The number of a quantity with a unit, or the value itself."""
    bare = getattr(value, "magnitude", value)
    assert isinstance(bare, bool | int | float)
    return bare


def run(job: Job) -> list[Row]:
    with tempfile.TemporaryDirectory() as folder:
        component = FMUComponent("towed", fmu_path=completed(job.fmu, Path(folder)))
        return driven(component, job)


def driven(component: FMUComponent, job: Job) -> list[Row]:
    component._record_history = False  # its records of thousands of outputs would take most of the time
    component.set_parameters(**job.parameters)
    system = System(name="tow")
    system.add_component(component)
    system.initialize(t0=0.0)
    rows: list[Row] = []
    taken = 0

    def between(time: float, end: float) -> None:
        nonlocal taken
        taken += 1
        if taken in job.looks:
            outputs = component.get_outputs()
            rows.append({name: magnitude(outputs[name]) for name in job.outputs})
        if due := job.due(taken):
            component.set_inputs(due)

    component.set_inputs(job.due(0))
    system.run(t0=0.0, tf=job.steps * job.step, dt=job.step, progress=between)
    component.free()
    return rows


if __name__ == "__main__":
    serve("syssimx", run)
