"""Knots that weigh something, and that give way under load in series with the threads between them."""

from __future__ import annotations

import math
from typing import Any

from fmu_src.extremes import Extreme
from fmu_src.interface import Term
from fmu_src.net_capture.planes import DAMPING, MASS, STIFFNESS, STRIP_NUMBERS
from fmu_src.net_capture.rigging import Checks, Rig, Values
from fmu_src.rows import at_least_zero
from orbital.kernel import kernel


@kernel
def in_series(stiffness, compliance):
    """Stiffness of a thread with its knots [N/m]: 1 / (1/k + c).

    stiffness    k    of the thread alone                                    [N/m]
    compliance   c    of both its knots together, as far as it pulls them    [m/N]

    Checked  tests/net_capture/test_rigging.py
    """
    return stiffness / (1.0 + compliance * stiffness)


def make(composition: Any) -> Rig:
    """Kernels for the composition's net."""
    node_plane, properties = composition.memory.node_plane, composition.memory.properties

    @kernel
    def count_up(p):
        """Nothing is added to the graph.

        Checked  tests/net_capture/test_rigging.py
        """
        return 0

    @kernel
    def lay_out(p, work):
        """Add the knots' masses, and soften the net's threads: their dashpots keep their ratio.

        Checked  tests/net_capture/test_rigging.py
        """
        mass = node_plane(p, work, MASS)
        for node in range(p.knot_slots):
            if mass[node] > 0.0:
                mass[node] += p.knots_mass
        numbers = properties(p, work)
        for q in range(p.net_strips):
            at = STRIP_NUMBERS * q
            whole = numbers[at + STIFFNESS] / p.net_segments
            softer = in_series(whole, p.knots_compliance) / whole
            numbers[at + STIFFNESS] *= softer
            numbers[at + DAMPING] *= math.sqrt(softer)

    @kernel
    def stiffest(p, thread, dashpot, node):
        """Nothing grows stiffer for its mass: no bound of their own.

        Checked  tests/net_capture/test_rigging.py
        """
        return 0.0, 0.0

    return Rig(count_up, lay_out, stiffest)


def _mass(values: Values, net: Any) -> float:
    plain = {**values, "net.segments": 1}
    return float(values["knots.mass"] * net.nodes(plain))


PART = Term(
    "knots with a mass, and with a compliance in series with the threads",
    (
        at_least_zero("knots.mass", "kg", "of each knot, beside the thread that hangs on it", 0.0),
        at_least_zero("knots.compliance", "m/N", "by which a thread's two knots together give way", 0.0),
    ),
    make=make,
    extremes=(
        Extreme("knots of 1 kg", "knots far heavier than their threads", "energy_gained", {"knots.mass": 1.0}),
        Extreme(
            "knots that give way by 1 m/N", "threads as soft as their knots", "energy_gained", {"knots.compliance": 1.0}
        ),
    ),
    checks=Checks(lambda *_: (0.0, 0.0), _mass),
)
