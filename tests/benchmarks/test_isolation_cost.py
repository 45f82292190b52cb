"""What a process of its own costs an FMU: `pytest -m bench -n 0 -s tests/benchmarks/test_isolation_cost.py`.

Prints the time of a start, of a step with the reading after it, and of saving, in this process and in another, for the
C template's removal, whose own step is nothing. Both give the same rows.
"""

import time

import numpy as np
import pytest

from dcone_cosim.fmu.archive import Archive
from dcone_cosim.fmu.component import output_names
from tests.cosim.fmus.build import build

pytestmark = pytest.mark.bench
STEPS = 5000


def test_isolation_cost(tmp_path):
    rows = {}
    with Archive(build(tmp_path)) as archive:
        print("\n| | start [ms] | step and reading [us] | save [us] |")
        print("| --- | --- | --- | --- |")
        for label, make in (("in this process", archive.instantiate), ("isolated", archive.isolate)):
            marks = [time.perf_counter()]
            with make("tow") as component:
                component.set({"start.relative_velocity[1]": 0.1})
                component.initialise(0.0)
                read = component.reader(output_names(component.variables))
                marks.append(time.perf_counter())
                found = []
                for i in range(STEPS):
                    component.step(float(i), 1.0)
                    found.append(read().copy())
                marks.append(time.perf_counter())
                for _ in range(STEPS):
                    component.save()
                marks.append(time.perf_counter())
            start, steps, saves = np.diff(marks)
            print(f"| {label} | {1e3 * start:.0f} | {1e6 * steps / STEPS:.0f} | {1e6 * saves / STEPS:.0f} |")
            rows[label] = np.array(found)
    np.testing.assert_array_equal(rows["in this process"], rows["isolated"])
