"""The nets there are, by the name a scene gives them.

A net's kernels, `make(composition) -> Net`, write it down as a graph (see `planes`); nothing else knows its shape. Its
`checks` say in closed form, before any build or run, what a scene's values come to.
"""

from __future__ import annotations

from typing import Any, NamedTuple

LARGEST_MESH = 400
"""Meshes times segments along one side: an instance then takes 30 MB."""


class Net(NamedTuple):
    """Kernels of a net.

    count(p, work) -> fault  how many of everything there are, and the size of the mouth, into the record
    lay_out(p, work)         write the graph, the masses of its threads, and every node's place in the net as it is
                             meant to open, into the planes of what is shown: along the mouth's two axes and along
                             the shot [m]
    thread(p)                stiffness [N/m], dashpot [N s/m] of the stiffest piece of thread, and mass of a node
                             between two threads like it [kg]: what the bound of the substep is reckoned from
    """

    count: Any
    lay_out: Any
    thread: Any


def nets() -> dict[str, Any]:
    """Every net's term, by name."""
    from fmu_src.net_capture.nets import pyramid, rectangle, square

    return {"square": square.PART, "rectangle": rectangle.PART, "pyramid": pyramid.PART}
