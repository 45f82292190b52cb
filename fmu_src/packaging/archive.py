"""FMUs on demand: built once for what goes into them, kept in a cache, and written byte for byte reproducibly."""

from __future__ import annotations

import hashlib
import json
import os
import shutil
import tempfile
import zipfile
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from importlib.metadata import version
from pathlib import Path

from fmu_src.interface import Interface
from fmu_src.packaging import c_header, compile, description, documentation, link, picture, tools

PACKAGES = ("numba", "llvmlite", "ziglang", "numpy", "fmpy", "pillow")
"""Tools whose version settles what comes out."""
SOURCES = Path(__file__).parents[1]
EPOCH = (1980, 1, 1, 0, 0, 0)
Announce = Callable[[str], None]


def fingerprint(interface: Interface, platform: link.Platform) -> str:
    """Hash of all that goes into an FMU: kernels, shim, table, terms, tools, platform."""
    digest = hashlib.sha256()
    model = SOURCES / interface.model.name
    shared = sorted([*SOURCES.glob("*.py"), *(SOURCES / "packaging").glob("*.[pch]*")])
    formulas = sorted((SOURCES.parent / "orbital").glob("*.py"))
    for path in [*shared, *formulas, *sorted(p for p in model.iterdir() if p.suffix in (".py", ".md"))]:
        digest.update(path.name.encode() + b"\0" + path.read_bytes())
    tools = {name: version(name) for name in PACKAGES}
    digest.update(json.dumps([dict(interface.terms), tools, platform.folder, platform.processors]).encode())
    return digest.hexdigest()


def build(interface: Interface, cache: Path, announce: Announce = lambda _: None) -> Path:
    """Path of the FMU in the cache, built first if it is not there.

    A half-built FMU never has its final name, and two processes that build the same one do not disturb each other.
    """
    platform = link.host()
    key = fingerprint(interface, platform)
    path = cache / f"{interface.model.name}-{key[:16]}.fmu"
    if _intact(path):
        return path
    try:
        cache.mkdir(parents=True, exist_ok=True)
        folder = Path(tempfile.mkdtemp(prefix=f".{path.stem}-", dir=cache))
    except OSError as error:
        raise OSError(error.errno, f"the FMU cache can not be written: {error.strerror}", str(cache)) from None
    name = interface.model.name
    guid = "{" + f"{key[:8]}-{key[8:12]}-{key[12:16]}-{key[16:20]}-{key[20:32]}" + "}"
    announce(f"building {interface.model.name} with {', '.join(interface.terms)} (once; kept in {cache})")
    try:
        ir = folder / "model.ll"
        compile.emit(interface.model.name, interface.terms, ir)
        header = folder / "model.h"
        header.write_text(c_header.header(interface, name, guid))
        library = folder / f"{name}{platform.suffix}"
        announce(f"linking {interface.model.name} for {platform.folder}")
        link.link(ir, header, library, platform)
        package = version("dcone-cosim")
        files = {
            "modelDescription.xml": description.model_description(interface, name, guid, package),
            f"binaries/{platform.folder}/{library.name}": library.read_bytes(),
            "documentation/index.html": documentation.page(interface, SOURCES / interface.model.name).encode(),
            "model.png": picture.png(interface),
        }
        finished = folder / path.name
        pack(files, finished)
        if fingerprint(interface, platform) != key:
            raise tools.BuildError(f"the sources of {interface.model.name} changed while it was built: build it again")
        os.replace(finished, path)
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    return path


def _intact(path: Path) -> bool:
    """Whether a cached FMU is there and whole; a damaged one is built again."""
    try:
        with zipfile.ZipFile(path) as archive:
            return archive.testzip() is None
    except (OSError, zipfile.BadZipFile):
        return False


def build_all(interfaces: Sequence[Interface], cache: Path, announce: Announce = lambda _: None) -> list[Path]:
    """Paths of several FMUs, those that are missing built side by side."""
    with ThreadPoolExecutor(max_workers=os.cpu_count() or 1) as pool:
        try:
            return list(pool.map(lambda interface: build(interface, cache, announce), interfaces))
        except BaseException:
            tools.stop()
            raise


def pack(files: dict[str, bytes], path: Path) -> None:
    """Write a zip archive whose bytes depend on its content alone."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name in sorted(files, key=lambda n: (n != "modelDescription.xml", n)):
            info = zipfile.ZipInfo(name, EPOCH)
            info.external_attr = 0o644 << 16
            info.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(info, files[name])
