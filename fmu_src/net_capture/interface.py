"""The variables every net capture has, the groups of its parts, and its faults."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from fmu_src.interface import Fault, Group, Model, Term, Variable, fault, numbered
from fmu_src.net_capture import (
    air,
    bending,
    breaking,
    capture_index,
    force_map,
    gradient,
    hardest,
    pull_off,
    section,
    shot,
    sliding,
    tether,
    thrown,
    volume,
    wall,
    wrapping,
)
from fmu_src.net_capture.appendage import part as hinge
from fmu_src.net_capture.capacity import FAMILIES, MOST_NODES, MOST_THREADS
from fmu_src.net_capture.closing import closings, jam
from fmu_src.net_capture.contact import contacts
from fmu_src.net_capture.folding import foldings
from fmu_src.net_capture.graph import WRONG_NUMBER
from fmu_src.net_capture.gravity import gravities
from fmu_src.net_capture.nets import USUAL_BULLETS, nets
from fmu_src.net_capture.outcome import OUTCOMES
from fmu_src.net_capture.pace import paces
from fmu_src.net_capture.planes import MOST_BULLETS
from fmu_src.net_capture.precision import PRECISION
from fmu_src.net_capture.refusal import Refusal, Scene
from fmu_src.net_capture.release import ejection, ejector, spin
from fmu_src.net_capture.rigging import riggings
from fmu_src.net_capture.schemes import schemes
from fmu_src.net_capture.self_contact import part as self_contact
from fmu_src.net_capture.shapes import shapes
from fmu_src.net_capture.stepping import STEP_TOO_SMALL
from fmu_src.rows import angle, at_least_zero, count, flag, moving, output, parameter, peak, positive, state, vector

NOT_FINITE = fault(
    "not_finite", "", "the state of the net is no longer finite: lower solver.step_ratio or the stiffness"
)
TOO_MANY_NODES = fault(
    "too_many_nodes",
    "net.mesh",
    "the net has more nodes than this FMU has outputs for; raise the capacity of nodes",
)
TOO_MANY_THREADS = fault(
    "too_many_threads",
    "net.mesh",
    "the net has more threads than this FMU has outputs for; raise the capacity of threads",
)


def bullet_rows(number: int) -> tuple[Variable, Variable]:
    """Positions and velocities of so many bullets."""
    return (
        output(
            "bullet[#].position[#]",
            "m",
            "bullet, orbital frame",
            shape=(number, 3),
            nominal=10.0,
            rate="bullet[#].velocity[#]",
        ),
        output("bullet[#].velocity[#]", "m/s", "bullet, orbital frame", shape=(number, 3), nominal=1.0),
    )


BASE = (
    positive("bullets.mass", "kg", "mass of each bullet", 0.5),
    at_least_zero("bullets.speed", "m/s", "speed at which the bullets leave; with a target above 0", 3.0),
    angle(
        "bullets.angle",
        "angle of the bullets from the shot axis, outward along the diagonals; with a target neither 0 nor 90 deg",
        math.radians(40.0),
        0.0,
        math.pi / 2,
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
    angle("shot.roll", "turn of the net about the shot axis", 0.0),
    parameter(
        "solver.step_ratio",
        "1",
        "substep as a share of the guaranteed stability bound; zero: as large as keeps the mouth area within 0.3 % and "
        "the energy within 1 %, by the damping",
        0.0,
        0.0,
        1.3,
    ),
    vector(
        "solver.jitter", "m", "amplitude of the deterministic jitter of the folded nodes, per shot axis", "parameter"
    ),
    Variable("solver.seed", "1", "parameter", "which jitter, for ensembles of runs", 0, kind="Integer", minimum=0),
    *bullet_rows(USUAL_BULLETS),
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
    count("net.corners", "corners of the mouth", "state"),
    count("net.strips", "rows of parallel threads of the net itself", "state"),
    count("thread_numbers", "the last number that a thread has", "state"),
    count("knot_slots", "slots up to the last of the net's knots", "state"),
    state("rim_mesh", "m", "least distance of two knots of the rim, as meant"),
    count("net.faces", "faces between the threads", "state"),
    count("rim_nodes", "nodes of the mouth's rim", "state"),
    count("apex_nodes", "nodes that share the vertex", "state"),
    count("row_pitch", "slots of a row of nodes", "state"),
    count("grid_columns", "knots along a row", "state"),
    count("grid_rows", "rows of knots", "state"),
    count("grid_split", "rows of nodes that a row of knots stands in", "state"),
    count("grid_piece", "knots in each of them", "state"),
    count("thread_peak_index", "thread that bears the largest tension of the macro step", "state"),
    state("mouth_flat_area", "m2", "of the mouth as meant"),
    state("mouth_side[#]", "m", "of the rim as meant, from each bullet to the next", shape=(MOST_BULLETS,)),
    state("mouth_width[#]", "m", "of the mouth as meant, along both its axes", shape=(2,)),
    state("flight[#]", "1", "what a free flight needs of its time", shape=(10,)),
    state("enclosure_point[#]", "m", "sample point of the target", shape=(3,)),
    count("grid", "substeps since the start", "state"),
    state("start_time", "s", "of the instance: the integer grid and all its times count from here"),
    state("thread_power", "W", "what the threads' dashpots take now"),
    state("thread_loss", "J", "taken by the threads' dashpots up to half a substep back"),
    state("energy_start", "J", "of all bodies at the start"),
    state("axes[#]", "1", "shot axes as rows: two transverse, then the axis itself", shape=(9,)),
    state("muzzle[#]", "m", "muzzle at the start, orbital frame", shape=(3,)),
    count("strips", "rows of parallel threads", "state"),
    count("node_planes", "planes of node quantities", "state"),
    count("node_slots", "slots in each node plane", "state"),
    count("measure_every", "substeps between two looks at mouth and capture", "state"),
    state("chaser_place[#]", "m", "chaser at the last substep", shape=(3,)),
    state("pull[#]", "m/s2", "acceleration of the chaser by a tension signal", shape=(3,)),
    state("rest[#]", "m/s2", "acceleration of a body that nothing pulls", shape=(3,)),
    state("chaser_drift[#]", "m/s", "velocity of the chaser half a substep back", shape=(3,)),
    state("scratch[#]", "1", "small vectors of the kernels", shape=(9,)),
)

SETTLING = {
    "speed": Term(
        "when the net counts as settled",
        (
            positive("settling.speed", "m/s", "speed of the net's centre of mass relative to the target", 0.1),
            positive("settling.time", "s", "how long it must stay below", 2.0),
            state("calm_since", "s", "since when the net has been slow, from the shot"),
        ),
        make=lambda composition: None,
    )
}


BULLETS = {
    str(number): Term(
        f"{number} bullets, one at each corner of the mouth", () if number == USUAL_BULLETS else bullet_rows(number)
    )
    for number in range(3, MOST_BULLETS + 1)
}
"""How many bullets; those that nets usually have are among the variables that every net has."""


def bullets_of(terms: Mapping[str, str], parameters: Mapping[str, float]) -> str:
    """As many as the shape of the net asks for."""
    return str(NETS[terms["net"]].checks.bullets(parameters))


def sure_bullets(terms: Mapping[str, str], parameters: Mapping[str, float]) -> bool:
    """Whether the shape of the net says how many; files that make no net do not."""
    term = NETS[terms["net"]]
    return not term.tables or bool(term.checks.sound(parameters))


def each_bullet(terms: Mapping[str, str], parameters: Mapping[str, float]) -> str:
    """As many as there are."""
    return terms.get("bullets") or bullets_of(terms, parameters)


def nodes_of(terms: Mapping[str, str], values: Mapping[str, float]) -> int:
    """Nodes of the net and of what is rigged to it; 1 where there is no such net."""
    net = NETS[terms["net"]].checks
    rigged = sum(part.checks.nodes(values, net) for part in rigged_of(terms).values())
    return int(net.nodes(values) + rigged)


def threads_of(terms: Mapping[str, str], values: Mapping[str, float]) -> int:
    """Threads of the net and pieces of what is rigged to it; 1 where there is no such net.

    Checked  tests/net_capture/test_tensions.py
    """
    net = NETS[terms["net"]].checks
    if net.nodes(values) == 1:
        return 1
    lines, rim = net.drawing(values)
    pieces = round(values["net.segments"])
    edge = len(rim) - 1 if "edge" in terms else 0
    leads = RIGGINGS["leads"].checks.nodes(values, net) if "leads" in terms else 0
    return sum(len(line) - 1 for line in lines) * pieces + edge + leads


def capacity_of(terms: Mapping[str, str], parameters: Mapping[str, float]) -> str:
    """The capacity that a net's mesh asks for."""
    return str(min(nodes_of(terms, parameters), MOST_NODES))


def thread_capacity_of(terms: Mapping[str, str], parameters: Mapping[str, float]) -> str:
    """The same of threads."""
    return str(min(threads_of(terms, parameters), MOST_THREADS))


def rigged_of(terms: Mapping[str, str]) -> dict[str, Term]:
    """What is rigged to a net with these terms, by the name of its group."""
    return {name: part for name, part in RIGGINGS.items() if name in terms}


def _plain(part: Term, selector: str = "kind", **others: Term) -> Group:
    """A group of one term, which the scene need not name where it has the table, and others that it must name."""
    return Group({PLAIN: part, **others}, selector=selector, optional=True, follows=lambda terms, values: PLAIN)


PLAIN = "plain"
NETS, RIGGINGS, TARGETS, CONTACTS, CLOSINGS = nets(), riggings(), shapes(), contacts(), closings()

GROUPS = {
    "net": Group(NETS, selector="shape"),
    "section": _plain(section.PART),
    **{name: _plain(part) for name, part in RIGGINGS.items()},
    "bullets": Group(BULLETS, selector="number", default=str(USUAL_BULLETS), follows=bullets_of, early=True),
    "ejection": Group(
        ejection.PARTS, selector="number", optional=True, follows=each_bullet, early=True, sure=sure_bullets
    ),
    "ejector": Group(ejector.PARTS, selector="kind", optional=True),
    "spin": Group({"turning": spin.PART}, selector="kind", optional=True, follows=lambda terms, values: "turning"),
    "folding": Group(foldings(), selector="pattern", default="flat"),
    "gravity": Group(gravities()),
    "solver": Group(schemes(), selector="scheme", default="leapfrog"),
    "precision": Group(PRECISION, selector="precision", default="double", table="solver"),
    "substeps": Group(paces(), selector="substeps", default="fixed", table="solver"),
    "target": Group(TARGETS, selector="shape", optional=True),
    "gravity_gradient": _plain(gradient.PART),
    "hinge": _plain(hinge.PART),
    "contact": Group(CONTACTS, optional=True),
    "force_map": _plain(force_map.PART),
    "wrap": _plain(wrapping.PART, selector="bends", friction=wrapping.FRICTION),
    "closing": Group(CLOSINGS, selector="drive", optional=True),
    "jam": _plain(jam.PART),
    "tether": Group({"slack": tether.PART, "dragging": tether.DRAGGING}, selector="state", optional=True),
    "air": Group({"quadratic": air.PART}, selector="drag", optional=True, follows=lambda terms, values: "quadratic"),
    "bending": _plain(bending.PART),
    "self_contact": _plain(self_contact.PART),
    "wall": _plain(wall.PART),
    "table": _plain(sliding.PART),
    "break": Group({"breaks": breaking.PART}, optional=True, follows=lambda terms, values: "breaks"),
    "settling": Group(SETTLING, selector="by", optional=True),
    "volume": _plain(volume.PART),
    "quality": _plain(capture_index.PART),
    "pull_off": _plain(pull_off.PART),
    "tensions": _plain(hardest.PART),
    "nodes": Group(FAMILIES["nodes"], selector="capacity", optional=True, follows=capacity_of),
    "threads": Group(FAMILIES["threads"], selector="capacity", optional=True, follows=thread_capacity_of),
}


def _faults() -> Iterator[Fault]:
    """Those of the loop, then those of every part in the order of the groups."""
    yield from (NOT_FINITE, TOO_MANY_NODES, shot.NO_AXIS, STEP_TOO_SMALL, WRONG_NUMBER)
    for name, group in GROUPS.items():
        if name not in FAMILIES:
            for part in group.terms.values():
                yield from part.faults
    yield TOO_MANY_THREADS


MODEL = Model(
    name="net_capture",
    summary="A net is shot from a chaser, opens, wraps a free target and closes.",
    base=BASE,
    groups=GROUPS,
    faults=numbered(_faults()),
    module="fmu_src.net_capture.model",
    stop_time=20.0,
    macro_step=0.05,
)


def _refuses_numbers(scene: Scene) -> Iterator[Refusal]:
    """Other bullets than the shape has corners, and more nodes than there are outputs for."""
    net = scene.parts["net"].checks
    bullets = scene.terms.get("bullets", str(USUAL_BULLETS))
    corners = net.bullets(scene.values)
    if bullets != str(corners):
        yield Refusal("bullets.number", bullets, f"must be {corners}: a mouth of this shape has so many corners")
    for group, there_are in (("nodes", nodes_of), ("threads", threads_of)):
        if group in scene.terms and int(scene.terms[group]) < there_are(scene.terms, scene.values):
            text = f"must be at least {there_are(scene.terms, scene.values)}, the {group} of this net"
            yield Refusal(f"{group}.capacity", scene.terms[group], text)


def refusals(terms: Mapping[str, str], values: Mapping[str, float], duration: float = math.inf) -> list[Refusal]:
    """Why a shot can not work: empty if nothing speaks against it.

    terms        of the model, by group
    values       of every parameter by FMI name [SI]
    duration     of the capture phase [s]
    """
    terms = {name: group.default for name, group in GROUPS.items() if group.default} | dict(terms)
    scene = Scene(terms, values, duration, {group: GROUPS[group].terms[term] for group, term in terms.items()})
    if not scene.parts["net"].checks.sound(values):  # all others ask how large it is
        return list(scene.parts["net"].refuses(scene))
    found: list[Refusal] = []
    for part in scene.parts.values():
        if part.refuses is not None:
            found += part.refuses(scene)
    found += _refuses_numbers(scene)
    if terms.get("tether") == "dragging" and not found:
        found += thrown.refuses(scene)
    if "target" in terms:
        found += shot.refuses_place(scene)
        if not found:
            found += shot.refuses_way(scene)
    return found
