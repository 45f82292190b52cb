"""Binaries for other platforms, executed: Windows under wine, Linux on arm64 and an old x86-64 under qemu-user.

Release tests (pytest -m release): they need the Debian packages wine64, qemu-user and libc6-arm64-cross, and each is
skipped where its tool is missing. The importer is a plain C program, so no Python stands between.
"""

import os
import shutil
import subprocess
import sys
import urllib.parse
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from dcone_cosim.build import cache_folder
from fmu_src.instance import Instance
from fmu_src.packaging import link, platforms
from tests.packaging import lookup, platform_cases
from tests.packaging.platform_cases import CASES

pytestmark = [pytest.mark.release, pytest.mark.slow]

SPREAD = 1e-14
"""Largest difference between platforms, of an output's largest size. The mathematics libraries differ in last bits:
1.4e-16 was seen in one angle of the removal under wine, and none elsewhere."""
ARM_LIBRARIES = Path("/usr/aarch64-linux-gnu")


@pytest.fixture(scope="module")
def cache():
    return cache_folder()


@pytest.fixture(scope="module")
def native(cache, tmp_path_factory):
    """Outputs of each case on this machine."""
    if platforms.host() is not platforms.LINUX64:
        pytest.skip("compared with Linux on x86-64, which this machine is not")
    fmus = {model: platform_cases.build(model, platforms.LINUX64, cache) for model in CASES}
    return {model: platform_cases.run_case(model, fmu, tmp_path_factory.mktemp(model)) for model, fmu in fmus.items()}


@pytest.fixture(scope="module")
def wine(tmp_path_factory):
    """Command and environment of wine, with a Windows of its own."""
    found = [shutil.which("wine64", path=f"{os.environ['PATH']}:/usr/lib/wine"), shutil.which("wine")]
    program = next(filter(None, found), None)
    if program is None:
        pytest.skip("wine is not installed")
    return (program,), {**os.environ, "WINEPREFIX": str(tmp_path_factory.mktemp("wine")), "WINEDEBUG": "-all"}


def difference(rows, native):
    """Largest difference of any output at any time, of the output's largest size."""
    scale = np.max(np.abs(native), axis=0)
    return np.max(np.abs(rows - native) / np.where(scale > 0.0, scale, 1.0))


def qemu(machine):
    program = shutil.which(f"qemu-{machine}")
    if program is None:
        pytest.skip(f"qemu-{machine} is not installed")
    return program


@pytest.mark.parametrize("model", CASES)
def test_importer_in_c_sees_contact_and_tugs(model, native, cache):
    """The cases reach what they are for."""
    names = list(platform_cases.real_outputs(platform_cases.build(model, platforms.LINUX64, cache)))
    last = dict(zip(names, native[model][-1], strict=True))
    peak = dict(zip(names, native[model].max(axis=0), strict=True))
    if model == "net_capture":
        assert last["contact.impulse"] > 1.0
        assert last["mouth.cord_length"] < 0.2 * peak["mouth.cord_length"]
    else:
        assert peak["tether.tension_peak"] > 1.0
        assert np.count_nonzero(native[model][:, names.index("tether.tension_peak")]) > 3


@pytest.mark.parametrize("model", CASES)
def test_spread_is_narrow(model, native, cache, tmp_path, monkeypatch):
    """The twin: a parameter off by a billionth is told apart from another platform."""
    case = CASES[model]
    name = {"net_capture": "target.start_rate[1]", "tethered_deorbit": "thrust.level"}[model]
    moved = {**case.parameters, name: case.parameters[name] * (1.0 + 1e-9)}
    monkeypatch.setitem(CASES, model, replace(case, parameters=moved))
    fmu = platform_cases.build(model, platforms.LINUX64, cache)
    rows = platform_cases.run_case(model, fmu, tmp_path)
    assert difference(rows, native[model]) > SPREAD


@pytest.mark.parametrize("model", CASES)
def test_windows_under_wine(model, native, wine, cache, tmp_path):
    launcher, environment = wine
    fmu = platform_cases.build(model, platforms.WIN64, cache)
    rows = platform_cases.run_case(model, fmu, tmp_path, launcher, "x86_64-windows-gnu", environment)
    assert difference(rows, native[model]) < SPREAD


@pytest.mark.parametrize("model", CASES)
def test_windows_without_avx2_under_wine(model, native, wine, cache, tmp_path):
    """The plain code path alone, since wine shows the processor as it is."""
    launcher, environment = wine
    (place,) = platforms.WIN64.places
    (target,) = place.targets
    plain_place = replace(place, targets=(replace(target, processors=target.processors[:1]),))
    plain = replace(platforms.WIN64, name="win64-plain", places=(plain_place,))
    fmu = platform_cases.build(model, plain, cache)
    rows = platform_cases.run_case(model, fmu, tmp_path, launcher, "x86_64-windows-gnu", environment)
    assert difference(rows, native[model]) < SPREAD


@pytest.mark.parametrize("place", [place.folder for place in platforms.LINUX_AARCH64.places])
@pytest.mark.parametrize("model", CASES)
def test_linux_on_arm64_under_qemu(model, place, native, cache, tmp_path):
    if not ARM_LIBRARIES.is_dir():
        pytest.skip(f"no arm64 libraries in {ARM_LIBRARIES} (Debian: libc6-arm64-cross)")
    fmu = platform_cases.build(model, platforms.LINUX_AARCH64, cache)
    launcher = (qemu("aarch64"), "-L", str(ARM_LIBRARIES))
    rows = platform_cases.run_case(model, fmu, tmp_path, launcher, "aarch64-linux-gnu.2.17", place=place)
    assert difference(rows, native[model]) < SPREAD


@pytest.mark.parametrize("model", CASES)
def test_processor_without_avx2_takes_the_plain_path(model, native, cache, tmp_path):
    """The very library of this machine, on a Nehalem: the wide instructions would end the process there."""
    fmu = platform_cases.build(model, platforms.LINUX64, cache)
    launcher = (qemu("x86_64"), "-cpu", "Nehalem")
    rows = platform_cases.run_case(model, fmu, tmp_path, launcher)
    assert difference(rows, native[model]) == 0.0


def run_tow(platform, launcher, cache, folder, *more):
    """Rows of the tow on a platform, with more arguments for the importer."""
    folder.mkdir()
    fmu = platform_cases.build("tethered_deorbit", platform, cache)
    place = platform.places[0]
    (target,), more = place.targets, list(map(str, more))
    return platform_cases.run_case(
        "tethered_deorbit", fmu, folder, launcher, target.triple, more=more, place=place.folder
    )


@pytest.fixture(scope="module")
def saved(cache, tmp_path_factory):
    """A state of the tow saved on this machine, in a file, and the rows when it goes on from there, here."""
    folder = tmp_path_factory.mktemp("saved")
    run_tow(platforms.LINUX64, (), cache, folder / "first", f"@{folder / 'state'}")
    return folder / "state", run_tow(platforms.LINUX64, (), cache, folder / "second", f"+{folder / 'state'}")


def test_a_loaded_state_goes_on(saved, native, cache, tmp_path, monkeypatch):
    """As one long run does, to the last bit; and elsewhere than a run from the start."""
    case = CASES["tethered_deorbit"]
    monkeypatch.setitem(CASES, "tethered_deorbit", replace(case, count=2 * case.count))
    whole = run_tow(platforms.LINUX64, (), cache, tmp_path / "whole")
    assert difference(saved[1], whole[case.count :]) == 0.0
    assert difference(saved[1], native["tethered_deorbit"]) > SPREAD


def test_state_crosses_platforms(saved, cache, tmp_path):
    """A state is saved with one layout on both, and one saved here goes on on arm64."""
    if not ARM_LIBRARIES.is_dir():
        pytest.skip(f"no arm64 libraries in {ARM_LIBRARIES} (Debian: libc6-arm64-cross)")
    arm = platforms.LINUX_AARCH64, (qemu("aarch64"), "-L", str(ARM_LIBRARIES)), cache
    path, rows = saved
    run_tow(*arm, tmp_path / "saving", f"@{tmp_path / 'state'}")
    here, there = path.read_bytes(), (tmp_path / "state").read_bytes()
    assert len(here) == len(there)
    assert here[:16] == there[:16]  # what kind of state
    assert here[24:72] == there[24:72]  # of which library; between them stands the check word of all that follows
    assert difference(run_tow(*arm, tmp_path / "loading", f"+{path}"), rows) < SPREAD


ELSEWHERE = {"linux-aarch64": "aarch64", "win64": "wine", "linux64": "here"}


@pytest.mark.parametrize("name", ELSEWHERE)
def test_tables_are_read_on_every_platform(name, request, tmp_path):
    """Mapped there as here, and the same bits, since the lookup has no mathematics library between."""
    launcher, environment = (), None
    if name == "win64":
        launcher, environment = request.getfixturevalue("wine")
    elif name == "linux-aarch64":
        if not ARM_LIBRARIES.is_dir():
            pytest.skip(f"no arm64 libraries in {ARM_LIBRARIES} (Debian: libc6-arm64-cross)")
        launcher = (qemu("aarch64"), "-L", str(ARM_LIBRARIES))
    (target,) = platforms.PLATFORMS[name].places[0].targets
    library = lookup.build(tmp_path / "fmu", lookup.BOTH, target)
    lookup.furnish(tmp_path / "fmu", lookup.given(lookup.BOTH))
    host = platform_cases.compile_host(target.triple, tmp_path)
    references = lookup.MODEL.interface(lookup.BOTH).references
    asked = [f"?{references[n]}" for n in ("y", "sum", "corner", "total")]
    command = [*launcher, host, library, lookup.GUID, "0.5", "2", f"={references['u']}:0.25", *asked]
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, env=environment)
    assert done.returncode == 0, done.stderr
    here = Instance(lookup.MODEL, lookup.BOTH, {"u": 0.25}, lookup.named()).initialise()
    for line in done.stdout.splitlines():
        here.step(0.5)
        assert [float(x) for x in line.split()] == [here[n] for n in ("y", "sum", "corner", "total")]
    assert here["sum"] == pytest.approx(3.0 * here["y"])


@pytest.fixture(scope="module")
def places(tmp_path_factory):
    """A folder with a blank and an umlaut in its name, which holds a file to be found."""
    folder = tmp_path_factory.mktemp("places") / "a b ü" / "resources"
    folder.mkdir(parents=True)
    (folder / "it").write_text("found")
    return folder


def located(program, launcher, environment, locations):
    """What the program says of each location: whether it is one, what the file there holds, and its path."""
    given = "".join(f"{location}\n" for location in locations)
    command = [*launcher, str(program)]
    done = subprocess.run(command, input=given, capture_output=True, encoding="utf-8", env=environment, check=True)
    return [tuple(line.split(" ", 2)) for line in done.stdout.splitlines()]


def test_windows_finds_resources_however_they_are_named(wine, places, tmp_path):
    """Drive letters in all spellings; wine calls the root of this machine Z:."""
    launcher, environment = wine
    program = compile_locate("x86_64-windows-gnu", tmp_path / "locate.exe")
    path = str(places)
    encoded = urllib.parse.quote(path)
    there = [
        f"file:///Z:{encoded}", f"file:/Z:{encoded}", f"file://localhost/Z:{encoded}", f"file:///z:{encoded}/",
        f"file:///Z|{encoded}", f"file:///Z%3A{encoded}", f"file://Z:{encoded}", f"file:Z:{encoded}",
        f"Z:{path}", "Z:" + path.replace("/", "\\"), "Z:" + path.replace("/", "\\") + "\\", f"FILE:///Z:{path}",
    ]  # fmt: skip
    for location, row in zip(there, located(program, launcher, environment, there), strict=True):
        assert row[:2] == ("1", "found"), (location, row)
    nowhere = [f"file:///Z:{encoded}x", f"file:///Y:{encoded}", "file:///Z:/", f"Z:{encoded}"]
    assert [row[1] for row in located(program, launcher, environment, nowhere)] == ["-"] * len(nowhere)
    # the other machine's share is a path of Windows, if none that is there
    ((found, _, name),) = located(program, launcher, environment, ["file://server/share/resources"])
    assert (found, name) == ("1", "//server/share/resources/it")


def compile_locate(target, program):
    shim = Path(link.__file__).parent
    sources = [Path(__file__).parent / "locate.c", shim / "resources.c"]
    command = [sys.executable, "-m", "ziglang", "cc", "-target", target, "-O1", "-std=c99", "-Wall", "-Wextra"]
    subprocess.run([*command, "-I", str(shim), *map(str, sources), "-o", str(program)], check=True)
    return program
