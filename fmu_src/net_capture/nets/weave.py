"""What every net has alike: the rows of its thread, and what a strip of it weighs and how it pulls."""

from __future__ import annotations

from typing import Any

from fmu_src.interface import fault
from fmu_src.net_capture import formulas
from fmu_src.net_capture.planes import (
    DAMPING,
    FIRST,
    LANES,
    LENGTH,
    LONGEST_ROW,
    STIFFNESS,
    STRIP_NUMBERS,
    STRIP_WORDS,
    THREAD_MASS,
    A,
    B,
)
from fmu_src.rows import at_least_zero, parameter, positive
from orbital.kernel import kernel

TOO_FINE = fault("too_fine", "net.segments", "the net has too many meshes times segments per side")

THREAD = (
    positive("net.mesh", "m", "knot spacing: a design choice; the net keeps its mass", 1.0),
    parameter("net.segments", "1", "pieces each thread is cut into: a numerical choice", 1, 1, 64, kind="Integer"),
    positive("net.mass", "kg", "mass of all threads", 0.33),
    positive("net.youngs_modulus", "Pa", "of the thread", 70e9, display_unit="GPa"),
    positive("net.density", "kg/m3", "of the thread", 1440.0),
    at_least_zero("net.damping_ratio", "1", "xi in d = 2 xi sqrt(k m) of a thread and an inner node", 0.106),
)
"""Rows that every net has."""


@kernel
def add_strip(p, table, numbers, strip, thread, a, b, lanes, unloaded, area, write):
    """Write down a strip of equal threads, cut into `net_segments` pieces of which it holds one each.

    strip, thread    its number, and that of its first thread
    a, b             nodes of its lane 0
    lanes            those that are threads, a bit each
    unloaded         length of a whole thread                [m]
    area             of a thread's section                   [m2]
    write            False: it is only counted

    Checked  tests/net_capture/test_nets.py
    """
    if write:
        pieces = p.net_segments
        table[STRIP_WORDS * strip + A] = a
        table[STRIP_WORDS * strip + B] = b
        table[STRIP_WORDS * strip + LANES] = lanes
        table[STRIP_WORDS * strip + FIRST] = thread
        numbers[STRIP_NUMBERS * strip + LENGTH] = unloaded / pieces
        stiffness = formulas.axial_stiffness(p.net_youngs_modulus, area, unloaded)
        mass = p.net_density * area * unloaded
        dashpot = formulas.thread_dashpot(p.net_damping_ratio, stiffness, 2.0 * mass)
        numbers[STRIP_NUMBERS * strip + STIFFNESS] = stiffness * pieces
        numbers[STRIP_NUMBERS * strip + DAMPING] = dashpot * pieces
        numbers[STRIP_NUMBERS * strip + THREAD_MASS] = mass / pieces


@kernel
def first_lanes(count):
    """So many lanes from the first on, a bit each.

    Checked  tests/net_capture/test_nets.py
    """
    return -1 if count == LONGEST_ROW else (1 << count) - 1


@kernel
def even_gap(p, n):
    """From a knot of the rim to the next [m], where all are as far apart.

    Checked  tests/net_capture/test_rigging.py
    """
    return p.rim_mesh


def make_thread(total: Any, shortest: Any) -> Any:
    """Kernel `thread(p)` of a net, see `Net`: of all its thread [m], and of the shortest as `Checks` means it [m]."""

    @kernel
    def thread(p):
        """Stiffness [N/m] and dashpot [N s/m] of a piece of thread, mass of a node between two of them [kg].

        Checked  tests/net_capture/test_nets.py
        """
        length = shortest(p)
        area = formulas.thread_area(p.net_mass, p.net_density, total(p))
        mass = 2.0 * p.net_density * area * length
        stiffness = formulas.axial_stiffness(p.net_youngs_modulus, area, length)
        dashpot = formulas.thread_dashpot(p.net_damping_ratio, stiffness, mass)
        return stiffness * p.net_segments, dashpot * p.net_segments, mass / p.net_segments

    return thread
