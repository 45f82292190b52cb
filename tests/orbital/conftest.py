"""Formulas are tested as the plain Python that they are written in.

Compiled they are in every model, whose bits in the FMU are those of the kernels; here each is compiled as well under
the marker `evidence`, and where a test asks for `compiled`.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from orbital.kernel import Kernel


@pytest.fixture(params=[pytest.param("compiled", marks=pytest.mark.evidence), "uncompiled"])
def run(request: pytest.FixtureRequest) -> Callable[..., Any]:
    """A function that picks the compiled or the plain form of a kernel."""
    compiled = request.param == "compiled"
    return lambda kernel: kernel if compiled else kernel.py_func


@pytest.fixture
def compiled() -> None:
    """For a test of what compiled code alone does: it divides by zero, for one."""


@pytest.fixture(autouse=True)
def as_written(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Have a test that does not ask for compiled kernels call the functions that they were written as."""
    if "compiled" not in request.fixturenames and request.node.get_closest_marker("evidence") is None:
        monkeypatch.setattr(Kernel, "dispatcher", property(lambda kernel: kernel.py_func))


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(20240229)
