"""FMUs on demand: built once for what goes into them, kept in a cache, and written byte for byte reproducibly.

The same sources and the versions in PACKAGES give the same files. The archive around them, and the picture, are
deflated by the zlib that Python and Pillow were linked with, so the archive has the same bytes where that is the same
too. The key leaves zlib out: what an FMU does, and so its GUID, does not depend on it.

An FMU has two identities. The key is its library's: whatever values it starts with, it loads the saved states of all
with that key and its tables. The GUID is the file's, values, tables and experiment with it.

The cache holds an FMU with the model's own values for each platform, and without the tables of its parts, so that one
with tables does not run from there. One for several platforms, or with the values of a scene, is put together from
those, without compiler or linker: platforms differ in their libraries alone, values and tables in what `described`
makes. The IR is worked out once, since every FMU carries it among its sources.
"""

from __future__ import annotations

import hashlib
import json
import os
import shutil
import tempfile
import zipfile
from collections.abc import Callable, Container, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import AbstractContextManager, ExitStack, contextmanager
from dataclasses import astuple
from importlib.metadata import version
from pathlib import Path

from fmu_src.interface import Interface
from fmu_src.packaging import (
    c_header,
    compile,
    description,
    documentation,
    kept,
    link,
    picture,
    sources,
    start_values,
    table_file,
    tools,
)
from fmu_src.packaging.description import Experiment
from fmu_src.packaging.platforms import KNOWN, WIN64, Platform, host

PACKAGES = ("dcone-cosim", "numba", "llvmlite", "ziglang", "numpy", "fmpy", "pillow", "astropy", "markdown-it-py")
"""What settles by its version what comes out: the tools, and this package, whose version the description tells."""
SOURCES = Path(__file__).parents[1]
COMMON = "kernels"
"""The folder of a cache that has the kernels which choices of terms have in common."""
FIRST = {WIN64: "Windows on a machine takes minutes"}
"""Links before which a C library is built."""
EPOCH = (1980, 1, 1, 0, 0, 0)
Announce = Callable[[str], None]
Workplace = Callable[[Path], AbstractContextManager[Path]]


@contextmanager
def plain_folder(parent: Path) -> Iterator[Path]:
    """A new folder for the time of a block."""
    with tempfile.TemporaryDirectory(prefix=".dcone-", dir=parent) as folder:
        yield Path(folder)


def fingerprint(interface: Interface) -> str:
    """Hash of all that goes into an FMU: kernels, shim, table, terms, tools. The same on every platform."""
    digest = hashlib.sha256()
    model = SOURCES / interface.model.name
    packaging = (p for p in (SOURCES / "packaging").rglob("*") if p.suffix in (".py", ".c", ".h", ".txt"))
    shared = sorted([*SOURCES.glob("*.py"), *(SOURCES / "integrators").glob("*.py"), *packaging])
    formulas = sorted((SOURCES.parent / "orbital").glob("*.py"))
    for path in [*shared, *formulas, *sorted(p for p in model.rglob("*") if p.suffix in (".py", ".md"))]:
        digest.update(path.relative_to(SOURCES.parent).as_posix().encode() + b"\0" + path.read_bytes())
    tools = {name: version(name) for name in PACKAGES}
    digest.update(json.dumps([dict(interface.terms), tools]).encode())
    return digest.hexdigest()


def build(
    interface: Interface,
    cache: Path,
    announce: Announce = lambda _: None,
    platform: Platform | None = None,
    workplace: Workplace = plain_folder,
) -> Path:
    """Path of the FMU for one platform, this machine's if none is named, in the cache; built first if it is not there.

    workplace    makes a folder in the cache for the time of the work, and removes it

    Its values are the model's own, whatever those of the interface, and tables it has none. A half-built FMU never has
    its final name, and two processes that build the same one do not disturb each other.
    """
    platform = platform or host()
    interface = interface.model.interface(interface.terms)
    key = fingerprint(interface)
    name = interface.model.name
    path = cache / kept.file_name(name, key, platform)
    if os.path.lexists(path):
        wrong = kept.fault(path)
        if not wrong:
            return path
        announce(f"{path} is {wrong}; it is built again")
    with ExitStack() as stack:
        try:
            cache.mkdir(parents=True, exist_ok=True)
            folder = stack.enter_context(workplace(cache))
        except OSError as error:
            raise OSError(error.errno, f"the FMU cache can not be written: {error.strerror}", str(cache)) from None
        identity = kept.as_guid(key)
        ir = folder / "model.ll"
        known = kernels(cache, name, key)
        if known is None:
            terms = ", ".join(interface.terms) or "no terms to choose"
            announce(f"building {name} with {terms} (once; kept in {cache})")
            compile.emit(interface.model, interface.terms, ir, cache / COMMON)
        else:
            ir.write_bytes(known)
        header = folder / "model.h"
        header.write_text(c_header.header(interface, name, identity))
        library = folder / f"{name}{platform.suffix}"
        first = f"; the first link for {FIRST[platform]}" if platform in FIRST else ""
        announce(f"linking {name} for {platform.name}{first}")
        libraries = {}
        for place in platform.places:
            link.link(ir, header, library, place.targets)
            libraries[f"binaries/{place.folder}/{library.name}"] = library.read_bytes()
        files = {
            **described(interface, identity, Experiment.of(interface.model)),
            **libraries,
            "model.png": picture.png(interface),
            **sources.files(name, ir, header),
        }
        finished = folder / path.name
        pack(files, finished)
        if fingerprint(interface) != key:
            raise tools.BuildError(f"the sources of {name} changed while it was built: build it again")
        _put(finished, path)
    return path


def described(interface: Interface, library: str, experiment: Experiment) -> dict[str, bytes]:
    """The files in which FMUs with one library differ: what they are, their values and tables, and what for.

    library    its key in the form of a GUID
    """
    name = interface.model.name
    what = [library, start_values.slots(interface).hex(), *map(str, astuple(experiment))]
    tables = {table_file.PATH: table_file.content(interface)} if interface.given else {}
    what += [hashlib.sha256(data).hexdigest() for data in tables.values()]
    guid = kept.as_guid(hashlib.sha256(json.dumps(what).encode()).hexdigest())
    package = version("dcone-cosim")
    return {
        "modelDescription.xml": description.model_description(interface, name, guid, package, experiment),
        start_values.PATH: start_values.content(interface, library, guid),
        "documentation/index.html": documentation.page(interface, SOURCES / name, experiment.scene).encode(),
        **tables,
    }


def kernels(cache: Path, name: str, key: str) -> bytes | None:
    """IR from an FMU of the same origin for another platform, if there is one."""
    for platform in KNOWN.values():
        path = cache / kept.file_name(name, key, platform)
        if not kept.fault(path):
            with zipfile.ZipFile(path) as archive:
                return archive.read(f"sources/{sources.KERNELS}")
    return None


def _put(finished: Path, path: Path) -> None:
    """Move a file to its place; what is there gives way, even a folder."""
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path)
    os.replace(finished, path)


def build_all(
    interfaces: Sequence[Interface],
    cache: Path,
    announce: Announce = lambda _: None,
    platforms: Sequence[Platform | None] = (None,),
    workplace: Workplace = plain_folder,
) -> list[list[Path]]:
    """Paths of several FMUs, for each of them one per platform, those that are missing built side by side."""

    def build_one(interface: Interface) -> list[Path]:
        return [build(interface, cache, announce, platform, workplace) for platform in platforms]

    with ThreadPoolExecutor(max_workers=os.cpu_count() or 1) as pool:
        try:
            return list(pool.map(build_one, interfaces))
        except BaseException:
            tools.stop()
            raise


def unite(fmus: Mapping[Path, Container[str]]) -> dict[str, bytes]:
    """Files of one FMU for all the platforms of several, which must be of the same origin.

    fmus   with the folders under `binaries/` that are taken from each
    """
    files: dict[str, bytes] = {}
    for fmu, folders in fmus.items():
        with zipfile.ZipFile(fmu) as archive:
            for name in archive.namelist():
                if name.startswith("binaries/") and name.split("/")[1] not in folders:
                    continue
                content = archive.read(name)
                if files.setdefault(name, content) != content:
                    raise ValueError(f"{fmu} is not of the same origin: its {name} differs")
    return files


def furnish(fmus: Mapping[Path, Container[str]], interface: Interface, experiment: Experiment, path: Path) -> None:
    """Write one FMU for all the platforms of several, which has the values and tables of the interface.

    fmus   as for `unite`

    ValueError, and no file, if the interface was not given its tables.

    Checked  tests/packaging/test_start_values.py
    """
    interface.demand_tables()
    files = unite(fmus)
    pack(files | described(interface, start_values.library_of(files[start_values.PATH]), experiment), path)


def pack(files: dict[str, bytes], path: Path) -> None:
    """Write a zip archive whose bytes depend on its content alone."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name in sorted(files, key=lambda n: (n != "modelDescription.xml", n)):
            info = zipfile.ZipInfo(name, EPOCH)
            info.create_system = 3  # the writing system would be told otherwise
            info.external_attr = 0o644 << 16
            info.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(info, files[name])
