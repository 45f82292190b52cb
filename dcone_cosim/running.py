"""A scene run once: its FMUs, its phases, and what identifies what they were run with."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime
from types import MappingProxyType
from typing import Any

from dcone_cosim import loads
from dcone_cosim.errors import InputError
from dcone_cosim.master import run_scene
from dcone_cosim.phases import kind_of
from dcone_cosim.progress import Progress
from dcone_cosim.results import Attained, Begun, RunResult
from dcone_cosim.scene.data import Scene
from dcone_cosim.scene_fmus import SceneFmus, remarks

Instants = Mapping[str, Sequence[float]]
"""By phase, at which its state is kept, by its own time [s]."""


@dataclass
class Ran:
    """A run, the facts of its FMUs, when it began, and what to note of it."""

    result: RunResult
    facts: Mapping[str, Mapping[str, Any]]
    started: datetime
    notes: list[str] = field(default_factory=list)


def run_once(
    scene: Scene,
    progress: Progress,
    begin: Callable[[SceneFmus, Scene], Begun] | None = None,
    keep: Instants = MappingProxyType({}),
    attained: Mapping[str, Attained] = MappingProxyType({}),
    meanwhile: Callable[[], object] = lambda: None,
) -> Ran:
    """Run a scene.

    begin        tells what it goes on from, once its FMUs are there
    keep         when states are kept
    attained     how exact its phases are known to be
    meanwhile    called once the FMUs are there
    """
    started, notes = datetime.now(UTC), list(scene.notes)
    with SceneFmus(scene, progress) as archives:
        need_states(archives, scene, keep)
        begun = None if begin is None else begin(archives, scene)
        meanwhile()
        result = run_scene(scene, archives.instantiate, progress, archives.adopt, begun, keep)
        facts = archives.facts()
    loads.judge(result)
    if attained:
        result.attained = attained
    notes += [*nothing_recorded(result), *not_kept(result, keep), *remarks(facts)]
    return Ran(result, facts, started, notes)


def need_states(archives: SceneFmus, scene: Scene, keep: Instants) -> None:
    """`InputError` for an FMU whose state can be no file."""
    for phase in keep:
        for name in archives.without_states(phase):
            raise InputError(
                f"--save-at: the state of the {phase} cannot be kept: the FMU of {name} does not say "
                "canSerializeFMUstate = true; leave it out, or give that FMU fmi2SerializeFMUstate"
            )


def nothing_recorded(result: RunResult) -> list[str]:
    """Which phases leave nothing but their times."""
    return [
        f"nothing is recorded of the {name}: its FMU has no outputs that are numbers"
        for name, phase in result.phases.items()
        if len(phase.recorder.names) == 1
    ]


def not_kept(result: RunResult, keep: Instants) -> list[str]:
    """Instants that never came."""
    found = []
    for name, instants in keep.items():
        if name not in result.phases:
            found.append(f"no state of the {name} was kept: it was not run")
            continue
        latest = max((state.time for state in result.states if state.phase == name), default=-1.0)
        end = result.phases[name].end
        found += [
            f"no state was kept at {instant:g} s of the {kind_of(name).spoken or name}: it ended at {end:.6g} s, and "
            "its last communication point that is a whole number of macro steps from its begin is before that"
            for instant in sorted(instants)
            if instant > latest
        ]
    return found
