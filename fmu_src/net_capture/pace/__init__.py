"""How long the substeps are: one length for a whole run, or one that follows the net, by the name a scene gives it.

Whatever the macro step: a pace looks at the grid alone, so a scene gives the same bits in every tool.
"""

from __future__ import annotations

from typing import Any, NamedTuple


class Clock(NamedTuple):
    """Kernels that tell the time on the grid.

    now(p)          grid time since the shot [s]
    reach(p, end)   number of the substep, with its fraction, at which a time of the tool's clock [s] lies [1]
    due(p)          whether mouth and capture are to be looked at now
    looks(p)        how often they have been [1]
    """

    now: Any
    reach: Any
    due: Any
    looks: Any


class Traits(NamedTuple):
    """What is known of a pace before it is made.

    clock    see `Clock`
    make_meeting(composition)   what keeps the sums at the nodes, with a kernel `meet_both(p, work, node, stiffness,
             dashpot)` for whatever else than threads holds a node; None: nothing is kept
    planes   node planes of its own, behind those of the scheme
    masks    whole numbers of work memory for each strip, behind those of the scheme
    """

    clock: Clock
    make_meeting: Any
    planes: int = 0
    masks: int = 0


class Pace(NamedTuple):
    """Kernels of a pace at which the substep changes; one that stands still has none.

    note(p, reals, table, numbers, words, strip, taut)   threads that are taut in this substep, a bit each
    start(p, work)                       nothing noted yet; the nodes as shown
    look(p, work) -> step                what the coming interval allows [s]; the nodes as shown
    wanted(p) -> step                    what is left of it allows, by what has been noted [s]
    settle(p, step) -> substep           the substep with which the rest of the interval is walked [s]
    """

    note: Any
    start: Any
    look: Any
    wanted: Any
    settle: Any


def paces() -> dict[str, Any]:
    """Every pace's term, by name."""
    from fmu_src.net_capture.pace import fixed, following

    return {"fixed": fixed.PART, "following": following.PART}
