"""Native code from IR and the C shim, with the clang of the `ziglang` wheel."""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import fmpy
import ziglang

from fmu_src.packaging import page_library, tools, universal
from fmu_src.packaging.compile import ENTRY
from fmu_src.packaging.platforms import Target

HERE = Path(__file__).parent
SHIM = (HERE / "fmi2.c", HERE / "resources.c")
IN_A_PAGE = (HERE / "fmi2.c", HERE / "wasm" / "host.c")
"""The same where no system is below: a page has the resources."""
HEADERS = Path(fmpy.__file__).parent / "c-code"
"""The FMI headers as fmpy ships them."""
FLAGS = ("-O3", "-ffp-contract=off", "-fno-math-errno", "-fPIC", "-g0", "-Wno-override-module")
"""For kernels and shim. Products and sums are never fused, so that all processors give the same bits."""
SHIM_FLAGS = ("-std=c99", "-fvisibility=hidden", "-Wall", "-Wextra", "-s")
CALLED = (
    "Instantiate SetupExperiment EnterInitializationMode ExitInitializationMode Reset FreeInstance DoStep "
    "GetReal GetInteger GetBoolean SetReal SetInteger SetBoolean GetFMUstate SetFMUstate"
)
"""Functions of FMI that a page calls: the linker leaves out what nothing reaches."""
FIXED = "-fno-PIC"
"""For WebAssembly, which is linked to its place."""
MODULE = (
    FIXED,
    "-mexec-model=reactor",
    *(f"-Wl,--export=fmi2{name}" for name in CALLED.split()),
    *(f"-Wl,--export={name}" for name in ("malloc", "free", "dcone_callbacks")),
)
"""For a library of WebAssembly, in the place of -shared."""
SECOND_PATH = {"x86_64_v3": "v3"}
"""What the entry of a second code path is called, for processor.h."""


def clang(arguments: Sequence[object], environment: Mapping[str, str] | None = None) -> None:
    """Run it; BuildError with its last words if it fails.

    It knows a C library that it has built by the paths of its sources as seen from the working directory, and would
    build it anew, minutes for Windows, wherever it is run from a folder above them: it runs in their own.

    Checked  tests/packaging/test_platforms.py
    """
    told = (os.path.abspath(one) if isinstance(one, Path) else str(one) for one in arguments)
    command = [sys.executable, "-m", "ziglang", "cc", *told]
    tools.run("clang", command, environment, place=Path(ziglang.__file__).parent)


def is_page(target: Target) -> bool:
    """Whether it is WebAssembly."""
    return target.triple.startswith("wasm32")


def compile_kernels(ir: Path, target: Target, folder: Path) -> list[Path]:
    """Object files of a model's kernels in `folder`, one for each processor; the first bears the plain entry."""

    def compile_for(processor: str) -> Path:
        source = folder / f"kernel_{processor}.ll"
        plain = processor == target.processors[0]
        entry = ENTRY if plain else f"{ENTRY}_{SECOND_PATH[processor]}"
        source.write_text(ir.read_text().replace(f"@{ENTRY}", f"@{entry}"))
        machine_code = source.with_suffix(".o")
        flags = (*FLAGS, FIXED) if is_page(target) else FLAGS
        clang(["-target", target.triple, f"-mcpu={processor}", *flags, "-c", source, "-o", machine_code])
        return machine_code

    with ThreadPoolExecutor() as pool:
        return list(pool.map(compile_for, target.processors))


def link(ir: Path, header: Path, library: Path, targets: Sequence[Target]) -> None:
    """Make the shared library of one FMU from its IR and its generated header; BuildError if a tool fails.

    What is made on the way stays in the folder of `library`, in one folder per machine code; what is there is taken.
    """
    parts = []
    for target in targets:
        parts.append(library.parent / target.triple / library.name)
        if not parts[-1].exists():
            parts[-1].parent.mkdir()
            _link_one(ir, header, parts[-1], target)
    library.write_bytes(parts[0].read_bytes() if len(parts) == 1 else universal.join([p.read_bytes() for p in parts]))


def _link_one(ir: Path, header: Path, library: Path, target: Target) -> None:
    objects = compile_kernels(ir, target, library.parent)
    paths = [f"-DDCONE_{SECOND_PATH[p].upper()}" for p in target.processors[1:]]
    search = ["-I", HEADERS, "-I", header.parent]
    system: list[str] = []
    shim: Sequence[Path] = SHIM
    kind: Sequence[str] = ("-shared",)
    if is_page(target):
        shim, kind = IN_A_PAGE, MODULE
        search += ["-I", HERE]
    elif "linux" in target.triple:
        system = ["-lm", "-ldl"]  # the others have their mathematics, and their loader, in the one C library
    elif "macos" in target.triple:
        # without these, the folder of this build, and the names of internal functions
        system = [f"-Wl,-install_name,@rpath/{library.name}", "-Wl,-x"]
    words = ["-target", target.triple, *FLAGS, *SHIM_FLAGS, *kind, *search, *paths, *shim, *objects]
    clang([*words, "-o", library, *system], page_library.environment() if is_page(target) else None)
