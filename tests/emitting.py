"""Kernels compiled in children of one process that has numba loaded: a third of what each choice of terms costs.

Each child is forked from a process that has compiled nothing, so that what it makes does not depend on what was asked
for before it.

Checked  tests/packaging/test_shared_kernels.py: the text is that of `fmu_src.packaging.compile`, byte for byte
"""

from __future__ import annotations

import gc
import itertools
import json
import os
import runpy
import subprocess
import sys
import tempfile
import traceback
from collections.abc import Mapping, Sequence
from contextlib import redirect_stdout
from pathlib import Path
from threading import Lock
from typing import Any

from fmu_src.interface import Model
from fmu_src.packaging import compile, tools

ROOT = Path(__file__).parents[1]


class Emitter:
    """The process that has numba loaded, for one process of a test run."""

    def __init__(self) -> None:
        self._owner = os.getpid()
        self._words = tempfile.TemporaryFile()  # noqa: SIM115 (it lives as long as the process)
        pipe = subprocess.PIPE
        self._process = subprocess.Popen(
            [sys.executable, "-m", __name__],
            stdin=pipe, stdout=pipe, stderr=self._words, text=True, cwd=ROOT,
            env={**os.environ, **compile.ENVIRONMENT},
        )  # fmt: skip

    def is_ours(self) -> bool:
        """Whether it answers this process, and not one that this was forked from."""
        return self._owner == os.getpid() and self._process.poll() is None

    def emit(self, model: Model, terms: Mapping[str, str], path: Path, kept: Path) -> None:
        """As `compile.emit`."""
        self._ask([model.module, dict(terms), str(path.resolve()), str(kept.resolve())], model.name)

    def run(self, program: Path, arguments: Sequence[str]) -> str:
        """What a program of Python says that is run in a child."""
        with tempfile.NamedTemporaryFile(mode="r") as told:
            self._ask([str(program), [*arguments], told.name], program.name)
            return told.read()

    def _ask(self, what: Sequence[Any], name: str) -> None:
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        begin = self._words.seek(0, os.SEEK_END)
        self._process.stdin.write(json.dumps(what) + "\n")
        self._process.stdin.flush()
        if self._process.stdout.readline() != "0\n":
            self._words.seek(begin)
            words = self._words.read().decode(errors="replace")
            raise tools.BuildError(f"compiling the kernels of {name} failed:\n{words.strip()[-2000:]}")


_lock = Lock()
_emitters: list[Emitter] = []


def emit(model: Model, terms: Mapping[str, str], path: Path, kept: Path) -> None:
    """As `compile.emit`, one at a time."""
    with _lock:
        _ours().emit(model, terms, path, kept)


def run(program: Path, arguments: Sequence[str]) -> str:
    """What a program of Python says that is run where the kernels of FMUs are compiled, one at a time."""
    with _lock:
        return _ours().run(program, arguments)


def _ours() -> Emitter:
    _emitters[:] = [emitter for emitter in _emitters if emitter.is_ours()] or [Emitter()]
    return _emitters[0]


def _load() -> None:
    """What every child needs, the tables of numba's own functions among it.

    numba numbers its types as they come, and has a record's number in the names of functions: what is made here is
    numbered far from what the children make, which then count as a process of their own does.
    """
    from numba.core.types import abstract

    from orbital import keeping, linking

    counted, abstract._typecodes = abstract._typecodes, itertools.count(1_000_000)
    keeping.keep_in(Path(os.devnull))
    for library in (linking.parts.library, linking.parts.text):
        target: Any = linking._target(linking.parts.context, library)
        target.typing_context.refresh()
        target.target_context.refresh()
    abstract._typecodes = counted


def _do(what: str, given: Any, path: str, *kept: str) -> None:
    if kept:
        Path(path).write_text(compile._lower(what, given, Path(*kept)))
        return
    sys.argv = [what, *given]
    with open(path, "w") as told, redirect_stdout(told):
        runpy.run_path(what, run_name="__main__")


def _serve() -> None:
    """A line of JSON for each choice of terms, or program, answered by the exit status of the child that does it."""
    gc.disable()
    _load()
    gc.freeze()
    for line in sys.stdin:
        child = os.fork()
        if not child:
            try:
                _do(*json.loads(line))
                os._exit(0)
            except BaseException:
                traceback.print_exc()
                sys.stderr.flush()
                os._exit(1)
        print(os.waitpid(child, 0)[1], flush=True)


if __name__ == "__main__":
    _serve()
