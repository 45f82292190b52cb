"""What the tests of many cases share: cases of a scene that is never run, and a scene of one small FMU that is."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from dcone_cosim.cases.case import Case, digest
from tests.cosim.conftest import dcone, scene_of
from tests.cosim.fmus.build import build

__all__ = ["dcone"]

SCENE = """
title = "A pair that drifts"
phases = ["removal"]

[orbit]
altitude = "700 km"

[removal]
fmu = "my_removal.fmu"
isolate = false
macro_step = "10 s"
duration = "100 s"

[removal.start]
relative_position = ["0 m", "10 m", "0 m"]
relative_velocity = ["0 m/s", "1 mm/s", "0 m/s"]
"""


def case_of(number: int) -> Case:
    """A case for work that only looks at its seed."""
    return Case(digest("case", number), scene_of("removal"), seed=number)


@pytest.fixture
def cases() -> Callable[[int], list[Case]]:
    return lambda count: [case_of(number) for number in range(count)]


@pytest.fixture(scope="session")
def template(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The removal of the C template, compiled once."""
    return build(tmp_path_factory.mktemp("template"))


def put_scene(folder: Path, fmu: Path, text: str = SCENE) -> Path:
    """The scene and its FMU in a folder; returns the scene."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "my_removal.fmu").write_bytes(fmu.read_bytes())
    (folder / "drift.toml").write_text(text)
    return folder / "drift.toml"


@pytest.fixture
def drift(tmp_path: Path, template: Path) -> Path:
    """A scene whose FMU is there already, and takes a millisecond to run."""
    return put_scene(tmp_path / "scene", template)
