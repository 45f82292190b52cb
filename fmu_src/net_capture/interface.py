"""The variables of the net capture model, term by term, and what a scene may choose."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from fmu_src.interface import Fault, Group, Model, Term, Variable
from orbital.constants import EARTH_EQUATORIAL_RADIUS

OUTCOMES = ("flying", "captured", "settled", "missed", "slipped_off", "not_closed", "tether_taut")
TRIGGERS = ("time", "first_contact", "distance", "command")
LARGEST_MESH = 400
"""Meshes times segments per side: an instance then takes 30 MB."""


def _vector(name: str, unit: str, description: str, causality: str = "output", start: object = 0.0) -> Variable:
    return Variable(f"{name}[#]", unit, causality, description, start, shape=(3,))  # type: ignore[arg-type]


def _out(name: str, unit: str, description: str, **more: object) -> Variable:
    return Variable(name, unit, "output", description, **more)  # type: ignore[arg-type]


def _state(name: str, unit: str, description: str, **more: object) -> Variable:
    return Variable(name, unit, "state", description, **more)  # type: ignore[arg-type]


def _positive(name: str, unit: str, description: str, start: float, **more: object) -> Variable:
    return Variable(name, unit, "parameter", description, start, minimum=0.0, open_minimum=True, **more)  # type: ignore[arg-type]


def _at_least_zero(name: str, unit: str, description: str, start: float, **more: object) -> Variable:
    return Variable(name, unit, "parameter", description, start, minimum=0.0, **more)  # type: ignore[arg-type]


def _flag(name: str, description: str) -> Variable:
    return Variable(name, "1", "output", description, False, kind="Boolean")


def _count(name: str, description: str, causality: str = "output") -> Variable:
    return Variable(name, "1", causality, description, 0, kind="Integer", minimum=0)  # type: ignore[arg-type]


BASE = (
    _positive("bullets.mass", "kg", "mass of each of the four bullets", 0.5),
    _at_least_zero("bullets.speed", "m/s", "speed at which the bullets leave", 3.0),
    Variable(
        "bullets.angle",
        "rad",
        "parameter",
        "angle of the bullets from the shot axis, outward along the diagonals",
        math.radians(40.0),
        minimum=0.0,
        maximum=math.pi / 2,
        display_unit="deg",
    ),
    _at_least_zero("vertex.mass", "kg", "mass at the centre of the net, where the tether is made fast", 0.15),
    _positive("chaser.mass", "kg", "mass of the chaser, which takes the recoil", 2000.0),
    _vector(
        "chaser.start_position",
        "m",
        "muzzle at the start, from the target's centre of mass, orbital frame",
        "parameter",
        (0.0, -20.0, 0.0),
    ),
    _vector("chaser.start_velocity", "m/s", "velocity of the chaser before the shot, orbital frame", "parameter"),
    _vector("shot.axis", "1", "direction of the shot, orbital frame; zero: from the chaser to the target", "parameter"),
    Variable("shot.roll", "rad", "parameter", "turn of the net about the shot axis", 0.0, display_unit="deg"),
    Variable(
        "solver.step_ratio",
        "1",
        "parameter",
        "substep as a fraction of the guaranteed stability bound",
        0.9,
        minimum=0.0,
        maximum=1.3,
        open_minimum=True,
    ),
    _vector(
        "solver.jitter", "m", "amplitude of the deterministic jitter of the folded nodes, per shot axis", "parameter"
    ),
    Variable("solver.seed", "1", "parameter", "which jitter, for ensembles of runs", 0, kind="Integer", minimum=0),
    Variable("bullet[#].position[#]", "m", "output", "bullet, orbital frame", shape=(4, 3)),
    Variable("bullet[#].velocity[#]", "m/s", "output", "bullet, orbital frame", shape=(4, 3)),
    _vector("vertex.position", "m", "where the tether is made fast, orbital frame"),
    _vector("vertex.velocity", "m/s", "where the tether is made fast, orbital frame"),
    _vector("chaser.position", "m", "chaser, orbital frame"),
    _vector("chaser.velocity", "m/s", "chaser with its recoil, orbital frame"),
    _out("catch.mass", "kg", "net, bullets and vertex together"),
    _vector("catch.position", "m", "centre of mass of net, bullets and vertex, orbital frame"),
    _vector("catch.velocity", "m/s", "velocity of that centre of mass, orbital frame"),
    _vector(
        "catch.spin",
        "N.m.s",
        "angular momentum of net, bullets and vertex about their centre of mass, "
        "of the velocities seen in the orbital frame",
    ),
    Variable(
        "catch.inertia[#]",
        "kg.m2",
        "output",
        "inertia of net, bullets and vertex about their centre of mass: 11, 22, 33, 12, 13, 23 of the orbital frame",
        shape=(6,),
    ),
    _out("mouth.area", "m2", "area spanned by the bullets, projected on the plane normal to the shot"),
    _out("mouth.area_ratio", "1", "mouth area over the area of the flat net"),
    _out("mouth.area_max", "m2", "largest mouth area so far"),
    _out("mouth.t_max", "s", "when the mouth area was largest"),
    _out("mouth.t80", "s", "when the mouth first exceeded 80 % of the flat net's area; -1 before"),
    _out("mouth.time_above_80", "s", "time the mouth has spent above 80 % of the flat net's area"),
    _out("mouth.depth", "m", "mean distance of the bullets from the muzzle along the shot axis"),
    _out("energy.kinetic", "J", "of net, bullets and vertex, in the orbital frame"),
    _out("energy.elastic", "J", "in the threads (and the closing cord, where there is one)"),
    _out("energy.total", "J", "kinetic and elastic energy of net, bullets, vertex and closing cord"),
    _vector("momentum", "N.s", "linear momentum of all bodies in the scene, orbital frame"),
    _vector("angular_momentum", "N.m.s", "angular momentum of all bodies about the frame's origin, orbital frame"),
    _out("thread.tension_max", "N", "largest tension of any thread since the start"),
    _count("thread.tension_max_index", "which thread that was, counted from 1"),
    _out("thread.tension_peak", "N", "largest tension of any thread over the last macro step"),
    _count("thread.taut", "threads now taut"),
    _flag("closed", "mouth drawn to its locked length"),
    _flag("captured", "the mouth can not pass the target any more"),
    _flag("settled", "the net moves no more relative to the target"),
    _out("t_capture", "s", "instant of capture; -1 before"),
    Variable(
        "outcome",
        "1",
        "output",
        "how the shot stands",
        0,
        kind="Integer",
        minimum=0,
        maximum=len(OUTCOMES) - 1,
        choices=OUTCOMES,
    ),
    _out("solver.substep", "s", "substep in use"),
    _count("solver.steps", "substeps taken"),
    _out("solver.stability_bound", "s", "guaranteed stability bound of the explicit step"),
    _count("net.nodes", "nodes of the net"),
    _count("net.threads", "threads of the net, after cutting into segments"),
    # what the kernels keep
    _count("grid", "substeps since the start", "state"),
    _state("start_time", "s", "start of the integer grid"),
    _state("axes[#]", "1", "shot axes as rows: two transverse, then the axis itself", shape=(9,)),
    _state("muzzle[#]", "m", "muzzle at the start, orbital frame", shape=(3,)),
    _state("thread_length", "m", "rest length of one segment"),
    _state("thread_stiffness", "N/m", "EA / l of one segment"),
    _state("thread_damping", "N.s/m", "dashpot of one segment"),
    _count("knots", "knots per side", "state"),
    _count("strips", "rows of parallel threads", "state"),
    _count("node_slots", "slots in each node plane", "state"),
    _count("thread_slots", "slots in each thread plane", "state"),
    _count("measure_every", "substeps between two looks at mouth and capture", "state"),
    _state("chaser_place[#]", "m", "chaser at the last substep", shape=(3,)),
    _state("chaser_drift[#]", "m/s", "velocity of the chaser half a substep back", shape=(3,)),
    _state("scratch[#]", "1", "small vectors of the kernels", shape=(28,)),
)

NET = {
    "square": Term(
        "planar square net of square meshes",
        (
            _positive("net.side", "m", "side of the flat net", 24.0),
            _positive("net.mesh", "m", "knot spacing: a design choice; the net keeps its mass", 1.0),
            Variable(
                "net.segments",
                "1",
                "parameter",
                "pieces each thread is cut into: a numerical choice",
                1,
                kind="Integer",
                minimum=1,
                maximum=64,
            ),
            _positive("net.mass", "kg", "mass of all threads", 0.33),
            _positive("net.youngs_modulus", "Pa", "of the thread", 70e9, display_unit="GPa"),
            _positive("net.density", "kg/m3", "of the thread", 1440.0),
            _at_least_zero("net.damping_ratio", "1", "xi in d = 2 xi sqrt(k m) of a thread and an inner node", 0.106),
            _positive("net.fold_side", "m", "side of the flat square the net is folded into", 0.5),
        ),
    )
}

GRAVITY = {
    "none": Term("inertial drift"),
    "hill": Term(
        "relative motion about the target's circular orbit",
        (
            Variable(
                "orbit.altitude",
                "m",
                "parameter",
                "of the circular orbit, over the equatorial radius",
                800e3,
                minimum=-0.5 * EARTH_EQUATORIAL_RADIUS,
                display_unit="km",
            ),
            _state("mean_motion", "rad/s", "of the orbital frame"),
        ),
    ),
}

TARGET = {
    "box": Term(
        "free box that takes the reaction of every contact",
        (
            Variable(
                "target.size[#]",
                "m",
                "parameter",
                "edges along the body axes",
                (4.0, 8.0, 4.0),
                shape=(3,),
                minimum=0.0,
                open_minimum=True,
            ),
            _positive("target.mass", "kg", "mass of the target", 1000.0),
            Variable(
                "target.principal_inertia[#]",
                "kg.m2",
                "parameter",
                "about the body axes; zero: uniform box",
                0.0,
                shape=(3,),
                minimum=0.0,
            ),
            Variable(
                "target.start_attitude[#]",
                "1",
                "parameter",
                "quaternion from body to orbital frame, scalar first; zero: aligned",
                0.0,
                shape=(4,),
            ),
            Variable(
                "target.start_rate[#]",
                "rad/s",
                "parameter",
                "body rate in body axes, relative to inertial space",
                0.0,
                shape=(3,),
                display_unit="deg/s",
            ),
            _vector("target.position", "m", "centre of mass, orbital frame"),
            _vector("target.velocity", "m/s", "of the centre of mass, orbital frame"),
            Variable(
                "target.attitude[#]", "1", "output", "quaternion from body to orbital frame, scalar first", shape=(4,)
            ),
            Variable(
                "target.rate[#]",
                "rad/s",
                "output",
                "body rate in body axes, relative to inertial space",
                shape=(3,),
                display_unit="deg/s",
            ),
            Variable("target.inertia[#]", "kg.m2", "output", "about the body axes", shape=(3,)),
            _vector("target.spin", "N.m.s", "angular momentum about the target's centre of mass, orbital axes"),
            _state("target_place[#]", "m", "centre of mass at the last substep", shape=(3,)),
            _state("target_pose[#]", "1", "attitude at the last substep", shape=(4,)),
            _state("girth", "m", "smallest girth"),
            _out("target.energy", "J", "kinetic energy of translation and spin of the target"),
        ),
    )
}

CONTACT = {
    "inelastic": Term(
        "impact that takes the normal velocity relative to the surface",
        (
            Variable(
                "contact.restitution",
                "1",
                "parameter",
                "share of the normal speed that comes back",
                0.0,
                minimum=0.0,
                maximum=1.0,
            ),
            _count("contact.nodes", "nodes now on the surface"),
            _out("contact.first_time", "s", "first touch; -1 before"),
            _out("contact.impulse", "N.s", "sum of the sizes of all impulses so far"),
            _state("half_size[#]", "m", "half the edges of the target", shape=(3,)),
            Variable("target_turn[#][#]", "1", "state", "rotation matrix from body to frame", shape=(3, 3)),
            _state("target_omega[#]", "rad/s", "rate of the target relative to the frame, frame axes", shape=(3,)),
            _state("envelope_radius", "m", "of the sphere around the target"),
            _out("contact.loss", "J", "kinetic energy lost in contact so far"),
        ),
    )
}

CLOSING = {
    "winches": Term(
        "cord between neighbouring bullets, drawn by winches that stall and never pay out",
        (
            Variable(
                "closing.trigger",
                "1",
                "parameter",
                "what starts the winches; close.command always does",
                0,
                kind="Integer",
                minimum=0,
                maximum=len(TRIGGERS) - 1,
                choices=TRIGGERS,
            ),
            _at_least_zero("closing.time", "s", "when the winches start, for trigger time", 11.2),
            Variable(
                "closing.distance",
                "m",
                "parameter",
                "bullets this far beyond the target's centre of mass, along "
                "the shot axis, start the winches, for trigger distance",
                0.0,
            ),
            _at_least_zero("closing.delay", "s", "from the trigger to the start of the winches", 0.0),
            _positive("closing.speed", "m/s", "no-load speed of each winch: a 24 m side in 5 s", 5.0),
            _positive("closing.stall_force", "N", "tension at which a winch stands still", 10.0),
            _positive("closing.axial_stiffness", "N", "EA of the cord: 0.5 mm nylon", 903.0),
            _at_least_zero("closing.damping_ratio", "1", "of the cord between two bullets", 0.106),
            _positive("closing.lock_length", "m", "a pair is locked when its cord is shorter than this", 0.25),
            _positive(
                "closing.timeout", "s", "after this long since the trigger an open mouth counts as not closed", 20.0
            ),
            Variable("close.command", "1", "input", "start the winches", False, kind="Boolean"),
            _out("mouth.cord_length", "m", "length of cord still out: the perimeter the mouth can not exceed"),
            _out("mouth.girth", "m", "smallest girth of the target, which the mouth would have to pass"),
            _count("mouth.locked_pairs", "pairs of bullets whose cord is shorter than the lock length"),
            _out("cord.tension_max", "N", "largest tension of the cord since the start"),
            _out("cord.tension_peak", "N", "largest tension of the cord over the last macro step"),
            _out("closing.work", "J", "work done by the winches so far"),
            _out("closing.t_start", "s", "when the winches started; -1 before"),
            _state("cord_length[#]", "m", "cord out between neighbouring bullets", shape=(4,)),
            _state("trigger_time", "s", "when the trigger fell; -1 before"),
        ),
    )
}

TETHER = {
    "slack": Term(
        "tether that pays out freely; a tension signal may be injected where it is made fast",
        (
            _positive("tether.length", "m", "length that can be paid out", 100.0),
            Variable("tether.vertex_tension", "N", "input", "tension at the vertex, towards the chaser"),
            _out("tether.paid_out", "m", "distance from the chaser to the vertex"),
        ),
    )
}

SETTLING = {
    "speed": Term(
        "when the net counts as settled",
        (
            _positive("settling.speed", "m/s", "speed of the net's centre of mass relative to the target", 0.1),
            _positive("settling.time", "s", "how long it must stay below", 2.0),
            _state("calm_since", "s", "since when the net has been slow"),
        ),
    )
}


class _NodeTerms(Mapping[str, Term]):
    """A term for any number of nodes: `{"nodes": "625"}` gives an FMU with outputs for up to 625 nodes."""

    def __getitem__(self, capacity: str) -> Term:
        if not capacity.isdigit() or int(capacity) < 1:
            raise KeyError(capacity)
        position = Variable(
            "node[#].position[#]",
            "m",
            "output",
            "node of the net, orbital frame, row by row of the "
            "flat net (knots first, then the inner nodes of the threads)",
            shape=(int(capacity), 3),
        )
        return Term(f"position of every node, up to {capacity} nodes", (position,))

    def __contains__(self, capacity: object) -> bool:
        return isinstance(capacity, str) and capacity.isdigit() and int(capacity) > 0

    def __iter__(self) -> Iterator[str]:
        return iter(("a number of nodes",))

    def __len__(self) -> int:
        return 1


FAULTS = (
    Fault(1, "error", "the state of the net is no longer finite: lower solver.step_ratio or the stiffness"),
    Fault(2, "error", "net.side must be a whole number of net.mesh, at least 2"),
    Fault(3, "error", "the net has more nodes than this FMU gives outputs for: build it with a larger capacity"),
    Fault(4, "error", "the net has too many meshes times segments per side"),
    Fault(5, "error", "the chaser stands in the target's centre of mass, and shot.axis names no direction"),
    Fault(6, "error", "net.fold_side must be smaller than net.side"),
    Fault(7, "error", "target.start_attitude is not a quaternion of unit length (nor zero)"),
    Fault(8, "error", "the principal inertias of the target break the triangle inequality"),
    Fault(9, "error", "chaser.start_position: the folded net would begin inside the target"),
)

MODEL = Model(
    name="net_capture",
    summary="A net is shot from a chaser, opens, wraps a free target and closes.",
    base=BASE,
    groups={
        "net": Group(NET, selector="shape"),
        "gravity": Group(GRAVITY),
        "target": Group(TARGET, selector="shape", optional=True),
        "contact": Group(CONTACT, optional=True),
        "closing": Group(CLOSING, selector="drive", optional=True),
        "tether": Group(TETHER, selector="state", optional=True),
        "settling": Group(SETTLING, selector="by", optional=True),
        "nodes": Group(_NodeTerms(), selector="capacity", optional=True),
    },
    faults=FAULTS,
    module="fmu_src.net_capture.model",
)
