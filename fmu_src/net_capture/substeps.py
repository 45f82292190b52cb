"""What a scene's values come to for the substep, of the parts themselves: before anything is built."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from fmu_src.implied import formula
from fmu_src.net_capture import formulas
from fmu_src.net_capture.bending import stiffening_of
from fmu_src.net_capture.rigging import riggings
from fmu_src.net_capture.self_contact.segments import stiffening

Values = Mapping[str, float]
COUNT = ("net", *riggings(), "solver", "closing", "target", "contact", "bending", "self_contact")
"""Groups on which a substep hangs."""


def substeps(values: Values, parts: Mapping[str, Any]) -> tuple[float, float]:
    """Stability bound, and the largest substep that keeps the mouth area within 0.3 % and the energy within 1 % [s].

    parts    terms of the model by group, those of COUNT among them as far as the scene has them
    """
    net = parts["net"].checks
    of_net = net.piece(values)
    *_, node = of_net
    cord = cord_dashpot = 0.0
    rings = apart = 0
    if "closing" in parts:
        rings, apart = int(values["closing.rings"]), int(values["closing.reels_at"])
        moved = formula(formulas.cord_mass)(values["bullets.mass"], 0.75 * node, rings, apart)
        cord = formula(formulas.cord_stiffness)(values["closing.axial_stiffness"], values["closing.lock_length"])
        cord_dashpot = formula(formulas.cord_damping)(values["closing.damping_ratio"], cord, moved)
    bent, resisting = stiffening_of(values, net) if "bending" in parts else (0.0, 0.0)
    touching = formula(stiffening)(values["self_contact.duration"]) if "self_contact" in parts else 0.0
    pressing = _pressing(values, parts, node) + bent + touching
    needs = parts["solver"].checks
    longest, accurate = formula(needs.longest_step), formula(needs.accurate_step)
    limits = formulas.make_substep_limits(longest, accurate)
    found: tuple[float, float] = formula(limits)(
        *of_net,
        cord,
        cord_dashpot,
        values["bullets.mass"],
        rings,
        pressing,
        apart,
        resisting,
    )
    rigged = [parts[name].checks.rates(values, net, *of_net) for name in riggings() if name in parts]
    stiff, damped = (max(rates) for rates in zip((0.0, 0.0), *rigged, strict=True))
    if stiff > 0.0:
        stiff, damped = stiff + pressing, damped + resisting
        found = min(found[0], longest(stiff, damped)), min(found[1], accurate(stiff, damped))
    return found


def _pressing(values: Values, parts: Mapping[str, Any], node: float) -> float:
    """What a surface adds at every node, see `formulas.longest_step` [1/s2], of a node between two pieces [kg]."""
    law = parts["contact"].checks.stiffening if "contact" in parts else None
    if law is None:
        return 0.0
    net, rigged = parts["net"].checks, [parts[name].checks for name in riggings() if name in parts]
    mass = net.mass(values) + net.bullets(values) * values["bullets.mass"] + values["vertex.mass"]
    mass += sum(rig.mass(values, net) for rig in rigged)
    nodes = net.nodes(values) + sum(rig.nodes(values, net) for rig in rigged)
    found: float = law(values, node, mass, nodes, parts["target"].checks.radius)
    return found
