"""A reel control beside the removal against the removal with the law inside: the order of coupling on a real model."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from tests.cosim.in_process import KernelComponent
from tests.cosim.reel_pair import CASES, Law, Outcome, pair, whole

pytestmark = pytest.mark.slow
STEPS = (20.0, 10.0, 5.0, 2.5)


def removal(law: str) -> KernelComponent:
    component = KernelComponent("removal", "removal", {"reel": law, "thrust": "along_track"})
    component.set({"thrust.level": 0.0})
    return component


@cache
def reference(case: str) -> Outcome:
    return whole(case, removal)


def slopes(case: str, **coupling: object) -> np.ndarray:
    """Orders of the errors of tension and separation."""
    found = [pair(case, removal, Law, step=step, **coupling).errors(reference(case)) for step in STEPS]
    return np.polyfit(np.log(STEPS), np.log(found), 1)[0]


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("method", ["jacobi", "gauss_seidel"])
def test_held_inputs_converge_with_the_step(case: str, method: str) -> None:
    assert slopes(case, method=method) == pytest.approx(1.0, abs=0.1)


@pytest.mark.parametrize("coupling", [{"method": "jacobi"}, {"order": ("controller", "removal")}])
def test_moving_inputs_converge_with_its_square(coupling: dict[str, object]) -> None:
    assert slopes("taut", extrapolation="linear", **coupling) == pytest.approx(2.0, abs=0.1)


def test_a_law_without_a_state_makes_no_difference_between_the_methods() -> None:
    """At a communication point its output agrees with its inputs, whoever went first: equal to the last bit."""
    one, other = (pair("taut", removal, Law, step=10.0, method=m).rows for m in ("jacobi", "gauss_seidel"))
    assert (one == other).all()


def test_another_gain_does_not_converge() -> None:
    """Twin: a law that differs by 1 % is told from the one inside by the same measure."""

    def stronger() -> Law:
        law = Law()
        law.d *= 1.01
        return law

    coarse, fine = (pair("taut", removal, stronger, step=h).errors(reference("taut")) for h in (2.5, 1.25))
    assert (fine > 0.8 * coarse).all()


def test_controlled_steps_reach_what_is_asked() -> None:
    """Error of the separation, relative to its size and to the number of macro steps."""
    tolerances = (1e-2, 1e-3)
    runs = [pair("taut", removal, Law, control="error", tolerance=t) for t in tolerances]
    errors = [run.errors(reference("taut"))[1] / (15.0 * 30) for run in runs]
    assert all(error < t for error, t in zip(errors, tolerances, strict=True))
    assert errors[1] < 0.3 * errors[0]
