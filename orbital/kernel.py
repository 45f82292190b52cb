"""The one numba decorator of the project.

A kernel is compiled without the numba runtime, so that any allocation inside it is a compile error (it gets its memory
from the caller), with C semantics for division, and without fast-math: the same source then gives the same bits in this
process and in an FMU's binary. Inside kernels use `math`, plain arithmetic and slices of arrays handed in.

Numba is imported when a kernel is first used, so that a module may hold kernels beside what is read without them.
"""

from collections.abc import Callable
from functools import cached_property
from typing import Any, TypeVar

import numpy as np

Function = TypeVar("Function", bound=Callable[..., Any])

OPTIONS: dict[str, Any] = {"error_model": "numpy", "_nrt": False}


class Kernel:
    """A function that numba compiles once it is called, or met in another kernel; all else is its dispatcher's.

    signature    of an entry: what it is compiled for; a kernel is compiled for what it first meets
    """

    def __init__(self, function: Callable[..., Any], signature: Any = None, **options: Any) -> None:
        self.py_func = function
        self.__doc__, self.__name__, self.__module__ = function.__doc__, function.__name__, function.__module__
        self.signature = signature
        self._options = options | OPTIONS

    @cached_property
    def dispatcher(self) -> Any:
        """For Python."""
        from orbital.linking import whole

        return whole(self.py_func, self._options, self.signature)

    @cached_property
    def _part(self) -> Any:
        """For other kernels."""
        from orbital.linking import part

        return part(self.py_func, self._options)

    @property
    def _numba_type_(self) -> Any:
        return self._part._numba_type_

    def module_text(self) -> tuple[str, str]:
        """Name of an entry's function in LLVM IR, and that IR with all kernels below it."""
        from orbital.linking import module_text

        return module_text(self.py_func, self.signature, self._options)

    def __call__(self, *arguments: Any) -> Any:
        return self.dispatcher(*arguments)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        return getattr(self.dispatcher, name)


def kernel(function: Function) -> Function:
    """Compile a function for use by other kernels; called from Python it compiles for the types it first meets."""
    return Kernel(function)  # type: ignore[return-value]


def view(function: Function) -> Function:
    """Compile a function that returns a slice of the memory it is given: it is inlined where it is called.

    Without the numba runtime a compiled function cannot return an array, only an inlined one can.
    """
    return Kernel(function, inline="always")  # type: ignore[return-value]


def entry(dtype: Any) -> Callable[[Function], Function]:
    """Compile a model's `entry(command, records, work, time, step) -> status`, for the shim of an FMU or from Python.

    dtype    of a record; `work` holds doubles
    """
    from numba import from_dtype, types

    records = from_dtype(np.dtype(dtype))[::1]
    signature = types.int32(types.int64, records, types.float64[::1], types.float64, types.float64)
    return lambda function: Kernel(function, signature)  # type: ignore[return-value]
