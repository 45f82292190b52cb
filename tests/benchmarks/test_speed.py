"""Timings, as ratios within one run: `pytest -m bench -n 0`. Never assertions: machines are shared and noisy.

`extra_info` carries the figures that matter: nanoseconds per thread and step, and the ratio of FMU to kernel.
"""

import time
from pathlib import Path

import pytest

from fmu_src.catalogue import MODELS
from fmu_src.instance import Instance, ModelFault
from fmu_src.packaging import builds
from tests.conftest import FREE
from tests.packaging.driven import Driven

pytestmark = pytest.mark.bench
MESH = {"net.mesh": 0.5}
REMOVAL = {"reel": "locked", "thrust": "along_track"}
TABLE_2 = {"thrust.level": -0.01, "start.separation": 10.0}


@pytest.fixture(scope="module")
def drive(tmp_path_factory):
    """Make a driven FMU of a model with terms."""
    from fmpy import extract

    cache = Path(tmp_path_factory.getbasetemp()).parent / "fmus"

    def make(model, terms, parameters):
        path = builds.build(MODELS[model].interface(terms), cache)
        return Driven(path, str(extract(str(path), unzipdir=str(tmp_path_factory.mktemp("fmu")))), parameters)

    return make


def test_kernel_and_fmu_on_a_49_by_49_net(benchmark, drive):
    """The whole opening of Table 1's net at 0.5 m: 0 to 9 s, 9e8 threads and steps; one core, double precision."""

    def kernel():
        net = Instance(MODELS["net_capture"], FREE, MESH).initialise()
        began = time.perf_counter()
        net.step(9.0)
        return time.perf_counter() - began, net["solver.steps"] * net["net.threads"]

    def fmu():
        driven = drive("net_capture", FREE, MESH)
        began = time.perf_counter()
        driven.step(9.0)
        return time.perf_counter() - began

    kernel()
    taken = [(kernel(), fmu()) for _ in range(5)]
    work = taken[0][0][1]
    benchmark.extra_info["kernel, ns per thread and step"] = min(k for (k, _), _ in taken) / work * 1e9
    benchmark.extra_info["FMU, ns per thread and step"] = min(f for _, f in taken) / work * 1e9
    benchmark.extra_info["FMU over kernel, median of pairs"] = sorted(f / k for (k, _), f in taken)[2]
    benchmark.pedantic(fmu, rounds=2)
    print({name: round(value, 3) for name, value in benchmark.extra_info.items()})


@pytest.mark.parametrize("damping", [0.0, 0.05])
def test_a_day_of_table_2(benchmark, drive, damping):
    """1440 macro steps of 60 s through fmpy."""

    def day():
        driven = drive("tethered_deorbit", REMOVAL, TABLE_2 | {"tether.damping_ratio": damping})
        began = time.perf_counter()
        for _ in range(1440):
            driven.step(60.0)
        return time.perf_counter() - began

    taken = [day() for _ in range(3)]
    benchmark.extra_info["seconds per simulated day, without loading"] = min(taken)
    benchmark.pedantic(day, rounds=1)
    print({name: round(value, 3) for name, value in benchmark.extra_info.items()})


def test_a_term_left_out_costs_nothing(benchmark):
    """The same free flight with contact, closing and tether compiled in but idle, against the bare net."""
    from tests.conftest import CAPTURE

    far = {"net.mesh": 0.5, "chaser.start_position[2]": -1000.0, "tether.length": 1e4, "closing.time": 1e3}

    def flight(terms, parameters):
        net = Instance(MODELS["net_capture"], terms, parameters).initialise()
        began = time.perf_counter()
        net.step(4.0)
        return time.perf_counter() - began

    flight(FREE, MESH), flight(CAPTURE, far)
    ratios = sorted(flight(CAPTURE, far) / flight(FREE, MESH) for _ in range(5))
    benchmark.extra_info["all terms idle over bare net"] = ratios[2]
    benchmark.pedantic(lambda: flight(FREE, MESH), rounds=1)
    print({name: round(value, 3) for name, value in benchmark.extra_info.items()})


TUMBLING = {
    "target_inertia": (6666.7, 2666.7, 6666.7, 0.0, 0.0, 0.0),
    "target_attachment": (0.0, -1.0, 0.0),
}


@pytest.mark.parametrize(("body", "rate"), [("rigid", 2.0), ("rigid", 5.0), ("box", 5.0)])
def test_a_target_that_tumbles_beside_a_point(benchmark, body, rate):
    """A day of Table 2's tow in macro steps of 60 s, the target turning at so many deg/s, over that of a point."""

    def day(target):
        i = Instance(MODELS["tethered_deorbit"], REMOVAL | {"target": target}, TABLE_2)
        if target != "point":
            for field, value in TUMBLING.items():
                i.array(field)[:] = value
            i.array("target_start_rate")[:] = 0.0, 0.0, rate * 0.017453292519943295
        if target == "box":
            i.array("target_size")[:] = 4.0, 2.0, 4.0
        i.initialise()
        began = time.process_time()
        try:
            for _ in range(1440):
                i.step(60.0)
        except ModelFault as end:
            print(end)
        return (time.process_time() - began) / i.time, i["solver.steps"] / i.time

    point = min(day("point") for _ in range(3))
    other = benchmark.pedantic(lambda: min(day(body) for _ in range(3)), rounds=1)
    benchmark.extra_info["ratio"] = other[0] / point[0]
    print(f"{body} at {rate} deg/s: {other[0] / point[0]:.1f} times the CPU time of a point, "
          f"{other[1] / point[1]:.2f} times its steps")  # fmt: skip
