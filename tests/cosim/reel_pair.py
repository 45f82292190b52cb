"""A removal whose reel is told its tension by a second component, against the removal with the same law inside.

As the coupling step goes to zero, the pair's solution goes to that of the whole.
"""

from __future__ import annotations

import time as clock
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from dcone_cosim.coupling.coupled import Coupled
from dcone_cosim.coupling.options import Connection, Coupling
from dcone_cosim.fmu.component import Steppable
from orbital.constants import EARTH_EQUATORIAL_RADIUS, EARTH_MU
from tests.cosim.linear_components import LinearComponent

LENGTH, PROPORTIONAL, DERIVATIVE = 12.0, 4.155e-3, 2.366
FEED_FORWARD = 3.0 * EARTH_MU / (EARTH_EQUATORIAL_RADIUS + 800e3) ** 3 * (2000.0 * 1000.0 / 3000.0) * LENGTH
WATCHED = ("tether.tension", "separation")
MACRO_STEP, DURATION = 60.0, 1800.0
CONNECTIONS = tuple(
    Connection(*ends)
    for ends in (
        ("removal", "tether.length", "controller", "length"),
        ("removal", "tether.length_rate", "controller", "length_rate"),
        ("controller", "tension", "removal", "reel.tension"),
    )
)
CASES: Mapping[str, Mapping[str, float]] = {
    "taut": {"start.separation": 13.0},
    "slack and taut again": {"start.separation": 9.0, "start.condition": 2.0},
}
"""Start values of the pair of Table 2: on one orbit, the line taut throughout; with equal velocities nearer than the
commanded length, the line slack from 300 s to 900 s."""


class Law(LinearComponent):
    """The linear law as a stand-in: T = max(0, T_ff + k_p (l - l_c) + k_d dl/dt), from its inputs directly."""

    def __init__(self) -> None:
        held = FEED_FORWARD - PROPORTIONAL * LENGTH
        matrices = ([[0.0]], [[0.0, 0.0]], [[1.0]], [[PROPORTIONAL, DERIVATIVE]])
        super().__init__("controller", matrices, ["length", "length_rate"], ["tension"], [held])

    def refresh(self) -> None:
        super().refresh()
        self.values["tension"] = max(0.0, self.values["tension"])


@dataclass(frozen=True)
class Outcome:
    """Tension [N] and separation [m] at the communication points, CPU time [s], and what stepping has cost."""

    rows: np.ndarray
    cpu: float
    statistics: Mapping[str, float]

    def errors(self, reference: Outcome) -> np.ndarray:
        """Largest difference of tension [N] and separation [m]."""
        return np.abs(self.rows - reference.rows).max(axis=0)


def fly(component: Steppable, values: Mapping[str, float]) -> Outcome:
    """Step the component, with these start values, from communication point to communication point, and close it."""
    try:
        component.set(values)
        component.enter_initialisation(0.0, DURATION)
        component.exit_initialisation()
        read = component.reader(WATCHED)
        rows = [[*read()]]
        began = clock.process_time()
        for i in range(round(DURATION / MACRO_STEP)):
            component.step(i * MACRO_STEP, MACRO_STEP)
            rows.append([*read()])
        taken = clock.process_time() - began
    finally:
        component.close()
    return Outcome(np.array(rows), taken, component.statistics if isinstance(component, Coupled) else {})


def whole(case: str, removal: Callable[[str], Steppable]) -> Outcome:
    """The removal with the linear law inside; `removal(law)` makes one."""
    return fly(removal("linear"), CASES[case] | {"reel.length": LENGTH})


def pair(case: str, removal: Callable[[str], Steppable], law: Callable[[], Steppable], **coupling: object) -> Outcome:
    """The removal whose reel obeys, and the law beside it."""
    coupled = Coupled("removal", [removal("commanded"), law()], CONNECTIONS, Coupling(**coupling))
    return fly(coupled, CASES[case])
