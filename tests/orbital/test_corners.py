"""Few corners for a body of many: inside it, as near as told, all of them where they are few."""

import itertools
import math

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from orbital.corners import few_corners

CUBE = np.array(list(itertools.product((-1.0, 1.0), repeat=3)))


def ball(count):
    z = 1.0 - (2.0 * np.arange(count) + 1.0) / count
    turn = math.pi * (3.0 - math.sqrt(5.0)) * np.arange(count)
    return np.column_stack([np.sqrt(1.0 - z * z) * np.cos(turn), np.sqrt(1.0 - z * z) * np.sin(turn), z])


def test_a_cube_keeps_its_corners():
    corners, short = few_corners(np.vstack([CUBE, 0.5 * CUBE, np.zeros((1, 3))]), 32)
    assert short == 0.0
    assert sorted(map(tuple, corners)) == sorted(map(tuple, CUBE))


def test_a_ball_is_as_near_as_told():
    points = ball(800)
    corners, short = few_corners(points, 32)
    assert len(corners) == 32
    planes = ConvexHull(corners).equations
    assert short == pytest.approx((points @ planes[:, :3].T + planes[:, 3]).max(), rel=1e-12)
    # the flattest cap that a face of a hull of 32 corners on a ball can cut off is 1 - cos of a 60th of its surface's
    assert 0.04 < short < 0.16
    assert ConvexHull(corners).volume < ConvexHull(points).volume


def test_points_in_a_plane_have_none():
    with pytest.raises(ValueError, match="plane"):
        few_corners(ball(50) * [1.0, 1.0, 0.0], 32)
