"""Which load governs the line: what each by itself asks of its diameter.

    snap        the hardest tug of all runs, at the fixed point, by simulation
    dashpot     what the model's dashpot puts on top: from a damping ratio of one half on it is the peak, and the line's
                own elasticity is not
    steady      what thrust and tide keep in the line, or the largest of the last orbit, without tugs
    handling    the least breaking load that the scene asks for
    debris cut  the line is cut by particles of a third of its diameter at most so often

Checked  tests/sizing/test_governs.py
"""

from __future__ import annotations

from dataclasses import dataclass

from dcone_cosim.sizing.flux import YEAR
from dcone_cosim.sizing.options import Options
from dcone_cosim.sizing.required import Required
from orbital import tethers
from orbital.materials import Material

SNAP, DASHPOT, STEADY, HANDLING, CUT = "snap", "dashpot", "steady load", "handling", "debris cut"


@dataclass(frozen=True)
class Demand:
    """What a load asks of the line: its size [N] (NaN where it is none), and the diameter [m]."""

    load: str
    size: float
    diameter: float
    how: str


def demands(needed: Required, zeta: float, steady: float, length: float, time: float, options: Options) -> list[Demand]:
    """Demands of every load on a line of a material, the largest first.

    steady     tension without tugs [N];  length   that is out [m];  time   for which [s]
    """
    material, factor = needed.material, options.factor_of_safety
    assert material.strength is not None
    tug = DASHPOT if zeta >= tethers.DASHPOT_GOVERNS else SNAP
    jump = (
        "the model's dashpot as the line goes taut, not the line" if tug == DASHPOT else "the hardest tug of all runs"
    )
    found = [
        Demand(tug, needed.peak, needed.diameter, f"{jump}, at the fixed point, FoS {factor:g}"),
        Demand(STEADY, steady, _bears(steady, material, factor), f"without tugs, FoS {factor:g}"),
        Demand(
            HANDLING, options.least_breaking_load, _bears(options.least_breaking_load, material, 1.0),
            "least_breaking_load" if options.least_breaking_load else "the scene asks for none: least_breaking_load",
        ),
        Demand(
            CUT, float("nan"), options.flux.diameter(options.cut_probability, time, length),
            f"{100 * options.cut_probability:g} % in {time / YEAR:.3g} years over {length:g} m",
        ),
    ]  # fmt: skip
    return sorted(found, key=lambda one: -one.diameter if one.diameter == one.diameter else 0.0)


def _bears(load: float, material: Material, factor: float) -> float:
    assert material.strength is not None
    return tethers.diameter_of(tethers.load_section(load, material.strength, factor))
