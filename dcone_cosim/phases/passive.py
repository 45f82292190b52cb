"""Passive safety of a tow: how near the two bodies come if the thrust stops, or the line is cut, on the way.

With the thrust stopped the tow's own FMU goes on, from its saved state. A line that is cut leaves two bodies that fall
freely, the thrust being stopped as well: two conics, or straight lines without a field.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from dcone_cosim import interrupts
from dcone_cosim.errors import FmuError
from dcone_cosim.fmu.component import Steppable, Terminated
from dcone_cosim.phases.phase import Stage
from dcone_cosim.results import PhaseResult
from orbital.constants import EARTH_MU
from orbital.kepler import propagate

Vectors = npt.NDArray[np.float64]
LOOKS = 720
"""Into how many pieces the time after an instant is cut."""
THRUST, OFFSET = "thrust.level", "thrust.offset"
EACH = tuple(f"[{i}]" for i in (1, 2, 3))
NEEDED = tuple(
    f"{name}{each}" for name in ("relative.position", "relative.velocity") for each in EACH
)  # fmt: skip
BODIES = tuple(
    f"{body}.{what}{each}" for body in ("chaser", "target") for what in ("position", "velocity") for each in EACH
)
INSTANT, PIECE = "passive instant", "passive piece"
"""Keys under which states are kept."""
SHORT_OF, LOCATED = 1e-9, 1e-6
"""Share of a piece that is left before an FMU's own end, so that its outputs there can be read; and of the room within
which two bodies count as met there."""


@dataclass(frozen=True)
class PassiveOptions:
    """What concerns the master of a tow.

    safety_every    time between two instants at which the thrust stops or the line is cut [s]; infinite: never
    safety_horizon  for how long the bodies are followed from there [s]
    """

    safety_every: float = math.inf
    safety_horizon: float = 10800.0


class Nearest(NamedTuple):
    """How near the centres come [m], and how long after the instant that is [s]."""

    distance: float
    after: float


@dataclass(frozen=True)
class Instant:
    """What happens if it stops there.

    time       since the phase began [s]
    separation of the centres there [m]
    stopped    with the thrust stopped, None where the FMU cannot show it
    cut        with the line cut as well, None where the bodies' states are not known
    """

    time: float
    separation: float
    stopped: Nearest | None
    cut: Nearest | None


def examine(stage: Stage, result: PhaseResult) -> list[Instant]:
    """The same tow once more, with both tried every `safety_every` until it ended; `FmuError` if it cannot be had.

    The states of the FMU are kept and restored, so that the tow itself is the one that was run.
    """
    phase, options = stage.phase, stage.phase.options
    found: list[Instant] = []
    reasons: list[str] = []
    if stage.begun is not None and stage.run.gone_on.get("changed"):
        raise FmuError("it follows the tow from its beginning, and values were changed where this one went on")
    record = stage.run.handovers.get(phase.name)
    start = phase.start if record is None else record.start
    component = stage.instantiate(phase.name, f"{phase.name} passive")
    try:
        component.set(stage.run.given[phase.name])
        component.enter_initialisation(start, start + phase.duration + options.safety_horizon)
        component.exit_initialisation()
        if not (set(NEEDED) <= component.variables.keys() and component.can_save):
            return found
        steps = int(result.end / phase.macro_step * (1.0 + 1e-12))
        stage.progress.begin(f"{phase.name}, passive safety", 0.0, result.end)
        next_look = 0.0
        for i in range(steps + 1):
            time = i * phase.macro_step
            interrupts.check(phase.name, time)
            if time >= next_look * (1.0 - 1e-12):
                found.append(_tried(component, start, time, options, reasons))
                next_look += options.safety_every
            if i < steps:
                component.step(start + time, phase.macro_step)
            stage.progress.at(time)
        stage.progress.end()
    except Terminated:
        pass
    except FmuError as error:
        reasons.append(str(error))
    finally:
        component.close()
    if reasons:
        stage.progress.say(f"passive safety is not complete: {reasons[0]}")
    return found


def _tried(component: Steppable, start: float, time: float, options: PassiveOptions, reasons: list[str]) -> Instant:
    """Both tried at one instant; a reason is added where the FMU failed."""
    read = component.get(NEEDED)
    separation = math.hypot(*(read[f"relative.position{each}"] for each in EACH))
    cut = None
    if set(BODIES) <= component.variables.keys():
        states = component.get(BODIES)
        orbits = "altitude" in component.variables
        cut = _freely({name: states[name] for name in BODIES}, options.safety_horizon, orbits)
    stopped = None
    if {THRUST, OFFSET} <= component.variables.keys():
        component.save(INSTANT)
        try:
            stopped = _without_thrust(component, start + time, options.safety_horizon)
        except FmuError as error:
            reasons.append(str(error))
        finally:
            component.restore(INSTANT)
            component.release(INSTANT)
    return Instant(time, separation, stopped, cut)


def _without_thrust(component: Steppable, begin: float, horizon: float) -> Nearest:
    """How near they come on the line, the thrust being zero from an instant on [s]."""
    component.set({OFFSET: -component.get((THRUST,))[THRUST]})
    piece, times = horizon / LOOKS, [0.0]
    rows = [component.get(NEEDED)]
    for i in range(LOOKS):
        component.save(PIECE)
        length = piece
        try:
            component.step(begin + i * piece, piece)
        except Terminated as end:
            # where the bodies meet, or the orbit ends: up to there
            length = (1.0 - SHORT_OF) * (end.time - (begin + i * piece))
            component.restore(PIECE)
            component.step(begin + i * piece, length)
        rows.append(component.get(NEEDED))
        times.append(i * piece + length)
        if length < piece:
            break
    component.release(PIECE)
    position = np.array([[row[f"relative.position{each}"] for each in EACH] for row in rows])
    velocity = np.array([[row[f"relative.velocity{each}"] for each in EACH] for row in rows])
    return nearest(np.array(times), position, velocity)


def _freely(states: Mapping[str, float], horizon: float, orbits: bool) -> Nearest:
    """How near two bodies come that fall freely."""
    times = np.linspace(0.0, horizon, LOOKS + 1)
    bodies = []
    for body in ("chaser", "target"):
        position, velocity = (
            np.array([states[f"{body}.{what}{each}"] for each in EACH]) for what in ("position", "velocity")
        )
        bodies.append(
            conic(position, velocity, times)
            if orbits
            else (position + times[:, None] * velocity, np.tile(velocity, (len(times), 1)))
        )
    (r_c, v_c), (r_t, v_t) = bodies
    return nearest(times, r_t - r_c, v_t - v_c)


def conic(position: Vectors, velocity: Vectors, times: Vectors) -> tuple[Vectors, Vectors]:
    """Positions (n, 3) [m] and velocities [m/s] about the Earth at times after a state (n,) [s].

    Source   `orbital.kepler.propagate`
    Checked  tests/cosim/test_passive.py
    """
    places, speeds = np.empty((len(times), 3)), np.empty((len(times), 3))
    for i, time in enumerate(times):
        propagate(places[i], speeds[i], position, velocity, float(time), EARTH_MU)
    return places, speeds


def nearest(times: Vectors, position: Vectors, velocity: Vectors) -> Nearest:
    """Least distance of a relative motion given at some times, and when: between two, straight on.

    position, velocity   relative, in axes that may turn                 (n, 3) [m], [m/s]

    Checked  tests/cosim/test_passive.py
    """
    distance = np.linalg.norm(position, axis=1)
    with np.errstate(invalid="ignore", divide="ignore"):
        rate = np.where(distance > 0.0, np.sum(position * velocity, axis=1) / distance, 0.0)
    least = int(np.argmin(distance))
    best = Nearest(float(distance[least]), float(times[least]))
    for i in np.flatnonzero((rate[:-1] < 0.0) & (rate[1:] > 0.0)):
        h = times[i + 1] - times[i]
        # straight on over the piece: exact for two bodies that pass each other
        u, w = position[i], (position[i + 1] - position[i]) / h
        if not w @ w > 0.0:
            continue  # it comes back to where it was: no nearer than its ends
        at = float(np.clip(-(u @ w) / (w @ w), 0.0, h))
        there = float(np.linalg.norm(u + at * w))
        if there < best.distance:
            best = Nearest(there, float(times[i]) + at)
    return best


@dataclass(frozen=True)
class Worst:
    """The worst of the instants tried.

    what, told   name and words of what happens there
    distance     least of the centres [m];  time   of the instant [s];  after   how long after it they are so near [s]
    meets        instants after which the bodies may meet, of how many
    """

    what: str
    told: str
    distance: float
    time: float
    after: float
    meets: int
    tried: int


def worst(instants: Sequence[Instant], room: float) -> Iterator[Worst]:
    """The worst of what was tried, with the thrust stopped and with the line cut.

    room    that the two bodies take from their centres on, with what is to be kept clear [m]
    """
    for what, told in (("stopped", "the thrust stops"), ("cut", "the line is cut")):
        tried: list[tuple[Nearest, float]] = [
            (near, instant.time) for instant in instants if (near := getattr(instant, what)) is not None
        ]
        if tried:
            near, time = min(tried, key=lambda pair: pair[0].distance)
            meets = sum(other.distance < room * (1.0 + LOCATED) for other, _ in tried)
            yield Worst(what, told, near.distance, time, near.after, meets, len(tried))
