"""How this thread computes, which a call to foreign code may change: rounding, tiny numbers, traps, x87's precision.

A library that was linked with -ffast-math flushes tiny numbers to zero from the moment it is loaded; one that computes
with intervals may forget to round to nearest again. All that is computed afterwards would differ in its last bits.
It is watched where the layout of the C library's environment is known, on Linux on x86-64; a look costs 0.4 us.
"""

from __future__ import annotations

import ctypes
import platform
import sys

IS_KNOWN = sys.platform == "linux" and platform.machine() == "x86_64"
BYTES = 32
"""Of glibc's fenv_t, here as eight words."""
SSE, X87 = 7, 0
"""Which of the words are MXCSR, and the control word of x87."""
BITS = {
    SSE: {
        0x6000: "rounding",
        0x8000: "flushing of tiny results to zero",
        0x0040: "taking of tiny operands for zero",
        0x1F80: "traps",
    },
    X87: {0x0C00: "rounding", 0x0300: "the precision of x87", 0x003F: "traps"},
}
"""What is watched; other bits are notes of what has happened.

Source   glibc, sysdeps/x86/bits/fenv.h; Intel 64 and IA-32 manual, volume 1, sections 8.1.5 and 10.2.3
"""
SSE_MASK, X87_MASK = (sum(BITS[word]) for word in (SSE, X87))


class Control:
    """The control of the thread that makes this object, as it is then.

    Checked  tests/cosim/test_floating.py
    """

    def __init__(self) -> None:
        if not IS_KNOWN:
            return
        library = ctypes.PyDLL("libm.so.6")  # nothing else may run in between, and a look costs less
        self._look, self._set_back = library.fegetenv, library.fesetenv
        self._look.restype = None
        self._kept, self._now = (ctypes.create_string_buffer(BYTES) for _ in range(2))
        self._was, self._is = (memoryview(buffer).cast("B").cast("I") for buffer in (self._kept, self._now))
        self._look(self._kept)

    def changed(self) -> str:
        """What has been changed since, in words, "" for nothing; it is set back to what it was."""
        if not IS_KNOWN:
            return ""
        self._look(self._now)
        was, now = self._was, self._is
        if not ((now[SSE] ^ was[SSE]) & SSE_MASK | (now[X87] ^ was[X87]) & X87_MASK):
            return ""
        self._set_back(self._kept)
        found = [name for word, bits in BITS.items() for mask, name in bits.items() if (now[word] ^ was[word]) & mask]
        return " and ".join(dict.fromkeys(found))
