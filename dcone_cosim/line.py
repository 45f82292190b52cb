"""The line across the hand-off: one and the same in both phases, from the chaser to where it is made fast.

The capture's ends at the net's vertex, on the near side of the target. The removal's target is a point, which turns
with the line: its line ends at a distance from the centre of mass, on the line of centres. So length and distance are
handed over, and with them the slack, but for the bend that the line has at the vertex. What an input asks of the reel
comes on top.
"""

from __future__ import annotations

from collections.abc import Container, Mapping
from dataclasses import dataclass

import numpy as np

from dcone_cosim.fmu.component import Steppable
from dcone_cosim.handoff import Handoff
from dcone_cosim.ledger import LedgerRow

ATTACHMENT = "target.attachment_distance"
REST_LENGTH = "tether.rest_length"
MASS = "lumped.mass"
"""Output of a removal whose line has mass."""
LINE_HELD = (ATTACHMENT, REST_LENGTH)
"""Parameters of a removal that say what line it has, as far as it has them."""

OFFSET, LENGTH, SLACK = "attachment to centre of mass", "length of the line", "slack of the line"
"""Quantities of the rows of the ledger."""
LENGTHENED = f"the removal FMU has no {ATTACHMENT}: its line is longer by as much, and has the stiffness of that length"
LOST = f"not carried: the removal FMU has neither {ATTACHMENT} nor {REST_LENGTH}"
"""What becomes of the distance of the attachment in an FMU that cannot take it."""

OVERRUN = 1e-6
"""Share of its length by which a line that was handed over taut may be stretched: the instant is located to 1e-6 s."""


@dataclass(frozen=True)
class Line:
    """The line as the capture leaves it.

    length       unloaded, of the line that is out, None when neither phase tells it   [m]
    reach        from the chaser to where the line is made fast, the net's vertex      [m]
    attachment   from there to the centre of mass of target and net                    [m]
    distance     from the chaser to that centre of mass                                [m]
    """

    length: float | None
    reach: float
    attachment: float
    distance: float

    @property
    def slack(self) -> float | None:
        """Length less reach: how far the attachments can still part [m]."""
        return None if self.length is None else self.length - self.reach

    @property
    def bend(self) -> float:
        """How much longer the way over the attachment is than the straight one to the centre of mass [m]."""
        return self.reach + self.attachment - self.distance

    @property
    def overrun(self) -> bool:
        """Whether the attachments are farther apart than the line is long."""
        return self.length is not None and self.reach > self.length * (1.0 + OVERRUN)


def line_of(handed: Handoff, length: float | None) -> Line:
    """The line of this length [m] between chaser and vertex as the capture left them."""

    def apart(first: np.ndarray, second: np.ndarray) -> float:
        return float(np.linalg.norm(second - first))

    chaser, vertex, center = handed.chaser.position, handed.vertex, handed.joint.position
    return Line(length, apart(chaser, vertex), apart(vertex, center), apart(chaser, center))


def line_parameters(line: Line, offered: Container[str]) -> dict[str, float]:
    """What to set in a removal that offers these parameters, so that its line has the slack of this one.

    A point target that does not know the distance of its attachment is given a line that is longer by it.
    """
    if ATTACHMENT in offered:
        return {ATTACHMENT: line.attachment}
    if REST_LENGTH in offered and line.length is not None:
        return {REST_LENGTH: line.length + line.attachment}
    return {}


def line_notes(offered: Container[str]) -> list[str]:
    """What is to be said beforehand of a hand-over to a removal that offers these variables."""
    return [] if ATTACHMENT in offered else [LENGTHENED if REST_LENGTH in offered else LOST]


def attached_rows(line: Line, held: Mapping[str, float], attachment: np.ndarray, apart: np.ndarray) -> list[LedgerRow]:
    """The same rows where the removal's target turns, its attachment where the capture's is.

    attachment   from the target's centre of mass, as it was read back, orbital axes [m] (3,)
    apart        from the chaser to that centre, likewise [m] (3,)
    """
    size = (line.length or 0.0) + line.reach + line.attachment + line.distance
    rows = [LedgerRow(OFFSET, "m", line.attachment, float(np.linalg.norm(attachment)), 0.0, "", size)]
    if line.length is None or REST_LENGTH not in held:
        return rows
    reach = float(np.linalg.norm(apart + attachment))
    return [
        *rows,
        LedgerRow(LENGTH, "m", line.length, held[REST_LENGTH], 0.0, "", size),
        LedgerRow(SLACK, "m", line.length - line.reach, held[REST_LENGTH] - reach, 0.0, "", size),
    ]


def drawn_rows(handed: Handoff, component: Steppable) -> list[LedgerRow]:
    """The mass of the line's nodes, as the removal computes it; none where its line is massless.

    An FMU of which only that is known has it beside what it was handed, which is told.
    """
    held = component.get([MASS])[MASS] if MASS in component.variables else 0.0
    drawn, total = handed.drawn, handed.chaser.mass + handed.joint.mass + handed.drawn
    if not (drawn > 0.0 or held > 0.0):
        return []
    name, added = "mass, nodes of the line, from the chaser", 0.0 if drawn > 0.0 else held
    account = "added: the line of this FMU has mass, and the chaser keeps its own" if added else ""
    return [LedgerRow(name, "kg", drawn, held, -added, account, total)]


def line_rows(line: Line, given: Mapping[str, float], held: Mapping[str, float], distance: float) -> list[LedgerRow]:
    """Rows of the ledger: distance of the attachment, length of the line, slack, as far as they are known.

    given        what was set in the removal, of `line_parameters`
    held         what it was read back to hold, of `LINE_HELD`
    distance     of chaser and target as it was read back to hold them [m]
    """
    size = (line.length or 0.0) + line.reach + line.attachment + line.distance
    missing = line.attachment - given.get(ATTACHMENT, 0.0)
    account = "" if ATTACHMENT in given else LENGTHENED if REST_LENGTH in given else LOST

    def row(quantity: str, before: float, after: float, accounted: float, account: str) -> LedgerRow:
        return LedgerRow(quantity, "m", before, after, accounted, account, size)

    rows = [row(OFFSET, line.attachment, held.get(ATTACHMENT, 0.0), missing, account)]
    if line.length is None:
        return rows
    slack = line.length - line.reach
    if REST_LENGTH not in held:
        return [*rows, row(SLACK, slack, 0.0, slack, f"not carried: the removal has no {REST_LENGTH}")]
    shorter = line.length - given.get(REST_LENGTH, line.length)
    after = held[REST_LENGTH] + held.get(ATTACHMENT, 0.0) - distance
    bend = f"{line.bend:.3g} m of bend: a point target has the attachment on the line of centres"
    return [
        *rows,
        row(LENGTH, line.length, held[REST_LENGTH], shorter, account),
        row(SLACK, slack, after, -line.bend, bend),
    ]
