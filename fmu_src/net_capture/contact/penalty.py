"""Law B: a spring and a dashpot at the surface, and Coulomb friction.

    F_n = max(0, c s - b v_n),   s the depth below the surface, v_n the speed off it
    F_t = -(c_t x + b_t w) while that is less than mu F_n, and mu F_n along it beyond

x is how far a node has been carried along the surface from where it holds on, in the body's axes, w its speed there. A
node sticks with a force, not with a small speed, and slides only as far as that is more than mu F_n: so it never turns
round within a substep, and what has come to rest stays (`friction.py`).

Forces belong to the instant of the positions. The dashpots see the velocity half way through the kick, with the kick's
own share in it, so they take energy at any step. Where the surface was reached within the last substep, dashpot and
friction count from there on.

Node and target get opposite impulses at the same point, so momenta are kept to rounding. In what is shown, contact
counts up to the middle of the last substep: for nodes, target, losses and the energy in springs alike.

Order 2 but for the onset. Source: Benvenuto and Lavagna (D-CoNe), eq. 4 and 5, here with F_n >= 0 and with a state of
sticking (Cundall and Strack, Geotechnique 29, 1979).

Checked  tests/net_capture/test_penalty.py
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from typing import Any

from fmu_src.extremes import Extreme
from fmu_src.implied import formula
from fmu_src.interface import Term
from fmu_src.net_capture.contact import Checks, Contact
from fmu_src.net_capture.contact.friction import FRICTION, PLANES, SINCE, make_friction
from fmu_src.net_capture.contact.pushing import make_push
from fmu_src.net_capture.contact.touching import INSIDE_TARGET, ROWS, make_contact
from fmu_src.net_capture.contact.touching import refuses as refuses_place
from fmu_src.net_capture.hinge.numbers import BODY as HINGED
from fmu_src.net_capture.hinge.numbers import YIELDS
from fmu_src.net_capture.planes import INVERSE_MASS, MASS, SHOWN, SHOWN_RATE, U, X
from fmu_src.net_capture.refusal import Refusal, Scene
from fmu_src.rows import at_least_zero, output, peak, positive, state
from orbital.kernel import kernel
from orbital.rotations import rotate, rotate_inverse
from orbital.vectors import cross, dot

SCHEME, PRECISION = "leapfrog", "double"
"""With which it goes: others ask for all forces at once, and in 24 bits a depth of a micrometre is noise."""
DURATION = 1e-3
"""Seconds that a contact lasts unless the scene says otherwise: at 3 m/s a node goes 1 mm deep, and the substep of an
aramid net hardly feels it."""
DEEPEST = 0.1
"""Of half the target's least dimension, that a bullet may go below the surface."""
TARGET_SHARE = 40.0
"""What an impulse at the farthest point of a uniform body gives it there at most, over what it gives its centre of
mass: 34 at the tip of a slender cone, less for all other shapes of one piece."""


@kernel
def own_stiffness(duration, stiffness, mass):
    """Stiffness across the surface [N/m] where a node meets it: c, or where that is 0, m (pi / t)^2.

    duration      t      of a contact without damping            [s]
    stiffness     c      0: that of the duration                 [N/m]
    mass          m      of the node                             [kg]

    Valid    a target much heavier than the node: else a contact is shorter by sqrt(1 + m/M)
    Checked  tests/net_capture/test_penalty.py
    """
    return stiffness if stiffness > 0.0 else mass * (math.pi / duration) * (math.pi / duration)


@kernel
def own_dashpot(ratio, dashpot, stiffness, mass):
    """Dashpot across the surface [N s/m]: b, or where that is 0, 2 zeta sqrt(c m).

    ratio         zeta                                           [1]
    dashpot       b      0: that of the ratio                    [N s/m]
    stiffness     c                                              [N/m]
    mass          m      of the node                             [kg]

    Checked  tests/net_capture/test_penalty.py
    """
    return dashpot if dashpot > 0.0 else 2.0 * ratio * math.sqrt(stiffness * mass)


@kernel
def stiffening(duration, stiffness, lightest, mass, nodes, target, share):
    """Stiffness over mass that contact may add at a node, half of it [1/s2], see `formulas.longest_step`.

        w^2 = c/m + sum of c/M over all nodes, each at the farthest point

    duration, stiffness   see `own_stiffness`                    [s], [N/m]
    lightest      m       mass of the lightest node              [kg]
    mass, nodes           of all nodes together, how many        [kg], [1]
    target        M       mass of the target                     [kg]
    share                 see TARGET_SHARE                       [1]

    Source   Gershgorin: a row of the target sums to twice its diagonal, half of which counts here
    Checked  tests/net_capture/test_penalty.py
    """
    if stiffness > 0.0:
        return 0.5 * stiffness * (1.0 / lightest + share * nodes / target)
    return 0.5 * (math.pi / duration) * (math.pi / duration) * (1.0 + share * mass / target)


def make(composition: Any) -> Contact:
    """Kernels of the law with the composition's target; ValueError with a scheme or precision it does not go with."""
    scheme, precision = composition.terms["solver"], composition.terms["precision"]
    if scheme != SCHEME or precision != PRECISION:
        raise ValueError(f"contact by penalty goes with {SCHEME} in {PRECISION} precision, not {scheme} in {precision}")
    node_plane, distance_to = composition.memory.node_plane, composition.target.shape.distance
    now, first_plane = composition.clock.now, composition.contact_planes
    relative, aim, push = make_push(composition)
    hinge = composition.target.hinge
    swings = hinge is not None
    swing, largest_share = (hinge.swing, hinge.largest_share) if hinge is not None else [None] * 2
    has_map = composition.force_map is not None
    add_to_map = composition.force_map.add if has_map else None
    rub, stored_along = make_friction(composition)

    @kernel
    def touch(p, work, node, h):
        """Force between one node and the target for a substep [s], at where the node was before it drifted; 1 if any.

        Checked  tests/net_capture/test_penalty.py
        """
        inverse = node_plane(p, work, INVERSE_MASS)[node]
        if inverse == 0.0:
            return 0
        arm, body, local, normal = p.contact_arm, p.contact_point, p.contact_local, p.contact_normal
        turn = p.target_turn
        for axis in range(3):
            place = node_plane(p, work, X + axis)[node] - h * node_plane(p, work, U + axis)[node]
            arm[axis] = place - p.target_place[axis]
        for i in range(3):
            body[i] = turn[0, i] * arm[0] + turn[1, i] * arm[1] + turn[2, i] * arm[2]
        depth = -distance_to(p, local, body)
        held = node_plane(p, work, first_plane + SINCE)[node] == p.grid
        stiffness = own_stiffness(p.contact_duration, p.contact_stiffness, 1.0 / inverse)
        if depth <= 0.0:
            if held:
                left = stored_along(p, work, node, stiffness)
                p.contact_loss += left
                p.contact_friction_loss += left
            return 0
        for i in range(3):
            normal[i] = dot(turn[i], local)
        relative(p, work, node, 1.0, p.contact_slip)
        leaving = dot(p.contact_slip, normal)
        dashpot = own_dashpot(p.contact_damping_ratio, p.contact_damping, stiffness, 1.0 / inverse)
        since = h
        counts = dashpot
        if not held:
            since = min(h, depth / max(-leaving, depth / h))
            counts = dashpot * (0.5 + since / h)
        feel = aim(p, inverse, normal)
        size = max(0.0, (stiffness * depth - counts * leaving) / (1.0 + 0.5 * h * counts * feel))
        impulse = h * size
        push(p, work, node, h, inverse, normal, impulse)
        p.contact_loss += (h * stiffness * depth - impulse) * (leaving + 0.5 * impulse * feel)
        p.contact_depth = max(p.contact_depth, depth)
        if p.contact_friction > 0.0:
            rubbed = rub(p, work, node, inverse, since, held, stiffness, dashpot, p.contact_friction * size)
            impulse = math.sqrt(impulse * impulse + rubbed * rubbed)
        p.contact_impulse += impulse
        if has_map:
            add_to_map(p, body, impulse)
        node_plane(p, work, first_plane + SINCE)[node] = p.grid + 1
        if p.contact_first_time < 0.0:
            p.contact_first_time = now(p)
        return 1

    @kernel
    def stored(p, work, node):
        """Energy in the springs of a node as shown [J], half a substep back, where the velocities of contact lie.

        Checked  tests/net_capture/test_penalty.py
        """
        arm, body, local, slip = p.contact_arm, p.contact_point, p.contact_local, p.contact_slip
        for axis in range(3):
            arm[axis] = node_plane(p, work, SHOWN + axis)[node] - p.target_place[axis]
        cross(slip, arm, p.target_omega)
        for axis in range(3):
            slip[axis] += node_plane(p, work, SHOWN_RATE + axis)[node] - p.target_drift[axis]
        rotate_inverse(body, p.target_pose, arm)
        depth = -distance_to(p, local, body)
        rotate(p.contact_normal, p.target_pose, local)
        if swings:
            swing(p, arm)
            for axis in range(3):
                slip[axis] -= p.hinge_moved[axis]
        depth += 0.5 * p.solver_substep * dot(slip, p.contact_normal)
        mass = node_plane(p, work, MASS)[node]
        stiffness = own_stiffness(p.contact_duration, p.contact_stiffness, mass)
        energy = 0.5 * stiffness * depth * depth if depth > 0.0 else 0.0
        if node_plane(p, work, first_plane + SINCE)[node] == p.grid:
            energy += stored_along(p, work, node, stiffness)
        return energy

    law = make_contact(composition, touch)
    start_all, measure_all = law.start, law.measure

    @kernel
    def start(p, work):
        """Nothing touched yet; a fault where the folded net stands inside the target.

        Checked  tests/net_capture/test_penalty.py
        """
        p.contact_friction_loss = 0.0
        p.contact_depth = 0.0
        since = node_plane(p, work, first_plane + SINCE)
        for node in range(p.node_slots):
            since[node] = -1.0
        return start_all(p, work)

    @kernel
    def measure(p, work):
        """Count the nodes on the surface [1], and sum what is in their springs [J].

        Checked  tests/net_capture/test_penalty.py
        """
        measure_all(p, work)
        p.contact_stored = 0.0
        mass = node_plane(p, work, MASS)
        reach = p.envelope_radius * p.envelope_radius
        for node in range(p.node_slots):
            away = 0.0
            for axis in range(3):
                way = node_plane(p, work, SHOWN + axis)[node] - p.target_place[axis]
                away += way * way
            if mass[node] > 0.0 and away < reach:
                p.contact_stored += stored(p, work, node)

    @kernel
    def share_of(p):
        """What an impulse at the target's farthest point may give it there over what it gives its centre of mass [1].

        Checked  tests/net_capture/test_penalty.py
        """
        if swings:
            return max(largest_share(p), TARGET_SHARE)
        least = min(p.target_inertia[0], p.target_inertia[1], p.target_inertia[2])
        share = 1.0 + p.target_mass * p.envelope_radius * p.envelope_radius / least
        given = abs(p.target_principal_inertia[0]) + abs(p.target_principal_inertia[1])
        return share if given + abs(p.target_principal_inertia[2]) > 0.0 else max(share, TARGET_SHARE)

    @kernel
    def weigh(p, work):
        """What contact may add to the stiffness of a node, see `stiffening`.

        Checked  tests/net_capture/test_penalty.py
        """
        mass = node_plane(p, work, MASS)
        lightest = math.inf
        whole = 0.0
        for node in range(p.node_slots):
            if mass[node] > 0.0:
                lightest = min(lightest, mass[node])
                whole += mass[node]
        duration, stiffness = p.contact_duration, p.contact_stiffness
        p.contact_stiffening = stiffening(duration, stiffness, lightest, whole, p.net_nodes, p.target_mass, share_of(p))

    return law._replace(start=start, measure=measure, weigh=weigh)


def of_values(
    values: Mapping[str, Any], node: float, mass: float, nodes: int, radius: Callable[[Mapping[str, Any]], float]
) -> float:
    """See `Checks.stiffening`: a node in the middle of a thread is half as heavy as one that four threads meet at."""
    told = [values[f"target.principal_inertia[{i}]"] / values["target.mass"] for i in (1, 2, 3)]
    worked_out = [float(moment) for moment in values.get("target.solid", ())[:3]]  # of several pieces, or of a mesh
    share = TARGET_SHARE
    if any(told):
        share = 1.0 + radius(values) ** 2 / min(told)
    elif worked_out:
        share = max(share, 1.0 + radius(values) ** 2 / min(worked_out))
    if HINGED in values:
        share = max(TARGET_SHARE, float(values[HINGED][YIELDS]))
    lightest = node * (0.5 if values["net.segments"] > 1 else 0.75)
    duration, stiffness = values["contact.duration"], values["contact.stiffness"]
    found: float = formula(stiffening)(duration, stiffness, lightest, mass, nodes, values["target.mass"], share)
    return found


def refuses(scene: Scene) -> Iterator[Refusal]:
    """Another scheme or precision; both of two coefficients; bullets, or a test load on one node, that would go too
    deep; a muzzle inside."""
    values = scene.values
    for group, wanted, told in (("solver", SCHEME, "solver.scheme"), ("precision", PRECISION, "solver.precision")):
        if scene.terms[group] != wanted:
            yield Refusal(told, f'"{scene.terms[group]}"', f'must be "{wanted}" with contact by penalty')
    if values["contact.damping"] > 0.0 and values["contact.stiffness"] == 0.0:
        expected = "must come with contact.stiffness: a stiffness by the duration grows with the mass of a node"
        yield Refusal("contact.damping", f"{values['contact.damping']:g} N s/m", expected)
    for name, unit, default, other in (
        ("duration", " s", DURATION, "stiffness"),
        ("damping_ratio", "", 1.0, "damping"),
    ):
        if values[f"contact.{other}"] > 0.0 and values[f"contact.{name}"] != default:
            expected = f"must be left out with contact.{other}, which takes its place"
            yield Refusal(f"contact.{name}", f"{values[f'contact.{name}']:g}{unit}", expected)
    mass, speed = values["bullets.mass"], values["bullets.speed"]
    stiffness = formula(own_stiffness)(values["contact.duration"], values["contact.stiffness"], mass)
    deepest = DEEPEST * min(scene.parts["target"].checks.half(values))
    depth = speed * math.sqrt(mass / stiffness)
    if depth > deepest:
        at_least = mass * (speed / deepest) ** 2
        longest = math.pi * deepest / speed
        by_stiffness = values["contact.stiffness"] > 0.0
        name = "contact.stiffness" if by_stiffness else "contact.duration"
        value = f"{stiffness:.3g} N/m" if by_stiffness else f"{values['contact.duration']:.3g} s"
        bound = f"at least {at_least:.3g} N/m" if by_stiffness else f"at most {longest:.3g} s"
        expected = (
            f"must be {bound}: a bullet of {mass:g} kg at {speed:g} m/s would go {depth:.2g} m deep, more than a tenth "
            f"of half the target's least dimension, {deepest:.2g} m"
        )
        yield Refusal(name, value, expected)
    if "pull_off" in scene.terms:
        node = scene.parts["net"].checks.piece(values)[-1]
        stiffness = formula(own_stiffness)(values["contact.duration"], values["contact.stiffness"], node)
        if values["pull_off.force"] > deepest * stiffness:
            expected = (
                f"must be at most {deepest * stiffness:.3g} N on springs of {stiffness:.3g} N/m: a node that bore all "
                f"of it would go {values['pull_off.force'] / stiffness:.2g} m deep, more than a tenth of half the "
                f"target's least dimension, {deepest:.2g} m; with a shorter contact.duration they are stiffer"
            )
            yield Refusal("pull_off.force", f"{values['pull_off.force']:g} N", expected)
    yield from refuses_place(scene)


PART = Term(
    "spring and dashpot at the surface, and Coulomb friction with a state of sticking",
    (
        positive(
            "contact.duration", "s", "how long a contact lasts without damping, whatever the node's mass", DURATION
        ),
        at_least_zero("contact.stiffness", "N/m", "spring of every node; zero: that of contact.duration", 0.0),
        at_least_zero(
            "contact.damping_ratio", "1", "of a node on its spring; 1: it comes back at 0.135 of its speed", 1.0, 10.0
        ),
        at_least_zero("contact.damping", "N.s/m", "dashpot of every node; zero: that of contact.damping_ratio", 0.0),
        at_least_zero("contact.friction", "1", "coefficient of friction; zero: none", FRICTION),
        *ROWS,
        peak("contact.friction_loss", "J", "of contact.loss, what friction took"),
        output("contact.stored", "J", "in the springs at the surface"),
        peak("contact.depth", "m", "deepest that a node has been below the surface"),
        state("contact_stiffening", "1/s2", "half the stiffness over mass that contact may add at a node"),
        *(
            state(f"contact_{name}[#]", unit, text, shape=(3,))
            for name, unit, text in (
                ("slip", "m/s", "velocity of a node relative to the surface, frame axes"),
                ("along", "1", "direction of the force along the surface, frame axes"),
                ("carried", "m", "way of a node along the surface from where it holds on, frame axes"),
                ("rested", "m", "the same before the substep"),
            )
        ),
    ),
    needs=("target",),
    faults=(INSIDE_TARGET,),
    make=make,
    checks=Checks(PLANES, of_values),
    refuses=refuses,
    extremes=(
        *(
            Extreme(
                f"contact of {duration:g} s",
                "a spring at the surface a thousandth or ten thousand times as stiff as usual",
                "energy_gained",
                {"contact.duration": duration},
                chief=duration > DURATION,
            )
            for duration in (1e-5, 3e-2)
        ),
        *(
            Extreme(
                f"contact damping {ratio:g}",
                "contacts that give all back, or nothing",
                "energy_gained",
                {"contact.damping_ratio": ratio},
                chief=ratio == 0.0,
            )
            for ratio in (0.0, 10.0)
        ),
        *(
            Extreme(
                f"friction {friction:g}",
                "nodes that slide freely, or hold wherever they touch",
                "contact_takes",
                {"contact.friction": friction},
                chief=friction > 1.0,
            )
            for friction in (0.0, 10.0)
        ),
    ),
)
