"""In what two scenes differ, key by key, as far as it reaches an FMU or the master."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from dcone_cosim.cases.case import content
from dcone_cosim.scene.data import Scene

MISSING = "nothing"


@dataclass(frozen=True)
class Difference:
    """A key that is other in the second scene.

    key    as a scene says it, "removal.tether.diameter"; an element of a vector with its index
    part   "parameters", "terms", "inputs" or the name of another field of the phase's main component; "" of the phase
    name   of the parameter or field
    """

    phase: str
    part: str
    name: str
    was: Any
    now: Any

    @property
    def key(self) -> str:
        return ".".join(filter(None, (self.phase, self.name)))

    def told(self) -> str:
        return f"{self.key}: was {_spoken(self.was)}, is {_spoken(self.now)}"


def _spoken(value: Any) -> str:
    return f"{value:.9g}" if isinstance(value, float) else str(value)


def differences(before: Scene, after: Scene) -> list[Difference]:
    """All of them, phase by phase; values SI.

    Checked  tests/resume/test_differences.py
    """
    one, other = content(before), content(after)
    phases = {phase["name"]: phase for phase in one.pop("phases")}
    others = {phase["name"]: phase for phase in other.pop("phases")}
    found = [Difference("", "", name, was, now) for name, was, now in _of(one, other)]
    for phase in {**phases, **others}:
        found += _of_phase(phase, phases.get(phase), others.get(phase))
    return found


def _of_phase(phase: str, one: Any, other: Any) -> Iterator[Difference]:
    if one is None or other is None:
        told = ("a phase", MISSING)
        yield Difference(phase, "", "", *(told if other is None else told[::-1]))
        return
    for part in ("parameters", "terms"):
        for name, was, now in _of(one["main"].pop(part), other["main"].pop(part)):
            yield Difference(phase, part, name, was, now)
    mains = one.pop("main"), other.pop("main")
    yield from (Difference(phase, "main", name, was, now) for name, was, now in _of(*mains))
    for name, was, now in _of(one, other):
        yield Difference(phase, "", name.removeprefix("options."), was, now)


def _of(one: Any, other: Any, name: str = "") -> Iterator[tuple[str, Any, Any]]:
    """Leaves of two trees that differ."""
    if isinstance(one, Mapping) and isinstance(other, Mapping):
        for key in {**one, **other}:
            inner = f"{name}.{key}" if name else str(key)
            yield from _of(one.get(key, MISSING), other.get(key, MISSING), inner)
    elif one != other and not (one != one and other != other):  # what is not known is the same as what is not known
        yield name, one, other
