"""Stored results of many shots: what they are made of, and that they add up."""

import json
from pathlib import Path

import numpy as np
import pytest

import fmu_src.net_capture
from tests.net_capture.evidence import contact_terms, indices, launches, self_contact
from tests.net_capture.evidence.shots import draw


def test_index_and_captured_are_compared_over_these_shots():
    result = json.loads(indices.RESULT.read_text())
    rows = result["rows"]
    assert result["command"] == indices.COMMAND
    assert [row["number"] for row in rows] == list(range(indices.SHOTS))
    assert result["captured"] == sum(row["captured"] for row in rows)
    for row in rows:
        assert {name: row[name] for name in ("scene", "tilt", "distance", "roll", "spin")} == draw(row["number"])[2]
        assert row["captured"] == (row["outcome"] in ("captured", "settled"))
        assert 0.0 < row["index_least"] <= row["index"]
    assert [indices.disagreement(rows, threshold) for threshold in indices.THRESHOLDS] == result["disagreements"]
    differ = {told["threshold"]: told["captured_alone"] + told["index_alone"] for told in result["disagreements"]}
    assert differ[1.0] <= 2, "at the best threshold they say the same"
    assert differ[0.5] > 20, "the twin: at another they do not"
    assert result["captured"] >= 0.9 * indices.SHOTS


def test_launches_scatter_as_their_rows_say():
    result = json.loads(launches.RESULT.read_text())
    rows = result["rows"]
    assert (result["command"], len(rows)) == (launches.COMMAND, launches.SHOTS)
    assert result["captured"] == sum(row["outcome"] == "captured" for row in rows) == launches.SHOTS
    for name, told in result["times"].items():
        times = np.array([row[name] for row in rows])
        assert told["mean"] == pytest.approx(times.mean(), abs=1e-3)
        assert told["deviation"] == pytest.approx(times.std(ddof=1), abs=1e-3)
    assert result["times"]["open"]["mean"] == pytest.approx(9.04, rel=0.03)


def test_what_terms_of_contact_change_is_told_as_the_rows_say():
    result = json.loads(contact_terms.RESULT.read_text())
    rows, choices = result["rows"], list(contact_terms.CHOICES)
    assert result["command"] == contact_terms.COMMAND
    assert [(row["number"], row["choice"]) for row in rows] == [(n, c) for n in range(result["shots"]) for c in choices]
    assert result["summary"] == contact_terms.summarise(rows)
    assert result["shots"] >= contact_terms.SHOTS
    first, friction = (result["summary"][choice] for choice in (choices[0], "law A, wrap with friction"))
    assert friction["friction_loss"]["mean"] > 5.0
    assert friction["remainder"]["mean"] == pytest.approx(first["remainder"]["mean"], abs=0.05), "of friction nothing"
    told = contact_terms.lines(result["summary"], result["shots"])
    page = Path(f"{fmu_src.net_capture.__path__[0]}/README.md").read_text().splitlines()
    at = page.index(told[0])
    assert page[at : at + len(told)] == told


@pytest.mark.evidence
@pytest.mark.parametrize("module", [indices, launches])
def test_a_shot_comes_out_as_it_is_stored(module):
    stored = json.loads(module.RESULT.read_text())["rows"][0]
    assert module.follow(0) == stored


def test_what_contact_of_threads_changes_is_told_as_the_rows_say():
    result = json.loads(self_contact.RESULT.read_text())
    rows, choices = result["rows"], list(self_contact.CHOICES)
    assert (result["command"], result["starts"]) == (self_contact.COMMAND, self_contact.STARTS)
    assert [(row["seed"], row["choice"]) for row in rows] == [(n, c) for n in range(result["starts"]) for c in choices]
    assert result["summary"] == self_contact.summarise(rows)
    thick = result["summary"]["10 mm"]
    assert thick["passed"]["mean"] == 0.0
    assert result["summary"]["as thick as they are"]["passed"]["mean"] > 0.0
