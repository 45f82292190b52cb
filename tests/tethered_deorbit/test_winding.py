"""What a winch is asked to do: tensions, schedules, swings damped, gains sampled, targets calmed."""

import math
from typing import Any

import numpy as np
import pytest
from scipy.linalg import expm

from fmu_src.instance import Instance, ModelFault
from fmu_src.tethered_deorbit import design
from fmu_src.tethered_deorbit.asked import LQR
from fmu_src.tethered_deorbit.interface import HANDED_OVER, MODEL
from fmu_src.tethered_deorbit.winding import INTEGRAL, RESPONSE
from tests.plain import plain
from tests.tethered_deorbit.test_design import scene
from tests.tethered_deorbit.test_regulator import placed, polar
from tests.tethered_deorbit.test_winch import MASS, ROOMY, SOFT, apart, schedule, winch
from tests.validation import Validated, closed_form

__all__ = ["plain"]

uncompiled = pytest.mark.usefixtures("plain")
RATE = 1.0381289e-3


def tension_loop(angle: float, zeta: float) -> float:
    """Largest eigenvalue, over one sample, of a pair on a line that follows a tension; h omega is the angle.

    State: stretch s, l', v, sum of errors; s' = l' - v, l'' = -T/m, v' = a; T = k s + c s'. In units of k = m = 1.
    """
    h, c = angle, 2.0 * zeta
    whole = np.zeros((4, 4))
    whole[:3] = [[0, 1, -1, 0], [-1, -c, c, 0], [0, 0, 0, 1]]
    moved = expm(whole * h)
    tension = np.array([1.0, c, -c])
    soft = 1.0 / (RESPONSE * h + 2.0 * c)
    wanted = np.append(tension * (1.0 + INTEGRAL) * soft + [0, 1, 0], soft)
    speeding = (wanted - [0, 0, 1, 0]) / h
    step = np.zeros((4, 4))
    step[:3, :3] = moved[:3, :3]
    step[:3] += np.outer(moved[:3, 3], speeding)
    step[3] = np.append(INTEGRAL * tension, 1.0)
    sizes = sorted(abs(np.linalg.eigvals(step)))
    # one stays: bodies and winch drift alike
    assert min(abs(size - 1.0) for size in sizes) < 1e-6
    sizes.pop(int(np.argmin([abs(size - 1.0) for size in sizes])))
    return float(sizes[-1])


@pytest.mark.parametrize("zeta", [0.0, 0.05, 0.5, 1.0])
def test_a_tension_is_held_by_a_stable_loop(zeta: float) -> None:
    """Up to 2 radians of the line's vibration from one sample to the next, and no longer at 3."""
    for angle in (0.001, 0.005, 0.05, 0.2, 0.5, 1.0, 2.0):
        assert tension_loop(angle, zeta) < 1.0
    assert zeta > 0.1 or tension_loop(3.0, zeta) > 1.0


@uncompiled
def test_constant_tension(validated: Validated) -> None:
    """Two bodies drawn together by 0.5 N while the chaser pulls away with 1 N: held to 1e-4 after ten seconds."""
    i = winch(
        "constant_tension",
        apart(12.001) | {"reel.held_tension": 0.5, "reel.sample_time": 0.1, "thrust.level": -1.0},
        thrust="tether",
    )
    i.step(10.0)
    speed = i["tether.length_rate"]
    for _ in range(20):
        i.step(0.5)
        assert i["tether.tension_peak"] == pytest.approx(0.5, rel=1e-4)
        assert i["tether.tension_least"] == pytest.approx(0.5, rel=1e-4)
    # l'' = F/m_c - T/m_r
    what, gained = "winch that holds a tension: speed in 10 s", 10.0 * (1.0 / 2000.0 - 0.5 / MASS)
    validated(closed_form("F/m_c - T/m_r"), what, i["tether.length_rate"] - speed, gained, "m/s", rel=1e-4)
    assert i["reel.limited"] == 0
    i["reel.tension_offset"] = 0.25
    i.step(10.0)
    assert i["tether.tension"] == pytest.approx(0.75, rel=1e-3)


@uncompiled
def test_a_slack_line_is_taken_in() -> None:
    """At its own rate, to a snap of about that times sqrt(k m_r)."""
    i = winch(
        "constant_tension",
        SOFT | apart(11.9) | {"reel.held_tension": 0.2, "reel.take_up": 5e-3, "reel.sample_time": 0.25},
    )
    i.step(19.5)
    assert not i["tether.taut"]
    assert i["reel.rate"] == pytest.approx(-5e-3, rel=1e-6)
    i.step(10.0)
    assert i["tether.tug_count"] == 1
    assert i["tug[1].speed"] == pytest.approx(0.0, abs=1e-9)
    impact = 5e-3 * math.sqrt(6e9 * math.pi * 2.5e-7 / 12.0 * MASS)
    assert 0.2 < i["tug[1].peak"] < 1.1 * impact
    i.step(20.0)
    assert i["tether.tension"] == pytest.approx(0.2, rel=1e-2)


@uncompiled
def test_schedule() -> None:
    """Kept to on its slopes; behind a corner off by no more than the change of slope makes in two samples."""
    h = 0.5
    points = ((0.0, 12.0), (10.0, 12.0), (30.0, 11.0), (50.0, 11.5))
    i = winch("schedule", schedule(*points) | ROOMY | apart(5.0) | {"reel.sample_time": h})
    times, lengths = zip(*points, strict=True)
    for k in range(1, 121):
        i.step(h)
        time = k * h
        off = abs(i["reel.paid_out"] - np.interp(time, times, lengths))
        corner = min(abs(time - t) for t in times)
        assert off <= (1e-9 if corner > 25.0 * h else 0.075 * 2.0 * h)
        if 25.0 < time < 29.0:
            assert off < 1e-9 + 0.05 * 0.5 ** ((time - 10.0) / h - 3.0)
    assert i["reel.limited"] == 0
    i["reel.length_offset"] = 0.5
    i.step(30.0)
    assert i["reel.paid_out"] == pytest.approx(12.0, abs=1e-6)


@uncompiled
def test_a_schedule_must_go_forward() -> None:
    with pytest.raises(ModelFault, match="times of a schedule must increase"):
        winch("schedule", schedule((0.0, 12.0), (10.0, 11.0), (9.0, 12.0)) | apart(5.0))


def towed(law: str, parameters: dict[str, Any], **terms: str) -> Instance:
    """A compiled pair in orbit on a line of 12 m."""
    fields = {name: value for name, value in parameters.items() if isinstance(value, list)}
    i = Instance(MODEL, {"reel": law, **terms}, {k: v for k, v in parameters.items() if k not in fields})
    for name, value in fields.items():
        i.array(name)[:] = value
    return i.initialise()


def test_a_swing_is_damped(validated: Validated) -> None:
    """A small swing without thrust, w = sqrt(3) n, dies out by the damping ratio g/sqrt(3); without gain it stays."""
    for gain in (0.1, 0.0):
        start = placed(12.0, 0.0, 0.05, 0.0) | {"tether.rest_length": 12.0 - 6.6e-6, "thrust.level": 0.0}
        i = towed(
            "libration",
            start | {"reel.swing_gain": gain, "reel.return_gain": 0.0, "reel.sample_time": 5.0},
            thrust="along_track",
        )
        tops = []
        before, now = polar(i), polar(i)
        for _ in range(2500):
            i.step(10.0)
            past, before, now = before, now, polar(i)
            if past[2] < before[2] > now[2] and abs(before[2]) > 1e-4:
                # the top of the parabola through three points
                curve = past[2] - 2.0 * before[2] + now[2]
                tops.append(before[2] - (now[2] - past[2]) ** 2 / (8.0 * curve))
        zeta = gain / math.sqrt(3.0)
        decrement = 2.0 * math.pi * zeta / math.sqrt(1.0 - zeta**2)
        found = float(np.log(tops[0] / tops[2])) / 2.0
        what = f"winch that damps a swing, gain {gain:g}: decrement"
        allowed = max(1e-2 * decrement, 1e-4)
        validated(closed_form("2 pi z/(1 - z^2)^(1/2), z = g/3^(1/2)"), what, found, decrement, "1", abs=allowed)
        assert i["tether.tug_count"] == 1


@pytest.mark.evidence
def test_a_sampled_loop_decays_by_its_poles(validated: Validated) -> None:
    """Table 2's pair about its equilibrium, a sample each 30 s: along the slowest oscillation of the sampled loop."""
    values, asked, terms = scene("sampled_linear", gains=LQR)
    found = design.designed(values, asked, terms)
    loop = design.loop_of(values | found, terms)
    assert loop is not None
    assert loop.step == 30.0
    closed = loop.matrix - loop.drive @ loop.gain
    poles, left = np.linalg.eig(closed.T)
    slow = int(np.argmax(np.where(poles.imag > 0.0, abs(poles), 0.0)))
    right = np.linalg.inv(left.T)[:, slow]
    # the winch begins at rest: an eigenvector turned so that its rate is zero
    right = right * np.exp(0.5j * math.pi - 1j * np.angle(right[1]))
    start = 2e-3 * (right / np.max(abs(right))).real
    units = np.array([12.0, 12.0 * RATE, 1.0, RATE])
    length, _, angle, turn = start * units + np.array([12.0, 0.0, loop.plant.angle, 0.0])
    stretch = loop.plant.tension / 3926.99
    i = towed(
        "sampled_linear",
        found | placed(length + stretch, 0.0, angle, turn) | {"tether.rest_length": length, "reel.sample_time": 30.0},
        thrust="along_track",
    )

    def mode() -> complex:
        _, _, phi, rate = polar(i)
        away = np.array([i["reel.paid_out"] - 12.0, i["reel.rate"], phi - loop.plant.angle, rate]) / units
        return complex(left[:, slow] @ away)

    first, samples = mode(), 50
    for _ in range(samples):
        i.step(30.0)
    pole = np.log(mode() / first / np.exp(1j * np.angle(poles[slow]) * samples)) / (30.0 * samples)
    expected = float(np.log(abs(poles[slow]))) / 30.0
    what = "winch with sampled gains: decay of its slowest swing"
    validated(closed_form("the sampled loop's pole"), what, pole.real, expected, "1/s", rel=1e-2)
    assert pole.imag == pytest.approx(0.0, abs=1e-2 * abs(np.angle(poles[slow])) / 30.0)


TUMBLING = {
    "target_inertia": [6666.7, 2666.7, 6666.7, 0.0, 0.0, 0.0],
    "target_attachment": [0.0, -4.0, 0.0],
    "target_start_rate": [0.0, 0.0, math.radians(5.0)],
    "reel.sample_time": 0.2,
    "tether.rest_length": 30.0,
    "tether.youngs_modulus": 6e9,
    "start.condition": HANDED_OVER,
    "start_relative_position": [0.0, 34.0, 0.0],
}


@uncompiled
def test_spin_goes_into_the_orbit(validated: Validated) -> None:
    """Free, without thrust: what the target's spin loses is angular momentum of the pair's motion, to 1e-9 of it."""
    i = winch("detumble", TUMBLING, target="rigid")

    def momenta() -> tuple[Any, Any]:
        places = [np.array([i[f"relative.{what}[{k}]"] for k in (1, 2, 3)]) for what in ("position", "velocity")]
        spin = np.array([i[f"target.spin[{k}]"] for k in (1, 2, 3)])
        return spin, MASS * np.cross(*places)

    spin, orbit = momenta()
    before = i["target.spin_energy"]
    for _ in range(30):
        i.step(1.0)
    after, swung = momenta()
    assert np.linalg.norm(after) < 0.75 * np.linalg.norm(spin)
    kept, what = closed_form("angular momentum is kept"), "winch that calms a body: spin and motion of the pair"
    validated(kept, what, after + swung, spin + orbit, "N.m.s", abs=1e-9 * float(np.linalg.norm(spin)))
    assert np.linalg.norm(swung - orbit) > 0.25 * np.linalg.norm(spin)
    # the attachment recedes by 8 m at most in half a turn: the line takes no more than T_hard times that
    taken = before - i["target.spin_energy"]
    assert 0.3 * 2.0 * 8.0 < taken < 1.05 * 2.0 * 8.0


@pytest.mark.evidence
@uncompiled
def test_one_tension_for_both_ways_calms_nothing() -> None:
    """The same pull while it recedes and while it nears: after a whole turn the spin has its energy back.

    Heavy bodies hardly move, and on a soft undamped line the tension is held to a hundredth.
    """
    heavy = TUMBLING | {"target.mass": 1e6, "chaser.mass": 1e6, "reel.sample_time": 0.1}
    heavy |= {"tether.youngs_modulus": 6e8, "tether.damping_ratio": 0.0}

    def spun(hard: float, soft: float) -> tuple[float, float]:
        """Energy of the spin after a whole turn over that at the start, and the least of it."""
        i = winch("detumble", heavy | {"reel.tension_receding": hard, "reel.tension_nearing": soft}, target="rigid")
        before, least, past = i["target.spin_energy"], math.inf, 0.0
        for _ in range(240):
            i.step(0.5)
            least = min(least, i["target.spin_energy"])
            turned = 2.0 * math.atan2(i["target.attitude[4]"], i["target.attitude[1]"]) % (2.0 * math.pi)
            if turned < past:
                break
            past = turned
        return i["target.spin_energy"] / before, least / before

    kept, least = spun(1.0, 1.0)
    assert least < 0.75
    assert kept == pytest.approx(1.0, abs=2e-2)
    calmed, _ = spun(1.2, 0.8)
    # 0.4 N over 8 m of 25.4 J
    assert 1.0 - calmed == pytest.approx(0.4 * 8.0 / 25.385, rel=0.15)
