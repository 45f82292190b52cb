"""Hashes of what kernels are made from: two kernels of one hash are compiled to the same code.

A kernel is its code and all that this refers to: what it closes over, globals of its module, attributes of modules of
ours, and the kernels and functions among these likewise. What numba was taught in a module of ours (types, intrinsics)
counts with that module's whole source.

Checked  tests/orbital/test_keeping.py
"""

from __future__ import annotations

import dis
import enum
import hashlib
import importlib
import inspect
import types as python
from functools import cache
from itertools import pairwise
from typing import Any

import numpy as np
from llvmlite import ir
from numba.core import types
from numba.core.extending import _Intrinsic

from orbital.kernel import Kernel

OWN = ("orbital", "fmu_src", "dcone_cosim", "tests")
"""Packages whose modules may change while the versions of all others stay."""


class NoKeyError(TypeError):
    """There is no hash of something that a kernel is made from."""


def digest(*parts: str) -> str:
    """One hash of several texts."""
    return hashlib.sha256("\0".join(parts).encode()).hexdigest()


@cache
def source(module: str) -> str:
    """Hash of a module's source."""
    return digest(inspect.getsource(importlib.import_module(module)))


class Keys:
    """Hashes of what kernels are made from; every object keeps the one that it had first."""

    def __init__(self) -> None:
        self._known: dict[int, tuple[Any, str]] = {}

    def of(self, value: Any) -> str:
        """What is the same for two values that make the same code; `NoKeyError` where that is not known."""
        if value is None or isinstance(value, str | bytes | int | float | complex | np.generic):
            return f"{type(value).__name__} {value!r}"
        known = self._known.get(id(value))
        if known is None:
            self._known[id(value)] = (value, "within itself")
            known = self._known[id(value)] = (value, self._made_of(value))
        return known[1]

    def _made_of(self, value: Any) -> str:
        match value:
            case Kernel():
                options = self.of(sorted(value._options.items()))
                return digest("kernel", value.__module__, self._function(value.py_func), options)
            case _Intrinsic():
                return digest("intrinsic", source(value._defn.__module__), self._function(value._defn))
            case python.FunctionType():
                return digest("function", value.__module__, self._function(value))
            case python.CodeType():
                return digest("code", value.co_code.hex(), value.co_exceptiontable.hex(), *map(self.of, (
                    value.co_consts, value.co_names, value.co_varnames, value.co_freevars, value.co_cellvars,
                )))  # fmt: skip
            case python.ModuleType():
                return f"module {value.__name__}"
            case tuple() | list():
                return digest(_named(type(value)), str(getattr(value, "_fields", "")), *map(self.of, value))
            case dict():
                return digest("dict", *(self.of(item) for item in value.items()))
            case frozenset():
                return digest("frozenset", *sorted(map(self.of, value)))
            case np.ndarray():
                return digest("array", value.dtype.str, str(value.shape), value.tobytes().hex())
            case types.Type() | ir.Type():
                module = type(value).__module__
                taught = "" if module.startswith(("numba.", "llvmlite.")) else source(module)
                return digest(_named(type(value)), str(value), taught)
            case enum.EnumType():
                members: Any = value
                return digest(_named(value), self.of([(member.name, member.value) for member in members]))
            case type() | python.BuiltinFunctionType() | np.ufunc():
                return f"{_named(value)} {getattr(value, '_fields', '')}"
        raise NoKeyError(f"no hash of {value!r:.80}")

    def _function(self, function: Any) -> str:
        code = function.__code__
        names = sorted(_names(code))
        around = {name: function.__globals__[name] for name in names if name in function.__globals__}
        modules = [module for module in around.values() if isinstance(module, python.ModuleType)]
        own = [module for module in modules if module.__name__.partition(".")[0] in OWN]
        there = [(name, getattr(module, name)) for module in own for name in names if hasattr(module, name)]
        cells = [cell.cell_contents for cell in function.__closure__ or ()]
        around |= zip(code.co_freevars, cells, strict=True)
        asked = [(name, _asked(code, name, value)) for name, value in around.items()]
        return digest(self.of(code), self.of(asked + there), self.of(function.__defaults__))


def _asked(code: python.CodeType, name: str, value: Any) -> Any:
    """What a function asks of something that it refers to: of several things with names, those that it names."""
    fields = getattr(value, "_fields", None)
    if fields is None or any(isinstance(constant, python.CodeType) for constant in code.co_consts):
        return value
    uses = _followed(code).get(name, set())
    if all(step in ("LOAD_ATTR", "LOAD_METHOD") and named in fields for step, named in uses):
        return [(field, getattr(value, field)) for field in sorted({named for _, named in uses})]
    return value


@cache
def _followed(code: python.CodeType) -> dict[str, set[tuple[str, Any]]]:
    """What is done next with each name that a function refers to: steps, and what they name."""
    found: dict[str, set[tuple[str, Any]]] = {}
    for step, then in pairwise(dis.get_instructions(code)):
        if isinstance(step.argval, str):
            found.setdefault(step.argval, set()).add((then.opname, then.argval))
    return found


class Apart(Keys):
    """Hashes of what one kernel is made from apart from those that it calls: of a kernel that is not written out where
    it is called, only how it may be called counts, and which of several it is.

    called    the kernels that were met, in this order, without repetition
    """

    def __init__(self, keys: Keys) -> None:
        super().__init__()
        self._keys = keys
        self._numbers: dict[str, int] = {}
        self.called: list[Kernel] = []

    def number(self, function: Any) -> int:
        """Which of the called kernels a function is; `NoKeyError` where it was reached past what is looked through."""
        number = self._numbers.get(self._keys.of(function))
        if number is None:
            raise NoKeyError(f"{function.__qualname__} is called and neither closed over nor named by a module of ours")
        return number

    def _made_of(self, value: Any) -> str:
        if not isinstance(value, Kernel) or "inline" in value._options:
            return super()._made_of(value)
        function = value.py_func
        number = self._numbers.setdefault(self._keys.of(function), len(self.called))
        if number == len(self.called):
            self.called.append(value)
        code = function.__code__
        arguments = code.co_varnames[: code.co_argcount + code.co_kwonlyargcount], code.co_flags
        return digest("called", str(number), *map(self._keys.of, (
            arguments, function.__defaults__, function.__kwdefaults__, sorted(value._options.items()),
        )))  # fmt: skip


def _named(value: Any) -> str:
    return f"{getattr(value, '__module__', '')}.{getattr(value, '__qualname__', value.__class__.__qualname__)}"


def _names(code: python.CodeType) -> set[str]:
    """Every name that a function and those within it refer to, and their attributes."""
    inner = [constant for constant in code.co_consts if isinstance(constant, python.CodeType)]
    return set(code.co_names).union(*map(_names, inner))
