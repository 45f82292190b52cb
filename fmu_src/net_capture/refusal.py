"""Whether a shot can work at all: necessary conditions, in closed form, for a clear refusal before any build or run.

They are bounds, not a prediction: a scene that passes may still miss, and only the run tells. Each part of a scene says
what it refuses, and the shot what lies between them.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple


class Refusal(NamedTuple):
    """A value that makes the shot impossible: FMI name, the value as text, what was expected."""

    name: str
    value: str
    expected: str


class Scene(NamedTuple):
    """What a part may look at: terms by group, every value by FMI name [SI], how long the capture lasts [s], and the
    parts themselves by group."""

    terms: Mapping[str, str]
    values: Mapping[str, Any]
    duration: float
    parts: Mapping[str, Any]

    def vector(self, name: str, size: int = 3) -> list[float]:
        """The components of a value."""
        return [float(self.values[f"{name}[{i}]"]) for i in range(1, size + 1)]


def text(values: list[float], unit: str = "") -> str:
    """A vector as a scene writes it."""
    return "[" + ", ".join(f"{value:g}{unit}" for value in values) + "]"
