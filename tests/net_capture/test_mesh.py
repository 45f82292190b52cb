"""A closed mesh as a target: distances on a grid against the shape it was made of, inertia against another library,
what is refused; the same catch as of the analytic box, in the mean of a stored ensemble."""

import json

import numpy as np
import pytest
import trimesh
from scipy.spatial.transform import Rotation

from fmu_src.implied import formula
from fmu_src.interface import Undesigned
from fmu_src.net_capture.shapes import mesh, solids, triangles
from fmu_src.net_capture.shapes.box import box_distance
from tests.net_capture.evidence import mesh_box, mesh_first

SIZE = np.array([2.0, 3.0, 1.5])


def saved(tmp_path, made, name="target.stl"):
    path = tmp_path / name
    made.export(path)
    return path


def lay(path, cell=0.1, unit=1.0):
    return mesh.lay({"target.mesh_unit": unit, "target.resolution": cell}, {mesh.MESH: triangles.read(path)})


def distances(tables, points):
    normals = np.zeros((len(points), 3))
    grid, lattice = tables[mesh.GRID], tables[mesh.LATTICE]
    kernel = formula(mesh.grid_distance)
    return np.array([kernel(grid, lattice, n, p) for n, p in zip(normals, points, strict=True)]), normals


@pytest.mark.parametrize("cell", [0.2, 0.1])
def test_a_box_on_a_grid_is_the_box_within_the_error_told(tmp_path, cell):
    tables = lay(saved(tmp_path, trimesh.creation.box(extents=SIZE)), cell).tables
    error = tables[mesh.LATTICE][4]
    assert 0.2 * cell < error < 0.8 * cell
    points = np.random.default_rng(1).uniform(-1.0, 1.0, (600, 3)) * SIZE
    found, normals = distances(tables, points)
    expected = np.array([box_distance.py_func(np.zeros(3), point, SIZE / 2) for point in points])
    assert np.linalg.norm(normals, axis=1) == pytest.approx(1.0, abs=1e-12)
    near = np.abs(expected) < 0.3
    assert np.abs(found - expected)[near].max() < error + 0.05 * cell
    assert np.abs(found - expected)[near].mean() < 0.1 * cell
    assert np.abs(found - expected).max() < 2.0 * cell
    # before a face it is exact, and so is the way out
    flat, ways = distances(tables, [[0.3, 0.2, 0.75 + 0.13], [-1.0 + 0.07, 0.4, 0.1], [0.1, 1.9, -0.2]])
    np.testing.assert_allclose(flat, [0.13, -0.07, 0.4], atol=1e-6)
    np.testing.assert_allclose(ways, [[0, 0, 1], [-1, 0, 0], [0, 1, 0]], atol=1e-6)


@pytest.mark.parametrize(("cell", "sharp"), [(0.2, False), (0.14, False), (0.1, True)])
def test_corners_are_as_far_in_as_is_told(tmp_path, cell, sharp):
    """Of a box, found by trying points within it; none where the grid's planes lie in its faces."""
    tables = lay(saved(tmp_path, trimesh.creation.box(extents=SIZE)), cell).tables
    grid, lattice = tables[mesh.GRID], tables[mesh.LATTICE]
    steps = np.linspace(0.0, 0.8 * cell, 41)
    inward = np.stack(np.meshgrid(steps, steps, steps), axis=-1).reshape(-1, 3)
    some = SIZE / 2 - inward[::7000]
    np.testing.assert_allclose(mesh.between(grid, lattice, some), distances(tables, some)[0], atol=1e-12)
    farthest = 0.0
    for corner in np.stack(np.meshgrid(*[[-1.0, 1.0]] * 3), axis=-1).reshape(-1, 3):
        within = mesh.between(grid, lattice, corner * (SIZE / 2 - inward)) < 0.0
        farthest = max(farthest, np.linalg.norm(inward[within], axis=1).min())
    if sharp:
        assert farthest < 0.06 * cell
    else:
        assert farthest > 0.45 * cell, "more than in the middle of any cell, 0.375"
        assert lattice[4] == pytest.approx(farthest, rel=0.1)


def test_inertia_and_body_axes_are_those_of_another_library(tmp_path):
    """Of a wedge that stands askew and away from the origin, in millimetres."""
    askew = trimesh.transformations.compose_matrix(angles=[0.4, 0.2, -0.3], translate=[4.0, -3.0, 2.0], scale=None)
    made = trimesh.creation.cone(radius=0.8, height=2.0, sections=24)
    made.apply_transform(askew)
    made.apply_scale(1000.0)
    solid = lay(saved(tmp_path, made, "cone.obj"), unit=1e-3).tables["target.solid"]
    made.apply_scale(1e-3)
    np.testing.assert_allclose(solid[solids.CENTER : solids.HALF], made.center_mass, atol=1e-6)
    turn = Rotation.from_quat(solid[solids.TURN : solids.CENTER], scalar_first=True).as_matrix()
    np.testing.assert_allclose(turn @ np.diag(solid[:3]) @ turn.T, made.moment_inertia / made.mass, atol=1e-6)
    assert np.abs(made.moment_inertia[0, 1]) > 0.004 * made.moment_inertia[0, 0]


def test_a_ball_rounds_nothing_and_its_samples_are_deep(tmp_path):
    tables = lay(saved(tmp_path, trimesh.creation.icosphere(subdivisions=3, radius=1.2)), 0.1).tables
    assert tables[mesh.LATTICE][4] < 0.01
    places = tables["target.samples"]
    assert np.linalg.norm(places[1:, :3], axis=1) == pytest.approx(1.2, abs=0.03)
    assert np.linalg.norm(places[:, 3:], axis=1).max() < 0.25
    assert tables["target.solid"][solids.GIRTH] == pytest.approx(2.0 * np.pi * 1.2, rel=0.01)
    assert tables["target.solid"][solids.THICKNESS] == pytest.approx(2.4, abs=0.15)


def holed(made):
    return trimesh.Trimesh(made.vertices, made.faces[1:], process=False)


def turned(made):
    faces = made.faces.copy()
    faces[3] = faces[3][::-1]
    return trimesh.Trimesh(made.vertices, faces, process=False)


def inward(made):
    return trimesh.Trimesh(made.vertices, made.faces[:, ::-1], process=False)


def flat(made):
    """A corner lies on the edge between two others."""
    vertices = np.array([[0.0, 0, 0], [2.0, 0, 0], [1.0, 0, 0], [0.0, 1, 0], [0.0, 0, 1]])
    faces = [[0, 2, 1], [0, 1, 4], [0, 3, 2], [2, 3, 1], [0, 4, 3], [1, 3, 4], [0, 1, 2]]
    return trimesh.Trimesh(vertices, faces, process=False)


@pytest.mark.parametrize(
    ("harm", "text"),
    [
        (holed, "is not closed: 3 edges belong to one triangle alone, 0 to more than two"),
        (turned, "face opposite ways"),
        (inward, "face inward"),
        (flat, r"triangle 1 of 7 has no area \(2 such in all\)"),
    ],
)
def test_a_mesh_that_is_no_body_is_told(tmp_path, harm, text):
    made = trimesh.creation.box(extents=SIZE)
    with pytest.raises(ValueError, match=text):
        triangles.read(saved(tmp_path, harm(made), "bad.obj"))


def test_files_that_are_no_meshes_are_told(tmp_path):
    (tmp_path / "a.stl").write_text("solid nothing\nendsolid nothing\n")
    (tmp_path / "a.obj").write_text("hello\n")
    (tmp_path / "a.ply").write_text("ply\n")
    for name, text in (("a.stl", "triangles|mesh"), ("a.obj", "triangles|mesh"), ("a.ply", "is no .stl or .obj file")):
        with pytest.raises(ValueError, match=text):
            triangles.read(tmp_path / name)
    with pytest.raises(OSError, match="missing"):
        triangles.read(tmp_path / "missing.stl")


@pytest.mark.parametrize(
    ("cell", "unit", "name", "text"),
    [
        (0.1, 1000.0, "target.mesh_unit", "makes the target 3e\\+03 m long"),
        (0.1, 1e-3, "target.mesh_unit", "makes the target 0.003 m long"),
        (0.005, 1.0, "target.resolution", "points; expected 0.0[0-9]* m or more"),
        (1.0, 1.0, "target.resolution", "is too coarse for walls of"),
    ],
)
def test_units_and_grids_that_cannot_be_meant_are_told(tmp_path, cell, unit, name, text):
    path = saved(tmp_path, trimesh.creation.box(extents=SIZE))
    with pytest.raises(Undesigned, match=text) as refused:
        lay(path, cell, unit)
    assert refused.value.name == name


def test_the_stored_ensembles_agree():
    """The same catch of a box by its closed form and as a mesh."""
    told = json.loads(mesh_box.RESULT.read_text())
    assert told["command"] == mesh_box.COMMAND
    assert mesh_box.summarise(told["rows"]) == told["summary"]
    quality, held = told["summary"]["quality"], told["summary"]["held"]
    assert abs(quality["apart"]) < mesh_box.QUALITY_WITHIN
    assert abs(held["apart"]) < mesh_box.IMPULSE_WITHIN
    assert held["error"] < 0.5 * mesh_box.IMPULSE_WITHIN
    assert told["summary"]["shots"] == len(told["rows"]) >= 16
    assert all(row[kind]["captured"] > 0.0 and row[kind]["momentum"] < 1e-11 for row in told["rows"] for kind in row)


def test_the_first_second_of_contact_has_the_same_impulse():
    """Start by start within 2 %, as long as the folds are those of one flight; their mean within 0.5 %."""
    told = json.loads(mesh_first.RESULT.read_text())
    assert (told["command"], len(told["rows"])) == (mesh_first.COMMAND, mesh_first.SHOTS)
    assert all(row["mesh"]["touch"] == row["box"]["touch"] for row in told["rows"])
    impulses = {kind: np.array([row[kind]["impulse"] for row in told["rows"]]) for kind in ("box", "mesh")}
    ratio = impulses["mesh"] / impulses["box"]
    assert np.abs(ratio - 1.0).max() < 0.02
    np.testing.assert_allclose(ratio.mean(axis=0), 1.0, atol=0.005)
    assert np.abs(np.roll(impulses["mesh"], 1, axis=0) / impulses["box"] - 1.0).max() > 0.02, "the twin: other starts"
    speeds = {kind: np.array([row[kind]["speed"] for row in told["rows"]]) for kind in ("box", "mesh")}
    np.testing.assert_allclose(speeds["mesh"], speeds["box"], rtol=0.02)


@pytest.mark.evidence
def test_a_start_touches_as_it_is_stored():
    stored = json.loads(mesh_first.RESULT.read_text())["rows"][0]
    tables = mesh_box.laid()
    assert {kind: mesh_first.first(kind, 0, tables) for kind in ("box", "mesh")} == stored
