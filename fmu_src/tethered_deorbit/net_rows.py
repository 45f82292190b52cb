"""The variables of what holds the line at the target, in series with it, and what it goes with."""

from __future__ import annotations

from fmu_src.interface import Group, Term
from fmu_src.rows import at_least_zero, state
from fmu_src.tethered_deorbit import stress

SERIES = Group(
    {
        "series": Term(
            "a closed net in series with the line, which gives under its pull",
            (
                at_least_zero("net.compliance", "m/N", "by how much the net gives per newton of the line's pull", 1e-3,
                              1e6),
                state("state.give", "m", "of the line alone that would give as much as the net"),
            ),
            excludes=("lumped",),
            carries={"reel": ("locked",)},
            extremes=stress.SERIES,
        ),
    },
    optional=True,
    follows=lambda terms, values: "series",
)  # fmt: skip
