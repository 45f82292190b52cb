"""What the summary tells of the capture quality index and of the pull-off test."""

from __future__ import annotations

import pytest

from dcone_cosim.phases.closed_report import PULL_OFF, findings
from fmu_src.cautions import Range
from fmu_src.net_capture.cautions import after
from fmu_src.net_capture.pull_off import STANDS

LAST = {
    "quality.index": 0.7,
    "quality.at_capture": -1.0,
    "pull_off.stands": 2.0,
    "pull_off.t_start": 19.6,
    "pull_off.drawn_max": 1.5,
    "pull_off.tension_max": 60.0,
    "pull_off.work": 16.0,
    **{f"pull_off.slip[{i}]": 0.1 * i for i in (1, 2, 3)},
    **{f"pull_off.hardest[{i}].thread": 600.0 + i for i in range(1, 6)},
    **{f"pull_off.hardest[{i}].tension": 14.0 - i for i in range(1, 6)},
}


def told(**changes: float) -> dict[str, object]:
    return {found.key: found.value for found in findings("capture", {**LAST, **changes})}


def test_the_words_for_how_it_stands_are_the_models() -> None:
    assert PULL_OFF == STANDS


def test_a_net_that_holds_and_what_it_bore() -> None:
    rows = told()
    assert rows["pull_off"] == "the net holds"
    assert rows["pull_off.slip"] == "+0.1, +0.2, +0.3 m"
    assert str(rows["pull_off.threads"]).startswith("13 N (thread 601), 12 N (thread 602)")
    assert (rows["quality.index"], rows["pull_off.tension_max"]) == (0.7, 60.0)
    assert "quality.at_capture" not in rows, "never captured"


@pytest.mark.parametrize(
    ("stands", "text", "further"),
    [(0.0, "not pulled", False), (1.0, "not seen", True), (3.0, "slips off", True)],
)
def test_other_ends_are_told_in_words(stands: float, text: str, further: bool) -> None:
    rows = told(**{"pull_off.stands": stands})
    assert text in str(rows["pull_off"])
    assert ("pull_off.work" in rows) == further


def test_nothing_is_told_without_the_tables() -> None:
    assert told()
    assert not list(findings("capture", {"t_capture": 3.0}))


@pytest.mark.parametrize(("stands", "word"), [(0.0, "still to be pulled"), (1.0, "was pulled"), (2.0, ""), (3.0, "")])
def test_a_phase_that_ends_too_early_is_warned_of(stands: float, word: str) -> None:
    ends = {"captured": 1.0, "pull_off.stands": stands}
    seen = {name: Range(0.0, value, 0.0, value) for name, value in ends.items()}
    cautions = list(after({}, (), {}, seen.get))
    assert [caution.about for caution in cautions] == (["pull_off.stands"] if word else [])
    assert all(word in caution.sentence for caution in cautions)
    assert not list(after({}, (), {}, (seen | {"captured": Range(0.0, 0.0, 0.0, 0.0)}).get))
