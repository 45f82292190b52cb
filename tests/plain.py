"""Kernels run as plain Python: what would be dear to compile anew, and formulas that a test changes on the way."""

from __future__ import annotations

import ctypes
import importlib
import inspect
import math
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from operator import attrgetter
from typing import Any

import numpy as np
import pytest
from numba.core.extending import _Intrinsic
from numba.np.numpy_support import as_dtype

from fmu_src import instance
from fmu_src.instance import Instance
from fmu_src.interface import Model, Value
from fmu_src.lanes import REALS, of
from fmu_src.tables import ROW
from orbital.kernel import Kernel


class _Fields:
    """A record as its kernels see it, sooner than numpy's own: a property for each field.

    _reals, _whole  its numbers, and the same words as whole numbers
    _arrays         views of the fields that have a shape, by name
    """

    __slots__ = "_arrays", "_reals", "_whole"

    def __init__(self, record: np.ndarray) -> None:
        self._reals, self._whole = record.view(np.ndarray).view(np.float64), record.view(np.ndarray).view(np.int64)
        shaped = [name for name, (kind, _) in record.dtype.fields.items() if kind.shape]
        self._arrays = {name: record.view(np.ndarray)[name][0] for name in shaped}

    def __getitem__(self, name: str) -> Any:
        return getattr(self, name)

    def __setitem__(self, name: str, value: Any) -> None:
        setattr(self, name, value)


def _real(slot: int) -> Any:
    def put(p: _Fields, value: Any) -> None:
        p._reals[slot] = value

    return property(lambda p: p._reals[slot], put)


def _whole(slot: int) -> Any:
    def put(p: _Fields, value: Any) -> None:
        p._whole[slot] = value

    return property(lambda p: p._whole[slot], put)


def _array(name: str) -> Any:
    def put(p: _Fields, value: Any) -> None:
        p._arrays[name][...] = value

    return property(lambda p: p._arrays[name], put)


@cache
def _fields_of(dtype: np.dtype[Any]) -> type[_Fields]:
    """The class of a record's type, whose slots all have 8 bytes."""
    rows: dict[str, Any] = {"__slots__": ()}
    for name, (kind, offset) in dtype.fields.items():
        rows[name] = _array(name) if kind.shape else (_real if kind == np.float64 else _whole)(offset // 8)
    return type("Fields", (_Fields,), rows)


def seen(record: np.ndarray) -> list[_Fields]:
    """An array of one record as its kernels see it."""
    return [_fields_of(record.dtype)(record)]


def _entry(model: Model, terms: Mapping[str, str]) -> Any:
    entry = importlib.import_module(model.module).make_entry(dict(terms))
    known: tuple[Any, Any] = None, None

    def call(command: int, record: Any, work: Any, time: float, step: float) -> Any:
        nonlocal known
        if known[0] is not record:
            known = record, seen(record)
        return entry(command, known[1], work, time, step)

    return call


@pytest.fixture
def plain(monkeypatch: pytest.MonkeyPatch) -> None:
    """As long as the test runs, every kernel is the function it was written as."""
    _patched(monkeypatch)
    monkeypatch.setattr(instance, "entry_of", _entry)


PLAIN = property(attrgetter("py_func"))


class _Words(np.ndarray):
    """Numbers of which a whole one may be given as 64 bits without a sign."""

    def __setitem__(self, where: Any, value: Any) -> None:
        if isinstance(value, int) and self.dtype == np.int64 and value >= 1 << 63:
            value -= 1 << 64
        super().__setitem__(where, value)


def _written_out(made: _Intrinsic, *arguments: Any) -> Any:
    """What an intrinsic of `fmu_src.lanes` does; lanes are arrays."""
    name = made._name
    if name == "viewed":
        kind = inspect.getclosurevars(made._defn).nonlocals["kind"]
        return arguments[0].view(as_dtype(kind)).view(_Words)
    if name == "table_at":
        return _table(made, *arguments)
    if name in OF_A_WIDTH:
        return OF_A_WIDTH[name](*_width(made), *arguments)
    return INTRINSICS[name](*arguments)


def _table(made: _Intrinsic, address: int) -> Any:
    """A table of those that lie at an address, see `fmu_src.tables.make_reader`; it can not be written to."""
    names = inspect.getclosurevars(made._defn).nonlocals
    place, dimensions = names["place"], names["dimensions"]
    row = (ctypes.c_int64 * (1 + dimensions)).from_address(int(address) + 8 * ROW * place)
    shape = tuple(row[1:])
    numbers = (ctypes.c_double * math.prod(shape)).from_address(int(address) + 8 * row[0])
    found = np.ctypeslib.as_array(numbers).reshape(shape)
    found.flags.writeable = False
    return found


@cache
def _width(made: _Intrinsic) -> tuple[int, Any]:
    """How many numbers lie side by side where an intrinsic of lanes is used, and their kind."""
    (lanes,) = (of(precision) for precision in REALS if made in of(precision))
    return lanes.width, as_dtype(next(real for real, *_, width in REALS.values() if width == lanes.width))


INTRINSICS: dict[str, Callable[..., Any]] = {
    "peek": lambda array, index: array[index],
    "poke": lambda array, index, value: array.__setitem__(index, value),
    "lowest": lambda bits: (int(bits) & -int(bits)).bit_length() - 1,
    "highest": lambda bits: int(bits).bit_length() - 1,
    "population": lambda bits: int(bits).bit_count(),
    "where": np.where,
    "root": np.sqrt,
    "slide": lambda value, before: np.concatenate([before[-1:], value[:-1]]),
    "bits": lambda flags: sum(1 << int(i) for i in np.flatnonzero(flags)),
    "lane": lambda value, index: float(value[index]),
}
OF_A_WIDTH: dict[str, Callable[..., Any]] = {
    "load": lambda width, kind, reals, index: np.array(reals[index : index + width]),
    "store": lambda width, kind, reals, index, value: reals.__setitem__(slice(index, index + width), value),
    "splat": lambda width, kind, value: np.full(width, value, kind),
    "ramp": lambda width, kind: np.arange(width, dtype=kind),
    "flags_of": lambda width, kind, bits: np.array([bool(int(bits) >> i & 1) for i in range(width)]),
}


def _patched(patch: pytest.MonkeyPatch) -> None:
    patch.setattr(Kernel, "dispatcher", PLAIN)
    patch.setattr(Kernel, "__call__", PLAIN)
    patch.setattr(_Intrinsic, "__call__", _written_out)


def plainly(function: Callable[..., Any]) -> Callable[..., Any]:
    """A kernel that is run as it was written, with all that it calls."""

    def run(*arguments: Any) -> Any:
        with pytest.MonkeyPatch.context() as patch:
            _patched(patch)
            return function(*arguments)

    return run


class PlainInstance(Instance):
    """An instance for `plain`, initialised; a parameter may be a whole array, by its field's name."""

    def __init__(
        self, model: Model, terms: Mapping[str, str], parameters: Mapping[str, Value | Sequence[float]] | None = None
    ) -> None:
        super().__init__(model, terms)
        self.record: Any = self.record.view(np.recarray)  # only of these plain Python reads fields as attributes
        for name, value in (parameters or {}).items():
            if isinstance(value, Sequence):
                self.array(name)[:] = value
            else:
                self[name] = value
        self.initialise()
