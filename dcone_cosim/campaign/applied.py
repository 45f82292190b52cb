"""Dispersions held against the scene before anything is run.

A dispersion whose key the scene does not have, or that changes nothing that reaches an FMU, is a mistake told with its
line: a campaign whose dispersions are never applied would look as good as any other.
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from dcone_cosim.campaign.inputs import JITTER, Group, Input, Inputs
from dcone_cosim.campaign.making import Maker, Wrong
from dcone_cosim.campaign.spec import ADAPTIVE, Dispersion, Spec
from dcone_cosim.cases import ensemble
from dcone_cosim.cases.case import content, digest
from dcone_cosim.errors import InputError
from dcone_cosim.loading import load, shipped
from dcone_cosim.scene.data import Scene
from dcone_cosim.scene.mistakes import Mistake, Mistakes, SceneError, unknown
from dcone_cosim.scene.toml_lines import dotted, given_at
from dcone_cosim.scenes.reading import parse

SEEDS = 2**31 - 1
"""Seeds that the jitter may have."""
_PROBES = (0.25, 0.75)
"""Where on its distribution a value is tried before anything is run."""


def base_of(spec: Spec, kept: Path | None = None) -> Scene:
    """The scene with what the campaign sets in it; mistakes are told where the campaign's file has them.

    kept    file of that scene as a campaign's folder has it, with its values set already
    """
    if kept is not None:
        return load(str(kept))
    beside = Path(spec.source).parent / spec.scene
    name = spec.scene if spec.scene in shipped() or not beside.exists() else str(beside)
    if name.lower().endswith(".ssp"):
        raise _wrong(spec, [Mistake(("scene",), spec.scene, "expected a scene in TOML; a package has no campaign")])
    try:
        plain = load(name)
    except SceneError:
        raise
    except InputError as error:
        raise _wrong(spec, [Mistake(("scene",), spec.scene, str(error))]) from None
    try:
        return load(name, list(_needed(spec.settings, plain.text)))
    except SceneError as error:
        found = [Mistake(("set", *one.path), one.given, one.expected) for one in error.mistakes]
        raise _wrong(spec, found) from None
    except InputError as error:
        raise _wrong(spec, [Mistake(("set",), None, str(error))]) from None


def _needed(settings: Sequence[str], text: str) -> Iterator[str]:
    """Settings without empty tables that the scene has already: they bring a part in, and take nothing away."""
    document = tomllib.loads(text)
    for one in settings:
        key, _, value = one.partition("=")
        if value != "{}" or given_at(document, tuple(key.split("."))) is None:
            yield one


def _wrong(spec: Spec, mistakes: Sequence[Mistake]) -> SceneError:
    return SceneError(mistakes, spec.places)


def inputs_of(spec: Spec, base: Scene, isolate: bool | None = None) -> Inputs:
    """The inputs of a campaign, each tried in the scene; a `SceneError` of the campaign's file lists every mistake.

    Checked  tests/campaign/test_inputs.py
    """
    wrong = Mistakes()
    taken: dict[str, Dispersion] = {}
    inputs: list[Input] = []
    groups: dict[
        str, Group
    ] = {}  # by key: elements of one vector are written at once, or the last would undo the others
    elements: dict[str, dict[int, int]] = {}
    matrix: dict[tuple[int, int], float] = {}
    for one in spec.dispersions:
        keys = one.keys or (one.key,)
        other = next((key for key in taken if any(_overlap(key, own) for own in keys)), None)
        if other is not None:
            wrong.append(Mistake((*one.path, "key"), one.key, f"{other} is dispersed above; expected each key once"))
            continue
        taken |= dict.fromkeys(keys, one)
        try:
            maker = Maker(spec, base, one)
            made, write = maker.made()
        except Wrong as error:
            wrong.extend(error.mistakes)
            continue
        places = tuple(range(len(inputs), len(inputs) + len(made)))
        inputs += made
        group = Group(places, write)
        wrong.extend(_tried(spec, base, one, made, group))
        if maker.element:
            several = elements.setdefault(maker.key, {})
            several[maker.element] = places[0]
            group = Group(tuple(several.values()), maker.writer(list(several), made[0].unit))
        groups[maker.key] = group
        if one.together:
            if not -1.0 < one.together < 1.0 or len(made) < 2:
                text = "expected a number between -1 and 1, of a vector's elements"
                wrong.append(Mistake((*one.path, "together"), one.together, text))
            matrix |= {(i, j): one.together for i in places for j in places if i != j}
    if spec.jitter:
        inputs.append(Input(JITTER, lambda u: float(min(int(u * SEEDS), SEEDS - 1)), points=()))
        groups[JITTER] = Group((len(inputs) - 1,), lambda values: ensemble.jitter(base, int(values[0])))
        try:
            ensemble.jitter(base, 0)
        except InputError as error:
            wrong.append(Mistake(("jitter",), True, str(error)))
    names = [one.name for one in inputs]
    for link in spec.correlations:
        places = tuple(names.index(name) for name in link.between if name in names)
        if len(places) < 2:
            absent = [name for name in link.between if name not in names]
            wrong.append(unknown((*link.path, "between"), absent[0], "is not dispersed", absent[0], names))
            continue
        matrix |= {places: link.coefficient, places[::-1]: link.coefficient}  # type: ignore[dict-item]
    if spec.sampler == ADAPTIVE and not wrong and len(inputs) not in (2, 3):
        wrong.append(Mistake(("sampler",), ADAPTIVE, f"maps two or three values; {len(inputs)} are dispersed"))
    if spec.sampler == ADAPTIVE:
        for one in spec.dispersions:
            if one.distribution != "uniform":
                said = "expected uniform: a map has a least and a largest value of each, all alike"
                wrong.append(Mistake((*one.path, "distribution"), one.distribution, said))
    factor = _factor(len(inputs), matrix)
    if matrix and factor is None:
        wrong.append(_contradicting(spec))
    if wrong:
        raise _wrong(spec, wrong)
    found = Inputs(tuple(inputs), tuple(groups.values()), factor)
    wrong.extend(_all_count(base, found))
    if wrong:
        raise _wrong(spec, wrong)
    return found


def _all_count(base: Scene, found: Inputs) -> Iterator[Mistake]:
    """Whether each number still changes what reaches an FMU where all others are set too: none may undo another."""
    middle = [one.value(0.5) for one in found.inputs]
    for place, one in enumerate(found.inputs):
        reached = set()
        values = [0.0, 1.0] if one.texts else [one.value(u) for u in _PROBES]
        for value in values:
            whole = [*middle[:place], value, *middle[place + 1 :]]
            try:
                scene = parse(base.text, base.name, base.source, Path(base.source).parent, found.settings(whole))
            except InputError:
                return  # values that do not go together are rows of their own
            reached.add(digest(reach(scene)))
        if len(reached) < len(values):
            yield Mistake(("dispersion",), one.name, "has no effect beside the others: another key undoes it")


def _overlap(one: str, other: str) -> bool:
    """Whether two keys set the same: a vector and an element of it, a table and a key in it, or twice the same."""
    plain = [key.partition("[")[0] for key in (one, other)]
    within = any(a.startswith(f"{b}.") for a, b in (plain, reversed(plain)))
    return within or one == other or (plain[0] == plain[1] and ("[" not in one or "[" not in other))


def _contradicting(spec: Spec) -> Mistake:
    """What is wrong where no values are correlated as the file says, with the coefficients."""
    text = "these coefficients contradict one another: no values have them all; make them smaller, or leave one out"
    if spec.correlations:
        return Mistake(("correlation",), [link.coefficient for link in spec.correlations], text)
    one = next(one for one in spec.dispersions if one.together)
    return Mistake((*one.path, "together"), one.together, text)


def _factor(size: int, matrix: Mapping[tuple[int, int], float]) -> npt.NDArray[np.float64] | None:
    if not matrix:
        return None
    full = np.eye(size)
    for (i, j), value in matrix.items():
        full[i, j] = value
    try:
        return np.asarray(np.linalg.cholesky(full), dtype=float)
    except np.linalg.LinAlgError:
        return None


def reach(scene: Scene) -> Any:
    """All of a scene that reaches an FMU, as plain data: parameters, inputs, terms, tables, texts."""
    told = content(scene)["phases"]
    parts = ("model", "terms", "fmu", "parameters", "texts", "tables", "sources", "tolerance")
    return [
        [{name: part.get(name) for name in parts} for part in (phase["main"], *phase.get("others", []))]
        for phase in told
    ]


def _tried(spec: Spec, base: Scene, one: Dispersion, made: Sequence[Input], group: Group) -> Iterator[Mistake]:
    """Whether each number of a dispersion can be set in the scene, and changes what reaches an FMU."""
    for place, number in enumerate(made):
        points = [(i + 0.5) / len(number.texts) for i in range(len(number.texts))] if number.texts else _PROBES
        values = list(map(float, range(len(number.texts)))) if number.texts else [number.value(u) for u in points]
        found: dict[str, tuple[str, float]] = {}
        for value in values:
            whole = [one_of.value(0.5) for one_of in made]
            whole[place] = value
            told = number.told(value).given
            try:
                scene = parse(base.text, base.name, base.source, Path(base.source).parent, group.write(whole))
            except InputError as error:
                yield _refusal(base, one, told, error)
                return
            same, before = found.setdefault(digest(reach(scene)), (told, value))
            if before != value:
                text = (
                    f"{same} and {told} come to the same in {base.name}: nothing that reaches an FMU differs; "
                    "expected a key that changes something"
                )
                yield Mistake((*one.path, "key"), number.name, text)
                return


def _refusal(base: Scene, one: Dispersion, told: str, error: InputError) -> Mistake:
    """Why the scene does not take a value, in the campaign's terms."""
    if not isinstance(error, SceneError):
        return Mistake((*one.path, "key"), one.key, f"{base.name} does not take {told}: {error}")
    first = error.mistakes[0]
    where = dotted(first.path)
    key, place = (where, "keys") if one.keys else (one.key, "key")
    if first.name:
        known = [f"{key.rpartition('.')[0]}.{name}" for name in first.known]
        return unknown((*one.path, place), key, f"{base.name} has no such key", key, known)
    return Mistake((*one.path, place), one.key, f"{base.name} does not take {told}: {where} {first.expected}")
