"""The library of a page: WebAssembly that asks a page for three functions and a clock, and for nothing else."""

from __future__ import annotations

import zipfile
from collections.abc import Iterator

import pytest

from dcone_cosim.build import cache_folder
from fmu_src.packaging import builds, kept, link, platforms
from fmu_src.reel_control.interface import MODEL

IMPORTS, EXPORTS = 2, 7
"""Sections of a module that tell what it asks for and what it offers (WebAssembly core specification, 5.5)."""


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


def test_it_is_no_machine_that_fmus_are_released_for() -> None:
    assert platforms.PAGE.name in platforms.KNOWN
    assert platforms.PAGE not in platforms.PLATFORMS.values()
