"""The lines of a model, each an entry of a table: what a scene may make it of, and what bears its load.

Each model that has lines has a module `lines` with `LINES`. No FMU knows of materials: a scene that names one gives the
parameters that follow from it, and what came out of the run is judged by its strength.

    stress = T / A,   strain = T / (E A)        T the largest tension, a dashpot's share included

Checked  tests/cosim/test_loads.py
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field

from orbital.materials import Material, section

Values = Mapping[str, float]
Terms = Mapping[str, str]


def _unknown(values: Values, terms: Terms) -> float | None:
    return None


@dataclass(frozen=True)
class Line:
    """A kind of line that a model has.

    name            in the keys of summaries: "line" in "line.stress"
    label           in sentences: "the line"
    table           of a scene that says what it is made of
    tension         outputs of its largest tension, of which the first that is there counts [N]
    follows         parameters that a material gives by the name of its figure, where the scene does not say them; an
                    axial stiffness is for its diameter
    modulus         parameter that is its Young's modulus, "" for none
    stiffness       parameter that is its E A, "" for none
    diameter        parameter that is its diameter; where the model has none of that name, a key of the scene alone
    usual           diameter that is taken where the scene says neither it nor the stiffness [m]
    usual_material  of which it is by default, "" for none
    breaks_at       parameter that is the load at which it breaks in the model, "" for none
    broken          outputs that tell that it broke, and when
    group           without a term of which the model does not have it, "" for none
    area            `area(values, terms)` of the section of one that has no diameter [m2]
    """

    name: str
    label: str
    table: str
    tension: tuple[str, ...]
    follows: Mapping[str, str] = field(default_factory=dict)
    modulus: str = ""
    stiffness: str = ""
    diameter: str = ""
    usual: float | None = None
    usual_material: str = ""
    breaks_at: str = ""
    broken: tuple[str, str] | None = None
    group: str = ""
    area: Callable[[Values, Terms], float | None] = _unknown

    def follow(self, material: Material, diameter: float | None, offered: Collection[str]) -> dict[str, float]:
        """Values of those parameters on offer that its material gives, SI by FMI name.

        diameter    [m], None where nothing tells it
        """
        found: dict[str, float] = {}
        for name, figure in self.follows.items():
            value = getattr(material, figure)
            if callable(value):
                value = value(diameter) if diameter is not None else None
            if value is not None and name in offered:
                found[name] = value
        return found

    def section(self, values: Values, terms: Terms, material: Material | None, diameter: float | None) -> float | None:
        """Area [m2] that its stress counts; None where nothing tells it.

        material    of which it is, None where none is known
        diameter    that the scene alone knows [m]
        """
        known = values.get(self.diameter, diameter) if self.diameter else None
        if known is not None:
            return section(known)
        if self.stiffness in values and material is not None:
            return values[self.stiffness] / material.youngs_modulus
        return self.area(values, terms)

    def axial_stiffness(self, values: Values, area: float | None) -> float | None:
        """E A [N]; None where nothing tells it."""
        if self.stiffness in values:
            return values[self.stiffness]
        return None if area is None or self.modulus not in values else values[self.modulus] * area
