"""How far a net was open as it met its target: between two rows, on a straight line."""

from __future__ import annotations

import numpy as np
import pytest

from dcone_cosim.findings import Finding
from dcone_cosim.phases.capture_report import findings
from dcone_cosim.recorder import Recorder
from dcone_cosim.results import PhaseResult, RunResult
from dcone_cosim.scene.data import Scene


def told(touch: float, volume: bool = True) -> dict[str, Finding]:
    """Figures of a mouth that opens by 3 m2/s and a volume that grows by 5 m3/s, rows every 2 s."""
    time = np.arange(0.0, 9.0, 2.0)
    columns = {"mouth.area": ("m2", "Real", 3.0 * time), "net.volume": ("m3", "Real", 5.0 * time)}
    columns["contact.first_time"] = ("s", "Real", np.where(time > touch, touch, -1.0))
    if not volume:
        del columns["net.volume"]
    result = PhaseResult("capture", 0.0, Recorder.of({"time": ("s", "Real", time), **columns}))
    run = RunResult(scene=Scene("one", "", "", ()))
    return {one.key: one for one in findings(run, result)}


def test_between_two_rows() -> None:
    figures = told(4.6)
    assert figures["mouth.area_at_touch"].value == pytest.approx(13.8)
    assert figures["net.volume_at_touch"].value == pytest.approx(23.0)
    assert (figures["mouth.area_at_touch"].unit, figures["net.volume_at_touch"].unit) == ("m2", "m3")


@pytest.mark.parametrize(
    ("late", "label"), [(0.0, "momentum of the shot"), (0.01, "momentum of the bullets that left at once")]
)
def test_what_the_momentum_is_of(late: float, label: str) -> None:
    """By the chaser's recoil in the first row, which knows of no bullet that leaves later."""
    moves = {
        f"chaser.velocity[{axis}]": ("m/s", "Real", np.array([speed] * 2)) for axis, speed in enumerate((0, 3, 4), 1)
    }
    rows = Recorder.of({"time": ("s", "Real", np.array([0.0, 1.0])), **moves})
    given = {"chaser.mass": 2.0, "ejection.delay[2]": late} | {f"chaser.start_velocity[{i}]": 0.0 for i in (1, 2, 3)}
    run = RunResult(scene=Scene("one", "", "", ()), parameters={"capture": given})
    (figure,) = (one for one in findings(run, PhaseResult("capture", 0.0, rows)) if one.key == "recoil")
    assert (figure.label, figure.value) == (label, 10.0)


@pytest.mark.parametrize(("speed", "told"), [(1e-17, 0.0), (2e-9, 1e-9)])
def test_a_shot_square_to_its_axis_has_no_momentum(speed: float, told: float) -> None:
    """What rounding leaves of the cosine of 90 deg is none; what is more than that is told as it is."""
    moves = {f"chaser.velocity[{axis}]": ("m/s", "Real", np.array([own] * 2)) for axis, own in ((1, 0.0), (3, 0.0))}
    moves["chaser.velocity[2]"] = ("m/s", "Real", np.array([-speed] * 2))
    rows = Recorder.of({"time": ("s", "Real", np.array([0.0, 1.0])), **moves})
    given = {"chaser.mass": 0.5, "bullets.mass": 0.3, "bullets.speed": 3.0}
    given |= {f"chaser.start_velocity[{axis}]": 0.0 for axis in (1, 2, 3)}
    run = RunResult(scene=Scene("one", "", "", ()), parameters={"capture": given})
    (figure,) = (one for one in findings(run, PhaseResult("capture", 0.0, rows)) if one.key == "recoil")
    assert figure.value == told


def test_no_touch_and_no_volume_have_none() -> None:
    assert not {"mouth.area_at_touch", "net.volume_at_touch"} & told(9.0).keys()
    assert "net.volume_at_touch" not in told(4.6, volume=False)
