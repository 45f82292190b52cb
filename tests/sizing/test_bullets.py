"""Bullets by simulation: heavier ones open the net wider, and the least that is enough lies where the curve says."""

from __future__ import annotations

import pytest

from dcone_cosim.cases.runner import Memory, Runner
from dcone_cosim.cases.workers import Workers
from dcone_cosim.progress import Progress
from dcone_cosim.sizing.bullets import ENOUGH, Opening, flights, least


@pytest.mark.evidence
def test_heavier_bullets_open_the_net_wider() -> None:
    with Workers(1) as workers:
        light, rule = flights(Runner(Memory(), workers, 2), Progress(), (1.0, 6.0))
    assert light.opening < ENOUGH < rule.opening <= 1.02
    assert rule.when < light.when
    assert rule.since == pytest.approx(9.04, rel=0.06), "as the finer net of Table 1 does, damped otherwise"


def test_the_least_that_is_enough() -> None:
    points = [Opening(1.0, 0.7, 1.0, 1.0), Opening(2.0, 0.8, 1.0, 1.0), Opening(4.0, 1.0, 1.0, 1.0)]
    assert least(points) == pytest.approx(3.0)
    assert least(points[:2]) is None
    assert least(points[2:]) == 4.0
