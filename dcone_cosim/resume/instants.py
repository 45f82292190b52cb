"""Instants as the command line says them: PHASE:TIME, with its unit, or TIME alone where a scene has one phase."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from dcone_cosim.errors import InputError
from dcone_cosim.names import did_you_mean
from dcone_cosim.scene.data import PhaseScene, Scene
from dcone_cosim.scene.expected import number_and_unit
from dcone_cosim.units import by_name, named

TIME = by_name("s")


@dataclass(frozen=True)
class Place:
    """Where a run goes on.

    time    by the phase's own time [s]; None: where the phase takes over from the one before it
    """

    phase: str
    time: float | None = None


def save_at(texts: Sequence[str], scene: Scene) -> dict[str, list[float]]:
    """Instants by phase, by its own time [s], from the arguments of `--save-at`; `InputError` for one that cannot come.

    Checked  tests/resume/test_instants.py
    """
    found: dict[str, list[float]] = {}
    for text in texts:
        option = f"--save-at {text}"
        phase, said = _parts(text, scene, option)
        if not said:
            raise InputError(f'{option}: expected a time with its unit, such as {phase}:"1 h"')
        time, begin = _seconds(said, option), begin_of(scene, phase)
        if not begin <= time <= begin + phase_of(scene, phase).duration:
            end = begin + phase_of(scene, phase).duration
            raise InputError(f"{option}: the {phase} goes from {begin:g} s to {end:g} s by its own time")
        found.setdefault(phase, []).append(time)
    return found


def go_on_at(text: str, scene: Scene) -> Place:
    """Where to go on, from the argument of `--from`: PHASE, PHASE:TIME or TIME."""
    option = f"--from {text}"
    phase, said = _parts(text, scene, option)
    return Place(phase, _seconds(said, option) if said else None)


def phase_of(scene: Scene, name: str) -> PhaseScene:
    return next(phase for phase in scene.phases if phase.name == name)


def begin_of(scene: Scene, name: str) -> float:
    """What a phase's own time begins with [s]."""
    from dcone_cosim.phases import kind_of

    return 0.0 if kind_of(name).own_clock else phase_of(scene, name).start


def _parts(text: str, scene: Scene, option: str) -> tuple[str, str]:
    """Phase and time; the time is empty where only a phase is named."""
    names = [phase.name for phase in scene.phases]
    first, colon, rest = text.partition(":")
    if colon or first.strip() in names:
        if first.strip() not in names:
            raise InputError(f"{option}: this scene has no phase {first.strip()!r}{did_you_mean(first.strip(), names)}")
        return first.strip(), rest.strip()
    if number_and_unit(text) is None:
        raise InputError(f'{option}: expected a phase ({", ".join(names)}), a time such as "1 h", or PHASE:TIME')
    if len(names) > 1:
        raise InputError(
            f"{option}: of which phase? expected {' or '.join(f'{name}:{chr(34)}{text}{chr(34)}' for name in names)}"
        )
    return names[0], text.strip()


def _seconds(text: str, option: str) -> float:
    number, name = number_and_unit(text.strip("\"' ")) or (math.nan, "")
    unit = named(name) if name else None
    if unit is None or unit.dimension != TIME.dimension or not math.isfinite(number):
        raise InputError(f'{option}: {text!r} is no time; expected one with its unit, such as "1 h" or "250 s"')
    return unit.to_si(number)
