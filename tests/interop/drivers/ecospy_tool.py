"""ecospy: a simulation structure of one model, with a parameter set.

Its native library wants libtbb.so.12, which PyPI's `tbb` puts into the environment's `lib`: loaded first, for all.
"""

from __future__ import annotations

import ctypes
import sys
from importlib.metadata import files
from pathlib import Path

from tests.interop.job import Job, Row, serve


def load_tbb() -> None:
    for file in files("tbb") or ():
        if file.name == "libtbb.so.12":
            ctypes.CDLL(str(Path(str(file.locate())).resolve()), mode=ctypes.RTLD_GLOBAL)
            return
    raise RuntimeError("the package tbb holds no libtbb.so.12")


def run(job: Job) -> list[Row]:
    from ecospy import EcosLib, EcosSimulation, EcosSimulationStructure

    EcosLib.set_log_level("warn")
    with EcosSimulationStructure() as structure:
        structure.add_model("towed", job.fmu)
        structure.add_parameter_set("given", {f"towed::{name}": value for name, value in job.parameters.items()})
        with EcosSimulation(structure=structure, step_size=job.step) as simulation:
            if not simulation.init(parameter_set="given"):
                raise RuntimeError(EcosLib.get_last_error())
            setters = {"Real": simulation.set_real, "Integer": simulation.set_integer, "Boolean": simulation.set_bool}
            getters = {"Real": simulation.get_real, "Integer": simulation.get_integer, "Boolean": simulation.get_bool}
            rows = []
            for i in range(job.steps):
                for name, value in job.due(i).items():
                    setters[job.kinds[name]](f"towed::{name}", value)
                simulation.step()
                if i + 1 in job.looks:
                    rows.append({name: getters[job.kinds[name]](f"towed::{name}") for name in job.outputs})
            simulation.terminate()
    return rows


if __name__ == "__main__":
    if sys.platform == "linux":
        load_tbb()
    serve("ecospy", run)
