"""Winches at the bullets draw the mouth together: each stands still at its stall force, and never pays out."""

from __future__ import annotations

from typing import Any

from fmu_src.interface import Term
from fmu_src.net_capture.closing import Closing
from fmu_src.net_capture.closing.part import EXTREMES, FASTEST, refuses, rows
from fmu_src.net_capture.closing.reels import TOO_MANY_RINGS, Drive, make_reels
from fmu_src.rows import positive
from orbital.kernel import kernel


@kernel
def force(p, length):
    """Tension [N] at which a winch stands still, whatever is out.

    Checked  tests/net_capture/test_closing.py
    """
    return p.closing_stall_force


@kernel
def slope(p, length):
    """Its derivative [N/m].

    Checked  tests/net_capture/test_closing.py
    """
    return 0.0


@kernel
def pays_out(p):
    """No winch does.

    Checked  tests/net_capture/test_closing.py
    """
    return False


def make(composition: Any) -> Closing:
    """Kernels of the winches on the cord along the rim of the composition's net."""
    return make_reels(composition, Drive(force, slope, pays_out, None))


PART = Term(
    "cord between neighbouring bullets, drawn by winches that stall and never pay out",
    (
        *rows("winches"),
        positive("closing.speed", "m/s", "no-load speed of each winch: a 24 m side in 5 s", 5.0, FASTEST),
        positive("closing.stall_force", "N", "tension at which a winch stands still", 5.0),
    ),
    faults=(TOO_MANY_RINGS,),
    make=make,
    refuses=refuses,
    extremes=EXTREMES,
)
