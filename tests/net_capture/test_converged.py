"""Aggregates over the pieces that threads are cut into: they come to a limit, by the stored shots."""

import json

import numpy as np
import pytest

from tests.net_capture.evidence.converged import AGGREGATES, PIECES, RESULT, limit


def test_mouth_and_dashpots_come_to_a_limit():
    """Both differences are far beyond chance, the second is the smaller, and errors fall at first order at least."""
    rows = json.loads(RESULT.read_text())["pieces"]["rows"]
    assert [row["pieces"] for row in rows] == list(PIECES)
    means, errors = (np.array([row[name] for row in rows]) for name in ("mean", "error"))
    for name, expected in (("largest mouth area over the flat net's", 0.919), ("taken by the dashpots [J]", 1.64)):
        column = list(AGGREGATES).index(name)
        steps = np.diff(means[:, column])
        assert (np.abs(steps) > 3.0 * np.hypot(errors[1:, column], errors[:-1, column])).all()
        assert (np.diff(np.abs(steps)) < 0.0).all()
        found, order = limit(means[1:, column])
        assert found == pytest.approx(expected, rel=0.01)
        assert 1.0 < order < 2.0


def test_a_limit_is_that_of_a_power_of_the_length():
    pieces = np.array([2.0, 4.0, 8.0])
    for power in (1.0, 2.0):
        assert limit(0.9 + 0.3 * pieces**-power) == pytest.approx((0.9, power), rel=1e-9)
