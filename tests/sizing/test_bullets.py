"""Bullets by simulation: heavier ones open the net wider, and the least that is enough lies where the curve says."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest

from dcone_cosim.cases.case import Case
from dcone_cosim.cases.rows import Row
from dcone_cosim.cases.runner import Memory, Runner
from dcone_cosim.cases.workers import Workers
from dcone_cosim.progress import Progress
from dcone_cosim.scene.data import Scene
from dcone_cosim.sizing import bullets
from dcone_cosim.sizing.bullets import ENOUGH, Opening, flights, least


@pytest.mark.evidence
def test_heavier_bullets_open_the_net_wider() -> None:
    with Workers(1) as workers:
        light, rule = flights(Runner(Memory(), workers, 2), Progress(), (1.0, 6.0))
    assert light.opening < ENOUGH < rule.opening <= 1.02
    assert rule.when < light.when
    assert rule.since == pytest.approx(9.04, rel=0.06), "as the finer net of Table 1 does, damped otherwise"


class Flown:
    """A runner of which every net opens to 288 m2: half of 24 x 24 m."""

    def __init__(self) -> None:
        self.cases: list[Case] = []

    def rows(self, cases: list[Case]) -> Iterator[tuple[Row, bool]]:
        self.cases = cases
        for case in cases:
            yield Row(case.key, "completed", figures={"capture.mouth.area_max": 288.0}), False


class Known:
    """What FMUs are, of which none is built."""

    def __init__(self, progress: Progress) -> None:
        pass

    def of(self, scene: Scene) -> dict[str, str]:
        return {}


def test_a_flight_has_four_bullets_of_its_ratio(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bullets, "Fmus", Known)
    runner: Any = Flown()
    one, six = flights(runner, Progress(), (1.0, 6.0))
    for case, ratio in zip(runner.cases, (1.0, 6.0), strict=True):
        (capture,) = case.scene.phases
        bullet, net = capture.setting("bullets.mass"), capture.setting("net.mass")
        assert 4.0 * bullet == pytest.approx(ratio * net, rel=1e-8)
    assert (one.ratio, six.ratio) == (1.0, 6.0)
    assert one.opening == pytest.approx(0.5), "of the net's area"


def test_the_least_that_is_enough() -> None:
    points = [Opening(1.0, 0.7, 1.0, 1.0), Opening(2.0, 0.8, 1.0, 1.0), Opening(4.0, 1.2, 1.0, 1.0)]
    assert least(points) == pytest.approx(2.5), "a quarter of the way from 0.8 to 1.2"
    assert least(points[:2]) is None
    assert least([Opening(1.0, 0.7, 1.0, 1.0), Opening(2.0, 0.95, 1.0, 1.0)]) == pytest.approx(1.8)
    assert least([Opening(1.0, 0.95, 1.0, 1.0), Opening(2.0, 0.8, 1.0, 1.0)]) == 1.0, "the first is enough"
    assert least(points[2:]) == 4.0
