"""Which intervals are told: those that hold what they say, with the sampler that made the cases."""

from __future__ import annotations

import io
import math
from collections.abc import Callable
from itertools import islice

import numpy as np
import numpy.typing as npt
import pytest
from rich.console import Console

from dcone_cosim.campaign import intervals, show
from dcone_cosim.campaign.answers import answers
from dcone_cosim.campaign.engine import Made, Tally
from dcone_cosim.campaign.sampling import hypercube, monte_carlo, sobol
from dcone_cosim.cases.rows import Row, refused
from dcone_cosim.cases.statistics import share
from tests.campaign.conftest import spec_of

TIMES = 400
Points = npt.NDArray[np.float64]
BOUND = (
    'success = { figure = "removal.peak", below = "2 N" }\n'
    '[[dispersion]]\nkey = "removal.thrust.level"\ndistribution = "normal"\ndeviation = "5 %"\n'
)
SAMPLERS = ("monte-carlo", "latin-hypercube", "sobol")


def held(points: Callable[[int], Points], good: Callable[[Points], Points], p: float) -> float:
    """How often Wilson's 95 % interval holds the probability, over many seeds."""
    found = [share(int(np.count_nonzero(verdicts)), len(verdicts)) for verdicts in map(good, map(points, range(TIMES)))]
    return sum(one.interval[0] <= p <= one.interval[1] for one in found) / TIMES


def parity(points: Points) -> Points:
    """Success where an even number of four values are above their medians: none of them alone tells anything."""
    return np.asarray((points[:, (0, 2, 3, 4)] > 0.5).sum(axis=1) % 2 == 0)


@pytest.mark.parametrize(
    ("good", "p"),
    [(lambda x: x[:, 0] < 0.7, 0.7), (lambda x: x[:, 0] * x[:, 1] < 0.05, 0.05 - 0.05 * math.log(0.05)), (parity, 0.5)],
    ids=["one value", "a corner", "parity"],
)
def test_of_a_hypercube_it_holds(good: Callable[[Points], Points], p: float) -> None:
    """Four standard deviations of what independent cases give, 95 %: also where evenness is of no use at all."""
    assert held(lambda seed: hypercube(seed, 64, 5), good, p) > 0.95 - 4.0 * math.sqrt(0.05 * 0.95 / TIMES)


def test_of_a_sequence_it_can_be_far_too_narrow() -> None:
    """Why none is told: of 16 points of a Sobol sequence all succeed there, or none, while half of all cases do."""

    def independent(seed: int) -> Points:
        return np.array([monte_carlo(seed, number, 5) for number in range(1, 17)])

    assert held(lambda seed: np.array(list(islice(sobol(seed, 5), 16))), parity, 0.5) < 0.05
    assert held(lambda seed: hypercube(seed, 16, 5), parity, 0.5) > 0.85
    assert held(independent, parity, 0.5) > 0.9


def rows(count: int, lacking: int = 0) -> list[Made]:
    return [
        Made(n, (0.0,), Row(str(n), "completed", 0, "", {"removal.peak": float(n % 4)} if n > lacking else {}))
        for n in range(1, count + 1)
    ]


@pytest.mark.parametrize("sampler", SAMPLERS)
def test_what_is_told(sampler: str) -> None:
    spec = spec_of(f'sampler = "{sampler}"\n' + BOUND)
    found = answers(spec, rows(60), {})
    told, bounded = next(show.sentences(spec, found)), sampler != "sobol"
    assert found.success is not None
    assert found.success.share == 0.5
    assert math.isnan(found.success.interval[0]) is not bounded
    limits = " (0.3774 to 0.6226), " if bounded else ", "
    assert told.startswith(f"removal.peak below 2 N: 30 of 60 cases, probability 0.5{limits}")
    assert ("95 % interval of Wilson" in told) is bounded
    assert ("as of independent cases" in told) is (sampler == "latin-hypercube")
    assert ("no interval: cases of a Sobol sequence are not independent" in told) is not bounded
    content = show.as_dict(spec, found)
    median = content["figures"]["removal.peak"]["percentiles"]["50"]
    intervals_told = [content["probability"]["interval"], median["interval"]]
    assert all((None in one) is not bounded for one in intervals_told)
    assert all((None in one["interval"]) is not bounded for one in content["outcomes"].values())
    tally = Tally(spec, 60)
    for one in rows(60):
        tally.count(one.row, False)
    assert tally.told().endswith("; 0.5 (0.3774 to 0.6226)" if bounded else "; 0.5")


def test_no_interval_of_what_is_no_sample() -> None:
    """Nor while it runs: shares of a grid's cases are no probabilities."""
    spec = spec_of('sampler = "grid"\n' + BOUND)
    tally = Tally(spec, 60)
    tally.count(rows(1)[0].row, False)
    assert tally.told().endswith("1 completed")


def test_no_case_has_the_figure() -> None:
    spec = spec_of(BOUND)
    told = next(show.sentences(spec, answers(spec, rows(6, 6), {})))
    assert told == "removal.peak below 2 N: none of 6 cases has removal.peak: no probability follows"


def test_cases_that_lack_the_figure_are_told() -> None:
    """Where no tug came, none is below a bound, and none above it: the share of the others is no probability of all."""
    spec = spec_of(BOUND)
    told = list(show.sentences(spec, answers(spec, [*rows(60, 2), Made(61, (0.0,), refused("61", "no"))], {})))
    assert told[0].startswith("removal.peak below 2 N: 29 of 58 cases, probability 0.5 ")
    assert told[2:] == [
        "no answer from 1 of 61 cases: 1 refused",
        "2 of 61 cases do not have removal.peak: neither success nor failure",
        "had all of them failed, the share were 0.4754, had all succeeded 0.5246",
    ]
    assert len(list(show.sentences(spec, answers(spec, rows(60), {})))) == 2


@pytest.mark.parametrize(("lacking", "told"), [(0, " 60 "), (2, " 58 of 60 ")])
def test_a_table_says_of_how_many_cases(lacking: int, told: str) -> None:
    spec = spec_of(BOUND)
    content = show.as_dict(spec, answers(spec, rows(60, lacking), {}))
    out = io.StringIO()
    show.show("t", [], content["figures"], Console(file=out, width=160))
    head, line = out.getvalue().splitlines()[1:3]
    assert "cases" in head
    assert line.startswith("removal.peak")
    assert told in line
    assert intervals.told(spec) == "95 % interval of Wilson"


def test_a_table_has_no_figure_that_differs_by_rounding() -> None:
    figures = {"a.same": (3.0, 3.0 + 4e-16), "a.differs": (3.0, 3.0001)}
    made = [Made(n, (0.0,), Row(str(n), "completed", 0, "", {k: v[n] for k, v in figures.items()})) for n in (0, 1)]
    content, out = show.as_dict(spec_of(BOUND), answers(spec_of(BOUND), made, {})), io.StringIO()
    show.show("t", [], content["figures"], Console(file=out, width=160))
    assert ("a.same" in out.getvalue(), "a.differs" in out.getvalue()) == (False, True)


@pytest.mark.parametrize("width", [80, 160])
def test_a_table_loses_no_digit(width: int) -> None:
    made = [Made(n, (0.0,), Row(str(n), "completed", 0, "", {"removal.peak": 1.2345e-5 * n})) for n in range(1, 9)]
    content = show.as_dict(spec_of(BOUND), answers(spec_of(BOUND), made, {}))
    out = io.StringIO()
    show.show("t", [], content["figures"], Console(file=out, width=width))
    told = out.getvalue().split()
    assert told[told.index("removal.peak") + 1 :] == (
        ["8", "5.555e-05", "3.024e-05", "1.667e-05", "5.555e-05", "9.444e-05", "9.79e-05"]
    )
