"""A hinged appendage that the removal holds fast: what the hand-off has to book of the motion that stops there.

Where the capture's target is one rigid body, the appendage in it, what it does besides, relative to the rest, the scene
says of the removal. Where it swings in the capture, that is what the capture comes to: the target's spin has it in it.
It is held fast as the tow begins, and its momentum becomes spin of the whole.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Vector = npt.NDArray[np.float64]
EACH = (1, 2, 3)
PLACES = tuple(f"appendage.{what}[{i}]" for what in ("center", "hinge") for i in EACH)
"""Places on the target, from its centre of mass: the net shifts that, and with it what is set in the removal."""
APPENDAGE = (
    "appendage.mass",
    *(f"appendage.inertia[{i}]" for i in range(1, 7)),
    *PLACES,
    *(f"appendage.axis[{i}]" for i in EACH),
    "appendage.rate",
)
"""Parameters of a removal whose target has one."""
ANGLE, SPEED = "hinge.angle", "hinge.rate"
PRODUCTS = tuple(f"target.products[{i}]" for i in EACH)
SWINGS = (ANGLE, SPEED, *PRODUCTS)
"""Outputs of a capture whose target has one that swings."""


@dataclass(frozen=True)
class Hinged:
    """The appendage's motion relative to the rest of the target, in whatever axes it is given in.

    momentum     h    about the centre of mass of all                            [N m s] (3,)
    own_energy        of that motion alone, the centre of mass at rest           [J]
    """

    momentum: Vector
    own_energy: float

    def along(self, turned: Vector) -> Hinged:
        """The same along other axes, to which this matrix turns."""
        return Hinged(turned @ self.momentum, self.own_energy)

    def energy(self, spin: Vector, inertia: Vector) -> float:
        """What it adds to the kinetic energy of a target of this spin [N m s] and inertia [kg m2], before [J].

        w.h + E_own,   w = I^-1 H
        """
        return float(np.linalg.solve(inertia, spin) @ self.momentum) + self.own_energy

    def lost(self, inertia: Vector) -> float:
        """What of it is lost as it is held fast [J]: E_own - h.I^-1 h/2."""
        return self.own_energy - 0.5 * float(self.momentum @ np.linalg.solve(inertia, self.momentum))


def hinged(values: Mapping[str, float]) -> Hinged | None:
    """Of `APPENDAGE` and `target.mass`, None where there is none. In body axes, from the centre of mass of all.

    h = I_p s + m_p c x v,   2 E_own = s.I_p s + m_p (1 - m_p/m) v.v,   s the rate along the hinge, v = s x (c - p)
    """
    if not all(name in values for name in APPENDAGE):
        return None
    own, mass = values["appendage.mass"], values["target.mass"]
    i11, i22, i33, i12, i13, i23 = (values[f"appendage.inertia[{i}]"] for i in range(1, 7))
    inertia = np.array([[i11, i12, i13], [i12, i22, i23], [i13, i23, i33]])
    center, hinge, axis = (
        np.array([values[f"appendage.{what}[{i}]"] for i in EACH]) for what in ("center", "hinge", "axis")
    )
    rate = values["appendage.rate"] * axis / np.linalg.norm(axis)
    speed = np.cross(rate, center - hinge)
    energy = 0.5 * float(rate @ inertia @ rate + own * (1.0 - own / mass) * (speed @ speed))
    return Hinged(inertia @ rate + own * np.cross(center, speed), energy)


def asked(setting: Callable[[str], float | None], shift: Vector) -> dict[str, float]:
    """`APPENDAGE` as a scene says, places from a centre of mass that lies elsewhere by -shift; empty if there is none.

    setting      value of a parameter by its name, SI, None where the removal has none of that name
    shift        body axes [m] (3,)
    """
    given = {name: value for name in APPENDAGE if (value := setting(name)) is not None}
    if len(given) < len(APPENDAGE):
        return {}
    return given | {name: given[name] + float(shift[k % 3]) for k, name in enumerate(PLACES)}
