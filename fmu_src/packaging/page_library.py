"""What the libraries of a page need of a C library for WebAssembly: 52 files of its six hundred.

zig would compile them all before the first page on a machine, 25 of 31 CPU-s; here it is told of a C library of our
own, from the same files with the same options, so that a page's library has the same bytes. Mathematical functions are
there whether or not today's models call them. Allocation, text and half of the mathematics are zig's own, with either.

Checked  tests/packaging/test_pages.py: the bytes of a library linked with all of it, and every function is there
"""

from __future__ import annotations

import hashlib
import json
import os
import re
import sys
import tempfile
from contextlib import suppress
from importlib.metadata import version
from pathlib import Path

import ziglang

from fmu_src.packaging import tools

PLACE = Path(ziglang.__file__).parent
"""Where zig runs, for which its own paths are relative."""
TARGET = "wasm32-wasi"
LIBC, TOP, BOTTOM = "lib/libc/musl", "lib/libc/wasi/libc-top-half/musl", "lib/libc/wasi/libc-bottom-half"
SHARED = {
    f"{LIBC}/src/locale": "__lctrans",
    f"{LIBC}/src/math": (
        "__cos __math_invalid __math_oflow __math_uflow __math_xflow __sin acosh asinh atan2 atanh erf exp_data expm1 "
        "fma ldexp lgamma lgamma_r pow pow_data remainder remquo scalbn signgam tgamma"
    ),
    f"{LIBC}/src/multibyte": "wcrtomb wctomb",
    f"{LIBC}/src/stdio": "__stdio_exit __toread __towrite fclose ferror fflush fread fwrite ofl_add rewind snprintf",
    f"{LIBC}/src/time": "difftime",
    f"{TOP}/src/errno": "strerror",
    f"{TOP}/src/internal": "libc",
    f"{TOP}/src/math": "__expo2 sinh",
    f"{TOP}/src/stdio": "fmemopen fseek ofl vfprintf vsnprintf",
}
"""Files by their folders."""
SYSTEM = {
    f"{BOTTOM}/cloudlibc/src/libc/errno": "errno",
    f"{BOTTOM}/cloudlibc/src/libc/time": "time",
    f"{BOTTOM}/sources": "__wasilibc_real",
    f"{BOTTOM}/sources/math": "math-builtins",
}
"""Those next to the system, which have headers of their own."""
START = f"{BOTTOM}/crt/crt1-reactor.c"
HEADERS = ("lib/libc/include/wasm-wasi-musl", "lib/libc/include/generic-musl")
OPTIONS = (
    *("-std=gnu17", "-fno-trapping-math", "-w", "-O3", "-mthread-model", "single", "-DBULK_MEMORY_THRESHOLD=32"),
    *("-I", f"{BOTTOM}/cloudlibc/src", "-isystem", HEADERS[0], "-isystem", HEADERS[1]),
)
OWN = (f"{TOP}/src/include", f"{LIBC}/src/include", f"{TOP}/src/internal", f"{LIBC}/src/internal")
OF_SHARED = (*OWN, f"{TOP}/arch/wasm32", f"{LIBC}/arch/generic", "lib/libc/wasi/libc-top-half/headers/private")
OF_SYSTEM = (f"{BOTTOM}/headers/private", f"{BOTTOM}/cloudlibc/src/include", f"{BOTTOM}/cloudlibc/src", *OWN)
PATHS = "paths.txt"
"""Where zig finds it, in zig's own form."""


def environment() -> dict[str, str]:
    """For a link of a page's library. What zig compiles for it knows it by its path: it is kept beside zig's own."""
    folder = _kept_by_zig() / f"dcone-page-{_key()}"
    if not (folder / PATHS).is_file():
        _make(folder)
    return {**os.environ, "ZIG_LIBC": str(folder / PATHS)}


def _zig(*arguments: str) -> str:
    return tools.run("zig", [sys.executable, "-m", "ziglang", *arguments], place=PLACE)


def _kept_by_zig() -> Path:
    found = re.search(r'\.global_cache_dir = ("(?:[^"\\]|\\.)*")', _zig("env"))
    if not found:
        raise tools.BuildError("zig does not tell where it keeps what it builds")
    return Path(json.loads(found[1]))


def _key() -> str:
    what = [version("ziglang"), str(PLACE), SHARED, SYSTEM, START, OPTIONS, OF_SHARED, OF_SYSTEM]
    return hashlib.sha256(json.dumps(what).encode()).hexdigest()[:16]


def _make(folder: Path) -> None:
    """Another process may make the same: what comes last gives way."""
    folder.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix=".dcone-", dir=folder.parent) as place:
        draft = Path(place) / "draft"
        draft.mkdir()
        own = ["-target", TARGET, "-O", "fast", "-fstrip", "--cache-dir", f"{place}/zig"]
        shared, system = _compiled(SHARED, OF_SHARED), _compiled(SYSTEM, OF_SYSTEM)
        _zig("build-lib", "-static", *own, "--name", "c", f"-femit-bin={draft}/libc.a", *shared, *system)
        start = ["-cflags", *_options(OF_SYSTEM), "-Os", "--", START]
        _zig("build-obj", *own, "--name", "crt1-reactor", f"-femit-bin={draft}/crt1-reactor.o", *start)
        fields = {
            "include_dir": PLACE / HEADERS[0],
            "sys_include_dir": PLACE / HEADERS[1],
            "crt_dir": folder,
            **dict.fromkeys(("msvc_lib_dir", "kernel32_lib_dir", "gcc_dir", "darwin_sdk_dir"), ""),
        }
        (draft / PATHS).write_text("".join(f"{name}={value}\n" for name, value in fields.items()), encoding="utf-8")
        with suppress(OSError):
            draft.rename(folder)
    if not (folder / PATHS).is_file():
        raise tools.BuildError(f"the C library of pages can not be kept as {folder}")


def _options(headers: tuple[str, ...]) -> list[str]:
    return [*OPTIONS, *(word for folder in headers for word in ("-I", folder))]


def _compiled(files: dict[str, str], headers: tuple[str, ...]) -> list[str]:
    sources = [f"{folder}/{name}.c" for folder, names in files.items() for name in names.split()]
    return ["-cflags", *_options(headers), "--", *sources]
