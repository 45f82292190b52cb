"""The nets there are, by the name a scene gives them.

A net's kernels, `make(composition) -> Net`, write it down as a graph (see `planes`); nothing else knows its shape. Its
`checks` say in closed form, before any build or run, what a scene's values come to.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

Values = Mapping[str, float]

USUAL_BULLETS = 4
LARGEST_MESH = 400
"""Meshes times segments along one side: an instance then takes 30 MB."""


class Net(NamedTuple):
    """Kernels of a net.

    count(p, work) -> fault  how many of everything there are, and the size of the mouth, into the record
    lay_out(p, work)         write strips, corners, apex and faces, and every node's place in the net as it is meant to
                             open, into the planes of what is shown: along the mouth's two axes and along the shot [m]
    rim_node(p, n)           the n-th node of the rim
    thread(p)                stiffness [N/m], dashpot [N s/m] of the stiffest piece of thread, and mass of a node
                             between two threads like it [kg]: what the bound of the substep is reckoned from
    """

    count: Any
    lay_out: Any
    rim_node: Any
    thread: Any


class Hanging(NamedTuple):
    """Length of thread [m] whose mass hangs on a knot inside the net, on its edge, and where a bullet is made fast:
    half of every thread that ends there, the largest of each."""

    inside: float
    edge: float
    corner: float


class Checks(NamedTuple):
    """What a net says before any build or run, of values by FMI name.

    corner(values)     place of a bullet in the net as meant, along both axes of the mouth           [m]
    widths(values)     of the mouth along both axes                                                  [m]
    sides(values)      of the rim from each bullet to the next, by the name of the variable that is to blame for it;
                       one alone: all are equal                                                      [m]
    knots(values)      of the rim between two bullets, where there are fewest                        [1]
    total(values)      length of all threads                                                         [m]
    shortest(values)   length of a thread of which a net of square meshes is as stiff for its mass as this one where it
                       is stiffest: the square root of the least sum of l over sum of 1/l at a knot  [m]
    hanging(values)    what hangs on its knots
    nodes(values)      with the inner nodes of all threads; 1 where there is no such net             [1]
    bullets            how many the shape has
    drawing(values)    the threads as lines from knot to knot, and the rim, closed: numbers of nodes as the outputs
                       count them
    """

    corner: Callable[[Values], tuple[float, float]]
    widths: Callable[[Values], tuple[float, float]]
    sides: Callable[[Values], dict[str, float]]
    knots: Callable[[Values], int]
    total: Callable[[Values], float]
    shortest: Callable[[Values], float]
    hanging: Callable[[Values], Hanging]
    nodes: Callable[[Values], int]
    drawing: Callable[[Values], tuple[list[list[int]], list[int]]]
    bullets: int = USUAL_BULLETS


def nets() -> dict[str, Any]:
    """Every net's term, by name."""
    from fmu_src.net_capture.nets import cone, hexagon, pyramid, radial, rectangle, square

    return {
        "square": square.PART,
        "rectangle": rectangle.PART,
        "pyramid": pyramid.PART,
        "cone": cone.PART,
        "radial": radial.PART,
        "hexagon": hexagon.PART,
    }
