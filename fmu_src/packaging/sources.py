"""The `sources/` of an FMU: the shim, the generated header, the kernels as IR, and how to build them.

The model description does not list them as SourceFiles: a tool would hand the C files it finds there to any C compiler,
which has no use for the IR, and the link would fail.
"""

from __future__ import annotations

from pathlib import Path

SHIM = Path(__file__).parent
"""Its C files and headers stand beside the packaging's own modules."""
GUIDE = SHIM / "sources"
KERNELS = "model.ll"


def files(identifier: str, ir: Path, header: Path) -> dict[str, bytes]:
    """Content of `sources/` by its path in the archive."""
    shim = sorted(p for p in SHIM.iterdir() if p.suffix in (".c", ".h"))
    content = {p.name: p.read_bytes() for p in shim}
    content[KERNELS] = ir.read_bytes()
    content["model.h"] = header.read_bytes()
    for guide in sorted(GUIDE.glob("*.txt")):
        content[guide.name] = guide.read_text().replace("@IDENTIFIER@", identifier).encode()
    return {f"sources/{name}": data for name, data in content.items()}
