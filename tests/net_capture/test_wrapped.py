"""Threads that bend round what is thin and hollow: shots as they are stored."""

import json

import pytest

from dcone_cosim.loading import shipped
from tests.net_capture.evidence.wrapped import CASES, RESULT

ROWS = json.loads(RESULT.read_text())["rows"]


def test_every_case_is_stored():
    assert {(row["case"], row["seed"]) for row in ROWS} == {
        (case, seed) for case, (_, _, shots) in CASES.items() for seed in range(shots)
    }
    assert {scene for scene, _, _ in CASES.values()} <= set(shipped())


@pytest.mark.parametrize("case", CASES)
def test_no_thread_goes_through_and_many_bend(case):
    for row in (row for row in ROWS if row["case"] == case):
        assert (row["passed"], row["slack"]) == (0, 0)
        assert row["bent"] > 5
        assert row["open"] < 0.03
