"""Whether a shot can work at all: necessary conditions, in closed form, for a clear refusal before any build or run.

They are bounds, not a prediction: a scene that passes may still miss, and only the run tells.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import NamedTuple

from fmu_src.net_capture.terms import LARGEST_MESH, MOST_NODES

FALLEN_BACK = 2.0
"""A net flies on about as far again as it took to open while it falls back: at Table 1's shot the mouth, full at 21.5
m, is below a tenth of its area beyond 40 m (measured with this model, undisturbed, damping ratio 0.106)."""
WHOLE = 1e-6
"""Share of a mesh by which the side may miss a whole number of them, as in the kernel."""

Parameters = Mapping[str, float]


class Refusal(NamedTuple):
    """A value that makes the shot impossible: FMI name, the value as text, what was expected."""

    name: str
    value: str
    expected: str


def _vector(parameters: Parameters, name: str, size: int = 3) -> list[float]:
    return [float(parameters[f"{name}[{i}]"]) for i in range(1, size + 1)]


def _text(values: list[float], unit: str = "") -> str:
    return "[" + ", ".join(f"{value:g}{unit}" for value in values) + "]"


def opening_distance(side: float, fold_side: float, speed: float, angle: float) -> float:
    """Distance [m] flown by the bullets when, unhindered, they have spread to the corners of the flat net.

        z = (a - a0) / (sqrt(2) tan(alpha))

    side       a      of the flat net                  [m]
    fold_side  a0     of the folded net                [m]
    speed      V0     of the bullets                   [m/s]
    angle      alpha  from the shot axis               [rad]

    Valid    a lower bound of where the mouth is largest: the net holds the bullets back
    """
    return (side - fold_side) / (math.sqrt(2.0) * math.tan(angle)) if speed > 0.0 and angle > 0.0 else math.inf


def node_count(meshes: int, segments: int) -> int:
    """Nodes of a square net: its knots, and the inner nodes of every thread cut into segments."""
    knots = meshes + 1
    return knots * knots + 2 * (segments - 1) * knots * meshes


def nodes_of(parameters: Parameters) -> str:
    """The capacity that a net's mesh asks for, "1" where there is no such net."""
    meshes = float(parameters["net.side"]) / float(parameters["net.mesh"])
    if not 2.0 - WHOLE <= meshes <= LARGEST_MESH:
        return "1"
    return str(min(node_count(round(meshes), int(parameters["net.segments"])), MOST_NODES))


def refusals(parameters: Parameters, duration: float = math.inf, capacity: int | None = None) -> list[Refusal]:
    """Why a shot can not work: empty if nothing speaks against it.

    parameters   values by FMI name [SI]; names of terms that are not in the scene may be missing
    duration     of the capture phase [s]
    capacity     how many nodes the FMU has outputs for; None: it has none
    """
    found = list(_about_net(parameters, capacity))
    if "target.size[1]" in parameters:
        found += _about_target(parameters)
        found += _about_place(parameters)
        if not found:
            found += _about_shot(parameters, duration)
    return found


def _about_net(parameters: Parameters, capacity: int | None) -> Iterator[Refusal]:
    """Meshes, nodes and fold of the net."""
    side, mesh = float(parameters["net.side"]), float(parameters["net.mesh"])
    segments, fold = int(parameters["net.segments"]), float(parameters["net.fold_side"])
    if fold >= side:
        yield Refusal("net.fold_side", f"{fold:g} m", f"must be smaller than net.side, {side:g} m")
    meshes = side / mesh
    whole = round(meshes) if math.isfinite(meshes) else 0
    if meshes * segments > LARGEST_MESH + 0.5:
        cut = f", each cut into {segments} segments" if segments > 1 else ""
        expected = f"net.side = {side:g} m holds {meshes:.4g} meshes{cut}; at most {LARGEST_MESH} pieces per side"
        yield Refusal("net.mesh", f"{mesh:g} m", expected)
    elif whole < 2 or abs(meshes - whole) > WHOLE * whole:
        expected = f"must be a whole number of net.mesh, {mesh:g} m, and at least 2; it is {meshes:.6g}"
        yield Refusal("net.side", f"{side:g} m", expected)
    elif capacity is not None and node_count(whole, segments) > capacity:
        expected = f"must be at least {node_count(whole, segments)}, the nodes of this net"
        yield Refusal("nodes.capacity", str(capacity), expected)
    elif parameters.get("closing.rings", 0) >= whole:
        expected = f"must be at most {whole - 1}: a side of this net has so many knots between its bullets"
        yield Refusal("closing.rings", f"{int(parameters['closing.rings'])}", expected)


def _about_target(parameters: Parameters) -> Iterator[Refusal]:
    """Inertia and attitude that no rigid body has."""
    inertia = _vector(parameters, "target.principal_inertia")
    if any(inertia):
        largest, others = max(inertia), sum(inertia) - max(inertia)
        if min(inertia) <= 0.0 or largest > others * (1.0 + 1e-12):
            expected = "none may be zero or exceed the sum of the other two (leave it out for a uniform box)"
            yield Refusal("target.principal_inertia", _text(inertia, " kg m2"), expected)
    attitude = _vector(parameters, "target.start_attitude", 4)
    squared = sum(part * part for part in attitude)
    if any(attitude) and not abs(squared - 1.0) <= 1e-6:
        expected = f"must be a quaternion of unit length, scalar first; its length is {math.sqrt(squared):.6g}"
        yield Refusal("target.start_attitude", _text(attitude), expected)


def _about_place(parameters: Parameters) -> Iterator[Refusal]:
    """A muzzle that no shot can leave."""
    chaser = _vector(parameters, "chaser.start_position")
    half = [0.5 * edge for edge in _vector(parameters, "target.size")]
    attitude = _vector(parameters, "target.start_attitude", 4)
    name, shown = "chaser.start_position", _text(chaser, " m")
    if not any(chaser) and not any(_vector(parameters, "shot.axis")):
        yield Refusal(name, shown, "stands in the target's centre of mass, and shot.axis names no direction")
    elif "contact.restitution" in parameters:
        inside = _in_body_axes(attitude, chaser)
        if all(abs(x) < h for x, h in zip(inside, half, strict=True)):
            yield Refusal(name, shown, "must be outside the target: the folded net would begin inside it")


def _in_body_axes(attitude: list[float], vector: list[float]) -> list[float]:
    """A vector of the frame in the axes of a body with this attitude; zero: aligned."""
    length = math.hypot(*attitude)
    if length == 0.0:
        return vector
    w, x, y, z = (part / length for part in attitude)
    a, b, c = vector
    return [
        (1 - 2 * (y * y + z * z)) * a + 2 * (x * y + w * z) * b + 2 * (x * z - w * y) * c,
        2 * (x * y - w * z) * a + (1 - 2 * (x * x + z * z)) * b + 2 * (y * z + w * x) * c,
        2 * (x * z + w * y) * a + 2 * (y * z - w * x) * b + (1 - 2 * (x * x + y * y)) * c,
    ]


def _about_shot(parameters: Parameters, duration: float) -> Iterator[Refusal]:
    """Whether the net gets to the target, in time, open, and wide enough."""
    chaser = _vector(parameters, "chaser.start_position")
    size = _vector(parameters, "target.size")
    axis = _vector(parameters, "shot.axis")
    distance = math.hypot(*chaser)
    here = f"is {distance:.4g} m from the target"
    side, fold = float(parameters["net.side"]), float(parameters["net.fold_side"])
    speed, angle = float(parameters["bullets.speed"]), float(parameters["bullets.angle"])
    half_diagonal = 0.5 * math.hypot(*size)
    near = distance - half_diagonal
    place, shown = "chaser.start_position", _text(chaser, " m")
    tether = parameters.get("tether.length")
    if tether is not None and tether < near:
        expected = f"must be at least {near:.4g} m, the distance to the target's nearest point"
        yield Refusal("tether.length", f"{tether:g} m", expected)
    girth = 2.0 * (sum(size) - max(size))
    if 4.0 * side <= girth:
        expected = f"must be more than {girth / 4:.4g} m: the mouth must go round the target"
        yield Refusal("net.side", f"{side:g} m", expected)
    forward = speed * math.cos(angle)
    if angle <= 0.0:
        expected = "must be greater than 0: bullets that fly side by side never open the net"
        yield Refusal("bullets.angle", f"{math.degrees(angle):g} deg", expected)
    elif speed <= 0.0:
        yield Refusal("bullets.speed", f"{speed:g} m/s", "must be greater than 0, or the net never arrives")
    elif forward <= 1e-9 * speed:
        expected = "must be less than 90 deg: without speed along the shot axis the net never arrives"
        yield Refusal("bullets.angle", f"{math.degrees(angle):g} deg", expected)
    else:
        if near / forward > duration:
            expected = (
                f"{here}; in {duration:g} s the net flies {forward * duration:.4g} m at {forward:.3g} m/s: "
                f"come within {forward * duration + half_diagonal:.4g} m, or raise duration or bullets.speed"
            )
            yield Refusal(place, shown, expected)
        limit = FALLEN_BACK * opening_distance(side, fold, speed, angle)
        if near > limit:
            expected = f"{here}; must be at most {limit + half_diagonal:.4g} m: farther out the net has fallen back"
            yield Refusal(place, shown, f"{expected} on itself")
    length = math.hypot(*axis)
    if length > 0.0 and distance > 0.0:
        along = -sum(a * c for a, c in zip(axis, chaser, strict=True)) / length
        beside = math.sqrt(max(distance * distance - along * along, 0.0))
        widest = 0.5 * side + half_diagonal
        if along <= 0.0:
            expected = f"points away from the target, which lies along {_text([0.0 - c / distance for c in chaser])}"
            yield Refusal("shot.axis", _text(axis), expected)
        elif beside > widest:
            expected = f"passes {beside:.4g} m beside the target's centre; must be within {widest:.4g} m of it"
            yield Refusal("shot.axis", _text(axis), expected)
