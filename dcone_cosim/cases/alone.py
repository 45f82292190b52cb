"""The phases of a scene each by itself, whatever is set in it.

A phase that another hands over to begins as it does in a run of the scene as it is.
"""

from __future__ import annotations

import tomllib
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import tomlkit

from dcone_cosim.cases.case import identities
from dcone_cosim.errors import InputError
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
    """

    def __init__(self, name: str, settings: Sequence[str], isolate: bool | None) -> None:
        self._name, self._settings, self._isolate = name, tuple(settings), isolate
        self.scene = load(name, settings).isolating(isolate)
        self._taken: dict[str, tuple[Mapping[str, float], float]] = {}

    @property
    def phases(self) -> list[str]:
        """Names of its phases."""
        return [phase.name for phase in self.scene.phases]

    def begin(self, progress: Progress) -> None:
        """Run the scene as it is, if a phase of it takes over from another, and keep what is handed over."""
        if len(self.scene.phases) == 1:
            return
        with SceneFmus(self.scene, progress) as fmus:
            result = run_scene(self.scene, fmus.instantiate, progress)
        if result.exit_code:
            raise InputError(f"{self.scene.source}: the scene itself does not come to its end: {result.message}")
        for name in result.handovers:
            self._keep(result, name)

    def _keep(self, result: RunResult, phase: str) -> None:
        own = next(p.main.parameters for p in self.scene.phases if p.name == phase)
        given = {name: value for name, value in result.given[phase].items() if own.get(name) != value}
        self._taken[phase] = (given, result.handovers[phase].start)

    def scene_of(self, phase: str, changes: Sequence[str] = (), without: Collection[str] = ()) -> Scene:
        """The scene with that phase alone; `InputError` for changes that it cannot have.

        without    tables of the phase that are left out first
        """
        scene = self._without(phase, changes, without) if without else load(self._name, [*self._settings, *changes])
        scene = scene.isolating(self._isolate)
        place = next(i for i, p in enumerate(scene.phases) if p.name == phase)
        own = scene.phases[place]
        if place + 1 < len(scene.phases):
            own = kind_of(phase).by_itself(own)
        if phase in self._taken:
            given, start = self._taken[phase]
            own = replace(own, main=replace(own.main, parameters={**own.main.parameters, **given}), start=start)
        return replace(scene, phases=(own,))

    def _without(self, phase: str, changes: Sequence[str], tables: Collection[str]) -> Scene:
        base = self.scene
        document = tomllib.loads(base.text)
        left = {name: value for name, value in document[phase].items() if name not in tables}
        text = tomlkit.dumps({**document, phase: left})
        return parse(text, base.name, base.source, Path(base.source).parent, changes)


class Fmus:
    """The FMUs of every scene that comes, built once if they are not there, and what they are.

    facts    of those there are by now, by what they hang on
    """

    def __init__(self, progress: Progress) -> None:
        self._progress = progress
        self.facts: dict[Any, Mapping[str, Any]] = {}

    def of(self, scene: Scene) -> dict[str, str]:
        """What identifies each FMU of a scene."""
        what = fmus_of(scene)
        if what not in self.facts:
            with SceneFmus(scene, self._progress) as archives:
                self.facts[what] = archives.facts()
        return identities(self.facts[what])
