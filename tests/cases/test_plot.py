"""The picture of a sweep: its axis in the unit that the values were given in, with labels that do not meet."""

from __future__ import annotations

from itertools import pairwise

import pytest

from dcone_cosim.cases.case import Value
from dcone_cosim.cases.plot import _figure
from dcone_cosim.cases.rows import Row
from dcone_cosim.cases.table import Column, Entry

KEY, PEAK = "removal.tether.diameter", "removal.tension_mean"


def drawn(given: list[str], si: list[float], unit: str = "m") -> tuple[str, list[float], bool]:
    """Label of the axis, where the points stand on it, and whether all labels lie apart, inside the picture."""
    entries = [
        Entry(Row(text, "completed"), {KEY: Value(text, number, unit)}) for text, number in zip(given, si, strict=True)
    ]
    peaks = Column(PEAK, [0.0312875 + 1e-6 * i for i in range(len(si))], "N")
    figure = _figure(entries, [peaks], KEY, None, {KEY: Column(KEY, si, unit), PEAK: peaks})
    figure.canvas.draw()
    (axes,) = figure.axes
    ticks = [tick.get_window_extent() for tick in axes.get_xticklabels() if tick.get_text()]
    apart = all(one.x1 < other.x0 for one, other in pairwise(ticks))
    inside = axes.yaxis.label.get_window_extent().x0 > 0.0
    return axes.get_xlabel(), axes.lines[0].get_xdata().tolist(), apart and inside


def test_the_unit_is_the_one_that_was_given() -> None:
    label, places, legible = drawn(["1 mm", "2 mm", "3 mm"], [1e-3, 2e-3, 3e-3])
    assert label == f"{KEY} [mm]"
    assert places == pytest.approx([1.0, 2.0, 3.0])
    assert legible


def test_values_in_several_units_are_si() -> None:
    label, places, legible = drawn(["1 mm", "0.2 cm", "0.003 m"], [1e-3, 2e-3, 3e-3])
    assert label == f"{KEY} [m]"
    assert places == [1e-3, 2e-3, 3e-3]
    assert legible


def test_a_pure_number_has_none() -> None:
    for given in (["0.05", "5 %", "0.1"], ["0.05", "0.05", "0.1"]):
        label, places, _ = drawn(given, [0.05, 0.05, 0.1], "1")
        assert (label, places) == (KEY, [0.05, 0.05, 0.1])
