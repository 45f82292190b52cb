"""Kernels run as plain Python: what would be dear to compile anew, and formulas that a test changes on the way."""

from __future__ import annotations

import importlib
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pytest

from fmu_src import instance
from fmu_src.instance import Instance
from fmu_src.interface import Model, Value
from orbital.kernel import Kernel


def _entry(model: Model, terms: Mapping[str, str]) -> Any:
    return importlib.import_module(model.module).make_entry(dict(terms))


@pytest.fixture
def plain(monkeypatch: pytest.MonkeyPatch) -> None:
    """As long as the test runs, every kernel is the function it was written as."""
    monkeypatch.setattr(Kernel, "dispatcher", property(lambda kernel: kernel.py_func))
    monkeypatch.setattr(instance, "entry_of", _entry)


class PlainInstance(Instance):
    """An instance for `plain`, initialised; a parameter may be a whole array, by its field's name."""

    def __init__(
        self, model: Model, terms: Mapping[str, str], parameters: Mapping[str, Value | Sequence[float]] | None = None
    ) -> None:
        super().__init__(model, terms)
        self.record: Any = self.record.view(np.recarray)  # only of these plain Python reads fields as attributes
        for name, value in (parameters or {}).items():
            if isinstance(value, Sequence):
                self.array(name)[:] = value
            else:
                self[name] = value
        self.initialise()
