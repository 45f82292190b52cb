"""An ensemble: the same scene with starts that differ by less than anybody could know, one for each seed.

What is chaotic comes out otherwise each time, and what is not comes out the same. Where a scene begins with

    a capture whose FMU has solver.jitter and solver.seed     folded nodes differ by 1 um, or by what the scene says
    a removal that begins with start.separation               the bodies begin nearer by 0 to 1 um
    a removal whose scene says start.relative_position        the same, along the line between them

These are the starts from which the scatter of single figures was measured (see `phases.chaos`).
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from dcone_cosim.cases.case import content, digest
from dcone_cosim.contract import HANDED_OVER
from dcone_cosim.errors import InputError
from dcone_cosim.loading import load
from dcone_cosim.scene.data import PhaseScene, Scene

AMPLITUDE = 1e-6
"""Of the jitter of a start [m]."""
SEED, JITTER = "solver.seed", [f"solver.jitter[{axis}]" for axis in (1, 2, 3)]
PLACE = tuple(f"start.relative_position[{axis}]" for axis in (1, 2, 3))
SEPARATION, CONDITION = "start.separation", "start.condition"
MOST = 100_000
"""Members of an ensemble."""


def jitter(scene: Scene, seed: int) -> tuple[str, ...]:
    """Settings `KEY=VALUE` that jitter the start of the scene.

    `InputError` for a scene whose first phase has nothing to jitter.
    """
    first = scene.phases[0]
    known = {**first.main.defaults, **first.main.parameters}
    if {SEED, *JITTER} <= known.keys():
        own = any(known[name] for name in JITTER)
        size = ", ".join([f'"{AMPLITUDE:g} m"'] * len(JITTER))
        added = () if own else (f"{first.name}.solver.jitter=[{size}]",)
        return (*added, f"{first.name}.{SEED}={seed}")
    if SEPARATION in known and not _handed_over(first):
        separation = known[SEPARATION] - AMPLITUDE * np.random.default_rng(seed).random()
        return (f"{first.name}.{SEPARATION}={float(separation)!r} m",)
    place = [known.get(name, 0.0) for name in PLACE]
    apart = math.hypot(*place)
    if apart > AMPLITUDE and _handed_over(first) and set(PLACE) <= first.main.given.keys():
        nearer = 1.0 - AMPLITUDE * float(np.random.default_rng(seed).random()) / apart
        moved = ", ".join(f'"{nearer * float(at)!r} m"' for at in place)
        return (f"{first.name}.start.relative_position=[{moved}]",)
    raise InputError(
        f"{scene.source or scene.name}: no ensemble of its {first.name}: its FMU has neither {SEED} with solver.jitter "
        f"nor a {SEPARATION} or start.relative_position of its own to be jittered"
    )


def _handed_over(phase: PhaseScene) -> bool:
    """Whether the phase begins with positions and velocities that are given, and no separation counts."""
    condition = phase.setting(CONDITION)
    return condition is not None and condition == phase.choice(CONDITION, HANDED_OVER)


def members(name: str, base: Scene, seeds: Sequence[int], settings: Sequence[str] = ()) -> list[tuple[int, Scene]]:
    """The scene with a start of its own for each seed."""
    found = [(seed, load(name, [*settings, *jitter(base, seed)])) for seed in seeds]
    if len({digest(content(scene)) for _, scene in found}) < len(found):
        raise InputError(f"{base.source or base.name}: seeds do not change its start; expected starts that differ")
    return found


def check(count: int, seed: int) -> None:
    """`InputError` for what is no size or no first seed of an ensemble."""
    if not 2 <= count <= MOST:
        raise InputError(f"--ensemble {count}: expected 2 to {MOST:,} runs")
    if not 0 <= seed < 2**31 - count:
        raise InputError(f"--seed {seed}: expected a whole number of 31 bits, from 0")
