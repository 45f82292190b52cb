"""The term of a hinged appendage: what a scene says of it, and what goes with it."""

from __future__ import annotations

import math
from collections.abc import Iterator

from fmu_src.extremes import Extreme
from fmu_src.interface import Term
from fmu_src.net_capture.appendage.laying import lay, lightest
from fmu_src.net_capture.hinge.motion import FASTEST, TOO_FAST, TURNS_TOO_FAST
from fmu_src.net_capture.hinge.numbers import BODY, MOST_PIECES
from fmu_src.net_capture.hinge.numbers import LIMIT as AT_LIMIT
from fmu_src.net_capture.refusal import Refusal, Scene, text
from fmu_src.net_capture.shapes.union import WORDS
from fmu_src.rows import angle, at_least_zero, count, output, parameter, peak, state, vector
from fmu_src.tables import Table

LIMIT = 0.5 * math.pi
"""Largest angle unless the scene says otherwise: a wing that lies along the body's wall."""

ROWS = (
    at_least_zero("hinge.stiffness", "N.m/rad", "spring of the hinge, relaxed as the target is drawn", 0.0),
    at_least_zero("hinge.damping", "N.m.s/rad", "dashpot of the hinge", 0.0),
    angle("hinge.start_angle", "angle at the start, from the target as it is drawn", 0.0, -math.pi, math.pi),
    parameter(
        "hinge.start_rate",
        "rad/s",
        "at which it turns at the start, relative to the rest of the target",
        0.0,
        display_unit="deg/s",
    ),
    output(
        "hinge.angle", "rad", "of the appendage from the target as it is drawn", rate="hinge.rate", display_unit="deg"
    ),
    output("hinge.rate", "rad/s", "of that angle", display_unit="deg/s"),
    output("hinge.energy", "J", "in the spring of the hinge"),
    peak("hinge.loss", "J", "taken so far by its dashpot, and by its stops"),
    output("target.reach", "m", "farthest point of the target from its centre of mass, at any angle", discrete=True),
    vector("target.inertia", "kg.m2", "about the body axes, of the whole as it is now"),
    vector("target.products", "kg.m2", "its products of inertia, as elements 12, 13, 23 of the tensor"),
    state("hinge_now[#]", "1", "attitude, cosine, sine, angle, momentum [N.m.s] and loss [J]", shape=(9,)),
    state("hinge_steps[#][#]", "1", "room of the integration", shape=(3, 9)),
    state("hinge_rates[#]", "rad/s", "of the rest of the target, in its axes, and of the hinge", shape=(4,)),
    state("hinge_speed", "rad/s", "rate of the hinge in contact"),
    state("hinge_inverse[#][#]", "1/(kg.m2)", "inverse of the matrix of the masses", shape=(4, 4)),
    state("hinge_whole[#][#]", "kg.m2", "inertia of the whole, body axes", shape=(3, 3)),
    state("hinge_own[#][#]", "kg.m2", "inertia of the appendage, body axes", shape=(3, 3)),
    state("hinge_small[#][#]", "1/(kg.m2)", "inverse of that of the whole", shape=(3, 3)),
    state("hinge_coupling[#]", "kg.m2", "how the rate of the hinge enters the angular momentum", shape=(3,)),
    state("hinge_eased[#]", "1", "rate of the rest per rate of the hinge without angular momentum", shape=(3,)),
    state("hinge_shift[#]", "m", "centre of mass of the whole, from that at angle 0, body axes", shape=(3,)),
    state("hinge_recoil[#]", "m", "way of that centre in the body axes per radian", shape=(3,)),
    state("hinge_gain[#]", "1/(kg.m)", "rates that an impulse gives", shape=(4,)),
    state("hinge_lever", "m", "way of the point touched along the impulse, per radian"),
    count("hinge_touched", "whether the point of the surface found last is the appendage's; -1: not asked", "state"),
    state("hinge_gap", "m", "distance of the point asked of last"),
    state("hinge_found[#][#]", "1", "normal of the surface there, and that point [m], body axes", shape=(2, 3)),
    state("hinge_point[#]", "m", "point touched, from the centre of mass, body axes", shape=(3,)),
    state("hinge_local[#]", "1", "direction of an impulse, body axes", shape=(3,)),
    state("hinge_moved[#]", "m/s", "velocity of a point by the swing, frame axes", shape=(3,)),
    state("hinge_room[#][#]", "1", "room for vectors", shape=(8, 3)),
    state("hinge_rows[#][#]", "1", "pieces of the target as they are now", shape=(MOST_PIECES, WORDS + 1)),
)
ASKED = (
    vector("hinge.position", "m", "a point of the hinge's axis, in the target's design axes", "parameter"),
    vector(
        "hinge.axis", "1", "direction of the hinge, design axes, of any length: it turns to the right about it",
        "parameter", (1.0, 0.0, 0.0),
    ),
    angle("hinge.limit", "largest angle to both sides, where it is stopped without a rebound", LIMIT, 0.0, math.pi),
)  # fmt: skip


EXTREMES = (
    Extreme("hinge spring of 1e9 N m/rad", "the appendage is all but rigid, its spring thousands of times as fast as "
            "the net", "energy_gained", {"hinge.stiffness": 1e9}, chief=True),
    Extreme("hinge dashpot of 1e4 N m s/rad", "the appendage creeps", "energy_gained", {"hinge.damping": 1e4}),
    Extreme("hinge dashpot beyond what is followed", "it would take no end of steps", "finite",
            {"hinge.damping": 1e12}),
    Extreme("hinge without spring and dashpot", "nothing holds the appendage but its stops", "energy_gained",
            {"hinge.stiffness": 0.0, "hinge.damping": 0.0}),
    Extreme("hinge at 180 deg/s", "the appendage strikes its stop, and the net faster than that flies",
            "energy_gained", {"hinge.start_rate": math.pi}, chief=True),
)  # fmt: skip


def refuses(scene: Scene) -> Iterator[Refusal]:
    """Moments that the two bodies have not, a start beyond the stops, and a hinge faster than can be followed."""
    told = scene.vector("target.principal_inertia")
    if any(told):
        expected = "must be left out: with [capture.hinge] they follow from the pieces of both bodies"
        yield Refusal("target.principal_inertia", text(told, " kg m2"), expected)
    limit, start = (
        float(scene.values[BODY][AT_LIMIT]) if BODY in scene.values else math.pi,
        scene.values["hinge.start_angle"],
    )
    for name, turning in (
        ("hinge.start_rate", [float(scene.values["hinge.start_rate"])]),
        ("target.start_rate", scene.vector("target.start_rate")),
    ):
        if math.hypot(*turning) > FASTEST:
            told = [math.degrees(one) for one in turning]
            expected = f"must be at most {math.degrees(FASTEST):.3g} deg/s beside a hinge, whose steps follow it"
            yield Refusal(name, text(told, " deg/s") if len(told) > 1 else f"{told[0]:g} deg/s", expected)
    if abs(start) > limit:
        expected = f"must be within hinge.limit, {math.degrees(limit):.4g} deg"
        yield Refusal("hinge.start_angle", f"{math.degrees(start):.4g} deg", expected)
    if BODY in scene.values:
        moment = float(scene.values["target.mass"]) * lightest(scene.values[BODY])
        for name, unit, most in (
            ("stiffness", "N m/rad", FASTEST**2 * moment),
            ("damping", "N m s/rad", FASTEST * moment),
        ):
            if (given := float(scene.values[f"hinge.{name}"])) > most:
                expected = (
                    f"must be at most {most:.3g} {unit}: on {moment:.3g} kg m2, what the hinge feels at least, it is "
                    f"faster than {FASTEST:g} 1/s (leave [capture.hinge] out for a rigid target)"
                )
                yield Refusal(f"hinge.{name}", f"{given:.6g} {unit}", expected)


PART = Term(
    "an appendage of the target that swings about a hinge with a spring and a dashpot",
    ROWS,
    needs=("target",),
    excludes=("wrap",),
    because=": threads bend round bodies that do not move against one another; leave [capture.wrap] out, and nodes "
    "alone touch, or [capture.hinge] and each `hinged = true`, and the target is one rigid body",
    carries={"target": ("union",)},
    tables=(Table(BODY, "1", "masses of both bodies, the hinge, what holds at any angle, and what belongs to which"),),
    asked=ASKED,
    lay=lay,
    faults=(TOO_FAST, TURNS_TOO_FAST),
    make=lambda composition: None,
    refuses=refuses,
    extremes=EXTREMES,
)
