"""Points of the unit cube by case number: which one a case has hangs on the seed and its number alone.

Not on how many processes there are, nor on which of them came first, nor on how often the work was stopped.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence

import numpy as np
import numpy.typing as npt

from dcone_cosim.campaign.spec import GRID, HYPERCUBE, MONTE_CARLO, SALTELLI, SOBOL, Spec
from dcone_cosim.errors import InputError
from dcone_cosim.scene.mistakes import Mistake, SceneError

Points = npt.NDArray[np.float64]
LEAST = 2.0**-53
"""How near to its ends a coordinate may come: quantiles of many distributions are infinite there."""
BLOCK = 1024
"""Points of a sequence that are made at a time."""


def inside(points: Points) -> Points:
    """The same points with no coordinate at an end of the cube."""
    return np.clip(points, LEAST, 1.0 - LEAST)


def monte_carlo(seed: int, number: int, size: int) -> Points:
    """Point (size,) of one independent case.

    Checked  tests/campaign/test_sampling.py
    """
    return inside(np.random.default_rng([seed, number]).random(size))


def hypercube(seed: int, count: int, size: int) -> Points:
    """Points (count, size) of a Latin hypercube: one in each of `count` equal parts of every coordinate.

    Checked  tests/campaign/test_sampling.py
    """
    from scipy.stats import qmc

    return inside(qmc.LatinHypercube(size, rng=np.random.default_rng([seed, 0])).random(count))


def sobol(seed: int, size: int) -> Iterator[Points]:
    """Points (size,) of a scrambled Sobol sequence, one after the other.

    Checked  tests/campaign/test_sampling.py
    """
    from scipy.stats import qmc

    sequence = qmc.Sobol(size, scramble=True, rng=np.random.default_rng([seed, 0]))
    while True:
        yield from inside(sequence.random(BLOCK))


def saltelli(seed: int, count: int, size: int) -> Iterator[Points]:
    """Points (size,) for Sobol indices: for each row of two independent samples A and B the row of A, those of A with
    one coordinate of B each, and the row of B: `count (size + 2)` in all.

    Source   A. Saltelli et al., Computer Physics Communications 181 (2010) 259, table 2; the order is that of SALib
    Checked  tests/campaign/test_sensitivity.py
    """
    from scipy.stats import qmc

    sequence = qmc.Sobol(2 * size, scramble=True, rng=np.random.default_rng([seed, 0]))
    done = 0
    while done < count:
        for row in inside(sequence.random(min(BLOCK, 2 ** math.ceil(math.log2(count))))):
            if done == count:
                return
            first, second = row[:size], row[size:]
            yield first
            for place in range(size):
                mixed = first.copy()
                mixed[place] = second[place]
                yield mixed
            yield second
            done += 1


def grid(coordinates: Sequence[Sequence[float]]) -> Iterator[Points]:
    """Every coordinate of each input with every other; the last changes first."""
    for row in itertools.product(*coordinates):
        yield inside(np.array(row, dtype=float))


def count_of(spec: Spec, coordinates: Sequence[Sequence[float]]) -> int | None:
    """How many cases there will be; None where the campaign ends by itself."""
    size = len(coordinates)
    if spec.sampler == GRID:
        whole = math.prod(map(len, coordinates))
        return whole if spec.n is None else min(whole, spec.n)
    if spec.until is not None or spec.n is None:
        return None
    return spec.n * (size + 2) if spec.sampler == SALTELLI else spec.n


def points(spec: Spec, coordinates: Sequence[Sequence[float]]) -> Iterator[Points]:
    """Points of the cases of a campaign from the first on, of samplers whose points hang on no row.

    coordinates    of a grid, for each input
    """
    size = len(coordinates)
    if spec.sampler == MONTE_CARLO:
        return (monte_carlo(spec.seed, number, size) for number in itertools.count(1))
    if spec.sampler == SOBOL:
        return sobol(spec.seed, size)
    if spec.sampler == HYPERCUBE:
        assert spec.n is not None
        return iter(hypercube(spec.seed, spec.n, size))
    if spec.sampler == SALTELLI:
        assert spec.n is not None
        return saltelli(spec.seed, spec.n, size)
    if spec.sampler == GRID:
        return grid(coordinates)
    raise AssertionError(spec.sampler)


def check_grid(spec: Spec, names: Sequence[str], coordinates: Sequence[Sequence[float]]) -> None:
    """`SceneError` for a dispersion that tells no values of a grid."""
    if spec.sampler != GRID:
        return
    if spec.jitter:
        raise SceneError([Mistake(("jitter",), True, "a grid has no jitter; leave it out")], spec.places)
    wrong = [
        Mistake((*one.path, "points"), None, "expected how many values the grid has of it")
        for one in spec.dispersions
        if not one.values and not one.points
    ]
    if wrong:
        raise SceneError(wrong, spec.places)
    if math.prod(map(len, coordinates)) > spec.most:
        raise InputError(f"{spec.source}: a grid of {math.prod(map(len, coordinates)):,} cases; at most {spec.most:,}")
