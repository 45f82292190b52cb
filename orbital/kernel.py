"""The one numba decorator of the project.

A kernel is compiled without the numba runtime, so that any allocation inside it is a compile error (it gets its memory
from the caller), with C semantics for division, and without fast-math: the same source then gives the same bits in this
process and in an FMU's binary. Inside kernels use `math`, plain arithmetic and slices of arrays handed in.
"""

from collections.abc import Callable
from typing import Any, TypeVar

from numba import njit

Function = TypeVar("Function", bound=Callable[..., Any])

OPTIONS: dict[str, Any] = {"error_model": "numpy", "_nrt": False}


def kernel(function: Function) -> Function:
    """Compile a function for use by other kernels; called from Python it compiles for the types it first meets."""
    compiled: Function = njit(**OPTIONS)(function)
    return compiled


def view(function: Function) -> Function:
    """Compile a function that returns a slice of the memory it is given: it is inlined where it is called.

    Without the numba runtime a compiled function cannot return an array, only an inlined one can.
    """
    compiled: Function = njit(inline="always", **OPTIONS)(function)
    return compiled
