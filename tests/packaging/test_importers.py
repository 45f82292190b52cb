"""The FMUs by the calls that FMUChecker, fmusim, fmi4c and MasterSim make, in a program in C that stands for them.

All four ran them by hand; none can be had from PyPI. What they call, and with what, is in the C file.
"""

import shutil
import subprocess

import pytest

from tests.packaging.driven import SMALL, Driven, library_of
from tests.packaging.hosts import NO_VALGRIND, VALGRIND, compile_host

STEPS = 6
TOOLS = ("FMUChecker", "fmusim", "fmi4c", "MasterSim")
CASES = {
    "net_capture": (SMALL["net_capture"][1] | {"tether.vertex_tension": 0.5}, 0.0625),
    "tethered_deorbit": (SMALL["tethered_deorbit"][1] | {"thrust.offset": 0.25, "reel.length_offset": 0.125}, 16.0),
    "removal, linear": ({"start.separation": 11.0, "reel.length_offset": 0.5}, 16.0),
    "removal, commanded": ({"reel.tension": 0.25}, 16.0),
    "reel_control": ({"reel.length": 11.0, "length": 12.5, "length_rate": 0.01}, 1.0),
    "reel control, motor": ({"reel.length": 11.0, "length": 12.5, "length_rate": 0.01}, 1.0),
}
"""Parameters and inputs, and a macro step that a double holds."""


@pytest.fixture(scope="module")
def importers(tmp_path_factory):
    return compile_host("importers.c", tmp_path_factory.mktemp("importers"))


@pytest.fixture
def command(importers, fmu, tmp_path):
    """The program with its arguments for an FMU."""

    def make(name):
        values, step = CASES[name]
        _, folder = fmu(name)
        about = Driven(*fmu(name), None)
        rows = [
            f"{v.type[0].lower()} {v.causality[0]} {v.valueReference} {n in values:d} {float(values.get(n, 0.0))!r}"
            for n, v in about.variables.items()
        ]
        (tmp_path / "variables").write_text("\n".join(rows) + "\n")
        where = [f"{folder}/resources", repr(step), str(tmp_path / "variables")]
        return [str(importers), library_of(folder), about.description.guid, *where]

    return make


def by_fmpy(fmu, name):
    """The Real outputs at the end of the same life in fmpy, in the order of the description."""
    values, step = CASES[name]
    driven = Driven(*fmu(name), values)
    for _ in range(STEPS):
        driven.step(step)
    return [float(value) for value in driven.outputs().values() if isinstance(value, float)]


@pytest.mark.parametrize("name", CASES)
def test_every_tool_gets_the_bits_that_fmpy_gets(command, fmu, name):
    done = subprocess.run(command(name), capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    ends = [[float.fromhex(word) for word in line.split()] for line in done.stdout.splitlines()]
    assert len(ends) == 2 * len(TOOLS)  # the library was loaded twice
    expected = by_fmpy(fmu, name)
    for tool, end in zip(2 * TOOLS, ends, strict=True):
        assert end == expected, tool
    assert any(expected)


@pytest.mark.parametrize("name", CASES)
def test_valgrind_finds_nothing(command, name):
    if not shutil.which("valgrind"):
        pytest.skip(NO_VALGRIND)
    done = subprocess.run([*VALGRIND, *command(name)], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
