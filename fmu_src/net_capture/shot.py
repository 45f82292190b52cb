"""The shot: its axes, what each node begins with, and the bullets' velocity.

Bullets leave along the diagonals of the mouth, at an angle from the shot axis; the rest is at rest in the canister,
which moves with the chaser.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any, NamedTuple

from fmu_src.interface import fault
from fmu_src.net_capture.planes import INVERSE_MASS, MASS, SHOWN, U, X
from fmu_src.net_capture.refusal import Refusal, Scene, text
from fmu_src.net_capture.rigging import at_bullets, riggings
from orbital.kernel import kernel
from orbital.vectors import cross, dot

NO_AXIS = fault(
    "no_axis", "shot.axis[1]", "the chaser stands in the target's centre of mass, and shot.axis names no direction"
)


FALLEN_BACK = 2.0
"""A net flies on about as far again as it took to open while it falls back: at Table 1's shot the mouth, full at 21.5
m, is below a tenth of its area beyond 40 m (measured with this model, undisturbed, damping ratio 0.106)."""


class Shot(NamedTuple):
    """Kernels of the shot.

    load(p, work)      masses of bullets and vertex on their nodes, and the inverse of all masses
    jitter(p, work)    move every node a little
    shoot(p, work)     velocities of all nodes, by their places in the net as meant, which stand in the planes shown
    """

    load: Any
    jitter: Any
    shoot: Any


@kernel
def aim(p):
    """Shot axes as rows, and the muzzle; False where nothing says which way.

    Checked  tests/net_capture/test_free_flight.py
    """
    axis = p.axes[6:9]
    for i in range(3):
        p.muzzle[i] = p.chaser_start_position[i]
        axis[i] = p.shot_axis[i]
    if dot(axis, axis) == 0.0:
        for i in range(3):
            axis[i] = -p.chaser_start_position[i]
    length = math.sqrt(dot(axis, axis))
    if length == 0.0:
        return False
    for i in range(3):
        axis[i] /= length
    # first transverse axis: the orbital axis least along the shot, made normal to it
    least = 0
    for i in range(3):
        if abs(axis[i]) < abs(axis[least]):
            least = i
    share = axis[least]
    first = p.scratch[0:3]
    for i in range(3):
        first[i] = (1.0 if i == least else 0.0) - share * axis[i]
    length = math.sqrt(dot(first, first))
    for i in range(3):
        first[i] /= length
    second = p.scratch[3:6]
    second[0] = axis[1] * first[2] - axis[2] * first[1]
    second[1] = axis[2] * first[0] - axis[0] * first[2]
    second[2] = axis[0] * first[1] - axis[1] * first[0]
    c = math.cos(p.shot_roll)
    s = math.sin(p.shot_roll)
    for i in range(3):
        p.axes[i] = c * first[i] + s * second[i]
        p.axes[3 + i] = c * second[i] - s * first[i]
    return True


def make_shot(composition: Any) -> Shot:
    """Kernels of the shot of the composition's net."""
    memory = composition.memory
    node_plane, bullets, apex = memory.node_plane, memory.bullets, memory.apex
    has_ejection, has_spin = composition.ejection is not None, composition.spin is not None
    books_turn = composition.books_turn
    aim_each = composition.ejection.aim if has_ejection else None
    spin = composition.spin.turn if has_spin else None

    @kernel
    def load(p, work):
        """Masses of bullets and vertex [kg], and the inverse of all masses [1/kg].

        Checked  tests/net_capture/test_free_flight.py
        """
        mass = node_plane(p, work, MASS)
        inverse = node_plane(p, work, INVERSE_MASS)
        for corner in range(p.net_corners):
            mass[bullets(p, work)[corner]] += p.bullets_mass
        for i in range(p.apex_nodes):
            mass[apex(p, work)[i]] += p.vertex_mass / p.apex_nodes
        for i in range(p.node_slots):
            inverse[i] = 1.0 / mass[i] if mass[i] > 0.0 else 0.0

    @kernel
    def jitter(p, work):
        """By a small linear congruential generator: the same seed gives the same net.

        Source   multiplier and increment of Knuth's MMIX (The Art of Computer Programming, vol. 2, sec. 3.3.4,
                 table 1), modulo 2^63 in signed arithmetic
        Checked  tests/net_capture/test_free_flight.py
        """
        mass = node_plane(p, work, MASS)
        state = p.solver_seed * 2 + 1
        for axis in range(3):
            positions = node_plane(p, work, X + axis)
            amplitude = p.solver_jitter[axis]
            if amplitude != 0.0:
                for i in range(positions.size):
                    if mass[i] > 0.0:
                        state = (state * 6364136223846793005 + 1442695040888963407) & 0x7FFFFFFFFFFFFFFF
                        positions[i] += amplitude * (2.0 * ((state >> 10) / 9007199254740992.0) - 1.0)

    @kernel
    def shoot(p, work):
        """Every node moves with the chaser, and a bullet away from it, along the diagonal to its place in the open net.

        Checked  tests/net_capture/test_free_flight.py; test_folding.py: what the chaser is turned by
        """
        mass = node_plane(p, work, MASS)
        for axis in range(3):
            velocity = node_plane(p, work, U + axis)
            for i in range(p.node_slots):
                velocity[i] = p.chaser_start_velocity[axis] if mass[i] > 0.0 else 0.0
        if books_turn:
            for axis in range(3):
                p.chaser_turned[axis] = 0.0
        if has_spin:
            spin(p, work)
        if has_ejection:
            aim_each(p, work)
            return
        forward = p.bullets_speed * math.cos(p.bullets_angle)
        outward = p.bullets_speed * math.sin(p.bullets_angle)
        place, given, turn = p.scratch[0:3], p.scratch[3:6], p.scratch[6:9]
        for corner in range(p.net_corners):
            node = bullets(p, work)[corner]
            along = 1.0 * node_plane(p, work, SHOWN)[node]
            across = 1.0 * node_plane(p, work, SHOWN + 1)[node]
            diagonal = math.sqrt(along * along + across * across)
            for axis in range(3):
                away = (along * p.axes[axis] + across * p.axes[3 + axis]) / diagonal
                given[axis] = forward * p.axes[6 + axis] + outward * away
                node_plane(p, work, U + axis)[node] += given[axis]
            if books_turn:
                for axis in range(3):
                    place[axis] = node_plane(p, work, X + axis)[node] - p.muzzle[axis]
                cross(turn, place, given)
                for axis in range(3):
                    p.chaser_turned[axis] -= mass[node] * turn[axis]

    return Shot(load, jitter, shoot)


def opening_distance(radius: float, folded: float, speed: float, angle: float) -> float:
    """Distance [m] flown by the bullets when, unhindered, they have spread to their places in the open mouth.

        z = (R - R0) / tan(alpha)

    radius   R      of the bullets in the open mouth   [m]
    folded   R0     in the folded net                  [m]
    speed    V0     of the bullets                     [m/s]
    angle    alpha  from the shot axis                 [rad]

    Valid    a lower bound of where the mouth is largest: the net holds the bullets back
    """
    return (radius - folded) / math.tan(angle) if speed > 0.0 and angle > 0.0 else math.inf


def refuses_place(scene: Scene) -> Iterator[Refusal]:
    """A muzzle that no shot can leave."""
    chaser = scene.vector("chaser.start_position")
    if not any(chaser) and not any(scene.vector("shot.axis")):
        expected = "stands in the target's centre of mass, and shot.axis names no direction"
        yield Refusal("chaser.start_position", text(chaser, " m"), expected)


def refuses_way(scene: Scene) -> Iterator[Refusal]:
    """Whether the net gets to the target, in time, open, and wide enough."""
    values, duration = scene.values, scene.duration
    chaser, axis = scene.vector("chaser.start_position"), scene.vector("shot.axis")
    shape, net = scene.parts["target"].checks, scene.parts["net"].checks
    sides, open_radius = net.sides(values), math.hypot(*net.corner(values))
    led = at_bullets(net, [scene.parts[group].checks for group in riggings() if group in scene.parts])
    folded = scene.parts["folding"].checks.radius(values, led)
    distance = math.hypot(*chaser)
    here = f"is {distance:.4g} m from the target"
    speed, angle = float(values["bullets.speed"]), float(values["bullets.angle"])
    radius, girth = shape.radius(values), shape.girth(values)
    near = distance - radius
    place, shown = "chaser.start_position", text(chaser, " m")
    tether = values.get("tether.length")
    if tether is not None and tether < near:
        expected = f"must be at least {near:.4g} m, the distance to the target's nearest point"
        yield Refusal("tether.length", f"{tether:g} m", expected)
    if sum(sides) <= girth:
        expected = f"must be more than {girth / len(sides):.4g} m: the mouth must go round the target"
        yield Refusal(net.narrow(values), f"{min(sides):g} m", expected)
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
                f"come within {forward * duration + radius:.4g} m, or raise duration or bullets.speed"
            )
            yield Refusal(place, shown, expected)
        limit = FALLEN_BACK * opening_distance(math.hypot(*led.corner(values)), folded, speed, angle)
        if near > limit:
            expected = f"{here}; must be at most {limit + radius:.4g} m: farther out the net has fallen back"
            yield Refusal(place, shown, f"{expected} on itself")
    length = math.hypot(*axis)
    if length > 0.0 and distance > 0.0:
        along = -sum(a * c for a, c in zip(axis, chaser, strict=True)) / length
        beside = math.sqrt(max(distance * distance - along * along, 0.0))
        widest = open_radius + radius
        if along <= 0.0:
            expected = f"points away from the target, which lies along {text([0.0 - c / distance for c in chaser])}"
            yield Refusal("shot.axis", text(axis), expected)
        elif beside > widest:
            expected = f"passes {beside:.4g} m beside the target's centre; must be within {widest:.4g} m of it"
            yield Refusal("shot.axis", text(axis), expected)
