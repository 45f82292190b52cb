"""One instance of an FMU driven by variable name, in this process, through fmpy.

Nothing here knows a model: a foreign FMU is as good as ours. Call order: `Archive`, `Component`, `set`, `initialise`,
then `step` with `read`, `set` of inputs and `save`/`restore` in between, at last `close`. All values are SI: an FMU
that counts in other units is converted by its own unit definitions, one that counts in SI is passed through untouched.

An FMU's misbehaviour is a `CallError` with its own words, the instance and the time: a refused call, an output that is
no finite number, an answer promised for later. After a fatal error no further call is made, not even to free it. A call
that changes how this thread computes (see `floating`) is remarked on, and the change is taken back.
"""

from __future__ import annotations

import ctypes
import math
import os
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from types import TracebackType
from typing import Any

import fmpy
import fmpy.fmi1
import fmpy.fmi2 as fmi2

from dcone_cosim.errors import FmuError
from dcone_cosim.fmu.archive import XML, Archive
from dcone_cosim.fmu.floating import Control
from dcone_cosim.fmu.messages import STATUS, Messages
from dcone_cosim.fmu.reading import Reader, straight
from dcone_cosim.fmu.steppable import (
    NUMBERS,
    CallError,
    Readable,
    Row,
    Steppable,
    Terminated,
    VariableInfo,
    output_names,
)

__all__ = [
    "NUMBERS",
    "Archive",
    "CallError",
    "Component",
    "Readable",
    "Reader",
    "Row",
    "Steppable",
    "Terminated",
    "VariableInfo",
    "output_names",
]

SERIAL = "to be serialised"
"""Key under which a state is kept for a moment."""
WHOLE = 2.0**31
"""An Integer of FMI 2.0 stays below it."""


class Component:
    """One instance of an FMU."""

    def __init__(self, archive: Archive, name: str) -> None:
        self.name = name
        self.archive = archive
        self.variables: Mapping[str, VariableInfo] = archive.variables
        self.can_save = archive.can_save
        self.can_vary_step = archive.can_vary_step
        self.can_interpolate = archive.can_interpolate
        self.time = 0.0
        self._states: dict[str, Any] = {}
        self._times: dict[str, float] = {}
        self._steps = 0
        self._steps_of: dict[str, int] = {}
        self._stepping = False
        self._dead = ""
        self._messages = Messages()
        self._fmu: Any = None
        self.control = Control()
        place = os.getcwd()
        try:
            self._fmu = fmi2.FMU2Slave(
                guid=archive.guid,
                unzipDirectory=str(archive.folder),
                modelIdentifier=archive.identifier,
                instanceName=name,
            )
            self.watch("being loaded")
            self._fmu.instantiate(callbacks=self._messages.callbacks(), loggingOn=True)
        except Exception as error:
            os.chdir(place)  # fmpy stays in the binary's folder when that does not load
            raise self._not_instantiated(error) from None
        finally:
            self.watch("fmi2Instantiate")
        self._do_step = straight(self._fmu, "fmi2DoStep", ctypes.c_double, ctypes.c_double, ctypes.c_int)

    def _not_instantiated(self, error: Exception) -> FmuError:
        """Why there is no instance: the loader's words, or the FMU's own."""
        loaded, self._fmu = self._fmu is not None, None
        self._messages.close()
        file = self.archive.path.name
        if not loaded:
            reason = str(error).replace(f"{self.archive.folder}{os.sep}", "")
            return FmuError(f"{self.name}: the binary of {file} cannot be used\n  {reason}")
        said = self._messages.words()
        said += self._strange_guid() if self._messages.silent or "guid" in said.lower() else ""
        return CallError(self.name, " could not be instantiated", said, f"{file}: {error}", "Error")

    def _strange_guid(self) -> str:
        """A word on the commonest reason for no instance: description and binary are of two builds."""
        guid = self.archive.guid
        if guid.encode() in self.archive.library.read_bytes():
            return ""
        return f"; the guid {guid!r} of its {XML} is not in its binary, which may be of another build"

    def reference(self, name: str) -> VariableInfo:
        """The variable of that name; an unknown one is an error that names the nearest."""
        return self.archive.variable(name, self.name)

    def set(self, values: Mapping[str, float]) -> None:
        """Set variables by name, all Reals in one call, then Integers, then Booleans.

        Raises `FmuError` before any of them is set when a value does not fit the kind of its variable.
        """
        numbers = [(info, self._fitting(info, v)) for info, v in ((self.reference(n), v) for n, v in values.items())]
        for kind in NUMBERS:
            chosen = [(info.reference, number) for info, number in numbers if info.kind == kind]
            if chosen:
                self._call(f"set{kind}", [r for r, _ in chosen], [number for _, number in chosen])

    def set_texts(self, texts: Mapping[str, str]) -> None:
        """Set variables of kind String by name."""
        infos = [self.reference(name) for name in texts]
        for info in infos:
            if info.kind != "String":
                raise FmuError(f"{self.name}: {info.name} is a {info.kind}; a text was given")
        if infos:
            self._call("setString", [info.reference for info in infos], list(texts.values()))

    def _fitting(self, info: VariableInfo, value: float) -> float | int:
        """An SI value as the FMU counts it; one that its kind cannot hold is an error."""
        if info.kind == "Real":
            return _own(info, value)
        if info.kind not in NUMBERS:
            raise FmuError(
                f"{self.name}: {info.name} is a {info.kind}; only numbers can be set, and {value!r} was given"
            )
        if not (math.isfinite(value) and value == int(value) and -WHOLE <= value < WHOLE):
            expected = "true or false" if info.kind == "Boolean" else "a whole number of 32 bits"
            raise FmuError(f"{self.name}: {info.name} is of kind {info.kind}; expected {expected}, got {value!r}")
        return int(value) if info.kind == "Integer" else int(value != 0)

    def set_rates(self, rates: Mapping[str, float]) -> None:
        """Let inputs move at these rates [SI/s] over the next step."""
        infos = [self.reference(name) for name in rates]
        numbers = [rate / info.own.factor for info, rate in zip(infos, rates.values(), strict=True)]
        self._call("setRealInputDerivatives", [info.reference for info in infos], [1] * len(infos), numbers)

    def get(self, names: Sequence[str]) -> dict[str, float]:
        reader = self.reader(names)
        return dict(zip(reader.names, reader().tolist(), strict=True))

    def reader(self, names: Sequence[str]) -> Reader:
        return Reader(self, names)

    def initialise(self, start: float, stop: float | None = None) -> None:
        """Take the parameters as set and begin at `start` [s]."""
        self.enter_initialisation(start, stop)
        self.exit_initialisation()

    def enter_initialisation(self, start: float, stop: float | None = None) -> None:
        """Take the parameters as set and prepare to begin at `start` [s]."""
        self.time = start
        self._call("setupExperiment", self.archive.tolerance, start, stop)
        self._call("enterInitializationMode")

    def exit_initialisation(self) -> None:
        """Begin, with what was set meanwhile."""
        self._call("exitInitializationMode")
        self._stepping = True

    def step(self, time: float, size: float) -> None:
        """Advance from `time` by `size` [s]; a step refused is an error with the FMU's own words, never tried again.

        The FMU is told that nobody goes back to before `time`, unless a state of an earlier step is kept: it may throw
        its past away, and some take the word that somebody may go back for the news that somebody has.

        Raises `Terminated` when the FMU says that this is its end.
        """
        self.ready()
        kept = self._steps_of
        no_return = not kept or self._steps <= min(kept.values())
        status = self._do_step(time, size, no_return)
        try:
            if status > fmi2.fmi2Warning:
                raise self._refused(fmpy.fmi1.FMICallException("fmi2DoStep", status), time, size)
        finally:
            if changed := self.control.changed():
                self.remark(changed, "fmi2DoStep")
        if self._messages.late:
            raise self._asynchronous("it called stepFinished", time, size)
        self.time = time + size
        self._steps += 1

    def save(self, key: str = "") -> None:
        """Keep the present state, replacing the one kept before under this key."""
        self.ready()
        state = self._states.setdefault(key, fmi2.fmi2FMUstate())
        try:
            self._fmu.fmi2GetFMUstate(self._fmu.component, ctypes.byref(state))
        except fmpy.fmi1.FMICallException as error:
            raise self._error(error) from None
        finally:
            self.watch("fmi2GetFMUstate")
        self._times[key], self._steps_of[key] = self.time, self._steps

    def restore(self, key: str = "") -> None:
        """Go back to the state kept last under this key."""
        self._call("setFMUstate", self._states[key])
        self.time, self._steps = self._times[key], self._steps_of[key]

    def release(self, key: str = "") -> None:
        """Nobody goes back to what was kept under this key any more."""
        state = self._states.pop(key, None)
        if state is not None:
            del self._times[key], self._steps_of[key]
            self._call("freeFMUstate", state)

    def as_kept(self) -> dict[str, Any]:
        """The present state as bytes, for an instance of another process."""
        self.save(SERIAL)
        data: bytes = self._call("serializeFMUstate", self._states[SERIAL])
        self.release(SERIAL)
        return {"state": data, "time": self.time}

    def take_up(self, kept: Mapping[str, Any]) -> None:
        """Be in a state that `as_kept` gave; this instance must have begun."""
        state = self._call("deSerializeFMUstate", kept["state"])
        self._call("setFMUstate", state)
        self._call("freeFMUstate", state)
        self.time = float(kept["time"])

    def reset(self) -> None:
        """Back to how it was when it was made: every variable at its start value, no state kept, to be set and
        initialised anew. Its texts too are those that it starts with."""
        for key in list(self._states):
            self.release(key)
        self._call("reset")
        self._stepping = False
        self.time, self._steps = 0.0, 0

    def state_size(self) -> int:
        """Bytes of a serialised state: what an instance holds."""
        self.save()
        size = ctypes.c_size_t()
        self._fmu.fmi2SerializedFMUstateSize(self._fmu.component, self._states[""], ctypes.byref(size))
        self.release()
        return size.value

    def close(self) -> None:
        """Free the instance; one that is dead is left where it is, since no call may be made to it."""
        fmu, self._fmu = self._fmu, None
        if fmu is None:
            return
        if not self._dead:
            with suppress(fmpy.fmi1.FMICallException):
                for state in self._states.values():
                    fmu.freeFMUstate(state)
                if self._stepping:
                    fmu.terminate()
            fmu.freeInstance()
            self.watch("fmi2FreeInstance")
        self._messages.close()

    def __enter__(self) -> Component:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self.close()

    def ready(self) -> None:
        """Before a call: forget what was said during others, and refuse any after a fatal error."""
        self._messages.forget()
        if self._dead:
            raise CallError(self.name, " takes no further call", self._dead, self.archive.path.name, "Fatal")
        if self._fmu is None:
            raise FmuError(f"{self.name}: the instance is closed")

    def _call(self, function: str, *arguments: Any, **named: Any) -> Any:
        self.ready()
        try:
            return getattr(self._fmu, function)(*arguments, **named)
        except fmpy.fmi1.FMICallException as error:
            raise self._error(error) from None
        finally:
            self.watch(f"fmi2{function[0].upper()}{function[1:]}")

    def watch(self, call: str) -> None:
        """After a call: take back what it changed in how this thread computes, and remark on it."""
        if changed := self.control.changed():
            self.remark(changed, call)

    def remark(self, changed: str, call: str) -> None:
        """Note that a call changed how this thread computes."""
        self.archive.remark(
            f"{self.name}: {self.archive.path.name} changed {changed} in {call}; this was taken back, so that "
            "what is computed elsewhere keeps its bits"
        )

    def getter(self, kind: str) -> Callable[[int, int, int], int]:
        """fmi2GetReal or its like: of the addresses of references and of what is read, and how many between them."""
        return straight(self._fmu, f"fmi2Get{kind}", ctypes.c_void_p, ctypes.c_size_t, ctypes.c_void_p)

    def refusal(self, function: str, status: int) -> CallError:
        """What a call becomes that gave a status worse than a warning."""
        return self._error(fmpy.fmi1.FMICallException(function, status))

    def _error(self, error: Any, where: str = "", reached: float | None = None, end: bool = False) -> CallError:
        """What a refused call becomes. `where`: what was asked; without it, the time stands there."""
        status = STATUS[error.status] if error.status in range(len(STATUS)) else f"status {error.status}"
        said = self._messages.words()
        if status not in ("Discard", "Warning"):
            self._stepping = False
        if status in ("Fatal", "Pending"):
            self._dead = f"it ended in a fatal error at t = {self.time:.9g} s: {said}"
        detail = f"{self.archive.path.name}: {error.function} gave {status}"
        kind = Terminated if end else CallError
        return kind(self.name, where or f" at t = {self.time:.9g} s", said, detail, status, reached)

    def _refused(self, error: Any, time: float, size: float) -> CallError:
        """What a refused step becomes; a discarded one is asked how far it came, and whether this is the end."""
        reached, ended = None, False
        if error.status == fmi2.fmi2Discard:
            with suppress(Exception):
                reached = float(self._fmu.getRealStatus(fmi2.fmi2LastSuccessfulTime))
            with suppress(Exception):
                ended = bool(self._fmu.getBooleanStatus(fmi2.fmi2Terminated))
            if reached is not None and not time <= reached <= time + size * (1.0 + 1e-9):
                reached = None
        elif error.status == fmi2.fmi2Pending:
            return self._asynchronous("fmi2DoStep gave Pending", time, size)
        if ended:
            self.time = time if reached is None else reached
            return self._error(error, f" ended itself at t = {self.time:.9g} s", self.time, end=True)
        got = "" if reached is None else f", got at {reached:.9g} s"
        return self._error(error, f" stopped at t = {time:.9g} s in a step of {size:.6g} s{got}", reached)

    def _asynchronous(self, how: str, time: float, size: float) -> CallError:
        """An answer promised for later. A step that may still be running leaves nothing to call."""
        said = "it answers its steps later; this master takes only FMUs whose step is over when it returns"
        self._dead = said
        where = f" at t = {time:.9g} s in a step of {size:.6g} s"
        return CallError(self.name, where, said, f"{self.archive.path.name}: {how}", "Pending")

    def not_finite(self, info: VariableInfo, value: float) -> CallError:
        """The error for an output that is no finite number."""
        said = f"its output {info.name} is {value}, which is not a finite number"
        return CallError(self.name, f" at t = {self.time:.9g} s", said, self.archive.path.name)


def _own(info: VariableInfo, value: float) -> float:
    """An SI value as the FMU counts it."""
    return info.own.from_si(float(value))
