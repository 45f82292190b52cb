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
from fmu_src.packaging.platforms import host

SOURCE = Path(__file__).with_name("misbehaving.c")
HEADERS = Path(fmpy.__file__).parent / "c-code"
TARGET = host().places[0].targets[0].triple
"""That of our own FMUs, as they are linked: for another zig would first build another C library."""
FLUSHED = '    if (s->start + s->time < flushed - 1e-9) return refuse(i, "that state has been thrown away");\n'
SHIM = {
    "IGNORES_STATE": [("    memcpy(i->m.values, s + 1, block());\n", "")],  # it restores nothing
    "REFUSES_WITHOUT_A_WORD": [("if (!callbacks || !name) return", "if (callbacks) return")],  # it is not instantiated
    # told that somebody may go back, it begins anew: as one does that takes that for the news that somebody has
    "REWINDS": [("    (void)no_going_back;\n", "    if (!no_going_back) i->m.start = time;\n")],
    # its String `label` is told by its length, in the place of the target's mass; so is the tolerance it is told, or -1
    "TEXTS": [
        (
            '    (void)r, (void)values;\n    return n ? refuse(c, "there are no Strings") : fmi2OK;\n}\n\n/* ----',
            "    for (size_t k = 0; k < n; k++) ((instance *)c)->m.values[r[k]] = (double)strlen(values[k]);\n"
            "    return fmi2OK;\n}\n\n/* ----",
        ),
    ],
    "TOLERANCE": [
        (
            "    (void)tolerance_given, (void)tolerance, (void)stop_given, (void)stop;\n",
            "    (void)stop_given, (void)stop;\n    i->m.values[1] = tolerance_given ? tolerance : -1.0;\n",
        ),
    ],
    # its parameters can be set while it steps too
    "TUNES": [
        (
            "    return model_table[reference].causality == INPUT || i->phase < STEPPING;\n",
            "    (void)i;\n    return 1;\n",
        )
    ],
    # told that nobody goes back to before a step, it throws that away, and refuses to go there
    "FLUSHES": [
        ("    (void)no_going_back;\n", "    if (no_going_back && time > flushed) flushed = time;\n"),
        ("    i->m.start = s->start;\n", FLUSHED + "    i->m.start = s->start;\n"),
        ("static size_t block(void)", "static double flushed = -1e300;\nstatic size_t block(void)"),
    ],
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
        shim = (source / "fmu.c").read_text()
        for old, new in [change for switch in switches for change in SHIM.get(switch, [])]:
            assert shim.count(old) == 1
            shim = shim.replace(old, new)
        (source / "fmu.c").write_text(shim)
        binary = source / "it.so"
        subprocess.run(
            [
                *(sys.executable, "-m", "ziglang", "cc", "-target", TARGET, "-std=c99", "-O1", "-s", "-shared"),
                "-fno-sanitize=undefined",
                *("-fPIC", "-Wall", "-Wextra", "-D_POSIX_C_SOURCE=200809L", f"-I{HEADERS}", f"-I{source}"),
                *(f"-D{switch}" for switch in switches),
                *(str(SOURCE), str(source / "fmu.c"), "-lm", "-o", str(binary)),
            ],
            check=True,
        )
        return (source / "modelDescription.xml").read_text(), binary.read_bytes()
