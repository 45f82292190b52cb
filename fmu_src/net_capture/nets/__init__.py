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
    rim_gap(p, n)            from that to the next, as the net is meant [m]
    thread(p)                stiffness [N/m], dashpot [N s/m] of the stiffest piece of thread, and mass of a node
                             between two threads like it [kg]: what the bound of the substep is reckoned from
    knots(p)                 how many knots there are [1], and knot_slot(p, k), the slot of the k-th, of a net whose
                             outputs count them in another order than that of their slots; None of all others
    """

    count: Any
    lay_out: Any
    rim_node: Any
    rim_gap: Any
    thread: Any
    knots: Any = None
    knot_slot: Any = None


class Hanging(NamedTuple):
    """Mass of thread [kg] that hangs on a knot inside the net, on its edge, and where a bullet is made fast: half of
    every thread that ends there, the largest of each; with threads uncut. `alike`: whether all inside have the same."""

    inside: float
    edge: float
    corner: float
    alike: bool = True


class Thread(NamedTuple):
    """What the threads of a net are; where they differ, what is said of each size.

    section      of the thinnest; None where nothing tells it    [m2]
    strength     E A of the softest                              [N]
    stiffness    from knot to knot, of the stiffest              [N/m]
    dashpot      of that                                         [N s/m]
    mass         from knot to knot, of the lightest              [kg]
    hardest      E A of the one where it is most                 [N]
    softest      from knot to knot, where it is least            [N/m]
    called       which one stiffness and dashpot are of, where all have one section
    """

    section: float | None
    strength: float
    stiffness: float
    dashpot: float
    mass: float
    hardest: float
    softest: float
    called: str = "a thread"


class Checks(NamedTuple):
    """What a net says before any build or run, of values by FMI name. The tables of a part stand among the values.

    corner(values)     place of a bullet in the net as meant, along both axes of the mouth           [m]
    widths(values)     of the mouth along both axes                                                  [m]
    sides(values)      of the rim, from each bullet to the next                                      [m]
    narrow(values)     name of what is to blame where the shortest of them is too short
    knots(values)      of the rim between two bullets, where there are fewest                        [1]
    gap(values)        from knot to knot of the rim, the least                                       [m]
    total(values)      length of all threads                                                         [m]
    mass(values)       of all threads                                                                [kg]
    thread(values)     what they are
    piece(values)      stiffness [N/m], dashpot [N s/m] and mass [kg] of the kernel `Net.thread`
    hanging(values)    what hangs on its knots
    finest(values)     length of the shortest thread [m] and mass of the lightest [kg], from knot to knot
    nodes(values)      with the inner nodes of all threads; 1 where there is no such net             [1]
    drawing(values)    the threads as lines from knot to knot, and the rim, closed: numbers of nodes as the outputs
                       count them
    turns(values)      the rim's nodes that are corners, by their places in that rim; None: its threads are all as long
    bullets(values)    how many the shape has
    uneven(values)     the most by which a bullet stands beside the middle of its sector, where as many equal ones as
                       there are bullets lie round the shot's axis, in halves of a sector                [1]
    sound(values)      whether the others have an answer
    """

    corner: Callable[[Values], tuple[float, float]]
    widths: Callable[[Values], tuple[float, float]]
    sides: Callable[[Values], list[float]]
    narrow: Callable[[Values], str]
    knots: Callable[[Values], int]
    gap: Callable[[Values], float]
    total: Callable[[Values], float]
    mass: Callable[[Values], float]
    thread: Callable[[Values], Thread]
    piece: Callable[[Values], tuple[float, float, float]]
    hanging: Callable[[Values], Hanging]
    finest: Callable[[Values], tuple[float, float]]
    nodes: Callable[[Values], int]
    drawing: Callable[[Values], tuple[list[list[int]], list[int]]]
    turns: Callable[[Values], list[int]] | None = None
    bullets: Callable[[Values], int] = lambda values: USUAL_BULLETS
    sound: Callable[[Values], bool] = lambda values: True
    uneven: Callable[[Values], float] = lambda values: 0.0


def nets() -> dict[str, Any]:
    """Every net's term, by name."""
    from fmu_src.net_capture.nets import cone, hexagon, pyramid, radial, rectangle, square, table

    return {
        "square": square.PART,
        "rectangle": rectangle.PART,
        "pyramid": pyramid.PART,
        "cone": cone.PART,
        "radial": radial.PART,
        "hexagon": hexagon.PART,
        "table": table.PART,
    }
