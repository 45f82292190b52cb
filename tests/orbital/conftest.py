"""Every kernel is tested twice: compiled, and as the plain Python it was written in."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest


@pytest.fixture(params=["compiled", "uncompiled"])
def run(request: pytest.FixtureRequest) -> Callable[..., Any]:
    """A function that picks the compiled or the plain form of a kernel."""
    compiled = request.param == "compiled"
    return lambda kernel: kernel if compiled else kernel.py_func


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(20240229)
