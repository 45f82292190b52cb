"""What must hold of a shot: its energy book from both sides, momentum, free flight, and nothing inside the target."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from dcone_cosim import build
from dcone_cosim.appendage import ANGLE
from dcone_cosim.contract import bullets
from dcone_cosim.criteria import Criterion, Evidence, finite, rise
from dcone_cosim.quantities import Array

ACCURATE, STABLE = 0.01, 0.05
"""Shares of the energy that came in by which the book may be off."""
ROUNDING = {"double": (1e-9, 1e-7), "single": (1e-4, 1e-2)}
"""Shares of momentum by which it may change, accurate and stable, by the bits of a number: a velocity is rounded once a
substep, by 2^-53 or 2^-24 of it at most, so that 160,000 substeps of one sign come to a hundredth with 24 bits."""
FALLING = ("uniform", "history")
"""Gravities that give energy to a net in free flight."""
ON_GRID = 1.1e-3
"""Share of a substep by which a communication point may miss the grid and still be taken for on it, and a little."""
BOOKED = {"double": 2e-6}
"""Shares of the energy below which what the book leaves over may be rounding, by the bits of a number; with those that
are not here rounding is as large as a scheme's own error, and its order cannot be seen."""
DEPTH, DEEPEST = 2e-3, 2e-2
"""How deep a node may lie below the target's surface [m]: that up to which it counts as on it, and ten times that."""
CATCH, SHOT, STRENGTH = "catch", "shot.momentum", "thread.axial_stiffness"


def criteria(evidence: Evidence) -> Iterator[Criterion]:
    """All that can be asked of these outputs."""
    yield finite(evidence)
    if len(evidence.columns["time"]) < 2:
        return
    yield from _step(evidence)
    yield from _book(evidence)
    yield from _momentum(evidence)
    yield from _flight(evidence)
    yield from _stretch(evidence)
    yield from _depth(evidence)
    yield from _through(evidence)
    yield from _hull(evidence)


def _step(evidence: Evidence) -> Iterator[Criterion]:
    """The substep within the bound of stability that the model tells; of one that follows the net, the model's own
    account of what was taut."""
    if evidence.has("solver.margin_least"):
        over = max(0.0, 1.0 / float(np.min(evidence.columns["solver.margin_least"])) - 1.0)
        yield Criterion("bound", "substep above the bound of what was taut", over, "1", 1e-9, 1e-9)
    elif evidence.has("solver.substep", "solver.stability_bound"):
        ratio = float(np.max(evidence.columns["solver.substep"] / evidence.columns["solver.stability_bound"]))
        yield Criterion("bound", "substep above the bound of stability", max(0.0, ratio - 1.0), "1", 1e-9, 1e-9)


def _book(evidence: Evidence) -> Iterator[Criterion]:
    """The book of energy, and what is in it: nothing that takes energy gives any back."""
    columns = evidence.columns
    if not evidence.has("energy.kinetic"):
        return
    size = build.energy_entered(columns)
    if not size[0] > 0.0:
        return
    if evidence.has("energy.remainder"):
        left = columns["energy.remainder"] / size
        gained, lost = float(np.max(-left)), float(np.max(left))
        yield Criterion("energy_gained", "energy gained from nowhere", gained, "1", ACCURATE, STABLE)
        yield Criterion("energy_lost", "energy lost to nothing", lost, "1", ACCURATE, STABLE)
    for name, label in (
        ("thread.dissipated", "threads' dashpots"),
        ("cord.dissipated", "cord's dashpots"),
        ("contact.loss", "contact"),
        ("self_contact.loss", "contact of threads with each other"),
    ):
        if evidence.has(name):
            back = rise(-columns[name]) / float(size[-1])
            yield Criterion(
                f"{name.partition('.')[0]}_takes", f"energy given by the {label}", back, "1", 1e-3, ACCURATE
            )
    alone = not {"closing", "contact", "tether"} & evidence.terms.keys()
    if evidence.has("energy.total") and alone and evidence.terms.get("gravity") not in FALLING:
        # a net in free flight, whatever the book says, but for bullets that leave later
        total = columns["energy.total"]
        if evidence.has("ejection.work"):
            total = total - columns["ejection.work"]
        risen = rise(total) / size[0]
        yield Criterion("energy_rises", "energy of the flying net above what it was", risen, "1", ACCURATE, STABLE)


def spacing(evidence: Evidence) -> Array:
    """Distance [m] of neighbouring numbers of 24 bits at the farthest coordinate of a bullet, at each instant."""
    names = [f"bullet[{bullet}].position[{axis}]" for bullet in bullets(evidence.columns) for axis in (1, 2, 3)]
    farthest = np.max([np.abs(evidence.columns[name]) for name in names], axis=0)
    return np.asarray(np.spacing(farthest.astype(np.float32)), dtype=float)


def _is_free(evidence: Evidence) -> bool:
    """Whether nothing acts from outside: no gravity, and no air."""
    return evidence.terms.get("gravity") == "none" and "air" not in evidence.terms


def _momentum(evidence: Evidence) -> Iterator[Criterion]:
    """Of all bodies, in a frame that does not turn: as it was, whatever net, target and reels do, but for a test load's
    impulse."""
    if not _is_free(evidence) or not evidence.has("momentum", "angular_momentum", CATCH + ".mass"):
        return
    accurate, stable = ROUNDING[evidence.terms.get("precision", "double")]
    size = shot_momentum(evidence)
    if not size > 0.0:
        return
    momentum, moment = evidence.vector("momentum"), evidence.vector("angular_momentum")
    if evidence.has("pull_off.impulse"):
        momentum, moment = (
            momentum - evidence.vector("pull_off.impulse"),
            moment - evidence.vector("pull_off.angular_impulse"),
        )
    change = np.linalg.norm(momentum - momentum[0], axis=1).max()
    yield Criterion("momentum", "momentum of all bodies", float(change) / size, "1", accurate, stable)
    arm = max(np.linalg.norm(evidence.vector("catch.position"), axis=1).max(), 1.0)
    turned = np.linalg.norm(moment - moment[0], axis=1).max()
    label = "angular momentum of all bodies"
    yield Criterion("angular_momentum", label, float(turned) / (size * float(arm)), "1", accurate, stable)


def _is_held_back(evidence: Evidence) -> bool:
    """Whether something couples net and chaser on the way, or bullets leave otherwise than all alike: a tether that
    drags, bullets with errors of their own, a chaser that turns."""
    if evidence.terms.get("tether") == "dragging":
        return True
    own = ("ejection.", "spin.chaser_rate")
    return any(value != 0.0 for name, value in evidence.values.items() if name.startswith(own))


def shot_momentum(evidence: Evidence) -> float:
    """Of the bullets as they leave, in closed form [N s]."""
    rows = build.implied("net_capture", evidence.values, evidence.terms)
    return next((row.value for row in rows if row.key == SHOT), 0.0)


def _flight(evidence: Evidence) -> Iterator[Criterion]:
    """Until something touches the net its centre of mass flies straight on, at the speed that the bullets gave it.

    r = r0 + (v0 + P/M a) t,   a the shot's axis, P the momentum of the bullets, M the mass of the catch

    With 24 bits a way is rounded once a substep and once more as it is shown, by half the distance of neighbouring
    numbers at most, whatever the signs; what a kick moves a bullet by is far less than such a number.
    From a canister that holds on to it the net flies on as fast as it leaves.
    """
    values, columns = evidence.values, evidence.columns
    if not _is_free(evidence) or not evidence.has("catch.position", "catch.mass"):
        return
    if values.get("tether.vertex_tension", 0.0) != 0.0 or _is_held_back(evidence):
        return
    start = np.array([values[f"chaser.start_position[{i}]"] for i in (1, 2, 3)])
    drift = np.array([values[f"chaser.start_velocity[{i}]"] for i in (1, 2, 3)])
    axis = np.array([values[f"shot.axis[{i}]"] for i in (1, 2, 3)])
    axis = axis if axis.any() else -start
    time, place, first = columns["time"], evidence.vector("catch.position"), 0
    touched = columns["contact.first_time"] if "contact.first_time" in columns else np.full(len(time), -1.0)
    free = touched < 0.0
    if evidence.has("pull_off.impulse"):
        free &= ~evidence.vector("pull_off.impulse").any(axis=1)
    speed = shot_momentum(evidence) / columns["catch.mass"][0]
    velocity = drift + speed * axis / np.linalg.norm(axis)
    if "wall" in evidence.terms:
        left = np.flatnonzero(free & (columns["wall.stowed"] == 0))
        if len(left) < 2:
            return
        first = int(left[0])
        velocity = evidence.vector("catch.velocity")[first]
    since = time - time[first]
    free &= since >= 0.0
    way = np.linalg.norm(place - place[first] - velocity * since[:, None], axis=1)[free]
    flown = max(float(np.linalg.norm(velocity)) * float(since[free][-1]), 1e-9)
    accurate, stable = ROUNDING[evidence.terms.get("precision", "double")]
    if evidence.terms.get("precision") == "single" and evidence.has("solver.substep", "bullet[1].position"):
        substeps = float(time[free][-1]) / float(np.min(columns["solver.substep"]))
        stable = 0.5 * float(spacing(evidence)[free].max()) * (substeps + 1.0) / flown
    off = max(0.0, float(way.max()) - ON_GRID * _substep(evidence) * float(np.linalg.norm(velocity))) / flown
    yield Criterion("flight", "way of the catch from a straight line", off, "1", accurate, stable)


def _stretch(evidence: Evidence) -> Iterator[Criterion]:
    """The rim is no longer than all energy that came in can stretch it, whatever a scheme books.

        sum EA/(2 a) max(0, s - a)^2 <= E,   s between two bullets, a of the net's side between them, E what came in

    A side of many threads holds at least as much as one thread of its length that reaches from bullet to bullet.
    """
    names = [f"bullet[{bullet}].position" for bullet in bullets(evidence.columns)]
    sides = build.mouth_sides(evidence.values, evidence.terms)
    if not names or len(sides) != len(names) or "leads" in evidence.terms or not evidence.has("energy.kinetic"):
        return
    rows = build.implied("net_capture", evidence.values, evidence.terms)
    strength = next(row.value for row in rows if row.key == STRENGTH)
    corners = [evidence.vector(name) for name in names]
    held = np.zeros(len(evidence.columns["time"]))
    for number, side in enumerate(sides):
        apart = np.linalg.norm(corners[(number + 1) % len(corners)] - corners[number], axis=1)
        held += 0.5 * strength / side * np.maximum(apart - side, 0.0) ** 2
    came = build.energy_entered(evidence.columns)
    beyond = float(np.max(np.maximum(held - came, 0.0) / np.maximum(came, 1e-300)))
    label = "energy that the rim's stretch alone holds, above what came in"
    yield Criterion("stretch", label, beyond, "1", ACCURATE, STABLE)


def _substep(evidence: Evidence) -> float:
    """The longest in use [s]; 0 where it is not told."""
    return float(np.max(evidence.columns["solver.substep"])) if evidence.has("solver.substep") else 0.0


def _depth(evidence: Evidence) -> Iterator[Criterion]:
    """The deepest that a node lay below the target's surface, by the shape as it is drawn, at the angle of its hinge.

    Checked  tests/cosim/test_hinged_panel.py
    """
    if "contact" not in evidence.terms or not evidence.nodes or not evidence.has("target.attitude", "target.position"):
        return
    distance = build.target_distance(evidence.values, evidence.terms)
    if distance is None:
        return
    places, attitudes = evidence.vector("target.position"), evidence.vector("target.attitude", 4)
    deepest = 0.0
    for row, nodes in evidence.nodes.items():
        body = (nodes - places[row]) @ matrix(attitudes[row])
        reach = math.inf if not len(body) else float(np.abs(body).max())
        near = body if reach < math.inf else body[:0]
        angle = float(evidence.columns[ANGLE][row]) if evidence.has(ANGLE) else 0.0
        values = build.target_at(evidence.values, evidence.terms, angle)
        for point in near:
            deepest = min(deepest, distance(values, point.tolist()))
    give = _give(evidence)
    label = "deepest node below the target's surface"
    yield Criterion("depth", label, -deepest, "m", DEPTH + 2.0 * give, DEEPEST + 10.0 * give)


def _through(evidence: Evidence) -> Iterator[Criterion]:
    """No thread goes through a target round whose edges threads bend, as far as is known of slack ones."""
    if evidence.has("wrap.passed", "wrap.passed_slack"):
        passed = float(evidence.columns["wrap.passed"][-1] + evidence.columns["wrap.passed_slack"][-1])
        yield Criterion("through", "threads that went through the target", passed, "threads", 0.0, 0.0)


def _hull(evidence: Evidence) -> Iterator[Criterion]:
    """No body holds more than a ball of its surface, and a distance between two points is that of the points.

    36 pi V^2 <= S^3

    Source   isoperimetric inequality
    """
    columns = evidence.columns
    if not evidence.has("quality.hull_volume", "quality.hull_surface"):
        return
    surface, volume = columns["quality.hull_surface"], columns["quality.hull_volume"]
    there = surface > 0.0
    fuller = 36.0 * math.pi * volume[there] ** 2 / surface[there] ** 3 - 1.0
    beyond = max(float(np.max(fuller, initial=0.0)), float(np.max(-volume, initial=0.0)))
    yield Criterion("hull", "hull that holds more than a ball of its surface", beyond, "1", 1e-9, 1e-6)
    if evidence.has("quality.offset", "catch.position", "target.position"):
        apart = np.linalg.norm(evidence.vector("catch.position") - evidence.vector("target.position"), axis=1)
        off = float(np.max(np.abs(columns["quality.offset"] - apart)))
        yield Criterion("offset", "offset of net and target from that of their positions", off, "m", 1e-9, 1e-6)


def _give(evidence: Evidence) -> float:
    """How deep a bullet goes into a surface with a spring at the speed of the shot [m].

    v sqrt(m/c), or v t/pi where all contacts last t; 0 at a surface without one
    """
    values = evidence.values
    if "contact.duration" not in values:
        return 0.0
    if values["contact.stiffness"] > 0.0:
        return float(values["bullets.speed"] * math.sqrt(values["bullets.mass"] / values["contact.stiffness"]))
    return float(values["bullets.speed"] * values["contact.duration"] / math.pi)


def matrix(quaternion: Array) -> Array:
    """Rotation from body to frame (3, 3) of a unit quaternion, scalar first."""
    w, x, y, z = quaternion
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )
