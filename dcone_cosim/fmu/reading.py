"""What is called at every communication point, straight to the FMU's functions: the way there through fmpy costs more
than the calls themselves.
"""

from __future__ import annotations

import ctypes
import math
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, Protocol

import numpy as np

from dcone_cosim.errors import FmuError
from dcone_cosim.fmu.floating import Control
from dcone_cosim.fmu.steppable import NUMBERS, CallError, Row, VariableInfo

WARNING = 1
"""Worst status of a call that went well."""


def straight(fmu: Any, function: str, *kinds: Any) -> Callable[..., int]:
    """A function of an instance that fmpy has loaded, which gives its status; `kinds` of the arguments after the
    instance."""
    made = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, *kinds)
    address = ctypes.cast(getattr(fmu.dll, function), ctypes.c_void_p).value
    assert address is not None
    return partial(made(address), fmu.component)


class Read(Protocol):
    """An instance that is read."""

    @property
    def name(self) -> str: ...
    @property
    def control(self) -> Control: ...
    def reference(self, name: str) -> VariableInfo: ...
    def ready(self) -> None: ...
    def watch(self, call: str) -> None: ...
    def remark(self, changed: str, call: str) -> None: ...
    def refusal(self, function: str, status: int) -> CallError: ...
    def not_finite(self, info: VariableInfo, value: float) -> CallError: ...
    def getter(self, kind: str) -> Callable[[int, int, int], int]:
        """Of a kind: addresses of the references and of where they go, and how many between them."""


class Reader:
    """Reads a fixed set of variables into one row of doubles: Reals first, then Integers, then Booleans.

    The arrays are made once, so that a macro step costs a few microseconds whatever the number of variables.
    Parameters may be infinite; anything else that is read must be a finite number.
    """

    def __init__(self, component: Read, names: Sequence[str]) -> None:
        infos = [component.reference(name) for name in names]
        for info in infos:
            if info.kind not in NUMBERS:
                raise FmuError(f"{component.name}: {info.name} is a {info.kind}; only numbers can be read")
        component.ready()
        self._infos = sorted(infos, key=lambda info: NUMBERS.index(info.kind))
        self.names = tuple(info.name for info in self._infos)
        self.values: Row = np.zeros(len(self._infos))
        self._component = component
        reals = [info for info in self._infos if info.kind == "Real"]
        self._reals, self._rest = self.values[: len(reals)], self.values[len(reals) :]
        self._whole = np.zeros(len(self._rest), dtype=np.int32)
        self._to_si: tuple[Row, Row] | None = None
        if not all(info.own.is_si for info in reals):
            self._to_si = np.array([info.own.factor for info in reals]), np.array([info.own.offset for info in reals])
        self._references = np.array([info.reference for info in self._infos], dtype=np.uint32)
        self._calls: list[tuple[str, Callable[[int, int, int], int], int, int, int]] = []
        for kind in NUMBERS:
            places = [i for i, info in enumerate(self._infos) if info.kind == kind]
            if places:
                first = places[0]
                into = self._reals if kind == "Real" else self._whole[first - len(reals) :]
                address = self._references.ctypes.data + first * self._references.itemsize
                self._calls.append((f"fmi2Get{kind}", component.getter(kind), address, len(places), into.ctypes.data))
        self._told = " or ".join(name for name, *_ in self._calls)

    def __call__(self) -> Row:
        component = self._component
        component.ready()
        for name, get, references, count, into in self._calls:
            status = get(references, count, into)
            if status > WARNING:
                component.watch(self._told)
                raise component.refusal(name, status)
        if changed := component.control.changed():
            component.remark(changed, self._told)
        reals = self._reals
        # the product is no finite number if an element is none: one pass, where a look at each would take three
        if not math.isfinite(reals.dot(reals)):
            self._check()
        if self._to_si is not None:
            factors, offsets = self._to_si
            reals *= factors
            reals += offsets
        self._rest[:] = self._whole
        return self.values

    def _check(self) -> None:
        for info, value in zip(self._infos, self._reals.tolist(), strict=False):
            if not math.isfinite(value) and not info.causality.endswith("arameter"):
                raise self._component.not_finite(info, value)
