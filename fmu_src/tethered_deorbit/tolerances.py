"""How far a step may go: its error in tolerances, and the reach of a scheme over a taut line's vibration."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from fmu_src.tethered_deorbit.bodies import Bodies
from fmu_src.tethered_deorbit.bodies.bounds import WELL_DAMPED
from fmu_src.tethered_deorbit.level import Held
from orbital.kernel import kernel
from orbital.vectors import Array, dot, norm

ROUNDING = 4.0 * 2.220446049250313e-16
"""Share of what is bounded below which no tolerance goes."""
SETTLED_SHARE = 0.01
"""Square of the share of their errors with which attitudes count in a settled step: no vibration is shaken by them."""


def make_squared_error(bodies: Bodies, held: Held) -> Callable[..., Any]:
    """Size of an error of the state in units of the tolerances."""
    sways = held.sways

    @kernel
    def squared_error(record: Any, state: Array, error: Array) -> float:
        """Square of the error's size [-].

            sum of (e_R/tol_o)^2, (e_V/(tol_o n))^2, (e_rho/tol_s)^2, (e_rho'/(tol_s n))^2,
            once a line that sways has settled, over a step h, (e_rho'/(tol_s max(p, 1/h)))^2 in place of the latter,
            and while taut, unless it is held, of the parts along the line, (e.u/tol_t)^2, (e'.u/(tol_t omega))^2,
            that of what the bodies count of e_rho' across it by their pace p, (e'_x/(tol_s p))^2,
            and what the bodies add for their attitudes

        Each tolerance is at least a few units in the last place of what it bounds.

        state, error     of `layout`

        Valid    n the pace of the environment, on an orbit its mean motion, omega the taut line's frequency
        Source   ours
        Checked  tests/tethered_deorbit/test_integrator.py
        """
        r = record[0]
        n = r.state_pace
        orbit = r.solver_tolerance_orbit + ROUNDING * norm(state[0:3])
        orbit_rate = r.solver_tolerance_orbit * n + ROUNDING * norm(state[3:6])
        length = norm(state[6:9])
        apart = r.solver_tolerance_separation + ROUNDING * length
        apart_rate = r.solver_tolerance_separation * n + ROUNDING * norm(state[9:12])
        square = dot(error[0:3], error[0:3]) / (orbit * orbit)
        square += dot(error[3:6], error[3:6]) / (orbit_rate * orbit_rate)
        square += dot(error[6:9], error[6:9]) / (apart * apart)
        if r.state_taut and length > 0.0 and not held.settled(record):
            taut = r.state_taut_tolerance + ROUNDING * length
            taut_rate = taut * r.state_frequency
            along, along_rate = dot(error[6:9], state[6:9]) / length, dot(error[9:12], state[6:9]) / length
            square += along * along / (taut * taut) + along_rate * along_rate / (taut_rate * taut_rate)
            across = bodies.square_across(record, state, error, along_rate)
            apart_rate = r.solver_tolerance_separation * bodies.pace(record, state) + ROUNDING * norm(state[9:12])
            square += max(0.0, across) / (apart_rate * apart_rate)
        else:
            if r.state_taut:
                pace = bodies.pace(record, state)
                if sways:
                    pace = max(pace, 1.0 / r.state_step)
                apart_rate = r.solver_tolerance_separation * pace + ROUNDING * norm(state[9:12])
            square += dot(error[9:12], error[9:12]) / (apart_rate * apart_rate)
        of_attitudes = bodies.squared_error(record, state, error)
        return float(square + (SETTLED_SHARE * of_attitudes if held.settled(record) else of_attitudes))

    return squared_error


def make_longest_taut_step(reach: Callable[..., Any], further: float) -> Callable[..., Any]:
    """The kernel that says how long a step of a taut line may be, of a scheme with this `AdaptiveScheme.reach`, and of
    bodies with this `Bodies.further`."""

    @kernel
    def longest_taut_step(record: Any, mass: float) -> float:
        """Longest step [s] of a taut line: as far as the scheme reaches over its vibration.

            h omega <= f reach(zeta),   zeta = c / (2 m omega),   omega = omega_most sqrt(m_least/m)

        f grows from 1 to `further` as zeta does to `WELL_DAMPED`.

        Where no damping lets the scheme reach farther, what is lost is not drowned by it: there omega is omega_most.

        mass          m      that the line has to move where it is   [kg]

        Valid    omega the frequency of the fastest motion, that of the dashpot when it is faster than the spring
        Source   `AdaptiveScheme.reach`, which for a scheme that damps what is stiff has no end
        Checked  tests/tethered_deorbit/test_turning.py
        """
        r = record[0]
        frequency = r.state_frequency * math.sqrt(r.state_effective_mass / mass)
        damping = abs(r.state_damping) / (2.0 * mass * frequency)
        allowed: float = reach(damping)
        if not allowed > reach(0.0):
            return float(allowed / r.state_frequency)
        return float(allowed / frequency * (1.0 + (further - 1.0) * min(1.0, damping / WELL_DAMPED)))

    return longest_taut_step
