"""The thrust that there is power for, by the values of a scene."""

from __future__ import annotations

import math
from collections.abc import Mapping

from orbital.constants import STANDARD_GRAVITY


def most_thrust(values: Mapping[str, float], terms: Mapping[str, str]) -> float:
    """Most that an electric engine gives [N], infinite of any other.

        2 eta P/(Isp g0)

    values        by FMI name, SI
    terms         by group

    Source   jet power F v_e/2, as of `engine.make_engine`
    Checked  tests/tethered_deorbit/test_design.py: a loop is designed for the thrust there is
    """
    if terms.get("engine") != "electric":
        return math.inf
    power = 2.0 * values["engine.efficiency"] * values["engine.power_limit"]
    return power / (values["thrust.specific_impulse"] * STANDARD_GRAVITY)
