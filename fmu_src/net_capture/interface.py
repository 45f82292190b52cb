"""The variables every net capture has, its terms, and its faults."""

from __future__ import annotations

import math

from fmu_src.interface import Fault, Group, Model, Variable
from fmu_src.net_capture.reach import nodes_of
from fmu_src.net_capture.terms import (
    CLOSING,
    CONTACT,
    GRAVITY,
    NET,
    SETTLING,
    TARGET,
    TETHER,
    NodeTerms,
    at_least_zero,
    count,
    flag,
    moving,
    output,
    peak,
    positive,
    state,
    vector,
)
from fmu_src.net_capture.terms import LARGEST_MESH as LARGEST_MESH

OUTCOMES = ("flying", "captured", "settled", "missed", "slipped_off", "not_closed", "tether_taut")

(
    NOT_FINITE,
    NO_WHOLE_MESHES,
    TOO_MANY_NODES,
    TOO_FINE,
    NO_AXIS,
    FOLD_TOO_LARGE,
    NO_QUATERNION,
    NO_INERTIA,
    INSIDE_TARGET,
    STEP_TOO_SMALL,
    TOO_MANY_RINGS,
) = range(1, 12)

BASE = (
    positive("bullets.mass", "kg", "mass of each of the four bullets", 0.5),
    at_least_zero("bullets.speed", "m/s", "speed at which the bullets leave", 3.0),
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
    at_least_zero("vertex.mass", "kg", "mass at the centre of the net, where the tether is made fast", 0.15),
    positive("chaser.mass", "kg", "mass of the chaser, which takes the recoil", 2000.0),
    vector(
        "chaser.start_position",
        "m",
        "muzzle at the start, from the target's centre of mass, orbital frame",
        "parameter",
        (0.0, -20.0, 0.0),
    ),
    vector("chaser.start_velocity", "m/s", "velocity of the chaser before the shot, orbital frame", "parameter"),
    vector("shot.axis", "1", "direction of the shot, orbital frame; zero: from the chaser to the target", "parameter"),
    Variable("shot.roll", "rad", "parameter", "turn of the net about the shot axis", 0.0, display_unit="deg"),
    Variable(
        "solver.step_ratio",
        "1",
        "parameter",
        "substep as a share of the guaranteed stability bound; zero: as large as keeps the mouth area within 0.3 % and "
        "the energy within 1 %, by the damping",
        0.0,
        minimum=0.0,
        maximum=1.3,
    ),
    vector(
        "solver.jitter", "m", "amplitude of the deterministic jitter of the folded nodes, per shot axis", "parameter"
    ),
    Variable("solver.seed", "1", "parameter", "which jitter, for ensembles of runs", 0, kind="Integer", minimum=0),
    output(
        "bullet[#].position[#]",
        "m",
        "bullet, orbital frame",
        shape=(4, 3),
        nominal=10.0,
        rate="bullet[#].velocity[#]",
    ),
    output("bullet[#].velocity[#]", "m/s", "bullet, orbital frame", shape=(4, 3), nominal=1.0),
    *moving("vertex", "where the tether is made fast, orbital frame", "where the tether is made fast, orbital frame"),
    *moving("chaser", "chaser, orbital frame", "chaser with its recoil, orbital frame"),
    peak("catch.mass", "kg", "net, bullets and vertex together"),
    *moving(
        "catch",
        "centre of mass of net, bullets and vertex, orbital frame",
        "velocity of that centre of mass, orbital frame",
    ),
    vector(
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
    output("mouth.area", "m2", "area spanned by the bullets, projected on the plane normal to the shot", nominal=100.0),
    output("mouth.area_ratio", "1", "mouth area over the area of the flat net"),
    peak("mouth.area_max", "m2", "largest mouth area so far"),
    peak("mouth.t_max", "s", "when the mouth area was largest, since the shot"),
    peak("mouth.t80", "s", "when the mouth first exceeded 80 % of the flat net's area, since the shot; -1 before"),
    output("mouth.time_above_80", "s", "time the mouth has spent above 80 % of the flat net's area"),
    output("mouth.depth", "m", "mean distance of the bullets from the muzzle along the shot axis", nominal=10.0),
    output("energy.kinetic", "J", "of net, bullets and vertex, in the orbital frame"),
    output("energy.elastic", "J", "in the threads (and the closing cord, where there is one)"),
    output("energy.total", "J", "kinetic and elastic energy of net, bullets, vertex and closing cord"),
    output("thread.dissipated", "J", "taken by the threads' dashpots so far"),
    output(
        "energy.remainder",
        "J",
        "what the energy book of all bodies leaves over: energy at the start, and work of winches and reel, less what "
        "contact and dashpots took, less the energy now. The scheme's own error",
    ),
    vector("momentum", "N.s", "linear momentum of all bodies in the scene, orbital frame"),
    vector("angular_momentum", "N.m.s", "angular momentum of all bodies about the frame's origin, orbital frame"),
    peak("thread.tension_max", "N", "largest tension of any thread since the start"),
    count("thread.tension_max_index", "which thread that was, counted from 1"),
    peak("thread.tension_peak", "N", "largest tension of any thread over the last macro step"),
    count("thread.taut", "threads now taut"),
    flag("closed", "mouth drawn to its locked length"),
    flag("captured", "the mouth is closed behind the target, and the target has not come out since"),
    flag("settled", "the net moves no more relative to the target"),
    peak("t_capture", "s", "instant of capture, since the shot; -1 before"),
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
    peak("solver.substep", "s", "substep in use"),
    count("solver.steps", "substeps taken"),
    peak("solver.stability_bound", "s", "guaranteed stability bound of the explicit step"),
    count("net.nodes", "nodes of the net"),
    count("net.threads", "threads of the net, after cutting into segments"),
    # what the kernels keep
    count("grid", "substeps since the start", "state"),
    state("start_time", "s", "of the instance: the integer grid and all its times count from here"),
    state("thread_power", "W", "what the threads' dashpots take now"),
    state("thread_loss", "J", "taken by the threads' dashpots up to half a substep back"),
    state("energy_start", "J", "of all bodies at the start"),
    state("axes[#]", "1", "shot axes as rows: two transverse, then the axis itself", shape=(9,)),
    state("muzzle[#]", "m", "muzzle at the start, orbital frame", shape=(3,)),
    state("thread_length", "m", "rest length of one segment"),
    state("thread_stiffness", "N/m", "EA / l of one segment"),
    state("thread_damping", "N.s/m", "dashpot of one segment"),
    count("knots", "knots per side", "state"),
    count("strips", "rows of parallel threads", "state"),
    count("node_slots", "slots in each node plane", "state"),
    count("thread_slots", "slots in each thread plane", "state"),
    count("measure_every", "substeps between two looks at mouth and capture", "state"),
    state("chaser_place[#]", "m", "chaser at the last substep", shape=(3,)),
    state("pull[#]", "m/s2", "acceleration of the chaser by a tension signal", shape=(3,)),
    state("rest[#]", "m/s2", "acceleration of a body that nothing pulls", shape=(3,)),
    state("chaser_drift[#]", "m/s", "velocity of the chaser half a substep back", shape=(3,)),
    state("scratch[#]", "1", "small vectors of the kernels", shape=(28,)),
)

BLAMED = {
    NO_WHOLE_MESHES: "net.side",
    TOO_MANY_NODES: "net.mesh",
    TOO_FINE: "net.segments",
    NO_AXIS: "shot.axis[1]",
    FOLD_TOO_LARGE: "net.fold_side",
    NO_QUATERNION: "target.start_attitude[1]",
    NO_INERTIA: "target.principal_inertia[1]",
    INSIDE_TARGET: "chaser.start_position[1]",
    STEP_TOO_SMALL: "net.youngs_modulus",
    TOO_MANY_RINGS: "closing.rings",
}
"""The variable a fault names, or its first component."""

FAULTS = (
    Fault(NOT_FINITE, "error", "the state of the net is no longer finite: lower solver.step_ratio or the stiffness"),
    Fault(NO_WHOLE_MESHES, "error", "net.side must be a whole number of net.mesh, at least 2", True),
    Fault(
        TOO_MANY_NODES,
        "error",
        "the net has more nodes than this FMU has outputs for; raise the capacity of nodes",
        True,
    ),
    Fault(TOO_FINE, "error", "the net has too many meshes times segments per side", True),
    Fault(NO_AXIS, "error", "the chaser stands in the target's centre of mass, and shot.axis names no direction", True),
    Fault(FOLD_TOO_LARGE, "error", "net.fold_side must be smaller than net.side", True),
    Fault(NO_QUATERNION, "error", "target.start_attitude is not a quaternion of unit length (nor zero)", True),
    Fault(NO_INERTIA, "error", "the principal inertias of the target break the triangle inequality", True),
    Fault(INSIDE_TARGET, "error", "chaser.start_position: the folded net would begin inside the target", True),
    Fault(
        STEP_TOO_SMALL,
        "error",
        "the net is too stiff for its mass: the substep [s] it needs is below a nanosecond",
        True,
    ),
    Fault(TOO_MANY_RINGS, "error", "closing.rings: a side of the mouth has fewer knots between its bullets", True),
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
        "nodes": Group(NodeTerms(), selector="capacity", optional=True, follows=nodes_of),
    },
    faults=FAULTS,
    module="fmu_src.net_capture.model",
    stop_time=20.0,
    macro_step=0.05,
)
