"""The FMUs that are tried, and one of them driven by variable name through fmpy."""

from ctypes import byref
from pathlib import Path

from fmpy import calloc, free, read_model_description
from fmpy.fmi2 import (
    FMU2Slave,
    fmi2CallbackAllocateMemoryTYPE,
    fmi2CallbackFreeMemoryTYPE,
    fmi2CallbackFunctions,
    fmi2CallbackLoggerTYPE,
)
from fmpy.logging import addLoggerProxy

from tests.conftest import CAPTURE

REMOVAL = {"reel": "locked", "thrust": "along_track"}
CASES = {
    "net_capture": (CAPTURE, {"net.mesh": 2.0, "closing.time": 9.0, "target.start_rate[1]": 0.02}, 0.25, 60),
    "tethered_deorbit": (REMOVAL, {"tether.damping_ratio": 0.05, "thrust.level": -0.01}, 60.0, 70),
}
TERMS = {**{name: case[0] for name, case in CASES.items()}, "reel_control": {}}
"""Every FMU that the tests of this folder may ask for, and its terms."""
VARIANTS = {
    "removal, linear": ("tethered_deorbit", {"reel": "linear", "thrust": "tether"}),
    "removal, commanded": ("tethered_deorbit", {"reel": "commanded", "thrust": "along_track"}),
    "reel control, motor": ("reel_control", {"motor": "lag"}),
}
"""More of them, each a model with other terms."""
SMALL = {
    "net_capture": (
        CAPTURE,
        {"net.mesh": 6.0, "net.youngs_modulus": 7e6, "closing.axial_stiffness": 9.0, "closing.time": 0.1},
        0.05,
    ),
    "tethered_deorbit": (REMOVAL, {"thrust.level": -0.5, "start.separation": 11.9}, 20.0),
    "reel_control": ({}, {"reel.length": 11.0, "gain.derivative": 1.0, "length": 12.5, "length_rate": 0.01}, 1.0),
}
"""Terms, parameters and macro step of a short life: for what is done thousands of times, or under valgrind."""

SHORT = {
    "net_capture": (
        CAPTURE,
        {
            "bullets.speed": 12.0,
            "chaser.start_position[2]": -2.5,
            "net.side": 4.0,
            "net.mesh": 1.0,
            "net.youngs_modulus": 7e6,
            **{f"target.size[{axis}]": 1.0 for axis in (1, 2, 3)},
            "target.start_rate[1]": 0.02,
            "closing.time": 0.2,
            "closing.speed": 20.0,
            "closing.stall_force": 50.0,
            "closing.axial_stiffness": 9.0,
        },
        0.05,
        12,
        {"thread.tension_max": 1.0, "contact.impulse": 1.0, "closed": 0},
    ),
    "tethered_deorbit": (
        REMOVAL, {"thrust.level": -0.5, "start.separation": 11.9, "tether.damping_ratio": 0.05}, 20.0, 12,
        {"tether.tug_count": 1, "solver.steps": 20},
    ),
}  # fmt: skip
"""Terms, parameters, macro step and count of a life in which all happens within moments, and outputs that say so."""


def library_of(folder):
    """Path of the FMU's library for this machine, in its unpacked folder."""
    (path,) = Path(folder).glob("binaries/linux64/*.so")
    return str(path)


class Driven:
    """An FMU driven by variable name; `messages` holds what it said.

    parameters   set before it is initialised at time 0; None leaves it just instantiated
    """

    def __init__(self, path, folder, parameters):
        self.description = read_model_description(str(path))
        self.variables = {v.name: v for v in self.description.modelVariables}
        self.slave = FMU2Slave(
            guid=self.description.guid,
            unzipDirectory=folder,
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName="tested",
        )
        self.messages = []
        self._hear = fmi2CallbackLoggerTYPE(self._keep)
        self._callbacks = fmi2CallbackFunctions()
        self._callbacks.logger = self._hear
        self._callbacks.allocateMemory = fmi2CallbackAllocateMemoryTYPE(calloc)
        self._callbacks.freeMemory = fmi2CallbackFreeMemoryTYPE(free)
        addLoggerProxy(byref(self._callbacks))
        self.slave.instantiate(callbacks=self._callbacks, loggingOn=False, visible=False)
        self.time = 0.0
        if parameters is not None:
            self.set(parameters)
            self.initialise()

    def _keep(self, _environment, _name, _status, _category, message):
        self.messages.append(message.decode())

    def initialise(self):
        self.slave.setupExperiment(startTime=0.0)
        self.slave.enterInitializationMode()
        self.slave.exitInitializationMode()

    def set(self, values):
        for name, value in values.items():
            v = self.variables[name]
            getattr(self.slave, "set" + v.type)([v.valueReference], [value])

    def outputs(self):
        rows = {}
        for kind in ("Real", "Integer", "Boolean"):
            chosen = [v for v in self.variables.values() if v.causality == "output" and v.type == kind]
            values = getattr(self.slave, "get" + kind)([v.valueReference for v in chosen])
            rows |= {v.name: value for v, value in zip(chosen, values, strict=True)}
        return rows

    def step(self, size):
        self.slave.doStep(self.time, size)
        self.time += size
