"""The archive of an .ssp, read without trust: nothing in it is written anywhere but under a name of our own."""

from __future__ import annotations

import stat
import zipfile
from collections.abc import Iterable
from pathlib import Path, PurePosixPath
from types import TracebackType
from urllib.parse import unquote, urlsplit

from dcone_cosim.errors import InputError
from dcone_cosim.files import regular
from dcone_cosim.fmu.archive import LARGEST, MOST
from dcone_cosim.names import did_you_mean
from dcone_cosim.scene.mistakes import TOLD, shortened
from dcone_cosim.ssp.markup import STRUCTURE

LONGEST = 1000
"""Characters of what is told of one mistake."""
LARGEST_XML = 64 * 2**20
"""Bytes of a structure or a parameter file, unpacked."""


class Mistakes:
    """What is wrong with a package, told all at once, and what of it is ignored; of very many the first are told."""

    def __init__(self, source: str) -> None:
        self.source = source
        self.rows: dict[tuple[str, int, str], None] = {}
        self._ignored: list[str] = []
        self._looked_for = 0

    def add(self, file: str, line: int | None, text: str) -> None:
        self.rows[file, line or 0, text] = None

    def ignore(self, file: str, line: int, text: str) -> None:
        """Note what is no mistake, by the rules of SSP, and has no effect."""
        self._ignored.append(f"{file}{f' line {line}' if line else ''}: {shortened(text, LONGEST)}; it is ignored")

    def near(self, name: str, known: Iterable[str]) -> str:
        """`; did you mean 'x'?`, for as many names as are told: to look for one takes its time."""
        self._looked_for += 1
        return did_you_mean(name, known) if self._looked_for <= TOLD else ""

    @property
    def ignored(self) -> list[str]:
        """Notes of what is ignored."""
        more = len(self._ignored) - TOLD
        return [*self._ignored[:TOLD], *([f"{self.source}: {more} more are ignored like these"] if more > 0 else [])]

    def check(self) -> None:
        """Raise an `InputError` with the mistakes found so far."""
        if not self.rows:
            return
        count = len(self.rows)
        lines = [f"{self.source}: {count} mistake{'s' if count > 1 else ''}"]
        for file, line, text in sorted(self.rows, key=lambda row: (row[0] != STRUCTURE, row[0], row[1]))[:TOLD]:
            lines.append(f"  {file}{f' line {line}' if line else ''}: {shortened(text, LONGEST)}")
        if count > TOLD:
            lines.append(f"  and {count - TOLD} more")
        raise InputError("\n".join(lines))


class Package:
    """An .ssp, open; its FMUs are unpacked to `folder` on demand, which the caller keeps or removes."""

    def __init__(self, path: Path) -> None:
        self.path = path
        try:
            self._archive = zipfile.ZipFile(regular(path))
        except zipfile.BadZipFile as error:
            raise InputError(f"{path} is not an SSP package: {error}; the file may be cut short") from error
        except OSError as error:
            raise InputError(f"{path} cannot be read: {error.strerror or error}") from error
        try:
            self._check_names()
        except BaseException:
            self._archive.close()
            raise

    def _check_names(self) -> None:
        names = set()
        count = len(self._archive.infolist())
        if count > MOST:
            raise InputError(f"{self.path}: it has {count:,} entries; at most {MOST:,} are read")
        for info in self._archive.infolist():
            name = info.filename
            if _leaves(name):
                raise InputError(f"{self.path}: its entry {name!r} would leave the package; it is not read")
            if stat.S_ISLNK(info.external_attr >> 16):
                raise InputError(f"{self.path}: its entry {name!r} is a symbolic link; it is not read")
            if info.flag_bits & 0x1:
                raise InputError(f"{self.path}: its entry {name!r} is encrypted")
            if name in names:
                raise InputError(f"{self.path}: its entry {name!r} is there twice")
            names.add(name)
        if STRUCTURE not in names:
            others = [n for n in names if n.endswith(".ssd")]
            hint = did_you_mean(STRUCTURE, others) if others else ""
            raise InputError(f"{self.path} is not an SSP package: it holds no {STRUCTURE}{hint}")

    @property
    def names(self) -> list[str]:
        return self._archive.namelist()

    def read(self, name: str, largest: int = LARGEST_XML) -> bytes:
        """Content of an entry; an entry that is damaged or too large is an `InputError`."""
        size = self._archive.getinfo(name).file_size
        if size > largest:
            raise InputError(f"{self.path}: {name} has {size:,} bytes; at most {largest:,} are read")
        try:
            return self._archive.read(name)
        except (zipfile.BadZipFile, OSError, EOFError, ValueError) as error:
            raise InputError(f"{self.path}: {name} is damaged ({error})") from error
        except Exception as error:  # zlib.error, lzma.LZMAError, a method that is not known
            raise InputError(f"{self.path}: {name} cannot be unpacked ({error})") from error

    def unpack(self, name: str, folder: Path, as_name: str) -> Path:
        """Write an FMU to the folder under a name of ours."""
        place = folder / f"{as_name}.fmu"
        place.write_bytes(self.read(name, LARGEST))
        return place

    def __enter__(self) -> Package:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self._archive.close()


def _leaves(name: str) -> bool:
    return name.startswith("/") or "\\" in name or "\0" in name or ":" in name or ".." in PurePosixPath(name).parts


def entry_of(source: str, names: Iterable[str], mistakes: Mistakes) -> tuple[str, str]:
    """Entry that a relative URI names, and "" or why it names none."""
    parts = urlsplit(source)
    path = str(PurePosixPath(unquote(parts.path)))
    if parts.scheme or parts.netloc or _leaves(path) or parts.query or parts.fragment or not parts.path:
        return "", f"source {source!r} is not a file in the package; expected a path such as 'resources/x.fmu'"
    known = list(names)
    if path not in known:
        return "", f"source {source!r} is not in the package{mistakes.near(path, known)}"
    return path, ""
