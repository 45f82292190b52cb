"""What is told of a run is so: tugs that were missed, a line taut from the start, orbits, titles as written."""

from __future__ import annotations

import io
import json
import math
import os
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from time import sleep
from typing import Any

import numpy as np
import pytest
from rich.console import Console

from dcone_cosim import build
from dcone_cosim.findings import SHOWN_IN, Finding
from dcone_cosim.fmu.component import VariableInfo
from dcone_cosim.master import run_scene
from dcone_cosim.phases import capture_report
from dcone_cosim.plots import net_view, side_by_side, style, tow
from dcone_cosim.progress import Progress
from dcone_cosim.recorder import Recorder, TugLog
from dcone_cosim.reports import summary
from dcone_cosim.reports.figures import draw_all
from dcone_cosim.results import PhaseResult, RunResult
from dcone_cosim.run_folder import as_json
from dcone_cosim.scene.data import Scene
from tests.cosim.mock_components import MockCapture, MockRemoval

MakeScene = Callable[..., Scene]
HOSTILE = "tow [/b] [red]x $\\frac{ $ \\n 100 % of it"


def removal_run(scene: Scene, columns: dict[str, Sequence[float]], times: Sequence[float], tugs: TugLog) -> RunResult:
    """A run of a removal with the given columns."""
    names = list(columns)
    kinds = {name: VariableInfo(name, i, "Real", "1", "output", "") for i, name in enumerate(names)}
    recorder = Recorder(names, kinds)
    for i, time in enumerate(times):
        recorder.add(time, np.array([columns[name][i] for name in names]))
    return RunResult(scene, {"removal": PhaseResult("removal", times[0], recorder, tugs=tugs)})


def found(run: RunResult) -> dict[str, summary.Finding]:
    return {row.key: row for row in summary.findings(run)}


class TestTugs:
    def columns(self, taut: float = 0.0) -> dict[str, Sequence[float]]:
        return {"tether.tension_peak": [0.0, 30.0, 2.0], "tether.taut": [taut, 0.0, 1.0]}

    def test_missed_ones_are_told_and_the_largest_is_of_the_whole_run(self, make_scene: MakeScene) -> None:
        tugs = TugLog(2)
        tugs.update(5, np.array([[90.0, 2.0, 0.01], [80.0, 3.0, 0.02]]))
        rows = found(removal_run(make_scene("removal"), self.columns(), [0.0, 50.0, 100.0], tugs))
        assert (rows["tugs"].value, rows["tugs_missed"].value) == (5, 3)
        assert "first_tug" not in rows
        assert rows["first_tug_seen"].label == "first tug seen after"
        assert rows["first_tug_seen"].value == 80.0
        assert rows["largest_tug_peak"].value == 30.0

    def test_none_missed(self, make_scene: MakeScene) -> None:
        tugs = TugLog(2)
        tugs.update(1, np.array([[40.0, 30.0, 0.01], [0.0, 0.0, 0.0]]))
        rows = found(removal_run(make_scene("removal"), self.columns(), [0.0, 50.0, 100.0], tugs))
        assert (rows["first_tug"].value, rows["largest_tug_peak"].value) == (40.0, 30.0)
        assert not [key for key in rows if "seen" in key or "missed" in key]

    def test_a_line_taut_from_the_start_is_no_tug(self, make_scene: MakeScene) -> None:
        tugs = TugLog(2)
        tugs.update(2, np.array([[60.0, 2.0, 0.01], [0.0, 30.0, 0.0]]))
        rows = found(removal_run(make_scene("removal"), self.columns(taut=1.0), [0.0, 50.0, 100.0], tugs))
        assert rows["taut_from_start"].value == "taut from the start"
        assert (rows["tugs"].value, rows["first_tug"].value) == (1, 60.0)
        assert rows["tugs"].label == "tugs after that"
        rounded = TugLog(2)
        rounded.update(2, np.array([[60.0, 2.0, 0.01], [5.7e-6, 30.0, 1.4e-9]]))
        rows = found(removal_run(make_scene("removal"), self.columns(), [0.0, 50.0, 100.0], rounded))
        assert rows["taut_from_start"].value == "taut from the start"
        assert (rows["tugs"].value, rows["first_tug"].value) == (1, 60.0)
        run = removal_run(make_scene("removal"), self.columns(), [0.0, 50.0, 100.0], rounded)
        ((_, stems, _, _),) = tow._tug_sets(run.phases["removal"], None)
        assert stems.tolist() == [[60.0, 2.0]]
        slack = TugLog(2)
        slack.update(1, np.array([[0.01, 30.0, 0.01], [0.0, 0.0, 0.0]]))
        rows = found(removal_run(make_scene("removal"), self.columns(), [0.0, 50.0, 100.0], slack))
        assert (rows["tugs"].value, rows["first_tug"].value) == (1, 0.01)
        alone = TugLog(2)
        alone.update(1, np.array([[0.0, 30.0, 0.0], [0.0, 0.0, 0.0]]))
        rows = found(removal_run(make_scene("removal"), self.columns(taut=1.0), [0.0, 50.0, 100.0], alone))
        assert rows["tugs"].value == 0
        assert "first_tug" not in rows
        names = list(rows)
        assert names.index("tugs") == names.index("taut_from_start") + 1


class TestLowering:
    def rows(self, make_scene: MakeScene, separation: float, lowered: float, day: float) -> dict[str, summary.Finding]:
        columns = {
            "center.semi_major_axis": [7.178e6, 7.178e6 - lowered],
            "separation": [separation, 0.5 * separation],
            "altitude": [8e5, 8e5],
        }
        return found(removal_run(make_scene("removal"), columns, [0.0, 86400.0 * day], TugLog(1)))

    def test_of_a_pair_close_together(self, make_scene: MakeScene) -> None:
        rows = self.rows(make_scene, 12.0, 554.8, 1.0)
        assert rows["lowered"].value == pytest.approx(554.8)
        assert rows["lowering_rate"].value == pytest.approx(554.8 / 86400.0)
        assert rows["lowering_rate"].shown() == "554.8 m/day"
        assert rows["lowering_rate"].unit == "m/s"

    @pytest.mark.parametrize(("name", "told"), [("release", "the line was cut"), ("break", "the line broke")])
    def test_of_a_pair_that_is_let_go_until_then(self, make_scene: MakeScene, name: str, told: str) -> None:
        """It falls 100 m in each quarter of the first day; in the second the bodies are far apart and free."""
        time = np.arange(0.0, 2.01, 0.25) * 86400.0
        flags = {"release": "release.released", "break": "break.broken"}
        columns = {
            "center.semi_major_axis": list(7.178e6 - np.minimum(time, 86400.0) * 400.0 / 86400.0 + 9e3 * (time > 9e4)),
            "separation": list(np.where(time > 86400.0, 5e4, 12.0)), "altitude": [8e5] * 9,
            flags[name]: [0.0] * 4 + [1.0] * 5, f"{name}.time": [86400.0] * 9,
        }  # fmt: skip
        rows = found(removal_run(make_scene("removal"), columns, list(time), TugLog(1)))
        assert rows["lowered"].label == f"orbit lowered by, until {told}"
        assert rows["lowered"].value == pytest.approx(400.0)
        assert rows["lowering_rate"].shown() == "400 m/day"
        columns = {key: [column[0], column[-1]] for key, column in columns.items()}
        rows = found(removal_run(make_scene("removal"), columns, [0.0, 172800.0], TugLog(1)))
        assert rows["lowered"].value == f"not reported: too few rows before {told}"

    def test_not_of_a_pair_far_apart(self, make_scene: MakeScene) -> None:
        rows = self.rows(make_scene, 20e3, 554.8, 1.0)
        assert "not reported: chaser and target" in str(rows["lowered"].value)
        assert "lowering_rate" not in rows

    def test_no_rate_from_a_part_of_a_revolution(self, make_scene: MakeScene) -> None:
        assert "lowering_rate" not in self.rows(make_scene, 12.0, 5.0, 0.01)

    def test_not_where_it_is_noise(self, make_scene: MakeScene) -> None:
        assert "too little" in str(self.rows(make_scene, 500.0, 0.01, 1.0)["lowered"].value)


class TestLasting:
    """What a capture looked like, and what came of it."""

    def rows(self, make_scene: MakeScene, lost: float, end: float) -> dict[str, summary.Finding]:
        columns: dict[str, Sequence[float]] = {
            "t_capture": [-1.0, 15.2],
            "enclosure.at_capture": [-1.0, 25 / 27],
            "mouth.margin_at_capture": [-1.0, 0.1],
            "enclosure.least": [-1.0, 0.75],
            "t_lost": [-1.0, lost],
        }
        names = list(columns)
        kinds = {name: VariableInfo(name, i, "Real", "1", "output", "") for i, name in enumerate(names)}
        recorder = Recorder(names, kinds)
        for i, time in enumerate((0.0, end)):
            recorder.add(time, np.array([columns[name][i] for name in names]))
        return found(RunResult(make_scene("capture"), {"capture": PhaseResult("capture", 0.0, recorder)}))

    def test_a_capture_that_held(self, make_scene: MakeScene) -> None:
        rows = self.rows(make_scene, -1.0, 20.2)
        assert (rows["t_capture"].value, rows["mouth.margin_at_capture"].value) == (15.2, 0.1)
        assert rows["enclosure.at_capture"].value == pytest.approx(0.926, abs=1e-3)
        assert rows["enclosure.least"].value == 0.75
        assert rows["lasted"].value == "yes, for the 5 s to the end of the phase"

    def test_a_capture_that_was_taken_back(self, make_scene: MakeScene) -> None:
        assert self.rows(make_scene, 19.7, 20.2)["lasted"].value == "no: the target was out again 4.5 s later"

    def test_a_phase_that_ends_with_the_capture(self, make_scene: MakeScene) -> None:
        assert self.rows(make_scene, -1.0, 15.2)["lasted"].value == "not followed: the phase ends at the capture"

    def test_nothing_without_a_capture(self, whole: RunResult, make_scene: MakeScene) -> None:
        def instantiate(phase: str, name: str):
            return MockCapture(instant=1e9)

        assert "t_capture" not in found(run_scene(make_scene("capture"), instantiate, Progress()))
        # a foreign FMU tells when, and nothing of how it looked
        assert {"t_capture", "lasted"} & set(found(whole)) == {"t_capture"}


@pytest.fixture
def whole(make_scene: MakeScene) -> RunResult:
    def instantiate(phase: str, name: str):
        return MockCapture(reports=True) if phase == "capture" else MockRemoval(tugs=[(12.0, 5.0, 0.01)])

    return run_scene(make_scene("capture", "removal"), instantiate, Progress())


def test_texts_carry_no_unit_and_numbers_do(whole: RunResult) -> None:
    content = summary.as_dict(whole)
    for phase in ("capture", "hand-off", "removal"):
        for row in content[phase].values():
            assert isinstance(row["value"], str) != ("unit" in row)


def test_the_work_of_the_winches_is_told(make_scene: MakeScene) -> None:
    class Winches(MockCapture):
        def __init__(self) -> None:
            super().__init__()
            self.declare(["closing.work"], "output", 29.5)

    rows = found(run_scene(make_scene("capture"), lambda *_: Winches(), Progress()))
    assert (rows["closing.work"].value, rows["closing.work"].unit) == (29.5, "J")


def test_a_title_is_printed_as_it_is_written(whole: RunResult) -> None:
    whole.scene = replace(whole.scene, title=HOSTILE)
    console = Console(file=io.StringIO(), width=200)
    summary.show(whole, console)
    assert HOSTILE in console.file.getvalue()  # type: ignore[attr-defined]


def test_numbers_that_are_not_finite_are_told_and_written(make_scene: MakeScene) -> None:
    columns = {"tether.tension": [1.0, np.nan], "separation": [np.inf, -np.inf], "altitude": [0.0, np.nan]}
    run = removal_run(make_scene("removal"), columns, [0.0, 1.0], TugLog(1))
    content = json.loads(as_json(summary.as_dict(run)))
    assert content["removal"]["tension_mean"]["value"] == "nan"
    assert content["removal"]["separation"]["value"] == "-inf"
    summary.show(run, Console(file=io.StringIO()))
    numbers = {"a": np.float64(np.inf), "b": np.array([1.0, np.nan]), "c": (1, True, None, Path("x"))}
    assert json.loads(as_json(numbers)) == {"a": "inf", "b": [1.0, "nan"], "c": [1, True, None, "x"]}


class TestFigures:
    @pytest.fixture
    def towed(self, make_scene: MakeScene) -> RunResult:
        tugs = TugLog(1)
        tugs.update(1, np.array([[0.5, 3.0, 0.1]]))
        columns = {"tether.tension": [0.0, 1.0, 2.0], "chaser.radius": [7e6] * 3, "target.radius": [7e6] * 3}
        return removal_run(make_scene("removal"), columns, [0.0, 1.0, 2.0], tugs)

    @pytest.mark.parametrize("title", [HOSTILE, "$x^$", "", "long " * 200, "x" * 2000])
    def test_any_title_can_be_drawn(self, towed: RunResult, tmp_path: Path, title: str) -> None:
        towed.scene = replace(towed.scene, title=title)
        assert draw_all(towed, tmp_path) == []
        assert {p.name for p in tmp_path.iterdir()} == {"orbital_radius.png", "tether_tension.png"}

    def test_one_that_fails_is_named_and_the_others_are_drawn(
        self, towed: RunResult, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.setattr("dcone_cosim.plots.tow.orbit", lambda *_: 1 / 0)
        (note,) = draw_all(towed, tmp_path)
        assert "orbital_radius.png" in note
        assert "ZeroDivisionError" in note
        assert [p.name for p in tmp_path.iterdir()] == ["tether_tension.png"]

    @pytest.mark.parametrize("panels", range(1, 9))
    def test_the_grid_holds_its_panels_and_no_empty_row(self, panels: int) -> None:
        rows, columns = net_view.grid(panels)
        assert rows * columns >= panels > (rows - 1) * columns
        assert columns <= 4

    def test_no_legend_covers_a_curve(
        self, towed: RunResult, make_scene: MakeScene, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        """Curves that fill their axes from corner to corner: no place within is free for a legend."""
        times = list(np.linspace(0.0, 2.0, 9))
        up = list(np.arange(9.0))
        energies = ("energy.total", "energy.kinetic", "energy.elastic", "target.energy", "contact.loss", "closing.work")
        shot = removal_run(
            make_scene("removal"), {"mouth.area": up[::-1], **dict.fromkeys(energies, up)}, times, TugLog(1)
        )
        shot.phases["capture"] = shot.phases.pop("removal")
        assert shot.phases["capture"].recorder["mouth.area"][0] == 8.0
        seen = []

        def save(figure: Any, _: Path) -> None:
            figure.canvas.draw()
            legends = [axes.get_legend() for axes in figure.axes if axes.get_legend() is not None]
            boxes = [(legend.get_window_extent(), axes) for legend in legends for axes in figure.axes]
            assert not any(box.padded(-1.0).overlaps(axes.bbox) for box, axes in boxes)
            head = figure._suptitle.get_window_extent()
            assert not any(box.overlaps(head) or box.x1 > figure.bbox.x1 for box, _ in boxes)
            seen.append(len(legends))

        monkeypatch.setattr(style, "save", save)
        tow.orbit(towed.phases["removal"], "", "", tmp_path / "x.png")
        tow.tension(towed.phases["removal"], towed.comparisons.get("removal"), "", "", tmp_path / "x.png")
        capture_report.mouth_and_energy(shot.phases["capture"], "", tmp_path / "x.png")
        assert seen == [1, 1, 2]

    def test_long_titles_stay_within_the_figure(self) -> None:
        figure = style.new_figure(8.5, 6.5)
        style.head(figure, "a title that is rather long and goes on " * 5)
        figure.canvas.draw()
        box = figure._suptitle.get_window_extent()
        assert box.x0 >= 0.0
        assert box.x1 <= figure.bbox.x1


class TestSideBySide:
    def test_both_parts_are_reported_in_order(self) -> None:
        assert side_by_side.halves(lambda tasks: [f"{t}!" for t in tasks], "a", "bc") == ["a!", "b!", "c!"]
        assert side_by_side.halves(lambda tasks: [f"{t}!" for t in tasks], "", "bc") == ["b!", "c!"]

    def test_what_the_other_process_fails_to_do_is_done_here(self) -> None:
        here = os.getpid()

        def work(tasks: Sequence[str]) -> list[str]:
            if os.getpid() != here:
                os._exit(1)
            return list(tasks)

        assert side_by_side.halves(work, "a", "b") == ["a", "b"]

    def test_an_interrupt_leaves_no_process(self, monkeypatch: pytest.MonkeyPatch) -> None:
        here, fork, forked = os.getpid(), os.fork, []

        def noted() -> int:
            forked.append(fork())
            return forked[-1]

        monkeypatch.setattr(side_by_side.os, "fork", noted)

        def work(tasks: Sequence[str]) -> list[str]:
            if os.getpid() == here:
                raise KeyboardInterrupt
            sleep(30.0)
            return []

        with pytest.raises(KeyboardInterrupt):
            side_by_side.halves(work, "a", "b")
        with pytest.raises(ChildProcessError):
            os.waitpid(forked[0], os.WNOHANG)


SQUARE = {"net.side": 4.0, "net.mesh": 2.0}
BOX = {f"target.size[{i}]": edge for i, edge in ((1, 2.0), (2, 4.0), (3, 6.0))}


class TestShapesDrawn:
    """Net and target are drawn by the terms a scene names; of a file, which names none, by what it tells."""

    def test_the_term_decides(self) -> None:
        """A pyramid has all keys of a square, and a cylinder beside a box's keys is still a cylinder."""
        values = SQUARE | BOX | {"net.depth": 1.0, "target.radius": 1.0, "target.length": 4.0}
        surface = build.target_surface(values, {"target": "cylinder"})
        assert surface is not None
        assert np.abs(surface[0]).max() == 2.0
        assert build.target_surface(values, {"target": "box"})[0] != surface[0]  # type: ignore[index]
        lines, rim = build.net_drawing(values, {"net": "square"}) or ([], [])
        assert lines == [[0, 1, 2], [3, 4, 5], [6, 7, 8], [0, 3, 6], [1, 4, 7], [2, 5, 8]]
        assert rim == [0, 1, 2, 5, 8, 7, 6, 3, 0]

    def test_a_file_is_drawn_by_its_own_parameters(self) -> None:
        corners, faces = build.target_surface(BOX, {}) or ([], [])
        assert sorted(map(tuple, np.abs(corners))) == [(1.0, 2.0, 3.0)] * 8
        assert len(faces) == 6
        assert build.target_surface({"target.mass": 1.0}, {}) is None
        assert build.net_drawing({"net.side": 4.0}, {}) is None
        wide = {"net.width": 6.0, "net.height": 2.0, "net.mesh": 1.0}
        lines, _ = build.net_drawing(wide, {}) or ([], [])
        assert sorted(map(len, lines)) == [3] * 7 + [7] * 3


@pytest.mark.parametrize(
    ("value", "unit", "shown_in", "shown"),
    [
        (799451.29, "m", "km", "799.451 km"),
        (0.0170482, "m/s", "mm/s", "17.0482 mm/s"),
        (554.84 / 86400.0, "m/s", "m/day", "554.84 m/day"),
        (math.pi / 60.0, "rad/s", "deg/s", "3 deg/s"),
        (12.5, "N", "", "12.5 N"),
    ],
)
def test_what_a_person_reads_is_the_si_value_in_another_unit(
    value: float, unit: str, shown_in: str, shown: str
) -> None:
    assert Finding("removal", "key", "label", value, unit, shown_in=shown_in).shown() == shown


def test_a_unit_that_nobody_reads_is_no_silent_one() -> None:
    with pytest.raises(KeyError):
        Finding("removal", "key", "label", 1.0, "rad/s", shown_in="rpm").shown()


def test_every_unit_that_a_person_reads_is_as_large_as_astropy_has_it() -> None:
    import astropy.units as u

    si = {"%": u.one, "MPa": u.Pa, "mm/s": u.m / u.s, "km": u.m, "m/day": u.m / u.s, "deg/s": u.rad / u.s, "deg": u.rad}
    si |= {"day": u.s, "yr": u.s, "mm": u.m, "µs": u.s}
    assert {name: u.Unit(name).to(si[name]) for name in SHOWN_IN} == pytest.approx(SHOWN_IN, rel=1e-14)
