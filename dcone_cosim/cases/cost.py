"""What a case would take: it is begun, stepped for a tenth of a second, and reckoned on from there.

A phase that grows dearer on its way says in what state it costs most (`Phase.laden`): it is begun in that too, and the
price of a step is drawn from the one to the other.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

from dcone_cosim.cases.pace import spoken
from dcone_cosim.cases.work import run_alone
from dcone_cosim.phases import kind_of
from dcone_cosim.results import PhaseResult
from dcone_cosim.scene.data import Scene

ENOUGH = 0.1
"""CPU time after which an estimate is good enough [s]."""
SHORTEST = 1e-4
"""The first try, in macro steps; each further one is so many times as long."""
LONGER = 8.0
STEPS = "solver.steps"


@dataclass(frozen=True)
class Cost:
    """What a case takes.

    cpu      [s]
    steps    of its scheme, 0 where it tells of none
    """

    cpu: float
    steps: float = 0.0

    def told(self) -> str:
        """In words: about 3.2 h (2.1e+10 steps of 0.55 us)."""
        if not self.steps > 0.0:
            return f"about {spoken(self.cpu)}"
        return f"about {spoken(self.cpu)} ({self.steps:.2g} steps of {1e6 * self.cpu / self.steps:.2g} us)"


@dataclass(frozen=True)
class Rate:
    """What a second of a phase takes as it begins.

    cpu      over the phase's own time [1]
    steps    per second [1/s]
    ended    what it took in all where it ended by itself [s]
    """

    cpu: float
    steps: float
    ended: float | None = None


def _phase(scene: Scene) -> PhaseResult | None:
    return run_alone(scene).phase


def estimate(scene: Scene, run: Callable[[Scene], PhaseResult | None] = _phase) -> Cost | None:
    """What the one phase of a scene would take, from short beginnings of it; None where these tell nothing.

    run    a phase run to its end, or None if it comes to none
    """
    (phase,) = scene.phases
    begin = _rate(scene, run)
    if begin is None:
        return None
    if begin.ended is not None:
        return Cost(begin.ended)
    steps = math.ceil(begin.steps * phase.duration)
    laden = kind_of(phase.name).laden(phase) if phase.main.fmu is None else None
    if laden is None:
        return Cost(begin.cpu * phase.duration, steps)
    changed, reached = laden
    main = replace(phase.main, parameters={**phase.main.parameters, **changed})
    full = _rate(replace(scene, phases=(replace(phase, main=main),)), run)
    dearest = begin.cpu if full is None or full.ended is not None else max(full.cpu, begin.cpu)
    return Cost(begin.cpu * phase.duration + (dearest - begin.cpu) * _grown(phase.duration, reached), steps)


def _grown(duration: float, reached: float) -> float:
    """How long [s] at the highest price comes to as much as all of it does while the price grows evenly until then."""
    if duration <= reached:
        return 0.5 * duration * duration / reached
    return duration - 0.5 * reached


def _rate(scene: Scene, run: Callable[[Scene], PhaseResult | None]) -> Rate | None:
    (phase,) = scene.phases
    reach = min(SHORTEST * phase.macro_step, 0.5 * phase.duration)
    before = (0.0, 0.0, 0.0)
    while True:
        short = replace(phase, duration=reach, macro_step=min(phase.macro_step, reach))
        result = run(replace(scene, phases=(short,)))
        if result is None or result.error is not None or not len(result.recorder):
            return None
        if result.ended_by:
            return Rate(0.0, 0.0, result.cpu)
        steps = result.recorder.last().get(STEPS, 0.0)
        if result.cpu >= ENOUGH or LONGER * reach >= phase.duration:
            # at the rate of the latest part, or of all of it if that is dearer
            later = reach - before[0]
            return Rate(max(result.cpu / reach, (result.cpu - before[1]) / later), (steps - before[2]) / later)
        before, reach = (reach, result.cpu, steps), LONGER * reach
