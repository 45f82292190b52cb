"""Aggregates of an opening over substeps and pieces of thread, and the scaling law for every shape, as stored."""

import json

import numpy as np
import pytest

from tests.net_capture.evidence import converged, similar

WITHIN = {"share": 0.01, "pieces": 0.05}
"""Share by which an aggregate may move from the default substep to the finest, from uncut threads to the finest cut,
beside three standard errors."""
ALIKE = 1.0
"""Per cent of the flat net's area, what the scaling law is held to."""


def judge_converged(rows):
    """Each aggregate at the default against the finest of either kind."""
    default = next(row for row in rows if (row["pieces"], row["share"]) == (1, 1.0))
    for kind, finest in (
        ("share", min(rows, key=lambda row: row["share"])),
        ("pieces", max(rows, key=lambda row: row["pieces"])),
    ):
        off = np.abs(np.subtract(default["mean"], finest["mean"]))
        chaos = 3.0 * np.hypot(default["error"], finest["error"])
        assert (off <= WITHIN[kind] * np.abs(finest["mean"]) + chaos).all(), (kind, off, chaos)


def stored(module):
    return json.loads(module.RESULT.read_text())["rows"]


def test_aggregates_hang_on_neither():
    rows = stored(converged)
    assert {row["share"] for row in rows} == set(converged.SHARES)
    assert {row["pieces"] for row in rows} == set(converged.PIECES)
    judge_converged(rows)


def test_an_aggregate_that_moves_is_told():
    """The twin: a finest substep that opens the mouth by 3 % less."""
    rows = stored(converged)
    moved = [dict(row, mean=[0.97 * row["mean"][0], *row["mean"][1:]]) if row["share"] < 0.3 else row for row in rows]
    with pytest.raises(AssertionError):
        judge_converged(moved)


def test_a_stored_shot_is_one_of_today():
    """A slice of it: one shot at the default lies within four standard deviations of the stored mean."""
    rows = stored(converged)
    default = next(row for row in rows if (row["pieces"], row["share"]) == (1, 1.0))
    spread = np.array(default["error"]) * np.sqrt(converged.SHOTS)
    off = np.abs(np.subtract(converged.shot(0, 1, 1.0), default["mean"]))
    assert (off <= 4.0 * spread + 1e-3 * np.abs(default["mean"])).all()


def test_every_shape_obeys_the_scaling_law():
    """And a net whose masses are scaled by s2 does not."""
    rows = {row["shape"]: row for row in stored(similar)}
    assert set(rows) == set(similar.SHAPES)
    for row in rows.values():
        assert max(row["off"].values()) < ALIKE
        assert row["twin"] > 3.0 * ALIKE
        assert row["largest"] > 50.0


def test_a_square_is_similar_today():
    """A slice of it."""
    whole, small = (similar.curve("square", s) for s in (1.0, 1.0 / 16.0))
    assert 100.0 * np.abs(whole - small).max() < ALIKE
    assert 100.0 * whole.max() == pytest.approx(
        next(r["largest"] for r in stored(similar) if r["shape"] == "square"), rel=0.01
    )


@pytest.mark.evidence
def test_all_of_it_again():
    judge_converged(converged.main()["rows"])
    similar.main([])
    test_every_shape_obeys_the_scaling_law()
