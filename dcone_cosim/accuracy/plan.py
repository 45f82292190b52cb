"""The cases that measure a phase.

What is chaotic is run with several jittered starts, what is not several times, for its CPU time.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from dcone_cosim.accuracy.peers import peers_of
from dcone_cosim.accuracy.settings import NUMERICS, Setting, judges, settings_of
from dcone_cosim.accuracy.work import CPU, Measured, OfPeer
from dcone_cosim.cases import ensemble
from dcone_cosim.cases.alone import Alone, Fmus
from dcone_cosim.cases.case import digest, key_of
from dcone_cosim.cases.rows import Row
from dcone_cosim.errors import InputError
from dcone_cosim.fmu.component import NUMBERS
from dcone_cosim.phases import kind_of
from dcone_cosim.progress import Progress
from dcone_cosim.quantities import spread_instants
from dcone_cosim.scene.data import PhaseScene
from dcone_cosim.scene_fmus import SceneFmus

INSTANTS = 120
"""At which curves are compared, at most."""
DEAR = 20.0
"""CPU time of a run that is told well enough by one [s]."""
TWIN = 1
"""Seed of the start that a twin has."""


@dataclass(frozen=True)
class Effort:
    """How much is done.

    runs       of a chaotic phase, for each setting; its references, and what judges them, have twice as many
    repeats    of any other, for its CPU time, where one takes less than `DEAR`
    thin       every how many-th setting is tried; the finest always is
    refine     whether the model itself is refined too
    peers      whether other programs are tried too
    """

    runs: int = 6
    repeats: int = 3
    thin: int = 1
    refine: bool = True
    peers: bool = False


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

    @property
    def first(self) -> list[Measured]:
        """The cases that are run in any case: without the repeats of what comes out the same each time."""
        if self.chaotic:
            return self.cases
        keys = {key for planned in (self.base, *self.settings) for key in planned.keys[:1]}
        return [case for case in self.cases if case.key in keys]

    def drop_dear(self, rows: Mapping[str, Row]) -> None:
        """Leave out the repeats of what took longer than `DEAR`."""
        if self.chaotic:
            return
        for planned in (self.base, *self.settings):
            if planned.keys and rows[planned.keys[0]].timings.get(CPU, 0.0) > DEAR:
                del planned.keys[1:]
        kept = {key for planned in (self.base, *self.settings) for key in planned.keys}
        self.cases[:] = [case for case in self.cases if case.key in kept]


class Planner:
    """Makes the cases of one phase.

    base       the phase by itself, as it is
    chaotic    its runs are samples: each starts a little differently
    changes, without    settings of all its cases, and tables that all leave out
    """

    def __init__(
        self, alone: Alone, phase: str, progress: Progress, changes: Sequence[str] = (), without: Sequence[str] = ()
    ) -> None:
        self._alone, self._phase = alone, phase
        self._rest, self._without = tuple(changes), tuple(without)
        self.base = alone.scene_of(phase, changes, without)
        self.own = self.base.phases[0]
        self.chaotic = kind_of(phase).chaotic
        self._instants = spread_instants(_first(self.own), self.own.duration, self.own.macro_step, INSTANTS)
        self._fmus = Fmus(progress)

    def cases(self, planned: Planned, count: int) -> dict[str, Measured]:
        """So many cases of a setting, whose keys it gets; `InputError` for one that the scene cannot have."""
        found: dict[str, Measured] = {}
        for number in range(count):
            jitter = ensemble.jitter(self.base, number) if self.chaotic else ()
            changes = (*self._rest, *planned.setting.changes, *jitter)
            scene = self._alone.scene_of(self._phase, changes, self._without)
            key = digest(key_of(scene, self._fmus.of(scene), number), self._instants)
            found.setdefault(key, Measured(key, scene, changes, {}, number, self._instants))
            planned.keys.append(key)
        return found

    def twin(self, planned: Planned) -> dict[str, Measured]:
        """A case that begins a micrometre beside; `InputError` for a scene that has nothing to move."""
        changes = (*self._rest, *planned.setting.changes, *ensemble.jitter(self.base, TWIN))
        scene = self._alone.scene_of(self._phase, changes, self._without)
        key = digest(key_of(scene, self._fmus.of(scene), TWIN), self._instants)
        planned.keys.append(key)
        return {key: Measured(key, scene, changes, {}, TWIN, self._instants)}

    def by_peers(self, notes: list[str]) -> Iterator[tuple[Planned, Measured]]:
        """A case of every peer for each of its tolerances, begun where our FMU begins."""
        found = list(peers_of(self.own, notes))
        if not found:
            return
        values = self._begun()
        for what, peer in found:
            for size in peer.sizes:
                key = digest(key_of(self.base, self._fmus.of(self.base), None), what, peer.name, size, self._instants)
                case = OfPeer(key, self.base, (), {}, None, self._instants, what, peer.name, size, values)
                yield Planned(Setting(NUMERICS, peer.name, size, (), True), [key]), case

    def _begun(self) -> dict[str, float]:
        """Parameters, and outputs at the start, of the phase's FMU."""
        with SceneFmus(self.base, Progress()) as fmus:
            component = fmus.instantiate(self._phase, self._phase)
            try:
                component.set(self.own.main.parameters)
                component.enter_initialisation(self.own.start, self.own.start + self.own.duration)
                component.exit_initialisation()
                found: dict[str, float] = component.get(
                    [v.name for v in component.variables.values() if v.kind in NUMBERS]
                )
                return found
            finally:
                component.close()


def plan(alone: Alone, phase: str, effort: Effort, progress: Progress) -> PhasePlan:
    """What is to be run of a phase."""
    planner = Planner(alone, phase, progress)
    notes: list[str] = []
    settings = _thinned(settings_of(planner.own, effort.refine, notes), effort.thin)
    cases: dict[str, Measured] = {}
    here = Planned(Setting("", "the scene as it is", 1.0, ()))
    planned = [here, *(Planned(setting) for setting in settings)]
    axes = dict.fromkeys(s.axis for s in settings)
    judging = {judge for axis in axes for judge in judges([s for s in settings if s.axis == axis])}
    for one in planned:
        count = effort.runs * (2 if one.setting in judging else 1) if planner.chaotic else effort.repeats
        try:
            cases |= planner.cases(one, count)
        except InputError as error:
            if one is here:
                raise
            which = one.setting.family if one.setting.detail else one.setting.label
            note = f"{phase}: {which} is left out: {str(error).splitlines()[-1].strip()}"
            notes += [note] if note not in notes else []
            one.keys.clear()
    if effort.peers:
        for one, case in planner.by_peers(notes):
            planned.append(one)
            cases[case.key] = case
    kept = [p for p in planned[1:] if p.keys]
    return PhasePlan(phase, planner.base.title, planner.chaotic, here, kept, list(cases.values()), notes)


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
