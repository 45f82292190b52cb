"""The model of a thousand workers, where the answer is known."""

from __future__ import annotations

import json

import pytest

from tests.campaign.evidence.thousand import STORED, Costs, simulated


def test_nothing_to_do_but_cases() -> None:
    """Without costs all workers are busy to the end."""
    found = simulated(Costs(0.0, 0.0, 0.0, 0.0, 0.0), 50, 20_000, 1.6, 1e-9)
    assert found.efficiency == pytest.approx(1.0, abs=1e-6)
    assert found.wall == pytest.approx(20_000 / 50 * 1.6, rel=1e-6)


def test_a_scheduler_that_is_too_slow_is_the_bound() -> None:
    """A task a second, whatever the workers could do."""
    found = simulated(Costs(0.0, 0.0, 1.0, 0.0, 0.0), 100, 500, 1.6, 1e-9)
    assert found.wall == pytest.approx(500.0, rel=0.01)
    assert found.scheduler == pytest.approx(1.0, rel=0.01)


def test_a_client_that_is_too_slow_is_the_bound() -> None:
    found = simulated(Costs(0.5, 0.0, 0.0, 0.0, 0.0), 100, 1000, 1.6, 1e-9)
    assert found.wall == pytest.approx(500.0, rel=0.02)


def test_what_is_stored() -> None:
    """A thousand workers on cases of 1.6 s are busy 95 % of the time, by the measured costs."""
    told = json.loads(STORED.read_text(encoding="utf-8"))
    runs = {run["workers"]: run for run in told["runs"]}
    assert runs[1000]["cases"] == 1_000_000
    assert runs[1000]["efficiency"] > 0.95
    again = simulated(Costs(**told["costs [s]"]), 100, 10_000, told["case [s]"]["mean"], told["case [s]"]["spread"])
    assert again.efficiency == pytest.approx(runs[100]["efficiency"], rel=1e-6)
