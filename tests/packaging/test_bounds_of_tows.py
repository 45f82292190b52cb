"""Tows of all that a scene may name reach for nothing beyond their rows: run as plain Python, which compiles nothing.

What is compiled, and shots: `test_bounds`, as evidence.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import fmu_src.instance
import tests.plain
from dcone_cosim.loading import load
from fmu_src.catalogue import MODELS
from fmu_src.instance import Instance
from tests.packaging import compositions
from tests.plain import plain as plain

LONGEST = 120.0
"""Of the steps [s]."""
DEAR = "nodes"
"""Takes a minute as plain Python; compiled, `test_bounds` has it."""
SLOW = {"round", "hull", "radau", "settled round", "settled hull", "sampled", "schedule"}
"""Those that take 4 to 32 s: evidence."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The scenes."""
    made = tmp_path_factory.mktemp("compositions")
    compositions.write(made)
    return made


class Within(np.ndarray):
    """Numbers none of which is reached by an index below zero."""

    def __getitem__(self, where: Any) -> Any:
        assert at_least(where) >= 0
        return super().__getitem__(where)

    def __setitem__(self, where: Any, value: Any) -> None:
        assert at_least(where) >= 0
        super().__setitem__(where, value)


def at_least(where: Any) -> int:
    """The least of the indices of an element, 0 where there is none."""
    every = where if isinstance(where, tuple) else (where,)
    return min((int(i) for i in every if isinstance(i, int | np.integer)), default=0)


@pytest.fixture
def within(plain: None, monkeypatch: pytest.MonkeyPatch) -> None:
    """Kernels run as plain Python, where numpy knows how long an array is."""
    seen, aligned = tests.plain.seen, fmu_src.instance._aligned

    def rows_within(record: np.ndarray) -> Any:
        (fields,) = seen(record)
        fields._arrays = {name: array.view(Within) for name, array in fields._arrays.items()}
        return [fields]

    monkeypatch.setattr(tests.plain, "seen", rows_within)
    monkeypatch.setattr(fmu_src.instance, "_aligned", lambda size: aligned(size).view(Within))


@pytest.mark.usefixtures("within")
@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=pytest.mark.evidence) if name in SLOW else name
        for name in compositions.TOWS
        if name != DEAR
    ],
)
def test_the_first_steps_of_a_tow_are_within_its_rows(name: str, folder: Path) -> None:
    """What a compiled shot takes minutes for, a tow run as plain Python shows in seconds."""
    (phase,) = load(str(folder / "tow.toml"), compositions.TOWS[name]).phases
    instance = Instance(MODELS[phase.main.model], phase.main.terms, phase.main.parameters, phase.main.numbers)
    instance.initialise()
    inputs = [v for v in instance.interface.variables if v.causality == "input"]
    for step in range(4):
        if step == 2:
            instance.set_rates({v.name: 1e-9 for v in inputs if v.rate})
            instance.differentiate()
        instance.step(min(phase.duration / 400.0, LONGEST))
    for v in inputs:
        instance[v.name] += 1e-6
    instance.refresh()


@pytest.mark.usefixtures("within")
def test_a_row_a_number_too_short_is_noticed(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    rows = tests.plain.seen

    def shorter(record: np.ndarray) -> Any:
        (fields,) = rows(record)
        fields._arrays["state_at_end"] = fields._arrays["state_at_end"][:-1]
        return [fields]

    monkeypatch.setattr(tests.plain, "seen", shorter)
    with pytest.raises(IndexError, match="out of bounds"):
        test_the_first_steps_of_a_tow_are_within_its_rows("linear", folder)
