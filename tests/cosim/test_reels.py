"""Reels in a scene: gains that are designed when it is read, values that a reel cannot work with, and what is told."""

from __future__ import annotations

import pytest

from dcone_cosim import build
from dcone_cosim.loading import load
from dcone_cosim.scene.data import Scene
from dcone_cosim.scene.mistakes import SceneError
from dcone_cosim.scenes.reading import parse

HEAD = """
[orbit]
altitude = "800 km"
[removal]
macro_step = "60 s"
duration = "1 h"
[removal.thrust]
direction = "along_track"
level = "-0.01 N"
specific_impulse = "3000 s"
"""
REGULATOR = HEAD + '[removal.reel]\nlaw = "regulator"\n'
SCHEDULE = HEAD + '[removal.reel]\nlaw = "schedule"\n'


def read(text: str) -> Scene:
    return parse(text, "reel", "reel.toml")


def mistakes(text: str) -> str:
    with pytest.raises(SceneError) as caught:
        read(text)
    return str(caught.value)


def test_designed_gains_become_parameters() -> None:
    """3 n^2 m_r is in them: the gains of Table 2's pair, as its regulator has them (tests/tethered_deorbit)."""
    main = read(REGULATOR + 'gains = "lqr"\n').phases[0].main
    unit = 1.0381289e-3**2 * 2000.0 / 3.0
    assert main.parameters["reel.proportional_gain"] == pytest.approx(5.78290 * unit, rel=1e-4)
    assert main.parameters["reel.angle_gain"] == pytest.approx(-2.93980 * unit * 12.0, rel=1e-4)
    assert main.parameters["reel.angle"] == pytest.approx(0.129233, rel=1e-4)
    # what only the scene knows goes into no FMU
    names = build.CATALOGUE[main.model].interface(main.terms).references
    assert set(main.parameters) <= set(names)
    assert "reel.gains" in main.asked
    assert "reel.gains" not in names


def test_given_gains_stay_as_they_are() -> None:
    main = read(REGULATOR + 'proportional_gain = "0.004 N/m"\nangle_gain = "-0.02 N"\n').phases[0].main
    assert main.parameters["reel.proportional_gain"] == 0.004
    assert "reel.angle" not in main.parameters


def test_a_sampled_law_is_designed_for_its_sample_time() -> None:
    text = HEAD + '[removal.reel]\nlaw = "sampled_linear"\ngains = "lqr"\nsample_time = "{} s"\n'
    often, seldom = (read(text.format(step)).phases[0].main.parameters for step in (1, 300))
    assert often["reel.winding_rate_gain"] == pytest.approx(2.8164e-3, rel=1e-4)
    assert seldom["reel.winding_rate_gain"] < 0.9 * often["reel.winding_rate_gain"]


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (REGULATOR + 'gains = "best"\n', ('line 13: removal.reel.gains = "best"', "expected one of given, lqr, poles")),
        (
            REGULATOR + 'gains = "lqr"\nangle_gain = "1 N"\n',
            ('line 14: removal.reel.angle_gain = "1 N"', "follows from what this scene asks for"),
        ),
        (
            REGULATOR + 'gains = "poles"\npoles_imaginary = [1.0, 0.0, 0.0, 0.0]\n',
            ("line 14: removal.reel.poles_imaginary", "needs its conjugate beside it"),
        ),
        (
            (REGULATOR + 'gains = "lqr"\nabout = "towing"\n').replace("-0.01 N", "0 N"),
            ("line 14: removal.reel.about", "needs a thrust along the track"),
        ),
        (
            (REGULATOR + 'gains = "lqr"\n').replace("-0.01 N", "-0.1 N"),
            ("removal.reel.about", "3 n^2 l m_c = 0.0776 N", 'expected "towing"'),
        ),
        (SCHEDULE + 'sample_time = "0 s"\n', ('removal.reel.sample_time = "0 s"', "must be greater than 0")),
        (
            SCHEDULE + 'schedule_time = ["0 s", "9 s", "5 s"]\n',
            ("line 13: removal.reel.schedule_time", "element 3, 5 s, must be later than the one before it, 9 s"),
        ),
        (
            SCHEDULE + 'schedule_time = ["0 s", "9 s"]\nschedule_length = ["12 m", "0.5 m"]\n',
            ("line 14: removal.reel.schedule_length", "element 2 must lie between reel.length_least, 1 m"),
        ),
        (
            SCHEDULE + 'length_least = "20 m"\nlength_most = "15 m"\n',
            ('line 13: removal.reel.length_least = "20 m"', "must be at most reel.length_most, 15 m"),
        ),
        (
            SCHEDULE + 'length_least = "13 m"\n',
            ("removal.tether.rest_length", "must lie between reel.length_least, 13 m"),
        ),
        (
            HEAD + '[removal.reel]\nlaw = "brake"\nlength_most = "11 m"\n',
            ("removal.tether.rest_length", "must be at most reel.length_most, 11 m"),
        ),
        (
            HEAD + '[removal.reel]\nlaw = "detumble"\n',
            ("removal.target.body", "a point has no spin to be taken out; expected rigid, box or cylinder"),
        ),
        (
            HEAD + '[removal.environment]\nfield = "none"\n[removal.reel]\nlaw = "libration"\n',
            ("removal.environment.field", "libration needs an orbit"),
        ),
    ],
)
def test_bad_values_are_told_before_any_run(text: str, told: tuple[str, ...]) -> None:
    found = mistakes(text)
    for part in told:
        assert part in found
    assert "1 mistake" in found


def test_a_short_schedule_is_filled_up() -> None:
    text = SCHEDULE + 'schedule_time = ["0 s", "9 s"]\nschedule_length = ["12 m", "11 m"]\n'
    parameters = read(text).phases[0].main.parameters
    assert [parameters[f"reel.schedule_time[{k}]"] for k in (1, 2, 3, 16)] == [0.0, 9.0, 9.0, 9.0]
    assert parameters["reel.schedule_length[16]"] == 11.0


def test_unstable_gains_are_told() -> None:
    (told,) = read(REGULATOR + 'proportional_gain = "0.001 N/m"\n').cautions
    assert "removal.reel.proportional_gain: with these gains the pair leaves its rest near the vertical" in told
    assert not read(REGULATOR + 'gains = "lqr"\n').cautions


def test_samples_too_seldom_for_the_line_are_told() -> None:
    text = HEAD + '[removal.reel]\nlaw = "constant_tension"\nsample_time = "{} s"\n'
    (told,) = read(text.format(1)).cautions
    assert "removal.reel.sample_time: 1 s are 2.43 radians of the pair's vibration" in told
    assert not read(text.format(0.5)).cautions


def test_what_inspect_tells_of_a_loop() -> None:
    main = read(REGULATOR + 'gains = "lqr"\n').phases[0].main
    told = {row.key: row for row in build.implied(main.model, {**main.defaults, **main.parameters}, main.terms)}
    assert [told[f"reel.gain[{k}]"].value for k in (1, 2, 3, 4)] == pytest.approx(
        [-5.78290, -3.41930, 2.93980, -0.21854], abs=1e-4
    )
    assert all(told[f"reel.pole[{k}]"].value < 0.0 for k in (1, 2, 3, 4))
    assert {"reel.gain_reduction", "reel.phase_margin", "reel.rest_tension"} <= told.keys()
    assert told["reel.phase_margin"].unit == "rad"


@pytest.mark.parametrize("name", ["reel-damped", "detumbling"])
def test_scenes(name: str) -> None:
    scene = load(name)
    assert not scene.cautions
