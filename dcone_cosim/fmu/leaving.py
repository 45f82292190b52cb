"""An FMU in our process that calls `exit(0)` takes us along, in the midst of a run, and it would look like success.

    exit(0) of the FMU        the C library's handlers run: ours raises SIGABRT, which no shell takes for success
    the end of the program    Python's handlers run first: ours lets SIGABRT be ignored from then on

Python's own handlers cannot do it: they do not run when C code ends the process.
"""

from __future__ import annotations

import atexit
import ctypes
import os
import signal
from functools import cache


@cache
def guard_exit() -> None:
    """From now on, the process ends by SIGABRT when it is not Python that ends it."""
    if os.name == "nt":
        return
    library = ctypes.CDLL(None)
    atexit.register(signal.signal, signal.SIGABRT, signal.SIG_IGN)
    raising = ctypes.cast(library["raise"], ctypes.c_void_p)
    library["__cxa_atexit"](raising, ctypes.c_void_p(int(signal.SIGABRT)), None)
