"""Points by case number: the same whoever asks, and as each sampler promises."""

from __future__ import annotations

from itertools import islice

import numpy as np

from dcone_cosim.campaign import sampling


def test_a_case_hangs_on_its_number_alone() -> None:
    one = [sampling.monte_carlo(3, number, 4) for number in (5, 1, 9)]
    assert np.array_equal(one[0], sampling.monte_carlo(3, 5, 4))
    assert len({tuple(point) for point in one}) == 3
    assert not np.array_equal(sampling.monte_carlo(4, 5, 4), one[0])


def test_independent_cases_are_uniform() -> None:
    points = np.array([sampling.monte_carlo(1, number, 3) for number in range(1, 2001)])
    counts = np.array([np.histogram(column, 10, (0.0, 1.0))[0] for column in points.T])
    assert ((counts - 200) ** 2 / 200).sum(axis=1).max() < 27.9, "chi2 of 9 degrees, 1 in 1000"
    assert np.abs(np.corrcoef(points.T) - np.eye(3)).max() < 0.07


def test_hypercube_has_one_in_each_part() -> None:
    points = sampling.hypercube(2, 50, 3)
    assert all(sorted((50 * column).astype(int)) == list(range(50)) for column in points.T)
    assert np.array_equal(points, sampling.hypercube(2, 50, 3))


def test_sobol_goes_on_as_it_began() -> None:
    whole = list(islice(sampling.sobol(2, 3), 3000))
    assert np.array_equal(whole[:10], list(islice(sampling.sobol(2, 3), 10)))
    first = np.array(whole[:1024])
    assert all(sorted((1024 * column).astype(int)) == list(range(1024)) for column in first.T), "a (0, 10, 1)-net"


def test_saltelli_changes_one_coordinate_at_a_time() -> None:
    points = np.array(list(sampling.saltelli(1, 5, 3))).reshape(5, 5, 3)
    for a, *mixed, b in points:
        assert not (a == b).any()
        for place, row in enumerate(mixed):
            assert [row[i] == (b if i == place else a)[i] for i in range(3)] == [True] * 3


def test_grid_and_ends() -> None:
    points = list(sampling.grid([(0.0, 1.0), (0.25, 0.5, 0.75)]))
    assert len(points) == 6
    assert (points[0][0], points[5][0]) == (sampling.LEAST, 1.0 - sampling.LEAST)
    assert [point[1] for point in points] == [0.25, 0.5, 0.75] * 2
