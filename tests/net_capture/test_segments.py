"""Closest points of two threads against bounded least squares, and passes against the roots of the volume's cubic."""

import numpy as np
import pytest
from scipy.optimize import lsq_linear

from fmu_src.net_capture.self_contact.segments import closest, passes, volume
from tests.plain import plainly

CLOSEST, PASSES, VOLUME = map(plainly, (closest, passes, volume))


def independent(u, v, w):
    """Least distance by bounded least squares, of |s u - t v + w|."""
    found = lsq_linear(np.column_stack([u, -v]), -w, (0.0, 1.0), method="bvls", tol=1e-15)
    return np.linalg.norm(w + found.x[0] * u - found.x[1] * v)


def check(u, v, w, rel=1e-9):
    s, t, squared = CLOSEST(*u, *v, *w)
    assert 0.0 <= s <= 1.0
    assert 0.0 <= t <= 1.0
    assert np.linalg.norm(w + s * u - t * v) == pytest.approx(np.sqrt(squared), rel=1e-12, abs=1e-15)
    assert np.sqrt(squared) == pytest.approx(independent(u, v, w), rel=rel, abs=1e-12)
    return s, t


def test_closest_points_of_any_two():
    """Of 600 pairs some are nearest inside, some at one end, some at two: all three kinds are among them."""
    rng = np.random.default_rng(1)
    kinds = set()
    for _ in range(600):
        u, v, w = rng.normal(size=(3, 3)) * rng.choice([0.01, 1.0, 1.0, 3.0], (3, 1))
        s, t = check(u, v, w)
        kinds.add(int(0.0 < s < 1.0) + int(0.0 < t < 1.0))
    assert kinds == {0, 1, 2}


def test_closest_points_of_threads_that_are_parallel_or_nearly_so():
    rng = np.random.default_rng(2)
    for turned in (0.0, 1e-14, 1e-9, 1e-7, 1e-5, 1e-3):
        for _ in range(40):
            u, aside = rng.normal(size=(2, 3))
            v = rng.choice([-1.0, 0.3, 2.0]) * u + turned * aside
            check(u, v, rng.normal(size=3))


def test_closest_points_end_to_end_and_of_no_length():
    one = np.array([1.0, 0.0, 0.0])
    none = np.zeros(3)
    # in one line, an end 0.5 m before the other's
    assert CLOSEST(*one, *one, -1.5, 0.0, 0.0) == (1.0, 0.0, 0.25)
    # both begin at one spot
    assert CLOSEST(*one, 0.0, 1.0, 0.0, *none) == (0.0, 0.0, 0.0)
    # a T: an end on the other's middle
    assert CLOSEST(*one, 0.0, 1.0, 0.0, -0.25, 0.0, 0.0) == (0.25, 0.0, 0.0)
    # one is a point, or both are
    assert CLOSEST(*one, *none, -0.25, 0.0, 2.0) == (0.25, 0.0, 4.0)
    assert CLOSEST(*none, *one, 0.25, 0.0, 2.0) == (0.0, 0.25, 4.0)
    assert CLOSEST(*none, *none, 0.0, 3.0, 4.0)[2] == 25.0


def met(before, now):
    """How often two threads pass within a straight motion, by the roots of the cubic of their volume."""

    def at(time):
        return (1.0 - time) * before + time * now

    times = np.arange(4.0)
    cubic = np.polyfit(times, [VOLUME(*at(time).ravel()) for time in times], 3)
    found, roots = 0, 0
    for root in np.roots(cubic):
        if abs(root.imag) < 1e-9 and 0.0 < root.real < 1.0:
            roots += 1
            u, v, w = at(root.real)
            shares, *_ = np.linalg.lstsq(np.column_stack([u, -v]), -w, rcond=None)
            apart = np.linalg.norm(w + shares[0] * u - shares[1] * v)
            found += apart < 1e-6 and bool(((shares >= 0.0) & (shares <= 1.0)).all())
    return found, roots


def test_passes_of_any_two():
    """Motions in which the volume vanishes once, which are those of a substep."""
    rng = np.random.default_rng(3)
    counted = [0, 0]
    beside = 0
    while min(counted) < 60:
        before = rng.normal(size=(3, 3))
        now = before + rng.normal(size=(3, 3)) * np.array([[0.3], [0.3], [1.5]])
        expected, roots = met(before, now)
        if roots <= 1:
            assert PASSES(*now.ravel(), *(now - before).ravel()) == expected
            counted[expected] += 1
            beside += roots == 1 and expected == 0
    assert beside > 10, "lines that crossed beyond the ends of a thread, which is no pass"


def test_passes_of_threads_that_stay_parallel():
    """They have no volume: sideways through each other is a pass, past an end or up to each other is none."""
    u = np.array([1.0, 0.0, 0.0])

    def pair(height, along=0.0, lift=0.0):
        return np.array([u, u, [along, height, lift]])

    for start, end, expected in (
        (pair(0.1), pair(-0.1), 1),
        (pair(0.1), pair(0.05), 0),
        (pair(0.1, 1.2), pair(-0.1, 1.2), 0),
        (pair(0.1, lift=0.5), pair(-0.1, lift=0.5), 0),
    ):
        assert PASSES(*end.ravel(), *(end - start).ravel()) == expected


@pytest.mark.parametrize("lift", [0.05, 1e-3])
def test_threads_that_turn_past_parallel_do_not_pass(lift):
    """Their volume vanishes there, with the lines apart: one turns about its end, or about its middle."""
    u = np.array([1.0, 0.0, 0.0])
    for first in (0.0, 0.5):
        shapes = [np.array([u, [1.0, tilt, 0.0], [0.2, first * tilt, lift]]) for tilt in (0.1, -0.07)]
        before, now = shapes
        assert VOLUME(*before.ravel()) * VOLUME(*now.ravel()) < 0.0
        assert PASSES(*now.ravel(), *(now - before).ravel()) == 0
