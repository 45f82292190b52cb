"""One substep for the whole run: that of the net with every thread taut."""

from __future__ import annotations

from typing import Any

from fmu_src.interface import Term
from fmu_src.net_capture.pace import Clock, Traits
from orbital.kernel import kernel


@kernel
def now(p):
    """Grid time since the shot [s].

    Checked  tests/net_capture/test_free_flight.py
    """
    return p.grid * p.solver_substep


@kernel
def reach(p, end):
    """Number of the substep, with its fraction, at which a time of the tool's clock lies [1].

    Checked  tests/net_capture/test_free_flight.py
    """
    return (end - p.start_time) / p.solver_substep


@kernel
def due(p):
    """Whether mouth and capture are to be looked at now.

    Checked  tests/net_capture/test_outcome.py
    """
    return p.grid % p.measure_every == 0


@kernel
def looks(p):
    """How often they have been looked at [1].

    Checked  tests/net_capture/test_outcome.py
    """
    return p.grid // p.measure_every


def make_nothing(composition: Any) -> None:
    """Nothing is kept, and nothing ever changed."""


PART = Term(
    "of one length, which the net would need with every thread taut",
    make=make_nothing,
    checks=Traits(Clock(now, reach, due, looks), make_nothing),
)
