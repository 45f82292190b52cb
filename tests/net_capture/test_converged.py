"""Aggregates over the pieces that threads are cut into: they come to a limit, by the stored shots."""

import json

import numpy as np
import pytest

from tests.net_capture.evidence.converged import AGGREGATES, CLOSED, OPEN_FOR, PIECES, RESULT, limit

LIMITS = {
    "largest mouth area over the flat net's": (0.919, 1.0),
    "80 % open from [s]": (9.38, 0.8),
    "80 % open for [s]": (4.41, 1.0),
    "taken by the dashpots [J]": (1.64, 1.0),
}
"""Where they lead to, and the least order."""


@pytest.mark.parametrize("name", LIMITS)
def test_an_aggregate_comes_to_a_limit(name):
    """Every difference is far beyond chance, each is smaller than the one before, and errors fall at first order."""
    rows = json.loads(RESULT.read_text())["pieces"]["rows"]
    assert [row["pieces"] for row in rows] == list(PIECES)
    column = list(AGGREGATES).index(name)
    means, errors = (np.array([row[of][column] for row in rows]) for of in ("mean", "error"))
    steps = np.diff(means)
    assert (np.abs(steps) > 3.0 * np.hypot(errors[1:], errors[:-1])).all()
    assert (np.diff(np.abs(steps)) < 0.0).all()
    expected, least = LIMITS[name]
    found, order = limit(means[1:])
    assert found == pytest.approx(expected, rel=0.01)
    assert least < order < 2.0


def test_no_mouth_is_still_open_when_it_is_told_for_how_long_it_was():
    """Shots that are followed to 14 s end that time with them: 14.01 s for uncut threads and for two pieces alike."""
    opened, lasted = (list(AGGREGATES).index(name) for name in ("80 % open from [s]", OPEN_FOR))
    until = [row["mean"][opened] + row["mean"][lasted] for row in json.loads(RESULT.read_text())["pieces"]["rows"]]
    assert max(until) < CLOSED - 1.0
    assert until[0] - until[1] > 0.5


def test_a_limit_is_that_of_a_power_of_the_length():
    pieces = np.array([2.0, 4.0, 8.0])
    for power in (1.0, 2.0):
        assert limit(0.9 + 0.3 * pieces**-power) == pytest.approx((0.9, power), rel=1e-9)
