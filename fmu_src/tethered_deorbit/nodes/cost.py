"""What a line of nodes costs, before anything is built: by the kernels' own formulas, on the values of a scene."""

from __future__ import annotations

from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any, NamedTuple

from fmu_src.implied import formula
from fmu_src.integrators import dop853
from fmu_src.tethered_deorbit.nodes import pieces
from orbital import oscillators

HOUR = 3600.0
PER_STEP, PER_NODE = 3.5e-6, 0.5e-6
"""Processor time of a step [s], and what a node adds."""

reduced_mass = formula(oscillators.reduced_mass)
tune, fastest, reach = formula(pieces.tune), formula(pieces.fastest), formula(dop853.reach)
NAMES = (
    "chaser.mass",
    "target.mass",
    "tether.rest_length",
    "tether.diameter",
    "tether.youngs_modulus",
    "tether.damping_ratio",
    "lumped.nodes",
    "lumped.density",
    "lumped.damped_as",
)


class Cost(NamedTuple):
    """Mass of all nodes [kg], dashpot of all pieces in series [N s/m], bound of the line's fastest motion [rad/s], and
    of an hour of the line taut its steps and their processor time [s]."""

    mass: float
    dashpot: float
    fastest: float
    steps: float
    seconds: float


def cost(values: Mapping[str, float]) -> Cost:
    """Of a line with these values, every parameter and input by FMI name, SI.

    Checked  tests/tethered_deorbit/test_nodes.py: as the model has it
    """
    r: Any = SimpleNamespace(**{name.replace(".", "_"): values[name] for name in NAMES})
    r.state_effective_mass = reduced_mass(r.chaser_mass, r.target_mass)
    tune([r])
    shortest = r.state_piece_length + min(0.0, values["reel.length_offset"])
    rate, share = fastest([r], shortest) if shortest > 0.0 else (0.0, 0.0)
    steps = HOUR * rate / reach(share)
    dashpot = r.state_piece_lag * r.state_piece_stiffness / (r.lumped_nodes + 1.0)
    return Cost(
        r.lumped_nodes * r.state_node_mass, dashpot, rate, steps, steps * (PER_STEP + PER_NODE * r.lumped_nodes)
    )
