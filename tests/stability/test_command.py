"""`dcone stability` as a user runs it: what it leaves, what is refused, and that a fault turns it red."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pandas as pd
import pytest

from dcone_cosim import build
from dcone_cosim.cases.alone import Alone, Fmus
from dcone_cosim.criteria import Criterion
from dcone_cosim.errors import InputError
from dcone_cosim.progress import Progress
from dcone_cosim.stability import commands
from dcone_cosim.stability.judge import ACCURATE, EXCLUDED, LEFT, REFUSED, STABLE, Verdict
from dcone_cosim.stability.plan import AS_IT_IS, plan
from dcone_cosim.stability.show import Cell, Matrix, by_extreme
from dcone_cosim.stability.work import judge_cell
from tests.cases.conftest import put_scene, template

__all__ = ["template"]

SHORT = ("removal.duration=70 min",)
"""Long enough for five tugs."""


def tried(folder: Path) -> commands.Done:
    """With the scene's scheme alone: the others would be compiled for these tests."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(build, "numerics", lambda model: ())
        return commands.stability("table2-deorbit", folder, Progress(), SHORT, quick=True)


@pytest.fixture(scope="module")
def done(tmp_path_factory: pytest.TempPathFactory) -> commands.Done:
    return tried(tmp_path_factory.mktemp("stability") / "out")


def test_what_it_leaves(done: commands.Done) -> None:
    assert {p.name for p in done.folder.iterdir()} == {
        *("provenance.json", "rows", "scene.toml", "study.json", "summary.json", "report.html"),
        *("table.csv", "table.parquet", "table2-deorbit_removal_stability.png"),
    }
    assert done.exit_code == 0
    table = pd.read_parquet(done.folder / "table.parquet")
    assert {"as it is", "eccentricity 0.9", "line of 20000 m"} <= set(table.extreme)
    assert {"finite", "snap", "orbit", "longer", "agrees", "jacobi", "jacobi_falls"} <= set(table.criterion)
    assert (table.value <= table.stable_up_to).all()
    page = (done.folder / "report.html").read_text()
    assert "dcone stability table2-deorbit --set" in page
    assert "http" not in re.sub(r"base64,[^\"]*", "", page)
    told = json.loads((done.folder / "summary.json").read_text())["phases"]["table2-deorbit.removal"]
    assert told["counts"]["failed"] == 0
    assert told["refused"]["its own"]["refused"] == 0


def test_the_same_command_goes_on(done: commands.Done) -> None:
    before = (done.folder / "table.csv").read_bytes()
    tried(done.folder)
    assert (done.folder / "table.csv").read_bytes() == before


def test_what_cannot_be_is_refused_with_the_reason(tmp_path: Path) -> None:
    """Before any step: by the cost, by the scene, and by the FMU itself."""
    cells = _cells("table2-deorbit", (*SHORT, "removal.macro_step=10 min"), 1e-3)
    dear, cost, _ = judge_cell(cells["ten years"])
    assert dear.kind == REFUSED
    assert cost is not None
    assert cost.cpu > 1.0
    assert re.match(r"too long: about .* \(.* steps of .* us\), and 0 s are allowed", dear.text)
    none, _, _ = judge_cell(cells["coincident bodies"])
    assert none.kind == REFUSED
    assert "start.relative_position is zero" in none.text


def test_what_would_take_long_is_left_out_of_a_quick_look() -> None:
    alone = Alone("table2-deorbit", (*SHORT, "removal.macro_step=10 min"), None)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(build, "numerics", lambda model: ())
        found = plan(alone, "removal", Fmus(Progress()), 1e-6, True)
    case = next(cell.case for cell in found.cells if cell.case is not None)
    dear, _, spent = judge_cell(case)
    assert (dear.kind, dear.red, spent) == (LEFT, False, 0.0)
    assert dear.text.startswith("not in a quick look: it would take about")


def _cells(name: str, settings: tuple[str, ...], limit: float) -> dict[str, object]:
    alone = Alone(name, settings, None)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(build, "numerics", lambda model: ())
        found = plan(alone, alone.phases[0], Fmus(Progress()), limit, False)
    return {cell.extreme.name: cell.case for cell in found.cells}


def test_every_scheme_of_a_net_meets_every_extreme_of_its_parts() -> None:
    alone = Alone("table1-capture", (), None)
    own = alone.scene.phases[0]
    extremes = build.extremes(own.main.model, own.main.terms)
    names = [one.name for one in extremes]
    assert len(set(names)) == len(names)
    assert {"restitution 1", "spin of 60 deg/s", "cord 10000 times as stiff", "net of 10 mg"} <= set(names)
    assert "slack of a folded net wound on a stiff cord" in names
    assert {"macro steps of 1e-06 s", "macro steps of 100 s"} <= set(names)


def test_a_part_that_is_left_out_takes_its_extremes_with_it() -> None:
    from dcone_cosim.stability.plan import _schemes

    schemes = {one.name: one for one in _schemes(Alone("table1-capture", (), None).scene.phases[0])}
    assert next(iter(schemes)) == "leapfrog, double"
    assert {"leapfrog, single", "rk4, double", "rk4, single"} <= set(schemes)
    assert not schemes["leapfrog, double"].lacks
    assert set(schemes["rk4, double"].without) == {"contact", "closing"}
    assert {"restitution 1", "closing at the first instant", "net of 10 mg"} <= set(schemes["rk4, double"].lacks)
    assert "all slack" not in schemes["rk4, double"].lacks
    assert EXCLUDED == "excluded"


def test_what_a_part_of_the_scene_does_not_go_together_with_is_no_case() -> None:
    """Contact by penalty asks for double precision: single is no failure of a scheme, and without contact it is one."""
    from dcone_cosim.stability.plan import _Maker, _schemes

    alone = Alone("table1-capture", ('capture.contact.law="penalty"',), None)
    schemes = {one.name: one for one in _schemes(alone.scene.phases[0])}
    maker = _Maker(alone, "capture", (), Fmus(Progress()), 1.0, True)
    why = maker._unsuited(schemes["leapfrog, single"])
    assert 'must be "double" with contact by penalty' in why
    assert [maker._unsuited(schemes[name]) for name in ("leapfrog, double", "rk4, double", "rk4, single")] == [""] * 3
    verdict = maker.draft(AS_IT_IS, schemes["leapfrog, single"]).found
    assert verdict is not None
    assert (verdict.kind, verdict.text) == (EXCLUDED, why)


def test_what_a_scene_does_not_say_is_no_extreme() -> None:
    """The mass of a target of several pieces is the sum of theirs."""
    from dcone_cosim.stability.plan import _Maker, _schemes

    alone = Alone("upper-stage", ('phases=["capture"]',), None)
    own = alone.scene.phases[0]
    light = next(one for one in build.extremes(own.main.model, own.main.terms) if one.name == "target of 1 kg")
    maker = _Maker(alone, "capture", (), Fmus(Progress()), 1.0, True)
    assert maker._made(light, next(_schemes(own)))[0] is None


def test_what_needs_a_part_that_an_extreme_goes_without_is_left_out_too() -> None:
    """A net without a closing cord is not pulled once it is closed."""
    from dcone_cosim.stability.plan import _Maker, _schemes

    alone = Alone("pull-off", (), None)
    own = alone.scene.phases[0]
    slack = next(one for one in build.extremes(own.main.model, own.main.terms) if one.name == "no slack")
    assert slack.terms["closing"] is None
    made, _, without = _Maker(alone, "capture", (), Fmus(Progress()), 1.0, True)._made(slack, next(_schemes(own)))
    assert made is not None
    assert {"closing", "pull_off"} <= set(without)
    assert not {"closing", "pull_off"} & set(made.phases[0].main.terms)


def test_a_scheme_that_cannot_follow_the_net_is_tried_at_substeps_of_one_length() -> None:
    """A scene of following substeps is one of every scheme: none is refused for the pace of another."""
    from dcone_cosim.stability.plan import _schemes

    alone = Alone("deployment", ('capture.solver.substeps="following"',), None)
    schemes = {one.name: one for one in _schemes(alone.scene.phases[0])}
    assert next(iter(schemes)) == "leapfrog, double, following"
    assert {"rk4, single, following", "ros2, double", "xpbd, double"} <= set(schemes)
    for name, scheme in schemes.items():
        made = alone.scene_of("capture", scheme.changes, scheme.without).phases[0].main.terms
        assert made["substeps"] == ("following" if name.endswith("following") else "fixed"), name
    usual = {one.name for one in _schemes(Alone("deployment", (), None).scene.phases[0])}
    assert {"leapfrog, double", "ros2, double"} <= usual


def test_a_case_shorter_than_a_macro_step_takes_a_shorter_one() -> None:
    """It is no refusal of a scheme that the scene looks at its net less often."""
    from dcone_cosim.stability.plan import Scheme, _Maker

    settings = ("capture.macro_step=0.05 s",)
    maker = _Maker(Alone("deployment", settings, None), "capture", settings, Fmus(Progress()), 1.0, False)
    extremes = {one.name: one for one in build.extremes("net_capture", {"net": "square"})}
    draft = maker.draft(extremes["taut from the start, damping ratio 0.5"], Scheme("x"))
    (own,) = draft.made.phases  # type: ignore[union-attr]
    assert (own.macro_step, own.duration) == (0.02, 0.02)
    (longer,) = maker.draft(extremes["threads 1e+06 times as stiff"], Scheme("x")).made.phases  # type: ignore[union-attr]
    assert (longer.macro_step, longer.duration) == (0.05, 1.0)


def test_a_phase_that_hands_over_is_flown_to_its_end() -> None:
    """Without the phase after it, which would ask for a hand-over."""
    from dcone_cosim.phases import kind_of

    settings = tuple(f"capture.{one}" for one in kind_of("capture").to_its_end)
    alone = Alone("mission", (), None)
    (own,) = alone.scene_of("capture", settings, to_its_end=True).phases
    assert own.options.hand_over == "none"
    whole = alone.scene_of("capture").phases[0]
    assert own.main.parameters == whole.main.parameters
    assert own.main.terms == whole.main.terms


def test_what_a_phase_takes_over_is_no_extreme_of_it() -> None:
    from dcone_cosim.stability.plan import Scheme, _Maker

    extreme = next(one for one in build.extremes("tethered_deorbit", {"reel": "locked"}) if one.name == "line of 100 m")
    found = _Maker(Alone("mission", (), None), "removal", (), Fmus(Progress()), 1.0, False).draft(extreme, Scheme("x"))
    assert found.found is not None  # type: ignore[union-attr]
    assert found.found.kind == EXCLUDED  # type: ignore[union-attr]
    assert "start.separation" in found.found.text  # type: ignore[union-attr]


def test_an_fmu_from_elsewhere_has_its_macro_steps(tmp_path: Path, template: Path) -> None:
    scene = put_scene(tmp_path, template)
    done = commands.stability(str(scene), tmp_path / "out", Progress())
    (one,) = done.matrices
    assert next(extreme.name for extreme in one.plan.extremes) == "as it is"
    assert any(extreme.name.startswith("macro step x") for extreme in one.plan.extremes)
    assert {cell.verdict.kind for cell in one.cells} == {ACCURATE}


@pytest.mark.parametrize(("option", "value"), [("limit", 0.0), ("budget", -1.0), ("limit", float("nan"))])
def test_times_out_of_bounds_are_refused(option: str, value: float, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=f"--{option}"):
        commands.stability("table2-deorbit", tmp_path / "out", Progress(), **{option: value})  # type: ignore[arg-type]
    assert not (tmp_path / "out").exists()


def test_a_tow_without_a_field_is_asked_for_what_there_is(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing moves without thrust; a long line begins with the scene's own slack, which the push takes up, not
    a sixth of its length; what is asked above all is told as it is asked there, in words."""
    monkeypatch.setattr(Fmus, "of", lambda *_: {})
    monkeypatch.setattr(Fmus, "make_ready", lambda *_: None)
    monkeypatch.setattr(build, "numerics", lambda _: ())
    planned = plan(Alone("friction-table", (), None), "removal", Fmus(Progress()), 20.0, False)
    cells = {one.extreme.name: one for one in planned.cells}
    for name in ("undamped without thrust", "damped without thrust", "ten years", "ten years on a soft line"):
        found = cells[name].found
        assert found is not None
        assert (found.kind, found.text) == (EXCLUDED, 'goes without anything that moves: environment = "none"')
    orbit = Alone("table2-deorbit", (), None).scene.phases[0].main.values
    for length in (1.0, 100.0, 20e3):
        one = cells[f"line of {length:g} m"]
        assert one.case is not None
        begun = one.case.scene.phases[0].main.parameters["start.separation"]
        assert begun == pytest.approx(length - 0.1)  # 1.9 m on 2 m of line
        assert one.extreme.given(orbit)["start.separation"] == 5.0 / 6.0 * length
    nearest = cells["bodies a nanometre apart"].case
    assert nearest is not None
    assert "ends" not in nearest.scene.phases[0].main.terms
    label = "energy of the pair above the work done on it"
    work = Verdict(STABLE, "", [Criterion("work", label, 0.0, "1", 1e-3, 1e-2)])
    matrix = Matrix(planned, [Cell(c, work if c.asked == "work" else Verdict(STABLE, "")) for c in planned.cells])
    about = {extreme.name: matrix.about(own) for extreme, own in by_extreme(matrix)}
    assert about["thrust of 1 N"] == label
    assert about["line of 100 m"] == "longer"  # no run told it in words
