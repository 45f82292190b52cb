"""Native code from IR and the C shim, with the clang of the `ziglang` wheel."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import fmpy

from fmu_src.packaging import tools
from fmu_src.packaging.compile import ENTRY

SHIM = Path(__file__).parent / "fmi2.c"
HEADERS = Path(fmpy.__file__).parent / "c-code"
"""The FMI headers as fmpy ships them."""


@dataclass(frozen=True)
class Platform:
    """One slot of an FMU.

    folder       name under `binaries/`
    suffix       of the library
    target       for clang
    processors   code paths in one library, best last; the shim takes the best the machine runs
    """

    folder: str
    suffix: str
    target: str
    processors: tuple[str, ...]


LINUX64 = Platform("linux64", ".so", "x86_64-linux-gnu.2.17", ("x86_64", "x86_64_v3"))
FLAGS = ("-O3", "-ffp-contract=off", "-fno-math-errno", "-fPIC", "-g0", "-Wno-override-module")


def host() -> Platform:
    """The platform this process runs on."""
    import platform

    if sys.platform == "linux" and platform.machine() in ("x86_64", "AMD64"):
        return LINUX64
    raise tools.BuildError(
        f"no FMU can be built for {sys.platform} on {platform.machine()} yet, only for Linux on x86-64"
    )


def _clang(arguments: Sequence[object]) -> None:
    command = [sys.executable, "-m", "ziglang", "cc", *map(str, arguments)]
    tools.run("clang", command)


def link(ir: Path, header: Path, library: Path, platform: Platform) -> None:
    """Make the shared library of one FMU from its IR and its generated header, in the folder of `ir`."""
    objects: list[Path] = []
    for processor in platform.processors:
        source = ir.with_name(f"kernel_{processor}.ll")
        source.write_text(ir.read_text().replace(f"@{ENTRY}", f"@{ENTRY}_{processor}"))
        objects.append(source.with_suffix(".o"))
        _clang(["-target", platform.target, f"-mcpu={processor}", *FLAGS, "-c", source, "-o", objects[-1]])
    visible = [
        "-std=c99",
        "-fvisibility=hidden",
        "-Wall",
        "-Wextra",
        "-shared",
        "-s",
        "-I",
        HEADERS,
        "-I",
        header.parent,
    ]
    _clang(["-target", platform.target, *FLAGS, *visible, SHIM, *objects, "-o", library, "-lm"])
