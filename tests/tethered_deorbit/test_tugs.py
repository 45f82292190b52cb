"""What is booked as a tug: a line that goes taut from slack and then pulls, each once, and nothing else."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from fmu_src.instance import Instance
from fmu_src.tethered_deorbit.interface import MODEL
from tests.tethered_deorbit.independent import Towed, integrate, line_of, start_of
from tests.validation import Validated, other_code

LOCKED = {"reel": "locked", "thrust": "along_track"}
Tug = tuple[float, float, float]

SCENES = {
    "released by a damped line": ({"start.leading": 1, "tether.damping_ratio": 0.2}, 2382.0, 9),
    "hard damping": (
        {
            "tether.damping_ratio": 1.0,
            "tether.youngs_modulus": 6.94e9,
            "start.condition": 2,
            "start.separation": 10.7,
            "thrust.level": -4.75,
        },
        60.0,
        2,
    ),
    "hard pull": ({"start.condition": 1, "thrust.level": 0.05}, 3000.0, 5),
}


def tugs_of(i: Instance, end: float, step: float = 10.0) -> list[Tug]:
    """Every tug up to `end`, by the ring; the steps are short enough for none to be lost."""
    seen: dict[int, Tug] = {}
    while i.time < end:
        i.step(min(step, end - i.time))
        count = int(i["tether.tug_count"])
        for place in range(1, min(16, count) + 1):
            seen[count - place + 1] = (i[f"tug[{place}].time"], i[f"tug[{place}].speed"], i[f"tug[{place}].peak"])
    assert len(seen) == i["tether.tug_count"]
    return [seen[number] for number in sorted(seen)]


def compared(parameters: dict[str, float], end: float) -> tuple[Instance, np.ndarray, Towed]:
    i = Instance(MODEL, LOCKED, parameters).initialise()
    reference = integrate(line_of(i), start_of(i), end)
    return i, np.array(tugs_of(i, end)), reference


SCIPY = other_code("scipy's DOP853, gravity formed otherwise, its own events")


def agree(validated: Validated, which: str, i: Instance, found: np.ndarray, reference: Towed) -> None:
    expected = np.array(reference.tugs)
    assert len(found) == len(expected)
    validated(SCIPY, f"{which}: times of tugs", found[:, 0], expected[:, 0], "s", abs=2e-5)
    validated(SCIPY, f"{which}: speeds of tugs", found[:, 1], expected[:, 1], "m/s", abs=1e-10)
    validated(SCIPY, f"{which}: peaks of tugs", found[:, 2], expected[:, 2], "N", abs=1e-7)
    validated(SCIPY, f"{which}: impulse of the line", i["tether.impulse"], reference.impulse, "N s", rel=1e-9)
    validated(SCIPY, f"{which}: closest approach", i["approach.distance"], reference.nearest, "m", abs=1e-8)
    when, expected_when = i["approach.time"], reference.nearest_at
    validated(SCIPY, f"{which}: time of the closest approach", when, expected_when, "s", abs=1e-5)


@pytest.mark.parametrize("name", SCENES)
def test_against_an_independent_integration(validated: Validated, name: str) -> None:
    """Count, times, speeds and peaks, impulse and closest approach. Where damping is hard the tension rises through
    zero while the stretched line is still shortening: then, and only then, a tug begins at a negative speed."""
    parameters, end, count = SCENES[name]
    i, found, reference = compared(parameters, end)
    agree(validated, "three hard tows", i, found, reference)
    assert len(found) == count
    assert (found[:, 1].min() < 0.0) == (name == "hard damping")
    other = np.array(tugs_of(Instance(MODEL, LOCKED, parameters | {"target.mass": 1000.1}).initialise(), end))
    assert len(other) == count
    assert (np.abs(other - reference.tugs).max(axis=0) > (2e-5, 1e-10, 1e-7)).all()


@pytest.mark.slow
def test_a_tug_begins_at_the_rest_length_to_rounding() -> None:
    """Read off the dense output, without the step being redone, that is right to a tenth of a picometre only."""
    hard = {"thrust.level": -0.3}
    i = Instance(MODEL, LOCKED, hard).initialise()
    i.step(700.0)
    assert i["tether.tug_count"] >= 3
    for k in range(1, 4):
        j = Instance(MODEL, LOCKED, hard).initialise()
        j.step(i[f"tug[{k}].time"])
        assert abs(j["separation"] - 12.0) < 1e-14


def test_forty_tugs_of_table_2_with_the_chaser_ahead(validated: Validated) -> None:
    i, found, reference = compared({"start.leading": 1}, 8000.0)
    agree(validated, "Table 2, chaser ahead", i, found, reference)
    assert len(found) == 40


def random_scene(rng: np.random.Generator, reel: str) -> dict[str, float]:
    scene = {
        "start.leading": float(rng.integers(2)),
        "start.condition": float(rng.integers(3)),
        "start.separation": rng.uniform(8.0, 12.0),
        "thrust.level": rng.choice([-1.0, 1.0]) * 10.0 ** rng.uniform(-2.0, 0.7),
    }
    if reel == "locked":
        scene["tether.damping_ratio"] = float(rng.choice([0.0, 1e-3, 0.05, 0.2, 0.45]))
        scene["tether.youngs_modulus"] = 60e9 * 10.0 ** rng.uniform(-1.0, 0.2)
    else:
        scene["reel.derivative_gain"] = float(rng.choice([0.0, 0.1, 2.366]))
        scene["reel.proportional_gain"] = 10.0 ** rng.uniform(-3.0, 0.0)
    return scene


@pytest.mark.parametrize(("reel", "scenes", "least"), [("locked", 120, 250), ("linear", 40, 40)])
def test_many_scenes(reel: str, scenes: int, least: int) -> None:
    """Every tug pulls and begins as the line lengthens; just before it the line is slack, just after it taut."""
    rng = np.random.default_rng(1)
    count = 0
    for _ in range(scenes):
        scene = random_scene(rng, reel)
        integers = {name: int(scene.pop(name)) for name in ("start.leading", "start.condition")}

        def begun(given: dict[str, float] = scene | integers) -> Instance:
            return Instance(MODEL, {"reel": reel, "thrust": "along_track"}, given).initialise()

        found = tugs_of(begun(), 600.0)
        again = begun()
        for number, (time, speed, peak) in enumerate(found, start=1):
            assert peak > 1e-7
            assert speed >= 0.0 or reel == "linear"
            if time == 0.0:
                continue
            again.step(time - 1e-5 - again.time)
            assert (again["tether.taut"], again["tether.tension"], again["tether.tug_count"]) == (0, 0.0, number - 1)
            again.step(2e-5)
            assert (again["tether.taut"], again["tether.tug_count"]) == (1, number)
        count += len(found)
    assert count > least


def pulls(knots: list[float], step: float) -> tuple[list[tuple[float, float]], float]:
    """When a command that goes straight from knot to knot begins to pull, and its peak then; and what it pulls in all.

    A command that comes down to zero and rises from it again goes on pulling.
    """
    found: list[tuple[float, float]] = []
    impulse, pulling = 0.0, False
    for k, (a, b) in enumerate(pairwise(knots)):
        top = max(a, b, 0.0)
        if top > 0.0:
            crossing = step * a / (a - b) if a * b < 0.0 else 0.0
            held = crossing if a > 0.0 > b else step - crossing if b > 0.0 > a else step
            impulse += 0.5 * (max(a, 0.0) + max(b, 0.0)) * held
            if not (pulling and a >= 0.0):
                found.append((k * step + (crossing if a < 0.0 else 0.0), top))
            found[-1] = found[-1][0], max(found[-1][1], top)
        pulling = b > 0.0 or (b == 0.0 and a > 0.0)
    return found, impulse


@pytest.mark.parametrize("step", [8.0, 9.7])
def test_ramps_of_a_command(step: float) -> None:
    """Against the intervals in which the command is above zero; many ramps end at zero, to rounding."""
    rng = np.random.default_rng(3)
    for _ in range(12):
        knots = [0.0, *rng.choice([0.0, 0.0, -0.003, 0.003, 0.007, -0.011], 24).tolist()]
        i = Instance(MODEL, {"reel": "commanded", "thrust": "along_track"}, {"thrust.level": 1e-3}).initialise()
        seen: dict[int, tuple[float, float]] = {}
        for goal in knots[1:]:
            i.set_rates({"reel.tension": (goal - i["reel.tension"]) / step})
            i.step(step)
            count = int(i["tether.tug_count"])
            seen |= {count - k: (i[f"tug[{k + 1}].time"], i[f"tug[{k + 1}].peak"]) for k in range(min(count, 16))}
        expected, impulse = pulls(knots, step)
        assert len(seen) == len(expected)
        assert np.array([seen[n] for n in sorted(seen)]) == pytest.approx(np.array(expected), rel=1e-9, abs=1e-9)
        assert i["tether.impulse"] == pytest.approx(impulse, rel=1e-11)
        assert i["tether.impulse"] != pytest.approx(1.0001 * impulse, rel=1e-11)
