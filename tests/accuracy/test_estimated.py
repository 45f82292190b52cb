"""What is estimated of an accuracy, by runs that are made up and by what is known of them."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from dcone_cosim.accuracy.attain import APART, TOLD, Estimate, Ladder, _Attempt, _ladders, student
from dcone_cosim.accuracy.judge import Sample
from dcone_cosim.accuracy.plan import Planned
from dcone_cosim.accuracy.settings import NUMERICS, Setting
from dcone_cosim.cases.alone import Alone
from dcone_cosim.cases.ensemble import jitter
from dcone_cosim.errors import InputError
from dcone_cosim.loading import load
from dcone_cosim.progress import Progress
from dcone_cosim.quantities import BOUND
from dcone_cosim.scene.data import Accuracy
from fmu_src.tethered_deorbit.trade import FACTORS


def test_a_setting_is_judged_by_one_twice_as_coarse() -> None:
    sizes = (6.0, 4.0, 3.0, 2.0, 1.4, 1.0, 0.7, 0.5, 0.25)
    settings = [Setting(NUMERICS, "leapfrog", size, ()) for size in sizes]
    for place, size in enumerate(sizes):
        partner = Ladder(NUMERICS, settings, place).partner
        assert partner is not None
        ratio = partner.size / size
        assert ratio >= APART or 1.0 / ratio >= APART
        assert (ratio > 1.0) == (size <= 3.0)
    assert Ladder(NUMERICS, settings[:1], 0).partner is None


Truth = Callable[[float, int], float]


class Faked:
    """An attempt whose runs are made up: of a size and a number follows what they find."""

    def __init__(
        self,
        monkeypatch: pytest.MonkeyPatch,
        truth: Truth,
        accuracy: Accuracy,
        phase: tuple[str, str] = ("deployment", "capture"),
        resolution: float = 0.0,
        bound: Callable[[float], float] | None = None,
    ) -> None:
        self.truth, self.made, self.resolution, self.bound = truth, list[float](), resolution, bound
        monkeypatch.setattr(_Attempt, "_run", lambda _, planned, runs: [self.sample(one, runs) for one in planned])
        monkeypatch.setattr(_Attempt, "_parts", lambda _: False)
        self.attempt = _Attempt(Alone(phase[0], [], None), phase[1], accuracy, None, Progress())  # type: ignore[arg-type]

    def sample(self, planned: Planned, runs: int) -> Sample:
        (ladder,) = self.attempt._ladders
        size = next(s.size for s in ladder.settings if s.changes == planned.setting.changes)
        self.made.append(size)
        values = np.array([[self.truth(size, number)] for number in range(runs)])
        values = values[:, : None if math.isfinite(values.max()) else 0]
        about: dict[str, Any] = {"label": "mouth area", "scale": 0.0, "meant": True, "unit": "m2"}
        about["resolution"] = self.resolution
        if self.bound is not None:
            beside = {BOUND: np.array([self.bound(size)])}
            spread = np.zeros(1)
            meant = {"q": about, BOUND: about | {"meant": False}}
            return Sample(
                planned.setting, runs, 1.0, 0.0, {"q": values[0]} | beside, dict.fromkeys(meant, spread), meant
            )
        spread = values.std(axis=0, ddof=1) if runs > 1 else np.zeros(1)
        return Sample(
            planned.setting, runs, 1.0, means={"q": values.mean(axis=0)}, spreads={"q": spread}, about={"q": about}
        )


@pytest.mark.parametrize("power", [1.0, 2.0, 4.0])
def test_it_is_refined_until_it_is_exact_enough(monkeypatch: pytest.MonkeyPatch, power: float) -> None:
    """An error of 3 % at the default step: the setting found has the accuracy asked, and the estimate is no less."""
    faked = Faked(monkeypatch, lambda size, _: 100.0 * (1.0 + 0.03 * size**power), Accuracy(0.01))
    changes, attained = faked.attempt.attained()
    size = faked.made[-2]
    truly = 0.03 * size**power / (1.0 + 0.03 * size**power)
    assert truly <= attained.error * (1.0 + 1e-4) <= 0.01
    assert len(changes) == 1
    assert size < 1.0
    assert attained.runs == 1


TOW = ("table2-deorbit", "removal")


def held_short(size: float, number: int) -> float:
    """Something else holds the steps short until the finest tolerances but one: no error falls before."""
    return 100.0 * (1.0 + (0.003 if size > 0.1 else 0.003 * size))


def test_a_tolerance_that_changes_nothing_is_not_taken_for_one_without_an_error(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A tolerance ten times as loose comes to the same, bit for bit, and both err by 0.3 %."""
    faked = Faked(monkeypatch, held_short, Accuracy(0.01), TOW)
    _, attained = faked.attempt.attained()
    assert set(faked.made) == {faked.made[0], FACTORS[-1]}
    assert 0.003 * (1.0 - FACTORS[-1]) <= attained.error <= 0.0034
    finer = Faked(monkeypatch, held_short, Accuracy(0.002), TOW)
    _, attained = finer.attempt.attained()
    assert finer.made[-2:] == [0.1, FACTORS[-1]]
    assert 0.0003 * 0.9 <= attained.error <= 0.0005


@pytest.mark.parametrize("power", [0.5, 1.0])
def test_what_is_told_of_a_tolerance_is_no_less_than_its_error(monkeypatch: pytest.MonkeyPatch, power: float) -> None:
    """Also at the finest, and where errors fall with the root of a tolerance, as of steps that an error controls."""
    for asked in (1e-3, 1e-5):
        faked = Faked(monkeypatch, lambda size, _: 100.0 * (1.0 + 1e-5 * size**power), Accuracy(asked), TOW)
        _, attained = faked.attempt.attained()
        assert 1e-5 * faked.made[-2] ** power <= attained.error * (1.0 + 1e-4) <= asked


def test_nothing_is_told_below_what_schemes_differ_by(monkeypatch: pytest.MonkeyPatch) -> None:
    faked = Faked(monkeypatch, lambda size, _: 100.0, Accuracy(1e-8), TOW)
    assert faked.attempt.attained()[1].error == TOLD
    refused = Faked(monkeypatch, lambda size, _: 100.0, Accuracy(0.9e-8), TOW)
    with pytest.raises(InputError, match=r"more than any setting can tell\n.*is told to 1e-06 % at best"):
        refused.attempt.attained()


def test_an_instant_is_told_to_the_time_between_two_looks(monkeypatch: pytest.MonkeyPatch) -> None:
    """Every run sees it at the same look: that says nothing of the hundredth of a second before."""
    faked = Faked(monkeypatch, lambda size, _: 0.23, Accuracy(0.05), resolution=0.01)
    assert faked.attempt.attained()[1].error == pytest.approx(0.01 / 0.23)
    refused = Faked(monkeypatch, lambda size, _: 0.23, Accuracy(0.04), resolution=0.01)
    with pytest.raises(InputError, match=r"more than any setting can tell\n.*mouth area is told to 4\.3 % at best"):
        refused.attempt.attained()


def test_a_run_that_lacks_what_a_finer_one_has_is_refined(monkeypatch: pytest.MonkeyPatch) -> None:
    """A tug that only finer tolerances show."""
    faked = Faked(monkeypatch, lambda size, _: math.inf if size > 0.5 else 5.0, Accuracy(0.01), TOW)
    _, attained = faked.attempt.attained()
    assert faked.made[-2] == 0.1
    assert attained.error <= 2.0 * TOLD


def test_the_bound_of_a_level_of_detail_counts(monkeypatch: pytest.MonkeyPatch) -> None:
    """Runs of two bounds may come to the same, and both err by what the level leaves out."""
    asked = Accuracy(1e-3)
    faked = Faked(monkeypatch, lambda size, _: 5.0, asked, TOW, bound=lambda size: 8e-3 * size)
    _, attained = faked.attempt.attained()
    assert faked.made[-2] == 0.1
    assert attained.error == pytest.approx(8e-4, rel=1e-4)


def test_a_level_of_detail_is_compared_with_one_that_errs_less_and_not_with_none() -> None:
    """The last rung is for references: it leaves a level nothing, and would follow years of tow."""
    level = load("table2-deorbit", ['removal.level.detail="averaged"']).phases[0]
    (ladder,) = (one for one in _ladders(level) if one.axis == NUMERICS)
    partner = replace(ladder, place=0).partner
    assert partner is not None
    assert partner.size == FACTORS[-2]
    assert any(change.startswith("removal.level.average_tolerance=0.0") for change in partner.changes)


def test_a_start_that_the_scene_gives_in_place_of_a_separation_is_moved_too() -> None:
    """By up to a micrometre along the line between the bodies, each seed by another way."""
    scene = load("lumped-tether")
    values = scene.phases[0].main.parameters
    start = np.array([values[f"start.relative_position[{axis}]"] for axis in (1, 2, 3)])
    nearer = []
    for seed in (1, 2):
        (change,) = jitter(scene, seed)
        moved = load("lumped-tether", [change]).phases[0].main.parameters
        place = np.array([moved[f"start.relative_position[{axis}]"] for axis in (1, 2, 3)])
        nearer.append(np.linalg.norm(start) - np.linalg.norm(place))
        assert np.linalg.norm(np.cross(place, start)) == pytest.approx(0.0, abs=1e-9)
    assert 0.0 < min(nearer) < max(nearer) < 1e-6


def test_scatter_known_from_few_runs_counts_for_more() -> None:
    """Student's t: of 4 degrees of freedom 2.776, of many 1.96."""
    assert student(4) == pytest.approx(2.776, abs=1e-3)
    assert student(60) == pytest.approx(2.000, abs=1e-3)
    told = Estimate({"q": 0.001}, scatters={"q": 0.01}, made=3)
    assert told.of_mean("q", 1) == pytest.approx(0.001 + 0.02776, abs=1e-5)
    random = np.random.default_rng(4)
    three, one = random.standard_normal((2, 2000, 3)), random.standard_normal(2000)
    scatter = np.sqrt(three.var(axis=2, ddof=1).mean(axis=0))
    beyond = np.mean(np.abs(one) > student(4) * scatter)
    assert beyond == pytest.approx(0.05, abs=0.015)
    assert np.mean(np.abs(one) > 2.0 * scatter) > 0.09


def test_what_no_setting_meets_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    faked = Faked(monkeypatch, lambda size, _: 100.0 * (1.0 + 0.3 * size), Accuracy(0.001))
    with pytest.raises(InputError, match=r"cannot be met\n.*mouth area errs by .* with the finest setting"):
        faked.attempt.attained()


def scattered(size: float, number: int) -> float:
    """Scatter of 3 %, whatever the size."""
    return 100.0 + 3.0 * (-1.0, 0.2, 0.8, -0.9, 1.3, -0.4)[(number + round(size * 8)) % 6]


def test_scatter_is_refused_with_the_runs_that_would_do(monkeypatch: pytest.MonkeyPatch) -> None:
    faked = Faked(monkeypatch, scattered, Accuracy(0.01))
    with pytest.raises(InputError, match=r"more than one run can tell\n.*scatters by .* the mean of about \d+ runs"):
        faked.attempt.attained()


def test_scatter_is_met_by_the_mean_of_as_many_as_are_allowed(monkeypatch: pytest.MonkeyPatch) -> None:
    faked = Faked(monkeypatch, scattered, Accuracy(0.02, runs=200))
    _, attained = faked.attempt.attained()
    assert attained.runs > 4
    label, mean, spread, unit = attained.means["q"]
    assert (label, unit) == ("mouth area", "m2")
    assert abs(mean / 100.0 - 1.0) <= attained.error <= 0.02
    assert 2.0 * spread / mean / math.sqrt(attained.runs) <= attained.error
    assert attained.scatter == pytest.approx(spread / mean, rel=0.5)  # it was told by six runs
    refused = Faked(monkeypatch, scattered, Accuracy(0.02, runs=attained.runs - 1))
    with pytest.raises(InputError, match=f"more than the {attained.runs - 1} runs that solver.runs allows can tell"):
        refused.attempt.attained()
