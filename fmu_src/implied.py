"""What a scene implies without saying it: stiffness, masses, periods. The models' own formulas, as rows to be shown.

Each model has a module `implied` with `rows(values, terms)`, which yields `Implied`; values are all of the parameters
and inputs by FMI name, SI.
"""

from __future__ import annotations

from collections.abc import Callable
from types import FunctionType
from typing import Any, NamedTuple, TypeVar

from orbital.kernel import Kernel

Function = TypeVar("Function", bound=Callable[..., Any])


class Implied(NamedTuple):
    """A size: its name for machines, what it is, its value and SI unit ("1" for a pure number)."""

    key: str
    label: str
    value: float
    unit: str


def formula(kernel: Function) -> Function:
    """The Python that a kernel was compiled from: the same formula, without compiling it for one number, nor any kernel
    that it calls by its name."""
    written: Any = getattr(kernel, "py_func", kernel)
    called = {name: written.__globals__.get(name) for name in written.__code__.co_names}
    inner = {name: formula(value) for name, value in called.items() if isinstance(value, Kernel)}
    if inner:
        written = FunctionType(written.__code__, {**written.__globals__, **inner}, written.__name__)
    return written  # type: ignore[no-any-return]
