"""Columns, snapshots and tugs are kept as they came."""

from __future__ import annotations

import numpy as np

from dcone_cosim.fmu.component import VariableInfo
from dcone_cosim.recorder import Recorder, Snapshots, TugLog

VARIABLES = {
    "a": VariableInfo("a", 0, "Real", "m", "output", ""),
    "count": VariableInfo("count", 1, "Integer", "1", "output", ""),
    "flag": VariableInfo("flag", 2, "Boolean", "1", "output", ""),
}


def test_rows_survive_growing() -> None:
    recorder = Recorder(["a", "count", "flag"], VARIABLES, expected_rows=2)
    row = np.zeros(3)
    for i in range(100):
        row[:] = 0.5 * i, i, i % 2
        recorder.add(0.1 * i, row)
    assert len(recorder) == 100
    np.testing.assert_array_equal(recorder["a"], 0.5 * np.arange(100))
    assert recorder.column("count").dtype == np.int64
    assert recorder.column("flag").dtype == np.bool_
    assert recorder.units["a"] == "m"
    assert recorder.last() == {"a": 49.5, "count": 99.0, "flag": 1.0}


def test_snapshots_at_the_times_asked() -> None:
    snapshots = Snapshots([0.0, 0.25, 0.3, 9.0])
    for i in range(11):
        if snapshots.due(0.1 * i, 1e-9):
            snapshots.add(0.1 * i, np.full((2, 3), i))
    np.testing.assert_allclose(snapshots.times, [0.0, 0.3])
    assert snapshots.nodes[1][0, 0] == 3


def test_snapshots_are_thinned_evenly() -> None:
    snapshots = Snapshots(limit=8)
    for i in range(1000):
        if snapshots.due(float(i), 1e-9):
            snapshots.add(float(i), np.zeros((1, 3)))
    gaps = np.diff(snapshots.times)
    assert 4 <= len(snapshots.times) <= 8
    assert (gaps == gaps[0]).all()


def test_each_tug_once_with_its_final_peak() -> None:
    tugs = TugLog(ring=2)
    tugs.update(1, np.array([[10.0, 1.0, 0.1], [0.0, 0.0, 0.0]]))
    tugs.update(1, np.array([[10.0, 3.0, 0.1], [0.0, 0.0, 0.0]]))
    tugs.update(3, np.array([[30.0, 2.0, 0.1], [20.0, 5.0, 0.2]]))
    assert tugs.rows == {1: (10.0, 3.0, 0.1), 2: (20.0, 5.0, 0.2), 3: (30.0, 2.0, 0.1)}
    assert tugs.missed == 0


def test_tugs_that_left_the_ring_are_counted_as_missed() -> None:
    tugs = TugLog(ring=2)
    tugs.update(5, np.array([[50.0, 1.0, 0.1], [40.0, 1.0, 0.1]]))
    assert sorted(tugs.rows) == [4, 5]
    assert tugs.missed == 3


def test_no_memory_is_taken_for_rows_that_may_never_come() -> None:
    recorder = Recorder(["a"], VARIABLES, expected_rows=10**15)
    assert sum(block.nbytes for block in recorder._blocks) < 1e6
    for i in range(3000):
        recorder.add(float(i), np.array([2.0 * i]))
    np.testing.assert_array_equal(recorder["time"], np.arange(3000))
    np.testing.assert_array_equal(recorder["a"], 2.0 * np.arange(3000))
    assert recorder.last() == {"a": 5998.0}
    assert sum(block.nbytes for block in recorder._blocks) < 4 * 3000 * 2 * 8
