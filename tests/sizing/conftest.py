"""One sizing of Table 2's tow, short and with few runs, for all tests that look at what it leaves."""

from __future__ import annotations

import pytest

from dcone_cosim.progress import Progress
from dcone_cosim.sizing import commands
from dcone_cosim.sizing.result import Sizing

SHORT = ("removal.duration=80 min", "removal.macro_step=20 s")
"""Eleven tugs, the hardest among them."""
SAFETY = 2.5


@pytest.fixture(scope="session")
def done(tmp_path_factory: pytest.TempPathFactory) -> Sizing:
    folder = tmp_path_factory.mktemp("sizing") / "out"
    return commands.size(
        "table2-deorbit", folder, Progress(), SHORT, quick=True, factor_of_safety=SAFETY, samples=2,
        ranges=("removal.thrust.level=-0.012 N..-0.008 N",), materials=("Technora", "Vectran braid"),
    )  # fmt: skip
