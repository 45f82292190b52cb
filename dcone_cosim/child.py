"""Child processes of ours: each runs one module in a fresh interpreter and talks to us over its first two streams.

The parent starts it, kills it and says how it ended. The child takes the two streams away from whatever it loads, so
that what an FMU prints goes to the third, and ends with its parent even if an FMU never returns.
"""

from __future__ import annotations

import ctypes
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path

LOOK_FOR_PARENT = 0.5
"""How often to see whether the parent is still there [s]."""


def start(module: str, environment: Mapping[str, str] | None = None) -> subprocess.Popen[bytes]:
    """A fresh interpreter that runs a module, in a session of its own: Ctrl-C is ours to handle."""
    place = str(Path(__file__).parents[1])
    path = os.pathsep.join([place, *filter(None, [os.environ.get("PYTHONPATH")])])
    pipe = subprocess.PIPE
    return subprocess.Popen(
        [sys.executable, "-m", module],
        stdin=pipe,
        stdout=pipe,
        stderr=pipe,
        env=os.environ | (environment or {}) | {"PYTHONPATH": path},
        start_new_session=True,
    )


def kill(child: subprocess.Popen[bytes]) -> None:
    """Kill the child, and what it started itself."""
    if hasattr(os, "killpg"):
        with suppress(OSError):
            os.killpg(child.pid, signal.SIGKILL)
    child.kill()


def how_it_ended(code: int) -> str:
    """The exit code of a process in words: "was ended by SIGKILL", "ended itself with exit code 3"."""
    return f"was ended by {_signal_name(-code)}" if code < 0 else f"ended itself with exit code {code}"


def _signal_name(number: int) -> str:
    """Name of a signal; those for real-time use have none of their own."""
    try:
        return signal.Signals(number).name
    except ValueError:
        return f"signal {number}"


def own_streams() -> tuple[int, int]:
    """In the child: descriptors of what the parent sends and of what it is answered, out of reach of an FMU, whose
    prints go to the third stream."""
    calls, answers = os.dup(0), os.dup(1)
    nothing = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, 0)
    os.dup2(2, 1)
    with suppress(Exception):  # by lines, so that the last ones are out before a crash; only where the C library is so
        library = ctypes.CDLL(None)
        library.setvbuf(ctypes.c_void_p.in_dll(library, "stdout"), None, 1, ctypes.c_size_t(0))
    return calls, answers


def end_with_parent() -> None:
    """In the child: watch in a thread whether the parent is still there, and end when it is not."""
    threading.Thread(target=_watch, args=(os.getppid(),), daemon=True).start()


def _watch(parent: int) -> None:
    while os.getppid() == parent:
        time.sleep(LOOK_FOR_PARENT)
    os._exit(1)
