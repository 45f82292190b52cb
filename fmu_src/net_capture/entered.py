"""What a shot's energy book is measured by: the energy that came into net, bullets and vertex.

    E(t) = kinetic(0) + sum over the works of max |W| + sum over what gives of max (E(0) - E)

each up to t. Works are those of reels, tether, test load, ejector and a gravity that changes; the field gives what its
potential falls by, and a target what its motion and spin lose. A net let fall from rest has so what gravity gave it.

Checked  tests/net_capture/test_entered.py
"""

from __future__ import annotations

from typing import Protocol

import numpy as np
import numpy.typing as npt

from fmu_src.cautions import Seen

KINETIC = "energy.kinetic"
WORKS = ("closing.work", "tether.work", "pull_off.work", "ejection.work", "gravity.work")
GIVERS = ("energy.potential", "target.energy")
"""Energies that fall where they give."""


class Columns(Protocol):
    """Outputs over time by name."""

    def __contains__(self, name: str, /) -> bool: ...

    def __getitem__(self, name: str, /) -> npt.NDArray[np.float64]: ...


def over_time(columns: Columns) -> npt.NDArray[np.float64]:
    """It up to each instant [J], of the outputs that there are: of all, the kinetic energy alone must be."""
    energy = np.full(len(columns[KINETIC]), columns[KINETIC][0])
    for name in WORKS:
        if name in columns:
            energy = energy + np.maximum.accumulate(np.abs(columns[name]))
    for name in GIVERS:
        if name in columns:
            energy = energy + np.maximum.accumulate(columns[name][0] - columns[name])
    return energy


def by_the_end(seen: Seen) -> float | None:
    """It up to the end [J], from the ranges of outputs; None where the kinetic energy is not told."""
    kinetic = seen(KINETIC)
    if kinetic is None:
        return None
    works = [work for work in map(seen, WORKS) if work is not None]
    givers = [giver for giver in map(seen, GIVERS) if giver is not None]
    given = sum(giver.first - giver.least for giver in givers)
    return kinetic.first + sum(max(abs(work.least), abs(work.largest)) for work in works) + given
