"""Unions of pieces: distance, inertia, girth and sample points against dense points, meshes and closed forms; one that
tumbles with products of inertia, and is caught with all momenta kept."""

import math

import numpy as np
import pytest
import trimesh
from scipy.integrate import solve_ivp
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from fmu_src.implied import formula
from fmu_src.instance import Instance
from fmu_src.net_capture.interface import MODEL, OUTCOMES
from fmu_src.net_capture.shapes import pieces, solids, union
from fmu_src.net_capture.shapes.shell import shell_center, shell_distance
from tests.conftest import CAPTURE

BOX, CYLINDER, SPHERE, FRUSTUM, SHELL = range(5)
QUARTER = [math.cos(math.pi / 4), 0.0, math.sin(math.pi / 4), 0.0]
STAGE = [
    {"shape": CYLINDER, "radius": 1.2, "length": 4.0, "mass": 800.0},
    {"shape": SPHERE, "radius": 1.2, "mass": 150.0, "position": [0.0, 0.0, 2.0]},
    {"shape": FRUSTUM, "radius_bottom": 0.6, "radius_top": 0.3, "length": 1.0, "density": 300.0,
     "position": [0.2, 0.0, -2.5], "attitude": [math.cos(0.2), math.sin(0.2), 0.0, 0.0]},
    {"shape": BOX, "size": [0.2, 2.0, 1.0], "mass": 60.0, "position": [0.3, 2.1, 0.5],
     "attitude": [math.cos(0.4), 0.0, 0.0, math.sin(0.4)]},
]  # fmt: skip


def laid(entries):
    rows = np.array(pieces.gather(entries))
    return rows, union.lay({}, {union.PARTS: rows})


def meshes(rows):
    """The same pieces as fine meshes of another library, moved into the design axes."""
    found = []
    for row in rows:
        s = row[1:5]
        if row[0] == BOX:
            mesh = trimesh.creation.box(extents=s[:3])
        elif row[0] == SPHERE:
            mesh = trimesh.creation.icosphere(subdivisions=5, radius=s[0])
        else:
            bottom, top, length = (s[0], s[0], s[1]) if row[0] == CYLINDER else s[:3]
            line = [[0.0, -length / 2], [bottom, -length / 2], [top, length / 2], [0.0, length / 2]]
            mesh = trimesh.creation.revolve(line, sections=256)
        matrix = np.eye(4)
        matrix[:3, :3], matrix[:3, 3] = Rotation.from_quat(row[9:13], scalar_first=True).as_matrix(), row[6:9]
        mesh.apply_transform(matrix)
        found.append(mesh)
    return found


def test_mass_and_inertia_are_those_of_meshes():
    rows, made = laid(STAGE)
    mass, first, second = 0.0, np.zeros(3), np.zeros((3, 3))
    for row, mesh in zip(rows, meshes(rows), strict=True):
        mesh.density = row[5] / mesh.volume
        mass += mesh.mass
        first += mesh.mass * mesh.center_mass
        d = mesh.center_mass
        second += mesh.moment_inertia + mesh.mass * (d @ d * np.eye(3) - np.outer(d, d))
    center = first / mass
    tensor = second - mass * (center @ center * np.eye(3) - np.outer(center, center))
    solid = made.tables["target.solid"]
    assert made.parameters["target.mass"] == pytest.approx(mass, rel=1e-9)
    np.testing.assert_allclose(solid[solids.CENTER : solids.HALF], center, atol=1e-4)
    turn = Rotation.from_quat(solid[solids.TURN : solids.CENTER], scalar_first=True).as_matrix()
    own = turn @ np.diag(mass * solid[:3]) @ turn.T
    np.testing.assert_allclose(own, tensor, atol=1e-3 * tensor.max())
    assert np.abs(tensor - np.diag(np.diag(tensor))).max() > 0.02 * tensor.max()
    assert np.trace(turn) > 2.0  # the axes nearest to those of the design


def test_distance_is_that_of_the_nearest_of_dense_points():
    """Of points of the meshes that lie in no other; inside, a lower bound of the depth."""
    rows, made = laid(STAGE)
    solid, table = made.tables["target.solid"], made.tables["target.pieces"]
    turn = Rotation.from_quat(solid[solids.TURN : solids.CENTER], scalar_first=True).as_matrix()
    skins = meshes(rows)
    dense = np.vstack([trimesh.sample.sample_surface_even(mesh, 8000, seed=3)[0] for mesh in skins])
    dense = (dense - solid[solids.CENTER : solids.HALF]) @ turn
    np.testing.assert_allclose(np.abs(dense).max(axis=0), solid[solids.HALF : solids.RADIUS], rtol=0.01)
    assert np.linalg.norm(dense, axis=1).max() == pytest.approx(solid[solids.RADIUS], rel=0.01)
    distance = formula(union.union_distance)
    room = np.zeros((2, 3))
    outer = dense[np.array([distance(table, np.zeros(3), *room, point) for point in dense]) > -1e-3]
    tree = cKDTree(outer)
    rng = np.random.default_rng(4)
    inside = 0
    for point in rng.uniform(-1.3, 1.3, (300, 3)) * solid[solids.HALF : solids.RADIUS]:
        normal = np.zeros(3)
        found = distance(table, normal, *room, point)
        nearest = tree.query(point)[0]
        assert np.linalg.norm(normal) == pytest.approx(1.0, abs=1e-12)
        slope = [
            (distance(table, np.zeros(3), *room, point + d) - distance(table, np.zeros(3), *room, point - d)) / 2e-6
            for d in 1e-6 * np.eye(3)
        ]
        np.testing.assert_allclose(slope, normal, atol=1e-3)
        if found > 0.0:
            assert found == pytest.approx(nearest, abs=0.08)
        else:
            inside += 1
            assert -found < nearest + 2e-3
    assert 20 < inside < 150


SHELL_SIZES = (1.5, 3.0, 0.2, math.radians(200.0))


def test_the_shell_is_a_piece_of_a_tube():
    """Against points on all six of its faces, and its inside told by angle and radius."""
    radius, length, thickness, angle = SHELL_SIZES
    u, v = (a.ravel() for a in np.meshgrid(np.linspace(-1.0, 1.0, 161), np.linspace(-1.0, 1.0, 161)))
    walls = [(np.full_like(u, r), 0.5 * angle * u, 0.5 * length * v) for r in (radius, radius - thickness)]
    across = radius - 0.5 * thickness + 0.5 * thickness * u
    walls += [(across, np.full_like(u, side * angle / 2), 0.5 * length * v) for side in (-1, 1)]
    walls += [(across, 0.5 * angle * v, np.full_like(u, side * length / 2)) for side in (-1, 1)]
    dense = np.vstack([np.column_stack([r * np.cos(a), r * np.sin(a), z]) for r, a, z in walls])
    tree, rng, within = cKDTree(dense), np.random.default_rng(2), 0
    points = np.vstack([
        rng.uniform(-2.0, 2.0, (300, 3)),
        dense[rng.integers(0, len(dense), 200)] + rng.normal(0.0, 0.05, (200, 3)),
    ])  # fmt: skip
    for point in points:
        normal = np.zeros(3)
        found = formula(shell_distance)(normal, point, *SHELL_SIZES)
        away, turn = math.hypot(point[0], point[1]), abs(math.atan2(point[1], point[0]))
        inside = radius - thickness < away < radius and turn < angle / 2 and abs(point[2]) < length / 2
        assert (found < 0.0) == inside
        assert abs(found) == pytest.approx(tree.query(point)[0], abs=0.02)
        assert np.linalg.norm(normal) == pytest.approx(1.0, abs=1e-12)
        slope = [
            (formula(shell_distance)(np.zeros(3), point + d, *SHELL_SIZES)
             - formula(shell_distance)(np.zeros(3), point - d, *SHELL_SIZES)) / 2e-7
            for d in 1e-7 * np.eye(3)
        ]  # fmt: skip
        np.testing.assert_allclose(slope, normal, atol=1e-4)
        within += inside
    assert within > 20


def test_a_shell_weighs_where_its_slices_do():
    radius, length, thickness, angle = SHELL_SIZES
    _, made = laid([{"shape": SHELL, "radius": radius, "length": length, "thickness": thickness, "angle": angle,
                        "mass": 90.0}])  # fmt: skip
    away = radius - thickness + thickness * (np.arange(400) + 0.5) / 400
    turn = angle * ((np.arange(400) + 0.5) / 400 - 0.5)
    r, a = (x.ravel() for x in np.meshgrid(away, turn))
    x, y, share = r * np.cos(a), r * np.sin(a), r / r.sum()
    center = float((share * x).sum())
    assert shell_center(*SHELL_SIZES) == pytest.approx(center, rel=1e-5)
    squares = [float((share * (x - center) ** 2).sum()), float((share * y * y).sum()), length**2 / 12.0]
    np.testing.assert_allclose(made.tables["target.solid"][:3], [sum(squares) - one for one in squares], rtol=1e-5)
    # the cord that passes over a half shell: along its axis, round the arc and across
    half = laid([{"shape": SHELL, "radius": 1.0, "length": 9.0, "thickness": 1e-3, "angle": math.pi, "mass": 1.0}])[1]
    assert half.tables["target.solid"][solids.GIRTH] == pytest.approx(math.pi + 2.0, rel=1e-3)


@pytest.mark.parametrize(
    ("entry", "girth"),
    [
        ({"shape": BOX, "size": [4.0, 8.0, 4.0]}, 16.0),
        ({"shape": BOX, "size": [3.0, 1.0, 2.0]}, 6.0),
        ({"shape": CYLINDER, "radius": 2.0, "length": 8.0}, 4.0 * math.pi),
        ({"shape": CYLINDER, "radius": 2.0, "length": 0.5}, 9.0),
    ],
    ids=str,
)
def test_girth_is_that_of_the_closed_forms(entry, girth):
    """Also askew: the directions that are tried first are not along its axes."""
    askew = Rotation.from_rotvec([0.3, -0.5, 0.2]).as_quat(scalar_first=True).tolist()
    solid = laid([entry | {"mass": 1.0, "attitude": askew}])[1].tables["target.solid"]
    assert abs(solid[solids.GIRTH] - girth) <= solid[solids.GIRTH_ERROR] + 1e-5 * girth
    assert solid[solids.GIRTH_ERROR] < 4e-4 * girth


def test_sample_points_are_as_deep_as_asked_or_as_there_is():
    rows, made = laid(STAGE)
    table, places = made.tables["target.pieces"], made.tables["target.samples"]
    distance, room = formula(union.union_distance), np.zeros((3, 3))
    at = [[distance(table, *room, row[3 * k : 3 * k + 3]) for k in (0, 1)] for row in places]
    starts, ends = np.array(at[1:]).T
    np.testing.assert_allclose(starts, 0.0, atol=1e-5)
    assert ends.max() < -0.09  # in the middle of the thinnest, a panel of 0.2 m
    for row in places:
        way = row[:3] + (row[3:] - row[:3]) * np.linspace(0.05, 1.0, 20)[:, None]
        assert max(distance(table, *room, point) for point in way) < 0.0
    body = union.body_of(rows)
    for piece in pieces.pieces(rows):
        filled = [distance(table, *room, point) for point in body.to_body(pieces.filling(piece))]
        assert np.mean(np.array(filled) < 1e-9) >= (1.0 if piece.kind == BOX else 0.2)
    apart = np.linalg.norm(places[1:, None, :3] - places[None, 1:, :3], axis=-1) + 10.0 * np.eye(26)
    assert apart.min() > 0.5


@pytest.mark.parametrize(
    ("entry", "text"),
    [
        ({"radius": 1.0}, "piece 1 has no shape"),
        ({"shape": SPHERE, "mass": 1.0}, "piece 1, a sphere, lacks its radius"),
        ({"shape": SPHERE, "radius": 1.0, "length": 1.0, "mass": 1.0}, "a sphere, has no length"),
        ({"shape": SPHERE, "radius": 1.0}, "no mass or density"),
        ({"shape": SPHERE, "radius": 1.0, "mass": 1.0, "density": 1.0}, "both mass and density"),
        ({"shape": SPHERE, "radius": 1.0, "mass": 1.0, "attitude": [2.0, 0, 0, 0]}, "an attitude of length 2"),
        ({"shape": FRUSTUM, "radius_bottom": 0.0, "radius_top": 0.0, "length": 1.0, "mass": 1.0}, "two radii of 0"),
        ({"shape": SHELL, "radius": 1.0, "length": 1.0, "thickness": 1.0, "mass": 1.0}, "must be less than its radius"),
        ({"shape": BOX, "size": [1.0, 0.0, 1.0], "mass": 1.0}, "each must be greater than 0"),
    ],
    ids=str,
)
def test_what_is_no_piece_is_told(entry, text):
    with pytest.raises(ValueError, match=text):
        pieces.gather([entry])


def test_a_union_tumbles_as_its_tensor_says_and_is_caught_with_all_momenta_kept():
    """Before it is touched, against Euler's equations with the full tensor in the design axes."""
    _, made = laid(STAGE)
    solid = made.tables["target.solid"]
    turn = Rotation.from_quat(solid[solids.TURN : solids.CENTER], scalar_first=True)
    tensor = made.parameters["target.mass"] * (turn.as_matrix() @ np.diag(solid[:3]) @ turn.as_matrix().T)
    start, rate = Rotation.from_rotvec([0.2, 0.4, -0.1]), np.radians([5.0, 5.0, 5.0])
    given = {
        **made.parameters,
        "closing.time": 6.5,
        "net.side": 12.0,
        "net.mesh": 1.0,
        "net.mass": 0.8,
        "bullets.mass": 1.2,
        "chaser.start_position[2]": -12.0,
        **{f"target.start_attitude[{i + 1}]": x for i, x in enumerate(start.as_quat(scalar_first=True))},
        **{f"target.start_rate[{i + 1}]": x for i, x in enumerate(rate)},
    }
    net = Instance(MODEL, CAPTURE | {"target": "union"}, given, made.tables).initialise()

    def euler(_, y):
        w = y[4:]
        x, yy, z, s = y[:4]
        rates = 0.5 * np.array([
            s * w[0] + yy * w[2] - z * w[1], s * w[1] + z * w[0] - x * w[2], s * w[2] + x * w[1] - yy * w[0],
            -x * w[0] - yy * w[1] - z * w[2],
        ])  # fmt: skip
        return [*rates, *np.linalg.solve(tensor, -np.cross(w, tensor @ w))]

    end = solve_ivp(euler, (0.0, 4.0), [*start.as_quat(), *rate], rtol=1e-11, atol=1e-12).y[:, -1]
    spin, energy = net.array("angular_momentum").copy(), net["target.energy"]
    for _ in range(8):
        net.step(0.5)
    design = Rotation.from_quat(net.array("target_attitude"), scalar_first=True) * turn.inv()
    assert (design * Rotation.from_quat(end[:4]).inv()).magnitude() < 1e-5
    np.testing.assert_allclose(turn.apply(net.array("target_rate")), end[4:], atol=1e-6)
    assert net["target.energy"] == pytest.approx(energy, rel=1e-5)
    while net.time < 11.0:
        net.step(0.5)
        assert np.abs(net.array("momentum")).max() < 1e-11 * 10.0
        assert net.array("angular_momentum") == pytest.approx(spin, abs=1e-11 * np.abs(spin).max())
    assert net["contact.loss"] > 0.1
    assert OUTCOMES[int(net["outcome"])] == "captured"
    assert abs(net["energy.remainder"]) < 0.02 * (20.0 + net["closing.work"])


def test_contact_moves_a_sphere_and_never_turns_it():
    """Without friction every impulse goes through its centre, however askew the net meets it: its spin is kept to
    rounding, and it gains no energy but of its speed."""
    _, made = laid([{"shape": SPHERE, "radius": 1.5, "mass": 50.0}])
    given = {
        **made.parameters,
        "closing.time": 100.0,
        "net.side": 8.0,
        "net.mesh": 1.0,
        "net.mass": 0.5,
        "chaser.start_position[1]": 0.6,
        "chaser.start_position[2]": -8.0,
        "shot.axis[2]": 1.0,
        **{f"target.start_rate[{i}]": 0.01 * i for i in (1, 2, 3)},
    }
    net = Instance(MODEL, CAPTURE | {"target": "union"}, given, made.tables).initialise()
    spin, energy = net.array("target_spin").copy(), net["target.energy"]
    np.testing.assert_allclose(spin, 0.4 * 50.0 * 1.5**2 * np.array([0.01, 0.02, 0.03]), rtol=1e-14)
    for _ in range(12):
        net.step(0.5)
    speed = float(np.linalg.norm(net.array("target_velocity")))
    assert net["contact.impulse"] > 1.0
    assert net.array("target_velocity")[0] < -1e-4
    np.testing.assert_allclose(net.array("target_spin"), spin, atol=1e-13 * 50.0)
    assert net["target.energy"] == pytest.approx(energy + 25.0 * speed**2, rel=1e-9)
