"""No kernel reads or writes beyond the arrays that it is handed: our models compiled with numba's check of every index.

The FMUs have no such check: a row that is declared a number too short lets a kernel write over the one behind it, and
nothing tells. What the check sees: `test_bounds_seen`; tows in seconds: `test_bounds_of_tows`.
"""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from dcone_cosim.loading import load, shipped
from dcone_cosim.scene.data import ComponentScene
from fmu_src.catalogue import MODELS
from tests.packaging import checked, compositions

CODE = """
import json
import sys
from dcone_cosim.loading import load
from fmu_src.catalogue import MODELS
from fmu_src.instance import Instance, ModelFault

for scene, name, *settings in json.loads(sys.argv[1]):
    name, _, part = name.partition(".")
    phase = next(one for one in load(scene, settings).phases if one.name == name)
    one = next(one for one in phase.components if one.name == (part or name))
    instance = Instance(MODELS[one.model], one.terms, one.parameters, one.numbers)
    instance.initialise()
    inputs = [v for v in instance.interface.variables if v.causality == "input" and v.kind == "Real"]
    done, words = 0, ""
    try:
        while done < 400:
            if done % 100 == 50:
                for v in inputs:
                    instance[v.name] += 1e-6 * v.nominal
                instance.refresh()
            if done % 100 == 75:
                instance.set_rates({v.name: 1e-9 * v.nominal for v in inputs if v.rate})
                instance.differentiate()
            instance.step(phase.duration / 400.0)
            done += 1
    except ModelFault as fault:
        code = int(instance.record["fault_code"][0])
        if next(fault.severity for fault in MODELS[one.model].faults if fault.code == code) != "end":
            raise
        words = fault
    print(scene, name, *settings, "-", done, "steps", words, flush=True)
    assert done > 0
"""
"""Of phases, each in four hundred steps, or up to where the model ends, with inputs that change and move now and then;
one that another hands over to begins as its own defaults say."""
OTHERS = (
    ("table2-deorbit", "removal", "removal.level.detail=averaged", "removal.duration=300 d"),
    ("table2-deorbit", "removal", "removal.level.detail=event_map", "removal.duration=12 h"),
    ("tumbling-target", "removal", "removal.level.detail=settled"),
    ("table1-capture", "capture", "capture.net.mesh=2 m", "capture.self_contact.thickness=1 cm"),
    ("conical-2m", "capture", "capture.folding.pattern=star", "capture.self_contact.duration=1 ms"),
    ("mission", "capture", "capture.gravity_gradient.kind=plain"),
    ("planar-2m", "capture", "capture.bending.rigidity=1e-5 N.m2", "capture.wall.friction=0.2"),
    (
        "reel-control",
        "removal.controller",
        'removal.components.controller={model="reel_control", reel={length="12 m"}}',
    ),
)
"""What no shipped scene has."""
WITHOUT = ("ejector", "section")
"""Groups of which nothing is in an FMU."""


@cache
def ours(scene: str, *settings: str) -> list[tuple[str, ComponentScene]]:
    """The models of ours in a scene, each with its phase, `phase.component` where it is not the phase's main one."""
    phases = load(scene, settings).phases
    every = ((phase, one) for phase in phases for one in phase.components if one.fmu is None)
    return [(phase.name if one is phase.main else f"{phase.name}.{one.name}", one) for phase, one in every]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The scenes of our own."""
    made = tmp_path_factory.mktemp("compositions")
    compositions.write(made)
    return made


def placed(case: tuple[str, ...], folder: Path) -> tuple[str, ...]:
    """A case whose scene can be loaded from anywhere."""
    scene, *rest = case
    return (scene if scene in shipped() else str(folder / scene), *rest)


def built(case: tuple[str, ...]) -> tuple[str, tuple[tuple[str, str], ...]]:
    """Model of a case, and its terms by group."""
    scene, name, *settings = case
    one = dict(ours(scene, *settings))[name]
    return one.model, tuple(MODELS[one.model].interface(one.terms).terms.items())


def together() -> dict[str, list[tuple[str, ...]]]:
    """Scene, phase and settings of all cases, those together that are compiled to the same; by their names."""
    found: dict[Any, list[tuple[str, ...]]] = {}
    for name in sorted(shipped()):
        for phase, _ in ours(name):
            found.setdefault(built((name, phase)), []).append((name, phase))
    for case in OTHERS:
        found.setdefault(built(case), []).append(case)
    named = {"; ".join(map(" ".join, same)): same for same in found.values()}
    return named | {name: [case] for name, case in compositions.COMPOSITIONS.items()}


def test_every_term_has_a_case(folder: Path) -> None:
    """A new term, of whatever group, is compiled with the check as well; of what there is any number of, one."""
    models = {built(placed(case, folder)) for same in together().values() for case in same}
    tried = {(name, *choice) for name, terms in models for choice in terms}
    lacking = [
        (name, group, term)
        for name, model in MODELS.items()
        for group, choices in model.groups.items()
        for term in choices.terms
        if group not in WITHOUT and (name, group, term) not in tried
    ]
    counts = {(name, group) for name, group, term in tried if term.isdecimal()}
    assert [one for one in lacking if one[:2] not in counts] == []


@pytest.mark.evidence
@pytest.mark.parametrize("cases", together().values(), ids=together())
def test_every_index_is_within_its_array(cases: list[tuple[str, ...]], folder: Path) -> None:
    done = checked.run(folder / "kept", CODE, json.dumps([placed(case, folder) for case in cases]))
    print(done.stdout)
    assert "out of bounds" not in done.stderr
    assert done.returncode == 0, done.stderr
