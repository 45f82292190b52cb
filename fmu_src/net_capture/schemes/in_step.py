"""What schemes share whose velocities belong to the instant of the positions, and that leave no row asleep."""

from __future__ import annotations

from typing import Any, NamedTuple

from fmu_src.net_capture.planes import FX, SHOWN, SHOWN_BACK, SHOWN_RATE, P, U, X
from orbital.kernel import kernel


class InStep(NamedTuple):
    """Kernels for planes of nodes.

    copy(p, work, source, target)   three planes into three others
    clear(p, work)                  no force on any node
    begin(p, work)                  the dashpots see the velocities of the start
    place(p, work)                  positions and velocities as they are, see `schemes.Scheme`
    """

    copy: Any
    clear: Any
    begin: Any
    place: Any


def make_in_step(composition: Any) -> InStep:
    """Kernels for the composition's memory and precision."""
    node_plane, reals_of, lanes = composition.memory.node_plane, composition.memory.reals, composition.lanes
    load, store, width = lanes.load, lanes.store, lanes.width

    @kernel
    def copy(p, work, source, target):
        """Three planes into three others.

        Checked  tests/net_capture/test_schemes.py
        """
        reals, slots = reals_of(work), p.node_slots
        for i in range(0, 3 * slots, width):
            store(reals, i + target * slots, load(reals, i + source * slots))

    @kernel
    def clear(p, work):
        """No force on any node.

        Checked  tests/net_capture/test_schemes.py
        """
        for axis in range(3):
            for i in range(p.node_slots):
                node_plane(p, work, FX + axis)[i] = 0.0

    @kernel
    def begin(p, work):
        """Positions and velocities belong to the same instant already.

        Checked  tests/net_capture/test_schemes.py
        """
        copy(p, work, U, P)

    @kernel
    def place(p, work):
        """Positions and velocities as they are.

        Checked  tests/net_capture/test_schemes.py
        """
        copy(p, work, X, SHOWN)
        copy(p, work, U, SHOWN_RATE)
        copy(p, work, U, SHOWN_BACK)

    return InStep(copy, clear, begin, place)


def make_rouse(composition: Any) -> Any:
    """Kernel `rouse(p, work, node)`: every node is where it is now."""

    @kernel
    def rouse(p, work, node):
        """Every node is where it is now."""

    return rouse


def make_rouse_all(composition: Any) -> Any:
    """Kernel `rouse_all(p, work)`: every node is where it is now."""

    @kernel
    def rouse_all(p, work):
        """Every node is where it is now."""

    return rouse_all
