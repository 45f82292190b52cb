"""A model run in this process by its kernel: the twin of the FMU, for tests and references."""

from __future__ import annotations

import importlib
from collections.abc import Mapping
from functools import lru_cache
from typing import Any

import numpy as np
import numpy.typing as npt

from fmu_src.interface import INITIALISE, REFRESH, SIZE, STEP, Interface, Model, Value


class ModelFault(RuntimeError):
    """The kernel stopped: carries the fault's text, where and when."""


@lru_cache(maxsize=32)
def _entry(module: str, terms: tuple[tuple[str, str], ...]) -> Any:
    return importlib.import_module(module).make_entry(dict(terms))


class Instance:
    """One model with one choice of terms, driven like an FMU: set parameters, initialise, step, get.

    Values are read and written by FMI name (`bullet[1].position[1]`) or whole arrays by field name.
    """

    def __init__(self, model: Model, terms: Mapping[str, str], parameters: Mapping[str, Value] | None = None) -> None:
        self.interface: Interface = model.interface(terms)
        self.record = self.interface.make_record()
        self.work: npt.NDArray[np.float64] = np.zeros(0)
        self.time = 0.0
        self._entry = _entry(model.module, tuple(self.interface.terms.items()))
        self._slots = {n: (slot, v.kind == "Real") for n, slot, v, _ in self.interface.scalars() if v.at_interface}
        for name, value in (parameters or {}).items():
            self[name] = value

    def _slot(self, name: str) -> tuple[npt.NDArray[Any], int]:
        slot, real = self._slots[name]
        return self.record.view(np.float64 if real else np.int64), slot

    def __getitem__(self, name: str) -> float:
        view, slot = self._slot(name)
        value: float = view[slot].item()
        return value

    def __setitem__(self, name: str, value: Value) -> None:
        view, slot = self._slot(name)
        view[slot] = value

    def array(self, field: str) -> npt.NDArray[Any]:
        """View of a whole field of the record, by field name, shape as declared."""
        view: npt.NDArray[Any] = self.record[0][field]
        return view

    def _call(self, command: int, time: float, step: float) -> None:
        if self._entry(command, self.record, self.work, time, step):
            code = int(self.record["fault_code"][0])
            text = next(f.text for f in self.interface.model.faults if f.code == code)
            where = {k: self.record["fault_" + k][0] for k in ("index", "value", "time")}
            raise ModelFault(f"{text} (index {where['index']}, value {where['value']:g}, at {where['time']:.9g} s)")

    def initialise(self, start_time: float = 0.0) -> Instance:
        self._call(SIZE, start_time, 0.0)
        self.work = np.zeros(int(self.record["work_size"][0]))
        self._call(INITIALISE, start_time, 0.0)
        self.time = start_time
        return self

    def step(self, size: float) -> None:
        """Advance by one macro step [s]."""
        self._call(STEP, self.time, size)
        self.time += size

    def refresh(self) -> None:
        self._call(REFRESH, self.time, 0.0)
