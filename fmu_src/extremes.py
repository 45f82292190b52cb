"""What a part says of the ends of its range: cases so stiff, light, fast or long that a scheme may break on them.

A part gives its own with its term (`Term.extremes`), a model those that belong to no part, in its module `stress`. Each
changes a scene that is known to work in the one thing that it is about.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

Values = Mapping[str, float]
Given = float | Sequence[float] | Callable[[Values], float]
"""A value [SI], that of a whole vector, or what it is by the values of the scene that is changed."""


@dataclass(frozen=True)
class Extreme:
    """One case.

    name         as it stands in a table
    text         what it is about, in a sentence
    criterion    by which it is judged before all others, see the criteria of its kind of phase; the others count too
    values       by FMI name, or of a vector by its name without indices
    terms        group: its term, or None where the case goes without
    needs        groups without which it says nothing
    idle         terms with which nothing would happen in it, by group
    duration     of the phase; 0: as it is [s]
    macro_step   of the phase; 0: as it is [s]
    scatters     why a finer run cannot be asked to come to the same; "" where it can
    chief        among the few that are tried when there is little time
    """

    name: str
    text: str
    criterion: str
    values: Mapping[str, Given] = field(default_factory=dict)
    terms: Mapping[str, str | None] = field(default_factory=dict)
    needs: tuple[str, ...] = ()
    idle: Mapping[str, str] = field(default_factory=dict)
    duration: float = 0.0
    macro_step: float = 0.0
    scatters: str = ""
    chief: bool = False

    def given(self, values: Values) -> dict[str, float | Sequence[float]]:
        """What it sets in a scene of these values."""
        return {name: value(values) if callable(value) else value for name, value in self.values.items()}


def times(name: str, factor: float) -> Callable[[Values], float]:
    """So many times what the scene has."""
    return lambda values: factor * values[name]
