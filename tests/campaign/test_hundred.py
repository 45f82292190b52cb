"""A hundred campaigns of an FMU whose probability is known by hand, each to its own end by the stopping rule."""

from __future__ import annotations

from concurrent.futures import Executor, Future
from pathlib import Path
from typing import Any

import pytest

from dcone_cosim.campaign.answers import answers
from dcone_cosim.campaign.applied import base_of, inputs_of
from dcone_cosim.campaign.cluster import Cluster
from dcone_cosim.campaign.engine import Engine
from dcone_cosim.campaign.reading import parse
from dcone_cosim.campaign.sampling import monte_carlo
from dcone_cosim.campaign.shots import ground_of
from dcone_cosim.cases.runner import Memory
from dcone_cosim.progress import Progress
from tests.campaign.conftest import DRIFT

TRUTH = 0.9
"""Probability that bodies 10 m apart, drifting at 1 mm/s +- 0.2 mm/s, are within 10.1256 m after 100 s."""


class Here(Executor):
    def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> Future[Any]:
        future: Future[Any] = Future()
        future.set_result(fn(*args))
        return future


@pytest.mark.evidence
def test_the_interval_holds_as_often_as_it_says(drift: Path, capfd: pytest.CaptureFixture[str]) -> None:
    """89 to 99 of 100 times, every case a run of the FMU through the whole of a campaign."""
    held, numbers = 0, set()
    text = DRIFT.replace("n = 60", 'until = "95 % within 5.5 %"').replace(
        "scene = ", 'sampler = "monte-carlo"\nscene = '
    )
    first = parse(text, "campaign", str(drift))
    base = base_of(first)
    inputs = inputs_of(first, base)
    record = ("removal.separation",)
    for seed in range(100):
        spec = parse(text.replace("seed = 5", f"seed = {seed}"), "campaign", str(drift))
        engine = Engine(spec, inputs, ground_of(base, None, record), seed, Memory(), Cluster(Here(), 1, ""), Progress())
        points = (monte_carlo(spec.seed, number, len(inputs.inputs)) for number in range(1, spec.most + 1))
        found = answers(spec, engine.run(points, None), {}).success
        assert found is not None
        assert 0.5 * (found.interval[1] - found.interval[0]) <= 0.055
        held += found.interval[0] <= TRUTH <= found.interval[1]
        numbers.add(found.of)
    with capfd.disabled():
        print(f"held {held} of 100 times; campaigns of {min(numbers)} to {max(numbers)} cases")
    assert 89 <= held <= 99
    assert len(numbers) > 3
