"""What is called captured stays in the net: a few shots here, hundreds in the stored result (see `evidence.shots`)."""

import json

import pytest

from tests.net_capture.evidence import shots
from tests.net_capture.evidence.shots import RESULT, draw, follow, main, summarise

SHOTS = (1, 30, 32, 70)
"""Poorly aimed: two that come out within seconds, and two that stay."""


def stored():
    return json.loads(RESULT.read_text())


def test_what_the_centre_alone_took_and_lost_is_not_taken():
    """The twin is the rule of version 0.2.0 on the same shots: it takes what does not last."""
    rows = [follow(number, end=45.0) for number in SHOTS]
    assert [row for row in rows if row["centre_only"]["lost"] is not None]
    assert not [row for row in rows if row["lost"] is not None]
    assert [row for row in rows if row["captured"] is not None]


def test_the_stored_result_is_of_these_shots_and_adds_up():
    result = stored()
    assert result["command"] == "python -m tests.net_capture.evidence.shots"
    assert [row["number"] for row in result["rows"]] == list(range(len(result["rows"])))
    assert summarise(result["rows"]) == result["summary"]
    for row in result["rows"]:
        assert {name: row[name] for name in ("scene", "tilt", "distance", "roll", "spin")} == draw(row["number"])[2]
        if row["captured"] is not None:
            assert row["inside_at_capture"] >= 0.888
            assert row["end"] >= row["captured"] + 60.0 or row["lost"] is not None


def test_a_count_carries_its_interval():
    """Clopper and Pearson for none of n: the upper limit u solves (1 - u)^n = 0.025."""
    told = shots.proportion(0, 150)
    assert told["interval"][0] == 0.0
    assert (1.0 - told["interval"][1]) ** 150 == pytest.approx(0.025, rel=2e-2)


def judge(summary):
    """Fewer come out than by the rule of version 0.2.0, and next to nothing that holds is refused."""
    for what in ("taken_back_within_30_s", "taken_back_within_60_s"):
        assert summary[what]["count"] < summary["centre_only_rule"][what]["count"]
    assert summary["hold_but_refused"] <= 0.05 * summary["hold_to_the_end"]


def test_the_stored_captures_hold_better_than_they_did():
    judge(stored()["summary"])


@pytest.mark.xfail(
    strict=True,
    reason="the cord ties four bullets and leaves four slack loops longer than the girth: some come out through them",
)
def test_the_stored_captures_hold_for_a_minute():
    """What is asked, and open: no judgement of the mouth closes its loops."""
    summary = stored()["summary"]
    assert summary["taken_back_within_60_s"]["count"] <= 0.01 * summary["captured"]


@pytest.mark.evidence
def test_captures_last():
    """Every shot again; the stored result follows."""
    summary = main()["summary"]
    assert summary["shots"] == 200
    judge(summary)
