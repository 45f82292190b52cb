"""How much a captured net gives: it is pulled at its vertex as the scene's test says, after all has been handed over.

Nothing of the pull is in what is handed over: that has been read before. The capture's FMU goes on from the hand-over
through the test that it has in it ([capture.pull_off]). A net that lies loose is drawn tight by it, and friction keeps
most of that; so there are two compliances, and a scene says which is handed over to stand in series with the line:

    first_pull    x/F, the way x of the vertex about the target under the whole load F: what a first tug meets
    drawn_tight   dx/dF as the load falls: what tugs meet after that

Valid    as springs for what is none: the first keeps the energy that the net takes, the other leaves out the way that
         the net is drawn at first, and both are of the load of the test
Checked  tests/cosim/test_pulled.py
"""

from __future__ import annotations

import math
from collections.abc import Container, Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from dcone_cosim.errors import HandoffError
from dcone_cosim.findings import Finding
from dcone_cosim.fmu.component import Steppable
from dcone_cosim.ledger import LedgerRow

KEY, HOW = "net_compliance", ("given", "first_pull", "drawn_tight")
"""Of the table [handoff]: as the scene gives it, or one of those measured."""
GIVEN, FIRST_PULL, DRAWN_TIGHT = HOW
STANDS, LOAD, DRAWN = READ = ("pull_off.stands", "pull_off.load", "pull_off.drawn")
FORCE, LASTS = "pull_off.force", ("pull_off.delay", "pull_off.ramp", "pull_off.ramp", "pull_off.duration")
"""Parameters: the whole load, and what has to pass until it is gone."""
HELD, SLIPPED_OFF = 2, 3
"""Values of `pull_off.stands`, as a capture of ours has them."""
WHOLE = 1.0 - 1e-9
"""Share of the load from which on it is the whole."""
LATE = 4
"""Macro steps by which the test may end late."""
LEAST = 3
"""Samples from which a slope may be told."""
FAR = 2.0
"""How much the first tug may be of the load, or the load of it, without a word [1]."""
STEADY = 0.1
"""Share of the way under the whole load by which it may change there, without a word [1]."""
LEFT = ("net.first_pull", "net.drawn_tight", "net.load", "net.stays", "net.gave_way")
"""Under what a capture leaves what was found."""
TAKES = ("net.compliance", "lumped.end_compliance")
"""Parameters of a removal that take a compliance over, the first that it has."""
COMPLIANCE = "compliance of the net"
"""Quantity of the ledger's row."""


@dataclass(frozen=True)
class Pulled:
    """What a pull has shown.

    first_pull    way of the vertex about the target under the load, over the load       [m/N]
    drawn_tight   change of that way by the load as this falls, by least squares         [m/N]
    load          of the test                                                            [N]
    stays         of that way, when the load is gone                                     [m]
    gave_way      by how much that way grew, or shrank, under the whole load             [m]
    how           which is handed over, one of `HOW`
    """

    first_pull: float
    drawn_tight: float
    load: float
    stays: float
    gave_way: float = 0.0
    how: str = FIRST_PULL

    @classmethod
    def of(cls, left: Mapping[str, float], how: str) -> Pulled | None:
        """As a capture has left it, None where it is not to be handed over; `HandoffError` where it is none."""
        if how == GIVEN:
            return None
        if not left.keys() >= set(LEFT):
            text = f'hand-off refused: handoff.{KEY} = "{how}", and this capture ended without a pull; run it again'
            raise HandoffError(text)
        first_pull, drawn_tight, load, stays, gave_way = (left[name] for name in LEFT)
        found = cls(first_pull, drawn_tight, load, stays, gave_way, how)
        if not found.compliance > 0.0:
            raise HandoffError(
                f"hand-off refused: pulled with {found.load:g} N, the net's vertex moved by {found.compliance:.3g} m/N "
                f"({how.replace('_', ' ')}), which is no compliance; pull harder, or when the net lies still"
            )
        return found

    @property
    def compliance(self) -> float:
        """What is handed over [m/N]."""
        return self.first_pull if self.how == FIRST_PULL else self.drawn_tight

    def left(self) -> dict[str, float]:
        values = (self.first_pull, self.drawn_tight, self.load, self.stays, self.gave_way)
        return dict(zip(LEFT, values, strict=True))

    def told(self) -> dict[str, object]:
        """The same with units."""
        units = dict(zip(LEFT, ("m/N", "m/N", "N", "m", "m"), strict=True))
        told = {name.removeprefix("net."): {"value": v, "unit": units[name]} for name, v in self.left().items()}
        return {"handed_over": self.how, **told}

    def parameters(self, offered: Container[str]) -> dict[str, float]:
        """What to set in a removal that offers these parameters; the ledger does not close on one that takes none."""
        return {name: self.compliance for name in TAKES if name in offered}

    def rows(self, held: Mapping[str, float]) -> list[LedgerRow]:
        """The ledger's row, by what the removal was read back to hold."""
        after = next((held[name] for name in TAKES if name in held), 0.0)
        account = "" if held.keys() & set(TAKES) else f"not carried: the removal FMU has neither {' nor '.join(TAKES)}"
        return [LedgerRow(COMPLIANCE, "m/N", self.compliance, after, 0.0, account, self.compliance)]

    def findings(self, place: str) -> Iterator[Finding]:
        how = self.how.replace("_", " ")
        yield Finding(place, "net_compliance", f"the captured net gives, {how}", self.compliance, "m/N")
        yield Finding(place, "net_load", "measured by a pull at its vertex of", self.load, "N")
        yield Finding(place, "net_drawn", "which draws the vertex out by", self.first_pull * self.load, "m")
        yield Finding(place, "net_stays", "of which stays when the pull is gone", self.stays, "m")


def pull(component: Steppable, time: float, macro_step: float) -> Pulled:
    """Step a capture through its test from `time` on, as its FMU counts [s]; `HandoffError` where it shows nothing.

    macro_step    [s]
    """
    missing = [name for name in (*READ, FORCE, *LASTS) if name not in component.variables]
    if missing:
        raise HandoffError(f"hand-off refused: the capture FMU is to be pulled, and lacks {', '.join(missing)}")
    told = component.get([FORCE, *dict.fromkeys(LASTS)])
    force, lasts = told[FORCE], sum(told[name] for name in LASTS)
    rows: list[tuple[float, float]] = []
    for number in range(math.ceil(lasts / macro_step) + LATE):
        component.step(time + number * macro_step, macro_step)
        seen = component.get(READ)
        if seen[STANDS] == SLIPPED_OFF:
            raise HandoffError(f"hand-off refused: pulled at its vertex with {force:g} N, the net slips off the target")
        rows.append((seen[LOAD], seen[DRAWN]))
        if seen[STANDS] == HELD:
            break
    else:
        raise HandoffError(f"hand-off refused: the pull at the net's vertex did not end within {lasts:g} s")
    loads, drawn = np.array(rows).T
    whole = np.flatnonzero(loads >= WHOLE * force)
    if not len(whole) or len(loads) - whole[-1] < LEAST:
        raise HandoffError(
            f"hand-off refused: macro steps of {macro_step:g} s do not see {force:g} N at the net's vertex come and go"
        )
    held = drawn[whole]
    slope = float(np.polyfit(loads[whole[-1] :], drawn[whole[-1] :], 1)[0])
    return Pulled(float(held.mean()) / force, slope, force, float(drawn[-1]), float(held[-1] - held[0]))


def warnings(place: str, net: Pulled | None, peak: float) -> Iterator[str]:
    """That the way of a net depends on how long it is pulled, or that a first tug, its peak [N], is far off."""
    if net is None:
        return
    way = net.first_pull * net.load
    if abs(net.gave_way) > STEADY * abs(way):
        yield (
            f"{place}: under the whole {net.load:g} N the way of the vertex changed by {net.gave_way:.3g} m, about "
            f"its mean of {way:.3g} m: it was drawn on, or swung, and what is told of how it gives depends on how long "
            "it is pulled; pull it longer, or with a longer ramp, or when it lies still"
        )
    if not 1.0 / FAR <= peak / net.load <= FAR:
        yield (
            f"{place}: the first tug is of {peak:.3g} N, and by how much the net gives was measured at {net.load:g} N: "
            "a loose net gives more for each newton the less it is pulled; pull it about as hard"
        )
