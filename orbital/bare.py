"""numba's compiler without its bookkeeping, for a process that does nothing but compile: the same text, a tenth sooner.

Left out are events and timers, the lock round LLVM, which has one thread here, and after each pass over a function
which of its variables live where, what only generators and object mode ask for. numba's version is pinned.

Checked  tests/orbital/test_bare.py
"""

from __future__ import annotations

from contextlib import nullcontext
from typing import Any

from llvmlite.binding import ffi
from numba.core import event, ir, postproc, transforms

_whole_run = postproc.PostProcessor.run
_whole_list = ir.Inst._rec_list_vars
LEAVES = str, int, ir.Loc, type(None)
"""What of an instruction holds no variable."""


def _run(self: Any, emit_dels: bool = False, extend_lifetimes: bool = False) -> None:
    """Settle a function's blocks; lives of variables are worked out where they are asked for."""
    function = self.func_ir
    if function.is_generator:
        _whole_run(self, emit_dels, extend_lifetimes)
        return
    function.blocks = transforms.canonicalize_cfg(function.blocks)  # type: ignore[no-untyped-call]
    function.variable_lifetime = postproc.VariableLifetime(function.blocks)  # type: ignore[no-untyped-call]
    function.generator_info = None
    if emit_dels:
        self._insert_var_dels(extend_lifetimes=extend_lifetimes)


def _variables(self: Any, value: Any) -> Any:
    """Variables in a part of an instruction, the commonest kinds of part first."""
    kind = type(value)
    if kind is ir.Var:
        return [value]
    if kind in LEAVES:
        return []
    if kind is list or kind is tuple:
        return [variable for one in value for variable in _variables(self, one)]
    return _whole_list(self, value)  # type: ignore[no-untyped-call]


def leave_out() -> None:
    """From now on have numba do without, in this process."""
    event.trigger_event = lambda *_, **__: nullcontext()  # type: ignore[assignment]
    ffi._lib_fn_wrapper.__call__ = lambda self, *arguments: self._cfn(*arguments)
    postproc.PostProcessor.run = _run  # type: ignore[method-assign]
    ir.Inst._rec_list_vars = _variables  # type: ignore[method-assign]
