"""`dcone accuracy` as a user runs it: what it leaves, and that the errors it tells are the errors there are."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from dcone_cosim import build
from dcone_cosim.accuracy import commands
from dcone_cosim.accuracy.plan import Effort, Planned, Planner, plan
from dcone_cosim.accuracy.settings import COUPLING, MACRO_STEP, NUMERICS, Setting, settings_of
from dcone_cosim.accuracy.work import measure
from dcone_cosim.cases import alone
from dcone_cosim.cases.alone import Alone
from dcone_cosim.errors import InputError
from dcone_cosim.progress import Progress
from dcone_cosim.results import RunResult
from tests.accuracy.conftest import MISSION
from tests.cases.conftest import put_scene
from tests.consistency.test_table2 import REFERENCE

SHORT = ("removal.duration=70 min", "removal.macro_step=2 min")
"""Long enough for five tugs."""


def measured(folder: Path) -> commands.Done:
    """With the scene's scheme alone: the others would be compiled for these tests."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(build, "numerics", lambda model: ())
        patch.setattr(build, "details", lambda model: ())
        return commands.accuracy("table2-deorbit", folder, Progress(), SHORT, runs=2)


@pytest.fixture(scope="module")
def done(tmp_path_factory: pytest.TempPathFactory) -> commands.Done:
    return measured(tmp_path_factory.mktemp("accuracy") / "out")


def test_what_it_leaves(done: commands.Done) -> None:
    names = {p.name for p in done.folder.iterdir()}
    assert names == {
        *("provenance.json", "rows", "scene.toml", "study.json", "summary.json", "report.html"),
        *("table.csv", "table.parquet", "removal_accuracy.png"),
    }
    assert done.exit_code == 0
    table = pd.read_parquet(done.folder / "table.parquet")
    assert {"tug_times", "tug_peaks", "mean_tension", "semi_major_axis", "separation"} <= set(table.quantity)
    assert (table.cpu > 0.0).all()
    page = (done.folder / "report.html").read_text()
    assert "dcone accuracy table2-deorbit --set &#39;removal.duration=70 min&#39;" in page.replace("&#34;", "&#39;")
    assert "http" not in re.sub(r"base64,[^\"]*", "", page)
    summary = json.loads((done.folder / "summary.json").read_text())
    assert any("for 1 % use" in line for line in summary["phases"]["removal"]["sentences"])


def test_errors_are_those_against_quadruple_precision(done: commands.Done) -> None:
    """The coarsest setting's error of tug times and peaks, from the reference integration of `test_table2`."""
    report = done.reports[0]
    coarse = report.numerics.points[0]
    tugs = np.array(REFERENCE["B"][1])
    between = tugs[-1, 0] / len(tugs)
    for key, column, sizes in (("tug_times", 0, between), ("tug_peaks", 2, tugs[:, 2])):
        mine, exact = coarse.sample.means[key], tugs[:, column]
        independent = (np.abs(mine - exact) / sizes).max()
        assert coarse.errors[key] == pytest.approx(independent, rel=0.02, abs=1e-9)
        assert coarse.errors[key] > 1e-8
        reference = np.array(report.numerics.points[-1].sample.means[key])
        np.testing.assert_allclose(reference, exact, rtol=1e-9)


def test_the_same_command_goes_on(done: commands.Done) -> None:
    before = (done.folder / "table.parquet").read_bytes()
    assert (measured(done.folder).folder / "table.parquet").read_bytes() == before


def test_an_fmu_from_elsewhere_has_its_macro_step(tmp_path: Path, template: Path) -> None:
    scene = put_scene(tmp_path, template)
    done = commands.accuracy(str(scene), tmp_path / "out", Progress(), quick=True)
    (report,) = done.reports
    assert [axis.name for axis in report.axes] == [MACRO_STEP]
    assert "separation" in report.quantities


def test_a_coupled_phase_has_its_coupling_step() -> None:
    notes: list[str] = []
    phase = Alone("reel-control", (), None).scene.phases[0]
    found = settings_of(phase, True, notes)
    assert {s.axis for s in found} == {NUMERICS, MACRO_STEP, COUPLING}
    assert {s.family for s in found if s.axis == NUMERICS and not s.detail} == {"dop853", "gauss", "radau"}
    steps = {s.size: s.changes for s in found if s.axis == COUPLING}
    assert steps[0.5] == ("removal.coupling.step=1 s",)
    assert steps[1.0] == ()
    assert 100.0 not in steps


def test_a_tow_is_tried_in_other_levels_of_detail(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each at its own bounds, the finest at none; and none of them where the scene's checks refuse it, said once."""
    found = settings_of(Alone("table2-deorbit", (), None).scene.phases[0], True, [])
    levels = {s.family for s in found if s.detail}
    assert levels == {"dop853, settled", "dop853, event_map", "dop853, averaged"}
    finest = min((s for s in found if s.family == "dop853, event_map"), key=lambda s: s.size)
    assert finest.changes[0] == 'removal.level.detail="event_map"'
    assert "removal.level.peak_error=0" in finest.changes
    monkeypatch.setattr(alone.Fmus, "of", lambda *_: {})
    planned = plan(Alone("reel-control", (), None), "removal", Effort(repeats=1), Progress())
    assert not any(one.setting.detail for one in planned.settings)
    refused = [note for note in planned.notes if "event_map" in note]
    assert refused == [
        'removal: dop853, event_map is left out: --set removal.level.detail="event_map": removal.level.detail = '
        '"event_map": a line settles with reel.law = locked alone; leave the table out, or take that'
    ]


def test_a_net_is_tried_in_what_goes_together() -> None:
    notes: list[str] = []
    phase = Alone("mission", (), None).scene.phases[0]
    found = settings_of(phase, True, notes)
    families = {s.family for s in found if s.axis == NUMERICS}
    assert families >= {"leapfrog, double", "leapfrog, single"}
    assert "rk4, double" not in families
    assert any("rk4 is not for this scene" in note for note in notes)
    pieces = next(s for s in found if s.axis == "pieces of a thread" and s.size == 0.5)
    assert "capture.net.segments=2" in pieces.changes
    # outputs for its nodes follow: 25 x 25 knots and a node in each of 1200 threads
    assert "capture.nodes.capacity=1825" in pieces.changes


def test_a_handed_over_phase_begins_as_in_the_run(mission: RunResult, monkeypatch: pytest.MonkeyPatch) -> None:
    """The removal of `mission` by itself is the removal of the mission, to the last bit."""
    single = Alone("mission", MISSION, None)
    monkeypatch.setattr(alone, "run_scene", lambda *_: mission)
    single.begin(Progress())
    planned = Planned(Setting("", "as it is", 1.0, ()))
    (case,) = Planner(single, "removal", Progress()).cases(planned, 1).values()
    row = measure(case)
    tugs = mission.phases["removal"].tugs
    assert tugs is not None
    times, peaks, _ = zip(*(tugs.rows[n] for n in sorted(tugs.rows)), strict=True)
    assert row.samples["tug_times"]["values"] == list(times[:5])
    assert row.samples["tug_peaks"]["values"] == list(peaks[:5])
    assert times[0] == pytest.approx(222.7, abs=1.0)


@pytest.mark.parametrize("runs", [1, 0, -3, 5000])
def test_runs_out_of_bounds_are_refused(runs: int, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="--runs"):
        commands.accuracy("table2-deorbit", tmp_path / "out", Progress(), runs=runs)
    assert not (tmp_path / "out").exists()


def test_a_misspelt_key_leaves_nothing(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"tether\.rest_lenght"):
        commands.accuracy("table2-deorbit", tmp_path / "out", Progress(), ("removal.tether.rest_lenght=1 m",))
    assert not (tmp_path / "out").exists()
