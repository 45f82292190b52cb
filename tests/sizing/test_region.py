"""Where a tow may be flown: what makes a point of the grid bad, and that a debris that turns pulls harder."""

from __future__ import annotations

import math
from collections.abc import Sequence

import pytest

from dcone_cosim.cases.alone import Alone
from dcone_cosim.cases.rows import Row
from dcone_cosim.progress import Progress
from dcone_cosim.sizing.ground import Found, Ground
from dcone_cosim.sizing.region import _half_round, _turning, _verdict, region
from dcone_cosim.sizing.result import Sizing
from dcone_cosim.sizing.work import Load


def test_what_is_not_admissible() -> None:
    assert _verdict(99.0, 100.0, 5.0, 6.0) == "admissible"
    assert _verdict(101.0, 100.0, 5.0, 6.0) == "too hard"
    assert _verdict(99.0, 100.0, 7.0, 6.0) == "wraps"
    assert _verdict(101.0, 100.0, 7.0, 6.0) == "too hard and wraps"


def test_the_strength_counts_over_the_factor_of_safety(monkeypatch: pytest.MonkeyPatch) -> None:
    """Every tow of the grid pulls with 60 N: too hard for a line that breaks at 100 N, with a factor of 2."""

    def pulls(self: Ground, cases: Sequence[Load], what: str) -> list[Found]:
        row = Row("key", "completed", samples={"removal": {"extremes": {}}})
        return [Found(60.0, (), row) for _ in cases]

    monkeypatch.setattr(Ground, "run", pulls)
    ground = Ground(Alone("tumbling-target", (), None), Progress())
    assert {point.verdict for point in region(ground, 100.0, 2.0, quick=True).points} == {"too hard"}
    found = region(ground, 130.0, 2.0, quick=False)
    assert {point.verdict for point in found.points} == {"admissible"}
    assert len(found.points) == 40
    assert found.body == "the scene's box"
    half = 0.5 * ground.values["target.size[1]"]
    assert {point.offset for point in found.points} == {0.0, 0.25 * half, 0.5 * half, half}


def test_no_start_of_the_grid_is_stretched(monkeypatch: pytest.MonkeyPatch) -> None:
    """A line that is made fast aside reaches less far along: the pair begins nearer, by the way that it is aside."""
    begun: list[Load] = []

    def keeps(self: Ground, cases: Sequence[Load], what: str) -> list[Found]:
        begun.extend(cases)
        row = Row("key", "completed", samples={"removal": {"extremes": {}}})
        return [Found(1.0, (), row) for _ in cases]

    monkeypatch.setattr(Ground, "run", keeps)
    region(Ground(Alone("table2-deorbit", (), None), Progress()), 100.0, 2.0, quick=True)
    found = {}
    for case in begun:
        values = case.scene.phases[0].main.parameters
        found[values["target.attachment[1]"]] = values["start.separation"]
    assert found == {0.0: 14.0, 1.0: pytest.approx(14.0 - (math.hypot(12.0, 1.0) - 12.0) - 1e-3)}


def test_half_of_the_way_round() -> None:
    """Across the axis about which it turns: a box's width and depth; two radii and the length of a cylinder."""
    assert _half_round({"target.size[1]": 2.0, "target.size[2]": 5.0, "target.size[3]": 9.0}) == 7.0
    assert _half_round({"target.cylinder_radius": 1.5, "target.cylinder_length": 4.0}) == 7.0
    assert _half_round({}) == 12.0


@pytest.mark.parametrize(("leading", "side"), [("target", -4.0), ("chaser", 4.0)])
def test_the_line_is_made_fast_towards_the_chaser(leading: str, side: float) -> None:
    ground = Ground(Alone("table2-deorbit", (f"removal.start.leading='{leading}'",), None), Progress())
    scene, _ = _turning(ground)
    values = scene.phases[0].main.parameters
    assert [values[f"target.attachment[{i}]"] for i in (1, 2, 3)] == [0.0, side, 0.0]
    assert values["start.separation"] == pytest.approx(10.0 + 4.0), "as much slack as the point has"
    assert values["target.inertia[1]"] == pytest.approx(1000.0 * (8.0**2 + 4.0**2) / 12.0)


def test_a_debris_that_turns_pulls_harder(done: Sizing) -> None:
    found = done["region"]
    assert len(found) == 6
    still, fast = (found[found.rate.round(6) == round(math.radians(rate), 6)] for rate in (0.0, 5.0))
    assert (fast.peak.to_numpy() > 5.0 * still.peak.to_numpy()).all()
    assert set(found.verdict) <= {"admissible", "too hard", "wraps", "too hard and wraps"}
    assert done.study is not None
    assert done.study.region is not None
    assert done.study.region.half_round == 12.0, "half of the way round Table 1's box, 4 x 8 m"
    assert "Table 1" in done.study.region.body


def test_a_point_of_the_grid_is_the_tow_with_that_box(done: Sizing) -> None:
    """A box that does not turn, made fast in the middle, first tugs as the point does: as much slack, as much mass."""
    assert done.study is not None
    found = done["region"]
    first = done.study.nominal.tugs[0]
    plain = found[(found.rate == 0.0) & (found.offset == 0.0)]
    assert float(plain.peak.iloc[0]) > 0.9 * first[1]
