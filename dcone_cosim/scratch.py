"""Folders for work that is not finished, which nobody has to clear away by hand.

    .dcone-x.lock   locked by the process that works in   .dcone-x
    .dcone-x.old    what gives way to .dcone-x, as long as the two are being exchanged; the lock file names the place

The lock file is there before the folder and goes after it, so there is no instant at which a process may die and leave
what cannot be told from the work of a living one. Each new one clears what the dead have left in the same place.
"""

from __future__ import annotations

import errno
import os
import shutil
import sys
import tempfile
import weakref
from contextlib import suppress
from pathlib import Path

if sys.platform == "win32":
    import msvcrt
else:
    import fcntl

PREFIX, LOCK, OLD = ".dcone-", ".lock", ".old"
TAKEN = (errno.EAGAIN, errno.EWOULDBLOCK, errno.EACCES, errno.EDEADLK)
"""What the system answers when another has the lock."""
LONGEST = 4096
"""Bytes of a name at most."""


class Scratch:
    """A new folder in `parent`; removed by `remove`, with this object, or by whoever comes after a killed process.

    removed      folders of dead processes that were cleared away before
    """

    def __init__(self, parent: Path) -> None:
        self.removed = clear_left(parent)
        self._lock, mark = _Lock.of_new(parent)
        self.path = mark.with_suffix("")
        self.old = mark.with_suffix(OLD)
        self._end = weakref.finalize(self, _end, self.path, self.old, self._lock)
        try:
            self.path.mkdir(mode=0o700)
        except BaseException:
            self.remove()
            raise

    @classmethod
    def temporary(cls) -> Scratch:
        """In the system's folder for what is temporary."""
        return cls(Path(tempfile.gettempdir()))

    def name_place(self, name: str) -> None:
        """Say in the lock file whose place the folder is about to take."""
        if self._lock is not None:
            self._lock.write(name)

    def remove(self) -> None:
        self._end()

    def __enter__(self) -> Path:
        return self.path

    def __exit__(self, *_: object) -> None:
        self.remove()


def _end(path: Path, old: Path, lock: _Lock | None) -> None:
    shutil.rmtree(path, ignore_errors=True)
    if lock is None:
        return
    if path.exists() or os.path.lexists(old):  # as a library that is loaded, on Windows: the next process does it
        lock.release()
    else:
        lock.remove()


def clear_left(parent: Path) -> int:
    """Clear away what processes that were killed left in this folder; returns how many folders.

    One that was killed while its finished folder took its place, be it that of an earlier run, has that done for it.
    """
    removed = 0
    for mark in parent.glob(f"{PREFIX}*{LOCK}"):
        lock = _Lock.of_left(mark)
        if lock is None:
            continue
        if mark.exists():  # otherwise it has just been finished
            removed += _clear(mark.with_suffix(""), mark.with_suffix(OLD), lock.read())
            lock.remove()
        lock.release()
    return removed


def _clear(folder: Path, old: Path, name: str) -> bool:
    if name:
        place = folder.with_name(name)
        with suppress(OSError):
            if place.is_dir() and not place.is_symlink():
                place.rmdir()  # a name that was claimed; this fails for a folder that holds anything
            if not os.path.lexists(place):
                (folder if folder.exists() else old).rename(place)
    there = folder.exists()
    for left in (folder, old):
        shutil.rmtree(left, ignore_errors=True)
    return there


class _Lock:
    """A file that this process has locked. The system unlocks it when the process ends, however that happens."""

    def __init__(self, path: Path, handle: int) -> None:
        self._path, self._handle = path, handle

    @classmethod
    def of_new(cls, parent: Path) -> tuple[_Lock | None, Path]:
        """A new lock and its path; no lock, and no file, where the file system has none."""
        while True:
            handle, name = tempfile.mkstemp(prefix=PREFIX, suffix=LOCK, dir=parent)
            path = Path(name)
            try:
                _lock(handle)
                if path.exists():
                    return cls(path, handle), path
                os.close(handle)  # who clears up held it for dead before it was locked
            except OSError as error:
                os.close(handle)
                path.unlink(missing_ok=True)
                if error.errno not in TAKEN:
                    return None, path

    @classmethod
    def of_left(cls, path: Path) -> _Lock | None:
        """None when a living process has it, or when it belongs to somebody else."""
        try:
            handle = os.open(path, os.O_RDWR | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0))
        except OSError:
            return None
        try:
            if hasattr(os, "getuid") and os.fstat(handle).st_uid != os.getuid():
                raise PermissionError
            _lock(handle)
        except OSError:
            os.close(handle)
            return None
        return cls(path, handle)

    def write(self, text: str) -> None:
        os.ftruncate(self._handle, 0)
        os.lseek(self._handle, 0, os.SEEK_SET)
        os.write(self._handle, text.encode())

    def read(self) -> str:
        os.lseek(self._handle, 0, os.SEEK_SET)
        name = os.read(self._handle, LONGEST).decode("utf-8", "replace")
        return name if name == Path(name).name else ""

    def remove(self) -> None:
        """Remove the file; where open files can be removed it stays locked for those who have just opened it."""
        if sys.platform == "win32":
            self.release()
        self._path.unlink(missing_ok=True)
        self.release()

    def release(self) -> None:
        handle, self._handle = self._handle, -1
        if handle >= 0:
            os.close(handle)


def _lock(handle: int) -> None:
    if sys.platform == "win32":
        msvcrt.locking(handle, msvcrt.LK_NBLCK, 1)
    else:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
