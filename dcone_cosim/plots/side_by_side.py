"""Part of the work of a list in a second process, where that is safe: figures are drawn on two cores."""

from __future__ import annotations

import json
import os
import select
import signal
import sys
import warnings
from collections.abc import Callable, Sequence
from typing import TypeVar

Task = TypeVar("Task")
PATIENCE = 30.0
"""How long the other process may take before its part is done here [s]."""


def halves(work: Callable[[Sequence[Task]], list[str]], first: Sequence[Task], rest: Sequence[Task]) -> list[str]:
    """`work(first) + work(rest)`, the first part in a forked process on Linux with more than one core.

    The process shares what is computed, and writes files only. What it fails to report is done again here.
    """
    if not (first and rest and sys.platform == "linux" and (os.cpu_count() or 1) > 1):
        return work([*first, *rest])
    reading, writing = os.pipe()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # Python 3.12 warns of threads; none of ours runs then
        child = os.fork()
    if child == 0:
        try:
            os.write(writing, json.dumps(work(first)).encode() + b"\n")
        finally:
            os._exit(0)
    try:
        os.close(writing)
        done = work(rest)
        told = _read(reading)
    finally:
        os.close(reading)
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
    return (work(first) if told is None else told) + done


def _read(pipe: int) -> list[str] | None:
    """The report of the other process, None when it gave none."""
    content = b""
    while not content.endswith(b"\n"):
        if not select.select([pipe], [], [], PATIENCE)[0]:
            return None
        part = os.read(pipe, 65536)
        if not part:
            return None
        content += part
    report: list[str] = json.loads(content)
    return report
