"""The C functions of an FMU's library, called as they are: what fmpy would keep from being called wrongly can be."""

from __future__ import annotations

import ctypes
from ctypes import POINTER, byref, c_char_p, c_double, c_int, c_size_t, c_uint, c_void_p

OK, WARNING, DISCARD, ERROR, FATAL = range(5)
LAST_SUCCESSFUL_TIME, TERMINATED = 2, 3
CO_SIMULATION = 1
LOGGER = ctypes.CFUNCTYPE(None, c_void_p, c_char_p, c_int, c_char_p, c_char_p, c_char_p)
"""The variadic logger of FMI, as this project's shim calls it: a format of "%s" and one text."""


class Callbacks(ctypes.Structure):
    _fields_ = [(n, c_void_p) for n in ("logger", "allocate", "free", "finished", "environment")]


class Library:
    """A loaded library; `call` takes the name without fmi2 and Python numbers, lists, bytes or None."""

    def __init__(self, path):
        self.library = ctypes.CDLL(str(path))
        self.library.fmi2Instantiate.restype = c_void_p
        self.library.fmi2GetVersion.restype = c_char_p
        self.library.fmi2GetTypesPlatform.restype = c_char_p

    def call(self, name, *arguments):
        return getattr(self.library, "fmi2" + name)(*map(_as_c, arguments))


def _as_c(value):
    if isinstance(value, bool):
        return c_int(value)
    if isinstance(value, float):
        return c_double(value)
    if isinstance(value, Count):
        return c_size_t(value)
    return value


class Count(int):
    """A size_t, or another integer as wide as a register."""


def doubles(*values):
    return (c_double * len(values))(*values)


def integers(*values):
    return (c_int * len(values))(*values)


def references(*values):
    return (c_uint * len(values))(*values)


class Raw:
    """One instance driven by variable name, each call giving its status; `said` holds (status, category, text).

    resources    where they are, as bytes; None for those of the unpacked FMU that the library lies in
    """

    def __init__(
        self, library, guid, names=None, logging=True, hears=True, name="raw", kind=CO_SIMULATION, resources=None
    ):
        self.said = []
        self._logger = LOGGER(lambda env, who, status, category, form, text: self._hear(status, category, form, text))
        functions = Callbacks(logger=ctypes.cast(self._logger, c_void_p).value if hears else None)
        self.library = library
        self.names = names or {}
        self.component = c_void_p(
            library.call("Instantiate", name.encode(), kind, guid.encode(), resources, byref(functions), False, logging)
        )

    def _hear(self, status, category, form, text):
        assert form == b"%s"
        self.said.append((status, category.decode(), text.decode()))

    @property
    def last(self):
        """Text of the latest message."""
        return self.said[-1][2] if self.said else ""

    def call(self, name, *arguments):
        return self.library.call(name, self.component, *arguments)

    def start(self, values=None, stop=None, begin=0.0):
        """Set, and initialise; the worst status."""
        statuses = [self.set(values or {})]
        statuses.append(self.call("SetupExperiment", False, 0.0, begin, stop is not None, stop or 0.0))
        statuses += [self.call("EnterInitializationMode"), self.call("ExitInitializationMode")]
        return max(statuses)

    def set(self, values):
        worst = OK
        for name, value in values.items():
            vr, n = references(self.names[name]), Count(1)
            if isinstance(value, bool):
                worst = max(worst, self.call("SetBoolean", vr, n, integers(value)))
            elif isinstance(value, int):
                worst = max(worst, self.call("SetInteger", vr, n, integers(value)))
            else:
                worst = max(worst, self.call("SetReal", vr, n, doubles(value)))
        return worst

    def get(self, *names, kind="Real"):
        """Values of variables of one type; AssertionError if refused."""
        values = c_double if kind == "Real" else c_int
        values = (values * len(names))()
        status = self.call("Get" + kind, references(*(self.names[n] for n in names)), Count(len(names)), values)
        assert status == OK, (status, self.last)
        return values[0] if len(names) == 1 else list(values)

    def ramp(self, name, rate, order=1):
        return self.call(
            "SetRealInputDerivatives", references(self.names[name]), Count(1), integers(order), doubles(rate)
        )

    def output_rate(self, name, order=1):
        """Status and value."""
        value = c_double()
        status = self.call(
            "GetRealOutputDerivatives", references(self.names[name]), Count(1), integers(order), byref(value)
        )
        return status, value.value

    def directional(self, outputs, changes):
        """Status and the list of changes of the outputs."""
        result = (c_double * len(outputs))()
        status = self.call(
            "GetDirectionalDerivative", references(*(self.names[n] for n in outputs)), Count(len(outputs)),
            references(*(self.names[n] for n in changes)), Count(len(changes)), doubles(*changes.values()), result,
        )  # fmt: skip
        return status, list(result)

    def step(self, time, size):
        return self.call("DoStep", float(time), float(size), True)

    def save(self):
        state = c_void_p()
        assert self.call("GetFMUstate", byref(state)) == OK
        return state

    def restore(self, state):
        return self.call("SetFMUstate", state)

    def serialise(self, state):
        size = c_size_t()
        assert self.call("SerializedFMUstateSize", state, byref(size)) == OK
        buffer = ctypes.create_string_buffer(size.value)
        assert self.call("SerializeFMUstate", state, buffer, size) == OK
        return buffer.raw

    def deserialise(self, data):
        """Status and the state, which is NULL when refused."""
        state = c_void_p()
        return self.call("DeSerializeFMUstate", data, Count(len(data)), byref(state)), state

    def drop(self, state):
        return self.call("FreeFMUstate", byref(state))

    def real_status(self):
        """Status and last successful time."""
        value = c_double()
        return self.call("GetRealStatus", LAST_SUCCESSFUL_TIME, byref(value)), value.value

    def ended(self):
        value = c_int()
        assert self.call("GetBooleanStatus", TERMINATED, byref(value)) == OK
        return bool(value.value)

    def free(self):
        self.library.library.fmi2FreeInstance.restype = None
        self.call("FreeInstance")
        self.component = c_void_p()
        self._logger = None


__all__ = ["POINTER", "Count", "Library", "Raw", "doubles", "integers", "references"]
