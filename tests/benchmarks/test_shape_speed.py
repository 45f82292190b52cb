"""Nets of every shape beside the square one, CPU time per thread and step: `pytest -m bench -n 0 -s
tests/benchmarks/test_shape_speed.py`.

All fly side by side in this process, a second each in turn; a ratio is the median over pairs, with the least and the
largest behind it. Meshes are of half a metre, threads uncut, fold and shot those of the deployment.
"""

import time
from pathlib import Path

import numpy as np
import pytest

from fmu_src.instance import Instance
from fmu_src.net_capture.interface import MODEL
from fmu_src.net_capture.nets.own_graph import THREADS
from tests.benchmarks.test_net_speed import head, row, spread
from tests.conftest import FREE
from tests.net_capture.laid import Layer
from tests.net_capture.own_files import write

pytestmark = pytest.mark.bench
COMMON = {"net.damping_ratio": 0.05, "net.fold_side": 1.2}
SQUARE = {"net.side": 24.0, "net.mesh": 0.5}
ROUND = {"net.radius": 12.0, "net.mesh": 0.5}
SHAPES = {
    "square": SQUARE,
    "pyramid": {**SQUARE, "net.depth": 12.0},
    "cone": {**ROUND, "net.depth": 12.0, "net.top_radius": 3.0},
    "radial": ROUND,
}
PAIRS, SECONDS = 3, 8
MOST = 1.5


def test_cost_per_thread_and_step(tmp_path: Path):
    """Conical and pyramidal nets cost at most 1.5 times the plain net's; a net from files as ours what ours costs."""
    tables = write(Layer("square").lay({**SQUARE, **COMMON}), tmp_path)
    shuffled = {**tables, THREADS: tables[THREADS][np.random.default_rng(1).permutation(len(tables[THREADS]))]}
    makes = {shape: (shape, values, {}) for shape, values in SHAPES.items()}
    makes |= {"square from files": ("table", {}, tables), "in no order": ("table", {}, shuffled)}
    taken = {name: np.zeros(PAIRS) for name in makes}
    for pair in range(PAIRS):
        nets = {
            name: Instance(MODEL, FREE | {"net": shape}, {**COMMON, **values}, given).initialise()
            for name, (shape, values, given) in makes.items()
        }
        for second in range(SECONDS):
            for name in list(nets) if (pair + second) % 2 == 0 else list(reversed(nets)):
                began = time.process_time()
                nets[name].step(1.0)
                taken[name][pair] += time.process_time() - began
    each = {name: 1e9 * taken[name] / (nets[name]["net.threads"] * nets[name]["solver.steps"]) for name in nets}
    head("net", "threads", "ns per thread and step", "over the square net's")
    for name, costs in each.items():
        threads = f"{nets[name]['net.threads']:.0f}"
        row(name, threads, f"{np.median(costs):.2f}", spread(costs / each["square"]))
    for shape in ("cone", "pyramid"):
        assert np.median(each[shape] / each["square"]) < MOST
