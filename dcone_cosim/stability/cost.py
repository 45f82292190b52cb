"""What a case would take: it is begun, stepped for a tenth of a second, and reckoned on from there."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

from dcone_cosim.cases.pace import spoken
from dcone_cosim.results import PhaseResult
from dcone_cosim.scene.data import Scene

ENOUGH = 0.1
"""CPU time after which an estimate is good enough [s]."""
SHORTEST = 1e-4
"""The first try, in macro steps; each further one is so many times as long."""
LONGER = 8.0
STEPS, THREADS = "solver.steps", "net.threads"
AWAKE = 2e-9
"""What a thread takes in a substep once the net is open [s]: folded, most of them sleep, and a beginning tells nothing
of that (2.0 ns with 9,312 to 18,624 threads, measured by this command)."""


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


def estimate(scene: Scene, run: Callable[[Scene], PhaseResult | None]) -> Cost | None:
    """What the one phase of a scene would take, from short beginnings of it; None where these tell nothing.

    run    a phase run to its end, or None if it comes to none
    """
    (phase,) = scene.phases
    reach = min(SHORTEST * phase.macro_step, 0.5 * phase.duration)
    before: tuple[float, float, float] = (0.0, 0.0, 0.0)
    while True:
        short = replace(phase, duration=reach, macro_step=min(phase.macro_step, reach))
        result = run(replace(scene, phases=(short,)))
        if result is None or result.error is not None or not len(result.recorder):
            return None
        if result.ended_by:
            return Cost(result.cpu)
        last = result.recorder.last()
        steps = last.get(STEPS, 0.0)
        if result.cpu >= ENOUGH or LONGER * reach >= phase.duration:
            found = _reckoned(before, (reach, result.cpu, steps), phase.duration)
            return Cost(max(found.cpu, AWAKE * found.steps * last.get(THREADS, 0.0)), found.steps)
        before, reach = (reach, result.cpu, steps), LONGER * reach


def _reckoned(before: tuple[float, float, float], now: tuple[float, float, float], duration: float) -> Cost:
    """At the rate of the latest part, or of all of it if that is dearer."""
    reach, cpu, steps = now
    rate = max(cpu / reach, (cpu - before[1]) / (reach - before[0]))
    per_time = (steps - before[2]) / (reach - before[0])
    return Cost(max(cpu, rate * duration), math.ceil(per_time * duration))
