"""What is rigged to a net beside its own threads: knots with a mass, a rope along the rim, leads to the bullets.

Each is a group of its own that a scene may leave out, and adds nodes and strips to the graph of whatever net there is
(see `planes`); none of them knows its shape.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from typing import Any, NamedTuple

Values = Mapping[str, float]


class Rig(NamedTuple):
    """Kernels of one rigging.

    count(p)                 add what it brings to the counts of the graph; a fault code or 0
    lay_out(p, work)         write its strips, masses and places into a graph that the net is in already
    rates(p, thread, dashpot, node)
                             sums of the stiffnesses [1/s2] and of the dashpots [1/s] that meet at a node of it that is
                             stiffest for its mass, over that; of a net with such a piece of thread [N/m], [N s/m] and
                             such a node between two of them [kg]
    """

    count: Any
    lay_out: Any
    rates: Any


class Checks(NamedTuple):
    """What a rigging says before any build or run, of values by FMI name; `net` are the checks of the net.

    rates(values, net, thread, dashpot, node)   as the kernel
    mass(values, net)                           it adds [kg]
    nodes(values, net)                          it adds [1]
    threads(values, net)                        it adds [1]
    corner(values, net)                         mass [kg] that hangs on a bullet; None: it is that of the net's corner
    reach(values)                               how far beyond the corner of the mouth bullets are in the open net [m]
    lines(values, net)                          what it adds to the drawing of the net
    """

    rates: Callable[[Values, Any, float, float, float], tuple[float, float]]
    mass: Callable[[Values, Any], float]
    nodes: Callable[[Values, Any], int] = lambda values, net: 0
    threads: Callable[[Values, Any], int] = lambda values, net: 0
    corner: Callable[[Values, Any], float] | None = None
    reach: Callable[[Values], float] = lambda values: 0.0
    lines: Callable[[Values, Any], list[list[int]]] = lambda values, net: []


def at_bullets(net: Any, rigs: Iterable[Checks]) -> Any:
    """The checks of a net so rigged, with the corners where the bullets are: straight on from the middle."""

    def corner(values: Values) -> tuple[float, float]:
        x, y = net.corner(values)
        farther = 1.0 + sum(rig.reach(values) for rig in rigs) / math.hypot(x, y)
        return farther * x, farther * y

    rigs = list(rigs)
    return net._replace(corner=corner)


def riggings() -> dict[str, Any]:
    """Every rigging's term, by the name of its group."""
    from fmu_src.net_capture.rigging import edge, knots, leads

    return {"knots": knots.PART, "edge": edge.PART, "leads": leads.PART}
