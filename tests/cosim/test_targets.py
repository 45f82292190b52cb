"""Targets of every shape in a scene: unions entry by entry, meshes from files, what they are told of, and what they are
towed as."""

import json
import re

import jsonschema
import numpy as np
import pytest
import trimesh
from scipy.spatial import ConvexHull

from dcone_cosim import build
from dcone_cosim.loading import find, load
from dcone_cosim.scene.mistakes import SceneError
from dcone_cosim.scenes.new import new_scene
from dcone_cosim.scenes.reading import parse
from dcone_cosim.scenes.schema import schema

STAGE = find("upper-stage").read_text(encoding="utf-8")

NOZZLE = next(line for line in STAGE.splitlines() if line.startswith("[[capture.target.parts]] # the nozzle"))
UPPER_DOME = "[[capture.target.parts]] # its upper dome"


def changed(*changes):
    text = STAGE
    for old, new in changes:
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    return text


def test_a_union_weighs_what_its_pieces_do():
    main = load("upper-stage").phases[0].main
    assert main.values["target.mass"] == 1350.0
    assert set(main.numbers) == {"target.pieces", "target.solid", "target.samples"}
    assert main.values["target.solid"][9] == pytest.approx((150.0 * 2.2 - 200.0 * 2.2 - 200.0 * 4.0) / 1350.0, abs=0.02)


@pytest.mark.parametrize(
    ("change", "line", "text"),
    [
        (('radius_top = "0.25 m"', 'radius_topp = "0.25 m"'), 'radius_topp = "0.25 m"', "did you mean 'radius_top'"),
        (('radius_top = "0.25 m"', 'radius_top = "0.25 kg"'), 'radius_top = "0.25 kg"', "is a mass"),
        (('radius_top = "0.25 m"\n', ""), NOZZLE, "parts[4] = a table: piece 4, a frustum, lacks its radius_top"),
        (('mass = "150 kg"', 'mass = "150 kg"\ndensity = "9 kg/m3"'), UPPER_DOME, "has both mass and density"),
        (('shape = "frustum"', 'shape = "cone"'), 'shape = "cone"', "expected one of box, cylinder, sphere"),
        (('shape = "union"', 'shape = "union"\nmass = "3 kg"'), 'mass = "3 kg"', "follows from what this scene asks"),
    ],
    ids=str,
)  # fmt: skip
def test_what_is_wrong_with_a_piece_is_told_on_its_line(change, line, text):
    scene = changed(change)
    number = scene.splitlines().index(line) + 1
    with pytest.raises(SceneError) as told:
        parse(scene, "mine", "mine.toml")
    assert f"line {number}: capture.target." in str(told.value)
    assert text in str(told.value)


def test_a_union_without_pieces_is_told():
    start, end = STAGE.index("[[capture.target.parts]] # the tank"), STAGE.index("[capture.contact]")
    with pytest.raises(SceneError, match=r"expected one or more tables \[\[capture.target.parts\]\]"):
        parse(STAGE[:start] + STAGE[end:], "mine", "mine.toml")


def test_a_scene_begun_from_a_union_is_the_same():
    again = parse(new_scene(STAGE, "upper-stage", "mine.toml"), "mine", "mine.toml")
    first = load("upper-stage").phases[0].main
    for name, numbers in first.numbers.items():
        np.testing.assert_array_equal(again.phases[0].main.numbers[name], numbers)
    assert again.phases[0].main.parameters == first.parameters


def test_the_schema_knows_pieces():
    import tomllib

    told = json.loads(json.dumps(schema()))
    jsonschema.validate(tomllib.loads(STAGE), told)
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate(tomllib.loads(changed(('shape = "frustum"', 'shape = "cone"'))), told)


def with_mesh(more=""):
    start, end = STAGE.index("[capture.target]"), STAGE.index("[capture.contact]")
    target = f'[capture.target]\nshape = "mesh"\nmesh = "stage.stl"\nmass = "900 kg"\n{more}\n'
    return STAGE[:start] + target + STAGE[end:]


def test_a_mesh_is_read_from_its_file(tmp_path):
    trimesh.creation.box(extents=[2.0, 3.0, 1.5]).export(tmp_path / "stage.stl")
    scene = parse(with_mesh('resolution = "20 cm"'), "mine", "mine.toml", tmp_path)
    main = scene.phases[0].main
    assert set(main.numbers) == {"target.grid", "target.lattice", "target.solid", "target.samples"}
    assert main.values["target.mass"] == 900.0
    assert f'mesh = "{tmp_path / "stage.stl"}"' in scene.text
    told = {row.key: row.value for row in build.implied("net_capture", {**main.values, **main.asked}, main.terms)}
    assert told["target.girth"] == pytest.approx(2.0 * (2.0 + 1.5), rel=1e-6)
    assert told["target.grid_cell"] == pytest.approx(0.2)
    assert told["target.grid_error"] < 1e-6, "the faces of a box lie in the grid's planes"
    assert told["target.inertia_1"] == pytest.approx(900.0 * (9.0 + 2.25) / 12.0, rel=1e-6)


def test_what_is_wrong_with_a_mesh_names_file_and_fault(tmp_path):
    made = trimesh.creation.box(extents=[2.0, 3.0, 1.5])
    trimesh.Trimesh(made.vertices, made.faces[:-1], process=False).export(tmp_path / "stage.stl")
    with pytest.raises(SceneError, match=r"stage.stl: is not closed: 3 edges") as told:
        parse(with_mesh(), "mine", "mine.toml", tmp_path)
    assert "capture.target.mesh" in str(told.value)
    made.export(tmp_path / "stage.stl")
    with pytest.raises(SceneError, match=r"target.mesh_unit = .*makes the target 3e-05 m long"):
        parse(with_mesh('mesh_unit = "10 um"'), "mine", "mine.toml", tmp_path)
    with pytest.raises(SceneError, match=r"target.resolution = .*too coarse for walls"):
        parse(with_mesh('resolution = "1 m"'), "mine", "mine.toml", tmp_path)


@pytest.mark.parametrize(
    ("term", "values", "short"),
    [
        ("sphere", {"target.radius": 1.0}, (0.04, 0.16)),
        ("frustum", {"target.radius_bottom": 1.0, "target.radius_top": 0.5, "target.length": 2.0}, (0.0, 0.05)),
    ],
)
def test_what_has_no_surface_of_its_own_in_a_tow_is_a_hull(term, values, short):
    assert build.towed_surface(term) == "hull"
    corners, beyond = build.hull_corners(values, {"target": term})
    points = np.array([[corners[f"target.corner_{axis}[{k}]"] for axis in "xyz"] for k in range(1, 33)])
    surface = np.array(build.target_surface(values, {"target": term})[0])
    planes = ConvexHull(points).equations
    assert (surface @ planes[:, :3].T + planes[:, 3]).max() == pytest.approx(beyond, abs=1e-12)
    assert short[0] <= beyond < short[1]


def test_boxes_and_cylinders_keep_their_own():
    assert build.towed_surface("box") == "box"
    assert build.hull_corners({"target.radius": 1.0, "target.length": 2.0}, {"target": "cylinder"}) == ({}, 0.0)
    assert re.fullmatch("hull", build.towed_surface("union"))
