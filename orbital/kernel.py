"""The one numba decorator of the project.

A kernel is compiled without the numba runtime, so that any allocation inside it is a compile error (it gets its memory
from the caller), with C semantics for division, and without fast-math: the same source then gives the same bits in this
process and in an FMU's binary. Inside kernels use `math`, plain arithmetic and slices of arrays handed in.

Numba is imported when a kernel is first used, so that a module may hold kernels beside what is read without them.
"""

from collections.abc import Callable
from typing import Any, TypeVar

Function = TypeVar("Function", bound=Callable[..., Any])

OPTIONS: dict[str, Any] = {"error_model": "numpy", "_nrt": False}


class Kernel:
    """A function that numba compiles once it is called, or met in another kernel; all else is its dispatcher's."""

    def __init__(self, function: Callable[..., Any], **options: Any) -> None:
        self.py_func = function
        self.__doc__, self.__name__, self.__module__ = function.__doc__, function.__name__, function.__module__
        self._options = options
        self._dispatcher: Any = None

    @property
    def dispatcher(self) -> Any:
        if self._dispatcher is None:
            from numba import njit

            self._dispatcher = njit(**self._options, **OPTIONS)(self.py_func)
        return self._dispatcher

    @property
    def _numba_type_(self) -> Any:
        return self.dispatcher._numba_type_

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
