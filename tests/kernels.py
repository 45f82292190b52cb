"""Every choice of terms is compiled once in a whole test run, whichever process asks first.

What costs is numba's typing, half a minute for a net. Its result, the IR that goes into an FMU, is kept in a folder
that all processes of the run share. An `Instance` loads its entry from a library made of that IR, and a build takes the
IR as it is. What compiles has numba loaded already: see `tests.emitting`. A test that judges compiling asks for
`compiled_anew`, or puts `instance.compiled` back.

Checked  tests/packaging/test_fmu.py: the library's bits are those of the formulas run as plain Python
"""

from __future__ import annotations

import atexit
import ctypes
import fcntl
import os
import shutil
import sys
import tempfile
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any

from llvmlite import binding as llvm

from dcone_cosim.build import cache_folder
from fmu_src import instance
from fmu_src.catalogue import MODELS
from fmu_src.interface import Model
from fmu_src.packaging import builds, compile, link, platforms
from tests import emitting

OTHER_CODE = ("NUMBA_BOUNDSCHECK", "NUMBA_DISABLE_JIT")
"""Environment variables under which kernels are other code than an FMU's."""
V3 = {"avx", "avx2", "bmi", "bmi2", "f16c", "fma", "lzcnt", "movbe"}
"""What a processor of the second code path has, by LLVM's names."""
QUICKLY = "-Xclang", "-disable-llvm-passes"
"""clang turns what numba has optimised into machine code as it is."""

emit = compile.emit
"""What compiles, whatever the run has already, in a process that begins with nothing."""
emit_quickly = emitting.emit
"""The same text, sooner."""


def compiled_where_run() -> bool:
    """Whether a developer has asked numba for code that no library holds: one that checks bounds, or none at all."""
    return any(os.environ.get(name, "0") != "0" for name in OTHER_CODE)


def keep() -> None:
    """Have this process keep the kernels that it compiles among those of builds, and look for them there.

    numba reads its settings as it is imported: with those of a build it lowers a kernel to the same module, which is
    then kept for both. What is linked of modules is machine code for this processor, and optimised.
    """
    if not compiled_where_run():
        os.environ |= {name: value for name, value in compile.ENVIRONMENT.items() if name.startswith("NUMBA_")}
        assert "numba" not in sys.modules

        from numba.core import config

        from orbital import keeping

        config.OPT, config.LOOP_VECTORIZE = config._OptLevel(3), 1  # type: ignore[attr-defined]
        config.CPU_NAME = config.CPU_FEATURES = None
        keeping.keep_in(cache_folder() / builds.COMMON)
        share_wholes()


def share_wholes() -> None:
    """Have this process compile a kernel for Python once, however often tests write it down: two that are made from the
    same have one dispatcher, which knows the types of its arguments apart.

    Checked  tests/packaging/test_shared_kernels.py
    """
    from orbital import linking
    from orbital.keys import Keys, NoKeyError

    keys, made, known = Keys(), linking.whole, dict[tuple[str, int], Any]()

    def whole(function: Any, options: dict[str, Any], signature: Any = None) -> Any:
        parts = linking.parts
        if signature is None:
            with suppress(NoKeyError):
                key = keys.of((function, sorted(options.items()))), id(parts)
                _, dispatcher = known[key] = known.get(key) or (parts, made(function, options))
                return dispatcher
        return made(function, options, signature)

    linking.whole = whole


class Entry:
    """A model's entry in a loaded library, called as numba's is."""

    def __init__(self, library: Path) -> None:
        self._call = ctypes.CDLL(str(library))[compile.ENTRY]
        whole, real, at = ctypes.c_int64, ctypes.c_double, ctypes.c_void_p
        array = [at, at, whole, whole, at, whole, whole]
        self._call.argtypes = [at, at, whole, *array, *array, real, real]
        self._call.restype = ctypes.c_int32

    def __call__(self, command: int, record: Any, work: Any, time: float, step: float) -> int:
        result, exception = ctypes.c_int32(0), ctypes.c_void_p(None)
        status = self._call(
            ctypes.byref(result), ctypes.byref(exception), command,
            None, None, 1, record.nbytes, record.ctypes.data, 1, record.nbytes,
            None, None, work.size, 8, work.ctypes.data, work.size, 8,
            time, step,
        )  # fmt: skip
        if status:
            raise RuntimeError(f"the entry left with numba's status {status}")
        return result.value


def made_once(path: Path, make: Callable[[Path], None]) -> Path:
    """A file that the first process to want it makes, while others wait for it."""
    if not path.exists():
        with path.with_name(path.name + ".lock").open("w") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            if not path.exists():
                draft = path.with_name(path.name + ".draft")
                make(draft)
                draft.replace(path)
    return path


class Shared:
    """What is compiled in one test run, in a folder.

    long    choices of terms that run for long in all: their libraries are optimised as an FMU's; the others' take less
            than half the time to make and a fifth more to run, with the same bits
    """

    def __init__(self, folder: Path, long: Sequence[Mapping[str, str]]) -> None:
        self._folder, self._long = folder, [frozenset(terms.items()) for terms in long]
        self.entry = cache(self._entry)

    def _path(self, name: str, terms: tuple[tuple[str, str], ...], suffix: str) -> Path:
        key = builds.fingerprint(MODELS[name].interface(dict(terms)))
        return self._folder / f"{name}-{key[:32]}{suffix}"

    def ir(self, name: str, terms: tuple[tuple[str, str], ...]) -> Path:
        """The IR of a model; an FMU in the user's cache has it as well, and kernels that are kept there are taken."""
        interface = MODELS[name].interface(dict(terms))

        def make(path: Path) -> None:
            known = builds.kernels(cache_folder(), name, builds.fingerprint(interface))
            if known is None:
                emit_quickly(interface.model, interface.terms, path, cache_folder() / builds.COMMON)
            else:
                path.write_bytes(known)

        return made_once(self._path(name, terms, ".ll"), make)

    def _entry(self, name: str, terms: tuple[tuple[str, str], ...]) -> Entry:
        passes = () if frozenset(terms) in self._long else QUICKLY
        library = self._path(name, terms, ".so")
        return Entry(made_once(library, lambda path: _library(self.ir(name, terms), path, passes)))


def _library(ir: Path, path: Path, passes: Sequence[str] = ()) -> None:
    """A shared library with the entry alone, for this processor; `passes` are for clang."""
    (target, *_) = platforms.host().places[0].targets
    has = {name for name, there in llvm.get_host_cpu_features().items() if there}
    best = target.processors[-1] if has >= V3 else target.processors[0]
    with tempfile.TemporaryDirectory(dir=path.parent) as folder:
        visible = Path(folder) / "visible.ll"
        visible.write_text(ir.read_text().replace("define hidden", "define"))
        machine_code = visible.with_suffix(".o")
        first = ["-target", target.triple, *link.FLAGS]
        link.clang([*first, f"-mcpu={best}", *passes, "-c", visible, "-o", machine_code])
        link.clang([*first, "-s", "-shared", machine_code, "-o", path, "-lm"])


def share(folder: Path, long: Sequence[Mapping[str, str]] = ()) -> None:
    """Have this process take what is compiled from a folder, and put there what it compiles; `long` as in `Shared`."""
    folder.mkdir(exist_ok=True)
    shared = Shared(folder, long)

    def entry_of(model: Model, terms: Mapping[str, str]) -> Any:
        if MODELS.get(model.name) is not model:  # a test's own
            return instance.compiled(model, terms)
        return shared.entry(model.name, tuple(terms.items()))

    def emit_once(model: Model, terms: Mapping[str, str], path: Path, kept: Path) -> None:
        if MODELS.get(model.name) is not model:
            emit(model, terms, path, kept)
        else:
            shutil.copyfile(shared.ir(model.name, tuple(terms.items())), path)

    if not compiled_where_run():
        instance.entry_of = entry_of
    compile.emit = emit_once


def alone() -> None:
    """Have this process make libraries of what it compiles, as a test run does, in a folder that goes with it."""
    folder = tempfile.mkdtemp()
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    share(Path(folder))
