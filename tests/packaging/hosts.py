"""Programs in C that run FMUs, compiled with the project's own compiler, and run under memcheck."""

import subprocess
from pathlib import Path

from fmu_src.packaging import link
from tests.packaging import toy

HERE = Path(__file__).parent
NO_VALGRIND = "memcheck was not run: valgrind is not on this machine (Debian: apt-get install valgrind)"
VALGRIND = ["valgrind", "--error-exitcode=99", "--leak-check=full", "--errors-for-leak-kinds=definite,indirect", "-q"]


def compile_host(source, folder, *flags):
    """The program of a C file of this folder."""
    program = folder / Path(source).stem
    command = [*toy.COMPILER, "-std=c99", "-D_POSIX_C_SOURCE=200809L", "-D_GNU_SOURCE", "-Wall", "-Wextra", "-Werror"]
    # without zig's run-time library, of which nothing is called, and which would be built with its own lines first
    command += ["-O1", "-gdwarf-4", "-nostdlib", "-lc", "-I", link.HEADERS, *flags]
    command += [HERE / source, "-o", program, "-ldl", "-lm"]
    subprocess.run(list(map(str, command)), check=True, capture_output=True)
    return program
