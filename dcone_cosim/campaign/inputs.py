"""The numbers that are drawn for a case, held against the scene before anything is run.

A dispersion whose key the scene does not have, or that changes nothing that reaches an FMU, is a mistake told with its
line: a campaign whose dispersions are never applied would look as good as any other.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from dcone_cosim import build
from dcone_cosim.campaign import distributions
from dcone_cosim.campaign.distributions import DISCRETE, Quantile, Unfit
from dcone_cosim.campaign.spec import ADAPTIVE, Dispersion, Spec
from dcone_cosim.cases import ensemble
from dcone_cosim.cases.case import Value, content, digest
from dcone_cosim.errors import InputError
from dcone_cosim.loading import load, shipped
from dcone_cosim.scene.data import SHARED, ComponentScene, Scene
from dcone_cosim.scene.expected import number_and_unit
from dcone_cosim.scene.mistakes import Mistake, Mistakes, SceneError, unknown
from dcone_cosim.scenes.reading import parse
from dcone_cosim.units import PURE, Unit, by_name, named, si_name, spoken

JITTER = "jitter"
"""Name of the input that is the solver's jitter."""
SEEDS = 2**31 - 1
"""Seeds that the jitter may have."""
NORMAL = ("normal", "lognormal")
"""Distributions that are told best by their normal scores."""
_ELEMENT = re.compile(r"(.+)\[(\d+)\]")
_PROBES = (0.25, 0.75)
"""Where on its distribution a value is tried before anything is run."""
Point = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Input:
    """One number that is drawn.

    name       its key, with the element of a vector behind it
    value      of a coordinate of the unit cube, SI; of a discrete one the place among its texts
    unit       SI, FMI name
    texts      of a discrete one
    points     coordinates of a grid
    normal     whether its normal score tells it best
    """

    name: str
    value: Callable[[float], float]
    unit: str = "1"
    texts: tuple[str, ...] = ()
    points: tuple[float, ...] = ()
    normal: bool = False

    def told(self, value: float) -> Value:
        """As a table has it."""
        if self.texts:
            return _as_value(self.texts[int(value)])
        text = f"{value!r} {spoken(self.unit)}".rstrip() if self.unit != "1" else repr(value)
        return Value(text, value, self.unit)


@dataclass(frozen=True)
class Group:
    """The inputs of one dispersion, and the settings that give a case its values.

    places    of these inputs among all
    write     settings from their values, SI
    """

    places: tuple[int, ...]
    write: Callable[[Sequence[float]], tuple[str, ...]]


@dataclass(frozen=True)
class Inputs:
    """All that is drawn for a case.

    factor    lower triangular (d, d) matrix of the correlated normal scores; None where none are
    """

    inputs: tuple[Input, ...]
    groups: tuple[Group, ...]
    factor: npt.NDArray[np.float64] | None = field(default=None, compare=False)

    @property
    def names(self) -> list[str]:
        return [one.name for one in self.inputs]

    def values(self, point: Point) -> list[float]:
        """Values of a point of the unit cube, (d,), each strictly between 0 and 1, SI.

        Correlated by a Gaussian copula: z = L Phi^-1(u), u' = Phi(z), with L L^T the matrix of coefficients.

        Checked  tests/campaign/test_inputs.py
        """
        if self.factor is not None:
            from scipy.special import ndtr, ndtri

            point = ndtr(self.factor @ ndtri(point))
        return [one.value(float(u)) for one, u in zip(self.inputs, point, strict=True)]

    def settings(self, values: Sequence[float]) -> tuple[str, ...]:
        """What a command line would set to run this case alone."""
        return tuple(text for group in self.groups for text in group.write([values[place] for place in group.places]))


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
        load(name)
    except SceneError:
        raise
    except InputError as error:
        raise _wrong(spec, [Mistake(("scene",), spec.scene, str(error))]) from None
    try:
        return load(name, spec.settings)
    except SceneError as error:
        found = [Mistake(("set", *one.path), one.given, one.expected) for one in error.mistakes]
        raise _wrong(spec, found) from None
    except InputError as error:
        raise _wrong(spec, [Mistake(("set",), None, str(error))]) from None


def _wrong(spec: Spec, mistakes: Sequence[Mistake]) -> SceneError:
    return SceneError(mistakes, spec.places)


def inputs_of(spec: Spec, base: Scene, isolate: bool | None = None) -> Inputs:
    """The inputs of a campaign, each tried in the scene; a `SceneError` of the campaign's file lists every mistake.

    Checked  tests/campaign/test_inputs.py
    """
    wrong = Mistakes()
    taken: dict[str, Dispersion] = {}
    inputs: list[Input] = []
    groups: list[Group] = []
    matrix: dict[tuple[int, int], float] = {}
    for one in spec.dispersions:
        other = next((key for key in taken if _overlap(key, one.key)), None)
        if other is not None:
            wrong.append(Mistake((*one.path, "key"), one.key, f"{other} is dispersed above; expected each key once"))
            continue
        taken[one.key] = one
        try:
            made, write = _Maker(spec, base, one).made()
        except _Wrong as error:
            wrong.extend(error.mistakes)
            continue
        places = tuple(range(len(inputs), len(inputs) + len(made)))
        inputs += made
        groups.append(Group(places, write))
        if one.together:
            if not -1.0 < one.together < 1.0 or len(made) < 2:
                text = "expected a number between -1 and 1, of a vector's elements"
                wrong.append(Mistake((*one.path, "together"), one.together, text))
            matrix |= {(i, j): one.together for i in places for j in places if i != j}
        wrong.extend(_tried(spec, base, one, made, groups[-1]))
    if spec.jitter:
        inputs.append(Input(JITTER, lambda u: float(min(int(u * SEEDS), SEEDS - 1)), points=()))
        groups.append(Group((len(inputs) - 1,), lambda values: ensemble.jitter(base, int(values[0]))))
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
        wrong.append(Mistake(("correlation",), None, "these coefficients contradict one another: no values have them"))
    if wrong:
        raise _wrong(spec, wrong)
    return Inputs(tuple(inputs), tuple(groups), factor)


def _overlap(one: str, other: str) -> bool:
    """Whether two keys set the same: a vector and an element of it, or twice the same."""
    plain = [key.partition("[")[0] for key in (one, other)]
    return one == other or (plain[0] == plain[1] and ("[" not in one or "[" not in other))


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


class _Wrong(Exception):
    def __init__(self, *mistakes: Mistake) -> None:
        super().__init__()
        self.mistakes = mistakes


class _Maker:
    """Makes the inputs of one dispersion."""

    def __init__(self, spec: Spec, base: Scene, one: Dispersion) -> None:
        self.spec, self.base, self.one = spec, base, one
        match = _ELEMENT.fullmatch(one.key)
        self.key, self.element = (match[1], int(match[2])) if match else (one.key, 0)
        self.present, self.unit, self.given = standing(base, self.key)

    def made(self) -> tuple[list[Input], Callable[[Sequence[float]], tuple[str, ...]]]:
        one, size = self.one, len(self.present)
        if self.element and not 1 <= self.element <= size:
            text = f"{self.key} has {size} elements" if size else f"{self.base.name} has no vector of that name"
            raise _Wrong(Mistake((*one.path, "key"), one.key, text))
        if self.element and self.unit == "1" and not self.given:
            text = (
                "the scene leaves this direction at its default, which is none that a single element can be set in; "
                f"give all of it first, in [set.{self.key.rpartition('.')[0]}]"
            )
            raise _Wrong(Mistake((*one.path, "key"), one.key, text))
        if one.distribution == DISCRETE:
            return self._discrete()
        elements = [self.element] if self.element else list(range(1, size + 1)) if size else [0]
        found, unit = [], ""
        for element in elements:
            quantile, unit = self._quantile(element)
            name = f"{self.key}[{element}]" if element else self.key
            found.append(Input(name, quantile, unit, (), _grid(one), one.distribution in NORMAL))
        return found, self._writer(elements, unit)

    def _discrete(self) -> tuple[list[Input], Callable[[Sequence[float]], tuple[str, ...]]]:
        one = self.one
        if self.element:
            text = "a discrete distribution takes a whole key, not an element of it"
            raise _Wrong(Mistake((*one.path, "key"), one.key, text))
        choose = distributions.chooser(one.weights)
        ends = np.cumsum([0.0, *one.weights]) / math.fsum(one.weights)
        points = tuple((0.5 * (ends[1:] + ends[:-1])).tolist())
        found = Input(one.key, lambda u: float(choose(u)), "1", tuple(one.values), points)
        return [found], lambda values: (f"{one.key}={one.values[int(values[0])]}",)

    def _writer(self, elements: Sequence[int], unit: str) -> Callable[[Sequence[float]], tuple[str, ...]]:
        key, present = self.key, self.present

        def text(value: float) -> str:
            return repr(value) if unit == "1" else f'"{value!r} {spoken(unit)}"'

        if not any(elements):
            return lambda values: (f"{key}={text(values[0])}",)

        def write(values: Sequence[float]) -> tuple[str, ...]:
            whole = list(present)
            for element, value in zip(elements, values, strict=True):
                whole[element - 1] = value
            return (f"{key}=[{', '.join(text(value) for value in whole)}]",)

        return write

    def _quantile(self, element: int) -> tuple[Quantile, str]:
        """Quantile function of one number, SI, and the FMI name of its unit."""
        one = self.one
        kind = distributions.KINDS.get(one.distribution) or distributions.of_scipy(one.distribution)
        assert kind is not None
        told = dict(one.told)
        here = self.present[element - 1] if element else self._alone()
        numbers: dict[str, float] = {}
        units: dict[str, Unit] = {}
        shares: dict[str, float] = {}
        if "within" in told:
            self._read("within", told.pop("within"), numbers, units, shares)
        for name, given in told.items():
            if name in kind.pure:
                if isinstance(given, bool) or not isinstance(given, int | float):
                    raise _Wrong(Mistake((*one.path, name), given, "expected a bare number"))
                numbers[name] = float(given)
            else:
                self._read(name, given, numbers, units, shares)
        unit = self._one_unit(units)
        middle = numbers.get("mean", numbers.get("likeliest", here))
        for name, share in shares.items():
            if middle is None or math.isnan(middle):
                raise _Wrong(self._without_value(name))
            scale = middle if name in ("least", "most", "mean", "likeliest", "loc") else abs(middle)
            numbers[name] = scale * share
        if "within" in numbers:
            numbers |= self._within(numbers.pop("within"), here, numbers)
        if "mean" in kind.needs and "mean" not in numbers and here is not None:
            numbers["mean"] = here
        for name in kind.needs:
            if name not in numbers:
                text = f"expected it: {one.distribution} needs {', '.join(kind.needs)}"
                raise _Wrong(Mistake((*one.path, name), None, text))
        try:
            return kind.make(numbers), unit
        except Unfit as error:
            raise _Wrong(Mistake((*one.path, error.name), one.told.get(error.name), str(error))) from None

    def _without_value(self, name: str) -> Mistake:
        """Of a share of what the scene does not tell: probably its key is misspelt."""
        known = _keys(self.base)
        if self.key not in known:
            path = (*self.one.path, "key")
            return unknown(path, self.one.key, f"{self.base.name} has no such key with a number", self.key, known)
        text = f"a share needs the value that it is of; {self.key} has none in the scene"
        return Mistake((*self.one.path, name), self.one.told.get(name), text)

    def _alone(self) -> float | None:
        """Value of a key that is no vector."""
        values, _, _ = _named(self.base, self.key)
        return values

    def _within(self, half: float, here: float | None, numbers: Mapping[str, float]) -> dict[str, float]:
        """Ends of what lies within so much of the scene's value."""
        if here is None or not {"least", "most"}.isdisjoint(numbers):
            text = "expected least and most, or within about a value that the scene has"
            raise _Wrong(Mistake((*self.one.path, "within"), self.one.told.get("within"), text))
        return {"least": here - half, "most": here + half}

    def _read(
        self, name: str, given: Any, numbers: dict[str, float], units: dict[str, Unit], shares: dict[str, float]
    ) -> None:
        path = (*self.one.path, name)
        if isinstance(given, int | float) and not isinstance(given, bool):
            numbers[name], units[name] = float(given), by_name("1")
            return
        number, word = (number_and_unit(given) if isinstance(given, str) else None) or (math.nan, "")
        if word == "%" and math.isfinite(number):
            shares[name] = number / 100.0
            return
        unit = named(word) if word else by_name("1")
        if not math.isfinite(number) or unit is None:
            raise _Wrong(Mistake(path, given, 'expected a number with its unit such as "3 m/s", or a share "1 %"'))
        difference = unit.of_differences() if name in ("deviation", "scale", "within") else unit
        numbers[name], units[name] = difference.to_si(number), unit

    def _one_unit(self, units: Mapping[str, Unit]) -> str:
        """FMI name of the SI unit that all are in."""
        found = {name: si_name(unit.dimension or PURE) for name, unit in units.items()}
        expected = self.unit or next(iter(found.values()), "1")
        for name, unit in found.items():
            if (by_name(unit).dimension or PURE) != (by_name(expected).dimension or PURE):
                told = spoken(expected) or "a pure number"
                text = f"is in {spoken(unit) or 'no unit'}; {self.key} is in {told}"
                raise _Wrong(Mistake((*self.one.path, name), self.one.told.get(name), text))
        return expected


def _grid(one: Dispersion) -> tuple[float, ...]:
    """Coordinates of a grid's values: evenly spaced between the ends where there are such, at even shares elsewhere."""
    count = one.points
    if not count:
        return ()
    if one.distribution == "uniform":
        return tuple(np.linspace(0.0, 1.0, count).tolist())
    return tuple(((np.arange(count) + 0.5) / count).tolist())


def standing(base: Scene, key: str) -> tuple[list[float], str, bool]:
    """Elements [SI] of a vector of the scene by its key, none where it is none; the FMI name of its unit, "" where that
    is not known; and whether the scene gives it."""
    found: list[float] = []
    unit, given = "", False
    while True:
        value, of, there = _named(base, f"{key}[{len(found) + 1}]")
        if value is None:
            break
        found.append(value)
        unit, given = of, given or there
    if not found:
        _, unit, given = _named(base, key)
    return found, unit, given


def _named(base: Scene, key: str) -> tuple[float | None, str, bool]:
    """Value [SI] of one number of the scene by its key, its unit, and whether the scene gives it."""
    head, _, rest = key.partition(".")
    for phase in base.phases:
        component: ComponentScene | None = phase.main
        name = key if head == SHARED else rest if phase.name == head else ""
        if name.startswith("components."):
            part, _, name = name.removeprefix("components.").partition(".")
            component = next((one for one in phase.others if one.name == part), None)
        if component is None or not name:
            continue
        value = component.values.get(name, component.asked.get(name))
        if isinstance(value, int | float):
            return float(value), _unit_of(component, name), name in component.parameters
    return None, "", False


def _keys(base: Scene) -> list[str]:
    """Keys of all numbers of the scene's own phases."""
    return [
        f"{phase.name}.{name.partition('[')[0]}" if not name.startswith(f"{SHARED}.") else name
        for phase in base.phases
        for name in phase.main.values
    ]


def _unit_of(component: ComponentScene, name: str) -> str:
    if not component.model:
        return ""
    known = build.known_variables(component.model) | build.asked_variables(component.model)
    return known[name][0].unit if name in known else ""


def reach(scene: Scene) -> Any:
    """All of a scene that reaches an FMU, as plain data: parameters, inputs, terms, tables, texts."""
    told = content(scene)["phases"]
    parts = ("model", "terms", "fmu", "parameters", "texts", "tables", "tolerance")
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
    known = [f"{one.key.rpartition('.')[0]}.{name}" for name in first.known] if first.name else []
    if first.name:
        return unknown((*one.path, "key"), one.key, f"{base.name} has no such key", one.key, known)
    where = ".".join(map(str, first.path))
    return Mistake((*one.path, "key"), one.key, f"{base.name} does not take {told}: {where} {first.expected}")


def shown(one: Input, value: float) -> str:
    """A value as a person reads it."""
    if one.texts:
        return one.texts[int(value)]
    return f"{value:.5g} {spoken(one.unit)}".rstrip() if one.unit != "1" else f"{value:.5g}"


def _as_value(given: str) -> Value:
    from dcone_cosim.cases.vary import in_si

    return in_si(given)
