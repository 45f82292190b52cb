"""Gravity of the ground: the same everywhere and always."""

from __future__ import annotations

from typing import Any

from fmu_src.extremes import Extreme
from fmu_src.interface import Term
from fmu_src.net_capture.gravity import Gravity
from fmu_src.net_capture.gravity.falling import ROWS, begin_steady_flight, make_falling
from fmu_src.rows import vector
from orbital.kernel import kernel
from orbital.vectors import norm

STANDARD = 9.80665
"""Standard acceleration of free fall [m/s2], exact by definition: 3rd CGPM (1901)."""


@kernel
def start(p):
    """What the scene says holds all the time.

    Checked  tests/net_capture/test_ground.py
    """
    for i in range(3):
        p.gravity_now[i] = p.gravity_acceleration[i]
    p.gravity_most = norm(p.gravity_now)


def make(composition: Any) -> Gravity:
    """See `falling`."""
    return make_falling(composition, start, None, begin_steady_flight, None, None)


PART = Term(
    "uniform gravity of a ground test, on net, bullets and vertex; chaser and target are carried unless told to fall",
    (
        vector(
            "gravity.acceleration",
            "m/s2",
            "of all that falls, along the axes of positions",
            "parameter",
            (-STANDARD, 0.0, 0.0),
        ),
        *ROWS,
    ),
    make=make,
    extremes=tuple(
        Extreme(
            f"gravity of {many:g} g",
            "from none to what no net is tested in",
            "energy_gained",
            {"gravity.acceleration": (-many * STANDARD, 0.0, 0.0)},
            chief=many == 100.0,
        )
        for many in (0.0, 100.0)
    ),
)
