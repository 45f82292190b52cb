"""How much a captured net gives: it is pulled at its vertex as the scene's test says, after all has been handed over.

Nothing of the pull is in what is handed over: that has been read before. The capture's FMU goes on from the hand-over
through the test that it has in it ([capture.pull_off]), and what its vertex has moved about the target under the whole
load, over that load, is handed over as the compliance of the net in series with the line. A net that lies loose is
drawn tight by that; what of it stays when the load is gone is told beside.
"""

from __future__ import annotations

import math
from collections.abc import Container, Iterator, Mapping
from dataclasses import dataclass

from dcone_cosim.errors import HandoffError
from dcone_cosim.findings import Finding
from dcone_cosim.fmu.component import Steppable
from dcone_cosim.ledger import LedgerRow

KEY = "measure_net"
"""Of the table [handoff]."""
STANDS, LOAD, DRAWN = READ = ("pull_off.stands", "pull_off.load", "pull_off.drawn")
FORCE, LASTS = "pull_off.force", ("pull_off.delay", "pull_off.ramp", "pull_off.ramp", "pull_off.duration")
"""Parameters: the whole load, and what has to pass until it is gone."""
HELD, SLIPPED_OFF = 2, 3
"""Values of `pull_off.stands`, as a capture of ours has them."""
WHOLE = 1.0 - 1e-9
"""Share of the load from which on it is the whole."""
LATE = 4
"""Macro steps by which the test may end late."""
GIVES, AT, STAYS = LEFT = ("net.compliance", "net.load", "net.stays")
"""Under what a capture leaves what was found."""
TAKES = ("net.compliance", "lumped.end_compliance")
"""Parameters of a removal that take a compliance over, the first that it has."""
COMPLIANCE = "compliance of the net"
"""Quantity of the ledger's row."""


@dataclass(frozen=True)
class Pulled:
    """What a pull has shown.

    compliance   way of the vertex about the target under the load, over the load [m/N]
    load         of the test [N]
    stays        of that way, when the load is gone [m]
    """

    compliance: float
    load: float
    stays: float

    @classmethod
    def of(cls, left: Mapping[str, float]) -> Pulled | None:
        """As a capture has left it, None where it was not pulled."""
        return cls(left[GIVES], left[AT], left[STAYS]) if GIVES in left else None

    def left(self) -> dict[str, float]:
        return {GIVES: self.compliance, AT: self.load, STAYS: self.stays}

    def told(self) -> dict[str, object]:
        """The same with units."""
        sizes = (("compliance", self.compliance, "m/N"), ("load", self.load, "N"), ("stays", self.stays, "m"))
        return {name: {"value": value, "unit": unit} for name, value, unit in sizes}

    def parameters(self, offered: Container[str]) -> dict[str, float]:
        """What to set in a removal that offers these parameters; `HandoffError` where it takes none."""
        name = next((name for name in TAKES if name in offered), None)
        if name is None:
            raise HandoffError(f"hand-off refused: the removal FMU has neither {TAKES[0]} nor {TAKES[1]}")
        return {name: self.compliance}

    def rows(self, held: Mapping[str, float]) -> list[LedgerRow]:
        """The ledger's row, by what the removal was read back to hold."""
        after = next(held[name] for name in TAKES if name in held)
        return [LedgerRow(COMPLIANCE, "m/N", self.compliance, after, 0.0, "", self.compliance)]

    def findings(self, place: str) -> Iterator[Finding]:
        yield Finding(place, "net_compliance", "the captured net gives", self.compliance, "m/N", shown_in="mm/N")
        yield Finding(place, "net_load", "under a pull at its vertex of", self.load, "N")
        yield Finding(place, "net_drawn", "which draws the vertex out by", self.compliance * self.load, "m")
        yield Finding(place, "net_stays", "of which stays when the pull is gone", self.stays, "m")


def pull(component: Steppable, time: float, macro_step: float) -> Pulled:
    """Step a capture through its test from `time` on, as its FMU counts [s]; `HandoffError` where it shows nothing.

    macro_step    [s]

    Checked  tests/cosim/test_pulled.py
    """
    missing = [name for name in (*READ, FORCE, *LASTS) if name not in component.variables]
    if missing:
        raise HandoffError(f"hand-off refused: the capture FMU is to be pulled, and lacks {', '.join(missing)}")
    told = component.get([FORCE, *dict.fromkeys(LASTS)])
    force, lasts = told[FORCE], sum(told[name] for name in LASTS)
    drawn, last = [], math.nan
    for number in range(math.ceil(lasts / macro_step) + LATE):
        component.step(time + number * macro_step, macro_step)
        stands, load, way = component.get(READ).values()
        if stands == SLIPPED_OFF:
            raise HandoffError(f"hand-off refused: pulled at its vertex with {force:g} N, the net slips off the target")
        if stands == HELD:
            break
        if load >= WHOLE * force:
            drawn.append(way)
        last = way
    else:
        raise HandoffError(f"hand-off refused: the pull at the net's vertex did not end within {lasts:g} s")
    mean = sum(drawn) / len(drawn) if drawn else math.nan
    if not mean > 0.0:
        seen = f"moved by {mean:.3g} m" if drawn else f"never bore all of it in macro steps of {macro_step:g} s"
        raise HandoffError(
            f"hand-off refused: under {force:g} N at the net's vertex that {seen}, which is no compliance; let the "
            "test begin later or pull harder, or give the compliance"
        )
    return Pulled(mean / force, force, last)
