"""The FMUs of a scene while it runs: ours built on demand, others opened, each instantiated where it belongs."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dcone_cosim import build
from dcone_cosim.errors import FmuError, InputError
from dcone_cosim.fmu import children
from dcone_cosim.fmu.archive import Archive
from dcone_cosim.fmu.component import CallError, Component, Steppable
from dcone_cosim.fmu.isolation import IsolatedComponent
from dcone_cosim.fmu.leaving import guard_exit
from dcone_cosim.fmu.shelf import Shelf
from dcone_cosim.fmu.steppable import VariableInfo
from dcone_cosim.progress import Progress
from dcone_cosim.scene.data import ComponentScene, PhaseScene, Scene
from dcone_cosim.scene.mistakes import places_named
from dcone_cosim.scratch import Scratch


class SceneFmus:
    """The unpacked FMU of every component of a scene; closing removes the temporary folders.

    shelf     keeps instances that are closed, for the next scene that is `serve`d; without it each is freed
    """

    def __init__(self, scene: Scene, progress: Progress, shelf: Shelf | None = None) -> None:
        self._of: dict[tuple[str, str], Archive] = {}
        self._adopted: dict[tuple[str, str], tuple[Mapping[str, str], Archive]] = {}
        self._shelf, self._progress = shelf, progress
        self.serve(scene)
        components = [(phase.name, component) for phase in scene.phases for component in phase.components]
        ours = [(phase, component) for phase, component in components if component.fmu is None]
        try:
            children.make_ready(sum(c.isolate or (c.isolate is None and c.fmu is not None) for _, c in components))
            with progress.working("building"):
                built = build.ensure([(component.model, component.terms) for _, component in ours], progress.say)
            paths = {(phase, c.name): path for (phase, c), path in zip(ours, built, strict=True)}
            for phase, component in components:
                key = (phase, component.name)
                self._of[key] = (
                    Archive(component.fmu, tolerance=component.tolerance)
                    if component.fmu is not None
                    else self._ours(paths[key], component)
                )
        except BaseException:
            self.close()
            raise

    def serve(self, scene: Scene) -> None:
        """From now on instantiate for this scene, which must be of the same FMUs (`fmus_of`)."""
        self._scene = scene
        self._phases = {phase.name: phase for phase in scene.phases}
        self._coupled: dict[str, Any] = {}

    def adopt(self, phase: PhaseScene) -> None:
        """From now on, for this scene, a phase whose main model has other terms, as a hand-over asks for."""
        key = (phase.name, phase.main.name)
        if key not in self._adopted or self._adopted[key][0] != phase.main.terms:
            with self._progress.working("building"):
                (path,) = build.ensure([(phase.main.model, phase.main.terms)], self._progress.say)
            self._adopted[key] = (phase.main.terms, self._ours(path, phase.main))
        self._phases[phase.name] = phase

    def _archive(self, phase: PhaseScene, component: ComponentScene) -> Archive:
        terms, adopted = self._adopted.get((phase.name, component.name), (None, None))
        if adopted is not None and terms == component.terms:
            return adopted
        return self._of[phase.name, component.name]

    def instantiate(self, phase: str, name: str) -> Steppable:
        """A component of that phase: its one FMU under this name, or all of its FMUs coupled.

        The values that the scene gives to further components are set here, since a phase knows its main one alone.
        What they refuse is bad input, save in a phase that follows another: that one's results are kept.
        """
        plan = self._phases[phase]
        try:
            return self._together(plan, name)
        except InputError as error:
            if plan.name == self._scene.phases[0].name:
                raise
            raise FmuError(str(error)) from error

    def _together(self, plan: PhaseScene, name: str) -> Steppable:
        made: list[Steppable] = []
        try:
            for component in plan.components:
                is_main = component is plan.main
                made.append(self._one(plan, component, name if is_main else component.name))
                if not is_main and component.parameters:
                    self._set(plan, component, made[-1])
            if len(made) == 1 and not plan.connections:
                return made[0]
            from dcone_cosim.coupling.coupled import Coupled

            instances = [component.name for component in plan.components]
            coupled: Steppable = Coupled(name, made, plan.connections, plan.coupling, instances)
        except BaseException:
            for instance in reversed(made):
                instance.close()
            raise
        self._coupled.setdefault(plan.name, coupled)
        return coupled

    @staticmethod
    def _ours(path: Path, component: ComponentScene) -> Archive:
        """One of ours from the cache; built again should somebody have cleared it away in between."""
        try:
            return opened(path, component)
        except (FmuError, FileNotFoundError):
            if path.exists():
                raise
            (path,) = build.ensure([(component.model, component.terms)], lambda _: None)
            return opened(path, component)

    def _one(self, phase: PhaseScene, component: ComponentScene, name: str) -> Steppable:
        archive = self._archive(phase, component)
        apart = isolated(component, archive)
        if not apart and component.fmu is not None:
            guard_exit()
        if self._shelf is not None:
            made = self._shelf.take(archive, name, apart, component.timeout)
        else:
            made = IsolatedComponent(archive, name, component.timeout) if apart else Component(archive, name)
        try:
            if component.texts:
                made.set_texts(component.texts)
        except BaseException:
            made.close()
            raise
        return made

    def _set(self, phase: PhaseScene, component: ComponentScene, instance: Steppable) -> None:
        try:
            instance.set(component.parameters)
        except CallError as error:
            if error.broken:
                raise
            where = places_named(error.said, self._scene.places, phase.name, "components", component.name)
            text = f"{self._scene.source}: {component.name} of the {phase.name} cannot begin"
            raise InputError(f"{text}\n  {where}{error.said}\n  ({error.detail})") from error

    def variables(self, phase: str) -> Mapping[str, VariableInfo]:
        """Of the main FMU of a phase."""
        plan = self._phases[phase]
        return self._archive(plan, plan.main).variables

    def without_states(self, phase: str) -> list[str]:
        """Components of a phase whose FMU cannot write its state to a file."""
        plan = self._phases[phase]
        return [c.name for c in plan.components if not self._archive(plan, c).can_serialise]

    def facts(self) -> dict[str, dict[str, Any]]:
        """What identifies the FMUs of each phase and how they were coupled, for the provenance."""
        return {name: self._facts_of(phase) for name, phase in self._phases.items()}

    def _facts_of(self, phase: PhaseScene) -> dict[str, Any]:
        facts: dict[str, Any] = {"fmu": self._identity(phase, phase.main)}
        if phase.others:
            facts["components"] = {
                component.name: {
                    "fmu": self._identity(phase, component),
                    "terms": dict(component.terms),
                    "parameters": {**component.defaults, **component.parameters},
                    "given": dict(component.parameters),
                }
                for component in phase.others
            }
        coupled = self._coupled.get(phase.name)
        if coupled is not None:
            facts["connections"] = [str(c) for c in phase.connections]
            facts["transformations"] = {str(c): [c.factor, c.offset] for c in phase.connections}
            facts["coupling"] = {
                **vars(phase.coupling),
                "step": {"value": phase.coupling.step or phase.macro_step, "unit": "s"},
                "smallest_step": {"value": phase.coupling.smallest_step, "unit": "s"},
                "statistics": dict(coupled.statistics),
            }
        return facts

    def _identity(self, phase: PhaseScene, component: ComponentScene) -> dict[str, Any]:
        archive = self._archive(phase, component)
        apart = isolated(component, archive)
        rows = archive.description.modelVariables
        texts = {row.name: row.start for row in rows if row.type == "String" and row.causality == "parameter"}
        return {
            "file": archive.path.name if component.fmu is None else str(archive.path.absolute()),
            "sha256": archive.sha256,
            "guid": archive.guid,
            "model": archive.description.modelName,
            "generation_tool": archive.description.generationTool,
            "ours": component.fmu is None,
            "isolated": apart,
            "timeout": {"value": component.timeout, "unit": "s"} if apart else None,
            "texts": {**texts, **component.texts},
            "tolerance": archive.tolerance,
            "remarks": list(archive.remarks),
            "tables": {n: {"file": table.file.name, "sha256": table.sha256} for n, table in component.tables.items()},
        }

    def __enter__(self) -> SceneFmus:
        return self

    def close(self) -> None:
        children.dismiss()
        if self._shelf is not None:
            self._shelf.clear()
        for archive in (*self._of.values(), *(adopted for _, adopted in self._adopted.values())):
            archive.close()

    def __exit__(self, *_: object) -> None:
        self.close()


def fmus_of(scene: Scene) -> tuple[Any, ...]:
    """What the archives of a scene hang on: scenes for which it is equal differ in values alone, not in FMUs."""
    return tuple(
        (
            *(phase.name, c.name, c.model, tuple(c.terms.items()), c.fmu and c.fmu.absolute(), c.tolerance),
            tuple((name, table.sha256) for name, table in c.tables.items()),
            tuple((name, hashlib.sha256(numbers.tobytes()).hexdigest()) for name, numbers in c.laid.items()),
        )
        for phase in scene.phases
        for c in phase.components
    )


def opened(path: Path, component: ComponentScene) -> Archive:
    """One of ours from the cache, with the component's tables."""
    numbers = component.numbers
    if not numbers:
        return Archive(path)
    scratch = Scratch.temporary()
    try:
        return Archive(build.with_tables(path, component.model, component.terms, numbers, scratch.path), within=scratch)
    except BaseException:
        scratch.remove()
        raise


def remarks(facts: Mapping[str, Mapping[str, Any]]) -> list[str]:
    """What its user should know of what the FMUs did, from their facts; each sentence once."""
    phases = facts.values()
    fmus = [phase.get("fmu", {}) for phase in phases]
    fmus += [other["fmu"] for phase in phases for other in phase.get("components", {}).values()]
    return list(dict.fromkeys(remark for fmu in fmus for remark in fmu.get("remarks", ())))


def isolated(component: ComponentScene, archive: Archive) -> bool:
    """Whether a component is run in a process of its own: as it is told, otherwise unless it was built here."""
    if component.isolate is not None:
        return component.isolate
    return component.fmu is not None and not build.is_ours(archive.library)
