"""A grid of cases from keys that are varied: `--vary KEY=VALUE,VALUE,...`, every value with every other.

    removal.tether.rest_length=50 m,100 m,200 m           values as --set takes them
    removal.tether.rest_length=10 m..100 m:10             ten values, evenly spread, ends included
    removal.thrust.level=-0.001 N..-1 N:7:log             seven, evenly spread in their logarithm
    capture.target.start_rate=["1 deg/s","0 deg/s","0 deg/s"],["0 deg/s","1 deg/s","0 deg/s"]

A key that changes nothing in what reaches an FMU or the master is an error, as is a value that works in no case. A
combination of values that do not go together is a case that is refused, and its row says why.
"""

from __future__ import annotations

import itertools
import math
import re
import tomllib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from dcone_cosim.cases.case import Value, content, digest
from dcone_cosim.errors import InputError
from dcone_cosim.loading import load
from dcone_cosim.scene.data import Scene
from dcone_cosim.scene.expected import number_and_unit
from dcone_cosim.scene.mistakes import SceneError
from dcone_cosim.units import PURE, by_name, named, si_name

FORM = 'expected KEY=VALUE,VALUE,... or KEY=FIRST..LAST:COUNT, such as removal.tether.rest_length="50 m,100 m"'
MOST = 100_000
"""Cases of a grid."""
_NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
_RANGE = re.compile(rf"\s*({_NUMBER})\s*([^\d\s.:][^.:]*)?\.\.\s*({_NUMBER})\s*([^\d\s.:][^:]*)?(?::(.*))?", re.DOTALL)
_CLOSING = {"[": "]", "{": "}", '"': '"', "'": "'"}


@dataclass(frozen=True)
class Varied:
    """A key and the texts of its values, in their order."""

    key: str
    values: tuple[str, ...]


@dataclass(frozen=True)
class Combination:
    """Values of all varied keys, and the scene with them, or why there is none."""

    values: Mapping[str, Value]
    settings: tuple[str, ...]
    scene: Scene | None
    refusal: str = ""


def read(arguments: Sequence[str], settings: Sequence[str] = ()) -> list[Varied]:
    """The keys that are varied, from the arguments of `--vary`; `settings` are those of `--set`."""
    found: list[Varied] = []
    fixed = {setting.partition("=")[0].strip() for setting in settings}
    for argument in arguments:
        key, sign, text = argument.partition("=")
        key = key.strip()
        if not sign or not key or not text.strip():
            raise InputError(f"--vary {argument}: {FORM}")
        if key in {varied.key for varied in found}:
            raise InputError(f"--vary {argument}: {key} is varied twice; give all of its values at once")
        if key in fixed:
            raise InputError(f"--vary {argument}: {key} is given by --set too; leave one of them out")
        values = [value for piece in _pieces(argument, text) for value in _expanded(argument, piece)]
        if len(values) < 2:
            raise InputError(f"--vary {argument}: one value; expected two at least (one is given by --set)")
        found.append(Varied(key, tuple(values)))
    if not found:
        raise InputError(f"nothing is varied; give --vary: {FORM}")
    return checked(found)


def checked(keys: list[Varied]) -> list[Varied]:
    """The same, if they make no more cases than a grid may have."""
    if not keys or not all(key.values for key in keys):
        raise InputError("nothing is varied; expected a key with its values")
    count = math.prod(len(varied.values) for varied in keys)
    if count > MOST:
        raise InputError(f"a grid of {count:,} cases; expected {MOST:,} at most")
    return keys


def _pieces(argument: str, text: str) -> list[str]:
    """The parts of a text between commas that are in no bracket and no quotes."""
    text = text.strip()
    if len(text) > 1 and text[0] in "\"'" and text[0] == text[-1] and text.count(text[0]) == 2 and "," in text:
        text = text[1:-1]  # quotes that a shell has left around all of them
    pieces, waiting, begin = [], list[str](), 0
    for place, letter in enumerate(text):
        if waiting and letter == waiting[-1]:
            waiting.pop()
        elif letter in _CLOSING and not (waiting and waiting[-1] in "\"'"):
            waiting.append(_CLOSING[letter])
        elif letter == "," and not waiting:
            pieces.append(text[begin:place])
            begin = place + 1
    pieces = [piece.strip() for piece in (*pieces, text[begin:])]
    if waiting:
        raise InputError(f"--vary {argument}: a {waiting[-1]} is missing; {FORM}")
    if not all(pieces):
        raise InputError(f"--vary {argument}: a value is empty; {FORM}")
    return pieces


def _expanded(argument: str, piece: str) -> list[str]:
    """A value, or the values of a range."""
    if ".." not in piece or piece[0] in _CLOSING:
        return [piece]
    match = _RANGE.fullmatch(piece)
    if match is None:
        raise InputError(f"--vary {argument}: {piece!r} is no range; expected FIRST..LAST:COUNT, as in 10 m..100 m:10")
    first, last = float(match[1]), float(match[3])
    unit, other = (match[2] or "").strip(), (match[4] or "").strip()
    count, _, spread = (match[5] or "").partition(":")
    if unit and other and unit != other:
        raise InputError(f"--vary {argument}: a range from {unit} to {other}; expected one unit")
    if not count.strip().isdigit() or int(count) < 2:
        example = f"{piece.split(':')[0]}:10"
        raise InputError(f"--vary {argument}: {piece!r} does not say how many values; expected two or more: {example}")
    if int(count) > MOST:
        raise InputError(f"--vary {argument}: {int(count):,} values; expected {MOST:,} at most")
    if spread.strip() not in ("", "log", "lin"):
        raise InputError(
            f"--vary {argument}: {spread.strip()!r} is no spread; expected log, or nothing for an even one"
        )
    if spread.strip() == "log":
        if first * last <= 0.0:
            raise InputError(
                f"--vary {argument}: a logarithmic range from {first:g} to {last:g}; expected one sign, no zero"
            )
        numbers = np.geomspace(first, last, int(count))
    else:
        numbers = np.linspace(first, last, int(count))
    return [f"{_number(number)} {unit or other}".rstrip() for number in numbers.tolist()]


def _number(value: float) -> str:
    """Twelve digits at most, so that what a person would write comes out: 0.3, and not 0.30000000000000004."""
    return f"{value:.12g}"


def in_si(given: str) -> Value:
    """A value as given, and what it is in SI if it is a number with or without a unit."""
    try:
        text = tomllib.loads(f"value={given}")["value"]
    except (tomllib.TOMLDecodeError, ValueError, KeyError):
        text = given
    if isinstance(text, bool) or not isinstance(text, int | float | str):
        return Value(given)
    if not isinstance(text, str):
        return Value(given, float(text), "1")
    number, name = number_and_unit(text) or (math.nan, "")
    unit = named(name) if name else by_name("1")
    if math.isnan(number) or unit is None:
        return Value(text)
    return Value(text, unit.to_si(number), si_name(unit.dimension or PURE))  # one name, whatever it is written in


def grid(
    name: str, varied: Sequence[Varied], settings: Sequence[str] = (), said: Callable[[str], object] = lambda _: None
) -> list[Combination]:
    """Every combination of the values, the last key changing first, its scene checked.

    `InputError` for a value that works in no combination, and for a key that changes nothing.
    """
    values = {key.key: [in_si(value) for value in key.values] for key in varied}
    count = math.prod(len(key.values) for key in varied)
    if count > 1000:
        said(f"checking {count:,} cases")
    found = []
    for combination in itertools.product(*values.values()):
        chosen = dict(zip(values, combination, strict=True))
        added = tuple(f"{key}={value.given}" for key, value in chosen.items())
        try:
            found.append(Combination(chosen, added, load(name, [*settings, *added])))
        except InputError as error:
            found.append(Combination(chosen, added, None, _told(error, added)))
    _need_to_work(values, found)
    _need_effects(name, found)
    return found


def first_two(name: str, varied: Sequence[Varied], settings: Sequence[str] = ()) -> list[Scene]:
    """The scenes of the first two combinations; none where one of them cannot be."""
    *others, last = varied
    fixed = [f"{key.key}={in_si(key.values[0]).given}" for key in others]
    try:
        return [load(name, [*settings, *fixed, f"{last.key}={in_si(of).given}"]) for of in last.values[:2]]
    except InputError:
        return []


def _need_to_work(values: Mapping[str, Sequence[Value]], found: Sequence[Combination]) -> None:
    for key, of in values.items():
        for value in of:
            with_it = [c for c in found if c.values[key] is value]
            if not any(c.scene for c in with_it):
                refusal, given = with_it[0].refusal, f"--vary {key}={value.given}: "
                raise InputError(refusal if given in refusal else f"{given}it works in no case: {refusal}")


def _told(error: InputError, settings: Sequence[str]) -> str:
    """What is wrong with a scene, in one line that names no folder, and that calls what is varied so."""
    told = str(error)
    if isinstance(error, SceneError):
        told = "; ".join(
            f"{row['place'] and row['place'] + ': '}{row['key']} = {row['given']}: {row['expected']}"
            for row in error.rows()
        )
    for setting in settings:
        told = told.replace(f"--set {setting}", f"--vary {setting}")
    return told


def _need_effects(name: str, found: Sequence[Combination]) -> None:
    """No two combinations may come to the same."""
    before: dict[str, Combination] = {}
    for combination in found:
        if combination.scene is None:
            continue
        same = before.setdefault(digest(content(combination.scene)), combination)
        if same is combination:
            continue
        unlike = [key for key, value in combination.values.items() if same.values[key] is not value]
        told = " and ".join(f"{key} = {same.values[key].given} and = {combination.values[key].given}" for key in unlike)
        raise InputError(
            f"--vary: {told} come to the same in {name}: no value, term or option that reaches an FMU or the master "
            "differs; expected values that change something"
        )
