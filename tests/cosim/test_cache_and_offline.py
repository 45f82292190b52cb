"""The cache of built FMUs, what a long build tells, and the promise of --offline."""

from __future__ import annotations

import json
import os
import shutil
import socket
import subprocess
import sys
import threading
import time
import tomllib
import zipfile
from collections.abc import Iterator
from pathlib import Path

import pytest

from dcone_cosim import build, offline, progress
from dcone_cosim.cache import Times, age, clear, listing, spoken_age
from dcone_cosim.errors import InputError
from dcone_cosim.scratch import Scratch
from fmu_src.packaging import builds, start_values
from tests.cosim.conftest import Dcone

XML = '<fmiModelDescription modelName="{}" description="A net. Built with: {}. Left out: nodes."/>'
CAPTURE = "net_capture-0123456789abcdef-linux64"
REMOVAL = "tethered_deorbit-456789abcdef0123-linux64"
DAY = 86400.0


def keep(folder: Path, name: str, days: float, terms: str = "net square, gravity none") -> Path:
    path = folder / f"{name}.fmu"
    with zipfile.ZipFile(path, "w") as archive:
        model, key, _ = name.split("-")
        archive.writestr("modelDescription.xml", XML.format(model, terms))
        archive.writestr(
            start_values.PATH, start_values.content(build.CATALOGUE["reel_control"].interface({}), key, "")
        )
        archive.writestr(f"binaries/linux64/{model}.so", b"library")
    then = time.time() - days * DAY
    os.utime(path, (then, then))
    return path


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A cache with two FMUs, a build that is going on, and one that was killed."""
    monkeypatch.setenv("DCONE_CACHE", str(tmp_path))
    keep(tmp_path, CAPTURE, 40.0)
    keep(tmp_path, REMOVAL, 2.0, "reel locked")
    with Scratch(tmp_path) as living:
        (living / "model.ll").write_text("half a model")
        (tmp_path / ".dcone-killed.lock").touch()
        (tmp_path / ".dcone-killed").mkdir()
        (tmp_path / ".dcone-killed" / "model.ll").write_text("half a model")
        yield tmp_path


class TestCache:
    def test_list(self, dcone: Dcone, folder: Path) -> None:
        for arguments in (("cache",), ("cache", "list")):
            code, out, _ = dcone(*arguments)
            first, second, last = out.splitlines()
            assert code == 0
            assert first.startswith(f"{REMOVAL}.fmu")
            assert first.endswith("2 d  reel locked")
            assert second.endswith("40 d  net square, gravity none")
            assert last.startswith("2 FMUs, ")
            assert last.endswith(f"in {folder}")
        rows = json.loads(dcone("cache", "list", "--json")[1])
        assert [row["model"] for row in rows] == ["tethered_deorbit", "net_capture"]
        assert dcone("cache", "path")[1].strip() == str(folder)

    def test_clear_touches_nothing_that_is_being_built(self, dcone: Dcone, folder: Path) -> None:
        code, out, _ = dcone("cache", "clear", "--older-than", "30d")
        assert (code, out.startswith("1 FMUs removed")) == (0, True)
        living, lock, kept = sorted(p.name for p in folder.iterdir())
        assert (lock, kept) == (f"{living}.lock", f"{REMOVAL}.fmu")
        assert dcone("cache", "clear")[1].startswith("1 FMUs removed")
        assert sorted(p.name for p in folder.iterdir()) == [living, lock]
        assert (folder / living / "model.ll").exists()

    def test_kernels_kept_for_other_choices_of_terms_are_told_and_cleared(self, dcone: Dcone, folder: Path) -> None:
        old, young = (folder / builds.COMMON / "key" / name for name in ("old", "young"))
        old.parent.mkdir(parents=True)
        for path, days in ((old, 40.0), (young, 1.0)):
            path.write_bytes(bytes(50_000))
            os.utime(path, (time.time() - days * DAY,) * 2)
        assert ", and 100 kB for others, in" in dcone("cache", "list")[1]
        dcone("cache", "clear", "--older-than", "30d")
        assert (old.exists(), young.exists()) == (False, True)
        dcone("cache", "clear")
        assert not (folder / builds.COMMON).exists()

    def test_a_cache_that_is_not_there_is_empty(self, dcone: Dcone, tmp_path: Path, monkeypatch) -> None:
        monkeypatch.setenv("DCONE_CACHE", str(tmp_path / "none"))
        assert dcone("cache")[1].startswith("0 FMUs, 0 kB")
        assert dcone("cache", "clear")[1].startswith("0 FMUs removed")
        assert not (tmp_path / "none").exists()

    def test_a_damaged_one_is_told_and_cleared(self, folder: Path) -> None:
        (folder / f"{CAPTURE}.fmu").write_bytes(b"cut")
        assert "damaged" in next(kept.terms for kept in listing(folder, build.fault) if kept.model == "net_capture")
        assert clear(folder)[0] == 2

    def test_any_damage_is_told_and_cleared(self, dcone: Dcone, folder: Path) -> None:
        """A byte in deflated data, which zlib answers; the file of another; a folder; a name of nobody's."""
        data = bytearray((folder / f"{CAPTURE}.fmu").read_bytes())
        data[40] ^= 0xFF
        (folder / f"{CAPTURE}.fmu").write_bytes(data)
        shutil.copy(folder / f"{REMOVAL}.fmu", folder / "tethered_deorbit-0000000000000000-linux64.fmu")
        (folder / "reel_control-0000000000000000-linux64.fmu" / "within").mkdir(parents=True)
        (folder / "mine.fmu").touch()
        code, out, _ = dcone("cache", "list")
        told = dict(line.split("  ", 1) for line in out.splitlines()[:-1])
        assert code == 0
        for name, wrong in (
            (CAPTURE, "damaged"), ("tethered_deorbit-0000000000000000-linux64", "another's"),
            ("reel_control-0000000000000000-linux64", "no file"), ("mine", "gives to no FMU"),
        ):  # fmt: skip
            assert f"{wrong}" in told[f"{name}.fmu"]
            assert "built when it is needed" in told[f"{name}.fmu"]
        assert "reel locked" in told[f"{REMOVAL}.fmu"]
        assert dcone("cache", "clear")[:2][0] == 0
        assert not list(folder.glob("*.fmu"))

    @pytest.mark.parametrize(
        ("text", "seconds"), [("30d", 30 * DAY), ("12 h", 12 * 3600.0), ("2w", 14 * DAY), ("5min", 300.0)]
    )
    def test_ages(self, text: str, seconds: float) -> None:
        assert age(text) == seconds
        assert spoken_age(seconds).endswith((" d", " h", " min"))

    @pytest.mark.parametrize("text", ["30", "d", "-3d", "3 y", "soon"])
    def test_what_is_no_age(self, dcone: Dcone, folder: Path, text: str) -> None:
        code, _, err = dcone("cache", "clear", "--older-than", text)
        assert (code, f"--older-than {text}: expected a number with" in err) == (2, True)
        assert len(listing(folder, build.fault)) == 2


class TestWaiting:
    def test_how_long_it_took_is_remembered(self, tmp_path: Path) -> None:
        times = Times(tmp_path)
        assert times.spoken() == "this may take a minute or two"
        times.keep(48.3)
        assert times.spoken() == "it took 48 s before"
        times.keep(31.0)
        assert Times(tmp_path).spoken() == "it took 40 s before"
        for _ in range(9):
            times.keep(20.0)
        assert times.spoken() == "it took 20 s before"
        for damaged in ("{", "[]", '{"seconds": [NaN]}', '{"seconds": 3}', "\x00"):
            (tmp_path / "build-times.json").write_text(damaged)
            assert times.spoken() == "this may take a minute or two"
            times.keep(7.0)
            assert times.spoken() == "it took 7 s before"
        Times(tmp_path / "none").keep(1.0)
        assert not (tmp_path / "none").exists()

    def test_a_build_says_how_long_before_it_begins(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setenv("DCONE_CACHE", str(tmp_path))
        Times(tmp_path).keep(48.0)

        def build_all(interfaces, cache, announce, platforms, workplace):
            announce("building reel_control with  (once; kept in there)")
            announce("linking reel_control for linux64")
            return [[tmp_path / "x.fmu"] for _ in interfaces]

        monkeypatch.setattr("fmu_src.packaging.builds.build_all", build_all)
        said: list[str] = []
        wanted = ("reel_control", {})
        assert build.ensure([wanted, wanted], said.append) == [tmp_path / "x.fmu"] * 2
        assert said[0] == "building reel_control with  (once; kept in there); it took 48 s before"
        assert len(said) == 2

    def test_a_line_now_and_then_while_it_builds(self, monkeypatch, capsys: pytest.CaptureFixture[str]) -> None:
        monkeypatch.setattr(progress, "REMINDER", 0.05)
        lines = progress.Lines()
        with lines.working("building"):
            time.sleep(0.2)
        assert not capsys.readouterr().err, "nothing was built, so nothing is said"
        with lines.working("building"):
            lines.say("building net_capture")
            time.sleep(0.2)
        assert "still building, 0 s so far" in capsys.readouterr().err
        assert threading.active_count() < 20

    def test_the_bar_shows_the_time_that_has_gone(self) -> None:
        elapsed = progress._Elapsed()
        elapsed._began -= 12.0
        assert f"{elapsed}" == "12 s"


@pytest.fixture
def away(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Offline for one test."""
    for name in offline.PROXIES:
        monkeypatch.setenv(name, "before")
        monkeypatch.setenv(name.upper(), "before")
    for name in ("no_proxy", "NO_PROXY"):
        monkeypatch.setenv(name, "before")
    offline.go_offline()
    yield
    offline.go_online()


class TestOffline:
    def test_every_connection_is_refused(self, away: None) -> None:
        with pytest.raises(
            InputError, match=r"--offline: a connection to 192\.0\.2\.1 was refused; nothing is fetched"
        ):
            socket.create_connection(("192.0.2.1", 80), timeout=1.0)
        with pytest.raises(InputError, match=r"a connection to example\.org"):
            socket.getaddrinfo("example.org", 80)
        assert os.environ["https_proxy"] == offline.NOWHERE

    def test_online_nothing_is_refused(self) -> None:
        with socket.create_server(("127.0.0.1", 0)) as server:
            socket.create_connection(server.getsockname(), timeout=5.0).close()

    def test_an_address_is_refused_with_and_without(self, dcone: Dcone, tmp_path: Path, away: None) -> None:
        (tmp_path / "mine.toml").write_text(
            '[removal]\nfmu = "https://example.org/x.fmu"\nmacro_step = "1 s"\nduration = "9 s"\n'
        )
        for more in ((), ("--offline",)):
            code, _, err = dcone("run", str(tmp_path / "mine.toml"), *more)
            assert code == 2
            assert "line 2: removal.fmu" in err
            assert "is an address: nothing is fetched; download the FMU and give its path" in err

    @pytest.mark.slow
    @pytest.mark.skipif(shutil.which("unshare") is None, reason="needs network namespaces of Linux")
    @pytest.mark.parametrize("anew", [False, pytest.param(True, marks=pytest.mark.evidence)])
    def test_a_build_needs_no_network(self, tmp_path: Path, anew: bool) -> None:
        """In a network namespace without any interface; and with an empty cache of clang's too, which then builds its C
        library."""
        probe = subprocess.run(["unshare", "-rn", "true"], check=False, capture_output=True)
        if probe.returncode:
            pytest.skip("this system allows no network namespaces")
        program = "from dcone_cosim import build; print(build.ensure([('reel_control', {})], print)[0])"
        environment = {
            **os.environ,
            "DCONE_CACHE": str(tmp_path / "fmus"),
            **({"ZIG_GLOBAL_CACHE_DIR": str(tmp_path / "zig")} if anew else {}),
        }
        done = subprocess.run(
            ["unshare", "-rn", sys.executable, "-c", program],
            env=environment,
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, done.stdout + done.stderr
        assert Path(done.stdout.splitlines()[-1]).exists()


class TestCommandLine:
    def test_version(self, dcone: Dcone) -> None:
        told = tomllib.loads((Path(__file__).parents[2] / "pyproject.toml").read_text())["project"]["version"]
        assert dcone("--version")[:2] == (0, f"dcone {told}\n")

    def test_help_loads_nothing_heavy(self) -> None:
        program = (
            "import sys\nfrom dcone_cosim import cli\nsys.argv = ['dcone', '--help']\n"
            "try:\n    cli.main()\nexcept SystemExit:\n    pass\n"
            "heavy = {'numpy', 'astropy', 'fmpy', 'pyarrow', 'numba', 'matplotlib', 'tomlkit', 'lxml', 'rich'}\n"
            "sys.exit(', '.join(sorted(heavy & set(sys.modules))) or 0)"
        )
        done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr

    @pytest.mark.parametrize(
        ("words", "expected"),
        [("dcone run mis", {"mission"}), ("dcone validate table", {"table1-capture", "table2-deorbit"}),
         ("dcone new x --from mis", {"mission"}), ("dcone interface cap", {"capture"}),
         ("dcone run my/", {"my/own.toml"})],
    )  # fmt: skip
    def test_completion(self, tmp_path: Path, words: str, expected: set[str]) -> None:
        (tmp_path / "my").mkdir()
        (tmp_path / "my" / "own.toml").touch()
        environment = {**os.environ, "_DCONE_COMPLETE": "complete_bash", "COMP_WORDS": words,
                       "COMP_CWORD": str(len(words.split()) - 1)}  # fmt: skip
        program = "import sys; sys.argv = ['dcone']; from dcone_cosim import cli; cli.app(prog_name='dcone')"
        done = subprocess.run(
            [sys.executable, "-c", program], env=environment, cwd=tmp_path, capture_output=True, text=True, check=False
        )
        assert set(done.stdout.split()) == expected, done.stderr

    def test_validate_tells_all_scenes(self, dcone: Dcone, tmp_path: Path) -> None:
        (tmp_path / "bad.toml").write_text('[removal]\nmacro_step = 1\n[removal.reel]\nlaw = "lokced"\n')
        code, out, err = dcone("validate", "mission", str(tmp_path / "bad.toml"), "misson")
        assert (code, out) == (2, "mission: ok (capture, removal)\n")
        assert "bad.toml: 3 mistakes" in err
        assert "did you mean 'mission'?" in err
        code, out, _ = dcone("validate", "mission", str(tmp_path / "bad.toml"), "--json")
        good, bad = json.loads(out)
        assert (code, good["ok"], bad["ok"]) == (2, True, False)
        places = [(row["line"], row["key"], row["nearest"]) for row in bad["mistakes"]]
        assert places == [
            (1, "removal.duration", None), (2, "removal.macro_step", None), (4, "removal.reel.law", "locked"),
        ]  # fmt: skip

    def test_run_answers_with_the_mistakes_too(self, dcone: Dcone) -> None:
        code, out, _ = dcone("run", "mission", "--set", "capture.net.sied=3 m", "--json")
        answer = json.loads(out)
        assert (code, answer["exit_code"]) == (2, 2)
        assert [row["place"] for row in answer["mistakes"]] == ["--set capture.net.sied=3 m"]
