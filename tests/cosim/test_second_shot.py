"""Further shots after one that failed, and the next debris: phases of the master that follow or are left out."""

from __future__ import annotations

import json
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from dcone_cosim.errors import CAPTURE_FAILED, HANDOFF_FAILED, SUCCESS, InputError
from dcone_cosim.loading import find
from dcone_cosim.master import run_scene
from dcone_cosim.phases import kinds
from dcone_cosim.phases.expended import of_tows
from dcone_cosim.phases.second_shot import ShotHandover
from dcone_cosim.progress import Progress
from dcone_cosim.results import RunResult
from dcone_cosim.scene.data import Scene
from dcone_cosim.scene.mistakes import SceneError
from dcone_cosim.scene_fmus import SceneFmus
from dcone_cosim.scenes.reading import parse
from tests.cosim.fmus.build import build

NET, ISP, G0 = 6.0, 300.0, 9.80665
SHOTS = """
phases = ["capture", "second_shot", "third_shot"]

[capture]
fmu = "my_capture.fmu"
isolate = false
macro_step = "0.5 s"
duration = "20 s"

[capture.chaser]
mass = "1000 kg"
start_velocity = ["0 m/s", "0 m/s", "0 m/s"]

[second_shot]
like = "capture"
reload = "50 s"

[third_shot]
like = "second_shot"

[handoff]
specific_impulse = "300 s"
"""


def hits(shot: str) -> str:
    """Setting with which a shot takes the target: its chaser is fast enough sideways."""
    return f'{shot}.chaser.start_velocity=["1 m/s", "0 m/s", "0 m/s"]'


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """With the capture of the C template, which takes the target where its chaser is faster sideways than 0.6 m/s."""
    return build(tmp_path_factory.mktemp("shots"), "capture", "MISSES=0.6").parent


def scene(folder: Path, *settings: str, text: str = SHOTS) -> Scene:
    return parse(text, "shots", str(folder / "shots.toml"), folder, settings)


def run(chosen: Scene) -> RunResult:
    with SceneFmus(chosen, Progress()) as fmus:
        return run_scene(chosen, fmus.instantiate, Progress(), fmus.adopt)


def test_each_shot_is_made_where_the_one_before_has_failed(folder: Path) -> None:
    first = run(scene(folder, hits("capture")))
    assert (first.exit_code, list(first.phases)) == (SUCCESS, ["capture"])
    second = run(scene(folder, hits("second_shot")))
    assert (second.exit_code, list(second.phases)) == (SUCCESS, ["capture", "second_shot"])
    assert [result.outcome for result in second.phases.values()] == ["missed", "captured"]
    none = run(scene(folder))
    assert (none.exit_code, list(none.phases)) == (CAPTURE_FAILED, ["capture", "second_shot", "third_shot"])
    assert [result.outcome for result in none.phases.values()] == ["missed"] * 3


def test_mass_nets_and_propellant_run_down(folder: Path) -> None:
    """By hand: the shot gives the chaser 18 mm/s; it comes back in 50 s. Each net is of 6 kg."""
    ran = run(scene(folder))
    mass, spent = 1000.0, 0.0
    for place, name in enumerate(("second_shot", "third_shot")):
        record = ran.handovers[name]
        assert isinstance(record, ShotHandover)
        recoil, flight = NET * 3.0 / mass, ran.phases["capture"].end
        back = recoil * flight / 50.0
        burnt = mass * -np.expm1(-(recoil + 2.0 * back) / (ISP * G0))
        spent, mass = spent + burnt, mass - burnt - NET
        assert record.expended.speed == pytest.approx(recoil + 2.0 * back, rel=2e-2)  # the frame turns a little
        assert record.expended.propellant == pytest.approx(burnt, rel=2e-2)
        assert ran.parameters[name]["chaser.mass"] == pytest.approx(mass, rel=1e-6)
        told = {row.key: row.value for row in record.findings()}
        assert told["nets_left"] == 1 - place
        assert told["propellant_spent"] == pytest.approx(spent, rel=2e-2)
        assert all(row.closed for row in record.rows)
        assert record.time == flight + 50.0


def test_a_chaser_without_propellant_does_not_shoot_again(folder: Path) -> None:
    needed = run(scene(folder)).handovers["second_shot"].expended.propellant  # type: ignore[attr-defined]
    budget = f"handoff.propellant={1.5 * needed} kg"
    refused = run(scene(folder, budget))
    assert (refused.exit_code, list(refused.phases)) == (HANDOFF_FAILED, ["capture", "second_shot"])
    assert f"it had {1.5 * needed:.6g} kg, handoff.propellant" in refused.message


def test_a_shot_that_is_refused_tells_what_it_needed(folder: Path) -> None:
    """The same figures as where it has enough, and none of what it would have left."""
    names = ("velocity_change", "propellant")
    enough = {row.key: row.value for row in run(scene(folder)).handovers["second_shot"].findings()}
    record = run(scene(folder, "handoff.propellant=1e-3 kg")).handovers["second_shot"]
    told = {row.key: row.value for row in record.findings()}
    assert [told[name] for name in names] == [enough[name] for name in names]
    assert told["propellant"] > 1e-3
    assert told["propellant_spent"] == 0.0
    assert not {"chaser_mass", "nets_left"} & set(told)


class Saying(Progress):
    def __init__(self) -> None:
        self.said: list[str] = []

    def say(self, text: str) -> None:
        self.said.append(text)


TOWS = (
    SHOTS.replace('"second_shot", "third_shot"', '"second_shot", "removal", "second_tow"')
    + """
propellant = "1 kg"

[removal]
macro_step = "20 s"
duration = "100 s"

[removal.reel]
law = "locked"

[removal.tether]
rest_length = "100 m"

[removal.thrust]
direction = "along_track"
level = "-2 N"
specific_impulse = "200 s"

[second_tow]
macro_step = "20 s"
duration = "200 s"

[second_tow.reel]
law = "locked"

[second_tow.tether]
rest_length = "100 m"

[second_tow.thrust]
direction = "along_track"
level = "-2 N"
specific_impulse = "200 s"
"""
)
FIRST_TOW, SECOND_TOW = (2.0 * time / (200.0 * G0) for time in (100.0, 200.0))
"""Propellant that they take [kg]."""


@pytest.mark.parametrize(
    ("share", "status", "beyond"),
    [
        (0.9, "propellant overdrawn", ["removal"]),
        (2.9, "propellant overdrawn", ["second tow"]),
        (3.1, "completed", []),
    ],
)
def test_no_tow_takes_more_propellant_than_there_is(folder: Path, share: float, status: str, beyond: list[str]) -> None:
    """Told before it begins, and booked once it is over; the second takes twice as much as the first."""
    chosen, progress = scene(folder, hits("capture"), f"handoff.propellant={share * FIRST_TOW} kg", text=TOWS), Saying()
    with SceneFmus(chosen, Progress()) as fmus:
        ran = run_scene(chosen, fmus.instantiate, progress, fmus.adopt)
    assert (ran.status, ran.exit_code) == (status, HANDOFF_FAILED if beyond else SUCCESS), ran.message
    assert [text for text in progress.said if "propellant" in text] == [
        f"warning: the {tow} would take {needed:.6g} kg of propellant if it thrust all the time; the chaser had "
        f"{share * FIRST_TOW:.6g} kg, handoff.propellant, and {before:.6g} kg were spent before"
        for tow, needed, before in (("removal", FIRST_TOW, 0.0), ("second tow", SECOND_TOW, FIRST_TOW))
        if tow in beyond
    ]
    taken = of_tows(ran, "next_capture")
    assert taken == pytest.approx(FIRST_TOW + (SECOND_TOW if "second_tow" in ran.phases else 0.0), rel=1e-9)
    if beyond:
        assert ran.message.startswith(f"the {beyond[0]} has taken ")
        assert f"the chaser had {share * FIRST_TOW:.6g} kg, handoff.propellant" in ran.message
        assert list(ran.phases)[-1].replace("_", " ") == beyond[0]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (SHOTS.replace('reload = "50 s"', ""), "second_shot.reload missing"),
        (SHOTS.replace('reload = "50 s"', 'reload = "25 h"'), 'second_shot.reload = "25 h": must be at most 24 h'),
        (SHOTS.replace('specific_impulse = "300 s"', ""), "handoff.specific_impulse"),
        (SHOTS.replace('like = "capture"', 'like = "captrue"'), "did you mean 'capture'"),
        (SHOTS + '[second_shot.chaser]\nmass = "9 kg"\n', "is set by the hand-off from the capture"),
        (SHOTS.replace('"capture", ', ""), "expected a capture before it"),
    ],
)
def test_what_is_missing_or_said_twice_is_told(folder: Path, text: str, said: str) -> None:
    with pytest.raises((SceneError, InputError)) as error:
        scene(folder, text=text)
    assert said in str(error.value)


OF_OURS = {name: find(name).read_text(encoding="utf-8") for name in ("second-shot", "two-debris")}


@pytest.mark.parametrize(
    ("name", "setting", "said"),
    [
        (
            "second-shot",
            "second_shot.net.mass=3000 kg",
            'second_shot.net.mass = "3000 kg": must be less, with bullets and vertex, than capture.chaser.mass = '
            '"2000 kg"; these are 3005.23 kg',
        ),
        ("two-debris", "next_capture.net.mass=1995 kg", 'capture.chaser.mass = "2000 kg"; these are 2000.23 kg'),
        ("second-shot", "handoff.propellant=0 kg", 'handoff.propellant = "0 kg": must be greater than 0 kg'),
        ("two-debris", "next_capture.velocity_change=1e5 m/s", "must be at most 20000 m/s"),
        ("second-shot", "second_shot.reload=1e6 s", "must be at most 86400 s"),
    ],
)
def test_values_that_no_mission_has(name: str, setting: str, said: str) -> None:
    with pytest.raises(SceneError) as error:
        parse(OF_OURS[name], name, f"{name}.toml", settings=(setting,))
    assert said in str(error.value)


@pytest.mark.parametrize(("reload", "told"), [("50 min", False), ("51 min", True)])
def test_a_return_of_half_an_orbit_is_told(reload: str, told: bool) -> None:
    """At 800 km half an orbit takes 50.4 min."""
    chosen = parse(
        OF_OURS["second-shot"], "second-shot", "second-shot.toml", settings=(f"second_shot.reload={reload}",)
    )
    assert any(text.startswith("second_shot.reload: ") for text in chosen.cautions) is told


def test_a_net_lighter_than_its_chaser_will_do() -> None:
    parse(OF_OURS["second-shot"], "second-shot", "second-shot.toml", settings=("second_shot.net.mass=1990 kg",))


def test_what_is_left_is_in_the_frame_of_the_first_shot() -> None:
    """A second shot's frame begins at a target that drifts; by Hill's equations, all its bodies come out where they are
    in the frame of the first."""
    n, kind = 1.0381e-3, kinds()["second_shot"]
    generator = np.random.default_rng(3)
    origin = generator.normal(size=3), 0.02 * generator.normal(size=3)
    bodies = {name: (5.0 * generator.normal(size=3), 0.1 * generator.normal(size=3)) for name in ("chaser", "catch")}

    def flight(_: float, s: np.ndarray) -> np.ndarray:
        return np.array([*s[3:], 2 * n * s[4] + 3 * n * n * s[0], -2 * n * s[3], -n * n * s[2]])

    def after(place: np.ndarray, speed: np.ndarray) -> np.ndarray:
        return solve_ivp(flight, (0.0, 20.0), [*place, *speed], method="DOP853", rtol=1e-12, atol=1e-12).y[:, -1]

    left = {"catch.mass": NET, "energy.kinetic": 40.0}
    for name, state in bodies.items():
        own = after(*state)
        names = [f"{name}.{of}[{i}]" for of in ("position", "velocity") for i in (1, 2, 3)]
        left |= dict(zip(names, own.tolist(), strict=True))
    record = ShotHandover.__new__(ShotHandover)
    record.rate, record.origin = n, origin
    there = SimpleNamespace(handovers={"second_shot": record}, phases={"second_shot": SimpleNamespace(located=20.0)})
    moved = kind.leaves(there, None, left)  # type: ignore[arg-type]
    for name, (place, speed) in bodies.items():
        expected = after(place + origin[0], speed + origin[1])
        got = [moved[f"{name}.{of}[{i}]"] for of in ("position", "velocity") for i in (1, 2, 3)]
        assert got == pytest.approx(expected, abs=1e-9), name
    within, seen = (np.array([v[f"catch.velocity[{i}]"] for i in (1, 2, 3)]) for v in (left, moved))
    inner = moved["energy.kinetic"] - 0.5 * NET * float(seen @ seen)
    assert inner == pytest.approx(40.0 - 0.5 * NET * float(within @ within), abs=1e-9)


@pytest.mark.evidence
@pytest.mark.parametrize("name", ["second-shot", "two-debris"])
def test_shipped_missions_close_their_ledgers(name: str, tmp_path: Path) -> None:
    """Every hand-over of the mission; the tow begins with a chaser that is lighter by net and propellant."""
    chosen = parse(find(name).read_text(encoding="utf-8"), name, f"{name}.toml", tmp_path)
    ran = run(chosen)
    assert ran.exit_code == SUCCESS, ran.message
    assert list(ran.phases) == [phase.name for phase in chosen.phases]
    first = {"second-shot": "tether_taut", "two-debris": "captured"}[name]
    assert ran.phases["capture"].outcome == first
    for record in ran.handovers.values():
        assert record.rows
        assert all(row.closed for row in record.rows), json.dumps(record.told(), default=str)
    masses = [ran.parameters[phase]["chaser.mass"] for phase in ran.phases]
    assert masses == sorted(masses, reverse=True)
    assert masses[-1] < masses[0] - NET


@pytest.mark.evidence
def test_a_net_that_slipped_off_leaves_a_target_that_drifts_and_turns(tmp_path: Path) -> None:
    """The first net closes too early and pushes the box; what it gave is in the ledger, and the second shot finds the
    box where it has drifted."""
    text = find("failed-slipped-off").read_text(encoding="utf-8").replace('["capture"]', '["capture", "second_shot"]')
    text += '[second_shot]\nlike = "capture"\nreload = "60 s"\n\n[second_shot.closing]\ntime = "9 s"\nspeed = "5 m/s"\n'
    ran = run(parse(text + '\n[handoff]\nspecific_impulse = "220 s"\n', "again", "again.toml", tmp_path))
    assert ran.phases["capture"].outcome == "slipped_off"
    record = ran.handovers["second_shot"]
    assert isinstance(record, ShotHandover)
    assert all(row.closed for row in record.rows)
    assert np.linalg.norm(record.origin[1]) > 1e-3
    momenta = [row for row in record.rows if row.quantity.startswith("linear momentum")]
    assert max(abs(row.after) for row in momenta) > 1.0
    spins = [row for row in record.rows if "spin" in row.quantity]
    assert max(abs(row.after) for row in spins) > 1.0
