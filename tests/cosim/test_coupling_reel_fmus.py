"""Both FMUs of the reel control, coupled by the master, against the one FMU with the law inside.

What `test_coupling_reel.py` shows of the kernels and a stand-in for the law, here with what a user has.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import ExitStack

import numpy as np
import pytest

from dcone_cosim import build
from dcone_cosim.fmu.component import Archive, Component
from dcone_cosim.loading import load
from tests.cosim.reel_pair import DURATION, FEED_FORWARD, LENGTH, MACRO_STEP, PROPORTIONAL, Outcome, pair, whole

pytestmark = pytest.mark.slow
CASE = "taut"
STEPS = (20.0, 10.0, 5.0)
SPAN = 15.0
"""Largest separation of the case [m]."""
LINEAR = {"extrapolation": "linear", "order": ("controller", "removal")}

Pair = Callable[..., np.ndarray]


@pytest.fixture(scope="module")
def archives() -> Iterator[dict[str, Archive]]:
    """The FMUs of the shipped scene, without the motor, and the removal with the law inside."""
    (phase,) = load("reel-control").phases
    wanted = {
        "commanded": ("tethered_deorbit", phase.main.terms),
        "linear": ("tethered_deorbit", {**phase.main.terms, "reel": "linear"}),
        "controller": ("reel_control", {}),
    }
    paths = build.ensure(list(wanted.values()), print)
    with ExitStack() as stack:
        yield {name: stack.enter_context(Archive(path)) for name, path in zip(wanted, paths, strict=True)}


@pytest.fixture(scope="module")
def errors(archives: dict[str, Archive]) -> Pair:
    """`errors(gain, **coupling)`: largest differences of tension [N] and separation [m] from the law inside."""

    def removal(law: str) -> Component:
        return Component(archives[law], "removal")

    inside: Outcome = whole(CASE, removal)
    assert inside.rows[:, 1].max() < SPAN

    def run(gain: float = 1.0, **coupling: object) -> np.ndarray:
        def controller() -> Component:
            made = Component(archives["controller"], "controller")
            made.set({"reel.length": LENGTH, "feed_forward": FEED_FORWARD, "gain.proportional": gain * PROPORTIONAL})
            return made

        return pair(CASE, removal, controller, **coupling).errors(inside)

    return run


@pytest.mark.parametrize(
    ("coupling", "order"),
    [({"method": "jacobi"}, 1.0), ({"method": "gauss_seidel"}, 1.0), (LINEAR, 2.0)],
    ids=["jacobi", "gauss_seidel", "linear"],
)
def test_the_pair_comes_to_the_law_inside(errors: Pair, coupling: dict[str, object], order: float) -> None:
    """Order in the coupling step of the errors of tension and separation."""
    found = np.array([errors(step=step, **coupling) for step in STEPS])
    assert np.polyfit(np.log(STEPS), np.log(found), 1)[0] == pytest.approx(order, abs=0.1)


def test_another_gain_does_not(errors: Pair) -> None:
    """Twin: a law with a gain 1 % off comes to another motion, by the same measure."""
    found = np.array([errors(1.01, step=step, **LINEAR) for step in STEPS])
    slopes = np.polyfit(np.log(STEPS), np.log(found), 1)[0]
    assert not (abs(slopes - 2.0) < 0.1).any()
    assert (found[-1] > 3.0 * errors(step=STEPS[-1], **LINEAR)).all()


@pytest.mark.parametrize(
    ("coupling", "tolerance"),
    [({}, 1e-2), ({}, 1e-3), (LINEAR, 1e-3), (LINEAR, 1e-5)],
    ids=["held, 1e-2", "held, 1e-3", "linear, 1e-3", "linear, 1e-5"],
)
def test_controlled_steps_reach_what_is_asked(errors: Pair, coupling: dict[str, object], tolerance: float) -> None:
    """Error of the separation, relative to its size and to the number of macro steps."""
    assert errors(control="error", tolerance=tolerance, **coupling)[1] < allowed(tolerance)


def test_with_another_gain_they_do_not(errors: Pair) -> None:
    """Twin: at the finest tolerance above, a gain 1 % off shows."""
    assert errors(1.01, control="error", tolerance=1e-5, **LINEAR)[1] > allowed(1e-5)


def allowed(tolerance: float) -> float:
    """What the separation may be off [m]."""
    return tolerance * SPAN * DURATION / MACRO_STEP
