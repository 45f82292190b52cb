"""Instances made and freed in a process of its own: `python -m tests.packaging.cycles JSON`; prints bytes grown.

The life is `bare` (instantiate, free), `whole` (set, initialise, step, save, restore, serialise, free) or `crowd`
(fifty at once, stepped in turn, each freed). The leak is `none`, or what is left unfreed: `instance`, `state`.
"""

import gc
import json
import math
import os
import sys

from tests.packaging.raw import OK, Library, Raw

WARM, CYCLES, CROWD, ROUNDS = 3000, 3000, 50, 3
"""Cycles before memory is looked at (Python and malloc have then found their size), cycles that count, how many
instances a crowd has, and how often cycles are counted while memory grows: a leak loses as much each time, what malloc
moves about comes once."""


def resident():
    """Bytes of this process in memory (Linux)."""
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def begin(library, guid, names):
    return Raw(library, guid, names, logging=False, hears=False)


def live(raw, values, size, leak):
    """A short life up to its end."""
    assert raw.start(values) == OK, raw.last
    assert raw.step(0.0, size) == OK, raw.last
    state = raw.save()
    assert raw.restore(state) == OK
    status, copy = raw.deserialise(raw.serialise(state))
    assert status == OK
    raw.drop(copy)
    if leak != "state":
        raw.drop(state)


def one(make, life, leak, values, size):
    raw = make()
    if life == "whole":
        live(raw, values, size, leak)
    if leak != "instance":
        raw.free()


def crowd(make, leak, values, size):
    """Fifty at once; the saved states of all are the same, bit for bit."""
    many = [make() for _ in range(CROWD)]
    for raw in many:
        assert raw.start(values) == OK
    for k in range(2):
        for raw in many:
            assert raw.step(k * size, size) == OK
    states = [raw.save() for raw in many]
    assert len({raw.serialise(state) for raw, state in zip(many, states, strict=True)}) == 1
    for raw, state in zip(many, states, strict=True):
        raw.drop(state)
        if leak != "instance":
            raw.free()


def grown(library, guid, life, leak, names, values, size):
    """Bytes by which memory has grown over the cycles at least, after some to warm up."""

    def make():
        return begin(library, guid, names)

    def run(count):
        for k in range(count):
            if k % 100 == 0:
                gc.collect()
            if life == "crowd":
                crowd(make, leak, values, size)
            else:
                one(make, life, leak, values, size)
        gc.collect()

    each = CROWD if life == "crowd" else 1
    run(WARM // each)
    least = math.inf
    for _ in range(ROUNDS):
        before = resident()
        run(CYCLES // each)
        least = min(least, resident() - before)
        if least <= 0:
            break
    return least


if __name__ == "__main__":
    path, guid, life, leak, names, values, size = json.loads(sys.argv[1])
    print(grown(Library(path), guid, life, leak, names, values, size))
