"""The paper's mass budgets rebuilt: which lines are derived, and how near they come."""

from __future__ import annotations

import pytest

from dcone_cosim.sizing import budget

TABLES = {
    "Table 3, 200 kg, 2.3 m": (0.3, 4 * 0.45, 12.83, 2.4, 4.8, 22.13),
    "Table 3, 1000 kg, 3.9 m": (0.84, 4 * 1.27, 13.09, 2.4, 4.8, 26.21),
    "Table 4, 8000 kg, 25 m": (6.67, 4 * 10.0, 16.58, 2.7, 4.8, 70.75),
}
"""The paper's figures [kg], as printed: net, bullets, shooting, tether, sensors, total."""


def test_every_line_stands_beside_the_papers() -> None:
    for name, figures in TABLES.items():
        found = [line for line in budget.lines() if line.column == name]
        assert [line.paper for line in found] == pytest.approx(list(figures))
        assert sum(line.paper for line in found[:-1]) == pytest.approx(figures[-1], abs=0.006), "the paper adds up"
        assert found[-1].found == pytest.approx(sum(line.found for line in found[:-1]))


def test_what_is_derived_comes_near_and_what_is_not_says_so() -> None:
    kinds = {(line.column.split(",")[1].strip(), line.name): line for line in budget.lines()}
    net = kinds["1000 kg", "net"]
    assert net.kind == budget.DERIVED
    assert net.found == pytest.approx(0.84, rel=3e-3)
    assert kinds["200 kg", "net"].kind == budget.FITTED, "its factor was found from it"
    assert kinds["200 kg", "net"].found == pytest.approx(0.3, rel=3e-3)
    assert kinds["8000 kg", "net"].found == pytest.approx(6.67, rel=1e-3)
    for debris in ("200 kg", "1000 kg"):
        bullets = kinds[debris, "bullets"]
        assert bullets.kind == budget.DERIVED
        assert bullets.difference == pytest.approx(0.0, abs=0.01)
    taken = [line for line in budget.lines() if line.kind == budget.TAKEN]
    assert {line.name for line in taken} == {"bullets", "tether 100 m, reel, control", "sensors and data"}
    assert all(line.difference == 0.0 for line in taken)


def test_a_factor_that_is_off_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(budget, "SIDE_OVER_LENGTH", 1.01 * budget.SIDE_OVER_LENGTH)
    net = next(line for line in budget.lines() if line.name == "net" and line.kind == budget.DERIVED)
    assert abs(net.difference) > 0.01


def test_a_difference_is_over_the_papers_figure() -> None:
    assert budget.Line("", "", 1.2, 1.0, budget.DERIVED, "").difference == pytest.approx(0.2)


def test_the_mesh_that_table_4s_net_allows() -> None:
    """Both ways: a net of that mesh weighs 6.67 kg, with the margin and without, for each configuration of Fig. 9."""
    sides = {"36 x 36 m": (36.0, 36.0), "30 x 26 m": (30.0, 26.0), "18 x 18 m": (18.0, 18.0)}
    assert [(one.name, one.along, one.across) for one in budget.allowed()] == [(n, *s) for n, s in sides.items()]
    for one in budget.allowed():
        for mesh, margin in ((one.margined, 1.2), (one.bare, 1.0)):
            threads = one.along * (one.across / mesh + 1.0) + one.across * (one.along / mesh + 1.0)
            assert margin * 1440.0 * 3.141592653589793 * 1e-6 / 4.0 * threads == pytest.approx(6.67, rel=1e-9)


def test_the_shooting_mechanism_is_a_fit_of_two_parameters() -> None:
    """By the normal equations of a straight line through the paper's three points."""
    x, y = [1.8, 5.08, 40.0], [12.83, 13.09, 16.58]
    mean_x, mean_y = sum(x) / 3, sum(y) / 3
    slope = sum((a - mean_x) * (b - mean_y) for a, b in zip(x, y, strict=True)) / sum((a - mean_x) ** 2 for a in x)
    assert budget.shooting_law() == pytest.approx((mean_y - slope * mean_x, slope))
    assert budget.shooting_law() == pytest.approx((12.62, 0.0989), abs=5e-3)
