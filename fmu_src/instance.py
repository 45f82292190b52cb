"""A model run in this process by its kernel: the twin of the FMU, for tests and references."""

from __future__ import annotations

import importlib
from collections.abc import Callable, Mapping
from functools import lru_cache
from typing import Any

import numpy as np
import numpy.typing as npt

from fmu_src.interface import (
    DIFFERENTIATE,
    GO_ON,
    INDEX,
    INITIALISE,
    REFRESH,
    SIZE,
    STEP,
    UNDER_WAY,
    Interface,
    Model,
    Value,
    Variable,
)


class ModelFault(RuntimeError):
    """The kernel stopped: carries the fault's text, where and when."""


@lru_cache(maxsize=32)
def _compiled(module: str, terms: tuple[tuple[str, str], ...]) -> Any:
    return importlib.import_module(module).make_entry(dict(terms))


def compiled(model: Model, terms: Mapping[str, str]) -> Any:
    """The model's entry, compiled in this process when it is first called."""
    return _compiled(model.module, tuple(terms.items()))


entry_of: Callable[[Model, Mapping[str, str]], Any] = compiled
"""Where an instance has its entry from, `entry(command, record, work, time, step) -> status`: another source is put
here by who has it in a library already."""


def _aligned(size: int) -> npt.NDArray[np.float64]:
    """Zeros that begin at a multiple of 64 bytes, as in an FMU: only then are vectors stored at full speed."""
    memory = np.zeros(size + 8)
    first = -memory.ctypes.data // 8 % 8
    return memory[first : first + size]


class Instance:
    """One model with one choice of terms, driven like an FMU: set parameters, initialise, step, get.

    Values are read and written by FMI name (`bullet[1].position[1]`) or whole arrays by field name. `tables` are those
    of its parts, by name; ValueError if one is missing or wrong.
    """

    def __init__(
        self,
        model: Model,
        terms: Mapping[str, str],
        parameters: Mapping[str, Value] | None = None,
        tables: Mapping[str, npt.ArrayLike] | None = None,
    ) -> None:
        self.interface: Interface = model.interface(terms).with_tables(tables or {})
        self.record = self.interface.make_record()
        self.work: npt.NDArray[np.float64] = np.zeros(0)
        self.time = 0.0
        self.entry = entry_of(model, self.interface.terms)
        rows = list(self.interface.scalars())
        self._slots = {n: (slot, v.kind == "Real") for n, slot, v, _ in rows if v.at_interface}
        self._by_name = {n.removeprefix("@"): (slot, v) for n, slot, v, _ in rows}
        self._moving: set[str] = set()
        self._names = {slot: n for n, slot, _, _ in rows}
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
        self.record["tables_at"] = self.interface.table_block.ctypes.data
        status = self.entry(command, self.record, self.work, time, step)
        while status == UNDER_WAY:
            status = self.entry(GO_ON, self.record, self.work, time, step)
        self.record["tables_at"] = 0
        if status:
            code = int(self.record["fault_code"][0])
            fault = next(f for f in self.interface.model.faults if f.code == code)
            where = {k: self.record["fault_" + k][0] for k in ("index", "value", "time")}
            index = int(where["index"])
            at = self._names.get(index) if fault.names_variable and index else f"index {index}"
            of = f"{at}, " if index else ""
            raise ModelFault(f"{fault.text} ({of}value {where['value']:g}, at {where['time']:.9g} s)")

    def initialise(self, start_time: float = 0.0) -> Instance:
        self._call(SIZE, start_time, 0.0)
        self.work = _aligned(int(self.record["work_size"][0]))
        self._call(INITIALISE, start_time, 0.0)
        self.time = start_time
        return self

    def step(self, size: float) -> None:
        """Advance by one macro step [s]; rates of inputs hold for this step only."""
        self._call(STEP, self.time, size)
        self.time += size
        for rate in self._moving:
            self._whole(rate)[...] = 0.0
        self._moving.clear()

    def refresh(self) -> None:
        """Outputs for the inputs of now."""
        self._call(REFRESH, self.time, 0.0)

    def set_rates(self, rates: Mapping[str, float]) -> None:
        """Let inputs move at these rates in the next step, by FMI name [unit of the input per s]."""
        for name, rate in rates.items():
            slot, v = self._by_name[name]
            if v.causality != "input" or not v.rate:
                raise ValueError(f"{name} is no input with a rate")
            self._whole(v.rate).reshape(-1)[slot - self._first(v)] = rate
            self._moving.add(v.rate)

    def differentiate(self) -> None:
        """Work out the derivatives that `rate` and `partial` read."""
        self._call(DIFFERENTIATE, self.time, 0.0)

    def rate(self, name: str) -> float:
        """Time derivative of an output, as of the last `differentiate`."""
        slot, v = self._by_name[name]
        if not v.rate:
            raise ValueError(f"{name} has no rate")
        value: float = self._whole(v.rate).reshape(-1)[slot - self._first(v)].item()
        return value

    def partial(self, output: str, by: str) -> float:
        """Derivative of a scalar output by an input, as of the last `differentiate`; zero where nothing is told."""
        partials = dict(self._by_name[output][1].partials)
        return float(self._whole(partials[by])[0]) if by in partials else 0.0

    def _first(self, v: Variable) -> int:
        return self._by_name[v.element_names()[0]][0]

    def _whole(self, name: str) -> npt.NDArray[Any]:
        """View of the first record's field that a variable or state has."""
        view: npt.NDArray[Any] = self.record[name.replace(INDEX, "").replace(".", "_")][0:1]
        return view
