"""Kernels that do nothing: of points, of bodies that do not turn, and of lines that go straight."""

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
    """Over any step [s].

    Checked  tests/tethered_deorbit/test_macro_step.py
    """
    return math.inf


@kernel
def always(*arguments: Any) -> bool:
    """A straight line goes straight."""
    return True


@kernel
def never(*arguments: Any) -> bool:
    """And needs no other way."""
    return False


@kernel
def no_fault(*arguments: Any) -> int:
    """Nothing is wrong."""
    return 0
