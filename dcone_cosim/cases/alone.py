"""The phases of a scene each by itself, whatever is set in it.

A phase that another hands over to begins as it does in a run of the scene as it is.
"""

from __future__ import annotations

import tomllib
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import tomlkit

from dcone_cosim import build
from dcone_cosim.cases.case import identities
from dcone_cosim.errors import InputError
from dcone_cosim.level import GROUP, refused_by, with_term
from dcone_cosim.loading import load
from dcone_cosim.master import run_scene
from dcone_cosim.phases import kind_of
from dcone_cosim.progress import Progress
from dcone_cosim.results import RunResult
from dcone_cosim.scene.data import Scene
from dcone_cosim.scene_fmus import SceneFmus, fmus_of
from dcone_cosim.scenes.reading import parse


class Alone:
    """Makes scenes of one phase by itself, whatever is set.

    name, settings    the scene, and `--set` settings of all of them
    choose            whether the settings that the scene's accuracy asks for are among these; they may be set otherwise
    """

    def __init__(self, name: str, settings: Sequence[str], isolate: bool | None, choose: bool = True) -> None:
        self._name, self._isolate = name, isolate
        phases = load(name, settings).phases if choose else ()
        self._settings = (*settings, *(c for p in phases if p.chosen is not None for c in p.chosen.changes))
        self.scene = load(name, self._settings, choose=False).isolating(isolate)
        self._taken: dict[str, tuple[Mapping[str, float], float, str | None]] = {}

    @property
    def phases(self) -> list[str]:
        """Names of its phases."""
        return [phase.name for phase in self.scene.phases]

    def begin(self, progress: Progress) -> None:
        """Run the scene as it is, if a phase of it takes over from another, and keep what is handed over."""
        if len(self.scene.phases) == 1:
            return
        with SceneFmus(self.scene, progress) as fmus:
            result = run_scene(self.scene, fmus.instantiate, progress, fmus.adopt)
        if result.exit_code:
            raise InputError(f"{self.scene.source}: the scene itself does not come to its end: {result.message}")
        for name in result.handovers:
            self._keep(result, name)

    def _keep(self, result: RunResult, phase: str) -> None:
        own = next(p.main.parameters for p in self.scene.phases if p.name == phase)
        given = {name: value for name, value in result.given[phase].items() if own.get(name) != value}
        begun = next(p.main.terms.get(GROUP) for p in result.scene.phases if p.name == phase)
        self._taken[phase] = (given, result.handovers[phase].start, begun)

    def scene_of(
        self, phase: str, changes: Sequence[str] = (), without: Collection[str] = (), to_its_end: bool = False
    ) -> Scene:
        """The scene with that phase alone; `InputError` for changes that it cannot have.

        without       tables of the phase that are left out first
        to_its_end    whether the phases after it are left out before it is changed: it need not come to a hand-over
        """
        if without or to_its_end:
            scene = self._without(phase, changes, without)
        else:
            scene = load(self._name, [*self._settings, *changes], choose=False)
        scene = scene.isolating(self._isolate)
        place = next(i for i, p in enumerate(scene.phases) if p.name == phase)
        own = scene.phases[place]
        if phase != self.phases[-1]:
            own = kind_of(phase).by_itself(own)
        if phase in self._taken:
            given, start, body = self._taken[phase]
            main = own.main
            if body is not None and GROUP in main.unnamed and main.terms.get(GROUP) != body:
                turning = with_term(main, GROUP, body)  # the level that carries what was handed over
                why = refused_by(main, turning)
                if why:
                    raise InputError(f"{self.scene.source}\n  {phase}.{why}")
                main = turning
            own = replace(own, main=replace(main, parameters={**main.parameters, **given}), start=start)
        return replace(scene, phases=(own,))

    def _without(self, phase: str, changes: Sequence[str], tables: Collection[str]) -> Scene:
        """What the phase cannot do then for those after it does not matter: these are left out too."""
        base = self.scene
        document = tomllib.loads(base.text)
        kept = self.phases[: self.phases.index(phase) + 1]
        document = {name: value for name, value in document.items() if name not in self.phases or name in kept}
        left = {name: value for name, value in document[phase].items() if name not in tables}
        text = tomlkit.dumps({**document, "phases": kept, phase: left})
        scene = parse(text, base.name, base.source, Path(base.source).parent, changes, choose=False)
        *before, own = scene.phases
        # what a phase after it has told of it, such as the length of their one line
        told = base.phases[len(before)].main.parameters
        known = {name: value for name, value in told.items() if name in own.main.defaults}
        own = replace(own, main=replace(own.main, parameters={**known, **own.main.parameters}))
        return replace(scene, phases=(*before, own))


class Fmus:
    """The FMUs of every scene that comes, built once if they are not there, and what they are.

    facts    of those there are by now, by what they hang on
    """

    def __init__(self, progress: Progress) -> None:
        self._progress = progress
        self.facts: dict[Any, Mapping[str, Any]] = {}

    def make_ready(self, scenes: Iterable[Scene]) -> None:
        """Build those of all these scenes that are not there side by side, so that none is waited for by itself."""
        parts = [c for scene in scenes for phase in scene.phases for c in phase.components if c.fmu is None]
        with self._progress.working("building"):
            build.ensure([(part.model, part.terms) for part in parts], self._progress.say)

    def of(self, scene: Scene) -> dict[str, str]:
        """What identifies each FMU of a scene."""
        what = fmus_of(scene)
        if what not in self.facts:
            with SceneFmus(scene, self._progress) as archives:
                self.facts[what] = archives.facts()
        return identities(self.facts[what])
