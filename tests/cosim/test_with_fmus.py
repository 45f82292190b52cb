"""The whole way with the real FMUs, through the command line: what a user sees, and what is left in the folder."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from pathlib import Path

import pyarrow.parquet
import pytest

from dcone_cosim import build
from dcone_cosim.errors import FmuError
from dcone_cosim.fmu.component import Archive, Component
from dcone_cosim.loading import find, load
from tests.cosim.conftest import Dcone

pytestmark = pytest.mark.slow

Both = Callable[..., tuple[int, str]]


@pytest.fixture
def dcone(dcone: Dcone) -> Both:
    """Run the command line in an empty folder; returns exit code and all it wrote."""

    def run(*arguments: str) -> tuple[int, str]:
        code, out, err = dcone(*arguments)
        return code, out + err

    return run


def variant(tmp_path: Path, scene: str, *changes: tuple[str, str]) -> str:
    text = find(scene).read_text()
    for old, new in changes:
        assert text.count(old) == 1
        text = text.replace(old, new)
    (tmp_path / "mine.toml").write_text(text)
    return "mine.toml"


def summary_of(folder: Path) -> dict[str, dict[str, dict[str, float]]]:
    content: dict[str, dict[str, dict[str, float]]] = json.loads((folder / "summary.json").read_text())
    return content


def test_the_mission(dcone: Both, tmp_path: Path) -> None:
    """Captured, handed over with a closed ledger, towed; the recoil makes the first tug earlier and harder."""
    code, written = dcone("run", "mission", "-o", "out", "--csv")
    assert code == 0, written
    found = summary_of(tmp_path / "out")
    assert found["capture"]["outcome"]["value"] == "captured"
    ledger = json.loads((tmp_path / "out" / "ledger.json").read_text())
    assert ledger["rows"]
    assert all(row["closed"] for row in ledger["rows"])
    removal = found["removal"]
    assert removal["first_tug"]["value"] < removal["first_tug_without_recoil"]["value"] - 100.0
    assert removal["first_tug_peak"]["value"] > 1.5 * removal["first_tug_peak_without_recoil"]["value"]
    assert {p.suffix for p in (tmp_path / "out").iterdir()} == {".json", ".csv", ".parquet", ".png", ".toml"}
    assert len(list((tmp_path / "out").glob("*.png"))) == 4
    tugs = pyarrow.parquet.read_table(tmp_path / "out" / "tugs.parquet")
    assert len(tugs) == removal["tugs"]["value"]


def test_the_mission_keeps_its_slack(dcone: Both, tmp_path: Path) -> None:
    """14 m of line less the distance of its attachments, from what each phase recorded by itself; with the attachment
    in the centre of mass two metres were lost. The bend at the vertex is a millimetre."""
    code, written = dcone("run", "mission", "-o", "out", "--no-figures", "--set", "removal.duration=600 s")
    assert code == 0, written
    capture, removal = (pyarrow.parquet.read_table(tmp_path / "out" / f"{p}.parquet") for p in ("capture", "removal"))

    def place(of: str) -> list[float]:
        return [capture[f"{of}.position[{i}]"][-1].as_py() for i in (1, 2, 3)]

    slack = 14.0 - math.dist(place("vertex"), place("chaser"))
    assert slack == pytest.approx(3.906, abs=0.1)
    assert 0.0 <= 14.0 - removal["tether.length"][0].as_py() - slack < 2e-3
    assert removal["separation"][0].as_py() - removal["tether.length"][0].as_py() == pytest.approx(1.98, abs=0.1)
    told = summary_of(tmp_path / "out")["hand-off"]
    assert told["slack"]["value"] == pytest.approx(slack, abs=1e-9)
    assert told["line"]["value"] == 14.0
    tug = summary_of(tmp_path / "out")["removal"]["first_tug"]["value"]
    assert tug == pytest.approx(slack / 17.25e-3, rel=0.02)  # 17.45 mm/s at the hand-over, 17.05 as it ends


def test_table_2_has_its_first_tug_where_it_belongs(dcone: Both, tmp_path: Path) -> None:
    code, _ = dcone("run", "table2-deorbit", "-o", "out", "--no-figures", "--json")
    assert code == 0
    removal = summary_of(tmp_path / "out")["removal"]
    assert removal["first_tug"]["value"] == pytest.approx(1119.008376, abs=1e-4)
    assert removal["first_tug_speed"]["value"] == pytest.approx(1.969680e-3, rel=1e-5)
    assert "tugs_missed" not in removal


def test_the_macro_step_does_not_change_the_tugs(dcone: Both, tmp_path: Path) -> None:
    first = []
    for step in ("7 s", "60 s"):
        scene = variant(tmp_path, "table2-deorbit", ('"60 s"', f'"{step}"'), ('"1 day"', '"1 h"'))
        assert dcone("run", scene, "-o", "out", "--no-figures", "--force")[0] == 0
        tugs = pyarrow.parquet.read_table(tmp_path / "out" / "tugs.parquet")
        first.append(tugs["time"].to_pylist()[:3])
    assert first[0] == pytest.approx(first[1], abs=1e-6)


def test_a_capture_that_fails(dcone: Both, tmp_path: Path) -> None:
    late = variant(tmp_path, "mission", ('time = "6.4 s"', 'time = "29 s"'), ('"30 s"', '"9 s"'))
    code, written = dcone("run", late, "-o", "out", "--no-figures")
    assert code == 3
    assert "capture failed" in written
    assert json.loads((tmp_path / "out" / "provenance.json").read_text())["status"] == "capture failed"
    assert (tmp_path / "out" / "capture.parquet").exists()
    assert not (tmp_path / "out" / "removal.parquet").exists()


def test_a_tumbling_target_is_not_handed_to_a_point(dcone: Both, tmp_path: Path) -> None:
    turning = (
        'mass = "1000 kg"\n\n[capture.contact]',
        'mass = "1000 kg"\nstart_rate = ["0 deg/s", "0 deg/s", "5 deg/s"]\n\n[capture.contact]',
    )
    code, written = dcone("run", variant(tmp_path, "mission", turning), "-o", "out", "--no-figures")
    assert code == 4
    assert "hand-off refused" in written
    assert '[removal.target] body = "box", or none, would carry it' in written
    assert (tmp_path / "out" / "capture.parquet").exists()


def test_what_only_the_fmu_can_refuse_is_bad_input_too(dcone: Both, tmp_path: Path) -> None:
    odd = variant(tmp_path, "mission", ('mesh = "0.5 m"', 'mesh = "0.7 m"'))
    code, written = dcone("run", odd, "-o", "out")
    assert code == 2
    assert "whole number of net.mesh" in written
    assert [p.name for p in tmp_path.iterdir()] == ["mine.toml"]


def test_inspect_and_build(dcone: Both, tmp_path: Path) -> None:
    code, written = dcone("inspect", "mission")
    assert code == 0
    for part in ("gravity: hill", "left out", "nodes: 625", "threads: 1200", "bytes"):
        assert part in written
    code, written = dcone("build", "mission", "-o", "fmus")
    assert code == 0
    assert sorted(p.suffix for p in (tmp_path / "fmus").iterdir()) == [".fmu", ".fmu"]


class TestComponent:
    @pytest.fixture
    def archive(self):
        (phase,) = load("table2-deorbit").phases
        with Archive(build.ensure([("tethered_deorbit", phase.main.terms)], lambda _: None)[0]) as archive:
            yield archive

    def test_an_unknown_name_is_told_the_nearest(self, archive: Archive) -> None:
        with Component(archive, "a") as component, pytest.raises(FmuError, match=r"tether\.rest_length"):
            component.set({"tether.rest_lenght": 1.0})

    def test_the_folder_is_gone_after_closing(self, archive: Archive) -> None:
        folder = archive.folder
        assert folder is not None
        assert folder.exists()
        archive.close()
        assert not folder.exists()

    def test_a_restored_state_goes_on_with_the_same_bits(self, archive: Archive) -> None:
        with Component(archive, "a") as component:
            component.initialise(0.0)
            component.step(0.0, 1000.0)
            component.save()
            names = ["separation", "tether.tug_count", "tether.taut", "chaser.position[1]"]
            ends = []
            for _ in range(2):
                component.step(1000.0, 500.0)
                ends.append(component.get(names))
                component.restore()
            assert ends[0] == ends[1]
            assert ends[0]["tether.tug_count"] == 1.0

    def test_a_failure_carries_the_fmus_own_words(self, archive: Archive) -> None:
        with Component(archive, "towing") as component:
            component.set({"start.separation": 100.0})
            with pytest.raises(FmuError, match=r"towing.*\n.*start stretched"):
                component.initialise(0.0)

    def test_two_instances_do_not_know_each_other(self, archive: Archive) -> None:
        with Component(archive, "a") as first, Component(archive, "b") as second:
            second.set({"start.separation": 5.0})
            first.initialise(0.0)
            second.initialise(0.0)
            assert first.get(["separation"])["separation"] == pytest.approx(10.0, rel=1e-9)
            assert second.get(["separation"])["separation"] == pytest.approx(5.0, rel=1e-9)


def test_a_file_that_is_no_fmu(tmp_path: Path) -> None:
    (tmp_path / "broken.fmu").write_bytes(b"PK\x03\x04 cut short")
    with pytest.raises(FmuError, match=r"broken\.fmu: a damaged FMU"):
        Archive(tmp_path / "broken.fmu")
