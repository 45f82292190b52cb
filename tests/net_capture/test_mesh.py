"""A closed mesh as a target: distances on a grid against the shape it was made of, inertia against another library,
what is refused; the same catch as of the analytic box, in the mean of a stored ensemble."""

import json
from pathlib import Path

import numpy as np
import pytest
import trimesh
from scipy.spatial.transform import Rotation

import fmu_src.net_capture
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
def test_a_box_on_a_grid_is_the_box_within_a_share_of_a_cell(tmp_path, cell):
    tables = lay(saved(tmp_path, trimesh.creation.box(extents=SIZE)), cell).tables
    assert tables[mesh.LATTICE][mesh.ERROR] < 1e-6, "its surface is that of the box"
    points = np.random.default_rng(1).uniform(-1.0, 1.0, (600, 3)) * SIZE
    found, normals = distances(tables, points)
    expected = np.array([box_distance.py_func(np.zeros(3), point, SIZE / 2) for point in points])
    assert np.linalg.norm(normals, axis=1) == pytest.approx(1.0, abs=1e-12)
    near = np.abs(expected) < 0.3
    assert np.abs(found - expected)[near].max() < 0.4 * cell
    assert np.abs(found - expected)[near].mean() < 0.1 * cell
    assert np.abs(found - expected).max() < 2.0 * cell
    # before a face it is exact, and so is the way out
    flat, ways = distances(tables, [[0.3, 0.2, 0.75 + 0.13], [-1.0 + 0.07, 0.4, 0.1], [0.1, 1.9, -0.2], [0.1, 0, 1.3]])
    np.testing.assert_allclose(flat, [0.13, -0.07, 0.4, 0.55], atol=1e-6)
    np.testing.assert_allclose(ways, [[0, 0, 1], [-1, 0, 0], [0, 1, 0], [0, 0, 1]], atol=1e-6)


def farthest_in(laid, corners):
    """How far the grid's surface is from the farthest of these corners (n, 3) [m], by points about them."""
    grid, lattice = laid.tables[mesh.GRID], laid.tables[mesh.LATTICE]
    steps = 1.2 * lattice[3] * np.linspace(-1.0, 1.0, 51)
    about = np.stack(np.meshgrid(steps, steps, steps), axis=-1).reshape(-1, 3)
    ways = np.linalg.norm(about, axis=1)
    return max(ways[mesh.between(grid, lattice, corner + about) <= 1e-9].min() for corner in corners)


def eight_sided():
    return trimesh.creation.cylinder(radius=1.1, height=1.7, sections=8)


def double_pyramid():
    corners = np.array([[1.0, 0, 0], [0, 1.3, 0], [-1.0, 0, 0], [0, -1.3, 0], [0, 0, 0.8], [0, 0, -0.8]])
    sides = [(0, 1), (1, 2), (2, 3), (3, 0)]
    return trimesh.Trimesh(corners, [[a, b, 4] for a, b in sides] + [[b, a, 5] for a, b in sides])


@pytest.mark.parametrize("cell", [0.2, 0.14, 0.1])
def test_edges_of_a_box_are_sharp_on_every_grid(tmp_path, cell):
    """Its faces lie in the grid's planes; those of a prism of eight sides do not all."""
    laid = lay(saved(tmp_path, trimesh.creation.box(extents=SIZE)), cell)
    edges = laid.tables[mesh.LATTICE][3:6]
    np.testing.assert_allclose(SIZE / edges, np.ceil(SIZE / cell - 1e-6), rtol=1e-9)
    assert farthest_in(laid, laid.shown[mesh.FACES].reshape(-1, 3)[:6]) < 1e-6
    other = lay(saved(tmp_path, eight_sided()), cell)
    assert farthest_in(other, other.shown[mesh.FACES].reshape(-1, 3)[:12]) > 0.2 * cell


@pytest.mark.parametrize("cell", [0.2, 0.13, 0.1])
def test_corners_are_as_far_in_as_is_told(tmp_path, cell):
    laid = lay(saved(tmp_path, eight_sided()), cell)
    corners = np.unique(np.round(laid.shown[mesh.FACES].reshape(-1, 3), 9), axis=0)
    assert laid.tables[mesh.LATTICE][mesh.ERROR] == pytest.approx(farthest_in(laid, corners), rel=0.15)


def test_slanted_faces_are_exact_with_cells_of_three_edges(tmp_path):
    """Distance and way out, beside the middles of the faces of a double pyramid of three lengths."""
    laid = lay(saved(tmp_path, double_pyramid()), 0.15)
    assert len(set(np.round(laid.tables[mesh.LATTICE][3:6], 6))) == 3
    corners = laid.shown[mesh.FACES].reshape(-1, 3, 3)
    out = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    out /= np.linalg.norm(out, axis=1, keepdims=True)
    for beside in (0.02, -0.02):
        found, ways = distances(laid.tables, corners.mean(axis=1) + beside * out)
        np.testing.assert_allclose(found, beside, atol=1e-6)
        np.testing.assert_allclose(ways, out, atol=1e-6)


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
    assert tables[mesh.LATTICE][mesh.ERROR] < 0.01
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
        (1e9, 1.0, "target.resolution", "is too coarse for walls of"),
    ],
)
def test_units_and_grids_that_cannot_be_meant_are_told(tmp_path, cell, unit, name, text):
    path = saved(tmp_path, trimesh.creation.box(extents=SIZE))
    with pytest.raises(Undesigned, match=text) as refused:
        lay(path, cell, unit)
    assert refused.value.name == name


def test_the_stored_ensembles_agree():
    """The same catch of a box by its closed form and as a mesh, on a grid of 5 and of 7 cm."""
    told = json.loads(mesh_box.RESULT.read_text())
    assert told["command"] == mesh_box.COMMAND
    assert mesh_box.summarise(told["rows"]) == told["summary"]
    assert told["summary"]["shots"] == len(told["rows"]) >= mesh_box.STARTS
    for kind in mesh_box.CELLS:
        quality, impulse, held, sizes = (told["summary"][n][kind] for n in ("quality", "impulse", "held", "sizes"))
        assert abs(quality["apart"]) < mesh_box.QUALITY_WITHIN
        assert abs(impulse["apart"]) < mesh_box.IMPULSE_WITHIN
        assert abs(held["apart"]) < mesh_box.IMPULSE_WITHIN
        assert abs(sizes["apart"]) < 3.0 * sizes["error"]
        assert quality["error"] < 0.2 * mesh_box.QUALITY_WITHIN
        assert max(impulse["error"], held["error"], 0.5 * sizes["error"]) < 0.5 * mesh_box.IMPULSE_WITHIN
    assert all(row[kind]["captured"] > 0.0 and row[kind]["momentum"] < 1e-11 for row in told["rows"] for kind in row)
    lines = mesh_box.lines(told["rows"], json.loads(mesh_box.BEFORE.read_text())["rows"])
    page = Path(f"{fmu_src.net_capture.__path__[0]}/README.md").read_text().splitlines()
    at = page.index(lines[0])
    assert page[at : at + len(lines)] == lines


def test_a_grid_that_rounds_edges_is_told_apart():
    """The twin: of the same starts, before the grid's planes lay in the faces of the box."""
    told = json.loads(mesh_box.RESULT.read_text())
    before = json.loads(mesh_box.BEFORE.read_text())
    rows = [{"box": row["box"], **other} for row, other in zip(told["rows"], before["rows"], strict=True)]
    quality = mesh_box.summarise(rows)["quality"]["rounded"]
    assert quality["apart"] > 4.0 * quality["error"]
    first = zip(json.loads(mesh_first.RESULT.read_text())["rows"], before["first"], strict=True)
    ratios = np.array([np.divide(old["rounded"]["impulse"], row["box"]["impulse"]) for row, old in first])
    assert np.abs(ratios - 1.0).max() > 0.1


def test_the_first_second_of_contact_has_the_same_impulse():
    """Start by start within 2 %, as long as the folds are those of one flight; their mean within 0.5 %."""
    told = json.loads(mesh_first.RESULT.read_text())
    assert (told["command"], len(told["rows"])) == (mesh_first.COMMAND, mesh_first.SHOTS)
    impulses = {kind: np.array([row[kind]["impulse"] for row in told["rows"]]) for kind in mesh_box.KINDS}
    speeds = {kind: np.array([row[kind]["speed"] for row in told["rows"]]) for kind in mesh_box.KINDS}
    for kind in mesh_box.CELLS:
        assert all(row[kind]["touch"] == row["box"]["touch"] for row in told["rows"])
        ratio = impulses[kind] / impulses["box"]
        assert np.abs(ratio - 1.0).max() < 0.02
        np.testing.assert_allclose(ratio.mean(axis=0), 1.0, atol=0.005)
        assert np.abs(np.roll(impulses[kind], 1, axis=0) / impulses["box"] - 1.0).max() > 0.02, "the twin: other starts"
        np.testing.assert_allclose(speeds[kind], speeds["box"], rtol=0.02)


@pytest.mark.evidence
def test_a_start_touches_as_it_is_stored():
    stored = json.loads(mesh_first.RESULT.read_text())["rows"][0]
    assert {kind: mesh_first.first(kind, 0, mesh_box.laid(kind)) for kind in mesh_box.KINDS} == stored
