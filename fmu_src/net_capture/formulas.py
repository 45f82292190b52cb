"""What follows from the net's and the cord's parameters, in closed form: sections, stiffness, dashpots, the step.

Written once: the model's kernels use them, and so does whoever wants to know what a scene implies.
"""

import math
from collections.abc import Callable

from orbital import netting
from orbital.kernel import kernel
from orbital.oscillators import explicit_step_limit

Limit = Callable[[float, float], float]

BREAKING_STRAIN = 0.2
"""Of nylon 66, the cord's default: beyond, no cord is."""
RINGS_SHARE = 0.2
"""Share of a locked cord that lies in its rings."""


grid_length = kernel(netting.grid_length)


@kernel
def thread_area(mass: float, density: float, length: float) -> float:
    """Cross-section of the thread [m2]: A = m / (rho L).

    mass          m      of all threads                          [kg]
    density       rho    of the thread                           [kg/m3]
    length        L      of all threads                          [m]

    Checked  tests/net_capture/test_formulas.py; 0.191 mm2 for Table 1's net at 1 m
    """
    return mass / (density * length)


@kernel
def round_diameter(area: float) -> float:
    """Diameter [m] of a solid round section: d = sqrt(4 A / pi).

    Checked  tests/net_capture/test_formulas.py
    """
    return math.sqrt(4.0 * area / math.pi)


@kernel
def axial_stiffness(youngs_modulus: float, area: float, length: float) -> float:
    """Stiffness of a thread [N/m]: k = E A / l.

    youngs_modulus E                                             [Pa]
    area          A      cross-section                           [m2]
    length        l      unloaded                                [m]

    Source   Benvenuto and Lavagna (D-CoNe), eq. 1
    Checked  tests/net_capture/test_formulas.py; 13,368 N/m for Table 1's net at 1 m
    """
    return youngs_modulus * area / length


@kernel
def thread_dashpot(ratio: float, stiffness: float, knot_mass: float) -> float:
    """Axial dashpot of a thread [N s/m]: d = 2 xi sqrt(k m).

    ratio         xi     damping ratio                           [1]
    stiffness     k      of the whole thread                     [N/m]
    knot_mass     m      of an inner knot, two threads' worth    [kg]

    Checked  tests/net_capture/test_formulas.py
    """
    return 2.0 * ratio * math.sqrt(stiffness * knot_mass)


@kernel
def cord_stiffness(axial_stiffness: float, length: float) -> float:
    """Stiffness of the closing cord between two bullets [N/m]: k = EA / L.

    Checked  tests/net_capture/test_formulas.py
    """
    return axial_stiffness / length


@kernel
def cord_mass(bullet_mass: float, edge_mass: float, rings: int, apart: int = 0) -> float:
    """Mass that a cord between two reels moves as it lengthens [kg]: 1 / (2/m + 4 n/q), at the sharpest bends; with its
    reels on such knots too, and a ring at the bullet between them, 1 / (4/m + (4 n - 2)/q).

    bullet_mass   m      of each                                 [kg]
    edge_mass     q      of a knot on the net's edge             [kg]
    rings         n      on such knots, which it runs through    [1]
    apart                stretches from a bullet to its reel     [1]

    Checked  tests/net_capture/test_formulas.py
    """
    if apart > 0:
        return 1.0 / (4.0 / bullet_mass + (4.0 * rings - 2.0) / edge_mass)
    return 1.0 / (2.0 / bullet_mass + 4.0 * rings / edge_mass)


@kernel
def cord_damping(ratio: float, stiffness: float, mass: float) -> float:
    """Dashpot of the closing cord between two bullets [N s/m]: d = 2 xi sqrt(k m).

    ratio         xi     damping ratio                           [1]
    stiffness     k      of the cord between them                [N/m]
    mass          m      that it moves, see `cord_mass`          [kg]

    Checked  tests/net_capture/test_formulas.py
    """
    return 2.0 * ratio * math.sqrt(stiffness * mass)


@kernel
def ring_radius(lock_length: float, rings: int) -> float:
    """How near to the middle of a ring the closing cord passes [m]: a fifth of its length when locked, shared among its
    stretches, so that it always has the length to go through them all.

    Checked  tests/net_capture/test_formulas.py
    """
    return RINGS_SHARE * lock_length / (rings + 1) if rings > 0 else 0.0


@kernel
def longest_step(stiffness_rate: float, damping_rate: float) -> float:
    """Longest step [s] at which the leapfrog is stable at a node.

    stiffness_rate       sum of the stiffnesses that meet at it, over its mass   [1/s2]
    damping_rate         sum of the dashpots that meet at it, over its mass      [1/s]

    Twice these sums bound the eigenvalues (Gershgorin: the blocks beside the diagonal are no larger, taken together,
    than the one on it), so the least over all nodes is the bound of the net.

    Checked  tests/net_capture/test_formulas.py
    """
    return explicit_step_limit(2.0 * stiffness_rate, 2.0 * damping_rate)


@kernel
def onset_step(stiffness_rate: float, damping_rate: float) -> float:
    """Step [s] that keeps the mouth area within 0.3 % and the energy within 1 % at any damping at which it is stable.

        h = (0.3 + 1.77 zeta) / omega

    stiffness_rate       as for `longest_step`, omega^2 / 2                      [1/s2]
    damping_rate         as for `longest_step`, zeta omega                       [1/s]

    What spoils a large step is the onset of each pull, which falls somewhere within a substep; damping forgets it.

    Valid    measured with Table 1's net over 15 s, damping ratios from 0 to 1
    Source   ours, fitted to ensembles: tests/net_capture/test_step.py, marker evidence
    Checked  tests/net_capture/test_step.py
    """
    omega = math.sqrt(2.0 * stiffness_rate)
    zeta = damping_rate / omega
    return (0.3 + 1.77 * zeta) / omega


@kernel
def accurate_step(stiffness_rate: float, damping_rate: float) -> float:
    """Default step [s] of the leapfrog: that of `onset_step`, at most nine tenths of the longest.

    Checked  tests/net_capture/test_formulas.py
    """
    return min(onset_step(stiffness_rate, damping_rate), 0.9 * longest_step(stiffness_rate, damping_rate))


def make_substep_limits(longest: Limit, accurate: Limit) -> Callable[..., tuple[float, float]]:
    """Kernel `substep_limits` of a scheme, by its limits at a node; see `longest_step` and `accurate_step`."""

    @kernel
    def substep_limits(
        thread: float,
        dashpot: float,
        node_mass: float,
        cord: float,
        cord_dashpot: float,
        bullet_mass: float,
        rings: int,
        pressing: float,
        apart: int = 0,
        resisting: float = 0.0,
    ) -> tuple[float, float]:
        """Stability bound of a net and the step that is accurate [s], the least of an inner node's, a bullet's and a
        ring's.

        thread, dashpot      of one piece of thread                                  [N/m], [N s/m]
        node_mass            of an inner node, two pieces' worth                     [kg]
        cord, cord_dashpot   of a closing cord at its lock length; 0 without one     [N/m], [N s/m]
        bullet_mass          of each, without the thread that hangs on it            [kg]
        rings                that each pair's cord runs through                      [1]
        pressing             what a surface and bending add at every node, see `longest_step`; 0 without   [1/s2]
        apart                stretches of the cord from a bullet to its reel; 0: reels at the bullets   [1]
        resisting            dashpots that bending adds at every node, over its mass; 0 without it   [1/s]

        A cord of way s pulls its knots along ds/dx, of length 1 at a bullet and up to 2 at a ring, so through n rings a
        row of its matrix sums to 2 (n + 1) k at a bullet and twice that at a ring; half of it counts here. A stretch
        that is no longer than a ring's radius b turns, which adds T/b = k L/b times the strain, and BREAKING_STRAIN
        bounds that; of a single ring's two stretches only one can be so short, but both of those that end at a reel on
        the rim.

        Checked  tests/net_capture/test_formulas.py
        """
        stiffness_rate, damping_rate = 4.0 * thread / node_mass + pressing, 4.0 * dashpot / node_mass + resisting
        bound, enough = longest(stiffness_rate, damping_rate), accurate(stiffness_rate, damping_rate)
        corner = bullet_mass + 0.5 * node_mass
        held = (rings + 1) * cord
        turning = held * BREAKING_STRAIN / RINGS_SHARE if rings > 0 else 0.0
        damped = (rings + 1) * cord_dashpot
        stiffness_rate = 2.0 * (thread + held + turning) / corner + pressing
        damping_rate = 2.0 * (dashpot + damped) / corner + resisting
        bound = min(bound, longest(stiffness_rate, damping_rate))
        enough = min(enough, accurate(stiffness_rate, damping_rate))
        if rings > 0 and cord > 0.0:
            edge = 0.75 * node_mass
            stiffness_rate = (
                3.0 * thread + 2.0 * held + (2 if apart > 0 else min(rings, 2)) * turning
            ) / edge + pressing
            damping_rate = (3.0 * dashpot + 2.0 * damped) / edge + resisting
            bound = min(bound, longest(stiffness_rate, damping_rate))
            enough = min(enough, accurate(stiffness_rate, damping_rate))
        if pressing > 0.0:
            # a node that nothing else holds
            enough = min(enough, accurate(pressing, resisting))
        return bound, enough

    return substep_limits
