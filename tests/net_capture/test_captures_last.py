"""What is called captured stays in the net: a few shots here, hundreds in the stored result (see `evidence.shots`)."""

import json

import pytest

from tests.net_capture.evidence import shots
from tests.net_capture.evidence.shots import RESULT, draw, follow, main, summarise
from tests.validation import experiment
from tests.validation_page import CAUGHT, SHOT, interval

SHOTS = (60, 105)
"""Poorly aimed, 13 and 10 degrees."""
SEEDS = (1, 2)
"""Of the jitter: whether a shot so poorly aimed is caught is a sample. Of nine seeds each, 17 of 18 were, with the
rounding of version 0.3.0 as with that of now, and none came out."""
WITHOUT_RINGS = {"closing.rings": 0, "closing.stall_force": 10.0}
"""The closing of version 0.3.0."""


def stored():
    return json.loads(RESULT.read_text())


@pytest.mark.evidence
def test_a_cord_through_rings_holds_what_a_cord_around_four_bullets_loses():
    """The twins: that cord, and with it the rule of version 0.2.0, take what does not last."""
    shots = [(number, seed) for number in SHOTS for seed in SEEDS]
    held = [follow(number, end=30.0, changes={"solver.seed": seed}) for number, seed in shots]
    assert all(row["lost"] is None for row in held)
    assert sum(row["captured"] is not None for row in held) >= len(held) - 1
    twins = [follow(number, end=30.0, changes=WITHOUT_RINGS) for number in SHOTS]
    assert [row for row in twins if row["captured"] is None or row["lost"] is not None]
    assert [row for row in twins if row["centre_only"]["lost"] is not None]


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
    """At most one in a hundred is taken back within a minute; few that hold are refused, and no shot is for nothing."""
    assert summary["taken_back_within_60_s"]["count"] <= 0.01 * summary["captured"]
    assert summary["hold_but_refused"] <= 0.05 * summary["hold_to_the_end"]
    assert summary["captured"] >= 0.75 * summary["shots"]


def test_the_stored_captures_hold_for_a_minute():
    judge(stored()["summary"])


def test_as_many_are_captured_as_met_their_target_on_parabolic_flights(validated):
    """By Wilson's interval. Net, target and aim are ours, as theirs are not published: shares of one size, no more."""
    flights = experiment(f"ESA's net gun on parabolic flights, 2015: {CAUGHT} of {SHOT} nets met their target")
    summary = stored()["summary"]
    share, likely = summary["captured"] / summary["shots"], interval(CAUGHT, SHOT)
    validated(flights, "shots of mixed aim (set-up ours): share captured", share, unit="1", within=likely)


@pytest.mark.evidence
def test_captures_last():
    """Every shot again; the stored result follows."""
    summary = main()["summary"]
    assert summary["shots"] == 200
    judge(summary)
