"""The grid of the scheme: the substep that stiffness and damping allow, and when the net is looked at."""

import math

from fmu_src.net_capture import formulas, interface
from orbital.kernel import kernel

MEASURE_INTERVAL = 0.01
"""Seconds between two looks at mouth and capture: a whole number of substeps fits."""
SMALLEST_SUBSTEP = 1e-9
"""Seconds: below, no run would end."""


def make_choose_substep(terms):
    """Kernel `choose_substep(p) -> fault` of the model built with these terms.

    Checked  tests/net_capture/test_step.py, tests/net_capture/test_formulas.py
    """
    has_closing = "closing" in terms

    @kernel
    def choose_substep(p):
        """Rest length, stiffness and damping of a segment, the stability bound, and a substep that divides the grid."""
        total = formulas.square_net_length(p.net_side, p.net_mesh)
        area = formulas.thread_area(p.net_mass, p.net_density, total)
        knot = 2.0 * p.net_mass * p.net_mesh / total
        stiffness = formulas.axial_stiffness(p.net_youngs_modulus, area, p.net_mesh)
        damping = formulas.thread_dashpot(p.net_damping_ratio, stiffness, knot)
        p.thread_length = p.net_mesh / p.net_segments
        p.thread_stiffness = stiffness * p.net_segments
        p.thread_damping = damping * p.net_segments
        cord = 0.0
        dashpot = 0.0
        rings = 0
        node = knot / p.net_segments
        if has_closing:
            rings = p.closing_rings
            p.cord_mass = formulas.cord_mass(p.bullets_mass, 0.75 * node, rings)
            cord = formulas.cord_stiffness(p.closing_axial_stiffness, p.closing_lock_length)
            dashpot = formulas.cord_damping(p.closing_damping_ratio, cord, p.cord_mass)
        bound, step = formulas.substep_limits(
            p.thread_stiffness, p.thread_damping, node, cord, dashpot, p.bullets_mass, rings
        )
        if p.solver_step_ratio > 0.0:
            step = p.solver_step_ratio * bound
        p.solver_stability_bound = bound
        if not step > SMALLEST_SUBSTEP:
            p.fault_value = step
            return interface.STEP_TOO_SMALL
        p.measure_every = math.ceil(MEASURE_INTERVAL / step - 1e-9)
        p.solver_substep = MEASURE_INTERVAL / p.measure_every
        return 0

    return choose_substep
