"""A map of the outcome over two or three values, with cases put where it changes, by the package `adaptive`.

Cases are chosen a few at a time, each time by all rows before, so that the map is the same on however many processors.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from dcone_cosim.campaign.engine import Engine
from dcone_cosim.campaign.outcomes import succeeded
from dcone_cosim.campaign.sampling import inside
from dcone_cosim.errors import InputError

BATCH = 8
"""Cases that are chosen at a time."""
Judge = Callable[[Sequence[Any]], Sequence[float]]


def explore(judge: Judge, size: int, count: int) -> dict[str, float]:
    """Put `count` points where `judge` changes.

    judge    1 or 0 for each of some points of the unit cube
    size     2 or 3

    Returns the share of the cube in which it is 1 [1], interpolated, and how much of the cube is between points that
    differ, half of it: the share is known no better than that.

    Checked  tests/campaign/test_maps.py: a disc
    """
    learner = _learner(size)
    done = 0
    while done < count:
        points, _ = learner.ask(min(BATCH, count - done))
        values = judge([inside(np.asarray(point, dtype=float)) for point in points])
        for point, value in zip(points, values, strict=True):
            learner.tell(point, value)
        done += len(points)
    return _area(list(learner.data.items()), size)


def _learner(size: int) -> Any:
    try:
        import adaptive
    except ImportError:
        raise InputError("a map needs the package adaptive; pip install 'dcone-cosim[campaign]'") from None
    return adaptive.LearnerND(None, [(0.0, 1.0)] * size)


def _area(data: Sequence[tuple[Any, float]], size: int) -> dict[str, float]:
    from scipy.spatial import Delaunay

    points = np.array([point for point, _ in data], dtype=float)
    values = np.array([value for _, value in data], dtype=float)
    simplices = Delaunay(points).simplices
    edges = points[simplices[:, 1:]] - points[simplices[:, :1]]
    volumes = np.abs(np.linalg.det(edges)) / (2.0 if size == 2 else 6.0)
    means, mixed = values[simplices].mean(axis=1), np.ptp(values[simplices], axis=1) > 0.0
    return {
        "share": float(np.sum(volumes * means) / np.sum(volumes)),
        "unsure": float(0.5 * np.sum(volumes[mixed]) / np.sum(volumes)),
    }


def run_map(engine: Engine) -> Mapping[str, Any]:
    """Cases where the outcome changes; what was found, for the summary."""
    spec = engine.spec
    assert spec.n is not None
    engine.tally.pace.total = spec.n

    def judge(points: Sequence[Any]) -> list[float]:
        return [float(succeeded(one.row, spec.success) is True) for one in engine.batch(points)]

    return {"map": {"over": engine.inputs.names, **explore(judge, len(engine.inputs.inputs), spec.n)}}


def sentences(told: Mapping[str, Any]) -> list[str]:
    """What was found, in words."""
    return [
        f"success over {100.0 * told['share']:.3g} % of the map of {', '.join(told['over'])}, known to "
        f"{100.0 * told['unsure']:.2g} %: so much lies between cases that differ"
    ]
