"""A net spread on a level, low-friction table: all of it slides there, in the plane normal to the shot's axis.

Net, bullets and vertex lie on the table, and each mass is held by Coulomb's law with a true stick. In every substep

    J = min(mu m g h, m |u|) against u

so what moves is braked by mu g and comes to rest without turning round, and what rests stays until it is pulled harder
than mu m g. A bullet alone slides as far as v^2/(2 mu g). The table bears the weight: no gravity acts in its plane.

Valid    a net that lies flat and bullets that leave in its plane; one coefficient for all, at any speed
Source   Coulomb friction; ours, after the table that section 5 of the D-CoNe paper plans for reel and tether
Checked  tests/net_capture/test_sliding.py
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from fmu_src.extremes import Extreme
from fmu_src.interface import Term
from fmu_src.net_capture.planes import MASS, SHOWN_RATE, P, U, X
from fmu_src.net_capture.refusal import Refusal, Scene
from fmu_src.rows import at_least_zero, output, state
from orbital.kernel import kernel

SCHEME, PACE, FOLDING, GRAVITY = "leapfrog", "fixed", "flat", "none"
NETS = ("square", "rectangle", "hexagon")
"""That lie flat as they are meant."""
ASIDE = 1e-9
"""How far bullets may point out of the plane [rad]."""
PLANE = 3
"""Extent of it, in coordinates."""


class Sliding(NamedTuple):
    """Kernels of the table.

    begin(p, work)    velocities half a substep back are larger by what friction takes until the start
    wake(p, work)     rows of what slides stay awake
    rub(p, work)      brake all that moves over the substep just taken
    show(p, work)     brake what is shown, up to the instant that is shown
    """

    begin: Any
    wake: Any
    rub: Any
    show: Any


def make(composition: Any) -> Sliding:
    """Kernels for the composition's net."""
    terms = composition.terms
    if terms["solver"] != SCHEME or terms["substeps"] != PACE:
        raise ValueError(f"net_capture: a table needs solver = {SCHEME!r}, substeps = {PACE!r}")
    node_plane, rouse = composition.memory.node_plane, composition.rouse

    @kernel
    def speed_of(p, work, node, rate):
        """Speed of a node [m/s], by the planes of velocities from `rate` on.

        Checked  tests/net_capture/test_sliding.py
        """
        squared = 0.0
        for axis in range(PLANE):
            along = np.float64(node_plane(p, work, rate + axis)[node])
            squared += along * along
        return math.sqrt(squared)

    @kernel
    def brake(p, work, node, rate, duration):
        """Slow a node by friction over a time [s]; what it took [J]. What has come to rest stands still to the bit.

        Checked  tests/net_capture/test_sliding.py
        """
        speed = speed_of(p, work, node, rate)
        lost = p.table_coefficient * p.table_gravity * duration
        mass = np.float64(node_plane(p, work, MASS)[node])
        if lost >= speed:
            for axis in range(PLANE):
                node_plane(p, work, rate + axis)[node] = 0.0
            return 0.5 * mass * speed * speed
        for axis in range(PLANE):
            node_plane(p, work, rate + axis)[node] *= 1.0 - lost / speed
        return mass * lost * (speed - 0.5 * lost)

    @kernel
    def begin(p, work):
        """Half a substep before the start all that moves was faster by mu g h/2.

        Checked  tests/net_capture/test_sliding.py: energy
        """
        gained = 0.5 * p.table_coefficient * p.table_gravity * p.solver_substep
        p.table_loss = 0.0
        for node in range(p.node_slots):
            mass = np.float64(node_plane(p, work, MASS)[node])
            speed = speed_of(p, work, node, U)
            if mass > 0.0 and speed > 0.0:
                for axis in range(PLANE):
                    node_plane(p, work, U + axis)[node] *= 1.0 + gained / speed
                p.table_loss -= mass * gained * (speed + 0.5 * gained)

    @kernel
    def wake(p, work):
        """Rows of what slides stay awake.

        Checked  tests/net_capture/test_sliding.py
        """
        for node in range(p.node_slots):
            if speed_of(p, work, node, U) > 0.0:
                rouse(p, work, node)

    @kernel
    def rub(p, work):
        """Brake all that moves over the substep just taken, whose drift goes with it.

        Checked  tests/net_capture/test_sliding.py
        """
        h = p.solver_substep
        for node in range(p.node_slots):
            if speed_of(p, work, node, U) > 0.0:
                for axis in range(PLANE):
                    p.table_before[axis] = node_plane(p, work, U + axis)[node]
                p.table_loss += brake(p, work, node, U, h)
                still = speed_of(p, work, node, U) == 0.0
                for axis in range(PLANE):
                    change = np.float64(node_plane(p, work, U + axis)[node]) - p.table_before[axis]
                    node_plane(p, work, X + axis)[node] += h * change
                    node_plane(p, work, P + axis)[node] += 1.5 * change
                    if still:
                        node_plane(p, work, P + axis)[node] = 0.0

    @kernel
    def show(p, work):
        """Brake what is shown over the half substep up to the instant that is shown, and tell what was taken [J].

        Checked  tests/net_capture/test_sliding.py
        """
        p.table_friction_loss = p.table_loss
        for node in range(p.node_slots):
            if node_plane(p, work, MASS)[node] > 0.0:
                p.table_friction_loss += brake(p, work, node, SHOWN_RATE, 0.5 * p.solver_substep)

    return Sliding(begin, wake, rub, show)


def refuses(scene: Scene) -> Iterator[Refusal]:
    """What does not lie on a table, and what the books of friction do not know."""
    with_table = "on a table, [capture.table]"
    for group, name, allowed in (
        ("solver", "solver.scheme", (SCHEME,)),
        ("substeps", "solver.substeps", (PACE,)),
        ("folding", "folding.pattern", (FOLDING,)),
        ("gravity", "gravity.law", (GRAVITY,)),
        ("net", "net.shape", NETS),
    ):
        found = scene.terms.get(group, allowed[0])
        if found not in allowed:
            yield Refusal(name, f'"{found}"', f"must be {' or '.join(allowed)} {with_table}")
    angle = float(scene.values["bullets.angle"])
    if abs(angle - 0.5 * math.pi) > ASIDE:
        expected = f"must be 90 deg {with_table}: bullets leave in its plane, which is normal to the shot's axis"
        yield Refusal("bullets.angle", f"{math.degrees(angle):g} deg", expected)
    if any(scene.values.get(f"solver.jitter[{i}]", 0.0) != 0.0 for i in (1, 2, 3)):
        yield Refusal("solver.jitter", "", f"must be zero {with_table}: it lifts nodes off the plane")


PART = Term(
    "a level, low-friction table on which net, bullets and vertex slide, and stick",
    (
        at_least_zero("table.coefficient", "1", "of friction: ours, of air bearings", 1e-4, 10.0),
        at_least_zero("table.gravity", "m/s2", "that presses them on the table", 9.80665, 1e3),
        output("table.friction_loss", "J", "taken by friction on the table so far"),
        state("table_loss", "J", "the same up to half a substep back"),
        state("table_before[#]", "m/s", "velocity of a node before it is braked", shape=(PLANE,)),
    ),
    excludes=("ejection", "spin", "target", "tether", "wall", "bending", "air"),
    make=make,
    refuses=refuses,
    extremes=(
        Extreme("a table of rubber", "the net stops where it is", "energy_gained", {"table.coefficient": 1.0}),
        Extreme("a table without friction", "from none", "energy_gained", {"table.coefficient": 0.0}, chief=True),
    ),
)
