"""The cases that measure a phase.

What is chaotic is run with several jittered starts, what is not several times, for its CPU time.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from dcone_cosim.accuracy.settings import Setting, settings_of
from dcone_cosim.accuracy.work import Measured
from dcone_cosim.cases import ensemble
from dcone_cosim.cases.alone import Alone, Fmus
from dcone_cosim.cases.case import digest, key_of
from dcone_cosim.errors import InputError
from dcone_cosim.phases import kind_of
from dcone_cosim.progress import Progress
from dcone_cosim.quantities import spread_instants
from dcone_cosim.scene.data import PhaseScene

INSTANTS = 120
"""At which curves are compared, at most."""


@dataclass(frozen=True)
class Effort:
    """How much is done.

    runs       of a chaotic phase, for each setting; its references have twice as many
    repeats    of any other, for its CPU time
    thin       every how many-th setting is tried; the finest always is
    refine     whether the model itself is refined too
    """

    runs: int = 6
    repeats: int = 3
    thin: int = 1
    refine: bool = True


@dataclass
class Planned:
    """A setting and the keys of its cases."""

    setting: Setting
    keys: list[str] = field(default_factory=list)


@dataclass
class PhasePlan:
    """A phase and what is to be run of it.

    chaotic    its runs are samples
    base       the scene as it is
    """

    phase: str
    title: str
    chaotic: bool
    base: Planned
    settings: list[Planned]
    cases: list[Measured]
    notes: list[str]


def plan(alone: Alone, phase: str, effort: Effort, progress: Progress) -> PhasePlan:
    """What is to be run of a phase."""
    base = alone.scene_of(phase)
    own = base.phases[0]
    chaotic = kind_of(phase).chaotic
    notes: list[str] = []
    settings = _thinned(settings_of(own, effort.refine, notes), effort.thin)
    instants = spread_instants(_first(own), own.duration, own.macro_step, INSTANTS)
    fmus = Fmus(progress)
    cases: dict[str, Measured] = {}
    here = Planned(Setting("", "the scene as it is", 1.0, ()))
    planned = [here, *(Planned(setting) for setting in settings)]
    finest = {min((s for s in settings if s.axis == axis), key=lambda s: s.size) for axis in {s.axis for s in settings}}
    for one in planned:
        count = effort.runs * (2 if one.setting in finest else 1) if chaotic else effort.repeats
        try:
            for number in range(count):
                changes = (*one.setting.changes, *(ensemble.jitter(base, number) if chaotic else ()))
                scene = alone.scene_of(phase, changes)
                key = digest(key_of(scene, fmus.of(scene), number), instants)
                cases.setdefault(key, Measured(key, scene, changes, {}, number, instants))
                one.keys.append(key)
        except InputError as error:
            if one is here:
                raise
            notes.append(f"{phase}: {one.setting.label} is left out: {str(error).splitlines()[-1].strip()}")
            one.keys.clear()
    return PhasePlan(phase, base.title, chaotic, here, [p for p in planned[1:] if p.keys], list(cases.values()), notes)


def _first(phase: PhaseScene) -> float:
    """When the phase begins by its own times [s]."""
    return 0.0 if kind_of(phase.name).own_clock else phase.start


def _thinned(settings: Sequence[Setting], thin: int) -> list[Setting]:
    """Every so many-th setting of each family from its finest on; the default one stays too."""
    found = []
    for family in dict.fromkeys((s.axis, s.family) for s in settings):
        of = [s for s in settings if (s.axis, s.family) == family]
        found += [s for i, s in enumerate(of) if (len(of) - 1 - i) % thin == 0 or s.size == 1.0]
    return found
