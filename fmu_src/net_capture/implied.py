"""What a scene implies for a shot: section and stiffness of thread and cord, masses of nodes, momentum and energy."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from fmu_src.implied import Implied, formula
from fmu_src.net_capture import formulas
from fmu_src.net_capture.appendage import laying
from fmu_src.net_capture.hinge.numbers import BODY
from fmu_src.net_capture.interface import GROUPS, NETS, rigged_of
from fmu_src.net_capture.nets import USUAL_BULLETS, Checks, Hanging, Thread
from fmu_src.net_capture.release import ejection, ejector
from fmu_src.net_capture.rigging import at_bullets
from fmu_src.net_capture.rigging.knots import in_series
from fmu_src.net_capture.shapes import mesh, solids
from fmu_src.net_capture.shot import opening_distance
from fmu_src.net_capture.substeps import COUNT
from fmu_src.net_capture.substeps import substeps as of_parts
from orbital import oscillators
from orbital.constants import EARTH_EQUATORIAL_RADIUS, EARTH_MU
from orbital.plain import mean_motion

Values = Mapping[str, float]


def thread_length(values: Values, terms: Mapping[str, str]) -> float:
    """Length [m] of all threads."""
    return float(NETS[terms["net"]].checks.total(values))


def thread_section(values: Values, terms: Mapping[str, str]) -> float | None:
    """Area [m2] of the section of the thinnest thread; None where nothing tells it."""
    found: Thread = NETS[terms["net"]].checks.thread(values)
    return found.section


def hanging(values: Values, terms: Mapping[str, str]) -> Hanging:
    """Masses [kg] of the pieces of thread that hang on a knot inside the net, on its edge, and at a bullet."""
    pieces, found = values["net.segments"], NETS[terms["net"]].checks.hanging(values)
    return Hanging(found.inside / pieces, found.edge / pieces, found.corner / pieces, found.alike)


def cord_mass(values: Values, terms: Mapping[str, str]) -> float:
    """Mass [kg] that a cord between two bullets moves as it lengthens."""
    return formula(formulas.cord_mass)(
        values["bullets.mass"],
        hanging(values, terms).edge,
        int(values["closing.rings"]),
        int(values["closing.reels_at"]),
    )


def open_loop(values: Values, terms: Mapping[str, str]) -> float:
    """Way [m] round the loop that a locked cord leaves open between two knots that it holds: the net's edge between
    them, and the cord's share."""
    side = max(NETS[terms["net"]].checks.sides(values))
    return float((side + values["closing.lock_length"]) / (values["closing.rings"] + 1))


def bullet_thread(values: Values, terms: Mapping[str, str]) -> float:
    """Mass [kg] of what hangs on a bullet: of the net's corner with its knot, or of its lead."""
    led = [part.checks.corner for part in rigged_of(terms).values() if part.checks.corner is not None]
    if led:
        return float(led[0](values, NETS[terms["net"]].checks))
    return hanging(values, terms).corner + (values["knots.mass"] if "knots" in terms else 0.0)


def catch_mass(values: Values, terms: Mapping[str, str]) -> float:
    """Mass [kg] of net, what is rigged to it, bullets and vertex."""
    net: Checks = NETS[terms["net"]].checks
    rigged = sum(rigged_masses(values, terms).values())
    return net.mass(values) + rigged + net.bullets(values) * values["bullets.mass"] + values["vertex.mass"]


def rigged_masses(values: Values, terms: Mapping[str, str]) -> dict[str, float]:
    """Mass [kg] of each thing that is rigged to the net, by the name of its group."""
    net = NETS[terms["net"]].checks
    return {name: part.checks.mass(values, net) for name, part in rigged_of(terms).items()}


def substeps(values: Values, terms: Mapping[str, str]) -> tuple[float, float]:
    """Stability bound, and the largest substep that keeps the mouth area within 0.3 % and the energy within 1 % [s]."""
    chosen = {"solver": "leapfrog", **terms}
    return of_parts(values, {name: GROUPS[name].terms[chosen[name]] for name in COUNT if name in chosen})


def rows(values: Values, terms: Mapping[str, str]) -> Iterator[Implied]:
    """Thread, nodes, shot, cord and orbit."""
    yield from _of_thread(values, terms)
    yield from _of_nodes(values, terms)
    yield from _of_canister(values, terms)
    yield from _of_shot(values, terms)
    yield from ejector.rows(values, terms)
    if "closing" in terms:
        yield from _of_cord(values, terms)
    if "target.solid" in values:
        yield from solids.rows(values)
    if BODY in values:
        yield from laying.rows(values)
    if "target.grid" in values:
        yield from mesh.rows(values)
    if "orbit.altitude" in values:
        rate = mean_motion(EARTH_EQUATORIAL_RADIUS + values["orbit.altitude"], EARTH_MU)
        yield Implied("orbit.period", "period of the orbit", 2.0 * math.pi / rate, "s")


def _of_thread(values: Values, terms: Mapping[str, str]) -> Iterator[Implied]:
    """Where threads differ, of the least and of the most; stiffness and dashpot with the knots in series."""
    thread: Thread = NETS[terms["net"]].checks.thread(values)
    if thread.section is not None:
        which = "a thread" if _equal(thread.strength, thread.hardest) else "the thinnest thread"
        yield Implied("thread.area", f"section of {which}", thread.section, "m2")
        diameter = formula(formulas.round_diameter)(thread.section)
        yield Implied("thread.diameter", "its diameter, were it solid and round", diameter, "m")
    if _equal(thread.strength, thread.hardest):
        yield Implied("thread.axial_stiffness", "EA of a thread", thread.strength, "N")
    else:
        yield Implied("thread.axial_stiffness", "EA of the softest thread", thread.strength, "N")
        yield Implied("thread.axial_stiffness_most", "EA of the hardest thread", thread.hardest, "N")
    compliance = values["knots.compliance"] if "knots" in terms else 0.0
    with_knots = ", its knots in series" if compliance > 0.0 else ""
    whole, softest = (formula(in_series)(stiffness, compliance) for stiffness in (thread.stiffness, thread.softest))
    dashpot = thread.dashpot * math.sqrt(whole / thread.stiffness)
    which = thread.called
    if not _equal(whole, softest):
        which = "the stiffest thread"
        label = f"stiffness of the least stiff thread from knot to knot{with_knots}"
        yield Implied("thread.stiffness_least", label, softest, "N/m")
    yield Implied("thread.stiffness", f"stiffness of {which} from knot to knot{with_knots}", whole, "N/m")
    yield Implied("thread.dashpot", f"dashpot of {which} from knot to knot{with_knots}", dashpot, "N.s/m")


def _equal(one: float, other: float) -> bool:
    return math.isclose(one, other, rel_tol=1e-9)


def _of_nodes(values: Values, terms: Mapping[str, str]) -> Iterator[Implied]:
    """Half of each piece of thread that ends at a node, and the knot itself."""
    inside, edge, corner, alike = hanging(values, terms)
    knot = values["knots.mass"] if "knots" in terms else 0.0
    which = "a knot" if alike else "the heaviest knot"
    yield Implied("knot.mass", f"mass of {which} inside the net", inside + knot, "kg")
    bare = ", without its rope" if "edge" in terms else ""
    yield Implied("edge.mass", f"mass of {which} on its edge{bare}", edge + knot, "kg")
    if "leads" in terms:
        yield Implied("corner.mass", "thread and knot at a corner of the net, without its lead", corner + knot, "kg")
        yield Implied(
            "bullet.mass",
            "a bullet with half a piece of its lead",
            bullet_thread(values, terms) + values["bullets.mass"],
            "kg",
        )
    else:
        bullet = bullet_thread(values, terms) + values["bullets.mass"]
        yield Implied("corner.mass", "mass of a corner, with its bullet", bullet, "kg")
    for name, mass in rigged_masses(values, terms).items():
        yield Implied(f"{name}.mass", f"mass of all that [{name}] brings", mass, "kg")
    if values["net.segments"] > 1:
        piece = NETS[terms["net"]].checks.thread(values).mass / values["net.segments"]
        yield Implied("thread_node.mass", "mass of a node within a thread", piece, "kg")
    yield Implied("catch.mass", "net, bullets and vertex together", catch_mass(values, terms), "kg")


def _of_canister(values: Values, terms: Mapping[str, str]) -> Iterator[Implied]:
    """Its volume, and how much of that is thread."""
    volume = GROUPS["folding"].terms[terms.get("folding", "flat")].checks.volume(values)
    if volume > 0.0:
        yield Implied("canister.volume", "volume of the canister", volume, "m3")
        solid = NETS[terms["net"]].checks.mass(values) / values["net.density"]
        label = "share of it that the net's threads fill, were they solid"
        yield Implied("canister.filled", label, solid / volume, "")


ROUNDING = 1e-12
"""Share of a bullet's speed that is none along the shot: what the cosine of 90 deg leaves [1]."""


def _of_shot(values: Values, terms: Mapping[str, str]) -> Iterator[Implied]:
    """Of the corners, which alone leave at the bullets' speed; relative to the chaser before the shot."""
    bullet = bullet_thread(values, terms) + values["bullets.mass"]
    speed, angle = values["bullets.speed"], values["bullets.angle"]
    if "ejection" in terms:
        ways = ejection.ways(values, int(terms["ejection"]))
    else:
        ways = [(speed * math.cos(angle), speed)] * int(terms.get("bullets", USUAL_BULLETS))
    momentum = bullet * sum(forward for forward, whole in ways if abs(forward) > ROUNDING * whole)
    yield Implied("shot.momentum", "momentum of the shot", momentum, "N.s")
    yield Implied("shot.energy", "energy of the shot", 0.5 * bullet * sum(whole * whole for _, whole in ways), "J")
    yield Implied("shot.recoil", "speed of the chaser's recoil", momentum / values["chaser.mass"], "m/s")
    net = at_bullets(NETS[terms["net"]].checks, [rig.checks for rig in rigged_of(terms).values()])
    fold = GROUPS["folding"].terms[terms.get("folding", "flat")].checks
    opening = opening_distance(math.hypot(*net.corner(values)), fold.radius(values, net), speed, angle)
    if math.isfinite(opening):
        yield Implied("shot.opening", "bullets alone would have spread the net after", opening, "m")


def _of_cord(values: Values, terms: Mapping[str, str]) -> Iterator[Implied]:
    """Of the cord between two bullets, which swing against each other with half a bullet's mass; and what it closes."""
    sides = NETS[terms["net"]].checks.sides(values)
    for key, label, length in (
        ("cord_open", "the cord between two bullets, net flat", max(sides)),
        ("cord_locked", "the cord between two bullets, locked", values["closing.lock_length"]),
    ):
        stiffness = formula(formulas.cord_stiffness)(values["closing.axial_stiffness"], length)
        frequency = formula(oscillators.natural_frequency)(stiffness, 0.5 * values["bullets.mass"])
        yield Implied(f"{key}.stiffness", f"stiffness of {label}", stiffness, "N/m")
        yield Implied(f"{key}.period", "its period, undamped", 2.0 * math.pi / frequency, "s")
    yield Implied("cord.open_loop", "largest loop of the closed mouth", open_loop(values, terms), "m")
