"""Rows are whole or not there, whoever is killed while writing; foreign files and folders stay as they are."""

from __future__ import annotations

import math
import os
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest

from dcone_cosim.cases import store
from dcone_cosim.cases.case import digest
from dcone_cosim.cases.rows import Row, lost, of_summary
from dcone_cosim.cases.store import Store, unlike
from dcone_cosim.errors import InputError
from dcone_cosim.scratch import PREFIX
from tests.cosim.test_kills import WRITING, killed_everywhere

STUDY = {
    "kind": "a sweep",
    "scene": "mock",
    "varied": ["a.b"],
    "content": "c",
    "fmus": {"removal": "1" * 64},
    "code": {"dcone-cosim": "1.0", "sources": "s" * 64},
}


def row_of(number: int) -> Row:
    return Row(digest(number), "completed", 0, "", {"removal.x": number / 7.0}, {"removal.x": "m"}, {"cpu": 0.1})


def names(folder: Path) -> list[str]:
    return sorted(p.relative_to(folder).as_posix() for p in folder.rglob("*"))


def test_a_row_keeps_every_bit() -> None:
    figures = {"a": 0.1 + 0.2, "b": 5e-324, "c": math.inf, "d": -math.inf, "e": 3, "f": "told", "g": "nan"}
    row = Row("k", "completed", 0, "two\nlines", figures, {"a": "m"}, {"cpu": 1.0})
    assert Row.from_text(row.as_text()) == row
    back = Row.from_text(Row("k", "completed", figures={"x": math.nan}).as_text())
    assert math.isnan(back.figures["x"])  # type: ignore[arg-type]
    for text in ("", "[]", "{}", '{"key": "k", "status": "x", "colour": 1}', row.as_text()[:-1], "[" * 100_000):
        with pytest.raises(ValueError, match=r"row|JSON|Expecting|Unterminated|delimiter"):
            Row.from_text(text)


def test_a_summary_becomes_a_row() -> None:
    """Times of this computer are no figures."""
    summary = {
        "scene": "mock", "title": "t", "status": "completed", "message": "", "exit_code": 0, "warnings": [],
        "removal": {"tugs": {"value": 3, "unit": "1"}, "lowered": {"value": "too little"},
                    "wall": {"value": 0.3, "unit": "s"}},
        "hand-off": {"time": {"value": 9.5, "unit": "s", "one_sample": True, "spread": 0.05}},
    }  # fmt: skip
    row = of_summary("k", summary, {"cpu": 0.2})
    assert row.figures == {"removal.tugs": 3, "removal.lowered": "too little", "hand-off.time": 9.5}
    assert row.units == {"removal.tugs": "1", "hand-off.time": "s"}
    assert row.timings == {"cpu": 0.2, "removal.wall": 0.3}


def test_what_is_put_is_there_and_in_the_next_store_too(tmp_path: Path) -> None:
    with Store(tmp_path / "out", STUDY) as one:
        assert one.get(row_of(1).key) is None
        one.put(row_of(1))
        assert one.get(row_of(1).key) == row_of(1)
    assert names(tmp_path) == ["out", "out/rows", f"out/rows/{row_of(1).key}.json", "out/study.json"]
    with Store(tmp_path / "out", STUDY) as other:
        assert other.get(row_of(1).key) == row_of(1)
        assert other.get(row_of(2).key) is None


def test_many_rows_are_gathered(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(store, "GATHERED", 4)
    with Store(tmp_path, STUDY) as one, Store(tmp_path, STUDY) as beside:
        for number in range(10):
            one.put(row_of(number))
        assert len(list((tmp_path / "rows").glob("many-*.parquet"))) == 2
        assert len(list((tmp_path / "rows").glob("*.json"))) == 2
        one.gather()
        assert not list((tmp_path / "rows").glob("*.json"))
        assert [one.get(row_of(n).key) for n in range(10)] == [row_of(n) for n in range(10)]
        beside.put(row_of(0))  # it has not seen that there is one
        assert beside.get(row_of(0).key) == row_of(0)
    with Store(tmp_path, STUDY) as later:
        assert [later.get(row_of(n).key) for n in range(10)] == [row_of(n) for n in range(10)]


def test_a_row_that_another_process_gathers_is_found(tmp_path: Path) -> None:
    with Store(tmp_path, STUDY) as one:
        one.put(row_of(1))
        with Store(tmp_path, STUDY) as beside:
            one.gather()
            assert beside.get(row_of(1).key) == row_of(1)


def test_a_lost_case_takes_the_place_of_no_row(tmp_path: Path) -> None:
    good, gone = row_of(1), lost(row_of(1).key, "was ended by SIGKILL")
    with Store(tmp_path, STUDY) as one:
        one.put(gone)
        assert one.get(good.key) == gone
        one.gather()
        assert (tmp_path / "rows" / f"{good.key}.json").exists(), "it is to be run again"
        one.put(good)
        one.put(gone)
        assert one.get(good.key) == good
        one.gather()
        one.put(gone)
        assert one.get(good.key) == good


@pytest.mark.parametrize("damage", [b"", b"{", b"\xff\xfe", b'{"key": "another", "status": "completed"}'])
def test_what_is_damaged_is_not_there(tmp_path: Path, damage: bytes) -> None:
    with Store(tmp_path, STUDY) as one:
        one.put(row_of(1))
        path = tmp_path / "rows" / f"{row_of(1).key}.json"
        path.write_bytes(damage)
        assert one.get(row_of(1).key) is None
        one.put(lost(row_of(1).key, "is gone"))
        assert one.get(row_of(1).key) is not None
        one.put(row_of(1))
        one.gather()
        (segment,) = (tmp_path / "rows").glob("many-*")
        segment.write_bytes(segment.read_bytes()[:50])
    with Store(tmp_path, STUDY) as other:
        assert other.get(row_of(1).key) is None
        other.put(row_of(1))
        other.gather()
        assert other.get(row_of(1).key) == row_of(1)


def test_foreign_files_stay(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(store, "GATHERED", 2)
    with Store(tmp_path, STUDY) as one:
        mine = ["rows/notes.json", "rows/many-mine.parquet", f"rows/{'x' * 64}.json", "thesis.tex"]
        for name in mine:
            (tmp_path / name).write_text("mine")
        for number in range(4):
            one.put(row_of(number))
        one.gather()
    assert all((tmp_path / name).read_text() == "mine" for name in mine)


class TestRefused:
    def test_a_folder_of_something_else(self, tmp_path: Path) -> None:
        (tmp_path / "thesis.tex").write_text("years of work")
        with pytest.raises(InputError, match=r"holds other files: thesis.tex; choose a new folder with -o"):
            Store(tmp_path, STUDY)
        assert names(tmp_path) == ["thesis.tex"]

    def test_a_file(self, tmp_path: Path) -> None:
        (tmp_path / "out").write_text("")
        with pytest.raises(InputError, match="is not a folder"):
            Store(tmp_path / "out", STUDY)

    @pytest.mark.parametrize("text", ["", "[]", "{", "{}"])
    def test_a_study_that_cannot_be_read(self, tmp_path: Path, text: str) -> None:
        (tmp_path / "study.json").write_text(text)
        with pytest.raises(InputError, match="choose a new folder with -o"):
            Store(tmp_path, STUDY)
        assert names(tmp_path) == ["study.json"]

    @pytest.mark.parametrize(
        ("change", "told"),
        [
            ({"kind": "an ensemble"}, "holds a sweep, not an ensemble"),
            ({"scene": "mission"}, "holds a sweep of another scene, 'mock'; this is 'mission'"),
            ({"code": {"dcone-cosim": "1.1", "sources": "t" * 64}},
             "made by other code, dcone-cosim 1.0 (sources ssssssss); this is dcone-cosim 1.1 (sources tttttttt)"),
            ({"varied": ["a.b", "c"]}, "holds a sweep over a.b; this is over a.b, c"),
            ({"fmus": {"removal": "2" * 64}}, "with another FMU of the removal: it was 111111111111..., it is 222"),
            ({"content": "d"}, "holds a sweep of 'mock' with other values in the scene"),
        ],
    )  # fmt: skip
    def test_another_study(self, tmp_path: Path, change: dict[str, object], told: str) -> None:
        Store(tmp_path, STUDY).close()
        before = names(tmp_path)
        with pytest.raises(InputError) as caught:
            Store(tmp_path, STUDY | change)
        assert told in str(caught.value)
        assert names(tmp_path) == before
        assert not unlike(STUDY, STUDY), "the twin"


def test_litter_does_not_take_a_folder(tmp_path: Path) -> None:
    (tmp_path / ".DS_Store").touch()
    Store(tmp_path, STUDY).close()
    assert (tmp_path / "study.json").exists()


@pytest.mark.skipif(not hasattr(os, "fork"), reason="forks")
def test_killed_at_any_file_event(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """From an empty place to two rows that are gathered: what is there is whole, and the next goes on."""
    import pyarrow.parquet  # noqa: F401  # not to be loaded by each child

    monkeypatch.setattr(store, "GATHERED", 2)
    folder, rows = tmp_path / "out", [row_of(n) for n in range(2)]

    def work() -> None:
        with Store(folder, STUDY) as one:
            for row in rows:
                one.put(row)

    seen = set()
    for event in killed_everywhere(work):
        for path in (folder / "rows").glob("*.json"):
            assert Row.from_text(path.read_text()) in rows, f"killed at {event}"
        with Store(folder, STUDY) as after:
            there = [after.get(row.key) for row in rows]
            seen.add(len([row for row in there if row is not None]))
            assert all(row in (None, whole) for row, whole in zip(there, rows, strict=True)), f"killed at {event}"
        assert not [name for name in names(tmp_path) if ".dcone-" in name], f"killed at event {event}"
        work()
        with Store(folder, STUDY) as after:
            assert [after.get(row.key) for row in rows] == rows
        for path in sorted(folder.rglob("*"), reverse=True):
            path.rmdir() if path.is_dir() else path.unlink()
        folder.rmdir()
    assert seen == {0, 1, 2}
    assert event > 15


def test_nothing_is_written_under_its_final_name(tmp_path: Path) -> None:
    """What is opened for writing lies in a scratch folder: a kill between two writes cannot be had at a file event."""
    opened: list[str] | None = []

    def hook(event: str, arguments: object) -> None:
        if opened is not None and event == "open" and arguments[2] & WRITING:  # type: ignore[index]
            opened.append(str(arguments[0]))  # type: ignore[index]

    sys.addaudithook(hook)
    with Store(tmp_path, STUDY) as one:
        one.put(row_of(1))
        one.put(lost(row_of(2).key, "is gone"))
        one.put(row_of(2))
        one.gather()
    found, opened = [name for name in opened if str(tmp_path) in name], None
    assert len(found) >= 4
    assert [name for name in found if PREFIX not in name] == []


@pytest.mark.skipif(not hasattr(os, "fork"), reason="forks")
def test_killed_while_gathering(tmp_path: Path) -> None:
    """Rows that were there are there at every instant: alone, in a segment, or both."""
    import pyarrow.parquet  # noqa: F401

    rows = [row_of(n) for n in range(3)]
    with Store(tmp_path, STUDY) as one:
        for row in rows:
            one.put(row)

    def work() -> None:
        with Store(tmp_path, STUDY) as one:
            one.gather()

    found = set()
    for event in killed_everywhere(work):
        with Store(tmp_path, STUDY) as after:
            assert [after.get(row.key) for row in rows] == rows, f"killed at {event}"
            found.add(len(list((tmp_path / "rows").glob("*.json"))))
            for row in rows:
                after.put(row)
    assert found >= {0, 1, 3} or found >= {1, 2, 3}


WRITER = """
    import sys
    sys.path.insert(0, {root!r})
    from pathlib import Path
    from dcone_cosim.cases import store
    from tests.cases.test_store import STUDY, row_of
    store.GATHERED = 7
    with store.Store(Path("out"), STUDY) as one:
        for number in range(60):
            one.put(row_of(number))
        assert all(one.get(row_of(n).key) == row_of(n) for n in range(60))
"""


def test_several_processes_write_at_once(tmp_path: Path) -> None:
    """All of the rows, each of them, with segments that are made beside one another."""
    program = textwrap.dedent(WRITER).format(root=str(Path(__file__).parents[2]))
    writers = [subprocess.Popen([sys.executable, "-c", program], cwd=tmp_path) for _ in range(2)]
    assert [writer.wait(60) for writer in writers] == [0, 0]
    with Store(tmp_path / "out", STUDY) as after:
        assert all(after.get(row_of(n).key) == row_of(n) for n in range(60))
    assert not [name for name in names(tmp_path) if ".dcone-" in name]


def test_rows_that_come_together_are_one_file(tmp_path: Path) -> None:
    """Beside those of cases whose worker died, which lie alone: another row takes their place later."""
    whole = [Row(f"{number:064x}", "completed", 0, "", {"removal.value": float(number)}) for number in range(40)]
    died = lost(f"{99:064x}", "died")
    with Store(tmp_path / "out", STUDY) as store:
        store.put_all([*whole[:20], died, *whole[20:]])
        assert [store.get(row.key) for row in (*whole, died)] == [*whole, died]
    names = sorted(path.suffix for path in (tmp_path / "out" / "rows").iterdir())
    assert names == [".json", ".parquet"]
    with Store(tmp_path / "out", STUDY) as again:
        assert [again.get(row.key) for row in (*whole, died)] == [*whole, died]
        again.put(Row(died.key, "completed"))
        found = again.get(died.key)
        assert found is not None
        assert found.lasting
