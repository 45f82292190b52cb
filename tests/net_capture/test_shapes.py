"""Box, cylinder, sphere and frustum: distances, girths, sample points and inertia against what is true of any convex
body; capture of a cylinder."""

import math
from functools import cache

import numpy as np
import pytest
from numpy.polynomial import Polynomial
from scipy.optimize import minimize
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from fmu_src.net_capture.interface import MODEL, OUTCOMES
from fmu_src.net_capture.planes import SHOWN
from orbital.kernel import kernel
from tests.conftest import CAPTURE
from tests.net_capture.memory import nodes, planes

SIZES = {
    "box": [(4.0, 8.0, 4.0), (3.0, 1.0, 2.0), (1.0, 1.5, 6.0)],
    "cylinder": [(2.0, 8.0), (3.0, 1.0), (1.0, 1.3)],
    "sphere": [(1.3,)],
    "frustum": [(0.5, 1.5, 1.0), (1.0, 0.0, 2.0)],
}
CASES = [(shape, size) for shape, sizes in SIZES.items() for size in sizes]
CYLINDER = CAPTURE | {"target": "cylinder"}


NAMES = {
    "box": [f"target.size[{i}]" for i in (1, 2, 3)],
    "cylinder": ["target.radius", "target.length"],
    "sphere": ["target.radius"],
    "frustum": ["target.radius_bottom", "target.radius_top", "target.length"],
}


def support(shape, size, n):
    """How far a body reaches along unit vectors (..., 3) [m]."""
    if shape == "box":
        return np.abs(n) @ (0.5 * np.array(size))
    if shape == "sphere":
        return size[0] * np.linalg.norm(n, axis=-1)
    bottom, top, low, high = ends(size)
    across = np.hypot(n[..., 0], n[..., 1])
    return np.maximum(bottom * across - low * n[..., 2], top * across + high * n[..., 2])


@cache
def ends(size):
    """Radii of both ends of a cylinder or frustum, and how far they are from its centre of mass [m]."""
    bottom, top, length = size if len(size) == 3 else (size[0], *size)
    section = Polynomial([bottom, top - bottom]) ** 2
    low = length * float((section * Polynomial([0.0, 1.0])).integ()(1.0) / section.integ()(1.0))
    return bottom, top, low, length - low


def directions(count):
    """Unit vectors spread evenly over a sphere, by the golden angle."""
    z = 1.0 - (2.0 * np.arange(count) + 1.0) / count
    turn = math.pi * (3.0 - math.sqrt(5.0)) * np.arange(count)
    return np.column_stack([np.sqrt(1.0 - z * z) * np.cos(turn), np.sqrt(1.0 - z * z) * np.sin(turn), z])


DIRECTIONS = directions(4000)


def far_plane(shape, size, point):
    """Signed distance of a point from a convex body, and its normal: the largest n . x - h(n) over all planes that
    touch the body, h its support function. From a point outside there is one largest, and one start finds it, begun
    again where it halts."""
    start = DIRECTIONS
    axes = np.vstack([np.eye(3), -np.eye(3)])
    beyond = start @ point - support(shape, size, start)

    def short(n):
        n = n / np.linalg.norm(n)
        return support(shape, size, n) - n @ point

    def from_(n):
        options = {"xatol": 1e-10, "fatol": 1e-14, "maxiter": 4000, "maxfev": 4000}
        return minimize(short, n, method="Nelder-Mead", options=options)

    nearest = start[np.argsort(-beyond)[:3]]
    found = [from_(from_(nearest[0]).x)] if beyond.max() > 0.0 else [from_(n) for n in nearest]
    best = min(found, key=lambda each: each.fun)
    candidates = np.vstack([best.x / np.linalg.norm(best.x), axes])
    values = candidates @ point - support(shape, size, candidates)
    return float(values.max()), candidates[values.argmax()]


def parameters(shape, size):
    return dict(zip(NAMES[shape], size, strict=True)) | {"target.mass": 700.0}


class Body:
    """The kernels of a shape, measured for a size."""

    def __init__(self, shape, size):
        self.values = parameters(shape, size)
        term = MODEL.groups["target"].terms[shape]
        self.checks = term.checks
        terms = CAPTURE | {"target": shape}
        self.record = MODEL.interface(terms).make_record()
        for name, value in self.values.items():
            field, _, index = name.replace(".", "_").partition("[")
            if index:
                self.record[field][0][int(index[:-1]) - 1] = value
            else:
                self.record[field] = value
        self.kernels = KERNELS[shape]
        self.kernels["measure"](self.record)
        self.p = self.record[0]

    def distance(self, point):
        normal = np.zeros(3)
        return self.kernels["distance"](self.record, normal, np.array(point)), normal

    def sample(self, number, depth):
        out = np.zeros(3)
        self.kernels["sample"](self.record, out, number, depth)
        return out

    def inertia(self):
        out = np.zeros(3)
        self.kernels["inertia"](self.record, out)
        return out


def whole(function):
    """A kernel of a record in place of one of its first element."""

    @kernel
    def measure(record):
        function(record[0])

    @kernel
    def inertia(record, out):
        function(record[0], out)

    @kernel
    def distance(record, normal, point):
        return function(record[0], normal, point)

    @kernel
    def sample(record, out, number, depth):
        function(record[0], out, number, depth)

    return {"measure": measure, "inertia": inertia, "distance": distance, "sample": sample}


def kernels_of(shape):
    from fmu_src.net_capture.shapes import box, cylinder, frustum, sphere

    made = {"box": box, "cylinder": cylinder, "sphere": sphere, "frustum": frustum}[shape].PART.make(None)
    return {name: whole(getattr(made, name))[name] for name in ("measure", "inertia", "distance", "sample")} | {
        "samples": made.samples
    }


KERNELS = {shape: kernels_of(shape) for shape in SIZES}


@pytest.fixture(params=CASES, ids=str)
def body(request):
    made = Body(*request.param)
    made.shape, made.size = request.param
    return made


def points(body, count=15):
    """Random points in and around it, and some on its axes."""
    rng = np.random.default_rng(5)
    half = np.array(body.checks.half(body.values))
    spread = rng.uniform(-1.6, 1.6, (count, 3)) * half
    return np.vstack([spread, np.diag(1.5 * half), np.diag(-1.5 * half), np.diag(0.7 * half)])


def test_distance_and_normal_are_those_of_the_farthest_plane(body):
    inside = 0
    for point in points(body):
        expected, plane = far_plane(body.shape, body.size, point)
        found, normal = body.distance(point)
        assert found == pytest.approx(expected, abs=1e-7)
        assert body.checks.distance(body.values, point) == pytest.approx(found, abs=1e-14)
        assert np.linalg.norm(normal) == pytest.approx(1.0, abs=1e-14)
        # where two planes are as far, either will do
        if abs(plane @ point - support(body.shape, body.size, plane) - expected) < 1e-12 and expected > 0.0:
            np.testing.assert_allclose(normal, plane, atol=1e-4)
        assert normal @ point - support(body.shape, body.size, normal) == pytest.approx(found, abs=1e-12)
        inside += expected < 0.0
    assert 1 < inside < len(points(body)) - 5


def test_normal_is_the_gradient_of_the_distance(body):
    step = 1e-5
    for point in points(body, 25)[:25]:
        _, normal = body.distance(point)
        slope = [(body.distance(point + d)[0] - body.distance(point - d)[0]) / (2.0 * step) for d in step * np.eye(3)]
        np.testing.assert_allclose(slope, normal, atol=1e-4)


def test_on_the_axis_the_normal_is_still_a_unit_vector(body):
    for point in ([0.0, 0.0, 0.0], [0.0, 0.0, 0.1], [0.0, 0.0, 20.0]):
        found, normal = body.distance(point)
        assert np.linalg.norm(normal) == pytest.approx(1.0, abs=1e-15)
        assert found == pytest.approx(np.array(point) @ normal - support(body.shape, body.size, normal), abs=1e-14)


def surface(body):
    """Points that span the body."""
    if body.shape == "box":
        return 0.5 * np.array(body.size) * np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    if body.shape == "sphere":
        return body.size[0] * np.vstack([directions(3000), np.eye(3), -np.eye(3)])
    angles = np.linspace(0.0, 2.0 * math.pi, 720, endpoint=False)
    bottom, top, low, high = ends(body.size)
    return np.array([(r * math.cos(a), r * math.sin(a), z) for r, z in ((bottom, -low), (top, high)) for a in angles])


def silhouette(spanning, along):
    """Length of the shortest cord round what is seen of the points along a direction [m]."""
    _, _, basis = np.linalg.svd(along[None, :])
    seen = spanning @ basis[1:].T
    hull = ConvexHull(seen)
    corner = seen[hull.vertices]
    return float(np.linalg.norm(np.roll(corner, -1, axis=0) - corner, axis=1).sum())


def test_girth_is_the_shortest_silhouette(body):
    """A cord passes over a convex body along a direction when it goes round what is seen along it."""
    spanning = surface(body)
    ways = np.vstack([np.eye(3), directions(300)])
    best = min(ways, key=lambda way: silhouette(spanning, way))
    found = minimize(lambda way: silhouette(spanning, way), best, method="Nelder-Mead", options={"xatol": 1e-6})
    assert body.p["girth"] == pytest.approx(found.fun, rel=1e-3 if body.shape == "sphere" else 2e-5)
    assert body.checks.girth(body.values) == pytest.approx(float(body.p["girth"]), rel=1e-15)


def test_box_and_sphere_hold_it_tightly(body):
    spanning = surface(body)
    np.testing.assert_allclose(body.p["half_size"], np.abs(spanning).max(axis=0), rtol=1e-12)
    assert body.p["envelope_radius"] == pytest.approx(np.linalg.norm(spanning, axis=1).max(), rel=1e-12)
    np.testing.assert_allclose(body.checks.half(body.values), body.p["half_size"], rtol=1e-15)
    assert body.checks.radius(body.values) == pytest.approx(float(body.p["envelope_radius"]), rel=1e-15)


@pytest.mark.parametrize("share", [0.0, 0.3])
def test_sample_points_are_as_deep_as_asked(body, share):
    depth = share * min(body.checks.half(body.values))
    count = body.kernels["samples"]
    found = np.array([body.sample(number, depth) for number in range(count)])
    distances = np.array([body.distance(point)[0] for point in found])
    assert distances.max() == pytest.approx(-depth, abs=1e-12)
    assert len(np.unique(found.round(9) + 0.0, axis=0)) == (count if min(body.size) > 0.0 else 19)
    assert count == 27
    if body.shape == "frustum":
        return
    np.testing.assert_allclose(found.mean(axis=0), 0.0, atol=1e-14)
    # they reach as far as the body made smaller does, along every axis
    reach = np.array(body.checks.half(body.values)) - depth
    np.testing.assert_allclose(found.max(axis=0), reach, rtol=1e-12)
    assert np.sum(np.linalg.norm(found, axis=1) < 1e-12) == 1


def test_deeper_than_the_body_is_nothing(body):
    """Or where a frustum is deepest: a ball there touches its wall and an end."""
    deepest = np.zeros(3)
    if body.shape == "frustum":
        bottom, top, low, high = ends(body.size)
        widest, narrow, length = max(bottom, top), min(bottom, top), low + high
        ball = min(length / 2, widest * length / (math.hypot(length, widest - narrow) + widest - narrow))
        deepest[2] = ball - low if bottom > top else high - ball
        assert body.distance(deepest)[0] == pytest.approx(-ball, abs=1e-12)
    for number in range(body.kernels["samples"]):
        np.testing.assert_allclose(body.sample(number, 100.0), deepest, atol=1e-12)


def test_inertia_is_that_of_a_uniform_body(body):
    """Summed over thin slices across the third axis."""
    if body.shape == "box":
        a, b, c = body.size
        z = c * ((np.arange(1000) + 0.5) / 1000 - 0.5)
        mass, squares = np.ones(1000), [a * a / 12.0, b * b / 12.0]
    else:
        bottom, top, low, high = (0.0, 0.0, *body.size, *body.size) if body.shape == "sphere" else ends(body.size)
        z = (low + high) * (np.arange(1000) + 0.5) / 1000 - low
        radii = bottom + (top - bottom) * (z + low) / (low + high)
        mass = low * low - z * z if body.shape == "sphere" else radii**2
        squares = [float((mass * mass).sum() / mass.sum()) / 4.0] * 2
    assert float((mass * z).sum() / mass.sum()) == pytest.approx(0.0, abs=1e-5)
    squares.append(float((mass * z * z).sum() / mass.sum()))
    expected = [700.0 * (sum(squares) - own) for own in squares]
    np.testing.assert_allclose(body.inertia(), expected, rtol=1e-5)


def test_what_is_drawn_is_the_body(body):
    corners, faces = body.checks.surface(body.values)
    corners = np.array(corners)
    for corner in corners:
        assert body.checks.distance(body.values, corner) == pytest.approx(0.0, abs=1e-12)
    hull = ConvexHull(corners)
    if body.shape == "sphere":
        assert hull.volume == pytest.approx(4.0 / 3.0 * math.pi * body.size[0] ** 3, rel=0.03)
    else:
        bottom, top, low, high = (0.0, 0.0, 0.0, 0.0) if body.shape == "box" else ends(body.size)
        round_one = 4.0 * math.sin(math.pi / 12.0) * (bottom**2 + bottom * top + top**2) * (low + high)
        assert hull.volume == pytest.approx(math.prod(body.size) if body.shape == "box" else round_one, rel=1e-12)
    # every edge belongs to two faces
    edges = [frozenset((face[i - 1], face[i])) for face in faces for i in range(len(face))]
    assert all(edges.count(edge) == 2 for edge in edges)


@pytest.mark.evidence
def test_a_cylinder_is_captured_and_momenta_are_kept(shoot):
    turning = {"target.start_rate[1]": 0.02, "target.start_rate[3]": 0.03}
    net = shoot({"closing.time": 11.2} | turning, CYLINDER)
    spin = net.array("angular_momentum").copy()
    assert net.array("target_inertia") == pytest.approx(
        [1000.0 * (3.0 * 4.0 + 64.0) / 12.0, 1000.0 * (3.0 * 4.0 + 64.0) / 12.0, 1000.0 * 4.0 / 2.0], rel=1e-14
    )
    while net.time < 18.0:
        net.step(0.5)
        assert np.abs(net.array("momentum")).max() < 1e-11 * 4.6
        assert net.array("angular_momentum") == pytest.approx(spin, abs=1e-11 * np.abs(spin).max())
    assert OUTCOMES[int(net["outcome"])] == "captured"
    assert net["mouth.cord_length"] < net["mouth.girth"] == pytest.approx(4.0 * math.pi, rel=1e-14)
    assert net["contact.loss"] > 0.0
    assert np.abs(net.array("target_velocity")).max() * net["target.mass"] > 1e-3
    assert abs(net["energy.remainder"]) < 0.01 * (9.0 + net["closing.work"])


LIGHT = {
    "net.side": 4.0,
    "net.mesh": 1.0,
    "net.mass": 1e-5,
    "net.youngs_modulus": 1e6,
    "net.damping_ratio": 0.0,
    "net.fold_side": 0.4,
    "vertex.mass": 1e-6,
    "bullets.mass": 1e-3,
    "bullets.angle": 0.3,
    "closing.rings": 0,
}
"""A net of milligrams whose soft threads leave the substep at a millisecond and more."""


def deepest(net):
    """How far any node is inside the cylinder, by its place and attitude as told [m]."""
    w, x, y, z = net.array("target_attitude")
    turn = Rotation.from_quat([x, y, z, w]).as_matrix()
    shown = planes(net)[SHOWN : SHOWN + 3].T[nodes(net)]
    inside = (shown - net.array("target_position")) @ turn
    wall = net["target.radius"] - np.hypot(inside[:, 0], inside[:, 1])
    return float(np.max(np.minimum(wall, 0.5 * net["target.length"] - np.abs(inside[:, 2]))))


@pytest.mark.parametrize("way", ["wall", "end"])
@pytest.mark.parametrize("speed", [3.0, 3000.0])
def test_no_node_enters_a_cylinder(shoot, way, speed):
    """At its wall along the second axis, or at its end along the third."""
    at = (
        {"chaser.start_position[2]": -8.0}
        if way == "wall"
        else {
            "chaser.start_position[2]": 0.0,
            "chaser.start_position[3]": -8.0,
        }
    )
    net = shoot(LIGHT | at | {"bullets.speed": speed, "target.radius": 3.0, "target.length": 6.0}, CYLINDER)
    # whole substeps: what is shown between two of them is carried on freely
    substeps = max(round(0.004 / speed / net["solver.substep"]), 1)
    worst, touching = -math.inf, 0
    while net.time < 12.0 / speed:
        net.step(substeps * net["solver.substep"])
        worst = max(worst, deepest(net))
        touching = max(touching, int(net["contact.nodes"]))
    assert net["contact.impulse"] > 0.0
    # a node that would end inside is stopped where it began the substep
    assert -speed * net["solver.substep"] - 1e-3 < worst < 1e-6
    assert touching > 10 or speed > 3.0
