"""The page of a run, parsed: its arrays are those of the tables, its words those of the summary, and it asks nobody."""

from __future__ import annotations

import hashlib
import json
import re
import shlex
import shutil
from pathlib import Path

import numpy as np
import pandas as pd
import pyarrow.csv
import pytest

from dcone_cosim.errors import InputError
from dcone_cosim.findings import spoken
from dcone_cosim.progress import Progress
from dcone_cosim.report import commands, scripts
from dcone_cosim.report.commands import write_page
from dcone_cosim.report.links import Linked
from dcone_cosim.report.page import of_folder, packed
from dcone_cosim.run_folder import histories_of
from tests.cosim.conftest import Dcone, dcone
from tests.report.conftest import Page
from tests.report.test_packing import decoded, newtons

__all__ = ["dcone"]


def summary(folder: Path) -> dict[str, dict[str, dict[str, float]]]:
    told: dict[str, dict[str, dict[str, float]]] = json.loads((folder / "summary.json").read_text())
    return told


def test_positions_and_tensions_are_those_of_the_tables(kept: Path, page: Page) -> None:
    clip = next(one for one in page.data["clips"] if one["key"] == "capture")
    nodes, threads = (pd.read_parquet(kept / f"replay_{name}.parquet") for name in ("nodes", "threads"))
    times = decoded(clip["times"])
    assert (times == nodes["time"].unique()).all()
    held = clip["net"]["nodes"]
    told = np.array(held["low"]) + np.array(held["step"]) * decoded(held)
    wanted = nodes[[f"position[{i}]" for i in (1, 2, 3)]].to_numpy(float).reshape(told.shape)
    assert (np.abs(told - wanted) <= 0.51 * np.array(held["step"])).all()
    assert max(held["step"]) < 1e-3, "less than a millimetre"
    tension = threads["tension"].to_numpy(float).reshape(len(times), -1)
    shown = newtons(clip["net"]["tensions"])
    above = tension > 1.01e-3 * tension.max()
    assert shown[above] == pytest.approx(tension[above], rel=0.014)
    assert not shown[tension < 0.99e-3 * tension.max()].any()
    ends = threads[["node[1]", "node[2]"]].to_numpy()[: tension.shape[1]] - 1
    assert (decoded(clip["net"]["threads"]) == ends).all()
    rows = pd.read_parquet(kept / "capture.parquet").set_index("time").loc[times]
    for name, column in (("target", "target.position"), ("chaser", "chaser.position"), ("line", "vertex.position")):
        np.testing.assert_allclose(decoded(clip[name]), rows[[f"{column}[{i}]" for i in (1, 2, 3)]], atol=1e-5)
    np.testing.assert_allclose(
        decoded(clip["attitude"]), rows[[f"target.attitude[{i}]" for i in range(1, 5)]], atol=1e-7
    )
    np.testing.assert_allclose(
        decoded(clip["bullets"])[:, 2], rows[[f"bullet[3].position[{i}]" for i in (1, 2, 3)]], atol=1e-5
    )


def test_histories_are_those_of_the_tables(kept: Path, page: Page) -> None:
    charts = {one["key"]: one for one in page.data["charts"]}
    capture, removal, tugs = (pd.read_parquet(kept / f"{name}.parquet") for name in ("capture", "removal", "tugs"))
    (mouth,) = charts["capture-mouth"]["series"]
    assert (decoded(mouth["x"]) == capture["time"]).all()
    np.testing.assert_allclose(decoded(mouth["y"]), capture["mouth.area"], rtol=1e-6)
    tension = charts["removal-tension"]
    assert (tension["unit"], tension["xUnit"]) == ("N", "min")
    own = next(one for one in tension["series"] if one["name"] == "tugs")
    assert decoded(own["x"]) == pytest.approx(tugs["time"] / 60.0, rel=1e-12)
    np.testing.assert_allclose(decoded(own["y"]), tugs["peak"], rtol=1e-6)
    np.testing.assert_allclose(decoded(tension["series"][0]["y"]), removal["tether.tension"], rtol=1e-6, atol=1e-9)


def test_the_answer_is_that_of_the_summary(kept: Path, page: Page) -> None:
    told = summary(kept)["removal"]
    tile = re.search(r"first tug\s*~([\d.]+) s\s*since the hand-over[^~]*first tug, peak\s*~([\d.]+) N", page.text)
    assert tile is not None
    assert float(tile[1]) == pytest.approx(told["first_tug"]["value"], rel=1e-3)
    assert float(tile[2]) == pytest.approx(told["first_tug_peak"]["value"], rel=1e-3)
    line = page.row("removal: the tether")
    tugs = pd.read_parquet(kept / "tugs.parquet")
    worst = tugs.loc[tugs["peak"].idxmax()]
    assert f"tug {worst['tug']:.0f} of {len(tugs)}, at {spoken(worst['time'])} s" in line
    margin = 2920e6 * np.pi / 4.0 * 1e-6 / worst["peak"] - 1.0
    assert float(line[2].strip("~")) == pytest.approx(margin, rel=2e-3)


def test_every_figure_has_its_unit(kept: Path, page: Page) -> None:
    told = summary(kept)
    units = {"m²": 1, "N": 1, "J": 1, "s": 1}
    rows = [row for row in page.rows if len(row) == 3 and row[2] in units]
    assert len(rows) > 24
    assert ["largest mouth area", f"~{told['capture']['mouth.area_max']['value']:.4g}", "m²"] in rows


def test_it_asks_nobody_and_scripts_are_all_in_it(page: Page) -> None:
    outside = [link for link in page.links if not link.startswith(("#", "data:"))]
    assert outside == []
    imported = json.loads(page.scripts["importmap"])["imports"]
    assert set(imported) == {
        "three",
        *(
            f"dcone/{name}"
            for name in (
                "bodies",
                "bytes",
                "camera",
                "chart",
                "csv",
                "cursor",
                "knob",
                "lines",
                "live",
                "page",
                "panel",
                "replay",
                "shot",
            )
        ),
    }
    assert all(value.startswith("data:text/javascript;base64,") for value in imported.values())


def test_the_command_in_the_box_makes_the_run_again(kept: Path, page: Page, dcone: Dcone, tmp_path: Path) -> None:
    command = re.search(r"(dcone run \./run)\s+copy", page.text)
    assert command is not None
    words = shlex.split(command[1])[1:]
    words[words.index("./run")] = str(kept)
    assert dcone(*words, "-o", str(tmp_path / "again"), "--no-figures")[0] == 0
    for name in ("capture", "replay_nodes", "replay_threads", "removal", "tugs"):
        assert (tmp_path / "again" / f"{name}.parquet").read_bytes() == (kept / f"{name}.parquet").read_bytes()


def test_a_run_that_kept_less_shows_less_and_says_how_to_get_more(bare: Path) -> None:
    page = Page(of_folder(bare, bare / "report.html"))
    clip = page.data["clips"][0]
    assert "tensions" not in clip["net"]
    assert len(decoded(clip["net"]["threads"])) == 84
    assert "`dcone run ... --replay` keeps it in full" in page.text


def test_words_of_a_scene_are_no_markup(kept: Path, tmp_path: Path) -> None:
    copy = shutil.copytree(kept, tmp_path / "odd")
    text = (copy / "scene.toml").read_text()
    odd = "A <b>bold</b> </script><script>alert(1)</script> & more"
    (copy / "scene.toml").write_text(re.sub(r'title = ".*"', f'title = "{odd}"', text))
    content = of_folder(copy, copy / "report.html")
    assert "alert(1)</script>" not in content
    assert odd in Page(content).text


def test_no_text_among_the_data_ends_their_element() -> None:
    data = {"clips": [], "charts": [], "colours": [], "name": "a</script><script>b"}
    told = packed(data)["data"]
    assert "</" not in told
    assert json.loads(told) == data


def test_commands_write_whole_files_and_refuse_what_is_no_run(kept: Path, tmp_path: Path, dcone: Dcone) -> None:
    code, out, _ = dcone("replay", str(kept), "-o", str(tmp_path / "mine.html"))
    assert (code, out.strip()) == (0, str(tmp_path / "mine.html"))
    page = Page((tmp_path / "mine.html").read_text())
    assert [one["key"] for one in page.data["charts"]] == ["removal-tension"]
    assert len(page.data["clips"]) == 2
    tables = ("capture", "removal", "removal_without_recoil_tugs", "tugs")
    code, out, _ = dcone("report", str(kept))
    written = ["report.html", *(f"{name}.csv" for name in tables)]
    assert (code, out.split()) == (0, [str(kept / name) for name in written])
    assert set(written) <= set(json.loads((kept / "provenance.json").read_text())["files"])
    links = [link for link in Page((kept / "report.html").read_text()).links if link.endswith(".csv")]
    assert links == written[1:]
    assert dcone("report", str(tmp_path))[0] == 2
    assert dcone("report", str(kept), "-o", str(tmp_path / "mine.html"), "--csv", "--no-live")[0] == 0
    names = {path.stem for path in tmp_path.glob("*.csv")}
    assert names == set(tables)
    for name in names:
        told = pyarrow.csv.read_csv(tmp_path / f"{name}.csv").to_pandas()
        table = pd.read_parquet(kept / f"{name}.parquet")
        assert "time [s]" in told
        assert np.array_equal(told.to_numpy(float), table.to_numpy(float), equal_nan=True), "to the bit"
    other = tmp_path / "other"
    other.mkdir()
    code, out, _ = dcone("report", str(kept), "-o", str(other / "mine.html"), "--no-live")
    assert [path.name for path in other.iterdir()] == ["mine.html"], "nothing unasked where other files are"
    code, _, error = dcone("report", str(kept), "-o", str(tmp_path / "mine.txt"))
    assert code == 2
    assert "ends in .html" in error
    code, _, error = dcone("report", str(kept), "--sizing", str(tmp_path))
    assert code == 2
    assert "`dcone size` writes" in error


def test_a_large_table_is_csv_where_it_is_asked_for(
    bare: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(commands, "LARGEST", histories_of(bare)["capture"] - 1)
    copy = shutil.copytree(bare, tmp_path / "run")
    names = {path.name for path in write_page(copy, None, Progress())}
    assert "capture.csv" not in names
    assert "tugs.csv" in names
    page = Page((copy / "report.html").read_text())
    assert "capture.csv would be large: dcone report ./run --csv" in page.text
    assert "capture.csv" not in page.links
    assert (copy / "capture.csv") in write_page(copy, None, Progress(), csv=True)
    assert {path.name for path in write_page(copy, None, Progress(), csv=False)} == {"report.html"}


def test_reports_that_belong_to_it_are_linked_from_where_the_page_is(kept: Path, tmp_path: Path) -> None:
    sizing = tmp_path / "sized"
    rows = [
        {"load": "steady load", "size": 0.5, "diameter": 1e-4, "how": "FoS 2"},
        {"load": "snap", "size": 812.25, "diameter": 2.1e-3, "how": "the hardest tug"},
        {"load": "debris cut", "size": None, "diameter": 7e-4, "how": "1 %"},
    ]
    parts = {"governs": {"title": "", "purpose": "each by itself", "units": {}, "rows": rows, "said": []}}
    sizing.mkdir()
    (sizing / "report.html").write_text("")
    (sizing / "summary.json").write_text(
        json.dumps({"said": ["2.1 mm of Kevlar 29", "the first tug governs"], "parts": parts})
    )
    also = [Linked.read("sizing", sizing)]
    (path,) = write_page(kept, tmp_path / "pages" / "mission.html", Progress(), also)
    page = Page(path.read_text())
    assert "../sized/report.html" in page.links
    assert "Report of sizing: 2.1 mm of Kevlar 29" in page.text
    assert "the first tug governs" in page.text
    assert page.row("snap, governs") == ["snap, governs", "2.1", "812.2", "the hardest tug"]
    assert re.search(
        r"least diameter of the tether\s*2\.1 mm\s*by its sizing; snap governs: the hardest tug", page.text
    )
    loads = [row[0] for row in page.rows]
    assert loads.index("snap, governs") < loads.index("debris cut") < loads.index("steady load")


def test_three_is_held_against_its_hash(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    name = Path(scripts.origin()["file"]).name
    assert hashlib.sha256((scripts.THREE / name).read_bytes()).hexdigest() == scripts.origin()["sha256"]
    (tmp_path / name).write_text("another")
    monkeypatch.setattr(scripts, "THREE", tmp_path)
    scripts.three.cache_clear()
    with pytest.raises(InputError, match=r"is not three\.js 0\.170\.0"):
        scripts.three()
