"""Stand-ins for FMUs that solve a linear system exactly over each step, and two masses on springs split into two."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np
from scipy.linalg import expm

from dcone_cosim.coupling.coupled import Coupled
from dcone_cosim.coupling.options import Connection, Coupling
from dcone_cosim.fmu.component import CallError, Terminated
from tests.cosim.mock_components import MockComponent


class LinearComponent(MockComponent):
    """x' = A x + B u, y = C x + D u, with the inputs held or moving at a rate over a step.

    longest     steps longer than this are discarded [s]
    ends_at     ends itself there [s]
    forgets     restores everything but its state
    """

    def __init__(
        self,
        name: str,
        matrices: Sequence[Sequence[Sequence[float]]],
        inputs: Sequence[str],
        outputs: Sequence[str],
        start: Sequence[float],
        can_save: bool = True,
        can_interpolate: bool = True,
    ) -> None:
        super().__init__(name, can_save)
        self.can_interpolate = can_interpolate
        self.a, self.b, self.c, self.d = (np.array(m, dtype=float) for m in matrices)
        self.inputs, self.outputs = list(inputs), list(outputs)
        self.state = np.array(start, dtype=float)
        self.rates: dict[str, float] = {}
        self.longest, self.ends_at, self.forgets = math.inf, math.inf, False
        self.asked = 0
        n, m = self.b.shape
        whole = np.zeros((n + 2 * m, n + 2 * m))
        whole[:n, :n], whole[:n, n : n + m], whole[n : n + m, n + m :] = self.a, self.b, np.eye(m)
        self._terms = np.array([np.linalg.matrix_power(whole, k) / math.factorial(k) for k in range(30)])
        self._solution: dict[float, np.ndarray] = {}
        self._states: dict[str, np.ndarray] = {}
        self.declare(inputs, "input")
        self.declare(outputs, "output")

    def _u(self) -> np.ndarray:
        return np.array([self.values[name] for name in self.inputs])

    def set(self, values: Mapping[str, float]) -> None:
        super().set(values)
        self.refresh()

    def set_rates(self, rates: Mapping[str, float]) -> None:
        assert self.can_interpolate
        self.rates |= rates

    def enter_initialisation(self, start: float, stop: float | None = None) -> None:
        super().enter_initialisation(start, stop)
        self.refresh()

    def step(self, time: float, size: float) -> None:
        self.asked += 1
        if size > self.longest:
            raise CallError(self.name, f" stopped at t = {time:.9g} s", "too long", "mock", "Discard", time)
        if time + size > self.ends_at + 1e-12:
            raise Terminated(self.name, f" ended itself at t = {self.ends_at}", "", "mock", "Discard", self.ends_at)
        n, m = self.b.shape
        if size not in self._solution:
            self._solution[size] = np.tensordot(size ** np.arange(len(self._terms)), self._terms, axes=1)
        rates = np.array([self.rates.get(name, 0.0) for name in self.inputs])
        after = self._solution[size] @ np.concatenate([self.state, self._u(), rates])
        self.state = after[:n]
        self.values |= dict(zip(self.inputs, after[n : n + m].tolist(), strict=True))
        self.rates = {}
        super().step(time, size)

    def refresh(self) -> None:
        with np.errstate(over="ignore"):
            found = self.c @ self.state + self.d @ self._u()
        self.values |= dict(zip(self.outputs, found.tolist(), strict=True))

    def save(self, key: str = "") -> None:
        super().save(key)
        self._states[key] = self.state.copy()

    def restore(self, key: str = "") -> None:
        super().restore(key)
        if not self.forgets:
            self.state = self._states[key].copy()
        self.refresh()


MASS, OTHER_MASS = 1.0, 2.0
SPRING, OTHER_SPRING, BETWEEN, DASHPOT = 1.0, 1.5, 0.8, 0.1
START, OTHER_START = (1.0, 0.0), (-0.5, 0.3)


def exact(time: float) -> np.ndarray:
    """Positions and velocities of the two masses: wall, spring, mass, spring and dashpot, other mass, spring, wall."""
    k, c = BETWEEN, DASHPOT
    matrix = [
        [0.0, 1.0, 0.0, 0.0],
        [-(SPRING + k) / MASS, -c / MASS, k / MASS, c / MASS],
        [0.0, 0.0, 0.0, 1.0],
        [k / OTHER_MASS, c / OTHER_MASS, -(OTHER_SPRING + k) / OTHER_MASS, -c / OTHER_MASS],
    ]
    return np.asarray(expm(np.array(matrix) * time) @ np.array([*START, *OTHER_START]))


def by_force(**options: bool) -> tuple[list[LinearComponent], list[Connection]]:
    """One mass takes a force; the other, with the spring between them, gives it from position and speed directly."""
    first = LinearComponent(
        "first",
        ([[0, 1], [-SPRING / MASS, 0]], [[0], [1 / MASS]], np.eye(2), [[0], [0]]),
        ["force"],
        ["position", "velocity"],
        START,
        **options,
    )
    k, c, m = BETWEEN, DASHPOT, OTHER_MASS
    second = LinearComponent(
        "second",
        ([[0, 1], [-(OTHER_SPRING + k) / m, -c / m]], [[0, 0], [k / m, c / m]], [[k, c]], [[-k, -c]]),
        ["position", "velocity"],
        ["force"],
        OTHER_START,
        **options,
    )
    ends = [("first", n, "second", n) for n in ("position", "velocity")] + [("second", "force", "first", "force")]
    return [first, second], [Connection(*end) for end in ends]


def by_motion(**options: bool) -> tuple[list[LinearComponent], list[Connection]]:
    """Both masses have the spring between them and take the other's motion: no output depends directly on an input."""
    made = []
    k, c = BETWEEN, DASHPOT
    for name, mass, spring, start in (
        ("first", MASS, SPRING, START),
        ("second", OTHER_MASS, OTHER_SPRING, OTHER_START),
    ):
        matrices = (
            [[0, 1], [-(spring + k) / mass, -c / mass]],
            [[0, 0], [k / mass, c / mass]],
            np.eye(2),
            np.zeros((2, 2)),
        )
        outputs = ["position", "velocity"]
        made.append(LinearComponent(name, matrices, ["other.position", "other.velocity"], outputs, start, **options))
    names = ("position", "velocity")
    there = [Connection("first", n, "second", f"other.{n}") for n in names]
    back = [Connection("second", n, "first", f"other.{n}") for n in names]
    return made, there + back


def coupled(components: Sequence[MockComponent], connections: Sequence[Connection], **coupling: object) -> Coupled:
    """The components initialised at time zero."""
    whole = Coupled("pair", components, connections, Coupling(**coupling))
    whole.enter_initialisation(0.0)
    whole.exit_initialisation()
    return whole


def run(whole: Coupled, end: float, macro_step: float) -> Coupled:
    for i in range(round(end / macro_step)):
        whole.step(i * macro_step, macro_step)
    return whole


def error_at(whole: Coupled, time: float) -> float:
    """Distance of the state reached from the exact one."""
    state = np.concatenate([c.state for c in whole.components])
    return float(np.linalg.norm(state - exact(time)))
