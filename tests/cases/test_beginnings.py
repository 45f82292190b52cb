"""What cases of a sweep begin with is run once, and changes no bit of any row; what only looks shared is not."""

from __future__ import annotations

import shutil
from collections.abc import Sequence
from pathlib import Path

import pyarrow.parquet
import pytest

from dcone_cosim.cases import commands
from dcone_cosim.cases.alone import Fmus
from dcone_cosim.cases.beginnings import FOLDER, kept_of, key_of_beginning, shared
from dcone_cosim.cases.case import Case, key_of
from dcone_cosim.cases.work import Fleet
from dcone_cosim.loading import load
from dcone_cosim.phases import hastened
from dcone_cosim.progress import Progress
from dcone_cosim.scene.data import Scene
from tests.cases.conftest import dcone
from tests.cosim.conftest import Dcone
from tests.runs import COARSE, put

__all__ = ["dcone"]

DIAMETERS = "removal.tether.diameter=1 mm,1.5 mm,2 mm"
FAST = 'capture.bullets.speed="3 m/s","3.02 m/s"'


@pytest.fixture(scope="module")
def fmus() -> Fmus:
    return Fmus(Progress())


@pytest.fixture(scope="module")
def swept(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A sweep over the tow alone, and one over both phases: two captures for four cases."""
    folder = tmp_path_factory.mktemp("swept")
    for name, vary in (("tows", (DIAMETERS,)), ("both", (FAST, "removal.tether.diameter=1 mm,2 mm"))):
        done = commands.sweep("mission", vary, folder / name, Progress(), COARSE, 2, False)
        assert done.exit_code == 0
    return folder


def keys(settings: Sequence[str], fmus: Fmus, count: int = 1, scene: str = "mission") -> str:
    of = load(scene, settings)
    return key_of_beginning(of, fmus.of(of), count)


def beginnings(folder: Path) -> list[str]:
    return sorted(path.name for path in (folder / FOLDER).iterdir())


def case(scene: Scene, fmus: Fmus) -> Case:
    return Case(key_of(scene, fmus.of(scene), None), scene)


def test_one_capture_for_all_tows(swept: Path) -> None:
    assert len(beginnings(swept / "tows")) == 1
    assert len(beginnings(swept / "both")) == 2


@pytest.mark.parametrize("name", ["tows", "both"])
def test_the_rows_are_those_of_whole_runs(swept: Path, fmus: Fmus, name: str) -> None:
    """Every figure to the last bit, under the key of the whole case; each is run by itself from its beginning."""
    table = pyarrow.parquet.read_table(swept / name / "table.parquet").to_pylist()
    fleet = Fleet()
    for told in table:
        given = [
            f"{column.removeprefix('given.')}={value}" for column, value in told.items() if column.startswith("given.")
        ]
        row = fleet.row(case(load("mission", [*COARSE, *given]), fmus))
        assert row.succeeded
        assert row.key == told["key"]
        assert {name: told[name] for name in row.figures} == dict(row.figures)
        assert any(name.startswith("capture.") for name in row.figures)
    fleet.close()


def test_a_capture_costs_a_case_nothing_that_it_did_not_run(swept: Path) -> None:
    times = pyarrow.parquet.read_table(swept / "tows" / "timings.parquet")
    assert times["capture.wall"].to_pylist() == [0.0, 0.0, 0.0]
    assert all(wall > 0.0 for wall in times["removal.wall"].to_pylist())


def test_what_belongs_to_the_capture_whatever_it_is_called(fmus: Fmus, tmp_path: Path) -> None:
    """The one line of both phases, said in the removal alone; the orbit; against keys of the tow alone."""
    own = keys((), fmus)
    for same in (
        *(
            "removal.tether.diameter=3 mm",
            "removal.duration=1 h",
            "removal.thrust.level=-1 N",
            "removal.target.body=box",
        ),
        *("handoff.point_tolerance=0.02", "title=another", "removal.solver.tolerance_stretch=10 pm"),
    ):
        assert keys((same,), fmus) == own
    for other in ("orbit.altitude=700 km", "capture.bullets.speed=3.1 m/s", "capture.macro_step=0.01 s"):
        assert keys((other,), fmus) != own
    text = Path(load("mission").source).read_text().replace('length = "14 m"\n', "", 1)
    assert text.count('"14 m"') == 1
    (tmp_path / "line.toml").write_text(text)
    lengths = [load(str(tmp_path / "line.toml"), [f"removal.tether.rest_length={m} m"]) for m in (14, 15)]
    assert [scene.phases[0].setting("tether.length") for scene in lengths] == [14.0, 15.0]
    one, other = (key_of_beginning(scene, fmus.of(scene), 1) for scene in lengths)
    assert one == own
    assert other != own
    assert shared([(case(scene, fmus), fmus.of(scene)) for scene in lengths], tmp_path) == {}


def test_hand_overs_belong_to_what_comes_after_them(fmus: Fmus) -> None:
    """How the capture hands over to the removal matters to what the second tow begins with, not to the capture."""
    scene, tables = "two-tows", ("removal.duration=1 h",)
    assert keys(tables, fmus, 1, scene) == keys((*tables, "second_tow.duration=2 h"), fmus, 1, scene)
    assert keys(tables, fmus, 1, scene) != keys(("removal.duration=2 h",), fmus, 1, scene)
    three = ("second_tow.macro_step=10 s", "second_tow.duration=1 h", 'second_tow.reel={law="locked"}')
    three += (
        'second_tow.tether={rest_length="30 m"}',
        "second_tow.thrust.level=-0.01 N",
        "second_tow.thrust.direction=along_track",
    )
    three += ('phases=["capture", "removal", "second_tow"]',)
    loose = (*three, "handoff.point_tolerance=0.02")
    assert keys(three, fmus, 1) == keys(loose, fmus, 1)
    assert keys(three, fmus, 2) != keys(loose, fmus, 2)


def test_other_fmus_make_another_beginning(fmus: Fmus) -> None:
    scene = load("mission", COARSE)
    of = fmus.of(scene)
    assert key_of_beginning(scene, of, 1) == key_of_beginning(scene, of | {"removal": "another"}, 1)
    assert key_of_beginning(scene, of, 1) != key_of_beginning(scene, of | {"capture": "another"}, 1)


def test_what_is_damaged_counts_as_not_there(swept: Path, dcone: Dcone, tmp_path: Path) -> None:
    """The rows are the same, and the capture is run in each case; a beginning that is gone is run again."""
    copy = shutil.copytree(swept / "tows", tmp_path / "tows")
    (only,) = (copy / FOLDER).iterdir()
    settings = [part for setting in COARSE for part in ("--set", setting)]
    command = ("sweep", "mission", "--vary", DIAMETERS, "-o", "tows", "--no-figures", "-j", "1", *settings)
    before = (copy / "table.parquet").read_bytes()
    for damage in (lambda: (only / "capture.parquet").write_bytes(b"no table"), lambda: shutil.rmtree(copy / FOLDER)):
        shutil.rmtree(copy / "rows")
        damage()
        code, _, err = dcone(*command)
        assert code == 0, err
        assert (copy / "table.parquet").read_bytes() == before
    assert len(beginnings(copy)) == 1


def test_the_comparison_without_recoil_is_that_of_fine_steps(fmus: Fmus, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its macro steps are sixteen times as long, and no bit of what is told of it changes."""
    own = case(load("mission", COARSE), fmus)
    coarse = Fleet().row(own)
    monkeypatch.setattr(hastened, "COARSE", 1)
    fine = Fleet().row(own)
    assert fine.figures == coarse.figures
    assert any("without_recoil" in name for name in fine.figures)


def test_a_sweep_of_a_run_goes_on_from_what_it_left(fmus: Fmus, tmp_path: Path) -> None:
    """No capture is run, and the figures are those of whole runs; one that begins otherwise has its own."""
    run = put("mission", tmp_path / "run", COARSE)
    done = commands.sweep(str(run), (DIAMETERS,), tmp_path / "tows", Progress(), (), 1, False)
    assert done.exit_code == 0
    assert not (tmp_path / "tows" / FOLDER).exists()
    assert all(entry.row.timings["capture.wall"] == 0.0 for entry in done.entries)
    whole = Fleet().row(case(load("mission", [*COARSE, "removal.tether.diameter=2 mm"]), fmus))
    assert dict(done.entries[-1].row.figures) == dict(whole.figures)
    found = kept_of(run)
    assert list(found) == [keys(COARSE, fmus)]
    assert keys((*COARSE, "capture.bullets.speed=3.02 m/s"), fmus) not in found


def test_bad_input_leaves_nothing_of_what_was_begun_early(dcone: Dcone, tmp_path: Path) -> None:
    """The first two cases are good, and their capture is on its way as the third is found to be none."""
    settings = [part for setting in COARSE for part in ("--set", setting)]
    vary = "removal.tether.diameter=1 mm,2 mm,3 kg"
    code, _, err = dcone("sweep", "mission", "--vary", vary, "-o", "deep/out", "-j", "1", *settings)
    assert code == 2
    assert "3 kg" in err
    assert list(tmp_path.iterdir()) == []


def test_a_capture_that_fails_fails_every_case(tmp_path: Path) -> None:
    """Its rows say why, as whole runs do."""
    settings = (*COARSE, "capture.duration=7 s")
    done = commands.sweep("mission", (DIAMETERS,), tmp_path / "out", Progress(), settings, 1, False)
    assert [entry.row.status for entry in done.entries] == ["capture failed"] * 3
    whole = Fleet().row(done_case(settings))
    assert whole.message == done.entries[0].row.message
    assert whole.figures == done.entries[0].row.figures


def done_case(settings: Sequence[str]) -> Case:
    return Case("0" * 64, load("mission", [*settings, "removal.tether.diameter=1 mm"]))
