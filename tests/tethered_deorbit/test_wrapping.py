"""A line round a body: tugs against an integration in scipy, conservation, rates, and what ends a tow."""

import math
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from fmu_src.instance import ModelFault
from tests.plain import plain
from tests.tethered_deorbit.wrapped import (
    BOX,
    CYLINDER,
    M_C,
    REDUCED,
    SIZE,
    STIFFNESS,
    TUMBLING,
    momentum,
    pair,
    uncompiled,
    wrapped_and_taut,
)
from tests.validation import Validated, other_code

__all__ = ["plain"]


def test_what_wraps_too_often_is_told() -> None:
    flat = {"target_start_rate": (0.0, 0.0, 0.5), "target_inertia": (1671.0, 924.0, 1788.0, 0.0, 0.0, 0.0)}
    i = pair(BOX, flat, tether__rest_length=1e5)
    with pytest.raises(ModelFault, match="the line has wrapped"):
        i.step(1000.0)
    assert i["tether.bends"] == 0


def in_plane(size: np.ndarray, attached: np.ndarray, end: np.ndarray) -> tuple[float, np.ndarray]:
    """Length of the shorter way round a rectangle in its plane, and the corner or attachment where it leaves it."""
    half = 0.5 * size[:2]
    corners = [np.array(c) * half for c in ((1, 1), (-1, 1), (-1, -1), (1, -1))]

    def inside(p: np.ndarray, q: np.ndarray) -> bool:
        low, high = 0.0, 1.0
        for axis in range(2):
            for sign in (1.0, -1.0):
                above, slope = sign * p[axis] - half[axis] + 1e-11, sign * (q[axis] - p[axis])
                if slope < 0.0:
                    low = max(low, -above / slope)
                elif slope > 0.0:
                    high = min(high, -above / slope)
                elif above > 0.0:
                    return False
        return low < high

    ways = []
    angle = math.atan2(attached[1], attached[0])
    for sign in (1.0, -1.0):
        order = sorted(corners, key=lambda c: (sign * (math.atan2(c[1], c[0]) - angle)) % (2.0 * math.pi))
        here, length, left = attached, 0.0, list(order)
        while inside(here, end) and left:
            corner = left.pop(0)
            length, here = length + float(np.linalg.norm(corner - here)), corner
        ways.append((length + float(np.linalg.norm(end - here)), here))
    return min(ways, key=lambda w: w[0])


def test_tugs_of_a_wrapped_line_in_a_plane(validated: Validated) -> None:
    """A box that turns at 2 deg/s across the line of a chaser that pulls away: tugs as of scipy's DOP853."""
    rate, drift = math.radians(2.0), 0.005
    inertia = 1788.0
    arrays = {
        "target_inertia": (1671.0, 924.0, inertia, 0.0, 0.0, 0.0),
        "target_start_rate": (0.0, 0.0, rate),
        "start_relative_velocity": (0.0, drift, 0.0),
    }
    pull_away = -4.0
    i = pair(BOX, arrays, tether__rest_length=13.0, thrust__level=pull_away)
    attached = np.array([0.0, -0.5 * SIZE[1]])
    stiffness = STIFFNESS / 13.0

    def seen(y: np.ndarray) -> tuple[float, np.ndarray, np.ndarray]:
        """Length, where the line leaves, and its direction to the chaser, body axes."""
        turned = np.array([[math.cos(y[4]), math.sin(y[4])], [-math.sin(y[4]), math.cos(y[4])]])
        end = turned @ -y[0:2]
        length, leaves = in_plane(SIZE, attached, end)
        return length, leaves, (end - leaves) / np.linalg.norm(end - leaves)

    def motion(_: float, y: np.ndarray, taut: bool) -> np.ndarray:
        pull = np.zeros(2)
        torque = 0.0
        if taut:
            length, leaves, way = seen(y)
            force = stiffness * (length - 13.0) * way
            torque = leaves[0] * force[1] - leaves[1] * force[0]
            back = np.array([[math.cos(y[4]), -math.sin(y[4])], [math.sin(y[4]), math.cos(y[4])]])
            pull = back @ force
        away = np.array([0.0, -pull_away / M_C])
        return np.array([y[2], y[3], *(pull / REDUCED + away), y[5], torque / inertia])

    y, time, taut, tugs = np.array([0.0, 12.0, 0.0, drift, 0.0, rate]), 0.0, False, []
    while len(tugs) < 3 or taut:

        def change(_: float, y: np.ndarray, taut: bool) -> float:
            return seen(y)[0] - 13.0

        change.terminal, change.direction = True, -1 if taut else 1  # type: ignore[attr-defined]
        leg = solve_ivp(
            motion,
            (time, time + 500.0),
            y,
            "DOP853",
            args=(taut,),
            events=change,
            max_step=0.05 if taut else 1.0,
            rtol=1e-10,
            atol=1e-12,
            dense_output=taut,
        )
        assert leg.status == 1
        if taut:
            times = np.linspace(time, leg.t[-1], 2001)
            tugs[-1].append(max(stiffness * (seen(leg.sol(t))[0] - 13.0) for t in times))
        else:
            tugs.append([float(leg.t[-1])])
        time, y, taut = float(leg.t[-1]), leg.y[:, -1], not taut
    i.step(time + 1.0)
    count = int(i["tether.tug_count"])
    assert count == len(tugs)
    for k, (when, peak) in enumerate(tugs):
        assert i[f"tug[{count - k}].time"] == pytest.approx(when, abs=1e-6)
        assert i[f"tug[{count - k}].peak"] == pytest.approx(peak, rel=1e-5)
    source = other_code("scipy DOP853, a rectangle in its plane")
    what = "line wrapped round a box that turns: peak of the first tug"
    validated(source, what, i[f"tug[{count}].peak"], tugs[0][1], "N", rel=1e-5)


@pytest.mark.parametrize("terms", [BOX, CYLINDER])
def test_momentum_and_energy_through_wrapped_tugs(terms: dict[str, str]) -> None:
    """Tumbling about no axis: spins included, to 1e-11; the line slides without loss."""
    arrays: dict[str, Any] = dict(TUMBLING)
    values = {"target__cylinder_radius": 1.2, "target__cylinder_length": 3.0} if terms is CYLINDER else {}
    if terms is CYLINDER:
        arrays["target_attachment"] = (0.0, -1.2, -0.3)
    i = pair(terms, arrays, **values)
    before, energy = momentum(i), i["energy.relative"]
    wrapped_tugs = 0
    bends = 0
    for _ in range(600):
        count = i["tether.tug_count"]
        i.step(0.5)
        bends = max(bends, int(i["tether.bends"]))
        wrapped_tugs += bool(i["tether.tug_count"] > count and i["tether.bends"] > 0)
        assert momentum(i) == pytest.approx(before, abs=1e-11 * float(np.linalg.norm(before)))
        assert i["energy.relative"] == pytest.approx(energy, rel=1e-8)
    assert wrapped_tugs >= 1
    assert bends >= 2


def test_rates_of_a_wrapped_line() -> None:
    """Against differences of fourth order: the line's own, and those of what it shows."""
    i = pair(BOX, TUMBLING, tether__rest_length=1000.0)
    seen_bends, slides = set(), 0.0
    for _ in range(30):
        i.step(3.0)
        before = int(i["tether.bends"])
        names = ("tether.length", "tether.length_rate", "tether.span", "tether.wrapped")
        seen, step = [], 0.005
        rates: dict[str, float] = {}
        for k in range(5):
            i.step(step)
            seen.append([i[name] for name in names])
            if k == 2:
                i.differentiate()
                rates = {name: i.rate(name) for name in names}
        if int(i["tether.bends"]) != before:
            continue
        v = np.array(seen)
        differences = (v[0] - 8.0 * v[1] + 8.0 * v[3] - v[4]) / (12.0 * step)
        assert [rates[name] for name in names] == pytest.approx(differences, rel=1e-6, abs=1e-9)
        seen_bends.add(before)
        slides = max(slides, abs(rates["tether.wrapped"]))
    assert seen_bends >= {0, 1, 2}
    assert slides > 1e-3


@uncompiled
def test_a_wrapped_line_is_hauled_in() -> None:
    """Its tension is that of its whole length, k (l - l0) + c (l' - l0'), k and c as l0 makes them on the way."""
    zeta, pace = 0.3, -2e-3
    i = wrapped_and_taut(zeta)
    first, area = i["tether.rest_length"], 0.25 * math.pi * i["tether.diameter"] ** 2
    for k in range(10):
        i.set_rates({"reel.length_offset": pace})
        i.step(0.05)
        rest = first + pace * 0.05 * (k + 1)
        stiffness = 60e9 * area / rest
        dashpot = 2.0 * zeta * math.sqrt(stiffness * REDUCED)
        expected = stiffness * (i["tether.length"] - rest) + dashpot * (i["tether.length_rate"] - pace)
        assert i["tether.tension"] == pytest.approx(expected, rel=1e-9)
        assert i["tether.taut"]
        assert i["tether.bends"] == 2
        assert abs(i["tether.length_rate"]) > 1e-5


@uncompiled
def test_hauling_in_a_wrapped_line_pays_its_energy() -> None:
    """The work of the reel, (T + T^2/(2 EA)) (-l0'), by Simpson's rule."""
    pace, step = -2e-3, 0.01
    i = wrapped_and_taut(0.0)
    strength = 60e9 * 0.25 * math.pi * i["tether.diameter"] ** 2
    energy, power = [i["energy.relative"]], []
    for k in range(21):
        pull = i["tether.tension"]
        power.append(-pace * (pull + pull * pull / (2.0 * strength)))
        if k < 20:
            i.set_rates({"reel.length_offset": pace})
            i.step(step)
            energy.append(i["energy.relative"])
    assert i["tether.bends"] == 2
    work = step / 3.0 * (power[0] + power[-1] + 4.0 * sum(power[1:-1:2]) + 2.0 * sum(power[2:-1:2]))
    assert work > 1e-4
    assert energy[-1] - energy[0] == pytest.approx(work, rel=1e-6)


def test_macro_steps_and_a_stop_in_between_change_nothing() -> None:
    """The same tugs, bit for bit, for steps of 0.7 and 70 s: the way is followed from the steps of the integrator."""
    ends = []
    for step, count in ((0.7, 300), (70.0, 3)):
        i = pair(BOX, TUMBLING)
        for _ in range(count):
            i.step(step)
        ends.append([i[f"tug[{k}].{what}"] for k in range(1, 4) for what in ("time", "peak")])
        ends[-1] += [i["tether.length"], i["tether.wrapped"]]
    assert ends[0][:6] == ends[1][:6]
    assert ends[0] == pytest.approx(ends[1], rel=1e-11)


def test_an_attachment_out_of_sight_wraps_first() -> None:
    """On the far side of the box the line is shorter by the way round, and the tug comes sooner and harder."""
    arrays = {"start_relative_velocity": (0.0, 0.05, 0.0), "target_start_rate": (0.0, 0.0, 0.01)}
    near = pair(BOX, arrays, tether__rest_length=15.0)
    far = pair(BOX, arrays | {"target_attachment": (0.0, 0.5 * SIZE[1], 0.0)}, tether__rest_length=15.0)
    assert far["tether.length"] > near["tether.length"] + SIZE[1]
    assert far["tether.bends"] == 2
    firsts = []
    for i in (near, far):
        while i["tether.tug_count"] == 0:
            i.step(1.0)
        firsts.append(i["tug[1].time"])
    assert firsts[1] < 0.5 * firsts[0]


@pytest.mark.parametrize("count", [4, pytest.param(100, marks=pytest.mark.evidence)])
def test_tows_of_any_tumbling_body_run_to_an_end(count: int) -> None:
    """Sizes, attachments, spins and thrusts at random: a tow ends after its time or where the bodies meet."""
    rng = np.random.default_rng(7)
    for k in range(count):
        size, pull = rng.uniform(0.5, 5.0, 3), -(10.0 ** rng.uniform(-1.0, 1.0))
        way, axis = rng.normal(size=3), int(rng.integers(3))
        first = rng.uniform(-0.5, 0.5, 3) * size
        first[axis] = math.copysign(0.5 * size[axis], first[axis])
        arrays = {
            "target_inertia": (*(1000.0 / 12.0 * (size @ size - size**2)), 0.0, 0.0, 0.0),
            "target_attachment": first,
            "target_start_rate": rng.normal(size=3) * 10.0 ** rng.uniform(-3.0, -0.8),
            "start_relative_position": way / np.linalg.norm(way) * rng.uniform(6.0, 9.0),
            "start_relative_velocity": rng.normal(size=3) * 0.02,
        }
        values = {"thrust__level": pull, "tether__damping_ratio": float(rng.choice([0.0, 0.05, 0.5]))}
        if k % 2 == 0:
            i = pair(BOX, arrays | {"target_size": size}, **values)
        else:
            values |= {"target__cylinder_radius": 0.5 * size[0], "target__cylinder_length": size[2]}
            i = pair(CYLINDER, arrays, **values)
        try:
            i.step(1000.0)
        except ModelFault as end:
            if "the bodies have met" not in str(end):
                raise


def test_bodies_that_meet_end_the_tow() -> None:
    """A chaser that flies at 50 mm/s from 12 m at a face 1.95 m from the centre is there after 201 s."""
    i = pair(BOX, {"start_relative_velocity": (0.0, -0.05, 0.0), "target_attachment": (0.5, -0.5 * SIZE[1], 0.3)})
    i.step(200.9)
    with pytest.raises(ModelFault, match="the bodies have met") as told:
        i.step(1.0)
    assert float(str(told.value).rpartition(" at ")[2].removesuffix(" s)")) == pytest.approx(201.0, abs=1e-6)
    with pytest.raises(ModelFault, match="the bodies have met"):
        pair(BOX, {"start_relative_position": (0.0, 1.0, 0.0)})
