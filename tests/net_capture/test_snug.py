"""A box's outline as seen along the shot, and who may have one."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from fmu_src.implied import formula
from fmu_src.net_capture.interface import MODEL
from fmu_src.net_capture.refusal import Scene
from fmu_src.net_capture.snug import outline

HALF = np.array([12.5, 2.5, 5.0])
CORNERS = np.array(np.meshgrid(*zip(-HALF, HALF, strict=True))).reshape(3, 8).T


def told(turn, axis):
    """By the kernel, for a box turned so, seen along an axis."""
    axes = np.zeros(9)
    axes[6:] = axis
    pose = turn.as_quat(scalar_first=True)
    p = SimpleNamespace(axes=axes, target_pose=pose, half_size=HALF, snug_axis=np.zeros(3), snug_outline=0.0)
    return formula(outline)(p)


@pytest.mark.parametrize("seed", range(5))
def test_it_is_the_perimeter_of_the_hull_of_its_corners(seed):
    draw = np.random.default_rng(seed)
    turn = Rotation.random(random_state=seed)
    axis = draw.normal(size=3)
    axis /= np.linalg.norm(axis)
    across = np.linalg.svd(axis[None, :])[2][1:]
    seen = ConvexHull(turn.apply(CORNERS) @ across.T)
    assert told(turn, axis) == pytest.approx(seen.area, rel=1e-12)  # scipy's area of a plane hull is its perimeter


def test_along_an_edge_it_goes_round_the_other_two():
    assert told(Rotation.identity(), (0.0, 1.0, 0.0)) == pytest.approx(2.0 * (25.0 + 10.0), abs=1e-12)
    assert told(Rotation.identity(), (1.0, 0.0, 0.0)) == pytest.approx(2.0 * (5.0 + 10.0), abs=1e-12)


def test_only_a_box_has_one():
    part = MODEL.groups["snug"].terms["plain"]
    refused = part.refuses(Scene({"target": "cylinder"}, {}, 1.0, {}))
    assert [r.name for r in refused] == ["target.shape"]
    assert not list(part.refuses(Scene({"target": "box"}, {}, 1.0, {})))
    with pytest.raises(ValueError, match="cylinder is not known"):
        part.make(SimpleNamespace(terms={"target": "cylinder"}))
