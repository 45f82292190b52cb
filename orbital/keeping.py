"""Kernels kept from one build to the next: a choice of terms compiles what no choice before it had.

Two choices of terms share most of their code. What numba makes of a kernel, a module in LLVM's bitcode, is kept under
a hash of what it is made from: its code, what it closes over and refers to, and the types of its arguments. Two things
differ between choices where the code is the same, and a module that is kept leaves them open:

- the places of a record's fields. It refers to each by name, and the entry, linked last, says where the fields lie.
- the kernels that it calls. All that counts of them is what they are called with and what they give; which ones they
  are is told when the module is taken out again. So another force law does not compile the integrator anew.

    folder/KEY/USE     one module, with the fields that it uses, by name and type, and what it calls

A kernel made of something that has no hash here is compiled and not kept, and so is all that calls it.

Checked  tests/orbital/test_keeping.py
"""

from __future__ import annotations

import hashlib
import itertools
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
from typing import Any

import llvmlite
import numba
import numpy as np
from llvmlite import binding as llvm
from numba.core import ir_utils, sigutils, types
from numba.core.compiler import compile_result
from numba.core.environment import Environment
from numba.core.errors import NumbaError
from numba.core.funcdesc import PythonFunctionDescriptor
from numba.core.typing.templates import signature

from orbital import linking
from orbital.keys import Apart, Keys, NoKeyError, digest, source
from orbital.linking import Linked, PartDispatcher, PartLibrary, TextLibrary, WholeLibrary, callers_first
from orbital.places import PlacelessContext, Places

OWN, CALLED = "own", "called."
"""What the names of a kernel's functions, and of those that it calls, begin with where it is kept."""
NO_RECORD = types.Record([], 0, False)
"""Where a record is meant, whichever it is."""
STARRED = types.StarArgTuple, types.StarArgUniTuple
"""What is given to a kernel that takes any number of arguments."""


@cache
def _tools() -> str:
    """Hash of what makes code of a kernel: versions, settings, and our own rules of linking."""
    settings = sorted((name, value) for name, value in os.environ.items() if name.startswith("NUMBA_"))
    versions = numba.__version__, llvmlite.__version__, np.__version__, platform.python_version(), platform.machine()
    rules = (source(f"orbital.{name}") for name in ("kernel", "linking", "places", "keeping", "keys"))
    return digest(*versions, json.dumps(settings), *rules)


@dataclass
class _Kept:
    """What is kept of one kernel, compiled for one set of arguments.

    fields    of the record that it uses, with their types
    gives     the type it returns
    calls     what it calls: number among the kernels that it is made from, types of the arguments, type that it gives
    bitcode   of its module, whose functions are called by `_numbered`
    """

    fields: dict[str, str]
    gives: Any
    calls: list[tuple[int, tuple[Any, ...], Any]]
    bitcode: bytes


@dataclass
class _Made:
    """What one kernel is made from.

    function  that it was written as
    args      types of its arguments
    name      of its function: a hash of all, with the kernels that it calls
    key       where it is kept: a hash without these
    apart     the kernels that it may call
    """

    function: Any
    args: tuple[Any, ...]
    name: str
    key: str
    apart: Apart

    @property
    def record(self) -> Any:
        """The type of the record among the arguments, None where there is none."""
        kinds = (one for kind in self.args for one in (kind if isinstance(kind, STARRED) else (kind,)))
        records = (kind.dtype if isinstance(kind, types.Array) else kind for kind in kinds)
        return next((kind for kind in records if isinstance(kind, types.Record)), None)


class KeptLibrary(PartLibrary):
    """A kernel's module that refers to a record's fields by name.

    made      what it is made from, None: it is not kept
    fields    that it uses, with their types
    loose     whether it is not to be kept, for what it is made of or calls
    """

    made: _Made | None = None
    gives: Any = None
    loose = False

    def __init__(self, codegen: Any, name: str) -> None:
        super().__init__(codegen, name)  # type: ignore[no-untyped-call]
        self.fields: dict[str, str] = {}
        self.record: Any = None

    def finalize(self) -> None:
        """What numba made of a function of its own for this kernel becomes part of it."""
        own = {function.name for function in self._final_module.functions if not function.is_declaration}
        called = []
        for library in dict.fromkeys(self._linking_libraries):
            if isinstance(library, KeptLibrary) and (library.made is not None or library.loose):
                called.append(library)
                self.loose |= library.loose
            elif library.name != "nrt":
                self._final_module.link_in(library._get_module_for_linking(), preserve=True)
        for function in self._final_module.functions:
            if not function.is_declaration and function.name not in own:
                function.linkage = "internal"
        self._linking_libraries = called
        super().finalize()

    def number(self, name: str) -> None:
        """Call its functions, the one by this name and what numba added to it, and those that it calls by numbers."""
        names = {library.made.name: f"{CALLED}{k}" for k, library in enumerate(self._linking_libraries)} | {name: OWN}
        for function in self._final_module.functions:
            if str(function.linkage) == str(llvm.Linkage.internal):
                names[function.name] = f"{OWN}.{len(names)}"
            function.name = names.get(function.name, function.name)

    def name_functions(self) -> None:
        """Call those that have numbers by what they are made from."""
        assert self.made is not None
        called = {f"{CALLED}{k}": library.made.name for k, library in enumerate(self._linking_libraries)}
        for function in self._final_module.functions:
            own, dot, added = function.name.partition(".")
            if own == OWN:
                function.name = self.made.name + dot + added
            else:
                function.name = called.get(function.name, function.name)


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
        made = self.store.made(self.py_func, self.targetoptions, args)
        context = self._compiler.targetdescr.target_context
        library = self.store.find(made, context.codegen()) if made is not None else None
        if library is not None:
            return self._adopt(context, library)
        ir_utils._the_max_label._value = 0  # blocks are numbered alike, whatever else was compiled before
        entry_point = super().compile(sig)
        result = self.overloads[args]
        if made is None or result.library.loose:
            result.library.loose = True
        else:
            self.store.keep(made, result)
        return entry_point

    def _adopt(self, context: Any, library: KeptLibrary) -> Any:
        """Have what is kept for an overload."""
        assert library.made is not None
        function, args, name = self.py_func, library.made.args, library.made.name
        library.record = library.made.record
        named = function.__code__.co_varnames[: len(args)]
        describe: Any = PythonFunctionDescriptor
        description = describe(
            True, function.__module__, function.__qualname__, name, "", {}, library.gives, {}, named, (),
            mangler=lambda *_, **__: name, argtypes=args, env_name=f"environment of {name}",
        )  # fmt: skip
        environment = Environment.from_fndesc(description)  # type: ignore[no-untyped-call]
        entry_point = context.get_executable(library, description, environment)
        context.insert_user_function(entry_point, description, [library])
        result: dict[str, Any] = {
            "signature": signature(library.gives, *args),  # type: ignore[no-untyped-call]
            "library": library,
            "fndesc": description,
            "entry_point": entry_point,
            "objectmode": False,
            "lifted": (),
            "target_context": context,
        }
        self.add_overload(compile_result(**result))  # type: ignore[no-untyped-call]
        return entry_point


class _Placed(Linked):
    """A kernel with all below it, which says where the fields of its records lie."""

    def __init__(self, codegen: Any, name: str) -> None:
        super().__init__(codegen, name)  # type: ignore[no-untyped-call]
        self.fields: dict[str, str] = {}
        self.record: Any = None

    def finalize(self) -> None:
        parts: list[Any] = [part for part in callers_first(self._linking_libraries) if isinstance(part, KeptLibrary)]
        names = set(self.fields).union(*(part.fields for part in parts))
        records = {part.record for part in (self, *parts) if part.record is not None}
        if len(records) > 1:
            raise TypeError("the kernels that are linked know fields of two records, of which only one can be placed")
        for record in records:
            self._linking_libraries.insert(0, Places({name: record.offset(name) for name in sorted(names)}))
        super().finalize()


class KeptText(_Placed, TextLibrary):
    """An entry's text."""


class KeptWhole(_Placed, WholeLibrary):
    """A kernel's machine code.

    What it is linked of is its own, and has names of its own: kernels for records of two types have one name, by which
    the engine would take one for both.
    """

    _numbers = itertools.count()

    def finalize(self) -> None:
        module = self._final_module
        self._own = {one.name for one in (*module.functions, *module.global_variables) if not one.is_declaration}
        super().finalize()

    def _optimize_final_module(self) -> None:
        number = next(self._numbers)
        for one in (*self._final_module.functions, *self._final_module.global_variables):
            if not (one.is_declaration or one.name in self._own or one.name.startswith("llvm.")):
                one.linkage, one.name = "internal", f"{one.name}.{number}"
        super()._optimize_final_module()  # type: ignore[no-untyped-call]


class Store:
    """The kernels kept in a folder, which may grow at any time and by any process."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._keys = Keys()
        self._loaded: dict[tuple[str, Any], KeptLibrary] = {}

    def made(self, function: Any, options: Mapping[str, Any], args: tuple[Any, ...]) -> _Made | None:
        """What a kernel for arguments of these types is made from; None where something has no hash."""
        apart = Apart(self._keys)
        try:
            what = function, sorted(options.items()), tuple(_with(NO_RECORD, kind) for kind in args)
            whole, key = (digest(_tools(), *map(keys.of, what)) for keys in (self._keys, apart))
        except NoKeyError:
            return None
        where = f"{function.__module__}.{function.__qualname__}".replace(".<locals>", "")
        return _Made(function, args, f"{where}.{whole[:16]}", key, apart)

    def find(self, made: _Made, codegen: Any) -> KeptLibrary | None:
        """What is kept of a kernel, for a record that has the fields it uses, and calling what it may call here."""
        if (made.name, made.record) in self._loaded:
            return self._loaded[made.name, made.record]
        with suppress(OSError):
            for path in sorted((self._folder / made.key).glob("[!.]*")):
                kept = _read(path)
                if kept is None or not _has(made.record, kept.fields):
                    continue
                called = [_called(made, *call) for call in kept.calls]
                if None not in called:
                    library = KeptLibrary(codegen, made.name)
                    library._final_module = llvm.parse_bitcode(kept.bitcode)
                    library._linking_libraries = called
                    library._finalized = True
                    self._load(library, made, kept)
                    return library
        return None

    def _load(self, library: KeptLibrary, made: _Made, kept: _Kept) -> None:
        library.made, library.fields, library.gives = made, kept.fields, kept.gives
        library.name_functions()
        self._loaded[made.name, made.record] = library

    def keep(self, made: _Made, result: Any) -> None:
        """Keep what a kernel was compiled to, and name it by what it is made from."""
        library: KeptLibrary = result.library
        calls = []
        for called in library._linking_libraries:
            args = tuple(_with(NO_RECORD, kind) for kind in called.made.args)
            calls.append((made.apart.number(called.made.function), args, called.gives))
        library.number(result.fndesc.llvm_func_name)
        fields = dict(sorted(library.fields.items()))
        kept = _Kept(fields, result.signature.return_type, calls, library._final_module.as_bitcode())
        self._load(library, made, kept)
        result.fndesc.mangled_name = made.name
        _write(self._folder / made.key / digest(json.dumps(fields), str(calls))[:32], kept)


def _called(made: _Made, number: int, args: tuple[Any, ...], gives: Any) -> KeptLibrary | None:
    """One of the kernels that a kernel may call, compiled for its arguments, if it then gives this type."""
    dispatcher = made.apart.called[number]._part
    args = tuple(_with(made.record, kind) for kind in args)
    with suppress(NumbaError):
        dispatcher.compile(args)
        result = dispatcher.overloads[args]
        if result.signature.return_type == gives:
            library: KeptLibrary = result.library
            return library
    return None


def _with(record: Any, kind: Any) -> Any:
    """A type of an argument with another record in it, if it has one."""
    match kind:
        case types.Record():
            return record
        case types.Array(dtype=types.Record()):
            return kind.copy(dtype=record)
        case types.StarArgTuple() | types.StarArgUniTuple():
            return types.StarArgTuple([_with(record, one) for one in kind])  # type: ignore[no-untyped-call]
        case types.Dispatcher():
            raise NoKeyError(f"no hash of an argument that is the kernel {kind}")
    return kind


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
    linking.parts = linking.Parts(PlacelessContext, KeptLibrary, KeptWhole, KeptText, KeptDispatcher)
