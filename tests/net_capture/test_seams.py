"""Nodes at the seams of a union, where faces of two pieces lie on one another and are no way out; and seams that are
open to them."""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fmu_src.implied import formula
from fmu_src.net_capture.shapes import pieces, seams, solids, union
from tests.net_capture.on_target import Kernels

HEAVY = {"target_mass": 1e9, "target_inertia": (1e9, 1e9, 1e9)}
"""A target that nothing moves."""
NODE = 0.01
BODY = {"shape": pieces.BOX, "size": [2.0, 2.0, 1.0], "mass": 100.0}
BOOM = {"shape": pieces.CYLINDER, "radius": 0.04, "length": 0.8, "mass": 4.0}
NOZZLE = {"shape": pieces.FRUSTUM, "radius_bottom": 0.3, "radius_top": 0.5, "length": 0.6, "mass": 4.0}


def laid(*entries):
    """Tables of a union, and how places of its design axes lie in its body axes."""
    made = union.lay({}, {union.PARTS: np.array(pieces.gather(entries))}).tables
    solid = made["target.solid"]
    turn = Rotation.from_quat(solid[solids.TURN : solids.CENTER], scalar_first=True).as_matrix()
    return made, lambda at: (np.asarray(at) - solid[solids.CENTER : solids.HALF]) @ turn


def at(piece, x, z, **more):
    return piece | {"position": [x, 0.0, z]} | more


FOOT = (BODY, at(BOOM, 0.0, 0.9))
ENDS = (at(BODY, 0.0, -0.5), at(BODY, 0.0, 0.5))
BESIDE = (at(BODY, 0.0, -0.5), at(BODY, 1.0, 0.5))
CROSSED = (at(BODY, 0.0, -0.5, size=[2.0, 0.4, 1.0]), at(BODY, 0.0, 0.5, size=[0.4, 2.0, 1.0]))
FLARED = (BODY, at(NOZZLE, 0.0, 0.8))
TOUCHING = {"foot": FOOT, "ends": ENDS, "beside": BESIDE, "crossed": CROSSED, "flared": FLARED}


def within(entries, points):
    """Which points (n, 3) of the design axes lie in a union: boxes and round pieces along the third axis."""
    found = np.zeros(len(points), dtype=bool)
    for entry in entries:
        x, y, z = (points - entry.get("position", (0.0, 0.0, 0.0))).T
        if entry["shape"] == pieces.BOX:
            found |= (np.abs([x, y, z]).T / entry["size"] <= 0.5).all(axis=1)
            continue
        half = 0.5 * entry["length"]
        bottom, top = (entry["radius"],) * 2 if "radius" in entry else (entry["radius_bottom"], entry["radius_top"])
        found |= (np.abs(z) <= half) & (np.hypot(x, y) <= bottom + (top - bottom) * (z + half) / (2.0 * half))
    return found


RIMS = {
    "foot": lambda t: (0.04 * math.cos(7.0 * t), 0.04 * math.sin(7.0 * t), 0.5),
    "ends": lambda t: (1.0, 2.0 * t - 1.0, 0.0),
    "beside": lambda t: (0.0, 2.0 * t - 1.0, 0.0),
    "crossed": lambda t: (0.2, 0.4 * t - 0.2, 0.0),
    "flared": lambda t: (0.3 * math.cos(7.0 * t), 0.3 * math.sin(7.0 * t), 0.5),
}
"""Places along the rim of each seam, design axes."""


@pytest.mark.parametrize("name", TOUCHING)
def test_a_point_at_a_seam_is_as_deep_as_the_open_is_far(name):
    """Of points scattered about it the nearest that lie in no piece, which a slit without width is not among."""
    entries, draw, room = TOUCHING[name], np.random.default_rng(6), np.empty((6, 3))
    made, to_body = laid(*entries)
    contact, plain = formula(union.contact_distance), formula(union.union_distance)
    reach, deep, missed = 0.03, 0, 0
    cloud = draw.uniform(-1.0, 1.0, (12000, 3))
    cloud = reach * cloud[np.linalg.norm(cloud, axis=1) < 1.0]
    for number in range(60):
        point = np.array(RIMS[name](draw.uniform()))
        point += draw.uniform(-1.0, 1.0, 3) * (0.02, 0.02, (0.0, 1e-10, 1e-4, 0.004)[number % 4])
        if not within(entries, point[None])[0]:
            continue
        away = cloud[~within(entries, point + cloud)]
        normal = np.zeros(3)
        depth = -contact(made[union.PIECES], room, normal, to_body(point))
        if len(away) < 20 or depth == 0.0:
            continue
        near = np.linalg.norm(away, axis=1).min()
        assert np.linalg.norm(normal) == pytest.approx(1.0, abs=1e-9)
        assert depth < near + 1e-9
        assert depth > 0.7 * near - 0.002, (point, normal)
        if near > 0.006:
            deep += 1
            missed += -plain(made[union.PIECES], *room[:3], to_body(point)) < 2e-4
            on = to_body(point) + 0.5 * depth * normal
            assert -contact(made[union.PIECES], room, np.zeros(3), on) < 0.999 * depth, "the normal leads out"
    assert deep > 8
    assert missed > 0.3 * deep, "the twin: by the pieces alone it has no depth"


@pytest.fixture(scope="module", params=["inelastic", "penalty"])
def kernels(request):
    terms = {"net": "square", "gravity": "none", "target": "union", "contact": request.param}
    return Kernels(terms, laid(*FOOT)[0])


def thrown(kernels, entries, begin, velocity, pull, steps=3000, **values):
    """Ways of a node (n, 3) and its speeds, design axes, and the record."""
    made = laid(*entries)[0]
    center = made["target.solid"][solids.CENTER : solids.HALF]
    scene = kernels.place(made, **HEAVY, **values)
    ways, speeds = scene.put([NODE], [np.array(begin) - center], [velocity]).go(2e-4, steps, [pull])
    return ways + center, speeds, scene.p


def law(kernels, elastic=False):
    if kernels.terms["contact"] == "inelastic":
        return {"contact_restitution": 1.0 if elastic else 0.0}
    return {"contact_duration": 1e-3, "contact_damping_ratio": 0.0 if elastic else 1.0, "contact_friction": 0.0}


@pytest.mark.parametrize("way", [1.0, -1.0])
@pytest.mark.parametrize(("begin", "wall"), [((-0.8, 0.1, 0.01), 0.0), ((1.8, 0.1, -0.01), 1.0)])
def test_a_node_that_glides_to_a_seam_is_held_by_the_piece_that_stands_out(kernels, begin, wall, way):
    """On the one, towards the other: it does not come between them, from above or from below."""
    entries = BESIDE if way > 0.0 else tuple(e | {"position": (-np.array(e["position"])).tolist()} for e in BESIDE)
    towards = math.copysign(1.0, wall - begin[0])
    begin, pull = way * np.array(begin), -way * math.copysign(0.05, begin[2]) * np.array((0.0, 0.0, 1.0))
    ways, _, _ = thrown(kernels, entries, (begin[0], 0.1, begin[2]), np.array((3.0 * towards * way, 0.0, 0.0)), pull,
                        **law(kernels))  # fmt: skip
    along = towards * (way * ways[:, 0] - wall)
    assert along.max() < 1.1e-3
    assert along.max() > -2e-3, "it has come there"
    assert np.abs(ways[1500:, 2]).max() < 1e-3


def test_a_node_that_glides_to_the_foot_of_a_boom_slides_round_it(kernels):
    ways, speeds, _ = thrown(
        kernels, FOOT, (-0.5, 0.003, 0.501), np.array((3.0, 0.0, 0.0)), np.array((0.0, 0.0, -0.05)), **law(kernels)
    )
    assert np.hypot(ways[:, 0], ways[:, 1]).min() > 0.0385
    assert np.hypot(ways[:, 0], ways[:, 1]).min() < 0.042
    assert ways[:, 2].min() > 0.4985
    assert np.linalg.norm(speeds[-1]) > 0.1


@pytest.mark.parametrize("off", [0.0, 1e-9, -1e-4, 3e-4])
def test_a_node_shot_at_a_flush_seam_comes_back_as_from_one_piece(kernels, off):
    """Where two boxes stand end to end; it gives all back, so it keeps its speed, and has no other along the seam."""
    one = (at(BODY, 0.0, 0.0, size=[2.0, 2.0, 2.0]),)
    begin, velocity, pull = (-1.3, 0.1, off), np.array((3.0, 0.2, 0.0)), np.zeros(3)
    found = [thrown(kernels, entries, begin, velocity, pull, 1000, **law(kernels, True)) for entries in (ENDS, one)]
    (ways, speeds, p), (whole, whole_speeds, _) = found
    np.testing.assert_allclose(ways, whole, atol=1e-12)
    np.testing.assert_allclose(speeds, whole_speeds, atol=1e-12)
    assert p["contact_impulse"] > NODE * 3.0
    assert speeds[-1, 0] < -2.9


SHELL = {"shape": pieces.SHELL, "radius": 1.3, "length": 4.5, "thickness": 0.05, "angle": math.pi, "mass": 180.0}
CAP = SHELL | {"length": 0.05, "thickness": 1.25}
CUBE = BODY | {"size": [1.6, 1.8, 2.0]}
BALL = {"shape": pieces.SPHERE, "radius": 0.5, "mass": 4.0}
LYING = {"attitude": [math.sqrt(0.5), math.sqrt(0.5), 0.0, 0.0]}


@pytest.mark.parametrize(
    ("first", "second", "place", "pairs"),
    [
        (CUBE, BOOM, 1.4, []),
        (CUBE, BOOM, 1.4 + 5e-4, [(1, 2)]),
        (CUBE, BOOM, 1.35, []),
        (CUBE, BOOM, 1.5, []),
        (CUBE, CUBE, 2.0, []),
        (CUBE, CUBE | {"size": [0.2, 3.0, 2.0]}, 2.0, []),
        (CUBE, BOOM | LYING, 1.04, [(1, 2)]),
        (CUBE, BOOM | LYING, 1.02, []),
        (CUBE, BALL, 1.5, [(1, 2)]),
        (CUBE, BALL, 1.45, []),
        (CUBE, NOZZLE, 1.3, []),
        (SHELL, CAP, 2.275, []),
        (SHELL, CAP, 2.255, []),
    ],
    ids=lambda one: one if isinstance(one, float) else None,
)
def test_seams_that_nodes_slip_into_are_found(first, second, place, pairs):
    """A boom on a body, with a slit and lying on it, bodies end to end and across, a ball, a cap flush with a shell."""
    turn = Rotation.from_euler("xyz", [0.3, -0.5, 0.8])
    entries = []
    for one, z in ((first, 0.0), (second, place)):
        own = Rotation.from_quat(one.get("attitude", [1.0, 0.0, 0.0, 0.0]), scalar_first=True)
        attitude = (turn * own).as_quat(scalar_first=True).tolist()
        entries.append(one | {"mass": 4.0, "position": turn.apply([0.0, 0.0, z]).tolist(), "attitude": attitude})
    assert list(seams.open_seams(laid(*entries)[0])) == pairs
