"""FMUs made for a test: from the C template, with a model that goes wrong in a way of the test's choice."""

from __future__ import annotations

import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Callable
from functools import cache
from pathlib import Path

import fmpy

from dcone_cosim.interface_kit import write_template

SOURCE = Path(__file__).with_name("misbehaving.c")
HEADERS = Path(fmpy.__file__).parent / "c-code"
SHIM = {
    "IGNORES_STATE": ("    memcpy(i->m.values, s + 1, block());\n", ""),  # it restores nothing
    "REFUSES_WITHOUT_A_WORD": ("if (!callbacks || !name) return", "if (callbacks) return"),  # it cannot be instantiated
}
"""What some switches change in the template's fmu.c."""


def build(
    folder: Path,
    phase: str = "removal",
    *switches: str,
    when: float | None = None,
    change: Callable[[str], str] = lambda xml: xml,
) -> Path:
    """`my_PHASE.fmu` in a folder.

    switches    how it goes wrong, see misbehaving.c and SHIM: "CRASH", "EXIT=3"; none: it works as the template does
    when        after how long [s]
    change      of the text of its model description
    """
    defines = switches if when is None else (*switches, f"WHEN={when!r}")
    description, binary = _compiled(phase, defines)
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"my_{phase}.fmu"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("modelDescription.xml", change(description))
        archive.writestr(f"binaries/{fmpy.platform}/my_{phase}.so", binary)
    return path


@cache
def _compiled(phase: str, switches: tuple[str, ...]) -> tuple[str, bytes]:
    """Model description and binary; each is compiled once."""
    with tempfile.TemporaryDirectory() as place:
        source = Path(place) / "source"
        write_template(phase, "c", source)
        for switch, (old, new) in SHIM.items():
            if switch in switches:
                shim = (source / "fmu.c").read_text()
                assert old in shim
                (source / "fmu.c").write_text(shim.replace(old, new))
        binary = source / "it.so"
        subprocess.run(
            [
                *(sys.executable, "-m", "ziglang", "cc", "-std=c99", "-O1", "-fno-sanitize=undefined", "-shared"),
                *("-fPIC", "-Wall", "-Wextra", "-D_POSIX_C_SOURCE=200809L", f"-I{HEADERS}", f"-I{source}"),
                *(f"-D{switch}" for switch in switches),
                *(str(SOURCE), str(source / "fmu.c"), "-lm", "-o", str(binary)),
            ],
            check=True,
        )
        return (source / "modelDescription.xml").read_text(), binary.read_bytes()
