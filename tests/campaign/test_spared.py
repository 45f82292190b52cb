"""What a campaign asks for is what is run: nothing beside the tow where no figure of that is kept."""

from __future__ import annotations

from typing import Any

import pytest

from dcone_cosim.campaign import shots
from dcone_cosim.campaign.shots import Shot, ground_of, run_shot
from dcone_cosim.cases.case import Case
from dcone_cosim.cases.rows import Row
from dcone_cosim.loading import load


@pytest.mark.parametrize(
    ("kept", "beside"),
    [
        ((), True),
        (("removal.first_tug_peak", "capture.outcome"), False),
        (("removal.first_tug_peak", "removal.first_tug_peak_without_recoil"), True),
    ],
)
def test_the_tow_without_recoil_is_made_where_it_is_asked_for(
    kept: tuple[str, ...], beside: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    seen: list[Any] = []

    def run_case(case: Case, tell: Any, tables: bool) -> Row:
        seen.append((case.scene.handoff.compare_without_recoil, tables))
        return Row(case.key, "completed")

    monkeypatch.setattr(shots, "run_case", run_case)
    base = load("mission")
    run_shot(Shot("key", 1, (), ground_of(base, record=kept)))
    run_shot(Shot("key", 0, (), ground_of(base, record=kept)))
    assert seen == [(beside, False), (True, False)], "the scene as it is has all figures"
    assert base.handoff.compare_without_recoil
