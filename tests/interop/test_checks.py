"""The two checkers that pip offers find nothing in our FMUs, and something in each FMU that was spoilt.

Both read the model description alone, so it is that of every model and choice of terms that a shipped scene has, in an
archive whose library is no library: nothing is compiled.
"""

from __future__ import annotations

import re
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest
from fmpy.validation import validate_fmu

from dcone_cosim.loading import load, shipped
from fmu_src.catalogue import MODELS
from fmu_src.packaging import builds, kept
from fmu_src.packaging.description import Experiment
from fmu_src.packaging.platforms import host
from tests.interop.cases import CASES
from tests.interop.measure import TOOLS

pytestmark = [pytest.mark.interop, pytest.mark.slow]

FEW = "25"
SPOILT = {
    "two variables of one name": (rb'name="solver\.steps"', b'name="solver.rejected"'),
    "a start value for an output": (rb'(<ScalarVariable [^>]*name="solver\.steps"[^>]*>\s*<Integer)', rb'\1 start="0"'),
    "an output that is not listed": (rb'<Outputs>\s*<Unknown index="\d+"[^>]*?/>', b"<Outputs>"),
}
"""Twins: what is done to the model description of the removal, by pattern and replacement."""


def fmutool(path: Path) -> tuple[int, list[str]]:
    """Exit code and complaints of `fmutool -check`."""
    if not TOOLS["container"].version:
        pytest.skip("fmu-manipulation-toolbox is not installed")
    program = "from fmu_manipulation_toolbox.cli.fmutool import fmutool; fmutool()"
    command = [sys.executable, "-c", program, "-input", str(path), "-check"]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=120)
    complaints = [line for line in done.stdout.splitlines() if re.search(r"WARNING|ERROR|CRITICAL", line)]
    return done.returncode, complaints + done.stderr.splitlines()


def spoil(how: str, folder: Path) -> Path:
    """The removal's FMU with one mistake."""
    path = folder / "spoilt.fmu"
    with zipfile.ZipFile(CASES["removal"].path) as old, zipfile.ZipFile(path, "w") as new:
        for item in old.infolist():
            content = old.read(item)
            if item.filename == "modelDescription.xml":
                content, count = re.subn(*SPOILT[how], content, count=1)
                assert count == 1
            new.writestr(item, content)
    return path


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


@pytest.fixture(scope="module", params=every_fmu().items(), ids=list(every_fmu()))
def fmu(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    _, (name, terms) = request.param
    model = MODELS[name]
    files = builds.described(model.interface(terms), kept.as_guid("0" * 64), Experiment.of(model))
    files[f"binaries/{host().places[0].folder}/{name}{host().suffix}"] = b"no library"
    path = tmp_path_factory.mktemp("described") / f"{name}.fmu"
    builds.pack(files, path)
    return path


def test_the_fmus_are_those_of_all_models() -> None:
    kinds = [(model, "motor" in terms) for model, terms in every_fmu().values()]
    assert {model for model, _ in kinds} == {"net_capture", "tethered_deorbit", "reel_control"}
    assert kinds.count(("reel_control", True)) == kinds.count(("reel_control", False)) == 1


def test_fmpys_validation_finds_nothing(fmu: Path) -> None:
    assert validate_fmu(str(fmu)) == []


def test_fmutools_check_finds_nothing(fmu: Path) -> None:
    assert fmutool(fmu) == (0, [])


@pytest.mark.parametrize("how", SPOILT)
def test_a_spoilt_fmu_is_found_out(how: str, tmp_path: Path) -> None:
    path = spoil(how, tmp_path)
    assert validate_fmu(str(path))
    code, complaints = fmutool(path)
    assert code
    assert complaints
