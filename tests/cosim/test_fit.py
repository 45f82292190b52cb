"""Values estimated from tracks: against the textbook's line, by coverage, and from a net whose values are known."""

from __future__ import annotations

import math

import numpy as np
import pytest

from dcone_cosim.errors import InputError
from dcone_cosim.tracks.fitting import Fit, estimate
from fmu_src.instance import Instance
from fmu_src.net_capture.interface import MODEL

TERMS = {"net": "square", "gravity": "uniform", "air": "quadratic", "nodes": "169"}
"""Of the scene breadboard-nylon."""
SHOT = {
    "net.side": 1.5,
    "net.mesh": 0.25,
    "net.mass": 0.03,
    "net.youngs_modulus": 3e9,
    "net.density": 1140.0,
    "net.fold_side": 0.1,
    "bullets.mass": 0.045,
    "bullets.speed": 8.0,
    "bullets.angle": math.radians(35.0),
    "vertex.mass": 0.005,
    "chaser.mass": 1e6,
    "chaser.start_position[2]": -3.0,
    **{f"solver.jitter[{axis}]": 1e-6 for axis in (1, 2, 3)},
}
FREE = ("net.damping_ratio", "air.thread_drag")
TRUE = (0.2, 1.4)
BOUNDS = [(0.0, math.inf)] * 2
T = np.linspace(0.1, 2.0, 40)


def line(values, seed=0):
    return np.array(values[0] * T + values[1])


def fit_line(seed, sigma=0.01):
    measured = line([2.0, 3.0]) + sigma * np.random.default_rng(seed).standard_normal(len(T))
    return estimate(("slope", "offset"), (1.0, 1.0), BOUNDS, measured, line), measured


def test_a_line_has_the_textbooks_values_and_intervals():
    fit, measured = fit_line(1)
    design = np.column_stack([T, np.ones_like(T)])
    solution, left, _, _ = np.linalg.lstsq(design, measured, rcond=None)
    error = np.sqrt(np.diag(left[0] / (len(T) - 2) * np.linalg.inv(design.T @ design)))
    for one, value, own in zip(fit.estimates, solution, error, strict=True):
        assert one.value == pytest.approx(value, rel=1e-4)
        assert 0.5 * (one.high - one.low) == pytest.approx(2.0244 * own, rel=0.02)  # Student, 38 degrees, 95 %
    assert fit.converged


def test_intervals_hold_as_often_as_they_say():
    """Of 200 lines 95 % but for chance (three standard deviations of a count); a tenth of the width would not."""
    held, narrow = 0, 0
    for seed in range(200):
        one = fit_line(seed)[0].estimates[0]
        held += one.low <= 2.0 <= one.high
        narrow += abs(one.value - 2.0) <= 0.05 * (one.high - one.low)
    assert abs(held / 200 - 0.95) < 3.0 * math.sqrt(0.95 * 0.05 / 200)
    assert narrow / 200 < 0.3


def test_what_the_tracks_do_not_tell_is_said():
    measured = line([2.0, 3.0])
    with pytest.raises(InputError, match="the tracks do not tell slope and blind apart"):
        estimate(("slope", "blind"), (1.0, 1.0), BOUNDS, measured, lambda v, seed: v[0] * T)
    with pytest.raises(InputError, match="the tracks do not tell a and b apart"):
        estimate(("a", "b"), (1.0, 1.0), BOUNDS, measured, lambda v, seed: v[0] * v[1] * T)
    with pytest.raises(InputError, match="2 coordinates cannot tell 2 values"):
        estimate(("a", "b"), (1.0, 1.0), BOUNDS, measured[:2], lambda v, seed: v[0] * T[:2] + v[1])


def fly(values, seed, more=()):
    """Bullets and vertex at every hundredth of a second to 0.28 s: until the net is open."""
    net = Instance(MODEL, TERMS, {**SHOT, **dict(zip(FREE, values, strict=True)), **dict(more), "solver.seed": seed})
    net.initialise()
    rows = []
    for _ in range(28):
        net.step(0.01)
        rows.append([net.array("bullet_position").ravel(), net.array("vertex_position")])
    return np.concatenate([np.concatenate(row) for row in rows])


@pytest.fixture(scope="module")
def fits() -> tuple[Fit, Fit]:
    """Of tracks with known values and noise of half a millimetre, by the right model and by one with other bullets."""
    measured = fly(TRUE, 77)
    measured = measured + 0.5e-3 * np.random.default_rng(3).standard_normal(len(measured))

    def heavier(values, seed):
        return fly(values, seed, {"bullets.mass": 0.055})

    right = estimate(FREE, (0.106, 1.1), BOUNDS, measured, fly)
    wrong = estimate(FREE, (0.106, 1.1), BOUNDS, measured, heavier, noise=0.5e-3)
    return right, wrong


def test_known_values_come_back_within_their_intervals(fits):
    """The damping's own interval hangs on the last digits of the library that solves for it, as the motion is chaotic:
    on one processor it leaves out the value it began with, on another it does not. So only its width is judged."""
    fit = fits[0]
    assert fit.after < fit.before
    for one, true in zip(fit.estimates, TRUE, strict=True):
        assert one.low <= true <= one.high, one
    damping, drag = fit.estimates
    assert damping.high < 4.0 * damping.low, "an interval that holds everything tells nothing"
    assert drag.high - drag.low < 0.3 * TRUE[1]
    assert not drag.low <= drag.start <= drag.high, "it would notice the value that it began with"


def test_a_wrong_model_is_noticed(fits):
    """Bullets a fifth too heavy: no drag mends that, and what is left over says so."""
    fit = fits[1]
    assert fit.chi2 > 2.0
    assert any("the model is off" in warning for warning in fit.warnings)
    assert fits[0].chi2 < 2.0
