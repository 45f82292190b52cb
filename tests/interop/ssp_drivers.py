"""Other tools running a package of ours, each as its users run it; what its outputs were goes to a file.

    python -m tests.interop.ssp_drivers TOOL PACKAGE COMPONENT STEP STEPS START RESULT.npz

One process per tool and package: some keep their library loaded, write to stdout, or end the process on a fault.
"""

from __future__ import annotations

import ctypes
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
from lxml import etree


def outputs(package: str, component: str) -> dict[str, str]:
    """Kind of every output connector of a component."""
    with zipfile.ZipFile(package) as archive:
        root = etree.fromstring(archive.read("SystemStructure.ssd"))
    found = {}
    for row in root.iter("{*}Component"):
        if row.get("name") == component:
            for port in row.iter("{*}Connector"):
                if port.get("kind") == "output":
                    found[port.get("name")] = etree.QName(port[0]).localname
    return found


def ecos(package: str, component: str, step: float, steps: int, start: float) -> dict[str, np.ndarray]:
    """Its clock begins at 0 whatever start it is told, so it is told none.

    It gives one value a call, so thousands of outputs are read at every tenth point alone; the rest is not told.
    """
    for library in Path(sys.prefix, "lib").glob("libtbb.so.*"):
        ctypes.CDLL(str(library), mode=ctypes.RTLD_GLOBAL)
    from ecospy import EcosSimulation

    kinds = outputs(package, component)
    every = 10 if len(kinds) > 1000 else 1
    rows = np.full((steps + 1, len(kinds)), np.nan)
    with EcosSimulation(ssp_path=package, step_size=step) as simulation:
        get = {"Real": simulation.get_real, "Integer": simulation.get_integer, "Boolean": simulation.get_bool}
        assert simulation.init(parameter_set="initialValues")
        for i in range(steps + 1):
            if i:
                simulation.step(1)
            if i % every == 0:
                rows[i] = [get[kind](f"{component}::{name}") for name, kind in kinds.items()]
        simulation.terminate()
    return dict(zip(kinds, rows.T, strict=True))


def libcosim(package: str, component: str, step: float, steps: int, start: float) -> dict[str, np.ndarray]:
    """Start and step size are those of the package; before the first step its observer has nothing."""
    from libcosimpy.CosimEnums import CosimVariableType
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimObserver import CosimObserver

    execution = CosimExecution.from_ssp_file(ssp_path=package)
    observer = CosimObserver.create_last_value()
    execution.add_observer(observer)
    index = execution.slave_index_from_instance_name(component)
    variables = {v.name.decode(): v for v in execution.slave_variables(index)}
    get = {
        CosimVariableType.REAL.value: observer.last_real_values,
        CosimVariableType.INTEGER.value: observer.last_integer_values,
        CosimVariableType.BOOLEAN.value: observer.last_boolean_values,
    }
    names = list(outputs(package, component))
    kinds = {kind: [name for name in names if int(variables[name].type) == kind] for kind in get}
    rows = [[np.nan] * len(names)]
    for _ in range(steps):
        assert execution.step(1)
        row = {}
        for kind, own in kinds.items():
            row |= zip(own, get[kind](index, [variables[name].reference for name in own]), strict=True)
        rows.append([row[name] for name in names])
    return dict(zip(names, np.array(rows, dtype=float).T, strict=True))


def fmpy(package: str, component: str, step: float, steps: int, start: float) -> dict[str, np.ndarray]:
    """It takes its parameter set from the caller, under the names of the whole system, and tells no first row."""
    from fmpy.ssp.simulation import simulate_ssp
    from fmpy.ssp.ssd import read_ssd

    values = read_ssd(package).system.elements[0].parameterBindings[0].parameterValues[0]
    for parameter in values.parameters:
        parameter.name = f"{component}.{parameter.name}"
    stop = start + (steps - 0.5) * step
    rows = simulate_ssp(package, start_time=start, stop_time=stop, step_size=step, parameter_set=values)
    assert len(rows) == steps
    return {n: np.append(np.nan, rows[f"{component}.{n}"].astype(float)) for n in outputs(package, component)}


def container(package: str, component: str, step: float, steps: int, start: float) -> dict[str, np.ndarray]:
    """fmu-manipulation-toolbox: the FMUs and connections of the package in an FMU container, which fmpy runs.

    The container begins before the connections have carried anything, so its first row is not told.
    """
    from fmpy import simulate_fmu

    with zipfile.ZipFile(package) as archive, tempfile.TemporaryDirectory() as name:
        root = etree.fromstring(archive.read("SystemStructure.ssd"))
        names = [row.get("name") for row in root.iter("{*}Component")]
        for row in names:
            Path(name, f"{row}.fmu").write_bytes(archive.read(f"resources/{row}.fmu"))
        links = [
            f"LINK;{c.get('startElement')}.fmu;{c.get('startConnector')};{c.get('endElement')}.fmu;{c.get('endConnector')}"
            for c in root.iter("{*}Connection")
        ]
        shown = [f"OUTPUT;{component}.fmu;{port};;{port}" for port in outputs(package, component)]
        rules = ["rule;from_fmu;from_port;to_fmu;to_port", *(f"FMU;{row}.fmu;;;" for row in names), *links, *shown]
        Path(name, "pair.csv").write_text("\n".join(rules) + "\n")
        program = "from fmu_manipulation_toolbox.cli.fmucontainer import fmucontainer as f; f()"
        options = ["-container", f"pair.csv:{step!r}", "-fmu-directory", name, "-auto-parameter"]
        subprocess.run([sys.executable, "-c", program, *options], check=True, stdout=subprocess.DEVNULL)
        values = {
            f"{part.get('name')}.{value.get('name')}": float(value[0].get("value"))
            for part in root.iter("{*}Component")
            for value in part.iter("{*}Parameter")
        }
        found = simulate_fmu(
            str(Path(name, "pair.fmu")),
            stop_time=steps * step,
            output_interval=step,
            start_values=values,
            output=list(outputs(package, component)),
        )
    assert len(found) == steps + 1
    columns = {port: found[port].astype(float) for port in outputs(package, component)}
    return {port: np.append(np.nan, column[1:]) for port, column in columns.items()}


TOOLS: dict[str, Callable[..., dict[str, np.ndarray]]] = {
    "ecos": ecos,
    "libcosim": libcosim,
    "fmpy": fmpy,
    "container": container,
}


if __name__ == "__main__":
    tool, package, component, step, steps, start, result = sys.argv[1:]
    np.savez(result, **TOOLS[tool](package, component, float(step), int(steps), float(start)))
