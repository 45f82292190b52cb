"""`dcone campaign` from the file to the folder: what it leaves, that it goes on, and what it refuses."""

from __future__ import annotations

import json
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from scipy.special import ndtr

from dcone_cosim.campaign import commands
from dcone_cosim.campaign.folder import kept, settings_of
from dcone_cosim.campaign.shipped import shipped
from dcone_cosim.campaign.shots import Shot, ground_of, run_shot
from dcone_cosim.loading import load
from dcone_cosim.progress import Progress
from tests.campaign import fakes
from tests.campaign.conftest import DRIFT, put_campaign
from tests.cases.conftest import put_scene
from tests.cosim.conftest import Dcone

ROOT = str(Path(__file__).parents[2])
TABLES = ("table.parquet", "table.csv")
VELOCITY = "removal.start.relative_velocity[2]"


def tables(folder: Path) -> list[bytes]:
    return [(folder / name).read_bytes() for name in TABLES]


@pytest.fixture(scope="module")
def once(template: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A campaign of sixty cases, on plain processes."""
    folder = tmp_path_factory.mktemp("campaign")
    file = put_campaign(put_scene(folder / "scene", template).parent, DRIFT)
    return commands.campaign(file, folder / "out", Progress(), "processes").folder


def test_what_it_leaves(once: Path) -> None:
    names = {path.name for path in once.iterdir()}
    assert names == {
        *("estimate.png", "figures.png", "fmus", "provenance.json", "report.html", "rows", "scene.toml", "study.json"),
        *("summary.json", "table.csv", "table.parquet", "timings.parquet"),
    }
    page = (once / "report.html").read_text()
    assert "removal.separation below 10.12563103 m" in page
    assert "<pre><code>" in page


def test_dispersions_are_applied(once: Path) -> None:
    """By hand: two bodies 10 m apart that drift for 100 s are 10 m + 100 s v apart, for the v of each case."""
    table = pd.read_parquet(once / "table.parquet")
    assert table["case"].tolist() == list(range(1, 61))
    velocity = table[VELOCITY].to_numpy()
    np.testing.assert_allclose(table["removal.separation"], 10.0 + 100.0 * velocity, rtol=1e-12)
    assert len(set(velocity)) == 60
    assert abs(velocity.mean() - 1e-3) < 4 * 0.2e-3 / 60**0.5
    assert table.attrs["units"][VELOCITY] == "m/s"
    told = json.loads((once / "summary.json").read_text())
    good = int((table["removal.separation"] < 10.12563103).sum())
    assert (told["succeeded"], told["probability"]["share"]) == (good, good / 60)
    assert told["probability"]["interval"][0] < float(ndtr(1.2815515)) < told["probability"]["interval"][1]


def test_every_dispersion_is_applied(drift: Path, tmp_path: Path) -> None:
    """Three numbers, two of them elements of one vector: the distance by hand from all of them."""
    text = DRIFT.replace("n = 60", "n = 8")
    for key, least, most in (("velocity[1]", "0 mm/s", "9 mm/s"), ("position[2]", "9 m", "11 m")):
        text += f'[[dispersion]]\nkey = "removal.start.relative_{key}"\ndistribution = "uniform"\n'
        text += f'least = "{least}"\nmost = "{most}"\n'
    file = put_campaign(drift.parent, text)
    commands.campaign(file, tmp_path / "out", Progress(), "processes", jobs=1, with_figures=False)
    table = pd.read_parquet(tmp_path / "out" / "table.parquet")
    across, along = 100.0 * table["removal.start.relative_velocity[1]"], 100.0 * table[VELOCITY]
    expected = np.hypot(across, table["removal.start.relative_position[2]"] + along)
    np.testing.assert_allclose(table["removal.separation"], expected, rtol=1e-12)
    assert across.min() < 0.3 < 0.6 < across.max()


def test_it_goes_on_with_more(once: Path, tmp_path: Path) -> None:
    """The same folder with more cases runs those that are missing; a worker more or less changes no bit."""
    folder = shutil.copytree(once, tmp_path / "out")
    campaign = once.parent / "scene" / "campaign.toml"
    commands.campaign(campaign, folder, Progress(), "processes", with_figures=False, cases=70)
    more = put_campaign(campaign.parent, DRIFT.replace("n = 60", "n = 70"))
    commands.campaign(more, tmp_path / "one", Progress(), "processes", jobs=1, with_figures=False)
    put_campaign(campaign.parent, DRIFT)
    assert tables(folder) == tables(tmp_path / "one")
    assert settings_of(kept(folder), 65) == settings_of(kept(tmp_path / "one"), 65)  # case 65 can be made again
    assert pd.read_parquet(folder / "table.parquet")[:60].equals(pd.read_parquet(once / "table.parquet"))


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("seed = 5", "seed = 6", "with other values in the scene, or with other settings"),
        ('"0.2 mm/s"', '"0.3 mm/s"', "with other values in the scene, or with other settings"),
        ("velocity[2]", "velocity[1]", "holds a campaign over"),
    ],
)
def test_a_folder_of_another_campaign(once: Path, tmp_path: Path, old: str, new: str, told: str, dcone: Dcone) -> None:
    folder = shutil.copytree(once, tmp_path / "out")
    scene = shutil.copytree(once.parent / "scene", tmp_path / "scene")
    before = tables(folder)
    code, _, err = dcone("campaign", str(put_campaign(scene, DRIFT.replace(old, new))), "-o", str(folder))
    assert (code, told in err) == (2, True), err
    assert tables(folder) == before


def test_a_figure_that_there_is_not(drift: Path, dcone: Dcone) -> None:
    file = put_campaign(drift.parent, 'record = ["removal.separatoin"]\n' + DRIFT)
    code, _, err = dcone("campaign", str(file), "-o", "out", "--scheduler", "processes")
    assert (code, "did you mean 'removal.separation'?" in err) == (2, True), err
    assert "line 1: record[1]" in err


def test_cases_worth_looking_at_are_one_click_from_their_replay(drift: Path, tmp_path: Path) -> None:
    """Without their pages no link leads nowhere; the same command with `--replays` makes and links them."""
    file, out = put_campaign(drift.parent, DRIFT.replace("n = 60", "n = 6")), tmp_path / "out"
    linked = re.compile(r'href="(cases/\d+/report\.html)"')
    commands.campaign(file, out, Progress(), "processes", jobs=1, with_figures=False)
    before = (out / "report.html").read_text()
    assert linked.findall(before) == []
    worth = [int(number) for number in re.findall(r"dcone campaign rerun \S+ (\d+)", before)]
    assert worth
    commands.campaign(file, out, Progress(), "processes", jobs=1, with_figures=False, replays=True)
    pages = linked.findall((out / "report.html").read_text())
    assert pages == [f"cases/{number}/report.html" for number in worth]
    assert all("Replay of the removal" in (out / page).read_text() for page in pages)


def test_show_and_rerun(once: Path, dcone: Dcone) -> None:
    code, out, err = dcone("campaign", "show", str(once))
    assert (code, "removal.separation below 10.12563103 m" in out) == (0, True), err
    table = pd.read_parquet(once / "table.parquet")
    code, out, err = dcone("campaign", "rerun", str(once), "17", "-o", "again", "--no-figures")
    assert code == 0, err
    assert (Path("again") / "report.html").is_file()
    told = json.loads(Path("again/summary.json").read_text())
    assert told["removal"]["separation"]["value"] == table["removal.separation"][16], "the same bits"
    for folder, number, words in (
        (str(once), "61", "expected 0 for the scene as it is, or 1 to 60"),
        ("again", "1", "no study"),
    ):
        code, _, err = dcone("campaign", "rerun", folder, number)
        assert (code, words in err) == (2, True), err


def test_show_before_the_end(once: Path, tmp_path: Path, dcone: Dcone) -> None:
    folder = shutil.copytree(once, tmp_path / "out")
    (folder / "summary.json").unlink()
    code, out, err = dcone("campaign", "show", str(folder), "--json")
    assert (code, json.loads(out)["cases"]) == (0, 60), err
    assert json.loads(out)["probability"] == json.loads((once / "summary.json").read_text())["probability"]


def test_check_runs_nothing(drift: Path, dcone: Dcone) -> None:
    code, out, err = dcone("campaign", str(drift), "--check")
    assert (code, "60 cases by monte-carlo" in out) == (0, True), err
    assert f"{VELOCITY}: 0.60801 mm/s, 1 mm/s, 1.392 mm/s at 2.5 %" in out
    assert not list(Path().glob("runs"))
    for text in (DRIFT, DRIFT.replace("n = 60", 'until = "95 % within 1 %"')):
        code, out, err = dcone("campaign", str(put_campaign(drift.parent, text)), "--check", "--cases", "7")
        assert (code, "7 cases by monte-carlo" in out) == (0, True), err
    file = put_campaign(drift.parent, 'record = ["removal.separatoin"]\n' + DRIFT)
    code, _, err = dcone("campaign", str(file), "--check")
    assert (code, "is no figure that drift.toml can tell; did you mean 'removal.separation'?" in err) == (2, True), err
    file = put_campaign(drift.parent, DRIFT.replace("10.12563103 m", "10.12563103 kg"))
    code, _, err = dcone("campaign", str(file), "--check")
    assert (code, "removal.separation is in m, its bound is in kg" in err) == (2, True), err
    file = put_campaign(drift.parent, re.sub("success = .*", 'success = "captured"', DRIFT))
    code, _, err = dcone("campaign", str(file), "--check")
    assert (code, "no case of drift can come out so" in err) == (2, True), err


@pytest.mark.parametrize("name", sorted(shipped()))
def test_shipped_campaigns_hold(name: str, dcone: Dcone) -> None:
    code, out, err = dcone("campaign", name, "--check")
    assert (code, "values drawn for each" in out) == (0, True), err


def test_a_failure_is_a_row_with_its_reason(drift: Path, tmp_path: Path) -> None:
    """Of 60 cases, three give no answer: they are told with their reason, and are no part of the probability."""
    out, work = tmp_path / "out", fakes.refuses
    done = commands.campaign(drift, out, Progress(), "processes", jobs=1, with_figures=False, work=work)
    table = pd.read_parquet(tmp_path / "out" / "table.parquet")
    bad = table["status"] == "refused"
    assert table["case"][bad].tolist() == [20, 40, 60]
    assert table["message"][bad].tolist() == ["values that do not go together"] * 3
    assert (done.exit_code, done.content["no_answer"]) == (7, {"refused": 3})
    assert done.content["probability"]["of"] == 57
    assert "no answer from 3 of 60 cases: 3 refused" in done.said


def test_values_that_do_not_go_together() -> None:
    """A worker finds it as it reads the scene, and says so in the scene's terms."""
    row = run_shot(Shot("k", 1, ("removal.tether.damping_ratio=-1",), ground_of(load("table2-deorbit"))))
    assert (row.key, row.status, row.exit_code) == ("k", "refused", 2)
    assert row.message.startswith("removal.tether.damping_ratio = -1: must be at least 0")


def test_a_local_cluster_of_dask() -> None:
    """One process, one case; `-m evidence` runs a whole campaign on two."""
    from dcone_cosim.campaign import cluster

    pytest.importorskip("distributed")
    shot = Shot("k", 1, ('removal.value="0.25"',), ground_of(load("table2-deorbit")))
    with cluster.opened(None, 1) as found:
        assert found.what == "a local cluster of 1 processes"
        assert found.executor.submit(fakes.row_of, shot).result(60.0) == fakes.row_of(shot)


def test_without_dask_it_runs_on_processes(monkeypatch: pytest.MonkeyPatch) -> None:
    from dcone_cosim.campaign import cluster

    monkeypatch.setattr(cluster, "find_spec", lambda name: None)
    with cluster.opened(None, 1) as found:
        assert found.what == "1 processes"
        assert found.executor.submit(abs, -2).result() == 2


def test_nothing_heavy_is_imported_before_it_is_used() -> None:
    """`dcone run` knows nothing of clusters, and a campaign on processes nothing of dask."""
    code = (
        "import sys, dcone_cosim.cli, dcone_cosim.campaign.commands\n"
        "print([m for m in ('dask', 'distributed', 'openturns', 'SALib', 'adaptive', 'scipy') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=ROOT, check=True)
    assert done.stdout.strip() == "[]"
    code = "import sys, dcone_cosim.cli; print([m for m in sys.modules if m.startswith('dcone_cosim.campaign')])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=ROOT, check=True)
    assert done.stdout.strip() == "[]"


def started(*arguments: str, cwd: Path) -> subprocess.Popen[bytes]:
    environment = os.environ | {"PYTHONPATH": ROOT}
    command = [sys.executable, "-c", "from dcone_cosim.cli import main; main()", "campaign", *arguments]
    return subprocess.Popen(command, cwd=cwd, env=environment, stderr=subprocess.PIPE, start_new_session=True)


def rows(folder: Path) -> int:
    return len(list((folder / "rows").glob("*.json")))


def until(condition: Any, patience: float = 240.0) -> None:
    end = time.monotonic() + patience
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.005)


@pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
def test_killed_and_gone_on_with(template: Path, tmp_path: Path) -> None:
    """The client is killed in the midst of it: what is there is kept, and in the end the table has the same bits."""
    file = put_campaign(put_scene(tmp_path / "scene", template).parent, DRIFT.replace("n = 60", "n = 150"))
    once, out = (
        commands.campaign(file, tmp_path / "whole", Progress(), "processes", with_figures=False).folder,
        tmp_path / "out",
    )
    process = started(str(file), "-o", str(out), "--scheduler", "processes", cwd=tmp_path)
    until(lambda: any((out / "rows").glob("*")) or process.poll() is not None)
    process.send_signal(signal.SIGKILL)
    process.communicate()
    kept = {path.name for path in (out / "rows").iterdir()}
    assert kept
    assert not (out / "table.parquet").exists()
    commands.campaign(file, out, Progress(), "processes", with_figures=False)
    assert tables(out) == tables(once)


@pytest.mark.evidence
def test_on_dask(once: Path, tmp_path: Path) -> None:
    """A local cluster of dask gives the same bits as plain processes."""
    pytest.importorskip("distributed")
    done = commands.campaign(once.parent / "scene" / "campaign.toml", tmp_path / "out", Progress(), jobs=2)
    assert tables(done.folder) == tables(once)


def children(pid: int) -> list[int]:
    told = subprocess.run(["pgrep", "-P", str(pid)], capture_output=True, text=True, check=False)
    return [int(word) for word in told.stdout.split()]


@pytest.mark.evidence
@pytest.mark.parametrize("seed", [2026])
def test_ten_kills(template: Path, tmp_path: Path, seed: int, capfd: pytest.CaptureFixture[str]) -> None:
    """Worker, scheduler and client, ten times killed with -9 at random moments: no case is lost or counted twice, and
    the table has the bits of the undisturbed one."""
    pytest.importorskip("distributed")
    file = put_campaign(put_scene(tmp_path / "scene", template).parent, DRIFT.replace("n = 60", "n = 1500"))
    commands.campaign(file, tmp_path / "whole", Progress(), "processes")
    moments, out, told = random.Random(seed), tmp_path / "cut", []
    port = 8800 + os.getpid() % 500
    address = f"tcp://127.0.0.1:{port}"
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    module = [sys.executable, "-m", "distributed.cli.dask_scheduler", "--port", str(port), "--no-dashboard"]
    worker = [sys.executable, "-m", "distributed.cli.dask_worker", address, "--nthreads", "1", "--no-dashboard"]
    environment = os.environ | {"PYTHONPATH": ROOT}

    def begin(command: list[str]) -> subprocess.Popen[bytes]:
        return subprocess.Popen(command, env=environment, cwd=tmp_path, **quiet)  # type: ignore[call-overload,no-any-return]

    scheduler, workers = begin(module), [begin(worker) for _ in range(2)]
    try:
        for kill in range(10):
            what = ("client", "worker", "scheduler")[kill % 3]
            before = rows(out)
            process = started(str(file), "-o", str(out), "--scheduler", address, cwd=tmp_path)
            until(lambda before=before, of=process: rows(out) > before or of.poll() is not None, 120.0)
            time.sleep(moments.uniform(0.0, 2.0))
            if what == "client":
                process.kill()
            elif what == "worker":
                for pid in [*children(workers[0].pid), workers[0].pid]:
                    os.kill(pid, signal.SIGKILL)
                workers[0].wait()
                workers[0] = begin(worker)
                time.sleep(1.0)
                process.kill()
            else:
                scheduler.kill()
                scheduler.wait()
                _, err = process.communicate(timeout=120.0)
                assert process.returncode in (0, 6), err
                for one in workers:
                    one.kill()
                    one.wait()
                scheduler, workers = begin(module), [begin(worker) for _ in range(2)]
            process.communicate()
            told.append((what, rows(out)))
            if (out / "table.parquet").exists():
                break
        process = started(str(file), "-o", str(out), "--scheduler", address, cwd=tmp_path)
        _, err = process.communicate(timeout=300.0)
        assert process.returncode == 0, err
    finally:
        for one in (scheduler, *workers):
            one.kill()
            one.wait()
    with capfd.disabled():
        print(f"rows that lay alone after each kill: {told}")
    assert tables(out) == tables(tmp_path / "whole")
    assert pd.read_parquet(out / "table.parquet")["case"].tolist() == list(range(1, 1501))
