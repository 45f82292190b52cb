"""How a folder comes to be whole or not at all.

It is filled under another name beside its place, forced to disk and renamed. A folder that came to be in its place
meanwhile is never touched: the results then go beside it under the next free name. What fails removes its draft; what
dies cannot, and the next one here removes the draft for it.
"""

from __future__ import annotations

import itertools
import json
import os
import shutil
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from dcone_cosim.errors import InputError
from dcone_cosim.names import check_text

if sys.platform == "win32":
    import msvcrt
else:
    import fcntl

PROVENANCE = "provenance.json"
"""The file by which a folder is known as that of a run; its `files` are all that the run wrote."""
LITTER = (".DS_Store", "Thumbs.db", "desktop.ini")
"""What file managers leave in every folder that they show."""
TOLD = 5
"""How many files of others a refusal names."""
UNFINISHED = ".dcone-unfinished"
"""File in a draft that the process filling it holds locked."""


def check_free(folder: Path, force: bool) -> None:
    """Refuse a place that is taken, before any work is done; an empty folder is free."""
    if not _is_free(folder):
        if not force:
            raise InputError(f"{folder} already exists; choose another place with -o, or replace it with --force")
        written = _written(folder)
        if written is None:
            raise InputError(f"{folder} is not the folder of a run: --force will not replace it")
        others = _others(folder, written)
        if others:
            more = f" and {len(others) - TOLD} more" if len(others) > TOLD else ""
            raise InputError(
                f"{folder} holds what no run wrote there: {', '.join(others[:TOLD])}{more}; "
                "--force replaces the files of a run alone: move these, or choose another place with -o"
            )
    _try_place(folder)


def _try_place(folder: Path) -> None:
    """Refuse a place where no folder can be made: it is made, beside itself where one is there, and removed again."""
    check_text(str(folder))
    place = folder.absolute()
    made: list[Path] = []
    try:
        for part in (*reversed(place.parents), place):
            if not os.path.lexists(part):
                part.mkdir()
                made.append(part)
        os.rmdir(tempfile.mkdtemp(prefix=".", dir=place.parent))
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) else str(error)
        raise InputError(f"{folder} cannot be written: {reason}") from None
    finally:
        for part in reversed(made):
            with suppress(OSError):
                part.rmdir()


def _is_free(folder: Path) -> bool:
    if not os.path.lexists(folder):
        return True
    return folder.is_dir() and not folder.is_symlink() and not any(folder.iterdir())


def contents(folder: Path) -> list[str]:
    """Every file below, and every folder that has none, relative to it."""
    found = []
    for path in folder.rglob("*"):
        if path.is_symlink() or not path.is_dir() or not any(path.iterdir()):
            found.append(path.relative_to(folder).as_posix())
    return sorted(found)


def _written(folder: Path) -> set[str] | None:
    """The files that a run wrote into its folder, as its provenance lists them; None where no run has written."""
    try:
        told = json.loads((folder / PROVENANCE).read_text(encoding="utf-8"))
        return {str(name) for name in told.get("files", [PROVENANCE])}
    except (OSError, ValueError, TypeError, AttributeError):
        return None


def _others(folder: Path, written: set[str]) -> list[str]:
    """What is in the folder of a run beside the files that the run wrote."""
    return [name for name in contents(folder) if name not in written and name.rpartition("/")[2] not in LITTER]


class Draft:
    """The folder to fill, `path`, and, once it has taken its name, where that is: `folder`.

    removed      drafts that runs left here which are no more
    """

    def __init__(self, path: Path, folder: Path, removed: int) -> None:
        self.path, self.folder, self.removed = path, folder, removed


@contextmanager
def atomic_folder(folder: Path, force: bool = False) -> Iterator[Draft]:
    """A folder to fill, which takes its name only when the block ends well; otherwise nothing is left.

    force        replace a run of that name; otherwise what has the name by then keeps it, and the draft gets `name-2`
    """
    place = folder.absolute()
    made = [p for p in place.parents if not p.exists()]
    empty = place.is_dir() and _is_free(place)
    path, lock = None, None
    try:
        place.parent.mkdir(parents=True, exist_ok=True)
        path = Path(tempfile.mkdtemp(prefix=".dcone-", dir=place.parent))
        path.chmod(0o755)
        lock = _Lock.of_new(path / UNFINISHED)
        draft = Draft(path, folder, _remove_left_behind(place.parent))
        yield draft
        if lock is not None:
            lock.remove()
        for file in [*path.rglob("*"), path]:
            _to_disk(file)
        if not (force and _replace(path, place)):
            draft.folder = folder.with_name(_take_name(path, place, empty).name)
        _to_disk(place.parent)
    except BaseException:
        if path is not None:
            shutil.rmtree(path, ignore_errors=True)
        for parent in made:
            with suppress(OSError):
                parent.rmdir()
        raise
    finally:
        if lock is not None:
            lock.release()


def _remove_left_behind(place: Path) -> int:
    """Remove the drafts of processes that ended without a word, as at a crash of an FMU; returns how many."""
    removed = 0
    for mark in place.glob(f".*/{UNFINISHED}"):
        lock = None if mark.is_symlink() or mark.parent.is_symlink() else _Lock.of_left(mark)
        if lock is None:
            continue
        if mark.exists():  # otherwise it has just been finished
            shutil.rmtree(mark.parent, ignore_errors=True)
            removed += not mark.parent.exists()
        lock.release()
    return removed


class _Lock:
    """A file that this process has locked. The system unlocks it when the process ends, however that happens."""

    def __init__(self, path: Path, handle: int) -> None:
        self._path, self._handle = path, handle

    @classmethod
    def of_new(cls, path: Path) -> _Lock | None:
        """None, and no file, where the file system has no locks."""
        lock = cls._taken(path, os.O_RDWR | os.O_CREAT | os.O_EXCL)
        if lock is None:
            path.unlink(missing_ok=True)
        return lock

    @classmethod
    def of_left(cls, path: Path) -> _Lock | None:
        """None when a living process has it."""
        return cls._taken(path, os.O_RDWR)

    @classmethod
    def _taken(cls, path: Path, flags: int) -> _Lock | None:
        try:
            handle = os.open(path, flags, 0o644)
        except OSError:
            return None
        try:
            if sys.platform == "win32":
                msvcrt.locking(handle, msvcrt.LK_NBLCK, 1)
            else:
                fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            os.close(handle)
            return None
        return cls(path, handle)

    def remove(self) -> None:
        """Remove the file; where open files can be removed it stays locked for those who have just opened it."""
        if sys.platform == "win32":
            self.release()
        self._path.unlink()

    def release(self) -> None:
        handle, self._handle = self._handle, -1
        if handle >= 0:
            os.close(handle)


def _replace(draft: Path, place: Path) -> bool:
    """Put the draft in the place of an earlier run, which stays if that fails; False when there is none, or files of
    others have come into it meanwhile."""
    written = _written(place)
    if written is None or _others(place, written):
        return False
    aside = Path(tempfile.mkdtemp(prefix=".dcone-old-", dir=place.parent))
    old = aside / "old"
    try:
        place.rename(old)
        draft.rename(place)
    except BaseException:
        if old.exists() and not os.path.lexists(place):
            old.rename(place)
        raise
    finally:
        shutil.rmtree(aside, ignore_errors=True)
    return True


def _take_name(draft: Path, place: Path, empty: bool) -> Path:
    """Give the draft its name, or the first free one of `name-2`, `name-3`, ...: never one that something else has.

    Making an empty folder claims a name: it fails when there is anything, and a rename replaces nothing but an empty
    folder. `empty`: the place was an empty folder from the beginning, which need not be claimed.
    """
    for number in itertools.count(1):
        name = place if number == 1 else place.with_name(f"{place.name}-{number}")
        claimed = False
        try:
            if not (empty and number == 1 and name.is_dir()):
                name.mkdir()
                claimed = True
            if os.name == "nt":
                name.rmdir()
            draft.rename(name)
        except OSError:
            if claimed:
                with suppress(OSError):
                    name.rmdir()
            if not os.path.lexists(name):
                raise
        except BaseException:
            if claimed and draft.exists():
                with suppress(OSError):
                    name.rmdir()
            raise
        else:
            return name
    raise AssertionError("there is always a next number")


def _to_disk(path: Path) -> None:
    if os.name == "nt" and path.is_dir():
        return
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
