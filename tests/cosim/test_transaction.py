"""The transaction of the hand-off with stand-ins: what is refused, what is compared, and at which size it matters."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

from dcone_cosim.errors import HANDOFF_FAILED, SUCCESS
from dcone_cosim.master import run_scene
from dcone_cosim.progress import Progress
from dcone_cosim.results import RunResult
from dcone_cosim.scene.data import Scene
from tests.cosim.mock_components import MockCapture, MockComponent, MockRemoval, elements

Make = Callable[..., Scene]
RATE = 1.0381289e-3
INSTANT = 7.1234567
CATCH = -12.0 + 5.0 / 3.0 * INSTANT
DISTANCE = 6.0 * CATCH / 1006.0 + 12.0 + 0.005 * INSTANT
SPEED = 10.0 / 1006.0 + 0.005
"""Of target and net from the chaser, as the mock leaves them [m], [m/s]."""
REACH_AND_ON = math.hypot(0.3, CATCH - 1.5 - 6.0 * CATCH / 1006.0)
"""From the vertex to the joint centre of mass [m]."""


class Telling(MockRemoval):
    """Tells where it has begun in every way the master compares; `false` are factors, by quantity."""

    def __init__(self, **false: float) -> None:
        super().__init__()
        self.false = false
        self.declare(["tether.length"], "output")
        for name in ("relative.position", "relative.velocity"):
            self.declare(elements(name), "output")

    def refresh(self) -> None:
        super().refresh()
        separation = self.values["separation"]
        length = separation - self.values["target.attachment_distance"]
        self.values["separation"] = separation * self.false.get("separation", 1.0)
        self.values["tether.length"] = length * self.false.get("length", 1.0) + self.false.get("longer", 0.0)
        turn = np.array([[0.6, 0.8, 0.0], [-0.8, 0.6, 0.0], [0.0, 0.0, 1.0]])
        for what in ("position", "velocity"):
            vector = turn @ [self.values[name] for name in elements(f"start.relative_{what}")]
            for name, value in zip(elements(f"relative.{what}"), vector, strict=True):
                self.values[name] = value * self.false.get(what, 1.0) + self.false.get(f"{what}_off", 0.0)


def run(scene: Scene, removal: Callable[[], MockComponent], capture: MockCapture | None = None) -> RunResult:
    def instantiate(phase: str, name: str) -> MockComponent:
        return (capture or MockCapture(INSTANT, reports=True)) if phase == "capture" else removal()

    return run_scene(scene, instantiate, Progress())


def test_what_the_removal_computes_is_compared(make_scene: Make) -> None:
    """Sizes that turning the frame does not change; the twin of those below."""
    result = run(make_scene("capture", "removal"), Telling)
    assert result.exit_code == SUCCESS, result.message
    assert result.handovers["removal"] is not None
    assert result.handovers["removal"].failure == ""
    seen = {check.quantity: check for check in result.handovers["removal"].checks}
    length = DISTANCE - REACH_AND_ON
    for quantity, size, unit, tolerance in (
        ("separation", DISTANCE, "m", 1e-4 * DISTANCE),
        ("size of relative.position", DISTANCE, "m", 1e-4 * DISTANCE),
        ("size of relative.velocity", SPEED, "m/s", 1e-4 * (SPEED + RATE * DISTANCE)),
        ("size of tether.length", length, "m", 1e-4 * DISTANCE),
    ):
        check = seen.pop(quantity)
        assert (check.given, check.found, check.unit) == (pytest.approx(size), pytest.approx(size), unit)
        assert check.tolerance == pytest.approx(tolerance, rel=1e-6)
    assert not seen


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(
    ("quantity", "share", "named"),
    [
        ("separation", 1e-4, "separation: handed over"),
        ("position", 1e-4, "size of relative.position: handed over"),
        ("velocity", 1e-4 * (SPEED + RATE * DISTANCE) / SPEED, "size of relative.velocity: handed over"),
        ("length", 1e-4 * DISTANCE / (DISTANCE - REACH_AND_ON), "size of tether.length: handed over"),
    ],
)
def test_one_part_in_ten_thousand_is_the_limit(
    make_scene: Make, quantity: str, share: float, named: str, sign: float
) -> None:
    good = run(make_scene("capture", "removal"), lambda: Telling(**{quantity: 1.0 + 0.99 * sign * share}))
    assert good.exit_code == SUCCESS, good.message
    wrong = run(make_scene("capture", "removal"), lambda: Telling(**{quantity: 1.0 + 1.01 * sign * share}))
    assert wrong.exit_code == HANDOFF_FAILED
    assert wrong.message.startswith("hand-off violated: the ledger does not close\n  " + named)
    assert ", the removal computes " in wrong.message
    assert wrong.handovers["removal"] is not None
    assert wrong.handovers["removal"].failure == wrong.message
    assert "removal" not in wrong.phases


def test_what_is_no_number_is_no_agreement(make_scene: Make) -> None:
    assert run(make_scene("capture", "removal"), lambda: Telling(separation=math.nan)).exit_code == HANDOFF_FAILED


def test_a_removal_that_ignores_where_the_line_is_made_fast_is_caught(make_scene: Make) -> None:
    wrong = run(make_scene("capture", "removal"), lambda: Telling(longer=REACH_AND_ON))
    assert wrong.exit_code == HANDOFF_FAILED
    assert f"size of tether.length: handed over {DISTANCE - REACH_AND_ON:.12g} m" in wrong.message
    assert f"the removal computes {DISTANCE:.12g} m" in wrong.message


def test_a_chaser_nearer_than_the_attachment_is_compared_by_size(make_scene: Make) -> None:
    """The vertex far behind the target: the line's length is then less than nothing, and a bend of 28 m is told."""

    class Beyond(MockCapture):
        def refresh(self) -> None:
            super().refresh()
            self.values |= {"vertex.position[1]": 0.0, "vertex.position[2]": 14.0}

    scene = make_scene("capture", "removal")
    scene.phases[1].main.parameters["tether.rest_length"] = 30.0  # type: ignore[index]
    result = run(scene, Telling, Beyond(INSTANT, reports=True))
    assert result.exit_code == SUCCESS, result.message
    assert result.handovers["removal"] is not None
    check = next(check for check in result.handovers["removal"].checks if check.quantity == "size of tether.length")
    assert check.given == pytest.approx(14.0 - 6.0 * CATCH / 1006.0 - DISTANCE, rel=1e-9)
    slack = next(row for row in result.handovers["removal"].rows if row.quantity == "slack of the line")
    assert slack.after - slack.before == pytest.approx(2.0 * (14.0 - 6.0 * CATCH / 1006.0), rel=1e-9)


def test_a_removal_that_lacks_a_parameter_is_named(make_scene: Make) -> None:
    class Short(MockRemoval):
        def set(self, values: dict[str, float]) -> None:  # type: ignore[override]
            super().set({name: value for name, value in values.items() if name in self.values})

    def short() -> MockComponent:
        made = Short()
        for name in ("start.center_velocity[2]", "target.mass"):
            del made.values[name], made.variables[name]
        return made

    result = run(make_scene("capture", "removal"), short)
    assert result.exit_code == HANDOFF_FAILED
    assert result.message == "hand-off violated: the removal FMU lacks target.mass, start.center_velocity[2]"


def test_an_open_row_is_told_in_full(make_scene: Make) -> None:
    result = run(make_scene("capture", "removal"), lambda: MockRemoval({"target.mass": 1.01}))
    first, *lines = result.message.splitlines()
    assert first == "hand-off violated: the ledger does not close"
    assert len(lines) > 3
    assert all(line.startswith("  ") and line.endswith(" of the sum of magnitudes") for line in lines)
    line = next(line for line in lines if "mass, target and net" in line)
    assert line.strip().startswith("mass, target and net: before 1006 kg, after 1016.0")
    assert "difference -10.1 kg is 0.00335 of the sum of magnitudes" in line


def spinning(make_scene: Make, spin: float, **handoff: float) -> RunResult:
    capture = MockCapture(INSTANT, reports=True, spin=spin)
    capture.values["target.reach"] = 3.5
    return run(make_scene("capture", "removal", **handoff), MockRemoval, capture)


def test_what_is_told_of_the_energy_adds_up(make_scene: Make) -> None:
    """What was there before is there after, was lost in the joining, or is the dropped spin's."""
    record = spinning(make_scene, 5.0).handovers["removal"]
    told = {row.key: row.value for row in record.findings()}
    energy = next(row for row in record.rows if row.quantity == "kinetic energy")
    assert told["spin_energy_dropped"] == pytest.approx(0.5 * 5.0**2 / 1500.0, rel=0.02)
    assert told["energy_lost"] > 0.0
    gone = told["energy_lost"] + told["spin_energy_dropped"]
    assert energy.before - energy.after == pytest.approx(gone, rel=1e-9)


def test_a_point_is_judged_at_the_scene_s_tolerance(make_scene: Make) -> None:
    """One that can only be a point is refused above the bound of what it changes, and not at it."""
    still = spinning(make_scene, 0.05).handovers["removal"]
    assert still is not None
    bound = still.bound.largest
    assert 0.0 < bound < math.inf
    assert spinning(make_scene, 0.05, point_tolerance=bound).exit_code == SUCCESS
    refused = spinning(make_scene, 0.05, point_tolerance=0.999 * bound)
    assert refused.exit_code == HANDOFF_FAILED
    record = refused.handovers["removal"]
    assert record is not None
    assert record.failure == refused.message
    spin = 0.05 + 1000.0 * 6.0 / 1006.0 * (-12.0 + 5.0 / 3.0 * INSTANT) ** 2 * RATE  # of the net as it goes round
    for text in (
        "hand-off refused: the removal's point target cannot carry what the capture leaves\n",
        f"spin of target and net {spin:.4g} N m s, {spin / 1500.0 * 3.5:.4g} m/s at the tether's end",
        f"may be off by {100 * bound:.3g} %: more than the {99.9 * bound:g} % of handoff.point_tolerance",
        "a removal FMU with target.inertia[1], target.start_attitude[1], target.start_rate[1] and what else",
    ):
        assert text in refused.message
    turning = spinning(make_scene, 50.0, point_tolerance=1e9)
    assert turning.exit_code == HANDOFF_FAILED, "where the line would wrap no finite tolerance is enough"
    assert "the line wraps" in turning.message


@pytest.mark.parametrize("thrust", [None, -0.04])
def test_the_thrust_of_the_scene_counts(make_scene: Make, thrust: float | None) -> None:
    """In the estimate of the first tug; a removal without a thruster has none."""
    scene = make_scene("capture", "removal")
    given = scene.phases[1].main.parameters
    given.pop("thrust.level")  # type: ignore[attr-defined]
    if thrust is not None:
        given["thrust.level"] = thrust  # type: ignore[index]
    result = run(scene, MockRemoval)
    assert result.handovers["removal"] is not None
    slack = 20.0 + REACH_AND_ON - DISTANCE
    expected = math.sqrt(SPEED**2 + 2.0 * abs(thrust or 0.0) / 2000.0 * slack)
    assert result.handovers["removal"].spin.tug_speed == pytest.approx(expected, rel=1e-12)


def test_a_removal_of_unknown_length_counts_as_tight(make_scene: Make) -> None:
    scene = make_scene("capture", "removal")
    scene.phases[1].main.parameters.pop("tether.rest_length")  # type: ignore[attr-defined]
    scene.phases[1].main.defaults.clear()  # type: ignore[attr-defined]
    result = run(scene, lambda: MockRemoval(without=["tether.rest_length"]))
    assert result.handovers["removal"] is not None
    assert result.handovers["removal"].spin.tug_speed == pytest.approx(SPEED, rel=1e-12)


def test_the_tow_without_recoil_keeps_what_the_chaser_had(make_scene: Make) -> None:
    """Its own velocity before the shot, and nothing of the shot's."""
    made: list[MockComponent] = []
    capture = MockCapture(INSTANT, reports=True)
    capture.values |= {"chaser.start_velocity[1]": 2e-3, "chaser.start_velocity[2]": 3e-2}

    def removal() -> MockComponent:
        made.append(MockRemoval())
        return made[-1]

    result = run(make_scene("capture", "removal"), removal, capture)
    assert result.exit_code == SUCCESS, result.message
    with_recoil, without = (component.values for component in made)
    for i, start in enumerate((2e-3, 3e-2, 0.0), start=1):
        assert without[f"start.relative_velocity[{i}]"] == pytest.approx(-start, abs=1e-17)
        assert without[f"start.center_velocity[{i}]"] == pytest.approx(2000.0 / 3006.0 * start, abs=1e-17)
        assert without[f"start.relative_position[{i}]"] == with_recoil[f"start.relative_position[{i}]"]
    assert without["tether.rest_length"] == with_recoil["tether.rest_length"] == 20.0
    assert without["target.attachment_distance"] == with_recoil["target.attachment_distance"] > 1.0
