"""What a process of its own costs an FMU: `pytest -m bench -n 0 -s tests/benchmarks/test_isolation_cost.py`.

Prints the time of a start and of a step with the reading after it, without and with a state kept before it, in this
process and in another, and the ratio: for the removal of the C template, whose own step is nothing, and for our tow.
The rows are the same. Then how long a look at the floating-point control takes, which every call ends with; and an
exchange of 100 bytes with another process by itself: through pipes, asleep until the answer comes or looking for it,
and through shared memory.
"""

import ctypes
import mmap
import os
import time

import numpy as np
import pytest

from dcone_cosim import build as models
from dcone_cosim.fmu import frames
from dcone_cosim.fmu.archive import Archive
from dcone_cosim.fmu.component import Component, output_names
from dcone_cosim.fmu.floating import Control
from dcone_cosim.fmu.isolation import IsolatedComponent
from dcone_cosim.loading import load
from tests.cosim.fmus.build import build

pytestmark = pytest.mark.bench
STEPS, ROUNDS = 1000, 5


def timed(component, keep):
    """Median over some rounds of the time of a step [us], and the last row."""
    read = component.reader(output_names(component.variables))
    rounds = []
    for k in range(ROUNDS):
        began = time.perf_counter()
        for i in range(STEPS):
            if keep:
                component.save()
            component.step(float(k * STEPS + i), 1.0)
            row = read()
        rounds.append(1e6 * (time.perf_counter() - began) / STEPS)
    return np.median(rounds), row.copy()


def test_isolation_cost(tmp_path):
    (tow,) = load("table2-deorbit").phases
    ours = models.ensure([("tethered_deorbit", tow.main.terms)], print)[0]
    print("\n| FMU | start [ms] | step and reading [us] | with a state kept [us] |")
    print("| --- | --- | --- | --- |")
    for name, path, values in (
        ("C template", build(tmp_path), {"start.relative_velocity[1]": 0.1}),
        ("our tow", ours, tow.main.parameters),
    ):
        found = []
        with Archive(path) as archive:
            for make in (Component, IsolatedComponent):
                began = time.perf_counter()
                with make(archive, "tow") as component:
                    component.set(values)
                    component.initialise(0.0)
                    start = 1e3 * (time.perf_counter() - began)
                    plain, _ = timed(component, keep=False)
                with make(archive, "tow") as component:
                    component.set(values)
                    component.initialise(0.0)
                    kept, row = timed(component, keep=True)
                found.append((start, plain, kept, row))
        (here, apart) = found
        for label, row in (("in this process", here), ("isolated", apart)):
            print(f"| {name}, {label} | {row[0]:.0f} | {row[1]:.1f} | {row[2]:.1f} |")
        print(f"| {name}, more | {apart[0] - here[0]:.0f} | {apart[1] - here[1]:.0f} | {apart[2] - here[2]:.0f} |")
        print(f"| {name}, ratio | | {apart[1] / here[1]:.1f} | {apart[2] / here[2]:.1f} |")
        np.testing.assert_array_equal(here[3], apart[3])
    control, began = Control(), time.perf_counter()
    for _ in range(100_000):
        control.changed()
    print(f"a look at the floating-point control: {10.0 * (time.perf_counter() - began):.2f} us")


def through_pipes():
    (read, to_child), (from_child, write) = os.pipe(), os.pipe()
    if not os.fork():
        os.close(to_child)
        stream = frames.Incoming(read)
        while data := stream.read(100):
            os.write(write, data)
        os._exit(0)
    os.close(read)
    stream = frames.Incoming(from_child)

    def exchange(_):
        os.write(to_child, bytes(100))
        stream.read(100)

    return exchange, lambda: os.close(to_child)


def through_shared_memory():
    """Both look at a counter that the other writes."""
    memory = mmap.mmap(-1, mmap.PAGESIZE)
    asked, answered = (ctypes.c_int64.from_buffer(memory, place) for place in (0, 64))
    if not os.fork():
        while asked.value >= 0:
            answered.value = asked.value
        os._exit(0)

    def exchange(number):
        asked.value = number
        while answered.value < number:
            pass

    def end():
        asked.value = -1

    return exchange, end


def test_exchange_cost(monkeypatch):
    found = {}
    for label, make, moment in (
        ("pipes, asleep", through_pipes, 0.0),
        ("pipes, looking", through_pipes, frames.MOMENT),
        ("shared memory, looking", through_shared_memory, 0.0),
    ):
        monkeypatch.setattr(frames, "MOMENT", moment)
        exchange, end = make()
        rounds = []
        for k in range(ROUNDS):
            began = time.perf_counter()
            for i in range(STEPS):
                exchange(k * STEPS + i + 1)
            rounds.append(1e6 * (time.perf_counter() - began) / STEPS)
        end()
        os.wait()
        found[label] = np.median(rounds)
    print("\n" + "; ".join(f"{label}: {took:.1f} us" for label, took in found.items()))
