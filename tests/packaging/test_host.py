"""Each FMU in a host written in C, as other tools are; there also under valgrind's memcheck."""

import shutil
import subprocess

import pytest

from tests.packaging.driven import SMALL, Driven, library_of
from tests.packaging.hosts import NO_VALGRIND, VALGRIND, compile_host


@pytest.fixture(scope="module")
def host(tmp_path_factory):
    return compile_host("host.c", tmp_path_factory.mktemp("host"))


@pytest.fixture(scope="module")
def hosted(built_toy, fmu):
    """Arguments of the host for an FMU, or the toy."""

    def arguments(name):
        if name == "toy":
            built, r = built_toy, built_toy.references
            return [
                str(built.library),
                built.guid,
                "0.5",
                f"{r['x']},{r['sum']}",
                f"r:{r['push']}=2",
                f"i:{r['room']}=9",
            ]
        path, folder = fmu(name)
        _, parameters, step = SMALL[name]
        driven = Driven(path, folder, parameters)
        kinds = {n: driven.variables[n] for n in parameters}
        settings = [f"{v.type[0].lower()}:{v.valueReference}={parameters[n]!r}" for n, v in kinds.items()]
        outputs = [v for v in driven.variables.values() if v.causality == "output" and v.type == "Real"][:60]
        references = ",".join(str(v.valueReference) for v in outputs)
        return [str(library_of(folder)), driven.description.guid, repr(step), references, *settings]

    return arguments


NAMES = ["toy", *SMALL]


@pytest.mark.parametrize("name", NAMES)
def test_host_takes_it_through_its_life(host, hosted, name):
    done = subprocess.run([host, *hosted(name)], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    values = [float.fromhex(line) for line in done.stdout.split()]
    assert any(values)
    assert " 0 failed" in done.stderr


@pytest.mark.parametrize("name", NAMES)
def test_valgrind_finds_nothing(host, hosted, name):
    if not shutil.which("valgrind"):
        pytest.skip(NO_VALGRIND)
    done = subprocess.run([*VALGRIND, host, *hosted(name)], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def test_valgrind_would_find_a_leak(tmp_path, hosted):
    """The twin: a host that forgets to free its second instance."""
    if not shutil.which("valgrind"):
        pytest.skip(NO_VALGRIND)
    program = compile_host("host.c", tmp_path, "-DFORGETFUL")
    done = subprocess.run([*VALGRIND, program, *hosted("toy")], capture_output=True, text=True)
    assert done.returncode == 99
    assert "fmi2Instantiate" in done.stderr or "definitely lost" in done.stderr
