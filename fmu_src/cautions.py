"""What a user may not expect of a run: plain sentences, told before it where values alone say so, else after it.

Each model has a module `cautions` with two functions that yield `Caution`:

    before(values, given, terms)          from what the scene says
    after(values, given, terms, seen)     from what came out

    values    every parameter and input by FMI name, SI
    given     names of those that the scene gives; the others are at their defaults
    terms     terms the scene names, by group; none of an FMU from elsewhere
    seen      `seen(output)` is the `Range` it had, None for one that is not there
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import NamedTuple


class Caution(NamedTuple):
    """What it is about, the name of a variable, and the sentence."""

    about: str
    sentence: str


class Range(NamedTuple):
    """What an output was in a run."""

    least: float
    largest: float
    first: float
    last: float


Seen = Callable[[str], Range | None]

LOWEST_ORBIT = 120e3
"""Altitude [m] below which the air ends an orbit within a revolution; entry is reckoned from 400,000 ft, 122 km."""
HEAVY_DAMPING = 0.5
"""Damping ratio from which on the dashpot's jump is the peak of a snap (`orbital.oscillators.damped_snap_peak`)."""


class Fibre(NamedTuple):
    """Yarns of at least this Young's modulus [Pa] break at about this strain, as the fibre that is named does."""

    modulus: float
    strain: float
    name: str


FIBRES = (
    Fibre(90e9, 0.027, "high-modulus para-aramid"),
    Fibre(20e9, 0.035, "para-aramid (Technora: 4.5 %)"),
    Fibre(0.0, 0.13, "polyester (nylon 66: 20 %)"),
)
"""Elongation at break and modulus of yarns: Teijin, Technora, tensile properties of industrial fibres, table 3 (PPTA
regular 3.5 % at 73 GPa, high modulus 2.7 % at 105 GPa, Technora 4.5 %, HMPE 3.5 % at 86 GPa, polyester 13 %, nylon 66
20 %). DuPont's Kevlar technical guide has 3.6 % and 2.4 % for Kevlar 29 and 49. A scene names no material."""
NYLON, ARAMID = 0.20, 0.035
"""Elongation at break of nylon 66 and of regular para-aramid [1], from that table."""


def strained(
    about: str, what: str, tension: float, axial_stiffness: float, limit: float, fibre: str
) -> Iterator[Caution]:
    """A line whose largest tension would break it, were it of the fibre that its modulus suggests.

        strain = T / EA        of an elastic line; a dashpot's share counts as the fibre bears it too

    tension          T    largest in the run                     [N]
    axial_stiffness  EA   of its section                         [N]
    limit                 strain at which that fibre breaks      [-]
    """
    strain = tension / axial_stiffness
    if strain > limit:
        yield Caution(
            about,
            f"the largest tension of {what}, {tension:.3g} N, is {100 * strain:.3g} % of EA = {axial_stiffness:.4g} N; "
            f"{fibre} breaks at {100 * limit:.3g} %, but nothing breaks in this model",
        )


def fibre_of(youngs_modulus: float) -> Fibre:
    """The fibre that a modulus [Pa] suggests."""
    return next(fibre for fibre in FIBRES if youngs_modulus >= fibre.modulus)


def low(altitude: float) -> Iterator[str]:
    """What to say of an altitude [m] at which air would end the orbit."""
    if altitude < LOWEST_ORBIT:
        yield (
            f"{1e-3 * altitude:.6g} km is below {1e-3 * LOWEST_ORBIT:g} km, where the air ends an orbit within a "
            "revolution; no drag is computed"
        )


def heavily_damped(name: str, ratio: float | None, speed: str) -> Iterator[Caution]:
    """A damping ratio at which the peak is the dashpot's and not the spring's."""
    if ratio is not None and ratio > HEAVY_DAMPING and math.isfinite(ratio):
        yield Caution(
            name,
            f"{ratio:g} is above {HEAVY_DAMPING:g}: the largest tension of a snap is then the dashpot's jump as it "
            f"begins, 2 zeta v sqrt(k m) with v the speed of {speed}, not the spring's",
        )
