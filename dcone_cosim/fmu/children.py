"""Children for FMUs in processes of their own, started ahead: to import what they need takes as long as much else."""

from __future__ import annotations

import subprocess

from dcone_cosim.child import kill, start

CHILD = "dcone_cosim.fmu.isolated_child"
FAREWELL = 5.0
"""How long a child may take to free its FMU [s]."""

_ready: list[subprocess.Popen[bytes]] = []


def make_ready(count: int) -> None:
    """Start children ahead: to import what they need takes each 0.2 s, in which something else can be done."""
    _ready.extend(start(CHILD) for _ in range(count))


def dismiss() -> None:
    """End the children that nobody has needed."""
    while _ready:
        child = _ready.pop()
        try:
            child.communicate(timeout=FAREWELL)  # it ends with the stream of its calls
        except subprocess.TimeoutExpired:
            kill(child)
            child.communicate()


def next_child() -> subprocess.Popen[bytes]:
    """One that was made ready, or a new one."""
    while _ready:
        child = _ready.pop(0)
        if child.poll() is None:
            return child
        child.communicate()
    return start(CHILD)
