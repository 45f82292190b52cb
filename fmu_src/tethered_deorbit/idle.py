"""Kernels that do nothing: of parts that a scene lacks, of points, and of lines that go straight."""

from __future__ import annotations

import math
from typing import Any

from orbital.kernel import kernel


@kernel
def nothing(*arguments: Any) -> None:
    """Does nothing, whatever it is given."""


@kernel
def zero(*arguments: Any) -> float:
    """No energy [J], no error, no sliding."""
    return 0.0


@kernel
def no_end(*arguments: Any) -> float:
    """Never due, under no limit, over any step [s], [N].

    Checked  tests/tethered_deorbit/test_macro_step.py
    """
    return math.inf


@kernel
def always(*arguments: Any) -> bool:
    """What is asked holds, whatever the state."""
    return True


@kernel
def never(*arguments: Any) -> bool:
    """And nothing else is needed."""
    return False


@kernel
def no_fault(*arguments: Any) -> int:
    """Nothing is wrong."""
    return 0
