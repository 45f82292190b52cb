"""What draws the mouth together, by the name a scene gives it."""

from __future__ import annotations

from typing import Any, NamedTuple


class Closing(NamedTuple):
    """Kernels of one way of closing.

    start(p, work) -> fault                 nothing is triggered yet
    pull(p, work)                           add its forces to the nodes, for a substep
    pull_shown(p, work)                     the same for the positions and velocities shown
    wind(p, work)                           go on by the substep at whose end the nodes now are
    trigger(p, work, now, touched, reached) start when the trigger has fallen: time [s], instant of the first touch [s]
                                            or -1, whether the trigger's distance has been reached
    stored(p, work)                         elastic energy as shown [J]
    stiffen(p, work, span)                  give the pace what may meet at each node within a time [s]; the nodes as
                                            shown; None where the pace asks for nothing
    """

    start: Any
    pull: Any
    pull_shown: Any
    wind: Any
    trigger: Any
    stored: Any
    stiffen: Any


def closings() -> dict[str, Any]:
    """Every way of closing, by name."""
    from fmu_src.net_capture.closing import springs, winches

    return {"winches": winches.PART, "springs": springs.PART}
