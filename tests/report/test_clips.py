"""Clips of a tow against its FMU's outputs: lengths do not depend on the frame, directions on a circle are known."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from dcone_cosim.phases import kind_of
from dcone_cosim.phases.tow_clip import clip, orbital_axes
from dcone_cosim.recorder import Recorder
from dcone_cosim.results import PhaseResult
from dcone_cosim.run_reading import read_run


def test_axes_on_a_circle() -> None:
    angle = np.linspace(0.0, 6.0, 7)
    still = np.zeros(7)
    position = 7e6 * np.column_stack([np.cos(angle), np.sin(angle), still])
    velocity = 7e3 * np.column_stack([-np.sin(angle), np.cos(angle), still])
    axes = orbital_axes(position, velocity)
    np.testing.assert_allclose(axes[:, 0], position / 7e6, atol=1e-14)
    np.testing.assert_allclose(axes[:, 1], velocity / 7e3, atol=1e-14)
    np.testing.assert_allclose(axes[:, 2], np.tile([0.0, 0.0, 1.0], (7, 1)), atol=1e-14)


def test_distances_are_those_that_the_fmu_tells(bare: Path) -> None:
    run = read_run(bare)
    result = run.phases["removal"]
    one = kind_of("removal").clip(run, result)
    assert one is not None
    assert one.line_end is not None
    recorder = result.recorder
    assert np.linalg.norm(one.chaser, axis=1) == pytest.approx(recorder["separation"], rel=1e-9)
    assert np.linalg.norm(one.chaser - one.line_end, axis=1) == pytest.approx(recorder["tether.length"], rel=1e-6)
    assert one.chaser[0, 1] < -5.0, "the chaser is behind, along the track"
    assert abs(one.chaser[0, 2]) < 0.1, "and in the plane of the orbit"


def columns(**named: np.ndarray) -> Recorder:
    found = {"time": ("s", "Real", np.arange(3.0))}
    for name, values in named.items():
        for i, column in enumerate(np.atleast_2d(values).T, start=1):
            found[f"{name.replace('_', '.')}[{i}]"] = ("m", "Real", column)
    found["altitude"] = ("m", "Real", np.zeros(3))
    return Recorder.of(found)


def test_a_turning_target_is_seen_from_the_orbital_frame() -> None:
    """A body at rest in space turns backwards as the frame turns; one that turns with the frame stands still, and so
    does what is made fast to it."""
    angle = np.array([0.0, 0.5, 2.0])
    position = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(3)])
    velocity = np.column_stack([-np.sin(angle), np.cos(angle), np.zeros(3)])
    still = np.tile([1.0, 0.0, 0.0, 0.0], (3, 1))
    turning = Rotation.from_rotvec(np.outer(angle, [0.0, 0.0, 1.0])).as_quat(scalar_first=True)
    held = {f"target.attachment[{i}]": value for i, value in zip((1, 2, 3), (0.0, -2.0, 0.0), strict=True)}
    for attitude, wanted in ((still, -angle), (turning, 0.0 * angle)):
        recorder = columns(
            relative_position=np.tile([0.0, 10.0, 0.0], (3, 1)),
            center_position=position,
            center_velocity=velocity,
            target_attitude=attitude,
        )
        one = clip("removal", PhaseResult("removal", 0.0, recorder), "", held, None)
        assert one is not None
        np.testing.assert_allclose(one.chaser, np.tile([0.0, -10.0, 0.0], (3, 1)), atol=1e-12)
        seen = Rotation.from_quat(one.attitude, scalar_first=True)
        np.testing.assert_allclose(seen.as_rotvec()[:, 2], wanted, atol=1e-12)
        np.testing.assert_allclose(one.line_end, seen.apply([0.0, -2.0, 0.0]), atol=1e-12)
