"""A line that drags too hard for its substep: what has stopped the vertex holds on to its end, and throws it back."""

from __future__ import annotations

from collections.abc import Iterator

from fmu_src.net_capture.refusal import Refusal, Scene
from fmu_src.net_capture.substeps import substeps

THROWN = 0.03
"""Share of the bullets' speed by which friction and brake may change that of the vertex in a substep."""


def refuses(scene: Scene) -> Iterator[Refusal]:
    """A tension that would give energy.

        (F + B) h <= THROWN m v

    h    substep                                           [s]
    m    of the vertex with its knot                       [kg]
    v    of the bullets                                    [m/s]

    Valid    within that the energy book of a shot stays within 1 %; at 15 % it was open by 32 %, at 100 % by 8 times
    Checked  tests/net_capture/test_pay_out.py
    """
    values = scene.values
    bound, usual = substeps(values, scene.parts)
    step = values["solver.step_ratio"] * bound if values["solver.step_ratio"] > 0.0 else usual
    mass = values["vertex.mass"] + scene.parts["net"].checks.piece(values)[-1]
    most = THROWN * mass * values["bullets.speed"] / step
    tension = values["tether.friction"] + values["tether.brake_force"]
    if tension > most:
        name = "tether.brake_force" if values["tether.brake_force"] > values["tether.friction"] else "tether.friction"
        expected = (
            f"friction and brake together must be at most {most:.3g} N: more would throw a vertex of {mass:.2g} kg "
            f"back within a substep of {step:.2g} s, and give energy; take shorter ones with solver.step_ratio"
        )
        yield Refusal(name, f"{values[name]:g} N", expected)
