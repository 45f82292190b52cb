"""A scene's accuracy: what is chosen for it, and what runs come to that have one."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from dcone_cosim import measured
from dcone_cosim.accuracy import attain as attaining
from dcone_cosim.accuracy.plan import Planned, Planner
from dcone_cosim.accuracy.settings import Setting, settings_of
from dcone_cosim.accuracy.work import measure
from dcone_cosim.cases.alone import Alone
from dcone_cosim.commands import run_and_write
from dcone_cosim.errors import InputError
from dcone_cosim.loading import load
from dcone_cosim.measured import Entry
from dcone_cosim.phases import kind_of
from dcone_cosim.progress import Progress
from dcone_cosim.reports import summary
from dcone_cosim.results import RunResult
from dcone_cosim.scene.data import Accuracy
from dcone_cosim.scene.mistakes import SceneError
from fmu_src.tethered_deorbit.trade import FACTORS
from tests.consistency.test_table2 import REFERENCE

LEAPFROG = {"solver": "leapfrog", "precision": "double"}
SINGLE = LEAPFROG | {"precision": "single"}
ENTRIES = (
    Entry(LEAPFROG, 3.0, {"mouth_area": 0.02, "t80": 0.003}, 0.34),
    Entry(LEAPFROG, 2.0, {"mouth_area": 0.008, "t80": 0.002}, 0.51),
    Entry(LEAPFROG, 1.0, {"mouth_area": 0.002, "t80": 0.001}, 1.0),
    Entry(LEAPFROG, 0.5, {"mouth_area": 0.0004, "t80": 0.0002}, 2.0),
    Entry(SINGLE, 1.0, {"mouth_area": 0.003, "t80": 0.001}, 0.68),
)
"""Of a net that was never measured: errors that fall with the square of the step."""


@pytest.fixture
def entries(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(measured, "table", lambda model: ENTRIES if model == "net_capture" else ())


def step_ratio(*settings: str) -> tuple[float, str]:
    """What a deployment is computed with: its ratio over that at the default step, and its precision."""
    main = load("deployment", settings).phases[0].main
    plain = load("deployment").phases[0]
    from dcone_cosim import build

    values = {**plain.main.defaults, **plain.main.parameters}
    default = next(r for r in build.rungs("net_capture", values, plain.main.terms) if r.size == 1.0)
    return main.parameters["solver.step_ratio"] / default.values["solver.step_ratio"], main.terms["precision"]


@pytest.mark.parametrize(
    ("settings", "size", "precision"),
    [
        (["solver.accuracy=1 %"], 2.0, "double"),  # the single one is dearer
        (["solver.accuracy=0.5 %"], 1.0, "single"),
        (["solver.accuracy=0.25 %"], 1.0, "double"),
        (["solver.accuracy=0.1 %"], 0.5, "double"),
        (["solver.accuracy=0.005"], 1.0, "single"),
        (["solver.accuracy=0.5 %", 'capture.solver.precision="double"'], 1.0, "double"),  # the scene says so
        (["solver.accuracy=0.5 %", 'solver.quantities=["t80"]'], 2.0, "double"),  # three times is not stable here
        (["solver.accuracy=0.001 %"], 0.5, "double"),  # nothing is: the nearest, and the run will say
    ],
)
@pytest.mark.usefixtures("entries")
def test_the_cheapest_that_is_exact_enough_is_chosen(settings: list[str], size: float, precision: str) -> None:
    found = step_ratio(*settings)
    assert found[0] == pytest.approx(size, rel=1e-5)
    assert found[1] == precision


@pytest.mark.usefixtures("entries")
def test_a_scene_says_what_was_chosen_and_what_is_known_of_it() -> None:
    scene = load("deployment", ["solver.accuracy=1 %"])
    chosen = scene.phases[0].chosen
    assert chosen is not None
    assert chosen.label == "leapfrog, double x 2"
    assert chosen.error == 0.008
    assert scene.accuracy == Accuracy(0.01)
    assert load("deployment").accuracy is None


@pytest.mark.parametrize(
    ("scene", "settings", "unfit"),
    [
        ("lumped-tether", [], "radau"),
        ("big-panel-wrapped", [], "single"),
        ("pull-off", ['capture.contact.law="penalty"'], "single"),
    ],
)
def test_nothing_is_chosen_that_a_part_of_the_scene_refuses(
    monkeypatch: pytest.MonkeyPatch, scene: str, settings: list[str], unfit: str
) -> None:
    """A line of nodes goes with dop853, bent threads and springs at the surface with 53 bits; the usual is cheaper."""
    tow = (Entry({"solver": "radau"}, 1e6, {"tug_peaks": 1e-3}, 0.5), Entry({"solver": "dop853"}, 1e6, {}, 1.0))
    table = measured.table
    monkeypatch.setattr(measured, "table", lambda model: tow if model == "tethered_deorbit" else table(model))
    found = load(scene, [*settings, "solver.accuracy=1 %"]).phases[0].chosen
    usual = load("table2-deorbit" if unfit == "radau" else "failed-missed", ["solver.accuracy=1 %"]).phases[0].chosen
    assert found is not None
    assert usual is not None
    assert unfit in usual.label
    assert unfit not in found.label


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        (["solver.accuracy=1 %", "capture.solver.step_ratio=0.3"], "is chosen by solver.accuracy"),
        (["solver.accuracy=1 %", 'solver.quantities=["mouth_aera"]'], "did you mean 'mouth_area'"),
        (["solver.accuracy=1 %", 'solver.quantities=["tug_times"]'], "no phase of this scene is judged by it"),
        (["solver.accuracy=0 %"], "must be greater than 0"),
        (["solver.accuracy=60 %"], "must be at most"),
        (["solver.accuracy=1 mm"], "expected a share"),
        (["solver.acuracy=1 %"], "did you mean 'accuracy'"),
        (["solver.runs=4"], "solver.accuracy missing"),
        (["solver.accuracy=1 %", "solver.runs=0"], "must be at least 1"),
        (['capture.solver.accuracy="1 %"'], "is that of all phases: write it under [solver]"),
    ],
)
@pytest.mark.usefixtures("entries")
def test_what_cannot_be_asked_is_told(settings: list[str], said: str) -> None:
    with pytest.raises(SceneError) as caught:
        load("deployment", settings)
    assert said in str(caught.value)


def test_a_tow_is_as_exact_as_asked(tmp_path: Path) -> None:
    """And as exact as it says: against quadruple precision."""
    settings = ("removal.duration=70 min", "removal.macro_step=2 min", "solver.accuracy=0.1 %")
    written = run_and_write("table2-deorbit", tmp_path / "out", Progress(), False, False, settings=settings)
    attained = written.result.attained["removal"]
    assert attained.error <= 0.001
    assert written.result.phases["removal"].tugs is not None
    rows = written.result.phases["removal"].tugs.rows
    tugs = np.array([rows[n] for n in sorted(rows)][:5])
    exact = np.array(REFERENCE["B"][1])
    assert np.abs(tugs[:, 0] / exact[:, 0] - 1.0).max() <= attained.error
    assert np.abs(tugs[:, 1] / exact[:, 2] - 1.0).max() <= max(attained.error, 1e-8)
    told = summary.as_dict(written.result)["removal"]
    assert told["accuracy.asked"]["value"] == 0.001
    assert told["accuracy.error"]["value"] == pytest.approx(attained.error, rel=0.05)
    assert told["accuracy.made"]["value"] == 3
    assert told["accuracy.setting"]["value"].startswith("dop853 x ")
    # the folder runs again to the same
    again = run_and_write(str(tmp_path / "out"), tmp_path / "again", Progress(), False, False)
    assert again.result.attained == written.result.attained


@pytest.mark.evidence
def test_a_tow_that_scatters_in_no_way_needs_one_run_of_each_and_a_twin() -> None:
    settings = ["removal.duration=30 min", "solver.accuracy=1 %"]
    _, found = attaining.attain("table2-deorbit", settings, load("table2-deorbit", settings), None, Progress())
    assert found["removal"].made == 3
    assert found["removal"].scatter == 0.0


@pytest.mark.evidence
def test_a_tow_whose_twin_parts_from_it_is_met_as_a_mean_or_refused() -> None:
    """On a winch the mean tension of a day scatters by a few permille at any tolerance; the first tugs do not."""
    settings = ["solver.accuracy=0.5 %"]
    with pytest.raises(InputError, match="mean tension scatters by"):
        attaining.attain("reel-damped", settings, load("reel-damped", settings), None, Progress())
    settings.append('solver.quantities=["tug_times", "tug_peaks"]')
    _, found = attaining.attain("reel-damped", settings, load("reel-damped", settings), None, Progress())
    assert found["removal"].scatter < 1e-4
    assert found["removal"].error <= 0.005


def test_quantities_of_every_phase_are_those_that_can_be_asked_for(mission: RunResult) -> None:
    """What a run is judged by has the names that a scene may ask for."""
    for name, result in mission.phases.items():
        keys = {q.key for q in kind_of(name).quantities(mission, result, (1.0, 2.0, 3.0))}
        # "paid_out" is of a winch, "largest_along" of a line with mass, "friction_loss" of a table: not of this tow
        assert keys == set(kind_of(name).judged_by) - {"paid_out", "largest_along", "friction_loss"}


def test_a_capture_is_judged_by_what_its_columns_say(mission: RunResult) -> None:
    """Each from its definition: area of a 12 m net, momentum that the target got, energy of the shot in
    closed form and the work of the reels."""
    result = mission.phases["capture"]
    recorder, last = result.recorder, result.recorder.last()
    instants = recorder["time"][[50, 100, 200, 400]].tolist()
    found = {q.key: q for q in kind_of("capture").quantities(mission, result, instants)}
    assert found["mouth_area"].scale == pytest.approx(12.0**2)
    assert found["mouth_area"].values == recorder["mouth.area"][[50, 100, 200, 400]].tolist()
    assert found["bullets"].scale == pytest.approx(12.0)
    bullets = np.array(found["bullets"].values).reshape(4, 3, 4)
    assert bullets[1, 2].tolist() == recorder["bullet[2].position[3]"][[50, 100, 200, 400]].tolist()
    change = recorder.vector("target.velocity")[-1] - recorder.vector("target.velocity")[0]
    assert found["impulse"].values == [pytest.approx(1000.0 * np.sqrt((change**2).sum()))]
    assert found["t_capture"].values == [last["t_capture"]]
    entered = 4 * 0.5 * 1.27 * 3.0**2 + recorder["closing.work"].max() + np.abs(recorder["tether.work"]).max()
    assert found["energy_book"].scale == pytest.approx(entered, rel=1e-2)


def test_the_table_of_settings_is_as_far_off_as_it_says() -> None:
    """Its errors of a tow's tugs, at two tolerances, against the quadruple-precision ones of one of its scenes."""
    entries = {entry.size: entry for entry in measured.table("tethered_deorbit") if entry.terms == {"solver": "dop853"}}
    assert [size for size in sorted(entries, reverse=True)] == list(FACTORS)
    exact = np.array(REFERENCE["B"][1])
    planner = Planner(Alone("table2-deorbit", ["removal.duration=70 min"], None), "removal", Progress())
    for size in (1e6, 1e4):
        changes = next(s.changes for s in settings_of(planner.own, False, []) if (s.family, s.size) == ("dop853", size))
        (case,) = planner.cases(Planned(Setting("", "", 1.0, changes)), 1).values()
        samples = measure(case).samples
        off = np.abs(np.array(samples["tug_peaks"]["values"]) / exact[:, 2] - 1.0).max()
        told = entries[size].errors["tug_peaks"]
        assert off <= told * 1.05
        assert off > 1e-3 * told
    costs = [entry.cost for entry in measured.table("net_capture") if entry.terms == LEAPFROG and entry.size <= 1.0]
    assert costs == sorted(costs)
    assert entries[1.0].cost == 1.0
