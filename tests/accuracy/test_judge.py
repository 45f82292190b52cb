"""Errors, floors, orders and the choice, on runs whose errors are known since they were put in."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from dcone_cosim.accuracy.judge import Report, better_peers, cheapest, front, judge, own
from dcone_cosim.accuracy.plan import DEAR, Effort, PhasePlan, Planned, Planner, plan
from dcone_cosim.accuracy.settings import MACRO_STEP, NUMERICS, Setting
from dcone_cosim.accuracy.show import sentences
from dcone_cosim.accuracy.work import CPU, STEPS, Measured
from dcone_cosim.cases.alone import Alone
from dcone_cosim.cases.rows import Row
from dcone_cosim.progress import Progress

SIZES = (4.0, 2.0, 1.0, 0.5, 0.25, 0.125, 0.0625)
TRUE = np.array([3.0, 5.0, 11.0])


def told(values: Any, scale: float = 0.0, meant: bool = True) -> dict[str, Any]:
    about = {"key": "q", "label": "a quantity", "unit": "m", "relative_to": "itself"}
    return {**about, "values": list(map(float, values)), "scale": scale, "meant": meant}


class Made:
    """A plan and its rows, put together setting by setting."""

    def __init__(self, chaotic: bool = False) -> None:
        self.settings: list[Planned] = []
        self.rows: dict[str, Row] = {}
        self.chaotic = chaotic

    def add(
        self, family: str, size: float, values: Iterator[Any] | list[Any], cpu: float, axis: str = NUMERICS, **of: Any
    ) -> Planned:
        planned = Planned(Setting(axis, family, size, (f"{family}={size}",)))
        for number, value in enumerate(values):
            key = f"{axis} {family} {size} {number}"
            samples = {} if value is None else {"q": told(value, **of)}
            status, code = ("completed", 0) if samples else ("FMU failed", 5)
            self.rows[key] = Row(
                key, status, code, "" if samples else "it fell over", timings={CPU: cpu, STEPS: 0.0}, samples=samples
            )
            planned.keys.append(key)
        self.settings.append(planned)
        return planned

    def judged(self, base: Planned) -> Report:
        return judge(PhasePlan("tow", "A tow", self.chaotic, base, self.settings, [], []), self.rows)


def ladder(made: Made, family: str, order: float, size_of_error: float, cost: float) -> list[Planned]:
    """Settings whose relative error is known: size_of_error * size^order."""
    return [made.add(family, size, [TRUE * (1.0 + size_of_error * size**order)], cost / size) for size in SIZES]


@pytest.mark.parametrize("order", [1.0, 2.0, 4.0])
def test_error_and_order_are_those_put_in(order: float) -> None:
    made = Made()
    ladder(made, "plain", order, 1e-4, 1.0)
    other = made.add("other", 0.1, [TRUE], 9.0)
    report = made.judged(made.settings[2])
    axis = report.numerics
    finest = 1e-4 * SIZES[-1] ** order
    for point in axis.points[: len(SIZES)]:
        expected = abs(1e-4 * point.setting.size**order - finest) / (1.0 + finest)
        assert point.worst == pytest.approx(expected, rel=1e-9, abs=1e-15)
    assert axis.reference == made.settings[len(SIZES) - 1].setting
    assert axis.second == other.setting
    assert axis.agreement == pytest.approx(finest, rel=1e-5)  # the reference's own error, told by the other scheme
    # taken from the reference, not from the truth: a little steeper
    assert order - 0.01 < axis.orders["plain"] < order + 0.1
    assert report.here == pytest.approx(1e-4 - finest, rel=1e-3)


def test_a_wrong_order_shows() -> None:
    """The twin: errors that fall with the first power are not told as the second."""
    made = Made()
    ladder(made, "plain", 1.0, 1e-4, 1.0)
    made.add("other", 0.1, [TRUE], 9.0)
    assert made.judged(made.settings[2]).numerics.orders["plain"] < 1.2


def test_without_another_scheme_the_next_finer_setting_judges() -> None:
    made = Made()
    ladder(made, "plain", 2.0, 1e-4, 1.0)
    axis = made.judged(made.settings[0]).numerics
    assert axis.second == made.settings[-2].setting
    # at least of order 1: the reference is off by no more than the difference of the two
    assert axis.agreement == pytest.approx(1e-4 * (SIZES[-2] ** 2 - SIZES[-1] ** 2), rel=1e-3)
    assert axis.agreement > 1e-4 * SIZES[-1] ** 2  # and its true error is no larger


def test_the_scatter_of_runs_is_a_floor() -> None:
    """Runs that differ by a known standard deviation: their mean is told to twice its standard error."""
    made, random = Made(chaotic=True), np.random.default_rng(3)
    few = [[100.0 + d] for d in random.standard_normal(16)]
    many = [[100.0 + d] for d in random.standard_normal(32)]
    one = made.add("plain", 1.0, few, 1.0)
    made.add("plain", 0.5, many, 2.0)
    report = made.judged(one)
    here = report.numerics.here
    assert 2.0 * math.sqrt(1 / 16 + 1 / 32) / 100.0 == pytest.approx(here.floor, rel=0.3)
    assert report.numerics.scatter[0] == pytest.approx(0.01, rel=0.3)
    lines = "\n".join(sentences(report))
    assert "nothing tried is known to be within 0.1 %" in lines
    assert "One run scatters by" in lines


def test_runs_that_come_to_the_same_from_every_start_differ_by_nothing() -> None:
    """As of a net in other macro steps: that twice as many starts of the reference scatter says nothing of it."""
    made = Made(chaotic=True)
    starts = [[100.0 + 3.0 * d] for d in np.random.default_rng(5).standard_normal(12)]
    made.add("plain", 1.0, starts[:6], 1.0)
    made.add("plain", 0.5, starts, 1.0)
    other = made.add("plain", 2.0, [*starts[:5], [starts[5][0] + 1e-9]], 1.0)
    axis = made.judged(other).numerics
    by_size = {point.setting.size: point for point in axis.points}
    assert (by_size[1.0].worst, by_size[1.0].floor) == (0.0, 0.0)
    assert axis.agreement == 0.0
    assert by_size[2.0].floor > 0.01
    assert by_size[2.0].worst > 1e-3


def test_an_error_is_relative_to_what_it_says() -> None:
    made = Made()
    one = made.add("plain", 1.0, [[1.0, 0.0, 7.0]], 1.0, scale=20.0)
    made.add("plain", 0.5, [[1.0, 0.5, 7.0]], 2.0, scale=20.0)
    assert made.judged(one).numerics.here.errors["q"] == pytest.approx(0.5 / 20.0)


def test_what_is_missing_differs() -> None:
    """A tow with a tug less, and one that failed, are not compared number by number."""
    made = Made()
    short = made.add("plain", 2.0, [[1.0, 2.0]], 1.0)
    made.add("plain", 1.0, [None], 1.0)
    made.add("plain", 0.5, [[1.0, 2.0, 3.0]], 2.0)
    made.add("plain", 0.25, [[1.0, 2.0, 3.0]], 3.0)
    report = made.judged(short)
    assert math.isinf(report.numerics.here.worst)
    assert report.numerics.points[1].sample.failed == "it fell over"
    assert math.isinf(report.numerics.points[1].worst)
    assert cheapest(report.numerics.points, 0.01).setting.size == 0.5  # type: ignore[union-attr]


def test_a_reference_that_nothing_confirms_confirms_nothing() -> None:
    made = Made()
    one = made.add("plain", 1.0, [[1.0, 2.0, 3.0]], 1.0)
    made.add("plain", 0.5, [[1.0, 2.0, 3.0]], 2.0)
    made.add("other", 0.5, [[1.0, 2.0]], 2.0)
    report = made.judged(one)
    assert math.isinf(report.here)
    assert cheapest(report.numerics.points, 0.5) is None


def test_the_front_and_the_cheapest() -> None:
    made = Made()
    ladder(made, "plain", 2.0, 1e-3, 1.0)
    ladder(made, "slow", 2.0, -1e-3, 3.0)  # as exact at three times the cost
    made.add("other", 0.05, [TRUE], 99.0)
    points = made.judged(made.settings[2]).numerics.points
    best = front(points)
    assert {p.setting.family for p in best} == {"plain"}
    assert [p.setting.size for p in best][:4] == [4.0, 2.0, 1.0, 0.5]
    chosen = cheapest(points, 0.005)
    assert chosen is not None
    assert (chosen.setting.family, chosen.setting.size) == ("plain", 2.0)  # 0.4 %; at 4 it would be 1.6 %
    assert cheapest(points, 1e-9) is None


def test_costs_that_noise_alone_tells_apart_are_one() -> None:
    made = Made()
    made.add("plain", 2.0, [TRUE * 1.003], 1.00)
    made.add("plain", 1.0, [TRUE * 1.001], 1.02)
    made.add("plain", 0.5, [TRUE], 2.0)
    made.add("other", 0.5, [TRUE], 8.0)
    points = made.judged(made.settings[0]).numerics.points
    assert cheapest(points, 0.01).setting.size == 1.0  # type: ignore[union-attr]
    assert 2.0 not in [p.setting.size for p in front(points)]


def test_errors_of_all_axes_add_up() -> None:
    made = Made()
    base = made.add("plain", 1.0, [TRUE * 1.001], 1.0)
    made.add("plain", 0.5, [TRUE], 2.0)
    made.add("other", 0.5, [TRUE], 2.0)
    made.add(MACRO_STEP, 1.0, [TRUE * 1.001], 1.0, MACRO_STEP)
    made.add(MACRO_STEP, 0.5, [TRUE * 1.003], 1.0, MACRO_STEP)
    report = made.judged(base)
    steps = report.axes[1].here
    assert steps.worst == pytest.approx(0.002 / 1.003, rel=1e-6)
    assert report.here == pytest.approx(0.001 + steps.bound, rel=1e-6)


def test_nothing_that_ran_is_told_as_such() -> None:
    made = Made()
    one = made.add("plain", 1.0, [None], 1.0)
    made.add("plain", 0.5, [None], 1.0)
    report = made.judged(one)
    assert report.axes == []
    assert list(sentences(report)) == ["tow: no setting came to an end: it fell over"]


@pytest.mark.parametrize(
    ("off", "cost", "wins"),
    [(1e-3, 0.5, True), (1e-3, 0.96, False), (4e-3, 0.9, False), (4e-3, 0.05, True), (0.3, 1e-6, False)],
)
def test_another_program_is_better_where_none_of_ours_is_as_cheap_and_as_exact(
    off: float, cost: float, wins: bool
) -> None:
    """Ours errs by 0.4 % in a quarter of a second and by 0.1 % in one; times within a twentieth are one."""
    made = Made()
    ladder(made, "plain", 1.0, 1e-3, 1.0)
    made.add("other", 0.25, [TRUE * (1.0 + 2.5e-4)], 99.0)
    peer = made.add("peer", 1.0, [TRUE * (1.0 + off)], cost)
    peer.setting = replace(peer.setting, peer=True)
    points = made.judged(made.settings[2]).numerics.points
    assert ([p.setting.family for p in better_peers(points)] == ["peer"]) is wins


def test_a_level_of_detail_judges_no_scheme() -> None:
    """However near it comes: at its finest it is the same scheme."""
    made = Made()
    ladder(made, "plain", 2.0, 1e-3, 1.0)
    level = made.add("plain, level", 0.05, [TRUE], 0.001)
    level.setting = replace(level.setting, detail=True)
    made.add("other", 0.05, [TRUE * (1.0 + 1e-4)], 99.0)
    axis = made.judged(made.settings[2]).numerics
    assert axis.second is not None
    assert axis.second.family == "other"
    assert cheapest(axis.points, 0.005).setting.family == "plain, level"  # type: ignore[union-attr]


def test_what_shows_the_shape_alone_judges_nothing() -> None:
    """However well it agrees, and however fine it is; nor does what is rounded to 24 bits."""
    made = Made()
    ladder(made, "plain", 2.0, 1e-3, 1.0)
    for family, of in (("shape", {"partial": True}), ("plain, single", {})):
        other = made.add(family, 0.01, [TRUE * (1.0 + 1e-3 * SIZES[-1] ** 2)], 0.001)
        other.setting = replace(other.setting, **of)
    made.add("other", 0.05, [TRUE * (1.0 + 1e-4)], 99.0)
    axis = made.judged(made.settings[2]).numerics
    assert axis.second is not None
    assert axis.second.family == "other"


def test_the_runs_that_tell_most_go_to_the_reference_and_to_what_judges_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a chaotic net twice as many, and not of the finest setting of any family."""
    counted: dict[Setting, int] = {}

    def cases(_: Planner, planned: Planned, count: int) -> dict[str, Measured]:
        counted[planned.setting] = count
        planned.keys.append("one")
        return {}

    monkeypatch.setattr(Planner, "cases", cases)
    made = plan(Alone("deployment", [], None), "capture", Effort(runs=5), Progress())
    twice = {f"{s.family} x {s.size:g}" for s, count in counted.items() if count == 10}
    own = {"leapfrog, double x 0.25", "rk4, double x 0.25", "ros2, double x 0.25"}
    assert twice == own | {"macro step x 0.2", "macro step x 0.5", "pieces of a thread x 0.5", "pieces of a thread x 1"}
    assert {count for count in counted.values()} == {5, 10}
    assert any(p.setting.partial and p.setting.size < 0.25 for p in made.settings)


def test_what_is_dear_is_not_repeated_for_its_cost() -> None:
    """Of what scatters every run is a sample, and stays."""
    settings = [Planned(Setting(NUMERICS, "plain", size, ()), [f"{size} {i}" for i in range(3)]) for size in (1.0, 0.1)]
    base = Planned(Setting("", "", 1.0, ()), ["base 0", "base 1"])
    rows = {
        one.keys[0]: Row(one.keys[0], "completed", 0, "", timings={CPU: cpu}, samples={})
        for one, cpu in zip((base, *settings), (3.0, 3.0, DEAR + 1.0), strict=True)
    }
    every = [key for one in (base, *settings) for key in one.keys]
    cases: Any = [SimpleNamespace(key=key) for key in every]
    chaotic = PhasePlan("tow", "A tow", True, base, settings, list(cases), [])
    chaotic.drop_dear(rows)
    assert [case.key for case in chaotic.cases] == [case.key for case in chaotic.first] == every
    once = PhasePlan("tow", "A tow", False, base, settings, list(cases), [])
    assert [case.key for case in once.first] == ["base 0", "1.0 0", "0.1 0"]
    once.drop_dear(rows)
    assert [case.key for case in once.cases] == every[:6]
    assert settings[1].keys == ["0.1 0"]


def test_what_shows_the_shape_alone_is_never_advised() -> None:
    made = Made()
    ladder(made, "plain", 2.0, 1e-3, 1.0)
    cheap = made.add("shape", 1.0, [TRUE], 0.001)
    cheap.setting = replace(cheap.setting, partial=True)
    made.add("other", 0.05, [TRUE], 99.0)
    points = own(made.judged(made.settings[2]).numerics.points)
    assert "shape" not in {p.setting.family for p in points}
    assert cheapest(points, 0.005).setting.family == "plain"  # type: ignore[union-attr]


def test_a_setting_is_as_exact_as_its_own_scatter_lets_be_told() -> None:
    """One that scatters more than the others is not chosen for an accuracy that only they are known to have."""
    made = Made(chaotic=True)
    made.add("plain", 1.0, [[100.0], [104.0]], 1.0)
    for size in (0.5, 0.25, 0.125):
        made.add("plain", size, [[102.0], [102.001]], 1.0 / size)
    points = made.judged(made.settings[1]).numerics.points
    assert points[0].worst < 1e-4  # its mean happens to be right
    assert points[0].bound > 0.01
    assert cheapest(points, 0.01).setting.size == 0.5  # type: ignore[union-attr]


def test_a_curve_is_compared_where_there_are_rows_and_nowhere_else() -> None:
    from dcone_cosim.fmu.component import VariableInfo
    from dcone_cosim.quantities import at, spread_instants
    from dcone_cosim.recorder import Recorder

    recorder = Recorder(["x"], {"x": VariableInfo("x", 0, "Real", "m", "output", "")})
    for i in range(6):
        recorder.add(2.0 * i, np.array([float(i)]))
    found = at(recorder, "x", (2.0, 3.0, 4.0 + 1e-9, 10.0, 12.0))
    np.testing.assert_array_equal(found, [1.0, np.nan, 2.0, 5.0, np.nan])
    assert spread_instants(1.0, 10.0, 1.0, 5) == (3.0, 5.0, 7.0, 9.0, 11.0)
