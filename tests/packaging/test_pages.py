"""The library of a page: WebAssembly that asks a page for three functions and a clock, and for nothing else."""

from __future__ import annotations

import os
import zipfile
from collections.abc import Iterator
from pathlib import Path

import pytest

from dcone_cosim.build import cache_folder
from fmu_src.packaging import builds, kept, link, page_library, platforms, sources, tools
from fmu_src.reel_control.interface import MODEL

IMPORTS, EXPORTS = 2, 7
"""Sections of a module that tell what it asks for and what it offers (WebAssembly core specification, 5.5)."""

TARGET = platforms.PAGE.places[0].targets[0]
OF_ONE = """acos acosh asin asinh atan atanh cbrt ceil cos cosh erf erfc exp exp2 expm1 fabs floor lgamma log log10
    log1p log2 nearbyint rint round sin sinh sqrt tan tanh tgamma trunc"""
OF_TWO = "atan2 copysign fmax fmin fmod hypot pow remainder"
"""What numba may make kernels call."""


class Bytes:
    """Bytes that are read one after the other."""

    def __init__(self, content: bytes) -> None:
        self.content, self.at = content, 0

    def take(self, count: int) -> bytes:
        self.at += count
        return self.content[self.at - count : self.at]

    def number(self) -> int:
        """Unsigned, in groups of seven bits, the lowest first."""
        value, shift = 0, 0
        while True:
            (byte,) = self.take(1)
            value |= (byte & 0x7F) << shift
            shift += 7
            if not byte & 0x80:
                return value

    def name(self) -> str:
        return self.take(self.number()).decode()


def sections(code: bytes) -> Iterator[tuple[int, Bytes]]:
    assert code[:8] == b"\0asm\1\0\0\0"
    rest = Bytes(code[8:])
    while rest.at < len(rest.content):
        (kind,) = rest.take(1)
        yield kind, Bytes(rest.take(rest.number()))


def imported(section: Bytes) -> Iterator[str]:
    for _ in range(section.number()):
        yield f"{section.name()}.{section.name()}"
        assert section.take(1) == b"\0", "functions alone"
        section.number()


def exported(section: Bytes) -> Iterator[str]:
    for _ in range(section.number()):
        yield section.name()
        section.take(1)
        section.number()


@pytest.fixture(scope="module")
def code() -> bytes:
    fmu = builds.build(MODEL.interface({}), cache_folder(), platform=platforms.PAGE)
    assert kept.fault(fmu) == ""
    with zipfile.ZipFile(fmu) as archive:
        return archive.read(f"binaries/wasm32-wasi/{MODEL.name}.wasm")


def test_it_asks_a_page_for_little_and_offers_what_a_page_calls(code: bytes) -> None:
    found = dict(sections(code))
    assert set(imported(found[IMPORTS])) <= {
        "dcone.size", "dcone.read", "dcone.say", "wasi_snapshot_preview1.clock_time_get",
    }  # fmt: skip
    wanted = {f"fmi2{name}" for name in link.CALLED.split()} | {"memory", "malloc", "free", "dcone_callbacks"}
    assert wanted <= set(exported(found[EXPORTS]))


def linked(source: Path, library: Path, *names: str) -> Path:
    exports = [f"-Wl,--export={name}" for name in names]
    words = ["-target", TARGET.triple, *link.FLAGS, link.FIXED, "-s", "-mexec-model=reactor", *exports, source]
    link.clang([*words, "-o", library], page_library.environment())
    return library


def test_its_c_library_has_every_function_that_kernels_may_call(tmp_path: Path) -> None:
    calls = [f"double call_{name}(double x) {{ return {name}(x); }}" for name in OF_ONE.split()]
    calls += [f"double call_{name}(double x, double y) {{ return {name}(x, y); }}" for name in OF_TWO.split()]
    source = tmp_path / "calls.c"
    source.write_text("\n".join(["#include <math.h>", *calls]))
    wanted = [f"call_{name}" for name in f"{OF_ONE} {OF_TWO}".split()]
    found = dict(sections(linked(source, tmp_path / "calls.wasm", *wanted).read_bytes()))
    assert IMPORTS not in found
    assert set(wanted) <= set(exported(found[EXPORTS]))


def test_what_its_c_library_does_not_have_is_told(tmp_path: Path) -> None:
    source = tmp_path / "call.c"
    source.write_text("#include <math.h>\ndouble call(double x) { return j0(x); }")
    with pytest.raises(tools.BuildError, match="undefined symbol: j0"):
        linked(source, tmp_path / "call.wasm", "call")


@pytest.mark.evidence
def test_its_bytes_are_those_of_one_with_the_whole_c_library(
    code: bytes, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Half a minute where zig has not compiled that yet; that of a tow, by hand, and of a shot have the same too."""
    fmu = builds.build(MODEL.interface({}), cache_folder(), platform=platforms.PAGE)
    with zipfile.ZipFile(fmu) as archive:
        for name in (sources.KERNELS, "model.h"):
            (tmp_path / name).write_bytes(archive.read(f"sources/{name}"))
    monkeypatch.setattr(page_library, "environment", lambda: {**os.environ})
    library = tmp_path / f"{MODEL.name}.wasm"
    link.link(tmp_path / sources.KERNELS, tmp_path / "model.h", library, [TARGET])
    assert library.read_bytes() == code


def test_it_is_no_machine_that_fmus_are_released_for() -> None:
    assert platforms.PAGE.name in platforms.KNOWN
    assert platforms.PAGE not in platforms.PLATFORMS.values()
