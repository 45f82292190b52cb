"""Momenta and energy book of every capture in the shipped scenes, added up from what a run records and nothing else.

    python -m tests.net_capture.evidence.books [SCENE ...]

makes `books.json` again (with scenes named: their rows). Each scene runs as it is shipped, up to its last
capture, and of each capture every recorded instant counts. The bodies are the chaser, the target and the catch, which
is net, bullets, vertex and closing cord:

    P = sum of m v,   less the impulse of a test load
    L = sum of m r x v and of each body's spin about its own centre of mass, less the load's moment
    E = 1/2 M v^2 of the chaser and `HOLDS`, what is there;  W = `GAVE`, what came in;  Q = `TOOK`, what was taken

No output of the model that is itself such a sum is used (`momentum`, `angular_momentum`, `energy.remainder`), except to
be held against it: the largest difference is `sums`. Masses are parameters, which the run's provenance tells.

    momentum    largest |P - P0| over the momentum of the shot, without outer forces alone; P0 and L0 are those before
                the shot, when chaser and catch are one: of parameters, with the spin of the target as it is first told
    moment      largest |L - L0| over that times the farthest that a body is from the origin, likewise
    course      under Hill's gravity, in which every body's equation is the same linear one: largest distance of the
                centre of mass of all from its course in closed form, over how far the catch has flown
    open        largest |E0 + W - E - Q| over what came in, and `left` what that is in the end [J]
"""

from __future__ import annotations

import json
import math
import sys
import tempfile
import time
import warnings
from collections.abc import Iterator, Mapping
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from dcone_cosim import load_scene, run
from dcone_cosim.build import energy_entered
from dcone_cosim.loading import shipped
from tests import kernels

RESULT = Path(__file__).with_name("books.json")
COMMAND = "python -m tests.net_capture.evidence.books"
MODEL = "net_capture"
HOLDS = ("energy.kinetic", "energy.elastic", "target.energy", "energy.potential", "contact.stored", "hinge.energy")
GAVE = ("closing.work", "tether.work", "pull_off.work", "ejection.work", "gravity.work")
TOOK = (
    "contact.loss",
    "thread.dissipated",
    "cord.dissipated",
    "air.dissipated",
    "bending.dissipated",
    "wrap.slip_loss",
    "wrap.friction_loss",
    "tether.friction_loss",
    "wall.friction_loss",
    "table.friction_loss",
    "self_contact.loss",
    "break.energy",
    "hinge.loss",
)
EARTH, RADIUS = 3.986004418e14, 6378137.0
"""Gravitational parameter [m3/s2] and equatorial radius [m], WGS 84."""

Array = npt.NDArray[np.float64]


class Recorded:
    """Columns of a phase's table and its parameters."""

    def __init__(self, columns: Mapping[str, Array], values: Mapping[str, float], terms: Mapping[str, str]) -> None:
        self.columns, self.values, self.terms = columns, values, terms
        self.time = columns["time"]

    def vector(self, name: str) -> Array:
        """(rows, 3); zeros where a scene has no such output."""
        if f"{name}[1]" not in self.columns:
            return np.zeros((len(self.time), 3))
        return np.stack([self.columns[f"{name}[{i}]"] for i in (1, 2, 3)], axis=1)

    def sum(self, names: tuple[str, ...]) -> Array:
        """Of those outputs that there are."""
        return np.sum(
            [np.zeros(len(self.time)), *(self.columns[name] for name in names if name in self.columns)], axis=0
        )

    def bodies(self) -> Iterator[tuple[str, Array]]:
        """Name and mass of each, at every row."""
        yield "chaser", np.full(len(self.time), self.values["chaser.mass"])
        yield "catch", self.columns["catch.mass"]
        if "target" in self.terms:
            yield "target", np.full(len(self.time), self.values["target.mass"])


def momenta(of: Recorded) -> tuple[Array, Array]:
    """P and L at every row, see above."""
    momentum, moment = -of.vector("pull_off.impulse"), -of.vector("pull_off.angular_impulse")
    for body, mass in of.bodies():
        own = mass[:, None] * of.vector(f"{body}.velocity")
        momentum = momentum + own
        moment = moment + np.cross(of.vector(f"{body}.position"), own) + of.vector(f"{body}.spin")
    return momentum, moment


def before(of: Recorded) -> tuple[Array, Array]:
    """P and L before the shot: chaser and net in one at the chaser's place, the target's centre of mass at rest."""
    place, drift = (
        np.array([of.values[f"chaser.start_{what}[{i}]"] for i in (1, 2, 3)]) for what in ("position", "velocity")
    )
    own = (of.values["chaser.mass"] + of.columns["catch.mass"][0]) * drift
    return own, np.cross(place, own) + of.vector("target.spin")[0]


def energies(of: Recorded) -> Array:
    """E - W + Q at every row, see above."""
    chaser = 0.5 * of.values["chaser.mass"] * (of.vector("chaser.velocity") ** 2).sum(axis=1)
    return chaser + of.sum(HOLDS) - of.sum(GAVE) + of.sum(TOOK)


def course(of: Recorded, rate: float) -> float:
    """Largest distance of all bodies' centre of mass from its course under Hill's gravity, over the catch's way.

    Source   Clohessy and Wiltshire, J. Aerospace Sci. 27, 1960
    """
    whole = sum(mass for _, mass in of.bodies())
    place = sum(mass[:, None] * of.vector(f"{body}.position") for body, mass in of.bodies()) / whole[:, None]
    drift = sum(mass[:, None] * of.vector(f"{body}.velocity") for body, mass in of.bodies()) / whole[:, None]
    (x, y, z), (u, v, w) = place[0], drift[0]
    angle = rate * (of.time - of.time[0])
    s, c = np.sin(angle), np.cos(angle)
    flown = np.stack(
        [
            (4.0 - 3.0 * c) * x + s / rate * u + 2.0 / rate * (1.0 - c) * v,
            6.0 * (s - angle) * x + y - 2.0 / rate * (1.0 - c) * u + (4.0 * s - 3.0 * angle) / rate * v,
            c * z + s / rate * w,
        ],
        axis=1,
    )
    catch = of.vector("catch.position")
    gone = float(np.linalg.norm(catch - catch[0], axis=1).max())
    return float(np.linalg.norm(place - flown, axis=1).max()) / gone


def judged(of: Recorded) -> dict[str, Any]:
    """Figures of a capture."""
    momentum, moment = momenta(of)
    shot = float(
        np.linalg.norm(of.columns["catch.mass"][0] * (of.vector("catch.velocity") - of.vector("chaser.velocity"))[0])
    )
    farthest = max(float(np.linalg.norm(of.vector(f"{body}.position"), axis=1).max()) for body, _ in of.bodies())
    energy = energies(of)
    came = energy_entered(of.columns)
    open_by = energy[0] - energy
    row: dict[str, Any] = {"gravity": of.terms["gravity"], "rows": len(of.time), "end": float(of.time[-1])}
    if of.terms["gravity"] == "none" and "air" not in of.terms:
        first, turning = before(of)
        row["momentum"] = float(np.linalg.norm(momentum - first, axis=1).max()) / shot
        row["moment"] = float(np.linalg.norm(moment - turning, axis=1).max()) / (shot * farthest)
        told = np.abs(momentum + of.vector("pull_off.impulse") - of.vector("momentum")).max() / shot
        turned = np.abs(moment + of.vector("pull_off.angular_impulse") - of.vector("angular_momentum")).max()
        row["momentum_sums"] = max(float(told), float(turned) / (shot * farthest))
    if of.terms["gravity"] == "hill":
        row["course"] = course(of, math.sqrt(EARTH / (RADIUS + of.values["orbit.altitude"]) ** 3))
    row |= {
        "open": float(np.max(np.abs(open_by) / came)),
        "left": float(open_by[-1]),
        "came": float(came[-1]),
        "sums": float(np.abs(open_by - of.columns["energy.remainder"]).max()),
        "start": float(energy[0]),
        "gave": {name: float(of.columns[name][-1]) for name in GAVE if name in of.columns},
        "took": {name: float(of.columns[name][-1]) for name in TOOK if name in of.columns},
        "now": float(energy[-1] - of.sum(TOOK)[-1] + of.sum(GAVE)[-1]),
    }
    return row


def captures(name: str, settings: Mapping[str, Any] | None = None) -> Iterator[tuple[str, Recorded, str]]:
    """Phase, records and status of each capture of a shipped scene, with other values if some are given."""
    phases = load_scene(name).checked.phases
    shots = [phase.name for phase in phases if phase.main.model == MODEL]
    if not shots:
        return
    kept = [phase.name for phase in phases][: [phase.name for phase in phases].index(shots[-1]) + 1]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # the failures that scenes show
        done = run(load_scene(name, {"phases": kept, **(settings or {})}), progress=False)
    with tempfile.TemporaryDirectory() as folder:
        done.save(Path(folder) / "run", figures=False)
        told = json.loads((Path(folder) / "run" / "provenance.json").read_text())["phases"]
    for shot in filter(done.__contains__, shots):
        frame = done[shot].select_dtypes("number")
        columns = {str(column): frame[column].to_numpy(dtype=float) for column in frame}
        yield shot, Recorded(columns, told[shot]["parameters"], told[shot]["terms"]), done.status


def write(path: Path, command: str, rows: list[dict[str, Any]], *order: str) -> None:
    """A row on each line, in order of these of its entries, beneath the command and the versions that made them."""
    told = {"command": command, "version": {name: version(name) for name in ("dcone-cosim", "numba", "numpy")}}
    head = json.dumps(told, indent=1).removesuffix("\n}")
    lines = ",\n".join(json.dumps(row) for row in sorted(rows, key=lambda row: [row[name] for name in order]))
    path.write_text(f'{head},\n "rows": [\n{lines}\n ]\n}}\n')


def main(*only: str) -> None:
    """Every shipped scene, or those named anew, and what is stored of the others as it is."""
    stored = json.loads(RESULT.read_text())["rows"] if only else []
    for name in only or shipped():
        began = time.process_time()
        stored = [row for row in stored if row["scene"] != name]
        for phase, of, status in captures(name):
            stored.append({"scene": name, "phase": phase, "status": status, **judged(of)})
            print(json.dumps(stored[-1]), f"{time.process_time() - began:.1f} CPU-s", flush=True)
        write(RESULT, COMMAND, stored, "scene", "phase")


if __name__ == "__main__":
    kernels.alone()
    main(*sys.argv[1:])
