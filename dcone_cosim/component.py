"""One FMU driven by variable name, through fmpy and its modelDescription alone.

An `Archive` is an FMU unpacked once; it makes `Component`s, its instances. Nothing here knows a model: a foreign FMU is
as good as ours. Call order: `Archive`, `instantiate`, `set`, `initialise`, then `step` with `read`, `set` of inputs and
`save`/`restore` in between, at last `close`.
"""

from __future__ import annotations

import ctypes
import hashlib
import itertools
import shutil
from collections import deque
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from types import TracebackType
from typing import Any, Protocol

import fmpy
import fmpy.fmi1
import fmpy.fmi2 as fmi2
import numpy as np
import numpy.typing as npt
from fmpy.logging import addLoggerProxy

from dcone_cosim.errors import FmuError
from dcone_cosim.names import did_you_mean

Row = npt.NDArray[np.float64]
STATUS = ("OK", "Warning", "Discard", "Error", "Fatal", "Pending")
KINDS = ("Real", "Integer", "Boolean")


@dataclass(frozen=True)
class VariableInfo:
    """What the model description says of one scalar variable."""

    name: str
    reference: int
    kind: str
    unit: str
    causality: str
    description: str


class Readable(Protocol):
    """Fetches the same variables again and again; `values` is overwritten by each call."""

    names: tuple[str, ...]
    values: Row

    def __call__(self) -> Row: ...


class Steppable(Protocol):
    """What the master asks of a component. All values are SI.

    can_save          its state can be kept and restored, under several keys at a time
    can_interpolate   it takes input derivatives
    """

    name: str
    variables: Mapping[str, VariableInfo]
    can_save: bool
    can_interpolate: bool

    def set(self, values: Mapping[str, float]) -> None: ...
    def set_rates(self, rates: Mapping[str, float]) -> None: ...
    def get(self, names: Sequence[str]) -> dict[str, float]: ...
    def reader(self, names: Sequence[str]) -> Readable: ...
    def enter_initialisation(self, start: float, stop: float | None = None) -> None: ...
    def exit_initialisation(self) -> None: ...
    def step(self, time: float, size: float) -> None: ...
    def save(self, key: str = "") -> None: ...
    def restore(self, key: str = "") -> None: ...
    def close(self) -> None: ...


# fmpy's proxy formats the variadic message in C and hands it to one Python function per process; the environment
# pointer tells the instances apart.
_messages: dict[int, deque[tuple[int, str]]] = {}
_environment = itertools.count(1)


def _log(environment: int | None, instance: bytes, status: int, category: bytes, message: bytes) -> None:
    kept = _messages.get(environment or 0)
    if kept is None:
        fmpy.fmi1.printLogMessage(environment, instance, status, category, message)
    else:
        kept.append((status, message.decode("utf-8", "replace").strip()))


_callbacks = fmi2.fmi2CallbackFunctions()
_callbacks.logger = fmi2.fmi2CallbackLoggerTYPE(_log)
_callbacks.allocateMemory = fmi2.fmi2CallbackAllocateMemoryTYPE(fmpy.calloc)
_callbacks.freeMemory = fmi2.fmi2CallbackFreeMemoryTYPE(fmpy.free)
addLoggerProxy(ctypes.byref(_callbacks))


class CallError(FmuError):
    """A call that an FMU refused.

    said      the FMU's own words
    detail    the call, its status and the FMU's file
    """

    def __init__(self, name: str, where: str, said: str, detail: str) -> None:
        super().__init__(f"{name}{where}:\n  {said}\n  ({detail})")
        self.said = said
        self.detail = detail


class Archive:
    """An FMU file, unpacked to a temporary folder that `close` removes."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.folder: Path | None = None
        try:
            self.folder = Path(fmpy.extract(str(path)))
            self.description: Any = fmpy.read_model_description(str(self.folder), validate=False)
        except Exception as error:
            self.close()
            raise FmuError(f"{path}: not a readable FMU ({error})") from error
        if self.description.fmiVersion != "2.0" or self.description.coSimulation is None:
            version = self.description.fmiVersion
            self.close()
            raise FmuError(f"{path}: expected an FMI 2.0 co-simulation unit, this is FMI {version}")
        self.variables: dict[str, VariableInfo] = {
            v.name: VariableInfo(
                v.name, int(v.valueReference), v.type, v.unit or "1", v.causality or "local", v.description or ""
            )
            for v in self.description.modelVariables
        }

    @cached_property
    def sha256(self) -> str:
        return hashlib.sha256(self.path.read_bytes()).hexdigest()

    @property
    def guid(self) -> str:
        return str(self.description.guid)

    def instantiate(self, name: str) -> Component:
        return Component(self, name)

    def close(self) -> None:
        if self.folder is not None:
            shutil.rmtree(self.folder, ignore_errors=True)
            self.folder = None

    def __enter__(self) -> Archive:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self.close()


class Component:
    """One instance of an FMU."""

    def __init__(self, archive: Archive, name: str) -> None:
        self.name = name
        self.archive = archive
        self.variables: Mapping[str, VariableInfo] = archive.variables
        about = archive.description.coSimulation
        self.can_save = bool(about.canGetAndSetFMUstate)
        self.can_interpolate = bool(about.canInterpolateInputs)
        self._states: dict[str, Any] = {}
        self._environment = next(_environment)
        _messages[self._environment] = deque(maxlen=20)
        callbacks = fmi2.fmi2CallbackFunctions.from_buffer_copy(_callbacks)
        callbacks.componentEnvironment = self._environment
        self._fmu: Any = None
        try:
            self._fmu = fmi2.FMU2Slave(
                guid=archive.guid,
                unzipDirectory=str(archive.folder),
                modelIdentifier=about.modelIdentifier,
                instanceName=name,
            )
            self._fmu.instantiate(callbacks=callbacks, loggingOn=True)
        except Exception as error:
            said = self._said()
            self._fmu = None
            _messages.pop(self._environment)
            raise CallError(name, " could not be instantiated", said, f"{archive.path.name}: {error}") from error

    def reference(self, name: str) -> VariableInfo:
        """The variable of that name; an unknown one is an error that names the nearest."""
        try:
            return self.variables[name]
        except KeyError:
            hint = did_you_mean(name, self.variables)
            raise FmuError(f"{self.name}: {self.archive.path.name} has no variable {name!r}{hint}") from None

    def set(self, values: Mapping[str, float]) -> None:
        """Set variables by name, all Reals in one call, then Integers, then Booleans."""
        for kind in KINDS:
            chosen = [(self.reference(n).reference, v) for n, v in values.items() if self.reference(n).kind == kind]
            if chosen:
                references, numbers = zip(*chosen, strict=True)
                cast = float if kind == "Real" else int
                self._call(f"set{kind}", list(references), [cast(n) for n in numbers])

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
        self._call("setupExperiment", startTime=start, stopTime=stop)
        self._call("enterInitializationMode")

    def exit_initialisation(self) -> None:
        """Begin, with what was set meanwhile."""
        self._call("exitInitializationMode")

    def set_rates(self, rates: Mapping[str, float]) -> None:
        """Let inputs move at these rates [SI/s] over the next step."""
        references = [self.reference(name).reference for name in rates]
        self._call("setRealInputDerivatives", references, [1] * len(rates), list(rates.values()))

    def step(self, time: float, size: float) -> None:
        """Advance from `time` by `size` [s]; a step refused is an error with the FMU's own words, never tried again."""
        try:
            self._fmu.fmi2DoStep(self._fmu.component, time, size, fmi2.fmi2False)
        except fmpy.fmi1.FMICallException as error:
            reached = ""
            if error.status == fmi2.fmi2Discard:
                reached = self._discarded_at()
            raise self._error(error, f" stopped at t = {time:.9g} s in a step of {size:.6g} s{reached}") from None

    def save(self, key: str = "") -> None:
        """Keep the present state, replacing the one kept before under this key."""
        state = self._states.setdefault(key, fmi2.fmi2FMUstate())
        try:
            self._fmu.fmi2GetFMUstate(self._fmu.component, ctypes.byref(state))
        except fmpy.fmi1.FMICallException as error:
            raise self._error(error) from None

    def restore(self, key: str = "") -> None:
        """Go back to the state kept last under this key."""
        self._call("setFMUstate", self._states[key])

    def state_size(self) -> int:
        """Bytes of a serialised state: what an instance holds."""
        self.save()
        size = ctypes.c_size_t()
        self._fmu.fmi2SerializedFMUstateSize(self._fmu.component, self._states[""], ctypes.byref(size))
        return size.value

    def close(self) -> None:
        if self._fmu is not None:
            for state in self._states.values():
                self._fmu.freeFMUstate(state)
            self._fmu.freeInstance()
            self._fmu = None
            _messages.pop(self._environment)

    def __enter__(self) -> Component:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self.close()

    def _call(self, function: str, *arguments: Any, **named: Any) -> Any:
        try:
            return getattr(self._fmu, function)(*arguments, **named)
        except fmpy.fmi1.FMICallException as error:
            raise self._error(error) from None

    def _error(self, error: Any, where: str = "") -> CallError:
        status = STATUS[error.status] if error.status in range(len(STATUS)) else str(error.status)
        return CallError(self.name, where, self._said(), f"{self.archive.path.name}: {error.function} gave {status}")

    def _said(self) -> str:
        """The FMU's latest complaints, or its latest words when none is a complaint."""
        messages = list(_messages[self._environment])
        told = [text for status, text in messages if status >= fmi2.fmi2Warning] or [text for _, text in messages]
        return "; ".join(dict.fromkeys(told[-3:])) if told else "the FMU gave no message"

    def _discarded_at(self) -> str:
        try:
            time = self._fmu.getRealStatus(fmi2.fmi2LastSuccessfulTime)
            ended = self._fmu.getBooleanStatus(fmi2.fmi2Terminated)
        except fmpy.fmi1.FMICallException:
            return ""
        return f", {'terminated' if ended else 'got'} at {time:.9g} s"


class Reader:
    """Reads a fixed set of variables into one row of doubles: Reals first, then Integers, then Booleans.

    The ctypes arrays are made once, so that a macro step costs a few microseconds whatever the number of variables.
    """

    def __init__(self, component: Component, names: Sequence[str]) -> None:
        infos = [component.reference(name) for name in names]
        for info in infos:
            if info.kind not in KINDS:
                raise FmuError(f"{component.name}: {info.name} is a {info.kind}; only numbers can be read")
        ordered = sorted(infos, key=lambda info: KINDS.index(info.kind))
        self.names = tuple(info.name for info in ordered)
        self.values: Row = np.zeros(len(ordered))
        self._component = component
        self._blocks: list[tuple[Any, Any, int, Any, npt.NDArray[Any], slice]] = []
        begin = 0
        for kind, group in itertools.groupby(ordered, key=lambda info: info.kind):
            references = [info.reference for info in group]
            count = len(references)
            buffer: Any = ((ctypes.c_double if kind == "Real" else ctypes.c_int) * count)()
            self._blocks.append(
                (
                    getattr(component._fmu, f"fmi2Get{kind}"),
                    (ctypes.c_uint * count)(*references),
                    count,
                    buffer,
                    np.frombuffer(buffer, dtype=np.float64 if kind == "Real" else np.int32),
                    slice(begin, begin + count),
                )
            )
            begin += count

    def __call__(self) -> Row:
        instance = self._component._fmu.component
        try:
            for getter, references, count, buffer, view, part in self._blocks:
                getter(instance, references, count, buffer)
                self.values[part] = view
        except fmpy.fmi1.FMICallException as error:
            raise self._component._error(error) from None
        return self.values


def output_names(variables: Mapping[str, VariableInfo], without: Iterable[str] = ()) -> list[str]:
    """Names of all numeric outputs, save those that begin with one of the prefixes."""
    prefixes = tuple(without)
    return [
        v.name
        for v in variables.values()
        if v.causality == "output" and v.kind in KINDS and not v.name.startswith(prefixes or ("\0",))
    ]
