"""The grid of substeps: what stiffness and damping allow, and when the net is looked at."""

from __future__ import annotations

import math
from typing import Any

from fmu_src.interface import fault
from fmu_src.net_capture import formulas
from orbital.kernel import kernel
from orbital.vectors import dot

MEASURE_INTERVAL = 0.01
"""Seconds between two looks at mouth and capture: a whole number of substeps fits."""
LONGEST_SLEEP = 2000
"""Substeps for which a row of nodes may be left alone."""
WAY_SHARE = 0.1
"""Of the target's least dimension, by which a node may move relative to its surface in a substep."""
SMALLEST_SUBSTEP = 1e-9
"""Seconds: below, no run would end."""

STEP_TOO_SMALL = fault(
    "step_too_small",
    "net.youngs_modulus",
    "the net is too stiff for its mass: the substep [s] it needs is below a nanosecond",
)


def make_choose_substep(composition: Any) -> Any:
    """Kernel `choose_substep(p) -> fault` of the model with the composition's net and closing.

    Checked  tests/net_capture/test_step.py, tests/net_capture/test_formulas.py
    """
    has_closing = "closing" in composition.terms
    thread, needs, rates = composition.net.thread, composition.needs, composition.graph.rates
    everywhere = composition.everywhere
    has_rig, longest, accurate = rates is not None, needs.longest_step, needs.accurate_step
    substep_limits = formulas.make_substep_limits(needs.longest_step, needs.accurate_step)
    step_too_small = composition.code(STEP_TOO_SMALL.name)

    @kernel
    def choose_substep(p):
        """The stability bound, and a substep that divides the grid.

        Checked  tests/net_capture/test_step.py
        """
        stiffness, damping, node = thread(p)
        cord = 0.0
        dashpot = 0.0
        rings = 0
        apart = 0
        if has_closing:
            rings = p.closing_rings
            apart = p.closing_reels_at
            p.cord_mass = formulas.cord_mass(p.bullets_mass, 0.75 * node, rings, apart)
            cord = formulas.cord_stiffness(p.closing_axial_stiffness, p.closing_lock_length)
            dashpot = formulas.cord_damping(p.closing_damping_ratio, cord, p.cord_mass)
        pressing, resisting = everywhere(p)
        bound, step = substep_limits(
            stiffness, damping, node, cord, dashpot, p.bullets_mass, rings, pressing, apart, resisting
        )
        if has_rig:
            stiff, damped = rates(p, stiffness, damping, node)
            if stiff > 0.0:
                bound = min(bound, longest(stiff + pressing, damped + resisting))
                step = min(step, accurate(stiff + pressing, damped + resisting))
        if p.solver_step_ratio > 0.0:
            step = p.solver_step_ratio * bound
        p.solver_stability_bound = bound
        if not step > SMALLEST_SUBSTEP:
            p.fault_value = step
            return step_too_small
        p.measure_every = math.ceil(MEASURE_INTERVAL / step - 1e-9)
        p.solver_substep = MEASURE_INTERVAL / p.measure_every
        return 0

    return choose_substep


def make_limit_way(composition: Any) -> Any:
    """Kernel `limit_way(p)` of the model with the composition's bullets.

    Checked  tests/net_capture/test_following.py
    """
    has_ejection = composition.ejection is not None
    fastest = composition.ejection.fastest if has_ejection else None
    swings = composition.target is not None and composition.target.hinge is not None
    reach = composition.target.hinge.reach if swings else None

    @kernel
    def limit_way(p):
        """Shorten the substep [s] where bullets would move further in it than WAY_SHARE of the target's least
        dimension, relative to its surface.

            h (v + |v_c| + |w| R) <= 0.1 d

        v, v_c   of the bullets from the muzzle, of the muzzle                   [m/s]
        w, R     rate of the target, radius of its envelope                      [rad/s], [m]
        d        least thickness: of a part, or of the box that holds it         [m]

        A node that passes an edge at a distance below half its way is taken for one that meets it: so far the target is
        too large.

        Checked  tests/net_capture/test_following.py
        """
        speed = fastest(p) if has_ejection else p.bullets_speed
        speed += math.sqrt(dot(p.chaser_start_velocity, p.chaser_start_velocity))
        speed += math.sqrt(dot(p.target_start_rate, p.target_start_rate)) * p.envelope_radius
        if swings:
            speed += abs(p.hinge_start_rate) * reach(p)
        way = WAY_SHARE * p.target_thickness
        if speed * p.solver_substep > way:
            p.measure_every = math.ceil(MEASURE_INTERVAL * speed / way - 1e-9)
            p.solver_substep = MEASURE_INTERVAL / p.measure_every

    return limit_way
