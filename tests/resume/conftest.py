"""Runs with states on the way, and the same runs without a stop, each made once."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import pytest

from tests.runs import COARSE, put

TUG = (
    *("removal.thrust.level=-0.5 N", "removal.start.separation=11.9 m", "removal.tether.damping_ratio=0"),
    *("removal.macro_step=1 s", "removal.duration=200 s"),
)
"""Table 2's pair, pulled hard: its line comes taut every 58 s, and is slack between."""


@dataclass(frozen=True)
class Kept:
    """A run that kept states, and the same one that did not."""

    scene: str
    settings: tuple[str, ...]
    folder: Path
    whole: Path


def kept(tmp_path_factory: pytest.TempPathFactory, scene: str, settings: tuple[str, ...], *save_at: str) -> Kept:
    place = tmp_path_factory.mktemp(scene)
    return Kept(scene, settings, put(scene, place / "kept", settings, save_at), put(scene, place / "whole", settings))


@pytest.fixture(scope="session")
def mission(tmp_path_factory: pytest.TempPathFactory) -> Kept:
    """States in free flight, in contact, and between tugs."""
    at = ("capture:3 s", "capture:7 s", "removal:10 min", "removal:1200 s", "removal:30 min")
    return kept(tmp_path_factory, "mission", COARSE, *at)


@pytest.fixture(scope="session")
def tug(tmp_path_factory: pytest.TempPathFactory) -> Kept:
    """A state within a tug, with passive safety asked for."""
    settings = (*TUG, "removal.safety_every=50 s", "removal.safety_horizon=10 min")
    return kept(tmp_path_factory, "table2-deorbit", settings, "87 s", "2 min")


@pytest.fixture(scope="session")
def reel(tmp_path_factory: pytest.TempPathFactory) -> Kept:
    """Two coupled FMUs, whose inputs move."""
    return kept(tmp_path_factory, "reel-control", ("removal.duration=20 min",), "250 s")


@pytest.fixture(scope="session")
def steered(tmp_path_factory: pytest.TempPathFactory) -> Kept:
    """The same with steps as long as their error allows."""
    settings = ("removal.duration=10 min", "removal.coupling.control=error", "removal.coupling.step=1 s")
    return kept(tmp_path_factory, "reel-control", settings, "250 s")
