"""The tools a build calls, as child processes that can be stopped."""

from __future__ import annotations

import subprocess
from collections.abc import Mapping, Sequence
from pathlib import Path
from threading import Lock


class BuildError(RuntimeError):
    """A tool of the build failed, or the build has no place to write; carries the reason."""


_running: set[subprocess.Popen[str]] = set()
_lock = Lock()


def run(
    what: str, command: Sequence[str], environment: Mapping[str, str] | None = None, place: Path | None = None
) -> str:
    """Run a tool to its end, in a folder if one is named; its words, BuildError with the last of them if it fails."""
    pipe, both = subprocess.PIPE, subprocess.STDOUT
    with subprocess.Popen(command, env=environment, cwd=place, stdout=pipe, stderr=both, text=True) as process:
        with _lock:
            _running.add(process)
        try:
            words, _ = process.communicate()
        finally:
            with _lock:
                _running.discard(process)
    if process.returncode:
        raise BuildError(f"{what} failed:\n{words.strip()[-2000:]}")
    return words


def stop() -> None:
    """Kill what is running: the user wants out."""
    with _lock:
        for process in _running:
            process.kill()
