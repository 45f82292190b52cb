"""A third kind of phase: the line of a removal is cut, and another tows on from where both bodies are."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from dcone_cosim.errors import HANDOFF_FAILED, SUCCESS, HandoffError, InputError
from dcone_cosim.loading import find
from dcone_cosim.master import run_scene
from dcone_cosim.phases.phase import Stage
from dcone_cosim.phases.second_tow import SecondTow, TowHandover, begun_again
from dcone_cosim.progress import Progress
from dcone_cosim.results import RunResult
from dcone_cosim.scene.data import Scene
from dcone_cosim.scene_fmus import SceneFmus
from dcone_cosim.scenes.reading import parse
from tests.cosim.conftest import Dcone

TWO_TOWS = find("two-tows").read_text(encoding="utf-8")
MU = 3.986004418e14
RADIUS = 6378137.0
EACH = ("[1]", "[2]", "[3]")


def scene(*settings: str, text: str = TWO_TOWS) -> Scene:
    return parse(text, "two-tows", "two-tows.toml", settings=settings)


def run(chosen: Scene) -> RunResult:
    with SceneFmus(chosen, Progress()) as fmus:
        return run_scene(chosen, fmus.instantiate, Progress(), fmus.adopt)


def last(result: RunResult, phase: str, name: str) -> np.ndarray:
    row = result.phases[phase].recorder.last()
    return np.array([row[f"{name}{each}"] for each in EACH])


ORBITS = {
    "sun-synchronous": (),
    "equatorial": ("orbit.inclination=0 deg",),
    "retrograde equatorial": ("orbit.inclination=180 deg",),
    "turned and eccentric": (
        *("orbit.inclination=51.6 deg", "orbit.raan=200 deg", "orbit.eccentricity=0.05"),
        *("orbit.true_anomaly=250 deg", "orbit.argument_of_perigee=70 deg"),
    ),
}


@pytest.mark.parametrize("orbit", ORBITS.values(), ids=ORBITS)
@pytest.mark.parametrize("cut", [3000.0, 5000.0])
def test_a_tow_cut_in_two_and_tied_again_is_one_tow(orbit: tuple[str, ...], cut: float) -> None:
    """The second line is the first one: the same motion as in one phase, be the line slack or taut at the cut."""
    whole = 6000.0
    same = ("removal.macro_step=50 s", "second_tow.macro_step=50 s", "second_tow.tether.rest_length=12 m", *orbit)
    one = run(scene("phases=['removal']", f"removal.duration={whole} s", *same))
    two = run(scene(f"removal.duration={cut} s", f"second_tow.duration={whole - cut} s", *same))
    assert (one.exit_code, two.exit_code) == (SUCCESS, SUCCESS), two.message
    assert (two.phases["second_tow"].origin, two.phases["second_tow"].end) == (cut, whole - cut)
    for name, tolerance in (("center.position", 1e-5), ("relative.position", 1e-6), ("relative.velocity", 1e-8)):
        assert last(two, "second_tow", name) == pytest.approx(last(one, "removal", name), abs=tolerance), name
    tugs = sorted(row for row in one.phases["removal"].tugs.rows.values() if row[0] > cut + 50.0)
    after = sorted((time + cut, *rest) for time, *rest in two.phases["second_tow"].tugs.rows.values() if time > 50.0)
    assert np.array(after) == pytest.approx(np.array(tugs), rel=1e-5)


def test_a_target_that_turns_goes_on_turning() -> None:
    """Cut and tied again with the same line, a tumbling target is the one it would have been; a point is refused."""
    body = (
        'removal.target.body="rigid"',
        'removal.target.attachment=["0.2 m", "-1 m", "0.1 m"]',
        'removal.target.inertia=["900 kg m2", "500 kg m2", "1000 kg m2", "20 kg m2", "0 kg m2", "-10 kg m2"]',
        'removal.target.start_rate=["0.2 deg/s", "0.1 deg/s", "-0.15 deg/s"]',
    )
    same = ("removal.macro_step=50 s", "second_tow.macro_step=50 s", "second_tow.tether.rest_length=12 m")
    one = run(scene("phases=['removal']", "removal.duration=3000 s", *same, *body))
    two = run(scene("removal.duration=1500 s", "second_tow.duration=1500 s", *same, *body))
    assert (one.exit_code, two.exit_code) == (SUCCESS, SUCCESS), two.message
    assert two.scene.phases[1].main.terms["target"] == "rigid"
    for name, tolerance in (("relative.position", 1e-5), ("target.spin", 1e-6), ("target.rate", 1e-8)):
        assert last(two, "second_tow", name) == pytest.approx(last(one, "removal", name), abs=tolerance), name
    rows = [row for row in two.handovers["second_tow"].rows if "spin" in row.quantity]
    assert len(rows) == 3
    assert all(row.closed for row in rows)
    refused = run(scene("removal.duration=500 s", *same, *body, 'second_tow.target.body="point"'))
    assert refused.exit_code == HANDOFF_FAILED
    assert "which cannot carry its spin" in refused.message


def test_another_line_makes_another_tow() -> None:
    """The twin of the test above: half a metre of line is seen in it."""
    same = ("removal.macro_step=50 s", "second_tow.macro_step=50 s", "removal.duration=3000 s")
    ends = []
    for length in (12.0, 12.5):
        ended = run(scene(*same, f"second_tow.tether.rest_length={length} m", "second_tow.duration=3000 s"))
        ends.append(last(ended, "second_tow", "relative.position"))
    assert np.linalg.norm(ends[0] - ends[1]) > 0.1


def turned(axis: int, angle: float) -> np.ndarray:
    """Matrix that turns a vector about an axis [rad]."""
    c, s = math.cos(angle), math.sin(angle)
    matrix = np.eye(3)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    matrix[i, i], matrix[i, j], matrix[j, i], matrix[j, j] = c, -s, s, c
    return matrix


NORMALS = {
    "any": None,
    "nearly north": (1e-7, 0.0, 1.0),
    "north": (0.0, 0.0, 1.0),
    "south": (0.0, 0.0, -1.0),
    "polar": (1.0, 0.0, 0.0),
}


@pytest.mark.parametrize("normal", NORMALS.values(), ids=NORMALS)
@pytest.mark.parametrize("seed", range(3))
def test_the_parameters_stand_for_the_state_that_was_left(normal: tuple[float, ...] | None, seed: int) -> None:
    """By rotation matrices: from the elements and the relative state back to both inertial states."""
    generator = np.random.default_rng(seed)
    position = generator.normal(size=3)
    velocity = generator.normal(size=3)
    if normal is not None:
        unit = np.array(normal) / np.linalg.norm(normal)
        position, velocity = (x - np.dot(x, unit) * unit for x in (position, velocity))
        if np.dot(np.cross(position, velocity), unit) < 0.0:
            velocity = -velocity
    position *= 7.1e6 / np.linalg.norm(position)
    velocity *= 7.4e3 / np.linalg.norm(velocity)
    momentum = np.cross(position, velocity)
    rate = momentum / np.dot(position, position)
    axes = np.array([position / np.linalg.norm(position), np.zeros(3), momentum / np.linalg.norm(momentum)])
    axes[1] = np.cross(axes[2], axes[0])
    relative, seen = generator.normal(size=3) * 20.0, generator.normal(size=3) * 0.05
    inertial = axes.T @ relative, axes.T @ seen + np.cross(rate, axes.T @ relative)
    left = {"chaser.mass": 2000.0, "target.mass": 1000.0}
    for name, value in (
        *(("center.position", position), ("center.velocity", velocity)),
        *(("relative.position", relative), ("relative.velocity", seen)),
    ):
        left |= {f"{name}{each}": float(x) for each, x in zip(EACH, value, strict=True)}
    found = begun_again(left)
    radius = RADIUS + found["orbit.altitude"]
    assert found["orbit.eccentricity"] == 0.0
    frame = (
        turned(2, found["orbit.raan"])
        @ turned(0, found["orbit.inclination"])
        @ turned(2, found["orbit.argument_of_perigee"] + found["orbit.true_anomaly"])
    )
    motion = np.array([0.0, 0.0, math.sqrt(MU / radius**3)])

    def start(name: str) -> np.ndarray:
        return np.array([found[f"start.{name}{each}"] for each in EACH])

    point = frame @ np.array([radius, 0.0, 0.0])
    assert point + frame @ start("center_position") == pytest.approx(position, abs=1e-7)
    circling = np.cross(motion, np.array([radius, 0.0, 0.0]) + start("center_position"))
    assert frame @ (circling + start("center_velocity")) == pytest.approx(velocity, abs=1e-10)
    assert frame @ start("relative_position") == pytest.approx(inertial[0], abs=1e-12)
    rate_found = frame @ (start("relative_velocity") + np.cross(motion, start("relative_position")))
    assert rate_found == pytest.approx(inertial[1], abs=1e-14)
    assert (found["chaser.mass"], found["target.mass"]) == (2000.0, 1000.0)


class Holding:
    """Stands for an FMU that holds what it is given."""

    def __init__(self, values: Mapping[str, float]) -> None:
        self.values, self.variables = values, values

    def get(self, names: tuple[str, ...]) -> dict[str, float]:
        return {name: self.values[name] for name in names}


@pytest.mark.parametrize("wrong", ["chaser.mass", "target.position[2]", "chaser.velocity[1]", "relative.position[3]"])
def test_the_ledger_sees_what_is_not_held(wrong: str) -> None:
    chosen = scene()
    left = dict.fromkeys(SecondTow.takes, 0.0) | {"chaser.mass": 2000.0, "target.mass": 1000.0}
    for body in ("chaser", "target", "center"):
        left |= {f"{body}.position[1]": 7.1e6, f"{body}.velocity[2]": 7.4e3}
    record = TowHandover(0.0, 0.0, chosen.phases[1], left, None)
    record.close(Holding(left))  # type: ignore[arg-type]
    assert all(row.closed for row in record.rows)
    assert {row.key: row.value for row in record.findings()}["ledger_closure"] == 0.0
    with pytest.raises(HandoffError, match="the ledger does not close"):
        record.close(Holding(left | {wrong: left[wrong] * (1.0 + 1e-9) + 1e-4}))  # type: ignore[arg-type]


def test_the_attachment_stays_where_it_is() -> None:
    """Cut and tied again with the same line, made fast 1 m from the target's centre of mass: one tow once more."""
    same = ("removal.macro_step=50 s", "second_tow.macro_step=50 s", "removal.target.attachment_distance=1 m")
    lines = ("removal.tether.rest_length=11 m", "second_tow.tether.rest_length=11 m")
    one = run(scene("phases=['removal']", "removal.duration=4000 s", *same, *lines))
    two = run(scene("removal.duration=2000 s", "second_tow.duration=2000 s", *same, *lines))
    assert two.given["second_tow"]["target.attachment_distance"] == 1.0
    for name, tolerance in (("relative.position", 1e-6), ("relative.velocity", 1e-8)):
        assert last(two, "second_tow", name) == pytest.approx(last(one, "removal", name), abs=tolerance), name
    near = run(scene("removal.duration=600 s", *same, lines[0], "second_tow.tether.rest_length=10 m"))
    assert near.exit_code == SUCCESS, "10.8 m apart, and 1 m of the way is the target's"


def test_it_begins_when_the_tow_before_ends_whatever_that_began_at() -> None:
    chosen = scene()
    run = RunResult(chosen)
    run.left["removal"] = dict.fromkeys(SecondTow.takes, 0.0)
    tow = SimpleNamespace(start=0.0, end=100.0, origin=8.78, outcome="completed")
    run.phases["removal"] = tow  # type: ignore[assignment]
    stage = Stage(run, chosen.phases[1], chosen.phases[0], None, lambda *_: None, Progress())  # type: ignore[arg-type, return-value]
    record = SecondTow().take_over(stage)
    assert record is not None
    assert (record.time, record.start) == (100.0, 108.78)
    assert run.handovers["second_tow"] is record


def test_what_is_known_of_it_before_a_run() -> None:
    heavy = scene("removal.target.mass=1500 kg").phases[0]
    assert SecondTow().values_taken(heavy) == {"chaser.mass": 2000.0, "target.mass": 1500.0}


def test_a_line_that_is_too_short_is_refused() -> None:
    result = run(scene("removal.duration=600 s", "second_tow.tether.rest_length=9 m"))
    assert result.exit_code == HANDOFF_FAILED
    assert "second_tow.tether.rest_length must be larger" in result.message
    assert result.handovers["second_tow"].failure == result.message
    assert list(result.phases) == ["removal"]


@pytest.mark.parametrize(
    ("settings", "told"),
    [
        (("phases=['second_tow']",), "the second_tow comes first; expected a removal before it"),
        (("phases=['second_tow', 'removal']",), "the removal comes before the second_tow"),
        (("second_tow.target.mass=5 kg",), "is set by the hand-off from the removal; leave it out"),
        (("second_tow.start.separation=5 m",), "is set by the hand-off from the removal; leave it out"),
        (("second_tow.tether.rest_lenght=5 m",), "did you mean 'rest_length'"),
        (("second_tow.hand_over=captured",), "unknown key"),
    ],
)
def test_what_cannot_be_is_told(settings: tuple[str, ...], told: str) -> None:
    with pytest.raises(InputError, match=told.replace("[", r"\[")):
        scene(*settings)


def test_it_follows_a_capture_and_a_removal() -> None:
    mission, tows = find("mission").read_text(encoding="utf-8"), TWO_TOWS
    second = tows[tows.index("[second_tow]") :]
    text = mission.replace('["capture", "removal"]', '["capture", "removal", "second_tow"]') + "\n" + second
    assert [phase.name for phase in scene(text=text).phases] == ["capture", "removal", "second_tow"]
    with pytest.raises(InputError, match="the second_tow comes after the capture; expected a removal before it"):
        scene("phases=['capture', 'second_tow']", text=text)


def test_what_a_run_leaves(dcone: Dcone, tmp_path: Path) -> None:
    short = ("--set", "removal.duration=600 s", "--set", "second_tow.duration=1200 s")
    code, out, err = dcone("run", "two-tows", *short, "-o", "out")
    assert code == 0, err
    assert "hand-off to second_tow" in out
    folder = tmp_path / "out"
    summary = json.loads((folder / "summary.json").read_text())
    assert summary["second_tow"]["simulated"] == {"value": 1200.0, "unit": "s"}
    assert summary["hand-off to second_tow"]["time"] == {"value": 600.0, "unit": "s"}
    ledger = json.loads((folder / "ledger.json").read_text())
    assert len(ledger["rows"]) == 14
    assert all(row["closed"] for row in ledger["rows"])
    for name in ("removal", "second_tow", "tugs", "second_tow_tugs"):
        assert (folder / f"{name}.parquet").is_file()
    for name in ("tether_tension", "second_tow_tether_tension", "second_tow_orbital_radius"):
        assert (folder / f"{name}.png").stat().st_size > 5000
    code, out, err = dcone("build", "two-tows", *short, "-o", "fmus", "--from-run", "out")
    assert (code, len(out.split())) == (0, 2), err
