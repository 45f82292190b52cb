"""Maps: cases where the outcome changes, the same whoever runs them."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from dcone_cosim.campaign.maps import explore

pytest.importorskip("adaptive")
RADIUS = 0.3


@pytest.mark.parametrize(("size", "share"), [(2, math.pi * RADIUS**2), (3, 4.0 / 3.0 * math.pi * RADIUS**3)])
def test_a_ball(size: int, share: float) -> None:
    asked: list[Any] = []

    def judge(points: Any) -> list[float]:
        asked.extend(points)
        return [float(np.sum((point - 0.5) ** 2) < RADIUS**2) for point in points]

    found = explore(judge, size, 150)
    assert len(asked) == 150
    assert abs(found["share"] - share) < found["unsure"]
    near = sum(abs(math.dist(point, [0.5] * size) - RADIUS) < 0.1 for point in asked)
    shell = math.pi * 4 * 0.1 * RADIUS if size == 2 else 4 / 3 * math.pi * (0.4**3 - 0.2**3)
    assert near / 150 > 1.3 * shell, "more of them than chance would put there"
    again = list(asked)
    asked.clear()
    assert explore(judge, size, 150) == found
    assert np.array_equal(again, asked)
