"""FMUs made for a test: from the C template, with a model that goes wrong in a way of the test's choice."""

from __future__ import annotations

import subprocess
import sys
import zipfile
from collections.abc import Callable
from pathlib import Path

import fmpy

from dcone_cosim.interface_kit import write_template

SOURCE = Path(__file__).with_name("misbehaving.c")
HEADERS = Path(fmpy.__file__).parent / "c-code"


def build(
    folder: Path,
    phase: str = "removal",
    *switches: str,
    when: float | None = None,
    change: Callable[[str], str] = lambda xml: xml,
) -> Path:
    """`my_PHASE.fmu` in a new folder.

    switches    how it goes wrong, see misbehaving.c: "CRASH", "EXIT=3"; "IGNORES_STATE": it restores nothing;
                none: it works as the template does
    when        from which time on [s]
    change      of the text of its model description
    """
    source = folder / "source"
    write_template(phase, "c", source)
    if "IGNORES_STATE" in switches:
        shim = (source / "fmu.c").read_text()
        restoring = "    memcpy(i->m.values, s + 1, block());\n"
        assert restoring in shim
        (source / "fmu.c").write_text(shim.replace(restoring, ""))
    name = f"my_{phase}"
    binary = source / f"{name}.so"
    defines = [f"-D{switch}" for switch in (*switches, *([f"WHEN={when!r}"] if when is not None else []))]
    subprocess.run(
        [
            *(sys.executable, "-m", "ziglang", "cc", "-std=c99", "-O1", "-fno-sanitize=undefined", "-shared", "-fPIC"),
            *("-Wall", "-Wextra", "-D_POSIX_C_SOURCE=200809L", f"-I{HEADERS}", f"-I{source}", *defines),
            *(str(SOURCE), str(source / "fmu.c"), "-lm", "-o", str(binary)),
        ],
        check=True,
    )
    path = folder / f"{name}.fmu"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("modelDescription.xml", change((source / "modelDescription.xml").read_text()))
        archive.write(binary, f"binaries/{fmpy.platform}/{binary.name}")
    return path
