"""What this process has put in its place for good, so that no error after it says that nothing was written."""

from __future__ import annotations

from pathlib import Path

_paths: list[Path] = []


def forget() -> None:
    """A command begins."""
    _paths.clear()


def note(path: Path) -> None:
    """This is whole and in its place."""
    _paths.append(path)


def any_there() -> bool:
    return bool(_paths)


def told() -> str:
    """What stands, in words that end a message."""
    if not _paths:
        return "nothing was written"
    return f"written before that, and complete: {', '.join(str(path) for path in _paths)}"
