"""A rope of a section and material of its own: what a piece of it is, and how a strip of pieces is written down."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from fmu_src.extremes import Extreme, times
from fmu_src.implied import formula
from fmu_src.interface import Variable
from fmu_src.net_capture.planes import (
    DAMPING,
    FIRST,
    LANES,
    LENGTH,
    STIFFNESS,
    STRIP_NUMBERS,
    STRIP_WORDS,
    THREAD_MASS,
    A,
    B,
)
from fmu_src.rows import at_least_zero, positive
from orbital.kernel import kernel


def rows(prefix: str, what: str, diameter: float) -> tuple[Variable, ...]:
    """Parameters of a rope: section and material."""
    return (
        positive(f"{prefix}.diameter", "m", f"of the {what}, solid and round", diameter, display_unit="mm"),
        positive(f"{prefix}.youngs_modulus", "Pa", f"of the {what}", 70e9, display_unit="GPa"),
        positive(f"{prefix}.density", "kg/m3", f"of the {what}", 1440.0),
        at_least_zero(f"{prefix}.damping_ratio", "1", f"xi in d = 2 xi sqrt(k m) of a piece of the {what}", 0.106),
    )


@kernel
def piece(diameter, modulus, density, ratio, length):
    """Stiffness [N/m], dashpot [N s/m] and mass [kg] of a piece of rope.

        k = E A / l,   m = rho A l,   d = 2 xi sqrt(k 2 m)

    diameter, modulus, density, ratio    of the rope         [m], [Pa], [kg/m3], [1]
    length    l                          of the piece        [m]

    Checked  tests/net_capture/test_rigging.py
    """
    area = 0.25 * math.pi * diameter * diameter
    stiffness = modulus * area / length
    mass = density * area * length
    return stiffness, 2.0 * ratio * math.sqrt(stiffness * 2.0 * mass), mass


def piece_of(values: Mapping[str, float], prefix: str, length: float) -> tuple[float, float, float]:
    """The same of a rope of a scene, by FMI name."""
    diameter, modulus = values[f"{prefix}.diameter"], values[f"{prefix}.youngs_modulus"]
    density, ratio = values[f"{prefix}.density"], values[f"{prefix}.damping_ratio"]
    found: tuple[float, float, float] = formula(piece)(diameter, modulus, density, ratio, length)
    return found


def extremes(prefix: str, what: str) -> tuple[Extreme, ...]:
    """The ends of a rope's range: stiff, soft, damped."""
    name = f"{prefix}.youngs_modulus"
    stiff = (
        Extreme(
            f"{what} {factor:g} times as stiff",
            "beside a net that stays as it is: the substep follows the stiffest node",
            "energy_gained",
            {name: times(name, factor)},
            duration=duration,
            chief=factor == 1e2,
        )
        for factor, duration in ((1e-3, 0.0), (1e2, 0.0), (1e4, 4.0))
    )
    damped = (
        Extreme(
            f"{what}, damping ratio {ratio:g}",
            "dashpots from none to ten times critical",
            "energy_lost" if ratio else "energy_gained",
            {f"{prefix}.damping_ratio": ratio},
        )
        for ratio in (0.0, 10.0)
    )
    return (*stiff, *damped)


def make_add_rope(memory: Any) -> Any:
    """Kernel that writes a strip of such pieces."""
    strips, properties = memory.strips, memory.properties

    @kernel
    def add_rope(p, work, strip, thread, a, b, lanes, length, stiffness, dashpot, mass):
        """Write down a strip of equal pieces, whose first has that number of all threads.

        a, b                         nodes of lane 0
        lanes                        those that are pieces, a bit each
        length                       unloaded                                    [m]
        stiffness, dashpot, mass     of a piece                                  [N/m], [N s/m], [kg]

        Checked  tests/net_capture/test_rigging.py
        """
        words = STRIP_WORDS * strip
        strips(p, work)[words + A] = a
        strips(p, work)[words + B] = b
        strips(p, work)[words + LANES] = lanes
        strips(p, work)[words + FIRST] = thread
        numbers = STRIP_NUMBERS * strip
        properties(p, work)[numbers + LENGTH] = length
        properties(p, work)[numbers + STIFFNESS] = stiffness
        properties(p, work)[numbers + DAMPING] = dashpot
        properties(p, work)[numbers + THREAD_MASS] = mass

    return add_rope
