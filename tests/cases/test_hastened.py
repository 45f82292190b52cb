"""Tows of which no table is kept: fewer and longer macro steps, and the same figures."""

from __future__ import annotations

import pytest

from dcone_cosim.cases.case import Case
from dcone_cosim.cases.rows import Row
from dcone_cosim.cases.work import Fleet, tell_summary
from dcone_cosim.fmu.component import CallError, Component
from dcone_cosim.loading import load
from dcone_cosim.phases import hastened
from dcone_cosim.results import RunResult

LONG = ("removal.duration=4 h", "removal.macro_step=10 s")


def row(*settings: str, tables: bool, scene: str = "table2-deorbit") -> Row:
    fleet = Fleet()
    try:
        return fleet.row(Case("", load(scene, [*LONG, *settings])), tell_summary, tables)
    finally:
        fleet.close()


def counted(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """Lengths of all steps that are taken [s]."""
    found: list[float] = []
    step = Component.step

    def watched(self: Component, time: float, size: float) -> None:
        found.append(size)
        step(self, time, size)

    monkeypatch.setattr(Component, "step", watched)
    return found


@pytest.mark.parametrize(
    "settings",
    [
        (),
        ("removal.tether.damping_ratio=0.3", "removal.thrust.level=-0.2 N"),
        ("removal.tether.diameter=0.4 mm", "removal.thrust.level=0.05 N"),
    ],
    ids=["as it is", "stiff and hard", "thin, raised"],
)
def test_every_figure_is_that_of_all_rows(settings: tuple[str, ...], monkeypatch: pytest.MonkeyPatch) -> None:
    lengths = counted(monkeypatch)
    quick = row(*settings, tables=False)
    few = len(lengths)
    whole = row(*settings, tables=True)
    assert quick.succeeded
    assert quick.figures == whole.figures
    assert quick.figures["removal.steps"] == 1440 == len(lengths) - few
    assert 600 < few < 720, "an orbit of 6053 s in steps of 10 s, the rest in steps of 160 s"


def test_the_window_of_the_last_orbit_must_lie_where_all_rows_are(monkeypatch: pytest.MonkeyPatch) -> None:
    """Were less than an orbit left for them, the window would begin at another row; the tow is then taken again."""
    monkeypatch.setattr(hastened, "MARGIN", 0.5)
    lengths = counted(monkeypatch)
    quick = row(tables=False)
    assert len(lengths) > 1440
    assert quick.figures == row(tables=True).figures
    monkeypatch.setattr(hastened.Hastened, "_seen_in_full", lambda self, since: True)
    assert quick.figures["removal.tension_window"] != row(tables=False).figures["removal.tension_window"]


def test_a_long_step_that_fails_is_no_failure(monkeypatch: pytest.MonkeyPatch) -> None:
    """The tow is taken again in the steps of its scene, which may go further or end where they do."""
    whole, step = row(tables=True), Component.step
    refused = []

    def fails(self: Component, time: float, size: float) -> None:
        if size > 100.0 and time > 3000.0:
            refused.append(time)
            raise CallError(self.name, "", "too long", "")
        step(self, time, size)

    monkeypatch.setattr(Component, "step", fails)
    quick = row(tables=False)
    assert len(refused) == 1
    assert quick.figures == whole.figures


def test_with_outputs_whose_rows_are_told_they_stay() -> None:
    """Only what is known to tell the same with fewer rows is hastened."""
    for asked in ("level.settled", "tether.wrapped", "release.released", "electrodynamic.power", "lumped.deflection"):
        assert not hastened.KNOWN.fullmatch(asked)
    assert hastened.KNOWN.fullmatch("center.velocity[3]")


def test_who_asks_for_rows_gets_them(monkeypatch: pytest.MonkeyPatch) -> None:
    """A row that is made of more than the summary, as those of `dcone size` and `dcone accuracy`, has all of them."""
    seen: list[int] = []

    def tell(case: Case, result: RunResult, timings: object) -> Row:
        seen.append(len(result.phases["removal"].recorder))
        return Row(case.key, "completed")

    fleet = Fleet()
    case = Case("", load("table2-deorbit", LONG))
    fleet.row(case, tell)
    fleet.row(case, tell, tables=False)
    fleet.close()
    assert seen[0] == 1441
    assert seen[1] < 720
