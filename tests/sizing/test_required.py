"""The search for a diameter step by step, and the closed form that it begins from, each recomputed by hand."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from types import SimpleNamespace
from typing import Any

import pytest

from dcone_cosim.sizing import required
from dcone_cosim.sizing.required import Required, Search, Snap
from orbital.materials import Material

SAFETY = 2.0
E, RHO, SIGMA = 100e9, 1500.0, 2e9
FIBRE = Material("fibre", E, RHO, SIGMA, 0.03, None)


def area(diameter: float) -> float:
    return math.pi * diameter**2 / 4.0


OWN = {
    "tether.diameter": 1e-3,
    "tether.youngs_modulus": 60e9,
    "tether.rest_length": 12.0,
    "tether.damping_ratio": 0.05,
}
SAMPLE = {
    "tether.diameter": 3e-3,
    "tether.youngs_modulus": 30e9,
    "tether.rest_length": 20.0,
    "tether.damping_ratio": 0.2,
}
"""Three times the diameter and half the modulus of the scene's own line."""
TUG = (5.0, 300.0, -0.4)


class FakeGround:
    """Runs whose peak [N] is a law of their values."""

    def __init__(self, law: Any, values: Mapping[str, float] = OWN) -> None:
        self.law, self.values, self.said = law, values, []

    def case(self, values: Mapping[str, float]) -> Mapping[str, float]:
        return values

    def run(self, cases: Iterable[Mapping[str, float]], what: str) -> Iterator[Any]:
        self.said.append(what)
        for case in cases:
            yield SimpleNamespace(peak=self.law(case), row=SimpleNamespace(status="failed", message="it broke"))


class TestClosedForm:
    """T = P + sqrt(P^2 + g^2 k m v^2), k = E A/l: both ways."""

    P, F = 20.0, SAFETY

    @pytest.fixture
    def snap(self) -> Snap:
        return required.in_closed_form(OWN, SAMPLE, TUG, self.P, FIBRE, self.F, "a run")

    def test_mass_of_the_tug(self, snap: Snap) -> None:
        """Put back into the law with the run's own line, it gives the peak that it is from."""
        zeta = 0.2
        share = math.exp(-zeta * (3.0 * math.acos(zeta) - math.pi) / math.sqrt(1.0 - zeta**2))
        stiffness = 30e9 * area(3e-3) / 20.0
        back = self.P + math.sqrt(self.P**2 + share**2 * stiffness * snap.mass * 0.4**2)
        assert back == pytest.approx(300.0, rel=1e-12)
        assert snap.share == pytest.approx(share, rel=1e-12)
        assert (snap.run, snap.speed, snap.preload, snap.length) == ("a run", 0.4, self.P, 20.0)

    def test_line_of_that_diameter_bears_its_own_snap(self, snap: Snap) -> None:
        """With the sample's shares: the run's line is three times as thick as the one that is sought, of half its E."""
        assert snap.youngs_modulus == pytest.approx(0.5 * 9.0 * E, rel=1e-12)
        stiffness = (0.5 * E) * area(3.0 * snap.diameter) / 20.0
        peak = self.P + math.sqrt(self.P**2 + snap.share**2 * stiffness * snap.mass * snap.speed**2)
        assert self.F * peak == pytest.approx(SIGMA * area(snap.diameter), rel=1e-12)

    def test_preload_that_is_all_of_it_leaves_no_mass(self) -> None:
        snap = required.in_closed_form(OWN, {}, (0.0, 39.0, 0.4), self.P, FIBRE, self.F)
        assert snap.mass == 0.0
        assert SIGMA * area(snap.diameter) == pytest.approx(2.0 * self.F * self.P, rel=1e-12)

    def test_without_speed_there_is_no_impact(self) -> None:
        snap = required.in_closed_form(OWN, {}, (0.0, 300.0, 0.0), self.P, FIBRE, self.F)
        assert (snap.mass, snap.speed, snap.run) == (0.0, 0.0, "")

    def test_what_is_told_makes_the_diameter(self, snap: Snap) -> None:
        """With the numbers of the table, in their units, and the formula in its last line."""
        told = {row.what.rpartition(", ")[2]: row for row in snap.told(self.F, SIGMA)}
        s, sigma, v, m, p, g, length, e = (told[k].value for k in ("S", "sigma", "v", "m_r", "P", "g", "l", "E"))
        assert [told[k].unit for k in ("S", "sigma", "v", "m_r", "P", "g", "l", "E", "diameter")] == [
            *("1", "Pa", "m/s", "kg", "N", "1", "m", "Pa", "m")
        ]  # fmt: skip
        found = (s * g * v / sigma) ** 2 * e * m / length + 2.0 * s * p / sigma
        assert area(told["diameter"].value) == pytest.approx(found, rel=1e-12)
        assert "a run" in told["v"].how


class TestNext:
    """The diameter to try."""

    def search(self, thin: Any = None, thick: Any = None, tried: int = 0) -> Search:
        return Search(FIBRE, [{}], 3e-4, thin, thick, tried=[(1.0, 1.0)] * tried)

    def test_begins_where_it_is_told(self) -> None:
        assert self.search().next() == 3e-4

    @pytest.mark.parametrize(("tried", "factor"), [(1, 1.0), (2, 1.0), (3, 1.25), (6, 1.25**2)])
    def test_goes_outwards_by_what_is_lacking(self, tried: int, factor: float) -> None:
        """Faster every third time; the bearing grows with the square, and the peak with no more than the diameter."""
        step = math.exp(0.3) * 1.005 * factor
        assert self.search(thin=(1e-3, -0.3), tried=tried).next() == pytest.approx(1e-3 * step, rel=1e-12)
        assert self.search(thick=(1e-3, 0.3), tried=tried).next() == pytest.approx(1e-3 / step, rel=1e-12)

    @pytest.mark.parametrize(
        ("below", "above", "share"),
        [(-0.1, 0.3, 0.25 - 0.3 * 0.005 / math.log(2.0)), (-0.3, 0.1, 0.75 + 0.3 * 0.005 / math.log(2.0))],
        ids=["nearer to the thin end", "nearer to the thick end"],
    )
    def test_between_two_it_goes_by_a_straight_line_and_a_little_beyond(
        self, below: float, above: float, share: float
    ) -> None:
        """Away from the nearer end's zero, so that the far end comes in."""
        found = self.search((1e-3, below), (2e-3, above), 2).next()
        assert math.log(found / 1e-3) / math.log(2.0) == pytest.approx(share, rel=1e-12)

    def test_as_near_to_both_ends_it_goes_to_the_thin_one(self) -> None:
        found = self.search((1e-3, -0.2), (2e-3, 0.2), 2).next()
        assert math.log(found / 1e-3) / math.log(2.0) == pytest.approx(0.5 - 0.3 * 0.005 / math.log(2.0), rel=1e-12)

    def test_what_it_goes_beyond_is_a_quarter_at_most(self) -> None:
        narrow = 1.0055
        found = self.search((1e-3, -0.1), (1e-3 * narrow, 0.1 + 1e-9), 2).next()
        assert math.log(found / 1e-3) / math.log(narrow) == pytest.approx(0.5 - 0.25, abs=1e-6)

    @pytest.mark.parametrize(("below", "above", "share"), [(-1e-9, 0.3, 0.02), (-0.3, 1e-9, 0.98)])
    def test_it_keeps_off_the_ends(self, below: float, above: float, share: float) -> None:
        found = self.search((1e-3, below), (2e-3, above), 2).next()
        assert math.log(found / 1e-3) / math.log(2.0) == pytest.approx(share, rel=1e-12)

    @pytest.mark.parametrize(("tried", "halved"), [(4, False), (5, True), (9, True)])
    def test_after_some_runs_it_halves(self, tried: int, halved: bool) -> None:
        found = self.search((1e-3, -0.01), (4e-3, 0.3), tried).next()
        assert (found == pytest.approx(2e-3, rel=1e-12)) is halved


class TestTake:
    """What a run at a diameter is taken for: a line that bears `margin` times what it has to."""

    def take(self, one: Search, diameter: float, margin: float) -> None:
        one.take(diameter, SIGMA * area(diameter) / (SAFETY * margin), SAFETY)

    def test_thick_enough_or_too_thin(self) -> None:
        one = Search(FIBRE, [{}], 1e-3)
        self.take(one, 1e-3, 0.5)
        assert one.thin == pytest.approx((1e-3, math.log(0.5)))
        assert one.thick is None
        self.take(one, 4e-3, 3.0)
        assert one.thick == pytest.approx((4e-3, math.log(3.0)))
        assert one.peak == pytest.approx(SIGMA * area(4e-3) / (SAFETY * 3.0))
        assert one.tried == [(1e-3, pytest.approx(SIGMA * area(1e-3))), (4e-3, one.peak)]

    def test_just_enough_is_enough(self) -> None:
        one = Search(FIBRE, [{}], 1e-3)
        load = FIBRE.breaking_load(1e-3)
        assert load is not None
        one.take(1e-3, load / SAFETY, SAFETY)
        assert one.thin is None
        assert one.thick == (1e-3, 0.0)

    def test_only_nearer_ends_count(self) -> None:
        one = Search(FIBRE, [{}], 1e-3, (1e-3, -0.3), (4e-3, 0.3), 7.0)
        self.take(one, 5e-3, 2.0)
        self.take(one, 0.5e-3, 0.5)
        assert (one.thin, one.thick, one.peak) == ((1e-3, -0.3), (4e-3, 0.3), 7.0)
        self.take(one, 4e-3, 2.0)
        self.take(one, 1e-3, 0.5)
        assert (one.thin, one.thick, one.peak) == ((1e-3, -0.3), (4e-3, 0.3), 7.0)
        self.take(one, 3e-3, 2.0)
        self.take(one, 2e-3, 0.5)
        assert (one.thin[0], one.thick[0]) == (2e-3, 3e-3)  # type: ignore[index]

    def test_where_the_peak_jumps_ends_that_contradict_are_dropped(self) -> None:
        """A thinner line that holds makes nothing of a thicker one that does not, and the other way round."""
        one = Search(FIBRE, [{}], 1e-3, (2e-3, -0.3), (4e-3, 0.3), 7.0)
        self.take(one, 1e-3, 1.5)
        assert one.thin is None
        assert one.thick is not None
        assert one.thick[0] == 1e-3
        one = Search(FIBRE, [{}], 1e-3, (2e-3, -0.3), (4e-3, 0.3), 7.0)
        self.take(one, 5e-3, 0.5)
        assert one.thick is None
        assert math.isnan(one.peak)
        assert one.thin is not None
        assert one.thin[0] == 5e-3

    @pytest.mark.parametrize("margin", [1.5, 0.5])
    def test_the_same_diameter_again_replaces_the_end_that_it_contradicts(self, margin: float) -> None:
        one = Search(FIBRE, [{}], 1e-3, (2e-3, -0.3), None)
        if margin < 1.0:
            one = Search(FIBRE, [{}], 1e-3, None, (2e-3, 0.3), 7.0)
        self.take(one, 2e-3, margin)
        assert (one.thin is None) is (margin > 1.0)
        assert (one.thick is None) is (margin < 1.0)

    def test_a_line_that_bears_nothing_is_thick_enough(self) -> None:
        one = Search(FIBRE, [{}], 1e-3)
        one.take(1e-3, 0.0, SAFETY)
        assert one.thick == (1e-3, math.inf)
        one.take(0.9e-3, 0.5, SAFETY)
        assert one.thick == (0.9e-3, pytest.approx(math.log(SIGMA * area(0.9e-3) / (SAFETY * 0.5))))

    @pytest.mark.parametrize(
        ("diameter", "failed"), [(1e-6, True), (1.01e-6, False), (0.199, False), (0.2, True), (0.3, True)]
    )
    def test_diameters_that_no_line_has_end_it(self, diameter: float, failed: bool) -> None:
        one = Search(FIBRE, [{}], 1e-3)
        self.take(one, diameter, 0.5)
        assert bool(one.failed) is failed
        assert one.done is failed

    @pytest.mark.parametrize(("ratio", "done"), [(1.0049, True), (1.0051, False), (1.005, False)])
    def test_done_where_both_ends_are_near(self, ratio: float, done: bool) -> None:
        one = Search(FIBRE, [{}], 1.0, (1.0, -0.1), (ratio, 0.1))
        assert one.done is done
        assert not Search(FIBRE, [{}], 1.0, (1.0, -0.1), None).done
        assert not Search(FIBRE, [{}], 1.0, None, (1.0, 0.1)).done


class TestSearch:
    """All of it, with runs whose peak is known: T = c sqrt(E) d of the run's own line."""

    COEFFICIENT = 8.0

    def law(self, values: Mapping[str, float]) -> float:
        line = values["tether.diameter"]
        return self.COEFFICIENT * values.get("load", 1.0) * math.sqrt(values["tether.youngs_modulus"]) * line

    def expected(self, modulus: float, thicker: float, load: float) -> float:
        """sigma pi d^2/4 = S c load sqrt(E) (thicker d)."""
        return 4.0 * SAFETY * self.COEFFICIENT * load * math.sqrt(modulus) * thicker / (math.pi * SIGMA)

    def test_the_hardest_run_counts_with_its_share_of_the_line(self) -> None:
        thick = {"tether.diameter": 1.5e-3, "load": 2.0}
        soft = {"tether.youngs_modulus": 15e9, "load": 2.5}
        ground: Any = FakeGround(self.law)
        (one,) = required.search(ground, [(FIBRE, 1e-4)], [soft, thick, {}], SAFETY)
        expected = max(self.expected(E, 1.5, 2.0), self.expected(E / 4.0, 1.0, 2.5), self.expected(E, 1.0, 1.0))
        assert expected == self.expected(E, 1.5, 2.0)
        assert one.thick is not None
        assert expected <= one.thick[0] <= expected * 1.005
        assert ground.said[0] == "diameters, round 1"
        assert len(ground.said) <= required.ROUNDS

    def test_a_share_of_the_modulus_applies_to_the_material(self) -> None:
        ground: Any = FakeGround(self.law)
        (one,) = required.search(ground, [(FIBRE, 1e-4)], [{"tether.youngs_modulus": 15e9}], SAFETY)
        expected = self.expected(E / 4.0, 1.0, 1.0)
        assert one.thick is not None
        assert expected <= one.thick[0] <= expected * 1.005

    def test_what_does_not_close_in_is_given_up(self) -> None:
        """Every line bears a hair less than it has to: it goes on outwards for so many rounds, and is not found."""
        ground: Any = FakeGround(lambda values: SIGMA * area(values["tether.diameter"]) / SAFETY * (1.0 + 1e-9))
        (one,) = required.search(ground, [(FIBRE, 1e-5)], [{}], SAFETY)
        assert len(one.tried) == 14
        assert required.result(one, None, 1e-3, 12.0, SAFETY).note == "not found"

    def test_materials_are_sought_side_by_side(self) -> None:
        stiff = Material("stiff", 4.0 * E, RHO, SIGMA, 0.03, None)
        ground: Any = FakeGround(self.law)
        found = required.search(ground, [(FIBRE, 1e-4), (stiff, 1e-2)], [{}, {"load": 3.0}], SAFETY)
        for one, modulus in zip(found, (E, 4.0 * E), strict=True):
            assert one.thick is not None
            expected = self.expected(modulus, 1.0, 3.0)
            assert expected <= one.thick[0] <= expected * 1.005
            assert one.peak == pytest.approx(SIGMA * area(one.thick[0]) / SAFETY, rel=0.006)

    def test_a_run_that_does_not_end_is_told(self) -> None:
        ground: Any = FakeGround(lambda values: math.nan if "load" in values else self.law(values))
        (one,) = required.search(ground, [(FIBRE, 1e-4)], [{}, {"load": 1.0}], SAFETY)
        assert "it broke" in one.failed
        peak, margin = required.at(ground, FIBRE, 1e-3, [{}, {"load": 1.0}], SAFETY)
        assert math.isnan(peak)
        assert math.isnan(margin)

    def test_margin_at_a_diameter(self) -> None:
        ground: Any = FakeGround(self.law)
        peak, margin = required.at(ground, FIBRE, 2e-3, [{"load": 1.0}, {"load": 3.0}], SAFETY)
        assert peak == pytest.approx(3.0 * self.COEFFICIENT * math.sqrt(E) * 2e-3, rel=1e-12)
        assert SAFETY * peak * (1.0 + margin) == pytest.approx(SIGMA * area(2e-3), rel=1e-12)


class TestResult:
    def found(self, surplus: float, **other: Any) -> Required:
        peak = SIGMA * area(2e-3) / SAFETY / (1.0 + surplus)
        one = Search(FIBRE, [{}], 1e-3, thick=(2e-3, surplus), peak=peak, tried=[(2e-3, peak)] * 3, **other)
        snap = required.in_closed_form(OWN, {}, TUG, 20.0, FIBRE, SAFETY)
        return required.result(one, snap, 5e-3, 12.0, SAFETY)

    def test_mass_and_margin_of_the_line(self) -> None:
        row = self.found(0.01)
        assert row.mass == pytest.approx(RHO * math.pi * 1e-6 * 12.0, rel=1e-12)
        assert row.margin == pytest.approx(0.01, rel=1e-9)
        assert (row.diameter, row.fixed, row.runs, row.note) == (2e-3, 5e-3, 3, "")
        assert row.snap is not None
        assert row.closed == row.snap.diameter

    @pytest.mark.parametrize(("surplus", "jumps"), [(0.019, False), (0.021, True)])
    def test_a_margin_that_is_left_is_a_jump(self, surplus: float, jumps: bool) -> None:
        assert bool(self.found(surplus).note) is jumps

    def test_what_was_not_found_has_no_figures(self) -> None:
        row = self.found(0.01, failed="it broke")
        assert row.note == "it broke"
        assert all(math.isnan(x) for x in (row.diameter, row.peak, row.mass, row.margin))
        nothing = required.result(Search(FIBRE, [{}], 1e-3), None, 5e-3, 12.0, SAFETY)
        assert nothing.note == "not found"
        assert math.isnan(nothing.closed)
        assert nothing.runs == 0
