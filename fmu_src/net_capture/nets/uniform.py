"""What nets of one thread say of it: all are of one section, which the net's mass gives, and one material."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from fmu_src.implied import formula
from fmu_src.net_capture import formulas
from fmu_src.net_capture.nets import Checks, Hanging, Thread, Values

Lengths = tuple[float, float, float]


def uniform(
    *,
    total: Callable[[Values], float],
    shortest: Callable[[Values], float],
    lengths: Callable[[Values], Lengths],
    least: Callable[[Values], float] | None = None,
    even: bool = False,
    **others: Any,
) -> Checks:
    """What such a net says.

    total      length of all threads                                                                         [m]
    shortest   length of a thread of which a net of square meshes is as stiff for its mass as this one where it is
               stiffest: the square root of the least sum of l over sum of 1/l at a knot                     [m]
    lengths    of thread that hangs on a knot inside, on the edge, and where a bullet is made fast, the most of each:
               half of every thread that ends there                                                          [m]
    least      length of the shortest thread, where that is not `shortest`                                   [m]
    even       whether all threads are as long, and all knots inside hold as much
    others     of `Checks`
    """

    def section(values: Values) -> float:
        """Area of a thread's section [m2]."""
        return formula(formulas.thread_area)(values["net.mass"], values["net.density"], total(values))

    def of_length(values: Values, length: float) -> tuple[float, float, float]:
        """Stiffness [N/m], dashpot [N s/m] and mass [kg] of a thread of that length."""
        stiffness = formula(formulas.axial_stiffness)(values["net.youngs_modulus"], section(values), length)
        mass = values["net.density"] * section(values) * length
        dashpot = formula(formulas.thread_dashpot)(values["net.damping_ratio"], stiffness, 2.0 * mass)
        return stiffness, dashpot, mass

    def thread(values: Values) -> Thread:
        """Of one as long as a mesh is wide."""
        strength = values["net.youngs_modulus"] * section(values)
        stiffness, dashpot, mass = of_length(values, values["net.mesh"])
        called = "a thread" if even else "a thread as long as net.mesh"
        return Thread(section(values), strength, stiffness, dashpot, mass, strength, stiffness, called)

    def piece(values: Values) -> tuple[float, float, float]:
        """See `make_thread`."""
        pieces = values["net.segments"]
        stiffness, dashpot, mass = of_length(values, shortest(values))
        return pieces * stiffness, pieces * dashpot, 2.0 * mass / pieces

    def hanging(values: Values) -> Hanging:
        line = values["net.density"] * section(values)
        inside, edge, corner = (line * length for length in lengths(values))
        return Hanging(inside, edge, corner, even)

    def finest(values: Values) -> tuple[float, float]:
        length = (least or shortest)(values)
        return length, values["net.density"] * section(values) * length

    return Checks(
        total=total,
        mass=lambda values: values["net.mass"],
        thread=thread,
        piece=piece,
        hanging=hanging,
        finest=finest,
        **others,
    )
