"""Towed rigid bodies: against an integration of its own, closed forms, and what is conserved."""

import math
from typing import Any

import numpy as np
import pytest

from tests.plain import plain
from tests.tethered_deorbit.rigid_pairs import (
    BOTH,
    FIELD_FREE,
    INERTIA,
    MEAN_MOTION,
    MODULUS,
    ON_ORBIT,
    RADIUS,
    REDUCED,
    REST,
    STIFFNESS,
    TUMBLING,
    differences,
    matrix,
    momentum,
    pair,
    reference,
    six,
    uncompiled,
)
from tests.validation import Validated, closed_form

__all__ = ["plain"]


@uncompiled
@pytest.mark.parametrize("body", ["target", pytest.param("both", marks=pytest.mark.evidence)])
def test_three_tugs_on_an_orbit(body: str) -> None:
    """A tumbling pair with gravity gradient and thrust: tugs, attitude and rates of scipy's DOP853 at 1e-12."""
    terms = ON_ORBIT | ({"chaser": "rigid"} if body == "both" else {})
    arrays = TUMBLING | ({"chaser_start_rate": (-0.02, 0.01, 0.03)} if body == "both" else {})
    given = {"orbit__inclination": 0.0, "tether__damping_ratio": 0.05, "thrust__level": -8.0}
    i = pair(terms, arrays, **given)
    tow, start = reference(i, 0.05, RADIUS, -8.0)
    end = 100.0 if body == "both" else 200.0
    after = tow.run(start, end)
    i.step(end)
    assert len(tow.tugs) >= 3
    off = differences(i, tow, after)
    allowed = {"time": 1e-8, "speed": 1e-8, "peak": 1e-6, "place": 1e-8, "velocity": 1e-9, "attitude": 1e-9}
    for what, most in (allowed | {"rate": 1e-10}).items():
        assert off[what] < most, what


@uncompiled
def test_without_its_gradient_the_field_does_not_turn_a_body() -> None:
    seen = {}
    for on in (True, False):
        i = pair(ON_ORBIT, {"target_start_rate": (0.0, 0.0, 0.0)}, target__gravity_gradient=on)
        i["thrust.level"] = 0.0
        i.step(60.0)
        seen[on] = float(np.linalg.norm(i.array("target_rate")))
    assert seen[False] == 0.0
    assert seen[True] > 1e-6


@uncompiled
def test_a_tug_through_the_centre_of_mass_is_that_of_a_point() -> None:
    """To rounding: first tugs, impulse and places of a pair whose attachments are the centres."""
    arrays: dict[str, Any] = {"start_relative_velocity": (0.01, 0.02, 0.0)}
    turning = arrays | {"target_attachment": (0.0, 0.0, 0.0), "target_start_rate": (0.3, 0.1, 0.2)}
    rigid, point = pair(FIELD_FREE, turning), pair(FIELD_FREE | {"target": "point"}, arrays)
    for i in (rigid, point):
        i.step(600.0)
    assert point["tether.tug_count"] == rigid["tether.tug_count"] == 1
    for name in ("tug[1].time", "tug[1].speed", "tug[1].peak", "tether.impulse", "separation"):
        assert rigid[name] == pytest.approx(point[name], rel=1e-11), name


@uncompiled
def test_an_off_centre_snap_moves_the_effective_mass(validated: Validated) -> None:
    """v sqrt(k m), 1/m = 1/m_r + (a x n).I^-1 (a x n): of a line so stiff that nothing turns in the meantime."""
    n, v = np.array([0.0, 1.0, 0.0]), 0.05
    arm = np.array([1.5, -1.0, 0.5])
    apart = REST * n - arm - 1e-3 * n
    arrays = {"target_attachment": arm, "start_relative_position": apart, "start_relative_velocity": v * n}
    stiff = 1e3
    i = pair(FIELD_FREE, arrays, tether__youngs_modulus=MODULUS * stiff)
    i.step(1.0)
    lever = np.cross(arm, n)
    mass = 1.0 / (1.0 / REDUCED + lever @ np.linalg.solve(INERTIA, lever))
    assert mass < 0.8 * REDUCED
    formula = closed_form("v sqrt(k m), 1/m = 1/m_r + (a x n).I^-1 (a x n)")
    expected = v * math.sqrt(STIFFNESS * stiff * mass)
    validated(formula, "off-centre snap: peak", i["tug[1].peak"], expected, "N", rel=1e-4)
    assert not i["tether.taut"]
    assert i["tether.impulse"] == pytest.approx(2.0 * mass * v, rel=1e-4)
    assert i["tether.length_rate"] == pytest.approx(-v, rel=5e-3)  # it turns on until the second is over


@uncompiled
def test_small_librations_under_the_gradient(validated: Validated) -> None:
    """Pitch of a slack pair's target, axis 2, of the least moment, upright: 2 pi/(n sqrt(3 (I1 - I2)/I3))."""
    inertia = np.diag([6000.0, 2400.0, 5000.0])
    tilt = 1e-2
    # axis 2 of the body along the radius: a quarter turn about axis 3, and a little more
    half = 0.5 * (-0.5 * math.pi + tilt)
    arrays = {
        "target_inertia": six(inertia),
        "target_attachment": (0.0, 0.0, 0.0),
        "target_start_attitude": (math.cos(half), 0.0, 0.0, math.sin(half)),
    }
    i = pair(ON_ORBIT, arrays, target__rate_frame=1, tether__rest_length=1000.0)
    pace = MEAN_MOTION * math.sqrt(3.0 * (6000.0 - 2400.0) / 5000.0)
    quarter = 0.5 * math.pi / pace
    angles = []
    for k in (0.98, 0.02, 0.02):
        i.step(k * quarter)
        up = i.array("target_position") / np.linalg.norm(i.array("target_position"))
        along = i.array("target_velocity") / np.linalg.norm(i.array("target_velocity"))
        axis = matrix(i)[:, 1]
        angles.append(math.atan2(float(axis @ along), float(axis @ up)))
    assert angles[0] * angles[2] < 0.0
    slope = (angles[2] - angles[0]) / (0.04 * quarter)
    crossing = quarter * 0.98 - angles[0] / slope
    formula = closed_form("2 pi/(n sqrt(3 (I1 - I2)/I3))")
    validated(formula, "pitch libration of a target: period", 4.0 * crossing, 4.0 * quarter, "s", rel=2e-4)


@uncompiled
@pytest.mark.parametrize("terms", [FIELD_FREE, BOTH])
def test_field_free_momentum_and_energy(terms: dict[str, str]) -> None:
    """Through tugs: angular momentum about the joint centre of mass, spins included, to 1e-12, and energy."""
    i = pair(terms, TUMBLING | ({"chaser_start_rate": (0.02, 0.0, -0.05)} if terms is BOTH else {}))
    before, energy = momentum(i), i["energy.relative"]
    parting = i.array("center_velocity").copy()
    worst, drift = 0.0, 0.0
    for _ in range(300):
        i.step(1.0)
        worst = max(worst, float(np.abs(momentum(i) - before).max() / np.linalg.norm(before)))
        drift = max(drift, abs(i["energy.relative"] / energy - 1.0))
    assert i["tether.tug_count"] >= 2
    assert worst < 1e-12
    assert drift < 1e-11
    assert i.array("center_velocity") == pytest.approx(parting, abs=1e-16)


@uncompiled
def test_on_an_orbit_the_spin_changes_by_the_torque_of_the_gradient() -> None:
    """A slack target: the spin against the integral of the torque on eight mass points with its inertia."""
    inertia = np.diag([6000.0, 2400.0, 5000.0])
    trace = 0.5 * np.trace(inertia)
    size = np.sqrt((trace - np.diag(inertia)) / 2.0)
    points = np.vstack([np.diag(size), -np.diag(size)])
    i = pair(ON_ORBIT, TUMBLING | {"target_inertia": six(inertia)}, tether__rest_length=1000.0)
    before = i.array("target_spin").copy()
    nodes, weights = np.polynomial.legendre.leggauss(6)
    step, gained = 2.0, np.zeros(3)
    for _ in range(60):
        at = 0.0
        for node, weight in zip(nodes, weights, strict=True):
            then = 0.5 * step * (1.0 + node)
            i.step(then - at)
            at = then
            center, turned = i.array("target_position"), matrix(i)
            r = np.linalg.norm(center)
            for point in points:
                d = turned @ point
                # what turns is the gradient's part across the arm
                gained += 0.5 * step * weight * np.cross(d, 3.0 * 3.986004418e14 / r**5 * (center @ d) * center)
        i.step(step - at)
    change = i.array("target_spin") - before
    assert np.linalg.norm(change) > 1e-3
    assert change == pytest.approx(gained, abs=1e-9 * float(np.linalg.norm(before)))


@uncompiled
def test_undamped_on_an_orbit_the_energy_stays() -> None:
    """The Jacobi integral with that of the turning, over six hours of tugs: to first order in length over radius."""
    arrays = {"target_start_rate": (0.0, 0.002, 0.001), "start_relative_position": (6.0, 7.0, 0.0)}
    i = pair(ON_ORBIT, arrays, target__rate_frame=1)
    energy = i["energy.relative"]
    i.step(21600.0)
    assert i["tether.tug_count"] > 10
    assert i["energy.relative"] == pytest.approx(energy, abs=2e-5 * abs(energy))


@pytest.mark.evidence
@pytest.mark.parametrize("target", ["point", "rigid"])
def test_undamped_energy_over_a_day(target: str) -> None:
    """0.155 J of relative motion, and a target that tumbles at 5 deg/s: over a day of tugs 1e-9 of the 0.155 J stay."""
    own = 0.155
    parting = math.sqrt(2.0 * own / REDUCED) * np.array([0.5, 0.8, 0.3]) / math.sqrt(0.98)
    arrays: dict[str, Any] = {"start_relative_position": (6.0, 7.0, 0.0), "start_relative_velocity": parting}
    if target == "rigid":
        arrays["target_start_rate"] = np.radians([1.0, 2.0, 4.5])
    i = pair({"reel": "locked", "environment": "none", "target": target, "solver": "gauss"}, arrays)
    energy, worst = i["energy.relative"], 0.0
    for _ in range(144):
        i.step(600.0)
        worst = max(worst, abs(i["energy.relative"] - energy))
    assert i["tether.tug_count"] > 50
    assert worst < 1e-9 * own
