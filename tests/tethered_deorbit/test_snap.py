"""One snap of a slack line against the closed forms of `orbital.oscillators`: peak, duration, restitution."""

import math

import numpy as np
import pytest

from fmu_src.instance import Instance
from fmu_src.tethered_deorbit.interface import HANDED_OVER, MODEL
from orbital import oscillators, references
from orbital.constants import EARTH_EQUATORIAL_RADIUS, EARTH_MU
from tests.validation import Validated, closed_form

TERMS = {"reel": "locked", "thrust": "along_track"}
RATE = math.sqrt(EARTH_MU / (EARTH_EQUATORIAL_RADIUS + 800e3) ** 3)
REDUCED = oscillators.reduced_mass(2000.0, 1000.0)
STIFFNESS = oscillators.line_stiffness(60e9, 1e-3, 12.0)
FREQUENCY = oscillators.natural_frequency(STIFFNESS, REDUCED)


def snap(speed: float, zeta: float, angle: float = 0.5 * math.pi) -> Instance:
    """Parting at a speed [m/s], 0.1 s before the line goes taut, at an angle [rad] from the vertical; no thrust."""
    i = Instance(MODEL, TERMS, {"tether.damping_ratio": zeta, "thrust.level": 0.0, "start.condition": HANDED_OVER})
    direction = np.array([math.cos(angle), math.sin(angle), 0.0])
    i.array("start_relative_position")[:] = (12.0 - 0.1 * speed) * direction
    i.array("start_relative_velocity")[:] = speed * direction
    i.initialise().step(0.2)
    assert i["tether.taut"]
    while i["tether.taut"]:
        i.step(0.01)
    assert i["tether.tug_count"] == 1
    return i


@pytest.mark.parametrize("speed", [2e-3, 0.01, 0.1])
def test_undamped(validated: Validated, speed: float) -> None:
    """T = P + sqrt(P^2 + k m_r v^2), P the pull of the gravity gradient; leaves at the speed it came with."""
    preload = references.equilibrium_tension(RATE, 12.0, REDUCED)
    i = snap(speed, 0.0, angle=0.0)
    expected = oscillators.snap_peak(i["tug[1].speed"], STIFFNESS, REDUCED, preload)
    formula = closed_form("P + sqrt(P^2 + k m_r v^2)")
    validated(formula, "peak of an undamped snap", i["tug[1].peak"], expected, "N", rel=5e-3)
    assert i["tug[1].peak"] != pytest.approx(1.01 * expected, rel=5e-3)
    left, came = -i["tether.length_rate"], i["tug[1].speed"]
    validated(closed_form("the speed before"), "speed after an undamped snap", left, came, "m/s", rel=1e-3)


@pytest.mark.parametrize("zeta", [0.05, 0.2, 0.45, 0.7, 0.9])
def test_damped(validated: Validated, zeta: float) -> None:
    """Peak and restitution of a damped snap that never pushes; fast, so that gravity does not count."""
    i = snap(0.5, zeta)
    speed = i["tug[1].speed"]
    expected = oscillators.damped_snap_peak(speed, STIFFNESS, REDUCED, zeta)
    formula = closed_form("v sqrt(k m_r) exp(-zeta (3 acos zeta - pi)/sqrt(1 - zeta^2)), zeta < 0.5; c v above")
    validated(formula, "peak of a damped snap", i["tug[1].peak"], expected, "N", rel=5e-3)
    wrong = oscillators.damped_snap_peak(1.01 * speed, STIFFNESS, REDUCED, zeta)
    assert i["tug[1].peak"] != pytest.approx(wrong, rel=5e-3)
    back = -i["tether.length_rate"] / speed
    formula = closed_form("exp(-2 zeta acos zeta/sqrt(1 - zeta^2))")
    validated(formula, "restitution of a damped snap", back, oscillators.snap_restitution(zeta), rel=5e-3)
    assert back != pytest.approx(oscillators.snap_restitution(zeta + 0.01), rel=5e-3)


def test_tugs_add_energy_only_without_damping() -> None:
    """The Jacobi integral of the pair survives an undamped tug and not a damped one."""
    # First order in length over radius, 1.7e-6 of the terms that make up the integral.
    scatter = 2e-6 * 0.5 * REDUCED * 3.0 * RATE**2 * 12.0**2
    for zeta, kept in ((0.0, True), (0.05, False)):
        i = Instance(MODEL, TERMS, {"tether.damping_ratio": zeta, "thrust.level": 0.0, "start.condition": HANDED_OVER})
        i.array("start_relative_position")[:] = 11.0, 3.0, 0.5
        i.array("start_relative_velocity")[:] = 0.02, 0.0, 0.0
        i.initialise()
        begin = i["energy.relative"]
        for _ in range(100):
            i.step(60.0)
            if i["tether.taut"]:
                continue
            assert i["energy.relative"] <= begin + scatter
        assert i["tether.tug_count"] > 3
        assert (abs(i["energy.relative"] - begin) < scatter) == kept
