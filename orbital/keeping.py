"""Kernels kept from one build to the next: a choice of terms compiles what no choice before it had.

Two choices of terms share most of their kernels. What numba makes of one, a module in LLVM's bitcode, is kept under a
hash of all that it is made from: its code, what it closes over and refers to, the kernels among these likewise, and
the types of its arguments. One thing differs between any two choices, the places of a record's fields. So a module
that is kept refers to each place by name, and the entry, linked last, says where the fields lie.

    folder/KEY/FIELDS     one module, with the fields that it and all below it use, by name and type

A kernel made of something that has no hash here is compiled and not kept, and so is all that calls it.

Checked  tests/orbital/test_keeping.py
"""

from __future__ import annotations

import hashlib
import json
import os
import pickle
import platform
import tempfile
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import llvmlite
import numba
import numpy as np
from llvmlite import binding as llvm
from llvmlite import ir
from numba.core import sigutils, types
from numba.core.compiler import compile_result
from numba.core.environment import Environment
from numba.core.funcdesc import PythonFunctionDescriptor
from numba.core.typing.templates import signature

from orbital import linking
from orbital.keys import Keys, NoKeyError, digest, source
from orbital.linking import PartContext, PartDispatcher, PartLibrary, TextLibrary, callers_first

PLACE = "place."
"""What the name of a field's place begins with."""
WORD = ir.IntType(64)


@cache
def _tools() -> str:
    """Hash of what makes code of a kernel: versions, settings, and our own rules of linking."""
    settings = sorted((name, value) for name, value in os.environ.items() if name.startswith("NUMBA_"))
    versions = numba.__version__, llvmlite.__version__, np.__version__, platform.python_version(), platform.machine()
    rules = (source(name) for name in ("orbital.kernel", "orbital.linking", "orbital.keeping", "orbital.keys"))
    return digest(*versions, json.dumps(settings), *rules)


@dataclass
class _Kept:
    """What is kept of one kernel, compiled for one set of arguments.

    name      of its function
    fields    of the record that it and all below it use, with their types
    gives     the type it returns
    bitcode   of its module
    calls     where the kernels that it calls are kept, as (key, fields)
    """

    name: str
    fields: dict[str, str]
    gives: Any
    bitcode: bytes
    calls: list[tuple[str, str]]


class KeptLibrary(PartLibrary):
    """A kernel's module that refers to a record's fields by name.

    place     where it is kept, None: not at all
    fields    that it and all below it use, with their types
    """

    place: tuple[str, str] | None = None

    def __init__(self, codegen: Any, name: str) -> None:
        super().__init__(codegen, name)  # type: ignore[no-untyped-call]
        self.fields: dict[str, str] = {}
        self.record: Any = None

    def finalize(self) -> None:
        """What numba made of a function of its own for this kernel becomes part of it."""
        own = {function.name for function in self._final_module.functions if not function.is_declaration}
        called = []
        for library in self._linking_libraries:
            if isinstance(library, KeptLibrary) and library.place is not None:
                called.append(library)
            elif library.name != "nrt":
                self._final_module.link_in(library._get_module_for_linking(), preserve=True)
        for function in self._final_module.functions:
            if not function.is_declaration and function.name not in own:
                function.linkage = "internal"
        self._linking_libraries = called
        super().finalize()

    def rename(self, name: str) -> None:
        """Call its function by a name that tells what it is made from, and so what numba adds to it."""
        added = 0
        for function in self._final_module.functions:
            if not function.is_declaration:
                internal = str(function.linkage) == str(llvm.Linkage.internal)
                added += internal
                function.name = f"{name}.{added}" if internal else name


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


class KeptContext(PartContext):
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


class KeptDispatcher(PartDispatcher):
    """A kernel that is looked for among those kept before it is compiled."""

    store: Store
    _compiler: Any
    overloads: Any

    def compile(self, sig: Any) -> Any:
        args, _ = sigutils.normalize_signature(sig)  # type: ignore[no-untyped-call]
        args = tuple(args)
        if args in self.overloads:
            return self.overloads[args].entry_point
        key = self.store.key(self.py_func, self.targetoptions, args)
        context = self._compiler.targetdescr.target_context
        if key is not None:
            record = next((kind for kind in args if isinstance(kind, types.Record)), None)
            found = self.store.find(key, record, context.codegen())
            if found is not None:
                return self._adopt(args, context, *found)
        entry_point = super().compile(sig)
        result = self.overloads[args]
        if key is not None and all(called.place is not None for called in result.library._linking_libraries):
            self.store.keep(key, self.py_func, result)
        return entry_point

    def _adopt(self, args: tuple[Any, ...], context: Any, kept: _Kept, library: KeptLibrary) -> Any:
        """Have what is kept for an overload."""
        library.record = next((kind for kind in args if isinstance(kind, types.Record)), None)
        function = self.py_func
        named = function.__code__.co_varnames[: len(args)]
        describe: Any = PythonFunctionDescriptor
        description = describe(
            True, function.__module__, function.__qualname__, kept.name, "", {}, kept.gives, {}, named, (),
            mangler=lambda *_, **__: kept.name, argtypes=args, env_name=f"environment of {kept.name}",
        )  # fmt: skip
        environment = Environment.from_fndesc(description)  # type: ignore[no-untyped-call]
        entry_point = context.get_executable(library, description, environment)
        context.insert_user_function(entry_point, description, [library])
        made: dict[str, Any] = {
            "signature": signature(kept.gives, *args),  # type: ignore[no-untyped-call]
            "library": library,
            "fndesc": description,
            "entry_point": entry_point,
            "objectmode": False,
            "lifted": (),
            "target_context": context,
        }
        result = compile_result(**made)  # type: ignore[no-untyped-call]
        self.add_overload(result)
        return entry_point


class KeptText(TextLibrary):
    """An entry's text; it says where the fields of its records lie."""

    def __init__(self, codegen: Any, name: str) -> None:
        super().__init__(codegen, name)  # type: ignore[no-untyped-call]
        self.fields: dict[str, str] = {}
        self.record: Any = None

    def finalize(self) -> None:
        parts: list[Any] = [part for part in callers_first(self._linking_libraries) if isinstance(part, KeptLibrary)]
        names = set(self.fields).union(*(part.fields for part in parts))
        record = next((part.record for part in (self, *parts) if part.record is not None), None)
        if record is not None:
            self._linking_libraries.insert(0, _Places({name: record.offset(name) for name in sorted(names)}))
        super().finalize()


class _Places:
    """A module that says where the fields of a record lie: it is linked behind all that ask."""

    def __init__(self, offsets: Mapping[str, int]) -> None:
        lines = [f'@"{PLACE}{name}" = linkonce_odr constant i64 {offset}' for name, offset in offsets.items()]
        self._module = llvm.parse_assembly("\n".join(lines))
        self._reload_init: set[Any] = set()

    def _get_module_for_linking(self) -> Any:
        return self._module


class Store:
    """The kernels kept in a folder, which may grow at any time and by any process."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._keys = Keys()
        self._loaded: dict[tuple[str, str], tuple[_Kept, KeptLibrary]] = {}

    def key(self, function: Any, options: Mapping[str, Any], args: tuple[Any, ...]) -> str | None:
        """Of a kernel for arguments of these types; None where something has no hash."""
        try:
            kinds = ("record" if isinstance(kind, types.Record) else self._kind(kind) for kind in args)
            made = self._keys.of(function), self._keys.of(sorted(options.items()))
            return digest(_tools(), *made, *kinds)
        except NoKeyError:
            return None

    def _kind(self, kind: Any) -> str:
        if isinstance(kind, types.Dispatcher):
            return self._keys.of(kind.dispatcher.py_func)
        return self._keys.of(kind)

    def find(self, key: str, record: Any, codegen: Any) -> tuple[_Kept, KeptLibrary] | None:
        """What is kept of a kernel for a record that has the fields it uses."""
        with suppress(OSError):
            for path in sorted((self._folder / key).glob("[!.]*")):
                found = self._load((key, path.name), codegen)
                if found is not None and _has(record, found[0].fields):
                    return found
        return None

    def _load(self, place: tuple[str, str], codegen: Any) -> tuple[_Kept, KeptLibrary] | None:
        if place not in self._loaded:
            kept = _read(self._folder.joinpath(*place))
            called = [self._load(call, codegen) for call in kept.calls] if kept is not None else []
            if kept is None or None in called:
                return None
            library = KeptLibrary(codegen, kept.name)
            library._final_module = llvm.parse_bitcode(kept.bitcode)
            library._linking_libraries = [found[1] for found in called if found is not None]
            library.place, library.fields, library._finalized = place, kept.fields, True
            self._loaded[place] = kept, library
        return self._loaded[place]

    def keep(self, key: str, function: Any, result: Any) -> None:
        """Keep what a kernel was compiled to, and name it by what it is made from."""
        library: KeptLibrary = result.library
        for called in library._linking_libraries:
            library.fields |= called.fields
        fields = dict(sorted(library.fields.items()))
        place = key, digest(json.dumps(fields))[:32]
        where = f"{function.__module__}.{function.__qualname__}".replace(".<locals>", "")
        name = f"{where}.{digest(*place)[:16]}"
        library.rename(name)
        result.fndesc.mangled_name = name
        calls = [called.place for called in library._linking_libraries]
        kept = _Kept(name, fields, result.signature.return_type, library._final_module.as_bitcode(), calls)
        library.place = place
        self._loaded[place] = kept, library
        _write(self._folder.joinpath(*place), kept)


def _has(record: Any, fields: Mapping[str, str]) -> bool:
    """Whether a record, or none, has fields of these types."""
    own = {} if record is None else record.fields
    return all(name in own and str(own[name].type) == kind for name, kind in fields.items())


def _read(path: Path) -> _Kept | None:
    """A file of the store; None for one that is not whole."""
    with suppress(OSError):
        said, _, content = path.read_bytes().partition(b"\n")
        if hashlib.sha256(content).hexdigest().encode() == said:
            kept: _Kept = pickle.loads(content)
            return kept
    return None


def _write(path: Path, kept: _Kept) -> None:
    """Put a file into the store, whole or not at all; one that can not be written is compiled again next time."""
    content = pickle.dumps(kept)
    with suppress(OSError):
        path.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.NamedTemporaryFile(dir=path.parent, prefix=".", delete=False) as draft:
            draft.write(hashlib.sha256(content).hexdigest().encode() + b"\n" + content)
        os.replace(draft.name, path)


def keep_in(folder: Path) -> None:
    """From now on have this process look for kernels in a folder, and keep there what it compiles."""
    KeptDispatcher.store = Store(folder)
    linking.parts = linking.Parts(KeptContext, KeptLibrary, KeptText, KeptDispatcher)
