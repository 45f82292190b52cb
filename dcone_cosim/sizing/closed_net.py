"""From the tug to the threads: the closed net, caught round its target, is pulled at its vertex as a tug of the tow
does.

The capture FMU goes on after its capture with the tow's load as its input `tether.vertex_tension`: first a light pull
that draws the net together, then a pulse of the tug's height, one half-wave of the line's own period. Told is what
threads and target bear, how far the net slides about the target, and whether it stays on. Each run starts a micrometre
elsewhere: a net is chaotic, and one is a sample.

The load is given, not that of two bodies on a line: the chaser is pulled by it, but the line's own stretch is not
computed.

Checked  tests/sizing/test_closed_net.py
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from dcone_cosim.cases import ensemble
from dcone_cosim.cases.alone import Alone, Fmus
from dcone_cosim.cases.case import Case, digest, key_of
from dcone_cosim.cases.rows import Row
from dcone_cosim.contract import OUTCOMES
from dcone_cosim.errors import FAILED_AFTER, DconeError, InputError
from dcone_cosim.fmu.steppable import Steppable, Terminated
from dcone_cosim.handoff import Vector, rotation_matrix
from dcone_cosim.progress import Progress
from dcone_cosim.scene_fmus import SceneFmus

PHASE = "capture"
PULL = "tether.vertex_tension"
NEEDED = ("captured", "outcome", "thread.tension_max", "contact.impulse", "enclosure.share", PULL)
SETTLE, AFTER = 6.0, 1.0
"""How long the net is drawn together before the pulse, and watched after it [s]."""
DRAWN = 0.02
"""Light pull over the pulse's height [1]."""
PLACES = (
    *(f"{body}.position[{i}]" for body in ("catch", "target") for i in (1, 2, 3)),
    *(f"target.attitude[{i}]" for i in (1, 2, 3, 4)),
)
"""Where net and target are, and how the target lies."""
STEPS = 40
"""Of the pulse at least."""
RUNS, QUICK_RUNS = 4, 1
MOST_TIME = 120.0
"""Longest time after the shot in which the capture has to come [s]."""


@dataclass(frozen=True)
class Pull(Case):
    """A capture that goes on with a pull at its vertex.

    tug      height of the pulse [N];  light   pull before and after it [N]
    lasts    of the pulse [s]
    """

    tug: float = 0.0
    light: float = 0.0
    lasts: float = 1.0


@dataclass(frozen=True)
class Borne:
    """What one run bore.

    tug          height of the pulse [N]
    drawn, thread   largest tension of a thread while the net is drawn together, and in the pulse [N]
    contact      largest force on the target, the mean of a macro step [N]
    slip         way of the net's centre of mass about the target from the pulse on, at most [m]
    held         share of the target inside the net at the end [1]
    outcome      of the capture at the end
    """

    tug: float
    drawn: float
    thread: float
    contact: float
    slip: float
    held: float
    outcome: str
    failure: str = ""


def cases(alone: Alone, tug: float, lasts: float, count: int, progress: Progress) -> list[Pull]:
    """So many runs with another start each, with the pulse and without; none for a scene without a capture that has all
    that it takes."""
    if PHASE not in alone.phases:
        return []
    base = alone.scene_of(PHASE, to_its_end=True)
    fmus = Fmus(progress)
    found = []
    for number in range(count):
        scene = alone.scene_of(PHASE, ensemble.jitter(base, number), to_its_end=True)
        main = scene.phases[0].main
        if (
            main.fmu is not None
            or "tether" not in main.terms
            or "contact" not in main.terms
            or "closing" not in main.terms
        ):
            return []
        for height in (0.0, tug):
            key = digest(key_of(scene, fmus.of(scene), number), "pulled", height, tug, lasts)
            found.append(Pull(key, scene, seed=number, tug=height, light=DRAWN * tug, lasts=lasts))
    return found


def run(case: Case) -> Row:
    """Run a case in this process."""
    assert isinstance(case, Pull)
    try:
        with SceneFmus(case.scene, Progress()) as fmus:
            component = fmus.instantiate(PHASE, PHASE)
            try:
                found = _pulled(case, component)
            finally:
                component.close()
    except DconeError as error:
        return Row(case.key, "failed", FAILED_AFTER, str(error))
    return Row(case.key, "completed", samples=found)


def _pulled(case: Pull, component: Steppable) -> dict[str, float]:
    phase = case.scene.phases[0]
    step = phase.macro_step
    component.set(phase.main.parameters)
    component.enter_initialisation(phase.start, phase.start + MOST_TIME + SETTLE + AFTER)
    component.exit_initialisation()
    time, read = phase.start, component.get
    while not read(["captured"])["captured"]:
        if time - phase.start > min(phase.duration, MOST_TIME) or _failed(read(["outcome"])):
            raise InputError(f"no capture within {time - phase.start:.4g} s")
        component.step(time, step)
        time += step
    found = {"drawn": 0.0, "thread": 0.0, "contact": 0.0, "slip": 0.0}
    begun: Vector | None = None
    begin = time
    fine = min(step, case.lasts / STEPS)
    before = read(["contact.impulse"])["contact.impulse"]
    try:
        while time < begin + SETTLE + case.lasts + AFTER:
            at = time - begin - SETTLE
            size = step if at < 0.0 or at > case.lasts else fine
            component.set({PULL: _pull(case, at + 0.5 * size)})
            component.step(time, size)
            time += size
            now = read(["thread.tension_peak", "contact.impulse"])
            part = "drawn" if at < 0.0 else "thread"
            found[part] = max(found[part], now["thread.tension_peak"])
            if at >= 0.0:
                found["contact"] = max(found["contact"], (now["contact.impulse"] - before) / size)
                stands = _about_target(read)
                begun = stands if begun is None else begun
                found["slip"] = max(found["slip"], float(np.linalg.norm(stands - begun)))
            before = now["contact.impulse"]
    except Terminated:
        pass
    last = read(["enclosure.share", "outcome"])
    return {**found, "held": last["enclosure.share"], "outcome": last["outcome"]}


def _about_target(read: Callable[[Sequence[str]], Mapping[str, float]]) -> Vector:
    """The net's centre of mass from the target's, in the target's axes [m]."""
    told = read(PLACES)
    net, target, attitude = np.array([told[name] for name in PLACES[:3]]), PLACES[3:6], PLACES[6:]
    way = net - np.array([told[name] for name in target])
    return np.asarray(rotation_matrix(np.array([told[name] for name in attitude])).T @ way)


def _failed(outcome: Mapping[str, float]) -> bool:
    return OUTCOMES[int(outcome["outcome"])] not in ("flying", "captured", "settled")


def _pull(case: Pull, at: float) -> float:
    """Tension at the vertex [N], a time after the pulse began [s]: light before, a half-wave, light after."""
    light = case.light
    if at < 0.0:
        return light * min(1.0, 1.0 + at / SETTLE)
    if at > case.lasts:
        return light
    return max(light, case.tug * math.sin(math.pi * at / case.lasts))


def borne(cases: Sequence[Pull], rows: Mapping[str, Row]) -> Iterator[Borne]:
    """What the runs bore."""
    for case in cases:
        row = rows[case.key]
        if not row.samples:
            nan = math.nan
            yield Borne(case.tug, nan, nan, nan, nan, nan, row.status, row.message.splitlines()[-1].strip())
            continue
        told = row.samples
        yield Borne(
            case.tug,
            told["drawn"],
            told["thread"],
            told["contact"],
            told["slip"],
            told["held"],
            OUTCOMES[int(told["outcome"])],
        )
