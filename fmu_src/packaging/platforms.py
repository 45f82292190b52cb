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
class Place:
    """One folder of an FMU's libraries.

    folder    under `binaries/`
    targets   machine codes in the one file there; several make a universal binary
    apart     only in an archive of its own, since FMI 2.0 gives the folder to another platform
    """

    folder: str
    targets: tuple[Target, ...]
    apart: bool = False


@dataclass(frozen=True)
class Platform:
    """One kind of machine, and where importers on it look.

    name      as the command line says it
    suffix    of the library
    places    folders it stands in
    """

    name: str
    suffix: str
    places: tuple[Place, ...]

    @property
    def apart(self) -> bool:
        """Whether it needs an archive of its own too."""
        return any(place.apart for place in self.places)


X86_64 = ("x86_64", "x86_64_v3")
MAC_ARM = Target("aarch64-macos.11.0", ("apple_m1",))
LINUX_ARM = Target("aarch64-linux-gnu.2.17", ("generic",))
LINUX64 = Platform("linux64", ".so", (Place("linux64", (Target("x86_64-linux-gnu.2.17", X86_64),)),))
WIN64 = Platform("win64", ".dll", (Place("win64", (Target("x86_64-windows-gnu", X86_64),)),))
DARWIN64 = Platform(
    "darwin64",
    ".dylib",
    (Place("darwin64", (Target("x86_64-macos.11.0", X86_64), MAC_ARM)), Place("aarch64-darwin", (MAC_ARM,))),
)
LINUX_AARCH64 = Platform(
    "linux-aarch64", ".so", (Place("aarch64-linux", (LINUX_ARM,)), Place("linux64", (LINUX_ARM,), apart=True))
)
"""FMI 2.0.4, section 2.3, names folders for processors other than x86 by the tuples of FMI 3.0. Older loaders look in
`linux64` on every 64-bit Linux, fmpy's among them, and in `darwin64` on every Mac."""

PAGE = Platform("wasm32", ".wasm", (Place("wasm32-wasi", (Target("wasm32-wasi", ("generic+simd128",)),)),))
"""A browser: the library is WebAssembly with vectors of 128 bits, and has what `wasm/host.c` asks of a page."""

PLATFORMS = {p.name: p for p in (LINUX64, WIN64, DARWIN64, LINUX_AARCH64)}
"""Machines, by the names of the command line."""
KNOWN = {**PLATFORMS, PAGE.name: PAGE}
"""All that an FMU is built for here."""
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


def archives(chosen: Sequence[Platform]) -> list[tuple[str, dict[Platform, list[str]]]]:
    """What goes into which archive: what its name ends in, "" for the one that most share, and folders by platform.

    A platform that needs an archive of its own is in the shared one too, in the folders that are its alone.
    """
    shared = {p: [place.folder for place in p.places if not place.apart] for p in chosen}
    found = [("", shared)] if not all(p.apart for p in chosen) else []
    return found + [(f"-{p.name}", {p: [place.folder for place in p.places]}) for p in chosen if p.apart]
