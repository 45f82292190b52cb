"""What is wrong with the file of a mesh is called by its name, and the resolution that walls need is told at once."""

import math
import struct
from pathlib import Path

import numpy as np
import pytest

from fmu_src.interface import Undesigned
from fmu_src.net_capture.shapes import mesh, triangles

pytest.importorskip("trimesh")


def box(half, inward=False):
    """Triangles of a box (12, 3, 3) that face outward, or inward."""
    signs = [np.array([x, y, z], float) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
    found = []
    for axis in range(3):
        for side in (-1, 1):
            four = [corner for corner in signs if corner[axis] == side]
            four.sort(key=lambda c: math.atan2(c[(axis + 2) % 3], c[(axis + 1) % 3]), reverse=side < 0)
            a, b, c, d = (half * corner for corner in four)
            found += [(a, b, c), (a, c, d)]
    corners = np.array(found)
    return corners[:, ::-1] if inward else corners


def binary(path: Path, corners) -> Path:
    rows = b"".join(struct.pack("<12fH", 0, 0, 0, *corner.ravel(), 0) for corner in corners)
    path.write_bytes(b"\0" * 80 + struct.pack("<I", len(corners)) + rows)
    return path


def test_a_whole_one_is_read(tmp_path):
    corners = triangles.read(binary(tmp_path / "ok.stl", box(1.0)))
    assert triangles.volume(corners.reshape(-1, 3, 3)) == pytest.approx(8.0)


@pytest.mark.parametrize(("left", "there"), [(100, 0), (84 + 50 * 7 + 20, 7), (84 + 50 * 11, 11)])
def test_a_binary_file_that_is_cut_short(tmp_path, left, there):
    path = binary(tmp_path / "cut.stl", box(1.0))
    path.write_bytes(path.read_bytes()[:left])
    with pytest.raises(ValueError, match=f"is cut short: it says 12 triangles and holds {there}$"):
        triangles.read(path)


@pytest.mark.parametrize("seed", range(3))
def test_bytes_that_are_no_mesh_are_not_told_as_a_module_that_is_missing(tmp_path, seed):
    path = tmp_path / "junk.stl"
    path.write_bytes(np.random.default_rng(seed).integers(128, 256, 3000, dtype=np.uint8).tobytes())
    with pytest.raises(ValueError, match="cannot be read as a mesh") as error:
        triangles.read(path)
    assert "module" not in str(error.value)


def test_a_corner_that_is_no_number(tmp_path):
    corners = box(1.0)
    corners[4, 1, 2] = math.nan
    with pytest.raises(ValueError, match="triangle 5 has a corner that is no number"):
        triangles.read(binary(tmp_path / "nan.stl", corners))


@pytest.mark.parametrize("turned", [1, -1])
def test_triangles_that_stand_twice(tmp_path, turned):
    corners = box(1.0)
    with pytest.raises(ValueError, match=r"has triangle 4 twice, with the same corners \(2 such in all\)"):
        triangles.read(binary(tmp_path / "dup.stl", np.concatenate([corners, corners[3:5, ::turned]])))


@pytest.mark.parametrize("wall", [0.0025, 0.02])
def test_walls_tell_the_resolution_that_they_need(wall):
    """A hollow cube of 1 m: the wall by its construction, whatever the resolution that was tried."""
    hollow = np.concatenate([box(0.5), box(0.5 - wall, inward=True)])
    assert triangles.thickness(hollow, 0.05) == pytest.approx(wall, rel=1e-9)
    for cell in (0.1, 0.05):
        with pytest.raises(Undesigned) as error:
            mesh.lay({"target.mesh_unit": 1.0, "target.resolution": cell}, {"target.mesh": hollow.reshape(-1, 9)})
        assert f"walls of {wall:.3g} m; expected {wall / 2:.2g} m or less" in error.value.expected
        assert ("points, and at most" in error.value.expected) == (wall < 0.01)


def test_a_thick_body_is_as_thick_as_it_is():
    assert triangles.thickness(box(0.5), 0.05) == pytest.approx(1.0, rel=1e-9)


@pytest.mark.parametrize("reach", [0.03, 0.5, 1.5])
def test_bodies_that_run_into_one_another_are_told_with_the_place(reach):
    """As a file of an assembly has them: a finer grid would not help."""
    where = np.array([1.0 + 0.3 - reach, 0.1, 0.05])
    both = np.concatenate([box(1.0), 0.3 * box(1.0) + where])
    for unit in (1.0, 1e-3):
        with pytest.raises(Undesigned) as error:
            mesh.lay({"target.mesh_unit": unit, "target.resolution": 0.1}, {"target.mesh": both.reshape(-1, 9) / unit})
        assert error.value.name == "target.mesh"
        at = error.value.expected.partition("(")[2].partition(")")[0].split(",")
        place = unit * np.array([float(x) for x in at])
        assert (np.abs(place) <= 1.005).all()
        assert (np.abs(place - where) <= 0.305).all(), "within both"


def test_bodies_that_touch_face_to_face_and_hollow_ones_are_none_such():
    """Of other triangles, so that none stands twice; and a cavity, whose wall faces into it."""
    touching = np.concatenate([box(1.0), 0.5 * box(1.0) + np.array([1.5, 0.1, 0.05])])
    hollow = np.concatenate([box(1.0), box(0.5, inward=True)])
    for corners in (touching, hollow):
        cell = {"target.mesh_unit": 1.0, "target.resolution": 0.1}
        assert mesh.lay(cell, {"target.mesh": corners.reshape(-1, 9)}).tables
