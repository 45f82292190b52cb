"""Thousands of instances one after another, fifty at once, and some in threads: flat memory, the same bits."""

import json
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from tests.packaging.cycles import CYCLES
from tests.packaging.driven import SMALL, Driven, library_of
from tests.packaging.raw import OK, Library, Raw

ROOT = Path(__file__).parents[2]
TOLERANCE = 16 * CYCLES
"""Bytes by which a process may grow over all cycles: malloc's smallest piece, 32 bytes on 64 bits, lost once a cycle
would be twice that; what Python's own arenas move about was seen to be less."""
NAMES = ["toy", *SMALL]


@pytest.fixture(scope="module")
def known(built_toy, fmu):
    """Library, GUID, value references, parameters and macro step of an FMU, or the toy."""

    def find(name):
        if name == "toy":
            return str(built_toy.library), built_toy.guid, built_toy.references, {"room": 9}, 0.5
        path, folder = fmu(name)
        about = Driven(path, folder, None)
        references = {n: v.valueReference for n, v in about.variables.items()}
        return library_of(folder), about.description.guid, references, *SMALL[name][1:]

    return find


def grown(known, name, life, leak="none"):
    """Bytes by which a child process grows that does nothing but make and free instances."""
    path, guid, references, values, size = known(name)
    needed = {n: references[n] for n in values}
    argument = json.dumps([path, guid, life, leak, needed, values, size])
    command = [sys.executable, "-m", "tests.packaging.cycles", argument]
    done = subprocess.run(command, capture_output=True, text=True, cwd=ROOT)
    assert done.returncode == 0, done.stderr
    return int(done.stdout)


@pytest.mark.parametrize("life", ["bare", "whole", "crowd"])
@pytest.mark.parametrize("name", NAMES)
def test_memory_stays_flat(known, name, life):
    assert grown(known, name, life) < TOLERANCE


@pytest.mark.parametrize(
    ("life", "leak"), [("bare", "instance"), ("whole", "instance"), ("whole", "state"), ("crowd", "instance")]
)
def test_a_leak_would_be_seen(known, life, leak):
    """The twins: the smallest of all instances, not freed, or its state."""
    assert grown(known, "toy", life, leak) > TOLERANCE


def ends(known, name, steps=20):
    """State of an instance after some steps, as bytes."""
    path, guid, references, values, size = known(name)
    raw = Raw(Library(path), guid, references, logging=False)
    assert raw.start(values) == OK
    for k in range(steps):
        assert raw.step(k * size, size) == OK
    state = raw.save()
    data = raw.serialise(state)
    raw.drop(state)
    raw.free()
    return data


@pytest.mark.parametrize("name", NAMES)
def test_threads_with_an_instance_each_give_the_bits_of_one_alone(known, name):
    known(name)
    alone = ends(known, name)
    with ThreadPoolExecutor(4) as pool:
        together = list(pool.map(lambda _: ends(known, name), range(8)))
    assert set(together) == {alone}
    assert ends(known, name, steps=19) != alone  # the twin: a step less is another state


@pytest.mark.parametrize("name", NAMES)
def test_instances_do_not_touch_one_another(known, name):
    """Two in one process with other parameters, stepped in turn: each as if alone."""
    path, guid, references, values, size = known(name)
    library = Library(path)

    def make(parameters):
        raw = Raw(library, guid, references, logging=False)
        assert raw.start(parameters) == OK
        return raw

    def bits(raw):
        state = raw.save()
        data = raw.serialise(state)
        raw.drop(state)
        return data

    alone = []
    for parameters in (values, {}):
        raw = make(parameters)
        for k in range(4):
            raw.step(k * size, size)
        alone.append(bits(raw))
        raw.free()
    pair = [make(values), make({})]
    for k in range(4):
        for raw in pair:
            raw.step(k * size, size)
    assert [bits(raw) for raw in pair] == alone
    assert alone[0] != alone[1]
    for raw in pair:
        raw.free()
