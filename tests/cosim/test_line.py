"""The line across the hand-off: its slack is what the capture's was, in whatever way the removal takes it."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from dcone_cosim.errors import HANDOFF_FAILED, SUCCESS
from dcone_cosim.handoff import prepare
from dcone_cosim.ledger import LedgerRow
from dcone_cosim.line import Line, line_notes, line_of, line_parameters
from dcone_cosim.master import run_scene
from dcone_cosim.progress import Progress
from dcone_cosim.reports import summary
from dcone_cosim.results import RunResult
from dcone_cosim.scene.data import Scene
from tests.cosim.mock_components import MockCapture, MockComponent, MockRemoval
from tests.cosim.raw_world import RATE, world

Make = Callable[..., Scene]
ATTACHMENT, REST = "target.attachment_distance", "tether.rest_length"
OFFSET, LENGTH, SLACK = "attachment to centre of mass", "length of the line", "slack of the line"
INSTANT = 7.1234567
CHASER = -12.0 - 0.005 * INSTANT
CATCH = -12.0 + 5.0 / 3.0 * INSTANT
VERTEX = (0.3, CATCH - 1.5)
JOINT = 6.0 * CATCH / 1006.0
REACH = math.hypot(VERTEX[0], VERTEX[1] - CHASER)
OFF_CENTER = math.hypot(VERTEX[0], VERTEX[1] - JOINT)
DISTANCE = JOINT - CHASER
"""Where the mock leaves chaser, vertex and joint centre of mass, along-track and (vertex) radial [m]."""


def hand_over(
    scene: Scene, capture: MockCapture | None = None, **removal: Any
) -> tuple[RunResult, list[MockComponent], dict[str, LedgerRow]]:
    made: list[MockComponent] = []

    def instantiate(phase: str, name: str) -> MockComponent:
        component = (capture or MockCapture(INSTANT, reports=True)) if phase == "capture" else MockRemoval(**removal)
        made.append(component)
        return component

    result = run_scene(scene, instantiate, Progress())
    assert result.handovers["removal"] is not None
    return result, made, {row.quantity: row for row in result.handovers["removal"].rows if row.unit == "m"}


def slack_of(removal: MockComponent) -> float:
    """Of a line between two points that the removal would have, from its own parameters."""
    apart = math.hypot(*(removal.values[f"start.relative_position[{i}]"] for i in (1, 2, 3)))
    return removal.values[REST] + removal.values.get(ATTACHMENT, 0.0) - apart


def test_where_the_mock_leaves_the_line() -> None:
    """The figures below are worth something: a bend that shows, and an offset of metres."""
    assert 1.0 < OFF_CENTER < 2.0
    assert 1e-2 < REACH + OFF_CENTER - DISTANCE < 0.1


@pytest.mark.parametrize("line", [None, 20.0])
def test_length_and_offset_are_handed_over(make_scene: Make, line: float | None) -> None:
    """With and without a tether of the capture's own: the line keeps its length, and with it its stiffness."""
    result, made, rows = hand_over(make_scene("capture", "removal"), MockCapture(INSTANT, reports=True, line=line))
    assert result.exit_code == SUCCESS, result.message
    for removal in made[1:]:
        assert removal.values[REST] == 20.0
        assert removal.values[ATTACHMENT] == pytest.approx(OFF_CENTER, rel=1e-13)
        bend = REACH + OFF_CENTER - DISTANCE
        assert slack_of(removal) == pytest.approx(20.0 - REACH + bend, rel=1e-13)
    assert len(made) == 3, "the tow without recoil has the same line"
    for quantity, before, after, accounted in (
        (OFFSET, OFF_CENTER, OFF_CENTER, 0.0),
        (LENGTH, 20.0, 20.0, 0.0),
        (SLACK, 20.0 - REACH, 20.0 + OFF_CENTER - DISTANCE, DISTANCE - REACH - OFF_CENTER),
    ):
        row = rows[quantity]
        assert (row.before, row.after, row.accounted) == pytest.approx((before, after, accounted), abs=1e-12)
        assert row.magnitude == pytest.approx(20.0 + REACH + OFF_CENTER + DISTANCE, rel=1e-12)
        assert row.closed
    assert "bend" in rows[SLACK].account
    assert f"{REACH + OFF_CENTER - DISTANCE:.3g} m" in rows[SLACK].account
    assert rows[OFFSET].account == rows[LENGTH].account == ""


def test_an_fmu_that_does_not_know_the_offset_gets_a_longer_line(make_scene: Make) -> None:
    """The slack is the same, the stiffness that of the longer line: both rows say so."""
    result, made, rows = hand_over(make_scene("capture", "removal"), without=[ATTACHMENT])
    assert result.exit_code == SUCCESS, result.message
    for removal in made[1:]:
        assert removal.values[REST] == pytest.approx(20.0 + OFF_CENTER, rel=1e-14)
        assert slack_of(removal) == pytest.approx(20.0 + OFF_CENTER - DISTANCE, rel=1e-13)
    for quantity, before, after, accounted in (
        (OFFSET, OFF_CENTER, 0.0, OFF_CENTER),
        (LENGTH, 20.0, 20.0 + OFF_CENTER, -OFF_CENTER),
        (SLACK, 20.0 - REACH, 20.0 + OFF_CENTER - DISTANCE, DISTANCE - REACH - OFF_CENTER),
    ):
        row = rows[quantity]
        assert (row.before, row.after, row.accounted) == pytest.approx((before, after, accounted), abs=1e-12)
        assert row.closed
    for quantity in (OFFSET, LENGTH):
        assert "no target.attachment_distance: its line is longer" in rows[quantity].account
        assert "stiffness of that length" in rows[quantity].account


@pytest.mark.parametrize("line", [None, 14.0, 5.0])
def test_an_fmu_that_takes_no_line_says_what_is_lost(make_scene: Make, line: float | None) -> None:
    """Nor can such a line be too short for it."""
    scene = make_scene("capture", "removal")
    del scene.phases[1].main.parameters[REST]  # type: ignore[attr-defined]
    scene.phases[1].main.defaults.clear()  # type: ignore[attr-defined]
    capture = MockCapture(INSTANT, reports=True, line=line)
    result, made, rows = hand_over(scene, capture, without=[ATTACHMENT, REST])
    assert result.exit_code == SUCCESS, result.message
    assert len(made) == 3
    lost = rows[OFFSET]
    assert (lost.before, lost.after, lost.accounted) == pytest.approx((OFF_CENTER, 0.0, OFF_CENTER), rel=1e-13)
    size = (line or 0.0) + REACH + OFF_CENTER + DISTANCE
    assert lost.magnitude == pytest.approx(size, rel=1e-13)
    assert lost.account == "not carried: the removal FMU has neither target.attachment_distance nor tether.rest_length"
    assert (SLACK in rows) == (line is not None)
    if line is not None:
        row, slack = rows[SLACK], line - REACH
        assert (row.before, row.after, row.accounted) == pytest.approx((slack, 0.0, slack), rel=1e-13)
        assert "not carried" in row.account
    assert LENGTH not in rows


def test_a_working_reel_is_told_the_offset(make_scene: Make) -> None:
    """It has no slack of its own; the commanded length counts in the estimate of the first tug."""
    scene = make_scene("capture", "removal")
    scene.phases[1].main.parameters.pop(REST)  # type: ignore[attr-defined]
    scene.phases[1].main.defaults.pop(REST)  # type: ignore[attr-defined]
    scene.phases[1].main.defaults["reel.length"] = 15.0  # type: ignore[index]
    result, made, rows = hand_over(scene, without=[REST])
    assert result.exit_code == SUCCESS, result.message
    assert made[1].values[ATTACHMENT] == pytest.approx(OFF_CENTER, rel=1e-13)
    assert set(rows) == {OFFSET}
    assert rows[OFFSET].account == ""
    assert result.handovers["removal"] is not None
    speed = 0.005 + 10.0 / 1006.0
    slack = 15.0 + OFF_CENTER - DISTANCE
    assert result.handovers["removal"].spin.tug_speed == pytest.approx(
        math.sqrt(speed**2 + 2.0 * 0.01 / 2000.0 * slack), rel=1e-12
    )


@pytest.mark.parametrize(("name", "factor"), [(ATTACHMENT, 1.01), (REST, 1.01), (REST, 1.0 - 1e-11)])
def test_a_removal_with_another_line_is_caught(make_scene: Make, name: str, factor: float) -> None:
    result, _, rows = hand_over(make_scene("capture", "removal"), tampered={name: factor})
    assert result.exit_code == HANDOFF_FAILED
    assert "does not close" in result.message
    assert not rows[SLACK].closed
    assert not rows[OFFSET if name == ATTACHMENT else LENGTH].closed


def test_the_estimate_of_the_first_tug_has_the_slack_handed_over(make_scene: Make) -> None:
    result, _, _ = hand_over(make_scene("capture", "removal"))
    assert result.handovers["removal"] is not None
    speed, slack = 0.005 + 10.0 / 1006.0, 20.0 + OFF_CENTER - DISTANCE
    assert result.handovers["removal"].spin.tug_speed == pytest.approx(
        math.sqrt(speed**2 + 2.0 * 0.01 / 2000.0 * slack), rel=1e-12
    )


@pytest.mark.parametrize(
    ("length", "accepted"), [(REACH, True), (REACH * (1.0 - 0.9e-6), True), (REACH * (1.0 - 1.1e-6), False)]
)
def test_a_line_that_is_too_short_is_refused(make_scene: Make, length: float, accepted: bool) -> None:
    """Judged between the attachments; one that is tight to a millionth was handed over when it came taut."""
    scene = make_scene("capture", "removal")
    scene.phases[1].main.parameters[REST] = length  # type: ignore[index]
    result, made, _ = hand_over(scene)
    assert (result.exit_code == SUCCESS) is accepted
    if not accepted:
        assert len(made) == 1
        assert result.handovers["removal"] is not None
        assert result.handovers["removal"].failure == result.message
        for told in (f"{REACH:.6g} m apart", f"{length:.6g} m long", f"t = {INSTANT:.6g} s"):
            assert told in result.message


def test_a_millionth_is_where_a_line_is_too_short() -> None:
    """Of its length, and not of another; one of unknown length is not."""
    for reach, overrun in ((1e3, False), (1e3 + 0.99e-3, False), (1e3 + 1.01e-3, True)):
        assert Line(1e3, reach, 2.0, 1e3).overrun is overrun
    assert not Line(1.0, 1.0 + 1e-6, 0.0, 1.0).overrun
    assert not Line(None, 1e3, 2.0, 1e3).overrun


@pytest.mark.parametrize("seed", range(6))
def test_the_bend_is_that_of_the_triangle(seed: int) -> None:
    """By the law of cosines, from the raw points; it can only be gained."""
    made = world(seed)
    line = line_of(prepare(made.outputs(), RATE), 14.0)
    out, on = made.vertex - made.chaser.position[0], made.joint.center()[0] - made.vertex
    reach, attachment = float(np.linalg.norm(out)), float(np.linalg.norm(on))
    cosine = float(out @ on) / (reach * attachment)
    straight = math.sqrt(reach**2 + attachment**2 + 2.0 * reach * attachment * cosine)
    assert line.reach == pytest.approx(reach, rel=1e-13)
    assert line.attachment == pytest.approx(attachment, rel=1e-13)
    assert line.slack == pytest.approx(14.0 - reach, rel=1e-12)
    assert line.bend == pytest.approx(reach + attachment - straight, abs=1e-13)
    assert line.bend > 1e-4
    assert line_of(prepare(made.outputs(), RATE), None).slack is None


def test_what_is_said_beforehand() -> None:
    assert line_notes([ATTACHMENT, REST]) == []
    assert "longer by as much" in line_notes([REST])[0]
    assert "not carried" in line_notes(["reel.length"])[0]


def test_a_line_of_unknown_length_sets_none() -> None:
    line = Line(None, 10.0, 2.0, 12.0)
    assert line_parameters(line, [REST]) == line_parameters(line, []) == {}
    assert line_parameters(line, [REST, ATTACHMENT]) == {ATTACHMENT: 2.0}


@pytest.mark.parametrize("without", [[], [ATTACHMENT]])
def test_the_summary_says_which_line_was_handed_over(make_scene: Make, without: list[str]) -> None:
    result, _, _ = hand_over(make_scene("capture", "removal"), without=without)
    told = {row.key: row for row in summary.findings(result) if row.phase == "hand-off"}
    assert told["line"].value == 20.0
    assert told["attachment_distance"].value == pytest.approx(OFF_CENTER, rel=1e-13)
    assert told["slack"].value == pytest.approx(20.0 - REACH, rel=1e-12)
    assert told["slack_after"].value == pytest.approx(20.0 + OFF_CENTER - DISTANCE, rel=1e-12)
    assert any("longer by as much" in str(row.value) for row in told.values()) == bool(without)
