"""A run that stops and goes on leaves the tables of one that never stopped, byte for byte."""

from __future__ import annotations

import json
from pathlib import Path

import pyarrow.parquet
import pytest

from dcone_cosim import interrupts
from dcone_cosim.commands import run_and_write
from dcone_cosim.errors import Interrupted
from dcone_cosim.progress import Progress
from tests.resume.conftest import TUG, Kept
from tests.runs import put, tables


def column(folder: Path, phase: str, name: str, time: float) -> float:
    """An output at the communication point of that time."""
    table = pyarrow.parquet.read_table(folder / f"{phase}.parquet", columns=["time", name])
    (row,) = [i for i, t in enumerate(table["time"].to_pylist()) if abs(t - time) < 1e-6]
    return float(table[name][row].as_py())


def states(folder: Path) -> dict[str, dict[str, float]]:
    told = json.loads((folder / "provenance.json").read_text())["states"]
    return {Path(row["file"]).name: row for row in told}


def ledgers(folder: Path) -> list[bytes]:
    return [path.read_bytes() for path in sorted(folder.glob("ledger*"))]


def test_keeping_a_state_changes_nothing(mission: Kept, tug: Kept, reel: Kept) -> None:
    for run in (mission, tug, reel):
        assert tables(run.folder) == tables(run.whole)


def test_the_states_are_where_they_are_meant_to_be(mission: Kept, tug: Kept) -> None:
    """Before the first touch, with nodes in contact, with a slack line, and within a tug."""
    assert column(mission.folder, "capture", "contact.nodes", 3.0) == 0
    assert column(mission.folder, "capture", "contact.nodes", 7.0) > 0
    assert not column(mission.folder, "removal", "tether.taut", 600.0)
    assert column(mission.folder, "removal", "tether.tug_count", 600.0) > 0
    assert column(tug.folder, "removal", "tether.taut", 87.0)
    assert column(tug.folder, "removal", "tether.tension", 87.0) > 0.0
    assert states(mission.folder)["removal-600s.state"]["rows"] == 31


@pytest.mark.parametrize(
    ("which", "place"),
    [
        ("mission", "capture:3 s"),
        ("mission", "capture:7 s"),
        ("mission", "removal:10 min"),
        ("mission", "removal:1800 s"),
        ("mission", "removal"),
        ("tug", "87 s"),
        ("tug", "removal:2 min"),
        ("reel", "250 s"),
        ("steered", "250 s"),
    ],
)
def test_gone_on(which: str, place: str, request: pytest.FixtureRequest, tmp_path: Path) -> None:
    run: Kept = request.getfixturevalue(which)
    on = put(run.folder, tmp_path / "on", go_on=place)
    assert tables(on) == tables(run.whole)
    assert ledgers(on) == ledgers(run.whole)
    first, second = (json.loads((folder / "summary.json").read_text()) for folder in (run.whole, on))
    for phase in ("capture", "removal", "hand-off"):
        for told in (first.get(phase, {}), second.get(phase, {})):
            told.pop("wall", None)
    assert first == second


def test_for_longer(mission: Kept, tmp_path: Path) -> None:
    """From the very end, and from the middle: the tow of 50 minutes that never stopped."""
    longer = "removal.duration=50 min"
    whole = tables(put(mission.scene, tmp_path / "whole", (*mission.settings, longer)))
    for place in ("removal:30 min", "removal:10 min", "capture:7 s"):
        assert tables(put(mission.folder, tmp_path / place[-6:], (longer,), go_on=place)) == whole


def test_with_another_removal(mission: Kept, tmp_path: Path) -> None:
    """From the hand-over, and from within the capture; the capture itself is not run again in the first."""
    other = ("removal.tether.diameter=2 mm", "removal.thrust.level=-0.02 N", "removal.macro_step=15 s")
    whole = put(mission.scene, tmp_path / "whole", (*mission.settings, *other))
    for place in ("removal", "capture:3 s"):
        on = put(mission.folder, tmp_path / place[:4], other, go_on=place)
        assert tables(on) == tables(whole)
        assert ledgers(on) == ledgers(whole)
    assert tables(whole)["removal.parquet"] != tables(mission.folder)["removal.parquet"]


def test_an_input_may_change_on_the_way(mission: Kept, tmp_path: Path) -> None:
    """The rows up to there stay, those after it do not; the twin that changes it at once parts from the first row on.
    What is run from the beginning once more, the tow without recoil, would not have that change, and is left out."""
    push = ("removal.thrust.offset=-0.05 N",)
    on = put(mission.folder, tmp_path / "on", push, go_on="removal:10 min")
    whole, changed = (pyarrow.parquet.read_table(folder / "removal.parquet") for folder in (mission.whole, on))
    assert changed.slice(0, 31).equals(whole.slice(0, 31))
    assert changed["center.semi_major_axis"][40].as_py() < whole["center.semi_major_axis"][40].as_py()
    at_once = pyarrow.parquet.read_table(
        put(mission.folder, tmp_path / "once", push, go_on="removal") / "removal.parquet"
    )
    assert not at_once.slice(0, 31).equals(whole.slice(0, 31))
    assert not (on / "removal_without_recoil_tugs.parquet").exists()
    told = json.loads((on / "provenance.json").read_text())["gone_on"]
    assert (told["run"], told["phase"], told["time"]["value"]) == ("kept", "removal", 600.0)
    assert told["changed"] == {"thrust.offset": -0.05}


def test_going_on_again_keeps_what_has_changed_in_mind(mission: Kept, tmp_path: Path) -> None:
    """Two stops, the input changed at the first: the same as one stop, and no comparison from the beginning."""
    push = ("removal.thrust.offset=-0.05 N",)
    first = put(mission.folder, tmp_path / "first", push, ("removal:20 min",), go_on="removal:10 min")
    second = put(first, tmp_path / "second", go_on="removal:20 min")
    assert tables(second) == tables(first)
    assert json.loads((second / "provenance.json").read_text())["gone_on"]["changed"] == {"thrust.offset": -0.05}


def test_fmus_in_processes_of_their_own(tug: Kept, tmp_path: Path) -> None:
    """A state of an FMU in our process is taken up by one in another, and the other way round."""
    here = put(tug.folder, tmp_path / "here", go_on="87 s")
    apart = put(tug.folder, tmp_path / "apart", ("removal.isolate=true",), ("removal:2 min",), go_on="87 s")
    back = put(apart, tmp_path / "back", ("removal.isolate=false",), go_on="2 min")
    for folder in (here, apart, back):
        assert tables(folder) == tables(tug.whole)


def test_passive_safety_follows_the_tow_from_its_beginning(tug: Kept, tmp_path: Path) -> None:
    """So it is made again where nothing has changed, and left out where an input has."""
    assert "removal_passive_safety.parquet" in tables(put(tug.folder, tmp_path / "same", go_on="87 s"))
    on = put(tug.folder, tmp_path / "on", ("removal.thrust.offset=0.1 N",), go_on="87 s")
    assert "removal_passive_safety.parquet" not in tables(on)


def test_no_state_is_kept_off_the_grid(tmp_path: Path) -> None:
    """An end after half a macro step is no communication point of a longer run; nothing is kept there, with a word."""
    settings = (*TUG, "removal.duration=10.5 s")
    done = run_and_write(
        "table2-deorbit",
        tmp_path / "run",
        Progress(),
        with_figures=False,
        settings=settings,
        save_at=("10.2 s", "9.5 s"),
    )
    assert [state.time for state in done.result.states] == [10.0]
    assert any("no state was kept at 10.2 s" in note for note in done.notes)


def test_a_run_that_was_interrupted(mission: Kept, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """It goes on from the state it had kept by then, and comes to the end of one that never stopped."""

    def check(phase: str, time: float) -> None:
        if time > 5.0:
            raise Interrupted(f"interrupted at {time:g} s of the {phase}")

    with monkeypatch.context() as stopped:
        stopped.setattr(interrupts, "check", check)
        done = run_and_write(
            mission.scene,
            tmp_path / "cut",
            Progress(),
            False,
            False,
            settings=mission.settings,
            save_at=("capture:3 s",),
        )
    assert (done.result.status, list(done.result.phases)) == ("interrupted", ["capture"])
    assert tables(put(done.folder, tmp_path / "on", go_on="capture:3 s")) == tables(mission.whole)
