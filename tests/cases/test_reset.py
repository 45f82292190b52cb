"""FMUs stay loaded and are reset between cases, and no case can tell: the same bits as of new ones."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from dcone_cosim import build as models
from dcone_cosim.cases.case import Case
from dcone_cosim.cases.rows import Row
from dcone_cosim.cases.work import Fleet
from dcone_cosim.errors import FmuError
from dcone_cosim.fmu.archive import Archive
from dcone_cosim.fmu.component import CallError, Component
from dcone_cosim.fmu.isolation import IsolatedComponent
from dcone_cosim.fmu.shelf import Shelf
from dcone_cosim.loading import load
from dcone_cosim.master import run_scene
from dcone_cosim.progress import Progress
from dcone_cosim.scene_fmus import SceneFmus, fmus_of
from tests.cases.conftest import SCENE, put_scene
from tests.cosim.fmus import build as template_fmus
from tests.cosim.fmus.build import build

KINDS = [Component, IsolatedComponent]
Make = Callable[[Archive, str], Any]
LENGTH, RATE = "length", "length_rate"


@pytest.fixture(scope="module")
def controller() -> Path:
    """The reel control, whose motor is a state: the smallest of our FMUs."""
    return models.ensure([("reel_control", {"motor": "lag"})], lambda _: None)[0]


def driven(component: Any, start: float = 5.0) -> np.ndarray:
    """What it puts out from this time on with inputs that move; the component is left in the midst of it."""
    component.set({"motor.time_constant": 3.0, LENGTH: 12.5})
    component.initialise(start, start + 100.0)
    names = [v.name for v in component.variables.values() if v.causality == "output"]
    read = component.reader(names)
    rows = [read().copy()]
    for i in range(20):
        component.set({LENGTH: 12.5 + 0.01 * i, RATE: 1e-3})
        component.save("one")
        component.step(start + i, 1.0)
        rows.append(read().copy())
    return np.array(rows)


@pytest.mark.parametrize("kind", KINDS)
def test_a_reset_instance_is_a_fresh_one_bit_for_bit(controller: Path, kind: Make) -> None:
    with Archive(controller) as archive:
        with kind(archive, "fresh") as fresh:
            expected = driven(fresh)
        with kind(archive, "used") as used:
            used.set({"reel.length": 11.0, "motor.time_constant": 0.5, LENGTH: 14.0})
            used.initialise(0.0)
            other = used.reader([LENGTH])
            used.step(0.0, 0.7)
            other()
            used.save("kept")
            used.reset()
            assert used.time == 0.0
            np.testing.assert_array_equal(driven(used), expected)
            used.step(25.0, 1.0)
            assert not np.array_equal(driven_again(used), expected), "the twin: without a reset it goes on"
    assert expected.std(axis=0).max() > 1e-4, "and something moves"


def driven_again(component: Any) -> np.ndarray:
    read = component.reader(["tension"])
    return np.array([read().copy() for _ in range(21)])


@pytest.mark.parametrize("kind", KINDS)
def test_a_reset_forgets_the_states_that_were_kept(controller: Path, kind: Make) -> None:
    with Archive(controller) as archive, kind(archive, "used") as used:
        used.initialise(0.0)
        used.save("kept")
        used.reset()
        used.initialise(0.0)
        with pytest.raises((KeyError, FmuError)):
            used.restore("kept")


RESETS = "    take_start_values(c);\n    return fmi2OK;\n}\n\nfmi2Status fmi2DoStep"
KEEPS = "    ((instance *)c)->phase = INSTANTIATED;\n    return fmi2OK;\n}\n\nfmi2Status fmi2DoStep"
DENIES = '    return refuse(c, "it is never reset");\n}\n\nfmi2Status fmi2DoStep'


@pytest.fixture
def spoilt(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Callable[[str], Path]:
    """The template's removal with another body of fmi2Reset."""

    def make(body: str) -> Path:
        switch = "RESET_" + re.sub(r"\W", "", body)[:12]
        monkeypatch.setitem(template_fmus.SHIM, switch, [(RESETS, body)])
        return build(tmp_path / switch, "removal", switch)

    return make


@pytest.mark.parametrize("kind", KINDS)
def test_a_refusal_is_an_error(spoilt: Callable[[str], Path], kind: Make) -> None:
    with Archive(spoilt(DENIES)) as archive, kind(archive, "stubborn") as stubborn:
        stubborn.initialise(0.0)
        with pytest.raises(CallError, match="it is never reset"):
            stubborn.reset()


@pytest.mark.parametrize("apart", [False, True])
def test_the_shelf_resets_what_it_can_and_makes_what_it_must(
    template: Path, spoilt: Callable[[str], Path], apart: bool
) -> None:
    for fmu, made, reused in ((template, 2, 2), (spoilt(DENIES), 4, 0)):
        shelf = Shelf()
        with Archive(fmu) as archive:
            for _ in range(2):
                both = [shelf.take(archive, "towing", apart, 20.0) for _ in range(2)]
                for instance in both:
                    instance.initialise(0.0)
                for instance in both:
                    instance.close()
                    instance.close()
            assert (shelf.made, shelf.reused) == (made, reused)
            shelf.clear()


def cases_of(scene: Path, *speeds: float) -> list[Case]:
    changes = [f'removal.start.relative_velocity=["0 m/s","{speed} m/s","0 m/s"]' for speed in speeds]
    return [Case(str(i), load(str(scene), [change])) for i, change in enumerate(changes)]


def plain(case: Case) -> dict[str, Any]:
    """Last outputs of the case run by itself, as `dcone run` does."""
    with SceneFmus(case.scene, Progress()) as fmus:
        return run_scene(case.scene, fmus.instantiate, Progress()).phases["removal"].recorder.last()


def separations(rows: list[Row]) -> list[Any]:
    return [row.figures["removal.separation"] for row in rows]


@pytest.mark.parametrize("isolate", ["false", "true"])
def test_a_fleet_gives_what_runs_by_themselves_give(drift: Path, isolate: str) -> None:
    drift.write_text(drift.read_text().replace("isolate = false", f"isolate = {isolate}"))
    cases, fleet = cases_of(drift, 0.001, 0.002, 0.003, 0.004), Fleet()
    rows = [fleet.row(case) for case in cases]
    assert [row.status for row in rows] == ["completed"] * 4, rows[0].message
    assert separations(rows) == [plain(case)["separation"] for case in cases]
    assert len(set(separations(rows))) == 4
    assert (fleet.shelf.made, fleet.shelf.reused) == (2, 3), "the second case was run with a new one too, to compare"
    assert rows[0].timings["cpu"] >= 0.0
    fleet.close()


def test_coupled_fmus_of_ours_are_reset_too() -> None:
    """A removal and the law of its reel: three cases with one pair of instances, as if each had been alone."""
    lengths = ("12 m", "12.5 m", "12 m")
    scenes = [
        load("reel-control", ["removal.duration=10 min", f"removal.components.controller.reel.length={length}"])
        for length in lengths
    ]
    cases, fleet = [Case(str(i), scene) for i, scene in enumerate(scenes)], Fleet()
    rows = [fleet.row(case) for case in cases]
    fresh = [Fleet(new=True).row(case) for case in cases]
    assert [row.figures for row in rows] == [row.figures for row in fresh]
    assert rows[0].figures == rows[2].figures != rows[1].figures
    assert (fleet.shelf.made, fleet.shelf.reused) == (2, 4)
    fleet.close()


def test_a_reset_that_leaves_something_behind_is_found_out(spoilt: Callable[[str], Path], tmp_path: Path) -> None:
    """It says that all is well, and the next case would have values of the case before where it gives none itself."""
    text = re.sub(r"relative_velocity = .*", "", SCENE)
    scene = str(put_scene(tmp_path / "scene", spoilt(KEEPS), text))
    changes = ['removal.start.relative_velocity=["0 m/s","1 m/s","0 m/s"]']
    changes += [f"removal.chaser.mass={2000 + i} kg" for i in range(3)]
    first, *others = [Case(str(i), load(scene, [change])) for i, change in enumerate(changes)]
    fleet, trusting = Fleet(), Fleet()
    fleet.row(first)
    rows = [fleet.row(case) for case in others]
    assert separations(rows) == [plain(case)["separation"] for case in others]
    assert fleet.new
    assert fleet.shelf.reused == 1, "once, and never again"
    trusting.row(first)
    trusting._proved = True
    assert separations([trusting.row(others[0])]) != separations(rows[:1]), "the twin: trusted, it is wrong"
    fleet.close()
    trusting.close()


def test_other_fmus_are_loaded_in_their_place(drift: Path, template: Path, tmp_path: Path) -> None:
    elsewhere = put_scene(tmp_path / "elsewhere", template)
    fleet = Fleet()
    (here,), (there,) = cases_of(drift, 0.001), cases_of(elsewhere, 0.001)
    assert fmus_of(here.scene) != fmus_of(there.scene)
    assert fleet.row(here).figures == fleet.row(there).figures
    assert (fleet.shelf.made, fleet.shelf.reused) == (2, 0)
    fleet.close()


def test_failures_are_rows(drift: Path, tmp_path: Path) -> None:
    """An FMU that fails, one that refuses its values, and one that is gone; the next case is not touched by it."""
    fleet = Fleet()
    (good,) = cases_of(drift, 0.001)
    failing = put_scene(tmp_path / "failing", build(tmp_path / "a", "removal", "ERROR"))
    refusing = put_scene(tmp_path / "refusing", build(tmp_path / "b", "removal", "REFUSES"))
    gone = put_scene(tmp_path / "gone", drift.with_name("my_removal.fmu"))
    (lost,) = cases_of(gone, 0.001)
    (gone.parent / "my_removal.fmu").unlink()
    rows = [fleet.row(case) for case in (*cases_of(failing, 0.001), *cases_of(refusing, 0.001), lost, good)]
    assert [(row.status, row.exit_code) for row in rows] == [
        ("FMU failed", 5), ("refused", 2), ("FMU failed", 5), ("completed", 0),
    ]  # fmt: skip
    assert "tether.rest_length does not suit me" in rows[1].message
    assert "no such file" in rows[2].message
    fleet.close()


def test_a_fault_of_ours_is_a_row_too(drift: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def fault(*_: object, **__: object) -> None:
        raise ZeroDivisionError("of all things")

    monkeypatch.setattr("dcone_cosim.cases.work.run_scene", fault)
    fleet = Fleet()
    row = fleet.row(cases_of(drift, 0.001)[0])
    assert (row.status, row.exit_code, row.lasting) == ("fault", 1, False)
    assert "ZeroDivisionError: of all things" in row.message
    fleet.close()
