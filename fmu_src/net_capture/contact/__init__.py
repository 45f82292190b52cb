"""Contact of nodes with the target, by the law a scene names."""

from __future__ import annotations

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
    """

    start: Any
    begin_step: Any
    touch_row: Any
    clear_steps: Any
    hurries: Any
    measure: Any


def contacts() -> dict[str, Any]:
    """Every law's term, by name."""
    from fmu_src.net_capture.contact import inelastic

    return {"inelastic": inelastic.PART}
