"""The two checkers that pip offers find nothing in our FMUs, and something in each FMU that was spoilt.

Both read the model description alone, so it is that of every model and choice of terms that a shipped scene has, in an
archive whose library is no library: nothing is compiled.
"""

from __future__ import annotations

import re
import subprocess
import sys
import zipfile
from functools import cache
from pathlib import Path
from types import SimpleNamespace

import fmpy.validation
import pytest

from dcone_cosim.loading import load, shipped
from fmu_src.catalogue import MODELS
from fmu_src.packaging import builds, kept
from fmu_src.packaging.description import Experiment
from fmu_src.packaging.platforms import host
from tests import validating
from tests.interop.cases import CASES
from tests.interop.measure import TOOLS
from tests.validating import validate_fmu

pytestmark = [pytest.mark.interop, pytest.mark.slow]

FEW = "25"
SPOILT = {
    "two variables of one name": (rb'name="solver\.steps"', b'name="solver.rejected"'),
    "a start value for an output": (rb'(<ScalarVariable [^>]*name="solver\.steps"[^>]*>\s*<Integer)', rb'\1 start="0"'),
    "an output that is not listed": (rb'<Outputs>\s*<Unknown index="\d+"[^>]*?/>', b"<Outputs>"),
}
"""Twins: what is done to the model description of the removal, by pattern and replacement."""
UNREAD = {"a name that is none": (rb'name="solver\.steps"', b'name="solver..steps"')}
"""The same, where `fmutool` finds nothing."""


ONE_BY_ONE = """
import sys
from fmu_manipulation_toolbox.cli.fmutool import fmutool
for path in sys.argv[1:]:
    sys.argv[1:] = ["-input", path, "-check"]
    code = 0
    try:
        fmutool()
    except SystemExit as stop:
        code = 0 if stop.code is None else stop.code
    except BaseException as error:
        code = repr(error)
    for stream in (sys.stdout, sys.stderr):
        print(f"\\n{END}{code}", file=stream, flush=True)
"""
END = "checked, with exit code "


def fmutool(*paths: Path) -> list[tuple[str, list[str]]]:
    """Exit code and complaints of `fmutool -check` for each FMU, all in one process: to load it takes longest."""
    if not TOOLS["container"].version:
        pytest.skip("fmu-manipulation-toolbox is not installed")
    command = [sys.executable, "-c", ONE_BY_ONE.replace("{END}", END), *map(str, paths)]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=120)
    assert done.returncode == 0, done.stderr
    found = []
    streams = [re.split(rf"^{END}(.*)\n", stream, flags=re.MULTILINE) for stream in (done.stdout, done.stderr)]
    assert [len(parts) for parts in streams] == [2 * len(paths) + 1] * 2
    for at in range(0, 2 * len(paths), 2):
        said, errors = ([line for line in parts[at].splitlines() if line] for parts in streams)
        complaints = [line for line in said if re.search(r"WARNING|ERROR|CRITICAL", line)]
        found.append((streams[0][at + 1], complaints + errors))
    return found


def spoil(how: str, folder: Path) -> Path:
    """The removal's FMU with one mistake."""
    path = folder / f"{how}.fmu"
    with zipfile.ZipFile(CASES["removal"].path) as old, zipfile.ZipFile(path, "w") as new:
        for item in old.infolist():
            content = old.read(item)
            if item.filename == "modelDescription.xml":
                content, count = re.subn(*(SPOILT | UNREAD)[how], content, count=1)
                assert count == 1
            new.writestr(item, content)
    return path


@cache
def every_fmu() -> dict[str, tuple[str, dict[str, str]]]:
    """Model and terms of every FMU of every shipped scene, each once, and of a reel control without a motor; with
    outputs for a few nodes, since a check reads every variable."""
    found: dict[str, tuple[str, dict[str, str]]] = {}
    for name in shipped():
        for phase in load(name).phases:
            for c in phase.components:
                terms = {group: FEW if group == "nodes" else term for group, term in c.terms.items()}
                if (c.model, terms) not in found.values():
                    found[f"{name} {c.name}"] = (c.model, terms)
    return found | {"reel control without motor": ("reel_control", {})}


@pytest.fixture(scope="module")
def fmus(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    return {origin: described(*about, tmp_path_factory.mktemp("described")) for origin, about in every_fmu().items()}


def described(name: str, terms: dict[str, str], folder: Path) -> Path:
    model = MODELS[name]
    files = builds.described(model.interface(terms), kept.as_guid("0" * 64), Experiment.of(model))
    files[f"binaries/{host().places[0].folder}/{name}{host().suffix}"] = b"no library"
    path = folder / f"{name}.fmu"
    builds.pack(files, path)
    return path


def test_the_fmus_are_those_of_all_models() -> None:
    kinds = [(model, "motor" in terms) for model, terms in every_fmu().values()]
    assert {model for model, _ in kinds} == {"net_capture", "tethered_deorbit", "reel_control"}
    assert kinds.count(("reel_control", True)) == kinds.count(("reel_control", False)) == 1


@pytest.mark.parametrize("origin", every_fmu())
def test_fmpys_validation_finds_nothing(origin: str, fmus: dict[str, Path]) -> None:
    assert validate_fmu(str(fmus[origin])) == []


def test_fmutools_check_finds_nothing(fmus: dict[str, Path]) -> None:
    assert dict(zip(fmus, fmutool(*fmus.values()), strict=True)) == dict.fromkeys(fmus, ("0", []))


def test_a_name_that_has_the_numbers_of_another_is_judged_by_itself() -> None:
    """Whether it is read before or after one that looks alike."""
    right = ("node[1].x", "node[27].x", "node[3].x", "a1.b22[4,15]", "der(x7)", "der(x,2)", "a[10]")
    wrong = ("1node", "node[27.x", "node[3]x", "a1.2b", "a.22[4,15]", "der(7x)", "der(x,2", "a[1 0]", "node[].x")
    told = [SimpleNamespace(name=name, sourceline=1) for name in (*wrong, *right, *wrong)]
    description = SimpleNamespace(variableNamingConvention="structured", modelVariables=told)
    complaints = validating.said(fmpy.validation._validate_variable_names, description)
    assert [complaint.split('"')[1] for complaint in complaints] == [*wrong, *wrong]


def test_spoilt_fmus_are_found_out(tmp_path: Path) -> None:
    """Each of them, among others that are whole."""
    paths = [spoil(how, tmp_path) for how in SPOILT]
    for path in 2 * [*paths, *(spoil(how, tmp_path) for how in UNREAD)]:
        assert validate_fmu(str(path))
    whole = CASES["removal"].path
    first, *found, last = fmutool(whole, *paths, whole)
    assert first == last == ("0", [])
    for code, complaints in found:
        assert code != "0"
        assert complaints
