"""Without any flag an FMU that was not built here runs in a process of its own, in every kind of scene.

Whatever it does to its process is one clear error, and costs no results.
"""

from __future__ import annotations

import json
import shutil
import time
from collections.abc import Callable
from pathlib import Path

import pyarrow.parquet
import pytest

from dcone_cosim import build as models
from dcone_cosim.errors import FMU_FAILED
from dcone_cosim.fmu.archive import Archive
from dcone_cosim.loading import load
from dcone_cosim.master import run_scene
from dcone_cosim.progress import Progress
from dcone_cosim.run_folder import phase_table
from dcone_cosim.scene.data import ComponentScene
from dcone_cosim.scene_fmus import SceneFmus, isolated
from fmu_src.packaging.builds import pack
from tests.cosim.conftest import Dcone
from tests.cosim.fmus.build import build
from tests.cosim.ssp_packages import STRUCTURE, packed

TIMES = '{key}macro_step = "{step}"\nduration = "{duration}"\n'
REMOVAL = '[removal]\nfmu = "sound/my_removal.fmu"\nmacro_step = "10 s"\nduration = "100 s"\n'
COMPONENT = '[removal.components.other]\nfmu = "faulty/my_removal.fmu"\n{key}'
SYSTEM = """<ssd:SystemStructureDescription version="1.0" name="plain"
 xmlns:ssd="http://ssp-standard.org/SSP1/SystemStructureDescription"><ssd:System name="plain"><ssd:Elements>
<ssd:Component name="it" source="resources/it.fmu" type="application/x-fmu-sharedlibrary"/></ssd:Elements></ssd:System>
<ssd:DefaultExperiment startTime="0" stopTime="100"/></ssd:SystemStructureDescription>"""
STEP = ("--set", "plain.macro_step=10 s")


def of_removal(folder: Path, switches: list[str], key: str = "") -> tuple[str, ...]:
    build(folder / "faulty", "removal", *switches)
    text = REMOVAL.replace("sound", "faulty").replace("macro_step", f"{key}macro_step")
    (folder / "mine.toml").write_text(text)
    return ("mine.toml",)


def of_capture(folder: Path, switches: list[str], key: str = "") -> tuple[str, ...]:
    build(folder / "faulty", "capture", *switches, when=2.0)
    times = TIMES.format(key=key, step="0.5 s", duration="20 s")
    (folder / "mine.toml").write_text(f'[capture]\nfmu = "faulty/my_capture.fmu"\n{times}')
    return ("mine.toml",)


def of_component(folder: Path, switches: list[str], key: str = "") -> tuple[str, ...]:
    build(folder / "sound")
    build(folder / "faulty", "removal", *switches)
    (folder / "mine.toml").write_text(REMOVAL + COMPONENT.format(key=key))
    return ("mine.toml",)


def of_package(folder: Path, switches: list[str], key: str = "") -> tuple[str, ...]:
    """A system that is neither capture nor removal."""
    fmu = build(folder / "faulty", "removal", *switches, change=lambda xml: xml.replace("separation", "apartness"))
    packed(folder / "mine.ssp", {STRUCTURE: SYSTEM.encode(), "resources/it.fmu": fmu.read_bytes()})
    told = ["--set=it." + line.replace(" = ", "=").replace('"', "") for line in key.splitlines()]
    return ("mine.ssp", *STEP, *told)


KINDS = {"removal": of_removal, "capture": of_capture, "component": of_component, "package": of_package}
WAYS = {
    "CRASH": "ended by SIGSEGV",
    "ABORT": "ended by SIGABRT",
    "EXIT=0": "ended itself with exit code 0",
    "EXIT=3": "ended itself with exit code 3",
    "HANG": "did not answer within 2 s and was killed",
    "CLOSES": "did not answer within 2 s and was killed|closed the stream of our answers",
    'GARBLE="nonsense"': "wrote into the stream of our answers",
}
SLICE = [*((kind, "CRASH") for kind in KINDS), ("removal", "EXIT=0"), ("package", "HANG")]
Make = Callable[[Path, list[str], str], tuple[str, ...]]


def told_of(dcone: Dcone, folder: Path, kind: str, way: str) -> None:
    make: Make = KINDS[kind]
    arguments = make(folder, [way], 'timeout = "2 s"\n' if way in ("HANG", "CLOSES") else "")
    began = time.monotonic()
    code, out, err = dcone("run", *arguments, "-o", "out", "--no-figures")
    assert code == FMU_FAILED, err
    assert time.monotonic() - began < 30.0
    assert "Traceback" not in err
    (line,) = [line for line in err.splitlines() if any(words in line for words in WAYS[way].split("|"))]
    assert line.startswith(("  its process", "  it did not answer"))
    assert f"my_{kind}.fmu" in err or "my_removal.fmu" in err or "it.fmu" in err
    assert "results in out" in out
    phase = {"component": "removal", "package": "plain"}.get(kind, kind)
    assert pyarrow.parquet.read_table(folder / "out" / f"{phase}.parquet").num_rows >= 4


@pytest.mark.parametrize(("kind", "way"), SLICE)
def test_what_ends_its_process_ends_nothing_else(dcone: Dcone, tmp_path: Path, kind: str, way: str) -> None:
    told_of(dcone, tmp_path, kind, way)


@pytest.mark.evidence
@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("kind", KINDS)
def test_every_way_in_every_kind_of_scene(dcone: Dcone, tmp_path: Path, kind: str, way: str) -> None:
    told_of(dcone, tmp_path, kind, way)


@pytest.mark.parametrize("kind", KINDS)
def test_it_can_be_switched_off_and_changes_no_bit(dcone: Dcone, tmp_path: Path, kind: str) -> None:
    """By default, for none and for all of a run, and for one component alone."""
    phase = {"component": "removal", "package": "plain"}.get(kind, kind)
    make: Make = KINDS[kind]
    rows, apart = [], []
    for name, more, key in (
        ("default", (), ""), ("none", ("--no-isolate",), ""), ("all", ("--isolate",), "isolate = false\n"),
        ("one", (), "isolate = false\n"),
    ):  # fmt: skip
        code, _, err = dcone("run", *make(tmp_path, [], key), *more, "-o", name, "--no-figures")
        assert code == 0, err
        rows.append((tmp_path / name / f"{phase}.parquet").read_bytes())
        facts = json.loads((tmp_path / name / "provenance.json").read_text())["phases"][phase]
        others = [other["fmu"]["isolated"] for other in facts.get("components", {}).values()]
        apart.append([facts["fmu"]["isolated"], *others])
    assert rows == [rows[0]] * 4
    count = len(apart[0])
    assert count == 1 + (kind == "component")
    assert apart == [[True] * count, [False] * count, [True] * count, [True] * (count - 1) + [False]]


COUPLINGS = [
    (method, control, extrapolation)
    for method in ("jacobi", "gauss_seidel")
    for control in ("fixed", "error")
    for extrapolation in ("constant", "linear")
]


def same_bits_coupled(method: str, control: str, extrapolation: str, duration: str) -> None:
    """Ours, which can do all of it: their states are kept and gone back to, and their inputs move."""
    told = {"duration": duration, "coupling.method": method, "coupling.control": control}
    told |= {"coupling.extrapolation": extrapolation} | ({"coupling.tolerance": "1e-3"} if control == "error" else {})
    scene = load("reel-control", [f"removal.{key}={value}" for key, value in told.items()])
    tables, statistics = [], []
    for isolate in (False, True):
        with SceneFmus(scene.isolating(isolate), Progress()) as archives:
            run = run_scene(scene, archives.instantiate, Progress())
        assert run.exit_code == 0, run.message
        tables.append(phase_table(run.phases["removal"], ""))
        statistics.append(run.phases["removal"].coupling)
    assert statistics[0] == statistics[1]
    assert (statistics[0]["rejected"] > 0) == (control == "error")
    assert tables[0].equals(tables[1])


def test_coupled_they_give_the_same_bits() -> None:
    same_bits_coupled("gauss_seidel", "error", "linear", "10 min")


@pytest.mark.evidence
@pytest.mark.parametrize(("method", "control", "extrapolation"), COUPLINGS)
def test_every_coupling_gives_the_same_bits(method: str, control: str, extrapolation: str) -> None:
    same_bits_coupled(method, control, extrapolation, "1 h")


def test_only_what_was_built_here_is_ours(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A binary that the cache holds; a name, a key and a GUID can be had by anybody."""
    cache = tmp_path / "cache"
    monkeypatch.setenv("DCONE_CACHE", str(cache))
    cache.mkdir()
    fmu = build(tmp_path / "theirs")
    name = cache / "my_removal-0123456789abcdef-linux64.fmu"

    def apart(path: Path) -> bool:
        with Archive(path) as archive:
            return isolated(ComponentScene("it", fmu=path), archive)

    def contents(path: Path) -> dict[str, bytes]:
        with Archive(path) as archive:
            assert archive.folder is not None
            files = [file for file in archive.folder.rglob("*") if file.is_file()]
            return {file.relative_to(archive.folder).as_posix(): file.read_bytes() for file in files}

    assert apart(fmu)
    shutil.copy(fmu, name)  # as if it had been built
    assert not apart(fmu)
    theirs = contents(fmu)
    binary = next(path for path in theirs if path.startswith("binaries/"))
    for change in ({binary: theirs[binary] + b"\0"}, {f"{binary.rpartition('/')[0]}/libm.so.6": b"\x7fELF"}):
        pack(theirs | change, tmp_path / "claims.fmu")
        assert apart(tmp_path / "claims.fmu"), "with our name, our GUID, and what we never built"
    pack({"modelDescription.xml": theirs["modelDescription.xml"], f"resources/{binary}": theirs[binary]}, name)
    assert apart(fmu), "only a binary of the cache vouches for one"
    name.write_bytes(b"PK\x03\x04 damaged")
    assert apart(fmu)
    assert not isolated(ComponentScene("it", "reel_control"), None)  # type: ignore[arg-type]


def test_another_mass_is_no_other_binary(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The file may be packed anew with other values beside the same binary."""
    monkeypatch.setenv("DCONE_CACHE", str(tmp_path / "cache"))
    (tmp_path / "cache").mkdir()
    built = build(tmp_path / "theirs")
    shutil.copy(built, tmp_path / "cache" / "it.fmu")
    again = build(tmp_path / "again", change=lambda xml: xml.replace('guid="', 'guid="other-'))
    assert built.read_bytes() != again.read_bytes()
    with Archive(again) as archive:
        assert models.is_ours(archive.library)


def test_a_time_limit_isolates_and_none_without(tmp_path: Path) -> None:
    (name,) = of_removal(tmp_path, [], 'timeout = "3 s"\n')
    assert load(str(tmp_path / name)).phases[0].main.isolate is True
    (name,) = of_removal(tmp_path, [])
    assert load(str(tmp_path / name)).phases[0].main.isolate is None
