"""A table on which both bodies, and the nodes of the line between them, slide: friction against their own motion."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

from fmu_src.interface import Interface
from fmu_src.tethered_deorbit.acting import Acting
from fmu_src.tethered_deorbit.environment.disturbing import Disturbing
from fmu_src.tethered_deorbit.law import Reel
from fmu_src.tethered_deorbit.layout import WIDTH, StateLayout
from orbital.kernel import kernel
from orbital.vectors import Array, norm


class Rubbing(NamedTuple):
    """What a table does to the motion, and at the start."""

    disturbing: Disturbing
    acting: Acting


@kernel
def rub(out: Array, velocity: Array, most: float, creep: float) -> float:
    """out = acceleration by friction [m/s2]; returns the power by mass that it takes [W/kg].

        a = -mu g v/sqrt(v^2 + c^2)

    velocity      v      on the table                            [m/s]      (3,)
    most          mu g                                           [m/s2]
    creep         c      over which friction comes to its full value [m/s]

    Valid    motion in the plane of the table. What would stick creeps: under a share f of the full friction at
             c f/sqrt(1 - f^2)
    Source   Coulomb's law, made smooth at rest
    Checked  tests/tethered_deorbit/test_friction.py: a sled that stops
    """
    square = velocity[0] * velocity[0] + velocity[1] * velocity[1] + velocity[2] * velocity[2]
    factor = most / math.sqrt(square + creep * creep)
    for i in range(3):
        out[i] = -factor * velocity[i]
    return float(factor * square)


def make_friction(interface: Interface, layout: StateLayout) -> Rubbing:
    """The kernels; the loss is the last component of the state, ValueError where there is a field or a body turns."""
    terms = interface.terms
    for group, term in (("environment", "none"), ("target", "point"), ("chaser", "point")):
        if terms[group] != term:
            raise ValueError(f"friction on a table needs {group} = {term!r}, not {terms[group]!r}")
    loss, place, noded = layout.size - 1, layout.reel, "lumped" in terms

    @kernel
    def add(record: Any, state: Array, rate: Array) -> None:
        """Friction of both bodies, and what it takes, with that of the nodes.

            R'' += (m_c a_c + m_t a_t)/M,   rho'' += a_t - a_c

        Checked  tests/tethered_deorbit/test_friction.py
        """
        r = record[0]
        most = r.friction_coefficient * r.friction_gravity
        chaser, target, velocity = r.state_rubbing[0], r.state_rubbing[1], r.state_rubbing[2]
        for i in range(3):
            velocity[i] = state[3 + i] - r.state_target_share * state[9 + i]
        taken = r.state_chaser_share * r.state_total_mass * rub(chaser, velocity, most, r.friction_creep)
        for i in range(3):
            velocity[i] = state[3 + i] + r.state_chaser_share * state[9 + i]
        taken += r.state_target_share * r.state_total_mass * rub(target, velocity, most, r.friction_creep)
        for i in range(3):
            rate[3 + i] += r.state_chaser_share * chaser[i] + r.state_target_share * target[i]
            rate[9 + i] += target[i] - chaser[i]
        if noded:
            node = r.state_rubbing[3]
            for k in range(r.lumped_nodes):
                for i in range(3):
                    velocity[i] = state[3 + i] + r.state_chaser_share * state[9 + i] + state[place + WIDTH * k + 3 + i]
                taken += r.state_node_mass * rub(node, velocity, most, r.friction_creep)
        rate[loss] = taken

    @kernel
    def beside(record: Any, state: Array, offset: Array, parting: Array, rate: Array) -> None:
        """See `Disturbing`: a node lies on the table too.

        Checked  tests/tethered_deorbit/test_friction.py: nodes
        """
        r = record[0]
        most = r.friction_coefficient * r.friction_gravity
        target, velocity, node = r.state_rubbing[1], r.state_rubbing[2], r.state_rubbing[3]
        for i in range(3):
            velocity[i] = state[3 + i] + r.state_chaser_share * state[9 + i]
        rub(target, velocity, most, r.friction_creep)
        for i in range(3):
            velocity[i] += parting[i]
        rub(node, velocity, most, r.friction_creep)
        for i in range(3):
            rate[i] += node[i] - target[i]

    @kernel
    def begin(record: Any, state: Array) -> int:
        """Nothing is lost yet.

        Checked  tests/tethered_deorbit/test_friction.py
        """
        state[loss] = 0.0
        return 0

    return Rubbing(Disturbing(add=add, beside=beside), Acting(begin=begin))


def telling(reel: Reel, terms: Mapping[str, str], layout: StateLayout) -> Reel:
    """The law of the line with what friction takes told beside, where there is any."""
    if "friction" not in terms:
        return reel
    loss = layout.size - 1

    @kernel
    def publish(record: Any, state: Array, length: float, speed: float) -> None:
        """Loss [J], and friction of both bodies [N].

        Checked  tests/tethered_deorbit/test_friction.py
        """
        reel.publish(record, state, length, speed)
        r = record[0]
        most, out = r.friction_coefficient * r.friction_gravity, r.state_rubbing[0]
        r.friction_loss = state[loss]
        rub(out, r.chaser_velocity, most, r.friction_creep)
        r.friction_chaser_force = r.state_chaser_share * r.state_total_mass * norm(out)
        rub(out, r.target_velocity, most, r.friction_creep)
        r.friction_target_force = r.state_target_share * r.state_total_mass * norm(out)

    return reel._replace(publish=publish)
