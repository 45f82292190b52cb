"""Threads that break where their tension exceeds their strength; both their nodes fly on.

A thread breaks at the instant of the first substep in which it bears more: it still pulls for the half substep that
leads there, and its nodes then have the velocities of that instant. Its elastic energy is booked as what the break
takes. The others go on, and what they bear grows; nothing else knows of a hole in the net.

Valid    a thread as strong everywhere as its weakest place, however long the load lasts
Source   ours
Checked  tests/net_capture/test_breaking.py
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from fmu_src.extremes import Extreme
from fmu_src.interface import Term
from fmu_src.net_capture.planes import FIRST, LANES, STRIP_WORDS
from fmu_src.net_capture.refusal import Refusal, Scene
from fmu_src.rows import count, output, peak, positive
from orbital.kernel import kernel

SCHEME = "leapfrog"
"""That lets threads break."""


class Breaking(NamedTuple):
    """Kernels of threads that break.

    start(p)                 a whole net
    tear(p, table, strip)    take the threads out of a strip that `threads.pull` has found to bear too much
    """

    start: Any
    tear: Any


def make(composition: Any) -> Breaking:
    """Kernels for the composition's clock."""
    from fmu_src.lanes import lowest, peek, poke, population

    if composition.terms["solver"] != SCHEME:
        raise ValueError(f"net_capture: break needs solver = {SCHEME!r}")
    now = composition.clock.now

    @kernel
    def start(p):
        """A whole net.

        Checked  tests/net_capture/test_breaking.py
        """
        p.break_count = 0
        p.break_first = 0
        p.break_time = -1.0
        p.break_energy = 0.0
        p.torn_lanes = 0

    @kernel
    def tear(p, table, strip):
        """Take the threads of `torn_lanes` out of a strip.

        Checked  tests/net_capture/test_breaking.py
        """
        torn = np.uint64(p.torn_lanes)
        if torn != np.uint64(0):
            s = STRIP_WORDS * strip
            poke(table, s + LANES, np.int64(np.uint64(peek(table, s + LANES)) & ~torn))
            if p.break_count == 0:
                p.break_time = now(p)
                p.break_first = peek(table, s + FIRST) + np.int64(lowest(torn)) + 1
            p.break_count += population(torn)
            p.torn_lanes = 0

    return Breaking(start, tear)


def refuses(scene: Scene) -> Iterator[Refusal]:
    """A scheme that keeps all threads whole."""
    scheme = scene.terms.get("solver", SCHEME)
    if scheme != SCHEME:
        yield Refusal("solver.scheme", f'"{scheme}"', f'keeps all threads whole; [capture.break] needs "{SCHEME}"')


PART = Term(
    "a thread breaks where its tension exceeds its strength, and both its nodes fly on",
    (
        positive("break.strength", "N", "tension at which a thread breaks: 0.191 mm2 of 2.92 GPa", 558.0),
        count("break.count", "threads that have broken"),
        count("break.first", "which thread broke first, counted from 1; 0 before"),
        peak("break.time", "s", "when the first broke, since the shot; -1 before"),
        output("break.energy", "J", "elastic energy of the threads as they broke"),
        count("torn_lanes", "lanes of the present strip that bear too much, a bit each", "state"),
    ),
    make=make,
    refuses=refuses,
    extremes=(
        Extreme(
            "threads as weak as a cobweb", "they break as they come taut", "energy_gained", {"break.strength": 1e-9}
        ),
    ),
)
