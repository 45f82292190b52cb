"""Coupled linear components against the exact solution: orders of convergence, and error against tolerance."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from tests.cosim.linear_components import by_force, by_motion, coupled, error_at, run
from tests.validation import Validated, closed_form

END = 8.0
STEPS = (0.05, 0.025, 0.0125, 0.00625)
ORDERS = {"constant": 1.0, "linear": 2.0}
SPLITS = (by_force, by_motion)
METHODS = ("jacobi", "gauss_seidel")


def slope(x: Any, y: Any) -> float:
    return float(np.polyfit(np.log(x), np.log(y), 1)[0])


def errors(make: Callable[..., Any], **coupling: Any) -> list[float]:
    return [error_at(run(coupled(*make(), step=step, **coupling), END, 1.0), END) for step in STEPS]


@pytest.mark.parametrize("make", SPLITS)
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("extrapolation", ORDERS)
def test_order_of_the_coupling_step(
    validated: Validated, make: Callable[..., Any], method: str, extrapolation: str
) -> None:
    found = slope(STEPS, errors(make, method=method, extrapolation=extrapolation))
    what = f"coupled oscillators, inputs {extrapolation}: order of the error"
    validated(closed_form("exact solution by the matrix exponential"), what, found, ORDERS[extrapolation], abs=0.1)


def test_declared_orders_are_not_interchangeable() -> None:
    """Twin: the order of the one is far from that of the other."""
    assert slope(STEPS, errors(by_motion, extrapolation="constant")) < 1.2
    assert slope(STEPS, errors(by_motion, extrapolation="linear")) > 1.8


def test_linear_needs_fmus_that_take_rates() -> None:
    """Inputs of an FMU that takes no derivatives are held: to the last bit as with constant extrapolation."""

    def held() -> Any:
        return by_motion(can_interpolate=False)

    linear, constant = (errors(held, extrapolation=kind) for kind in ("linear", "constant"))
    assert linear == constant
    assert slope(STEPS, linear) == pytest.approx(1.0, abs=0.1)


def test_coupling_steps_that_do_not_divide_the_macro_step() -> None:
    """The last one is shorter, and the order stays."""
    steps = [0.93 * step for step in STEPS]
    for extrapolation, order in ORDERS.items():
        found = [
            error_at(run(coupled(*by_motion(), step=h, extrapolation=extrapolation), END, 1.0), END) for h in steps
        ]
        assert slope(steps, found) == pytest.approx(order, abs=0.1)


def test_gauss_seidel_is_nearer_than_jacobi_here() -> None:
    """And its result depends on who goes first, which Jacobi's does not."""
    jacobi, first, second = (
        errors(by_motion, method=method, order=order)
        for method, order in (("jacobi", ()), ("gauss_seidel", ()), ("gauss_seidel", ("second", "first")))
    )
    assert all(g < j for g, j in zip(first, jacobi, strict=True))
    assert first != second
    assert errors(by_motion, method="jacobi", order=("second", "first")) == jacobi


@pytest.mark.parametrize(("method", "extrapolation"), [("jacobi", "constant"), ("gauss_seidel", "linear")])
def test_error_goes_with_the_tolerance(method: str, extrapolation: str) -> None:
    tolerances = (1e-2, 3e-3, 1e-3) if extrapolation == "constant" else (1e-3, 1e-4, 1e-5)
    runs = [
        run(coupled(*by_force(), method=method, extrapolation=extrapolation, control="error", tolerance=t), END, 1.0)
        for t in tolerances
    ]
    found = [error_at(whole, END) for whole in runs]
    assert slope(tolerances, found) == pytest.approx(1.0, abs=0.1)
    assert all(error < 10.0 * t for error, t in zip(found, tolerances, strict=True))
    steps = [whole.statistics["steps"] for whole in runs]
    order = ORDERS[extrapolation]
    assert slope(tolerances, steps) == pytest.approx(-1.0 / order, abs=0.1)


def test_error_is_not_met_by_a_tolerance_ten_times_looser() -> None:
    """Twin: the bound that the tolerance gives is not so loose that any run would meet it."""
    loose = run(coupled(*by_force(), extrapolation="linear", control="error", tolerance=1e-2), END, 1.0)
    assert error_at(loose, END) > 10.0 * 1e-3


def test_explicit_coupling_of_held_forces_feeds_energy() -> None:
    """A force held over a step acts as if it came half a step late, which a spring turns into negative damping."""
    (first, second), connections = by_force()
    whole = run(coupled([first, second], connections, step=0.05, method="jacobi"), END, 1.0)
    exact_run = run(coupled(*by_force(), step=0.05, method="jacobi", extrapolation="linear"), END, 1.0)
    energy = [
        sum(float(c.state @ c.state) for c in w.components)  # type: ignore[attr-defined]
        for w in (whole, exact_run)
    ]
    assert energy[0] > energy[1]
