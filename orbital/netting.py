"""What a rectangular net of square meshes weighs, and the mesh that a mass allows.

Plain Python: the net's model hands `grid_length` to the compiler, the sizing uses all of it as it is.
"""

from __future__ import annotations

import math


def grid_length(along: float, across: float, mesh: float) -> float:
    """Length of all threads of a rectangular net of square meshes [m].

        a (b/l + 1) + b (a/l + 1)

    along, across a, b   sides of the flat net                   [m]
    mesh          l      knot spacing                            [m]

    Valid    a mesh that divides both sides; between such, a smooth curve through them
    Source   rows and columns of threads, counted
    Checked  tests/net_capture/test_formulas.py, tests/orbital/test_netting.py; 1200 m for 24 m x 24 m at 1 m
    """
    return along * (across / mesh + 1.0) + across * (along / mesh + 1.0)


def thread_line_mass(density: float, diameter: float) -> float:
    """Mass of a metre of solid round thread [kg/m].

        m' = rho pi d^2/4

    density       rho    of the thread                           [kg/m3]
    diameter      d      of its section                          [m]

    Valid    a solid section; a braid is lighter by its packing
    Source   geometry
    Checked  tests/orbital/test_netting.py; 1.131 g/m for 1 mm of aramid
    """
    return density * math.pi * diameter**2 / 4.0


def net_mass(along: float, across: float, mesh: float, density: float, diameter: float, margin: float = 0.0) -> float:
    """Mass of a net without knots and edge rope [kg].

        m = (1 + g) rho pi d^2/4 [a (b/l + 1) + b (a/l + 1)]

    along, across a, b   sides of the flat net                   [m]
    mesh          l      knot spacing                            [m]
    density       rho    of the thread                           [kg/m3]
    diameter      d      of its section                          [m]
    margin        g      share that is added                     [1]

    Valid    as `grid_length`
    Source   D-CoNe paper, section 4 and Fig. 9, whose curves it is
    Checked  tests/orbital/test_netting.py; 5.94 kg for 36 m x 36 m at 0.5 m of 1 mm aramid
    """
    return (1.0 + margin) * thread_line_mass(density, diameter) * grid_length(along, across, mesh)


def mesh_of_mass(
    along: float, across: float, mass: float, density: float, diameter: float, margin: float = 0.0
) -> float:
    """Mesh that a mass allows [m], the inverse of `net_mass`.

        l = 2 a b / (m / ((1 + g) m') - a - b)

    along, across a, b   sides of the flat net                   [m]
    mass          m      of the net, with its margin             [kg]
    density       rho    of the thread                           [kg/m3]
    diameter      d      of its section                          [m]
    margin        g      share of the mass that is margin        [1]

    Valid    a mass above that of two threads along each side; ValueError otherwise: the mesh would be no net
    Source   `net_mass`, solved for the mesh
    Checked  tests/orbital/test_netting.py; 0.535 m for 36 m x 36 m of 6.67 kg at 20 %, 0.445 m without
    """
    left = mass / ((1.0 + margin) * thread_line_mass(density, diameter)) - along - across
    if not left > 0.0:
        raise ValueError(f"{mass:g} kg is less than the edge of a net of {along:g} m x {across:g} m weighs")
    return 2.0 * along * across / left
