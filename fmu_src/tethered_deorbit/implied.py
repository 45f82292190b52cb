"""What a scene implies for a tow: the line's section and stiffness, its period, the orbit's tide."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from fmu_src.implied import Implied, formula
from fmu_src.tethered_deorbit.asked import LINEAR_LAWS
from fmu_src.tethered_deorbit.nodes.cost import cost
from orbital import oscillators, references
from orbital.constants import EARTH_EQUATORIAL_RADIUS, EARTH_MU
from orbital.plain import mean_motion

line_stiffness, reduced_mass = formula(oscillators.line_stiffness), formula(oscillators.reduced_mass)
natural_frequency, dashpot = formula(oscillators.natural_frequency), formula(oscillators.dashpot)
equilibrium_tension = formula(references.equilibrium_tension)


def axial_stiffness(values: Mapping[str, float]) -> float:
    """EA [N] of the line: what a metre of it would have as its stiffness times its length."""
    return line_stiffness(values["tether.youngs_modulus"], values["tether.diameter"], 1.0)


def rows(values: Mapping[str, float], terms: Mapping[str, str]) -> Iterator[Implied]:
    """Masses, line and orbit of the pair."""
    reduced = reduced_mass(values["chaser.mass"], values["target.mass"])
    yield Implied("pair.reduced_mass", "reduced mass of the pair", reduced, "kg")
    length, stiffness = 0.0, 0.0
    if "tether.youngs_modulus" in values:
        length = values["tether.rest_length"] + (values["reel.length_offset"] if terms["reel"] == "locked" else 0.0)
        extensional = axial_stiffness(values)
        given = length + extensional * values.get("net.compliance", 0.0)
        stiffness = line_stiffness(values["tether.youngs_modulus"], values["tether.diameter"], given)
        yield Implied("line.area", "section of the line", extensional / values["tether.youngs_modulus"], "m2")
        yield Implied("line.axial_stiffness", "EA of the line", extensional, "N")
        whose = "the line with the net in series" if "net" in terms else "the line"
        yield Implied("line.stiffness", f"stiffness of {whose}", stiffness, "N/m")
        if "lumped" in terms:
            label, damping = "dashpot of the line, its pieces in series", cost(values).dashpot
        else:
            label, damping = "dashpot of the line", dashpot(values["tether.damping_ratio"], stiffness, reduced)
        yield Implied("line.dashpot", label, damping, "N.s/m")
    elif terms["reel"] in ("linear", "regulator"):
        length, stiffness = values["reel.length"] + values["reel.length_offset"], values["reel.proportional_gain"]
    if stiffness > 0.0:
        period = 2.0 * math.pi / natural_frequency(stiffness, reduced)
        yield Implied("line.period", "period of the pair on the taut line, undamped", period, "s")
    if "lumped" in terms:
        told = cost(values)
        yield Implied("lumped.mass", "mass of the line's nodes", told.mass, "kg")
        yield Implied("lumped.fastest", "fastest motion of the line's nodes, a bound", told.fastest, "rad/s")
        yield Implied("lumped.steps", "steps of an hour while the line is taut", told.steps, "1")
        yield Implied("lumped.cpu", "processor time of these, about", told.seconds, "s")
    if "orbit.altitude" not in values:
        return
    rate = mean_motion(EARTH_EQUATORIAL_RADIUS + values["orbit.altitude"], EARTH_MU)
    yield Implied("orbit.period", "period of the orbit", 2.0 * math.pi / rate, "s")
    if length > 0.0:
        tide = equilibrium_tension(rate, length, reduced)
        yield Implied("tide.tension", "tension at rest under the tide, 3 n^2 m_r l", tide, "N")
        critical = references.critical_thrust(rate, length, values["chaser.mass"])
        yield Implied("vbar.critical_thrust", "least thrust of a stable tow on V-bar, 3 n^2 l m_c", critical, "N")
    if terms["reel"] in LINEAR_LAWS:
        from fmu_src.tethered_deorbit import design  # and with it scipy

        yield from design.rows(values, terms)
