"""Code that knows the fields of a record by name, not where they lie: the same for every record that has them.

Each place is a constant that is declared where it is used, and defined once where all is linked.

Checked  tests/orbital/test_keeping.py
"""

from __future__ import annotations

from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any

from llvmlite import binding as llvm
from llvmlite import ir
from numba.core import types

from orbital.linking import PartContext

PLACE = "place."
"""What the name of a field's place begins with."""
WORD = ir.IntType(64)


class _Placeless:
    """A record's type without the places of its fields; all else is the record's own."""

    def __init__(self, record: Any, builder: Any) -> None:
        self._record, self._builder = record, builder

    def __getattr__(self, name: str) -> Any:
        return getattr(self._record, name)

    def offset(self, name: str) -> Any:
        module = self._builder.module
        place = module.globals.get(PLACE + name)
        if place is None:
            place = ir.GlobalVariable(module, WORD, PLACE + name)
            place.global_constant = True
        return self._builder.load(place)


class PlacelessContext(PartContext):
    """Lowers what reads and writes the fields of a record without knowing where they lie."""

    def _note(self, record: Any, name: str) -> None:
        library = self.active_code_library
        library.fields[name] = str(record.typeof(name))
        library.record = record

    def get_getattr(self, typ: Any, attr: str) -> Any:
        found = super().get_getattr(typ, attr)  # type: ignore[no-untyped-call]
        if not isinstance(typ, types.Record):
            return found

        def get(context: Any, builder: Any, typ: Any, value: Any, attr: str) -> Any:
            self._note(typ, attr)
            return found(context, builder, _Placeless(typ, builder), value, attr)

        return get

    def get_setattr(self, attr: str, sig: Any) -> Any:
        record, kind = sig.args
        if not isinstance(record, types.Record):
            return super().get_setattr(attr, sig)  # type: ignore[no-untyped-call]
        put = self._setattrs[None].find((record, kind))

        def set_(builder: Any, args: Any) -> Any:
            self._note(record, attr)
            return put(self, builder, SimpleNamespace(args=(_Placeless(record, builder), kind)), args, attr)

        return set_


class Places:
    """A module that says where the fields of a record lie: it is linked behind all that ask."""

    def __init__(self, offsets: Mapping[str, int]) -> None:
        lines = [f'@"{PLACE}{name}" = linkonce_odr constant i64 {offset}' for name, offset in offsets.items()]
        self._module = llvm.parse_assembly("\n".join(lines))
        self._reload_init: set[Any] = set()

    def _get_module_for_linking(self) -> Any:
        return self._module
