"""Files that are read: regular ones. A pipe waits for whoever writes into it, and a device may never end."""

from __future__ import annotations

import errno
import stat
from pathlib import Path

FILE_KINDS = (
    (stat.S_ISFIFO, "a pipe"),
    (stat.S_ISSOCK, "a socket"),
    (stat.S_ISCHR, "a device"),
    (stat.S_ISBLK, "a device"),
)


def no_file(path: Path) -> str:
    """What else than a file or a folder there is at the path, "" when there is nothing else.

    Raises `OSError` or `ValueError` when the path cannot be looked at.
    """
    try:
        mode = path.stat().st_mode
    except (FileNotFoundError, NotADirectoryError):
        return ""
    return next((what for is_kind, what in FILE_KINDS if is_kind(mode)), "")


def regular(path: Path) -> Path:
    """The path, to be opened for reading; an `OSError` that says so when it is a pipe, a socket or a device."""
    what = no_file(path)
    if what:
        raise OSError(errno.EINVAL, f"it is {what}; expected a file", str(path))
    return path
