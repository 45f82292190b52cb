"""The net's FMU against plain C, as ratios of CPU time: `pytest -m bench -n 0 -s tests/benchmarks/test_net_speed.py`.

All contenders of a table fly side by side in this process, a second of flight each in turn, so that what else the
machine does falls on all alike; a ratio is the median over pairs, with the least and the largest behind it. The scene
is the deployment that peers were compared on: damping ratio 0.05, a flat fold of 1.2 m, free flight, on both sides with
a substep of 0.55 / sqrt(k/m).

NET_FMUS_KEEP=FOLDER    keeps the FMUs that were built, under the names that the tables use
NET_FMUS=LABEL=FOLDER   lets FMUs so kept fly too (several with `:` between them): before and after in one run
PLAIN_NET_CC=COMMAND    builds the C with another compiler than the clang that links the FMUs
"""

import math
import os
import shutil
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from fmpy import extract

from dcone_cosim.loading import load
from fmu_src.catalogue import MODELS
from fmu_src.packaging import builds
from tests.benchmarks.plain_net import DEFAULTS, PlainNet, compiled
from tests.conftest import FREE
from tests.net_capture.evidence.mouth_error import SCENES, TIMED, precisions, terms_of
from tests.packaging.driven import Driven

pytestmark = pytest.mark.bench
PAIRS = 5
DEPLOYMENT = SCENES["deployment"]
SUBSTEP = TIMED["deployment"]
LARGER = 1.14
FAR = {"chaser.start_position[2]": -1000.0}
TARGET = {"target": "box"}
CONTACT = TARGET | {"contact": "inelastic"}
CLOSING = TARGET | {"closing": "winches"}
TETHER = {"tether": "slack"}
NODES = {"nodes": "2401"}
HILL = {"gravity": "hill"}
IDLE: Mapping[str, Mapping[str, str]] = {
    "closing": CLOSING,
    "closing and contact": CLOSING | CONTACT,
    "gravity hill": HILL,
    "tether": TETHER,
    "node outputs": NODES,
    "all but gravity": CONTACT | CLOSING | TETHER | NODES,
    "all": CONTACT | CLOSING | TETHER | NODES | HILL,
}
"""Terms that have nothing to do so far from the target, besides those of the bare net; gravity always acts."""
LATE: Mapping[str, float] = {"closing.time": 1e3, "tether.length": 1e4, "closing.axial_stiffness": 90.0}
"""The cord is a soft one, which leaves the substep of the timings to the threads."""
SIZES = {13: (2.0, 5), 25: (1.0, 5), 49: (0.5, 5), 97: (0.25, 3), 145: (1 / 6, 1), 201: (0.12, 1)}
"""Mesh [m] and pairs by knots per side."""

Make = Callable[[], Any]
"""Makes what has `step(seconds)`: an FMU or a plain net at the start of the flight."""


class Hangar:
    """FMUs by name: built here, and those that NET_FMUS tells of."""

    def __init__(self, cache: Path, unpacked: Path) -> None:
        self.cache, self.unpacked = cache, unpacked
        self.folders: dict[Path, str] = {}
        told = [entry.partition("=") for entry in os.environ.get("NET_FMUS", "").split(os.pathsep) if entry]
        self.others = {label: Path(folder) for label, _, folder in told}

    def fmus(self, name: str, terms: Mapping[str, str]) -> dict[str, Path]:
        """Paths by label: the one of these terms as it is built now, and those of that name from elsewhere."""
        built = builds.build(MODELS["net_capture"].interface(terms), self.cache)
        file = f"{name.replace(' ', '_')}.fmu"
        keep = os.environ.get("NET_FMUS_KEEP")
        if keep:
            Path(keep).mkdir(parents=True, exist_ok=True)
            shutil.copy(built, Path(keep) / file)
        kept = {label: folder / file for label, folder in self.others.items()}
        return {"": built} | {label: path for label, path in kept.items() if path.is_file()}

    def drive(self, path: Path, parameters: Mapping[str, float]) -> Driven:
        """An FMU that has been initialised with those of the parameters that it has."""
        if path not in self.folders:
            self.folders[path] = str(extract(str(path), unzipdir=str(self.unpacked / str(len(self.folders)))))
        driven = Driven(path, self.folders[path], None)
        known = {n: v for n, v in parameters.items() if n in driven.variables}
        driven.set({n: v if driven.variables[n].type == "Real" else int(v) for n, v in known.items()})
        driven.initialise()
        return driven

    def at(self, path: Path, parameters: Mapping[str, float], substep: float) -> Make:
        """Makes an FMU that flies with this substep [s]."""
        bound = self.drive(path, parameters).outputs()["solver.stability_bound"]
        ratio = {"solver.step_ratio": substep / bound}
        assert self.drive(path, {**parameters, **ratio}).outputs()["solver.substep"] == pytest.approx(substep)
        return lambda: self.drive(path, {**parameters, **ratio})


@pytest.fixture(scope="module")
def hangar(tmp_path_factory):
    return Hangar(Path(tmp_path_factory.getbasetemp()).parent / "fmus", tmp_path_factory.mktemp("fmus"))


def on_grid(substep: float) -> float:
    """The next shorter substep of which a whole number fits in the model's interval of measures [s]."""
    return 0.01 / math.ceil(0.01 / substep - 1e-9)


def race(
    makes: Mapping[str, Make], legs: Sequence[float], pairs: int = PAIRS
) -> tuple[dict[str, npt.NDArray[np.float64]], dict[str, Any]]:
    """CPU seconds of each contender, (pairs, legs), and the contenders of the last pair where they have come to.

    legs    of the flight, one after another [s]; before each leg the contenders stand at the same instant
    """
    taken = {label: np.zeros((pairs, len(legs))) for label in makes}
    for pair in range(pairs):
        flying = {label: make() for label, make in makes.items()}
        for leg, size in enumerate(legs):
            order = list(flying) if (pair + leg) % 2 == 0 else list(reversed(flying))
            for label in order:
                began = time.process_time()
                flying[label].step(size)
                taken[label][pair, leg] = time.process_time() - began
    return taken, flying


def spread(ratios: npt.NDArray[np.float64]) -> str:
    """Median of the pairs, and the range."""
    return f"{np.median(ratios):.3f} ({ratios.min():.3f} to {ratios.max():.3f})"


def row(*cells: object) -> None:
    print("| " + " | ".join(str(cell) for cell in cells) + " |")


def head(*cells: object) -> None:
    print()
    row(*cells)
    row(*("---" for _ in cells))


def named(what: str, label: str) -> str:
    return f"{what}, {label}" if label else what


def test_ratio_by_second_of_flight(hangar):
    """49 x 49 knots, 8 s: all FMUs over the C at the timed substep, the larger substep too."""
    makes: dict[str, Make] = {"plain C": lambda: PlainNet(DEPLOYMENT, SUBSTEP)}
    for precision in precisions():
        name, what = ("bare", "FMU") if precision == "double" else (precision, f"FMU, {precision} precision")
        for label, path in hangar.fmus(name, terms_of(precision)).items():
            makes[named(what, label)] = hangar.at(path, DEPLOYMENT, SUBSTEP)
            larger = on_grid(LARGER * SUBSTEP)
            makes[named(f"{what}, substep x {LARGER}", label)] = hangar.at(path, DEPLOYMENT, larger)
    taken, flown = race(makes, [1.0] * 8)
    plain = taken["plain C"]
    print(f"\nplain C: {compiled()[1]}; {np.median(plain.sum(1)):.2f} CPU-s")
    head("over plain C", "8 s", *(f"{second}" for second in range(1, 9)), "ns per thread and step")
    for label, seconds in taken.items():
        work = flown["plain C"].threads * 8.0 / SUBSTEP
        if isinstance(flown[label], Driven):
            outputs = flown[label].outputs()
            work = outputs["net.threads"] * outputs["solver.steps"]
            assert outputs["mouth.area"] == pytest.approx(flown["plain C"].mouth_area(), rel=0.01)
        total = seconds.sum(1)
        by_second = (f"{ratio:.2f}" for ratio in np.median(seconds / plain, axis=0))
        row(label, spread(total / plain.sum(1)), *by_second, f"{1e9 * np.median(total) / work:.2f}")


def test_terms_that_have_nothing_to_do(hangar):
    """49 x 49 knots, the first 8 s, far from the target: over the bare net of the same origin."""
    parameters = {**DEPLOYMENT, **FAR, **LATE}
    makes = {
        (name, label): hangar.at(path, parameters, SUBSTEP)
        for name, terms in {"bare": {}, **IDLE}.items()
        for label, path in hangar.fmus(name if name == "bare" else f"idle {name}", FREE | dict(terms)).items()
    }
    taken, _ = race(makes, [1.0] * 8)
    head("compiled in and idle, over the bare net", "8 s")
    for (name, label), seconds in taken.items():
        if ("bare", label) in taken:
            row(named(name, label), spread(seconds.sum(1) / taken["bare", label].sum(1)))


def test_cost_by_size(hangar):
    """All 8 s for every size, the substep in proportion to the mesh: ns per thread and step. Ten minutes."""
    fmus = hangar.fmus("bare", FREE)
    head("knots per side", "plain C [ns]", *(f"{named('FMU', label)} [ns], over 49, over plain C" for label in fmus))
    rows: dict[int, dict[str, float]] = {}
    ratios: dict[tuple[int, str], str] = {}
    for knots, (mesh, pairs) in SIZES.items():
        parameters, substep = {**DEPLOYMENT, "net.mesh": mesh}, on_grid(SUBSTEP * mesh / DEPLOYMENT["net.mesh"])
        makes = {label: hangar.at(path, parameters, substep) for label, path in fmus.items()}
        makes["plain C"] = lambda parameters=parameters, substep=substep: PlainNet(parameters, substep)
        taken, flown = race(makes, [1.0] * 8, pairs)
        work = flown["plain C"].threads * 8.0 / substep
        assert flown["plain C"].knots == knots
        rows[knots] = {label: 1e9 * np.median(seconds.sum(1)) / work for label, seconds in taken.items()}
        for label in fmus:
            ratios[knots, label] = spread(taken[label].sum(1) / taken["plain C"].sum(1))
    for knots, costs in rows.items():
        cells = (f"{costs[label]:.2f}, {costs[label] / rows[49][label]:.2f}, {ratios[knots, label]}" for label in fmus)
        row(knots, f"{costs['plain C']:.2f}", *cells)


def test_capture_of_the_mission(hangar):
    """The mission's capture by its own steps; a plain net of its own in free flight for as long is the unit."""
    phase = load("mission").phases[0]
    fmus = hangar.fmus("mission", phase.main.terms)
    makes: dict[str, Make] = {
        named("FMU", label): lambda path=path: hangar.drive(path, phase.main.parameters) for label, path in fmus.items()
    }
    trial = makes["FMU"]()
    substep = trial.outputs()["solver.substep"]
    while not trial.outputs()["captured"]:
        trial.step(phase.macro_step)
    legs = [phase.macro_step] * round(trial.time / phase.macro_step)
    own = {name: phase.main.parameters.get(name, start) for name, start in DEFAULTS.items()}
    makes["plain C"] = lambda: PlainNet(own, substep)
    taken, flown = race(makes, legs)
    plain = taken["plain C"].sum(1)
    head(f"mission's capture, {trial.time:.2f} s", "over plain C", "CPU [s]", "substep [s]")
    for label, seconds in taken.items():
        used = flown[label].outputs()["solver.substep"] if isinstance(flown[label], Driven) else substep
        row(label, spread(seconds.sum(1) / plain), f"{np.median(seconds.sum(1)):.2f}", f"{used:.3g}")
