"""What lines are made of: stiffness, density and strength of fibres by name, each figure with its data sheet.

A figure that no sheet tells is None. Stress counts the section of a solid round of the line's diameter, pi d^2/4. A
yarn fills it; a braid has gaps, and its yarns run at an angle: per section it is lighter, softer and weaker.

Checked  tests/orbital/test_materials.py
"""

from __future__ import annotations

import difflib
import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType

FORMS = ("yarn", "braid")
KGF_PER_MM2 = 9.80665e6
"""Pa in 1 kgf/mm2, exact."""


@dataclass(frozen=True)
class Material:
    """A line's material; None is what no source tells.

    name              as scenes write it
    form              one of `FORMS`
    youngs_modulus    E      axial, over the section of a solid round       [Pa]
    density           rho    likewise                                       [kg/m3]
    strength          sigma  tensile stress at which it breaks              [Pa]
    strain_at_break   eps    elongation at which it breaks                  [1]
    damping_ratio     zeta   of a pair of bodies on it                      [1]
    sources           of each figure, by its name
    """

    name: str
    youngs_modulus: float
    density: float
    strength: float | None = None
    strain_at_break: float | None = None
    damping_ratio: float | None = None
    form: str = "yarn"
    sources: Mapping[str, str] = field(default_factory=dict, compare=False)

    def axial_stiffness(self, diameter: float) -> float:
        """E A [N] of a line of this diameter [m]."""
        return self.youngs_modulus * section(diameter)

    def breaking_load(self, diameter: float) -> float | None:
        """sigma A [N] of a line of this diameter [m]; None where the strength is not known."""
        return None if self.strength is None else self.strength * section(diameter)

    def mass_per_metre(self, diameter: float) -> float:
        """rho A [kg/m] of a line of this diameter [m]."""
        return self.density * section(diameter)

    def diameter_for(self, load: float) -> float | None:
        """Diameter [m] of a line that breaks at this load [N]; None where the strength is not known.

        d = sqrt(4 P / (pi sigma))
        """
        return None if self.strength is None else math.sqrt(4.0 * load / (math.pi * self.strength))

    def braided(self) -> Material:
        """A braid of it; itself where it is one."""
        if self.form == "braid":
            return self
        strength = None if self.strength is None else BRAID_STRENGTH * self.strength
        strain = None if self.strain_at_break is None else BRAID_STRENGTH / BRAID_MODULUS * self.strain_at_break
        sources = {
            figure: f"{source}; braid: {_BRAID[figure]}" if figure in _BRAID else source
            for figure, source in self.sources.items()
        }
        return replace(
            self,
            form="braid",
            youngs_modulus=BRAID_MODULUS * self.youngs_modulus,
            density=BRAID_DENSITY * self.density,
            strength=strength,
            strain_at_break=strain,
            sources=sources,
        )


BRAID_DENSITY, BRAID_MODULUS, BRAID_STRENGTH = 0.67, 0.35, 0.41
"""Figures of a braid over those of its yarn, per section of its nominal diameter."""
_BRAID = {
    "density": "x 0.67, as 0.391 kg/m at 24 mm of nylon and polyester are (English Braids, Superyacht Dockline)",
    "strength": "x 0.41, as 5,400 lb at 3/16 in of Dyneema SK75 in 12 strands are (Samson, AmSteel-Blue)",
    "youngs_modulus": "x 0.35, assumed: a braid beds in, so that it gives more than its strength falls",
    "strain_at_break": "x 0.41/0.35, follows from the two",
}


def section(diameter: float) -> float:
    """Area [m2] of a solid round: pi d^2/4."""
    return math.pi * diameter * diameter / 4.0


def stress(tension: float, area: float) -> float:
    """Tensile stress [Pa] of a tension [N] over a section [m2]."""
    return tension / area


def margin_of_safety(strength: float, stress: float, factor: float = 1.0) -> float:
    """Margin of safety [1]: negative where the strength is exceeded.

        MS = sigma / (FoS sigma_applied) - 1

    strength  sigma          at which it breaks                             [Pa]
    stress    sigma_applied  largest there is, above zero                   [Pa]
    factor    FoS            factor of safety asked for; 1: of the strength itself

    Source   ECSS-E-ST-32C and NASA-STD-5001B, margin of safety
    Checked  tests/orbital/test_materials.py
    """
    return strength / (factor * stress) - 1.0 if stress > 0.0 else math.inf


DUPONT = (
    "DuPont, Kevlar technical guide, table II-1: typical properties of yarns, as others cite it: the table could "
    "not be read"
)
TEIJIN = "Teijin, Technora, table 3: tensile properties of industrial fibres"
TOYOBO = (
    "Toyobo, Zylon technical information (2005), section 1: basic properties, as others cite it; read was Imattec, "
    "Zylon: 37 cN/dtex, 1150 (AS) and 1720 cN/dtex (HM), 3.5 and 2.5 %, 1540 and 1560 kg/m3, within 2 % of these"
)
DSM = "DSM Dyneema, fact sheet CIS YA100 (2010), fibre types SK75 and SK78"
TTI = "Tension Technology International, deepwater fibre moorings, table 1: synthetic fibre yarn properties"


NOTHING: Mapping[str, str] = MappingProxyType({})


def _fibre(
    name: str,
    youngs_modulus: float,
    density: float,
    strength: float,
    strain_at_break: float,
    source: str,
    others: Mapping[str, str] = NOTHING,
) -> Material:
    """A yarn all of whose figures stand in one sheet, save those of `others`. No sheet tells a damping ratio."""
    figures = ("youngs_modulus", "density", "strength", "strain_at_break")
    sources = {figure: others.get(figure, source) for figure in figures}  # a plain one: it goes to other processes
    return Material(name, youngs_modulus, density, strength, strain_at_break, sources=sources)


_FIBRES = (
    _fibre(
        "nylon 66", 4.0e6 * 1140.0, 1140.0, 0.84e6 * 1140.0, 0.20, f"{TTI}: 4 and 0.84 N/tex",
        {"strain_at_break": TEIJIN},
    ),
    _fibre("Kevlar 29", 70.5e9, 1440.0, 2.92e9, 0.036, DUPONT),
    _fibre("Kevlar 49", 112.4e9, 1440.0, 3.0e9, 0.024, DUPONT),
    _fibre("Technora", 7500.0 * KGF_PER_MM2, 1390.0, 347.0 * KGF_PER_MM2, 0.045, TEIJIN),
    _fibre(
        "Dyneema SK75", 120e9, 970.0, 3.3e9, 0.035, f"{DSM}: 3 to 4 %",
        {
            "youngs_modulus": f"{DSM}: 109 to 132 GPa",
            "strength": f"{DSM}: 3.3 to 3.9 GPa, of which the least",
            "density": f"HMPE: 940 to 970 kg/m3 in {TTI}; 980 in {TEIJIN}",
        },
    ),
    _fibre("Vectran HT", 7600.0 * KGF_PER_MM2, 1410.0, 329.0 * KGF_PER_MM2, 0.038, f"{TEIJIN}, polyarylate (HT)"),
    _fibre("Zylon AS", 180e9, 1540.0, 5.8e9, 0.035, TOYOBO),
    _fibre("Zylon HM", 270e9, 1560.0, 5.8e9, 0.025, TOYOBO),
)  # fmt: skip
MATERIALS: Mapping[str, Material] = MappingProxyType({fibre.name: fibre for fibre in _FIBRES})
"""Yarns by name."""
ALSO: Mapping[str, str] = MappingProxyType(
    {"nylon": "nylon 66", "HMPE": "Dyneema SK75", "Vectran": "Vectran HT", "PBO": "Zylon HM"}
)
"""Names of kinds of fibres, each with the one that is taken for it."""


def nearest_in_stiffness(youngs_modulus: float) -> Material:
    """The yarn of the table whose Young's modulus is nearest to this one [Pa], by their ratio."""
    return min(MATERIALS.values(), key=lambda fibre: abs(math.log(fibre.youngs_modulus / youngs_modulus)))


class UnknownMaterial(ValueError):
    """A name that no material has.

    given    the name
    known    names that there are
    nearest  the one of them that may be meant, "" for none
    """

    def __init__(self, given: str, known: Iterable[str]) -> None:
        self.given, self.known = given, tuple(known)
        plain = {_plain(name): name for name in self.known}
        found = difflib.get_close_matches(_plain(given), plain, n=1, cutoff=0.5)
        self.nearest = plain[found[0]] if found else ""
        meant = f"; did you mean {self.nearest!r}?" if found else ""
        super().__init__(f"no material is called {given!r}{meant}; known: {', '.join(self.known)}")


def _plain(name: str) -> str:
    return "".join(letter for letter in name.casefold() if letter.isalnum())


def named(name: str, form: str = "yarn", own: Mapping[str, Material] | None = None) -> Material:
    """The material of a name, or `UnknownMaterial`; capitals, spaces and dashes do not count.

    form    one of `FORMS`: a braid of it
    own     further materials by name, which go before those of `MATERIALS`
    """
    mine = own or {}
    places = {_plain(kind): fibre for kind, fibre in ALSO.items()}
    places |= {_plain(known): known for known in (*MATERIALS, *mine)}
    place = places.get(_plain(name))
    if place is None:
        raise UnknownMaterial(name, (*mine, *MATERIALS, *ALSO))
    found = mine[place] if place in mine else MATERIALS[place]
    return found.braided() if form == "braid" else found
