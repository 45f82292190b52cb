"""What a process of its own costs an FMU: `pytest -m bench -n 0 -s tests/benchmarks/test_isolation_cost.py`.

Prints the time of a start and of a step with the reading after it, without and with a state kept before it, in this
process and in another, and the ratio: for the removal of the C template, whose own step is nothing, and for our tow.
The rows are the same. Then how long a look at the floating-point control takes, which every call ends with.
"""

import time

import numpy as np
import pytest

from dcone_cosim import build as models
from dcone_cosim.fmu.archive import Archive
from dcone_cosim.fmu.component import output_names
from dcone_cosim.fmu.floating import Control
from dcone_cosim.scenes.scene import load
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
    ours = models.ensure_fmus({"removal": tow.main.terms}, print)["removal"]
    print("\n| FMU | start [ms] | step and reading [us] | with a state kept [us] |")
    print("| --- | --- | --- | --- |")
    for name, path, values in (
        ("C template", build(tmp_path), {"start.relative_velocity[1]": 0.1}),
        ("our tow", ours, tow.main.parameters),
    ):
        found = []
        with Archive(path) as archive:
            for make in (archive.instantiate, archive.isolate):
                began = time.perf_counter()
                with make("tow") as component:
                    component.set(values)
                    component.initialise(0.0)
                    start = 1e3 * (time.perf_counter() - began)
                    plain, _ = timed(component, keep=False)
                with make("tow") as component:
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
