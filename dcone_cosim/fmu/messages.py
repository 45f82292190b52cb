"""What an FMU says while it works: its messages, and whether it promises an answer for later.

A library of fmpy's formats the variadic message in C and hands it to one Python function, which it keeps in a global.
So we load a copy of it for ourselves: anybody else who uses fmpy in this process puts a function of theirs there, and
takes it away again. The environment pointer that every instance is given tells the instances apart.
"""

from __future__ import annotations

import ctypes
import itertools
import shutil
from collections import deque
from collections.abc import Callable
from typing import Any

import fmpy
import fmpy.fmi1
import fmpy.fmi2 as fmi2
import fmpy.logging

from dcone_cosim.scratch import Scratch

STATUS = ("OK", "Warning", "Discard", "Error", "Fatal", "Pending")
KEPT = 20
"""How many of an instance's latest messages are kept."""
TOLD = 3
"""How many of them an error quotes."""

listeners: list[Callable[[str], None]] = []
"""Called with every message as it comes; a child process passes them on before it may die."""

_open: dict[int, Messages] = {}
_keys = itertools.count(1)


class Messages:
    """The messages of one instance during the call that was made to it last, and the callbacks that gather them.

    late      it called stepFinished, which is for steps that go on after they have returned
    """

    def __init__(self) -> None:
        self._key = next(_keys)
        self._said: deque[tuple[int, str]] = deque(maxlen=KEPT)
        self.late = False
        _open[self._key] = self

    def callbacks(self) -> Any:
        made = fmi2.fmi2CallbackFunctions.from_buffer_copy(_callbacks)
        made.componentEnvironment = self._key
        return made

    def add(self, status: int, text: str) -> None:
        self._said.append((status, text))

    def forget(self) -> None:
        self._said.clear()

    @property
    def silent(self) -> bool:
        """Whether it has said nothing."""
        return not any(text for _, text in self._said)

    def words(self) -> str:
        """Its latest complaints, the gravest first, or its latest words when none is a complaint."""
        told = [(_gravity(status), place, text) for place, (status, text) in enumerate(self._said) if text]
        complaints = [row for row in told if row[0] > fmi2.fmi2OK]
        chosen = sorted(complaints or told)[-TOLD:]
        chosen.sort(key=lambda row: (-row[0], row[1]))
        return "; ".join(dict.fromkeys(text for _, _, text in chosen)) or "the FMU gave no message"

    def close(self) -> None:
        _open.pop(self._key, None)


def _gravity(status: int) -> int:
    """Rank of a message: 0 for no complaint. A status that FMI does not know counts as a warning."""
    return status if fmi2.fmi2OK <= status <= fmi2.fmi2Fatal else fmi2.fmi2Warning


def _log(key: int | None, instance: bytes | None, status: int, category: bytes | None, message: bytes | None) -> None:
    """Take one message; any of the texts may be NULL, and no bytes may stop us."""
    text = (message or b"").decode("utf-8", "replace").strip()
    kept = _open.get(key or 0)
    if kept is not None:
        kept.add(status, text)
        for listener in listeners:
            listener(text)
    elif status in range(len(STATUS)):
        fmpy.fmi1.printLogMessage(key, instance, status, category, text.encode())


def _finished(key: int | None, status: int) -> None:
    kept = _open.get(key or 0)
    if kept is not None:
        kept.late = True


_callbacks = fmi2.fmi2CallbackFunctions()
_callbacks.logger = fmi2.fmi2CallbackLoggerTYPE(_log)
_callbacks.allocateMemory = fmi2.fmi2CallbackAllocateMemoryTYPE(fmpy.calloc)
_callbacks.freeMemory = fmi2.fmi2CallbackFreeMemoryTYPE(fmpy.free)
_callbacks.stepFinished = fmi2.fmi2StepFinishedTYPE(_finished)


def _own_library() -> ctypes.CDLL:
    """A copy of fmpy's library, with a global of its own. Where a loaded file cannot be removed it is left behind."""
    with Scratch.temporary() as folder:
        return ctypes.CDLL(str(shutil.copy(fmpy.logging.logging._name, folder)))


_formatting = _own_library()
_formatting.addLoggerProxy(ctypes.byref(_callbacks))
