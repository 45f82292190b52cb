"""What patterns of folds have in common: the zigzag, and rows and checks of a canister."""

from __future__ import annotations

import math
from typing import Any

from fmu_src.extremes import Extreme, times
from fmu_src.interface import fault
from fmu_src.net_capture.planes import MASS, SHOWN
from orbital.kernel import kernel

DEPTH = "canister.depth"
TOO_DEEP = fault("too_deep", DEPTH, "canister.depth must be less than half of what the mouth of the net is wide")
TOO_WIDE = fault("too_wide", "canister.width", "the canister must be narrower than the mouth of the net is wide")


def extremes(width: str) -> tuple[Extreme, ...]:
    """The ends of a canister's range; `width` is the parameter across the shot."""
    return (
        Extreme(
            "canister a tenth as wide",
            "folds much narrower than a mesh",
            "energy_gained",
            {width: times(width, 0.1)},
            chief=True,
        ),
        Extreme("canister of 1 mm depth", "layers that all but touch", "energy_gained", {DEPTH: 1e-3}),
        Extreme("canister 1 km deep", "no net folds into that: it is to be refused", "refused", {DEPTH: 1e3}),
    )


GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)


@kernel
def fold_width(width, mesh):
    """How wide a band is folded [m]: as wide as the canister, or where a mesh is wider than that, as much less as
    spreads the knots evenly over the width, in place of laying all of them on one spot.

        mesh / (2 w) = k + g  or  k + 1 - g,   g = (sqrt(5) - 1) / 2,   the least that fits, k a whole number

    width    of the canister                  [m]
    mesh     from knot to knot of the net     [m]

    Checked  tests/net_capture/test_folding.py
    """
    if mesh <= width:
        return width
    turns = 0.5 * mesh / width
    whole = math.floor(turns)
    if turns <= whole + 1.0 - GOLDEN:
        return 0.5 * mesh / (whole + 1.0 - GOLDEN)
    return 0.5 * mesh / (whole + (GOLDEN if turns <= whole + GOLDEN else 2.0 - GOLDEN))


@kernel
def zigzag(way, width):
    """Place on a strip of that width of a band laid to and fro on it [m], from its middle.

    way     along the band, from its beginning    [m]
    width   of the strip                          [m]

    Places on the band are nowhere farther apart on the strip.

    Checked  tests/net_capture/test_folding.py
    """
    on = abs(way) % (2.0 * width)
    return (on if on < width else 2.0 * width - on) - 0.5 * width


def make_spans(composition: Any) -> Any:
    """Kernel `spans(p, work) -> (along, across)`: widths [m] of what is to be folded, along both axes of the mouth.

    With leads, which reach out beyond it, they are those of all nodes; otherwise of the mouth.
    """
    node_plane, has_leads = composition.memory.node_plane, "leads" in composition.terms

    @kernel
    def span(p, work, axis):
        """Width along one axis [m].

        Checked  tests/net_capture/test_folding.py
        """
        found = p.mouth_width[axis]
        if has_leads:
            mass, place = node_plane(p, work, MASS), node_plane(p, work, SHOWN + axis)
            for node in range(p.node_slots):
                if mass[node] > 0.0:
                    found = max(found, 2.0 * abs(place[node]))
        return found

    @kernel
    def spans(p, work):
        """Widths along both [m].

        Checked  tests/net_capture/test_folding.py
        """
        return span(p, work, 0), span(p, work, 1)

    return spans
