"""Cycles and classes against counts made by hand."""

from __future__ import annotations

from dcone_cosim.sizing.spectrum import by_size, cycle_classes, cycles, turning_points


def test_tugs_from_slack_to_slack_are_cycles_of_their_peak() -> None:
    points = turning_points({"tugs": [(1.0, 5.0, 0.1), (2.0, 3.0, 0.1), (9.0, 4.0, 0.1)]})
    assert points == [0.0, 5.0, 0.0, 3.0, 0.0, 4.0, 0.0]
    found = cycles(points)

    whole = {size: sum(count for other, _, count in found if other == size) for size in (3.0, 4.0, 5.0)}
    assert whole == {3.0: 1.0, 4.0: 1.0, 5.0: 1.0}


def test_a_tug_that_lasts_over_macro_steps_counts_once() -> None:
    """Rows tell its peak too; the tension between is that of the line that stays taut."""
    loads = {"tugs": [(0.5, 9.0, 0.1)], "taut": [(2.0, 2.0, 9.0), (3.0, 1.0, 2.5), (4.0, 1.0, 3.0)]}
    points = turning_points(loads)
    assert points.count(9.0) == 1
    assert points == [0.0, 2.0, 9.0, 2.5, 1.0, 3.0]
    hidden = {**loads, "taut": [(2.0, 2.0, 8.0), (3.0, 1.0, 2.5)]}
    assert turning_points(hidden)[:3] == [0.0, 9.0, 8.0], "a peak that no row tells is there all the same"


def test_a_row_belongs_to_the_tug_that_it_ends_after() -> None:
    """One that ends as a tug begins tells of the time before it."""
    loads = {"tugs": [(1.0, 5.0, 0.1), (4.0, 3.0, 0.1)], "taut": [(4.0, 2.0, 5.0)]}
    assert turning_points(loads) == [0.0, 2.0, 5.0, 0.0, 3.0, 0.0]


def test_rainflow_of_the_standard() -> None:
    """The example of ASTM E1049-85, figure 6: ranges 3, 4, 4, 6, 8, 8, 9, of which one, the 4 in between, is whole."""
    found = cycles([-2.0, 1.0, -3.0, 5.0, -1.0, 3.0, -4.0, 4.0, -2.0])
    assert sorted((size, count) for size, _, count in found) == [
        (3.0, 0.5), (4.0, 0.5), (4.0, 1.0), (6.0, 0.5), (8.0, 0.5), (8.0, 0.5), (9.0, 0.5),
    ]  # fmt: skip


def test_classes_hold_every_tug_once() -> None:
    peaks = [0.5, 1.0, 1.5, 7.0, 10.0]
    rows = by_size(peaks, 10.0)
    assert sum(count for *_, count, _ in rows) == len(peaks)
    assert next(above for *_, above in rows) == len(peaks)
    assert rows[-1][2] == 1, "the largest is in the last"
    counted = cycle_classes([(9.5, 5.0, 0.5), (10.0, 5.0, 1.0), (0.5, 1.0, 2.0)], 10.0)
    assert counted[-1][2:] == (1.5, 5.0)
    assert counted[0][2:] == (2.0, 1.0)
