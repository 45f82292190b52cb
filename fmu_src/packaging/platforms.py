"""The platforms an FMU can be built for, and which of them this process runs on."""

from __future__ import annotations

import platform
import sys
from collections.abc import Sequence
from dataclasses import dataclass

from fmu_src.packaging.tools import BuildError


@dataclass(frozen=True)
class Target:
    """One kind of machine code.

    triple       of the machine, for clang
    processors   code paths in one library, plainest first; the shim takes the best the machine runs
    """

    triple: str
    processors: tuple[str, ...]


@dataclass(frozen=True)
class Platform:
    """One slot of an FMU.

    name      as the command line says it
    folder    under `binaries/`
    suffix    of the library
    targets   machine codes in the one file; several make a universal binary
    apart     needs an archive of its own, since FMI 2.0 gives its folder to another platform
    """

    name: str
    folder: str
    suffix: str
    targets: tuple[Target, ...]
    apart: bool = False


X86_64 = ("x86_64", "x86_64_v3")
LINUX64 = Platform("linux64", "linux64", ".so", (Target("x86_64-linux-gnu.2.17", X86_64),))
WIN64 = Platform("win64", "win64", ".dll", (Target("x86_64-windows-gnu", X86_64),))
DARWIN64 = Platform(
    "darwin64", "darwin64", ".dylib", (Target("x86_64-macos.11.0", X86_64), Target("aarch64-macos.11.0", ("apple_m1",)))
)
LINUX_AARCH64 = Platform(
    "linux-aarch64", "linux64", ".so", (Target("aarch64-linux-gnu.2.17", ("generic",)),), apart=True
)
"""FMI 2.0 knows no folder for it: `linux64` is where fmpy looks on such a machine, as on every 64-bit Linux."""

PLATFORMS = {p.name: p for p in (LINUX64, WIN64, DARWIN64, LINUX_AARCH64)}
MACHINES = {
    ("linux", "x86_64"): LINUX64,
    ("linux", "aarch64"): LINUX_AARCH64,
    ("win32", "amd64"): WIN64,
    ("darwin", "x86_64"): DARWIN64,
    ("darwin", "arm64"): DARWIN64,
}


def host() -> Platform:
    """The platform this process runs on; BuildError if there is none for it.

    Builds have been made on Linux on x86-64 alone: the other rows say what a build there would be for.
    """
    machine = platform.machine()
    try:
        return MACHINES[sys.platform, machine.lower()]
    except KeyError:
        known = ", ".join(f"{system} on {kind}" for system, kind in MACHINES)
        raise BuildError(f"no FMU can be built for {sys.platform} on {machine}, only for {known}") from None


def archives(chosen: Sequence[Platform]) -> list[tuple[str, list[Platform]]]:
    """Which platforms go into which archive, with what its name ends in: "" for the one most share."""
    together = [p for p in chosen if not p.apart]
    shared = [("", together)] if together else []
    return shared + [(f"-{p.name}", [p]) for p in chosen if p.apart]
