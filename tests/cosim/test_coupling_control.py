"""Controlled coupling steps: rollback, discards, jumps and FMUs that end themselves or lie."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from dcone_cosim.coupling.coupled import Coupled
from dcone_cosim.coupling.exchange import Exchange
from dcone_cosim.coupling.options import Connection, Coupling
from dcone_cosim.coupling.wiring import wire
from dcone_cosim.errors import FmuError, InputError
from dcone_cosim.fmu.component import CallError, Terminated
from tests.cosim.linear_components import LinearComponent, by_force, by_motion, coupled, run
from tests.cosim.mock_components import MockComponent

CONTROLLED: dict[str, Any] = {"control": "error", "tolerance": 1e-3}


def states(whole: Coupled) -> list[bytes]:
    return [c.state.tobytes() for c in whole.components]  # type: ignore[attr-defined]


@pytest.mark.parametrize("extrapolation", ["constant", "linear"])
@pytest.mark.parametrize("method", ["jacobi", "gauss_seidel"])
def test_rollback_leaves_no_trace(method: str, extrapolation: str) -> None:
    """To the last bit the run that takes the accepted half steps alone."""
    whole = coupled(*by_force(), method=method, extrapolation=extrapolation, **CONTROLLED)
    taken: list[tuple[float, float]] = []
    whole._exchange.step = _noting(whole._exchange, taken)  # type: ignore[method-assign]
    run(whole, 3.0, 1.0)
    assert whole.statistics["rejected"] > 0
    accepted = _halves(taken, 3.0)
    assert len(accepted) == whole.statistics["steps"]

    components, connections = by_force()
    again = Exchange(
        components,
        wire("pair", ["first", "second"], components, connections),
        [0, 1],
        method == "gauss_seidel",
        extrapolation == "linear",
    )
    for component in components:
        component.enter_initialisation(0.0)
    again.settle(0.0)
    for component in components:
        component.exit_initialisation()
    for time, size in accepted:
        again.step(time, size)
    assert [c.state.tobytes() for c in components] == states(whole)


def _noting(exchange: Exchange, taken: list[tuple[float, float]]) -> Any:
    take = exchange.step

    def noted(time: float, size: float) -> None:
        taken.append((time, size))
        take(time, size)

    return noted


def _halves(taken: list[tuple[float, float]], end: float) -> list[tuple[float, float]]:
    """The accepted ones of (whole, half, half) triples: those that the next triple goes on from."""
    triples = [taken[i : i + 3] for i in range(0, len(taken), 3)]
    kept = []
    for here, there in zip(triples, [*triples[1:], None], strict=True):
        follows = end if there is None else there[0][0]
        if follows > here[0][0]:
            kept += here[1:]
    return kept


def test_times_land_on_the_communication_points() -> None:
    whole = coupled(*by_motion(), **CONTROLLED)
    for i in range(3):
        whole.step(i * 0.7, 0.7)
        assert all(c.time == pytest.approx((i + 1) * 0.7, rel=1e-15) for c in whole.components)  # type: ignore[attr-defined]


def test_step_size_is_remembered_across_macro_steps() -> None:
    whole = coupled(*by_motion(), **CONTROLLED)
    taken: list[tuple[float, float]] = []
    whole._exchange.step = _noting(whole._exchange, taken)  # type: ignore[method-assign]
    first = []
    for i in range(5):
        first.append(len(taken))
        whole.step(float(i), 1.0)
    tried = [taken[place][1] for place in first]
    assert tried[0] == 1.0
    assert max(tried[1:]) < 0.2
    assert whole.statistics["rejected"] < 0.1 * whole.statistics["steps"]


def test_fmus_without_states_are_named() -> None:
    components, connections = by_force()
    components[1].can_save = False
    with pytest.raises(InputError, match=r'FMU of second cannot save its state; use control = "fixed"'):
        Coupled("pair", components, connections, Coupling(**CONTROLLED))
    Coupled("pair", components, connections, Coupling())


def test_discarded_steps_are_tried_shorter() -> None:
    components, connections = by_motion()
    components[1].longest = 0.02
    whole = run(coupled(components, connections, control="error", tolerance=1.0), 2.0, 1.0)
    assert whole.statistics["discarded"] > 0
    assert whole.statistics["largest"] <= 0.02
    assert np.isclose(components[0].time, 2.0)


@pytest.mark.parametrize("control", ["fixed", "error"])
def test_discarding_for_ever_ends(control: str) -> None:
    components, connections = by_motion()
    components[1].longest = 0.0
    whole = coupled(components, connections, control=control)
    with pytest.raises(CallError, match="second") as caught:
        whole.step(0.0, 1.0)
    assert caught.value.status == "Discard"
    assert components[1].asked < 30
    assert components[0].asked < 30


def test_a_state_that_does_not_restore_is_told() -> None:
    components, connections = by_motion()
    components[1].forgets = True
    whole = coupled(components, connections, **CONTROLLED)
    with pytest.raises(FmuError, match=r"second: its state does not restore: at t = 0 s its output position was "):
        whole.step(0.0, 1.0)


def test_one_that_forgets_later_is_told_too() -> None:
    components, connections = by_motion()
    whole = coupled(components, connections, **CONTROLLED)
    whole.step(0.0, 1.0)
    components[1].forgets = True
    with pytest.raises(FmuError, match=r"second does not restore its state: position was .* at t = 1 s"):
        whole.step(1.0, 1.0)


class Half(LinearComponent):
    """Its output comes back, and what its next step goes by does not: each step taken leaves it a little lower."""

    lost = 0.0

    def step(self, time: float, size: float) -> None:
        super().step(time, size)
        self.lost += 1e-3 * size
        self.state = self.state - self.lost
        self.refresh()


@pytest.mark.parametrize("shown", [True, False])
@pytest.mark.parametrize("tolerance", [1e-6, 10.0])
def test_a_state_that_is_half_restored_is_told(tolerance: float, shown: bool) -> None:
    """Whether another takes its output or not, and however loosely is asked; the FMU is named, not the coupling."""
    sound = LinearComponent("drive", ([[0]], [[1]], [[1]], [[0]]), ["in"], ["rate"], [1.0])
    ends = [Connection("drive", "rate", "sum", "rate")] + [Connection("sum", "total", "drive", "in")] * shown
    matrices = ([[0]], [[1]], [[1]], [[0]])
    liar = Half("sum", matrices, ["rate"], ["total"], [0.0])
    whole = coupled([sound, liar], ends, control="error", tolerance=tolerance)
    with pytest.raises(FmuError, match=r"sum: its state does not restore: the step .* gave its output total") as told:
        whole.step(0.0, 1.0)
    assert 'control = "fixed"' in str(told.value)
    run(coupled([sound, LinearComponent("sum", matrices, ["rate"], ["total"], [0.0])], ends, control="error"), 1.0, 1.0)


def test_the_first_steps_are_tried_to_no_effect() -> None:
    """What is tried to see whether states restore leaves the run as it would be without."""
    ends = []
    for tried in (True, False):
        whole = coupled(*by_motion(), **CONTROLLED)
        whole._steps._restores = not tried  # type: ignore[attr-defined]
        run(whole, 3.0, 1.0)
        ends.append((states(whole), whole.statistics))
    assert ends[0] == ends[1]


def test_steps_of_one_length_are_not_controlled() -> None:
    components, connections = by_force()
    components[1].can_vary_step = False
    told = r'makes steps of different lengths, but the FMU of second takes steps of one length; use control = "fixed"'
    with pytest.raises(InputError, match=told):
        Coupled("pair", components, connections, Coupling(**CONTROLLED))


@pytest.mark.parametrize(("control", "within"), [("fixed", 1e-12), ("error", 1e-6)])
def test_all_stand_together_when_one_ends_itself(control: str, within: float) -> None:
    components, connections = by_motion()
    components[1].ends_at = 1.234
    whole = coupled(components, connections, control=control, step=0.1, tolerance=1e-2)
    whole.step(0.0, 1.0)
    with pytest.raises(Terminated) as caught:
        whole.step(1.0, 1.0)
    times = [c.time for c in components]
    assert times[0] == times[1]
    assert caught.value.time == pytest.approx(times[0], abs=1e-12)
    assert 1.234 - within <= times[0] <= 1.234 + 1e-12


def test_without_states_the_end_is_told_all_the_same() -> None:
    components, connections = by_motion(can_save=False)
    components[1].ends_at = 0.25
    with pytest.raises(Terminated):
        coupled(components, connections, step=0.1).step(0.0, 1.0)


class Switch(MockComponent):
    """Its output jumps from 0 to 1 at an instant: no step meets a tolerance there."""

    def __init__(self, instant: float) -> None:
        super().__init__("switch")
        self.instant = instant
        self.declare(["on"], "output")

    def refresh(self) -> None:
        self.values["on"] = float(self.time >= self.instant)


class Noise(MockComponent):
    """Its output is another one at every time, however near."""

    def __init__(self) -> None:
        super().__init__("noise")
        self.declare(["level"], "output", 1.0)

    def refresh(self) -> None:
        self.values["level"] = 2.0 + math.sin(1e9 * self.time)


def integrator() -> LinearComponent:
    return LinearComponent("sum", ([[0]], [[1]], [[1]], [[0]]), ["rate"], ["total"], [0.0])


@pytest.mark.parametrize("tolerance", [1e-2, 1e-3, 1e-4])
def test_a_jump_is_met_as_the_tolerance_asks(tolerance: float) -> None:
    """What it leaves is the jump over the time it was not known; neither half step would have seen it."""
    total = integrator()
    ends = [Connection("switch", "on", "sum", "rate")]
    whole = coupled([Switch(0.4321), total], ends, method="jacobi", control="error", tolerance=tolerance)
    run(whole, 1.0, 0.5)
    assert total.state[0] == pytest.approx(1.0 - 0.4321, abs=0.5 * tolerance)
    assert whole.statistics["forced"] <= 1
    assert whole.statistics["steps"] < 100
    fixed = integrator()
    run(coupled([Switch(0.4321), fixed], ends, step=0.05, method="jacobi"), 1.0, 0.5)
    assert fixed.state[0] != pytest.approx(1.0 - 0.4321, abs=5e-3)


def test_an_error_that_no_step_meets_is_refused() -> None:
    ends = [Connection("noise", "level", "sum", "rate")]
    whole = coupled([Noise(), integrator()], ends, smallest_step=1e-3, **CONTROLLED)
    with pytest.raises(FmuError, match=r"stays above tolerance = 0\.001 in 100 steps of smallest_step = 0\.001 s"):
        whole.step(0.0, 1.0)
    assert math.isclose(whole.statistics["forced"], 100)
