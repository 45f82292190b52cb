"""The cache of built FMUs: what is in it, how long a build took here, and how it is emptied.

Nothing that another process is building is touched: a build works in a folder of its own, which takes no part in the
listing, and is cleared away only when its process has died (see `scratch`).
"""

from __future__ import annotations

import json
import math
import re
import shutil
import statistics
import time as clock
import zipfile
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from dcone_cosim.errors import InputError
from dcone_cosim.scratch import Scratch, clear_left

DAY = 86400.0
COMMON = "kernels"
"""The folder of kernels that the FMUs of several choices of terms have in common, as a build names it."""
MENDED = "what should be here is built when it is needed"
UNKNOWN = "this may take a minute or two"


@dataclass(frozen=True)
class Kept:
    """One FMU of the cache.

    terms     what it was built with, as its model description says
    size      [bytes]
    built     when [s since the epoch]
    """

    path: Path
    model: str
    terms: str
    size: int
    built: float


def listing(folder: Path, fault: Callable[[Path], str]) -> list[Kept]:
    """Every FMU of the cache, the latest first; `fault` tells what is wrong with one."""
    found = []
    for path, size, built in _files(folder):
        wrong = fault(path)
        model, terms = _described(path) if not wrong else (path.stem.partition("-")[0], "")
        found.append(Kept(path, model, f"{wrong}; {MENDED}" if wrong else terms, size, built))
    return sorted(found, key=lambda kept: -kept.built)


def _files(folder: Path) -> Iterator[tuple[Path, int, float]]:
    """Whatever has the name of an FMU, with its size [bytes] and when it was written [s since the epoch]."""
    yield from _about(folder.glob("*.fmu"))


def _kernels(folder: Path) -> Iterator[tuple[Path, int, float]]:
    """The same of what FMUs have in common."""
    yield from _about(path for path in (folder / COMMON).rglob("*") if path.is_file())


def _about(paths: Iterable[Path]) -> Iterator[tuple[Path, int, float]]:
    for path in paths:
        with suppress(OSError):
            about = path.lstat()
            yield path, about.st_size, about.st_mtime


def _described(path: Path) -> tuple[str, str]:
    """Model and terms of an FMU of ours."""
    with zipfile.ZipFile(path) as archive:
        head = archive.read("modelDescription.xml")[:10_000].decode("utf-8", "replace")
    name = re.search(r'modelName="([^"]*)"', head)
    terms = re.search(r"Built with: ([^.\"]*)", head)
    return name[1] if name else path.stem, terms[1] if terms else ""


def clear(folder: Path, older_than: float = 0.0) -> tuple[int, int]:
    """Remove what was built longer ago than this [s], kernels that FMUs have in common too; returns how many FMUs and
    how many bytes are gone."""
    now, count, size = clock.time(), 0, 0
    for path, bytes_of, built in _files(folder):
        if now - built >= older_than:
            _remove(path)
            count, size = count + 1, size + bytes_of
    for path, size_of, built in _kernels(folder):
        if now - built >= older_than:
            path.unlink(missing_ok=True)
            size += size_of
    with suppress(OSError):
        for emptied in sorted((folder / COMMON).rglob("*"), reverse=True):
            if emptied.is_dir() and not any(emptied.iterdir()):
                emptied.rmdir()
        (folder / COMMON).rmdir()
    clear_left(folder)
    return count, size


def size_of_kernels(folder: Path) -> int:
    """Of the kernels that FMUs have in common [bytes]."""
    return sum(size for _, size, _ in _kernels(folder))


def _remove(path: Path) -> None:
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path)
    else:
        path.unlink(missing_ok=True)


AGES = {"min": 60.0, "h": 3600.0, "d": DAY, "w": 7.0 * DAY}


def age(text: str) -> float:
    """An age such as 30d or 12h [s]; `InputError` for what is none."""
    match = re.fullmatch(r"\s*(\d+(?:\.\d+)?)\s*([a-z]+)\s*", text)
    if match is None or match[2] not in AGES:
        raise InputError(f"--older-than {text}: expected a number with {', '.join(AGES)}, such as 30d")
    return float(match[1]) * AGES[match[2]]


def spoken_age(seconds: float) -> str:
    for unit in reversed(AGES):
        if unit != "w" and seconds >= AGES[unit]:
            return f"{seconds / AGES[unit]:.0f} {unit}"
    return "just now"


def spoken_size(size: int) -> str:
    return f"{size / 1e6:.1f} MB" if size >= 1e6 else f"{size / 1e3:.0f} kB"


class Times:
    """How long building took on this machine, kept beside the FMUs; a cache that cannot be written keeps none."""

    def __init__(self, folder: Path) -> None:
        self._path = folder / "build-times.json"

    def spoken(self) -> str:
        """How long to wait, in words."""
        times = self._known()
        return f"it took {statistics.median(times):.0f} s before" if times else UNKNOWN

    def keep(self, seconds: float) -> None:
        """Add how long a build took; the last few count."""
        with suppress(OSError), Scratch(self._path.parent) as folder:
            draft = folder / self._path.name
            draft.write_text(json.dumps({"seconds": [*self._known(), round(seconds, 1)][-5:]}))
            draft.replace(self._path)

    def _known(self) -> list[float]:
        """The times kept; none of a file that cannot be read or is damaged, which the next build replaces."""
        try:
            if not self._path.is_file():
                return []
            times = [float(time) for time in json.loads(self._path.read_text())["seconds"]]
        except (OSError, ValueError, KeyError, TypeError, RecursionError):
            return []
        return times if all(0.0 <= time < math.inf for time in times) else []
