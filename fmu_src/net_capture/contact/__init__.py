"""Contact of nodes with the target, by the law a scene names."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple


class Contact(NamedTuple):
    """Kernels of one law.

    start(p, work) -> fault               nothing touched yet; the nodes as shown
    begin_step(p, rate)                   what all rows of a substep need of the target
    touch_row(p, work, first)             contact of a row of nodes that have just drifted, before the target moves; how
                                          many were touched [count], -1 if none was near the target
    clear_steps(p, work, first, pulled)   substeps for which no node of a row comes near, flying freely or pulled by its
                                          threads [count]
    hurries(p)                            whether the target has become faster, or a thread tauter (`contact_force`),
                                          than `clear_steps` reckoned with
    measure(p, work)                      what is reported, of the positions shown
    weigh(p, work)                        what it may add to the stiffness of a node, over its mass, half of it, into
                                          `contact_stiffening` [1/s2]; None: nothing, and it stores no energy
    """

    start: Any
    begin_step: Any
    touch_row: Any
    clear_steps: Any
    hurries: Any
    measure: Any
    weigh: Any = None


class Checks(NamedTuple):
    """What is known of a law before it is made.

    planes                    node planes of its own, behind those of scheme and pace
    stiffening(values, node, mass, nodes, radius)   the same [1/s2] of values by FMI name, a node between two pieces of
                              thread [kg], mass [kg] and number of all nodes, `radius` of the shape; None: nothing
    """

    planes: int = 0
    stiffening: Callable[[Mapping[str, float], float, float, int, Any], float] | None = None


def contacts() -> dict[str, Any]:
    """Every law's term, by name."""
    from fmu_src.net_capture.contact import inelastic, penalty

    return {"inelastic": inelastic.PART, "penalty": penalty.PART}
