"""Up to which speed two threads hold each other, of a scene's values."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from fmu_src.implied import formula
from fmu_src.net_capture.formulas import round_diameter, thread_area


def thread_thickness(values: Mapping[str, float], net: Any) -> float:
    """Of the thinnest thread, as far as contact goes [m]; `net` are the checks of the net."""
    if values["self_contact.thickness"] > 0.0:
        return values["self_contact.thickness"]
    thread, (length, mass) = net.thread(values), net.finest(values)
    section = thread.section
    if section is None:
        section = formula(thread_area)(mass, values["net.density"], length)
    return float(formula(round_diameter)(section))


def holding_speed(thickness: float, duration: float, ratio: float) -> float:
    """Speed [m/s] at which two threads that meet in their middles go as deep as they are thick.

        v = omega d exp(zeta acos(zeta) / sqrt(1 - zeta^2)),   omega = pi / t

    thickness  d      of both together, by halves              [m]
    duration   t      of a contact without damping             [s]
    ratio      zeta   of damping                               [1]

    Checked  tests/net_capture/test_self_contact.py
    """
    if ratio < 1.0:
        aside = math.sqrt(1.0 - ratio * ratio)
        share = ratio * math.acos(ratio) / aside if aside > 1e-6 else 1.0
    else:
        over = math.sqrt(ratio * ratio - 1.0)
        share = ratio * math.acosh(ratio) / over if over > 1e-6 else 1.0
    return math.pi * thickness / duration * math.exp(share)
