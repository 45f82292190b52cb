"""Kernels as parts of others: typed and lowered once, and made into machine code only where they end up.

numba makes of every function a library of its own, optimised, turned into machine code and wrapped for Python, and
does much of it again wherever one function is linked into another: for a tree of two hundred kernels that is half of
the time. Here a kernel that others call stops at its LLVM module. What is called from outside, by Python or by an FMU,
links the modules of all kernels below it, and these are optimised and compiled once, as one.

`whole` and `part` make numba's dispatchers do so, through the context in which they lower; numba's version is pinned.
What numba would do over and over with the same outcome is remembered: for a tree of two hundred kernels a quarter of
the time.

Checked  tests/orbital/test_kernel.py
"""

from __future__ import annotations

import copy
import ctypes
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from types import SimpleNamespace
from typing import Any

from numba import _dynfunc, njit  # type: ignore[attr-defined]
from numba.core import types
from numba.core.codegen import CPUCodeLibrary, JITCodeLibrary
from numba.core.cpu import CPUContext
from numba.core.registry import CPUDispatcher, cpu_target
from numba.core.typing.context import Context


class PartLibrary(CPUCodeLibrary):
    """One kernel's module, as it was lowered; its libraries are those of the functions that it calls."""

    def finalize(self) -> None:
        self._finalized = True


class Linked(CPUCodeLibrary):
    """A kernel's module with those of all parts below it."""

    def finalize(self) -> None:
        # the linker takes of a module what is referred to by then
        self._linking_libraries = callers_first(self._linking_libraries)
        super().finalize()  # type: ignore[no-untyped-call]


class WholeLibrary(Linked, JITCodeLibrary):
    """The same as machine code of this process."""


class TextLibrary(Linked):
    """The same as LLVM IR."""

    def _finalize_final_module(self) -> None:
        self._finalized = True


def callers_first(libraries: list[Any]) -> list[Any]:
    """The libraries and all parts below them, each behind all that call it."""
    done: dict[Any, None] = {}

    def visit(library: Any) -> None:
        if library not in done:
            for called in library._linking_libraries if isinstance(library, PartLibrary) else ():
                visit(called)
            done[library] = None

    for library in libraries:
        visit(library)
    return list(reversed(done))


SCALAR = (types.Number, types.Boolean, types.Literal)
_SIGNATURES: dict[tuple[Any, ...], Any] = {}
"""What an operator or a function of numba's own gives for scalars, by it and their types."""


class Typing(Context):
    """numba's typing, which works out once what comes of scalars."""

    def resolve_function_type(self, func: Any, args: Any, kws: Any) -> Any:
        if type(func) is not types.Function or kws or not all(isinstance(kind, SCALAR) for kind in args):
            return super().resolve_function_type(func, args, kws)  # type: ignore[no-untyped-call]
        key = func, tuple(args)
        found = _SIGNATURES.get(key)
        if found is None:
            found = super().resolve_function_type(func, args, kws)  # type: ignore[no-untyped-call]
            if found is not None:
                _SIGNATURES[key] = found
        return found


class PartDispatcher(CPUDispatcher):
    """A kernel that is compiled once for an argument's type, not for each value of it that a caller knows."""

    def get_call_template(self, args: Any, kws: Any) -> Any:
        plain: Callable[[Any], Any] = types.unliteral
        return super().get_call_template(tuple(map(plain, args)), {name: plain(kind) for name, kind in kws.items()})


# The long description of a record, which the compiler notes of every pass over every kernel, is written once.
types.Record.__repr__ = cache(types.Record.__repr__)  # type: ignore[method-assign]


class PartContext(CPUContext):
    """Lowers, and makes no machine code."""

    @cache  # noqa: B019 (of two contexts, which live as long as the process)
    def load_additional_registries(self) -> None:
        super().load_additional_registries()  # type: ignore[no-untyped-call]

    def get_executable(self, library: Any, fndesc: Any, env: Any) -> Any:
        library._ensure_finalized()
        name = fndesc.qualname.rpartition(".")[2]
        return _dynfunc.make_function(
            fndesc.lookup_module(), name, "part of other kernels", _refusal(), env, (library,)
        )


@cache
def _refusal() -> int:
    """Address of a function that raises: a part is not to be called from Python."""
    address = ctypes.cast(ctypes.pythonapi.PyErr_NoMemory, ctypes.c_void_p).value
    assert address is not None
    return address


@cache
def _target(context_class: type, library_class: type) -> Any:
    """What numba's compiler asks of a target, with a context and code libraries of our own."""
    codegen = copy.copy(cpu_target.target_context.codegen())
    codegen._library_class = library_class
    typing = copy.copy(cpu_target.typing_context)
    typing.__class__ = Typing
    context = cpu_target.target_context.subtarget(_internal_codegen=codegen, typing_context=typing)
    context.__class__ = context_class
    return SimpleNamespace(typing_context=typing, target_context=context, options=cpu_target.options)


@dataclass
class Parts:
    """What numba is to make of kernels that others call, of the one that is called, and of the one whose text is asked
    for."""

    context: type = PartContext
    library: type = PartLibrary
    whole: type = WholeLibrary
    text: type = TextLibrary
    dispatcher: type = PartDispatcher


parts = Parts()
"""Of this process."""


def _dispatcher(function: Any, options: dict[str, Any], context_class: type, library_class: type) -> Any:
    """numba's dispatcher, with a target of our own; the function itself where numba is told not to compile."""
    dispatcher = njit(**options)(function)
    if dispatcher is not function:
        dispatcher._compiler.targetdescr = _target(context_class, library_class)
    return dispatcher


BARE = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}


def part(function: Any, options: dict[str, Any]) -> Any:
    """Dispatcher of a kernel for use by other kernels."""
    dispatcher = _dispatcher(function, options | BARE, parts.context, parts.library)
    if dispatcher is not function:
        dispatcher.__class__ = parts.dispatcher
    return dispatcher


def whole(function: Any, options: dict[str, Any], signature: Any = None) -> Any:
    """Dispatcher of a kernel that is called from Python, for one signature only if one is given."""
    dispatcher = _dispatcher(function, options, CPUContext, parts.whole)
    if signature is not None and dispatcher is not function:
        dispatcher.compile(signature)
        dispatcher.disable_compile()
    return dispatcher


def module_text(function: Any, signature: Any, options: dict[str, Any]) -> tuple[str, str]:
    """Name of a kernel's function in LLVM IR, and that IR: it and all below it, optimised as numba is told to."""
    dispatcher = _dispatcher(function, options | BARE, parts.context, parts.text)
    dispatcher.compile(signature)
    result = dispatcher.overloads[signature.args]
    return result.fndesc.llvm_func_name, result.library.get_llvm_str()
