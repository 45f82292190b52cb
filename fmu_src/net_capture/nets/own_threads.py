"""How a thread of a net of one's own pulls and what it weighs, and what its nodes ask of the substep."""

from __future__ import annotations

import math
from typing import Any

from fmu_src.implied import formula
from fmu_src.net_capture import formulas
from fmu_src.net_capture.nets.own_tables import (
    BY_AREA,
    CORNER,
    EDGE,
    KIND,
    MASS_BY_AREA,
    OWN_DASHPOT,
    OWN_MASS,
    OWN_STIFFNESS,
    VIA_AREA,
    VIA_OWN,
    WITHIN,
)
from orbital.kernel import kernel


def make_of_thread(axial_stiffness: Any, thread_dashpot: Any) -> Any:
    """Function `of_thread` of these two of `formulas`, as kernels or as plain Python.

    Checked  tests/net_capture/test_own_net.py
    """

    def of_thread(length, diameter, stiffness, mass, dashpot, modulus, density, ratio):
        """Stiffness [N/m], dashpot [N s/m] and mass [kg] of a whole thread.

        length                                unloaded                                                [m]
        diameter, stiffness, mass, dashpot    as told; stiffness 0: by the diameter; dashpot below 0: by the ratio
        modulus, density, ratio               E, rho and xi of the scene                              [Pa], [kg/m3], [1]

        Checked  tests/net_capture/test_own_net.py
        """
        if stiffness == 0.0:
            area = 0.25 * math.pi * diameter * diameter
            stiffness = axial_stiffness(modulus, area, length)
            mass = density * area * length
        if dashpot < 0.0:
            dashpot = thread_dashpot(ratio, stiffness, 2.0 * mass)
        return stiffness, dashpot, mass

    return of_thread


of_thread = kernel(make_of_thread(formulas.axial_stiffness, formulas.thread_dashpot))
plain_thread = make_of_thread(formula(formulas.axial_stiffness), formula(formulas.thread_dashpot))


@kernel
def of_kinds(kinds, modulus, density, ratio, pieces):
    """Stiffness [N/m], dashpot [N s/m] and mass [kg] of the kernel `Net.thread`.

    kinds    of the nodes, see `own_tables`

    The most that stiffnesses and dashpots come to at a node, over its mass, is that of a node between four such pieces;
    three quarters of its mass is no more than the lightest knot of the rim has, half of it than the lightest corner.

    Checked  tests/net_capture/test_own_net.py
    """
    stiff = 0.0
    damped = 0.0
    node = math.inf
    for i in range(kinds.shape[0]):
        kind = kinds[i, KIND]
        if kind == WITHIN and pieces == 1:
            continue
        mass = kinds[i, OWN_MASS] + density * kinds[i, MASS_BY_AREA]
        stiff = max(stiff, (kinds[i, OWN_STIFFNESS] + modulus * kinds[i, BY_AREA]) / mass)
        # d = 2 xi sqrt(2 k m) of a thread, and k m = E rho A^2 of one of a diameter
        by_ratio = kinds[i, VIA_OWN] + math.sqrt(modulus * density) * kinds[i, VIA_AREA]
        damped = max(damped, (kinds[i, OWN_DASHPOT] + 2.0 * math.sqrt(2.0) * ratio * by_ratio) / mass)
        if kind == EDGE:
            node = min(node, mass / 0.75)
        if kind == CORNER:
            node = min(node, mass / 0.5)
    return 0.25 * stiff * node * pieces, 0.25 * damped * node * pieces, node / pieces
