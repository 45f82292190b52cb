"""What this process has put in its place for good, so that no error after it says that nothing was written.

A file is written under another name (see `scratch`) and comes to its place whole, in one step.
"""

from __future__ import annotations

import errno
import os
from pathlib import Path

from dcone_cosim.interrupts import postponed

NO_LINKS = (errno.EPERM, errno.ENOTSUP, errno.EOPNOTSUPP, errno.ENOSYS, errno.EMLINK)
"""What a file system answers that has no hard links."""

_paths: list[Path] = []


def forget() -> None:
    """A command begins."""
    _paths.clear()


def note(path: Path) -> None:
    """This is whole and in its place."""
    _paths.append(path)


def put(draft: Path, path: Path) -> Path:
    """Move a finished file to its place; an earlier one gives way."""
    with postponed():
        draft.replace(path)
        note(path)
    return path


def put_new(draft: Path, path: Path) -> Path:
    """Move a finished file to a place where there must be none: `FileExistsError` otherwise, and that one stays."""
    with postponed():
        if os.name == "nt":
            draft.rename(path)  # which replaces nothing there
        else:
            _link(draft, path)
        note(path)
    return path


def _link(draft: Path, path: Path) -> None:
    """Give a file a second name, which fails where there is anything; without links the place is looked at before."""
    try:
        os.link(draft, path)
    except OSError as error:
        if error.errno not in NO_LINKS:
            raise
        if os.path.lexists(path):
            raise FileExistsError(errno.EEXIST, os.strerror(errno.EEXIST), str(path)) from None
        draft.rename(path)


def any_there() -> bool:
    return bool(_paths)


def told() -> str:
    """What stands, in words that end a message."""
    if not _paths:
        return "nothing was written"
    return f"written before that, and complete: {', '.join(str(path) for path in _paths)}"
