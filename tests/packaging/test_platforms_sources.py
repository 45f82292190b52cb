"""The `sources/` of an FMU: what is there builds, as its guide says, to the numbers of the shipped binary."""

import re
import shlex
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from dcone_cosim.build import cache_folder
from fmu_src.packaging import link, platforms
from tests.packaging import platform_cases
from tests.packaging.test_fmu import Driven

MODEL = "tethered_deorbit"
CASE = platform_cases.CASES[MODEL]
STEPS = 40

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def fmu():
    return platform_cases.build(MODEL, platforms.host(), cache_folder())


def outputs(fmu, folder, parameters):
    driven = Driven(fmu, str(folder), parameters)
    for _ in range(STEPS):
        driven.step(CASE.step)
    return driven.outputs()


def check_same_numbers(fmu, folder, library):
    """The library just built, in place of the shipped one, gives its bits; another experiment gives others."""
    shipped = outputs(fmu, folder, CASE.parameters)
    (place,) = folder.glob("binaries/*/*")
    copy = folder.with_name(folder.name + "-built")
    shutil.copytree(folder, copy)
    shutil.copyfile(library, copy / place.relative_to(folder))
    assert (copy / place.relative_to(folder)).read_bytes() != place.read_bytes()  # another code path at least
    assert outputs(fmu, copy, CASE.parameters) == shipped
    assert outputs(fmu, copy, {**CASE.parameters, "thrust.level": -0.0101}) != shipped


def test_commands_of_the_guide_build_the_library(fmu, tmp_path):
    folder, _ = platform_cases.unpack(fmu, tmp_path / "fmu")
    guide = (folder / "sources/build.txt").read_text()
    commands = re.findall(r"^ +(python -m ziglang cc -.*)$", guide, re.MULTILINE)
    assert len(commands) == 2
    for command in commands:
        words = [str(link.HEADERS) if word == "PATH" else word for word in shlex.split(command)]
        subprocess.run([sys.executable, *words[1:]], cwd=folder / "sources", check=True, capture_output=True)
    check_same_numbers(fmu, folder, folder / f"sources/{MODEL}.so")


def test_cmake_builds_the_library(fmu, tmp_path):
    cmake = shutil.which("cmake", path=f"{Path(sys.executable).parent}:/usr/local/bin:/usr/bin")
    if cmake is None or not (shutil.which("make") or shutil.which("ninja")):
        pytest.skip("cmake and make are not installed")
    folder, _ = platform_cases.unpack(fmu, tmp_path / "fmu")
    sources = folder / "sources"
    compiler = tmp_path / "clang"
    # with optimisation even where cmake only tries it: without, zig first builds a run-time library of its own
    compiler.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m ziglang cc -O3 -s "$@"\n')
    compiler.chmod(0o755)
    start = [cmake, "-S", sources, "-B", tmp_path / "build", f"-DCMAKE_C_COMPILER={compiler}"]
    refused = subprocess.run(start, capture_output=True, text=True)
    assert refused.returncode != 0
    assert "FMI_HEADERS must name the folder" in refused.stderr
    for command in ([*start, f"-DFMI_HEADERS={link.HEADERS}"], [cmake, "--build", tmp_path / "build"]):
        done = subprocess.run(command, capture_output=True, text=True)
        assert done.returncode == 0, done.stdout + done.stderr
    check_same_numbers(fmu, folder, tmp_path / f"build/{MODEL}.so")


def test_no_source_files_are_promised(fmu):
    """A tool would hand them to any C compiler, which has no use for the IR beside them."""
    with zipfile.ZipFile(fmu) as content:
        assert b"SourceFiles" not in content.read("modelDescription.xml")
        assert "sources/model.ll" in content.namelist()
