"""What disturbs the orbit of a pair: the Earth's field, the air, Sun and Moon, and light, each where it is named.

All know the Earth's axis, Sun and Moon, which the laws of a step's axes do not: these turn with a taut line, and what
is pointed to is turned along with them.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

from fmu_src.interface import Interface
from fmu_src.tables import make_reader
from fmu_src.tethered_deorbit import field_table
from fmu_src.tethered_deorbit.acting import IDLE, Acting
from fmu_src.tethered_deorbit.air_table import NAME
from fmu_src.tethered_deorbit.environment import air, electrodynamic, msis, sky, sunlight, zonals
from fmu_src.tethered_deorbit.environment.disturbing import Disturbing, together
from fmu_src.tethered_deorbit.environment.friction import make_friction
from fmu_src.tethered_deorbit.idle import nothing
from fmu_src.tethered_deorbit.layout import StateLayout
from fmu_src.tethered_deorbit.turning import turn_vectors_back
from orbital.kernel import kernel
from orbital.vectors import Array

GROUPS = ("oblateness", "air", "third_bodies", "shadow", "sunlight", "electrodynamic")
TURNS = ("oblateness", "air", "electrodynamic")
"""Groups that know the Earth's axis."""
SKY = ("third_bodies", "shadow")
"""Groups that look at the sky."""
FIELDS = {"dipole": electrodynamic.point_dipole, "igrf": electrodynamic.point_greenwich}
"""What has to be pointed to for a magnetic field."""


class Perturbing(NamedTuple):
    """Kernels; as it stands, of an orbit that nothing disturbs.

    begin(record)                             before all others
    add(record, state, rate, since, elapsed)  to the rate under gravity, `elapsed` [s] after the begin of the step and
                                              `since` after the inputs in force began to move
    publish(record, time)                     outputs, and the potential in `energy.orbital`, from those of bodies and
                                              centre, at a time since the start of the instance [s]
    differentiate(record, center, velocity)   the part of the potential in the rate of that
    acting                                    where light comes and goes
    beside(record, state, offset, parting, rate)   as of `Disturbing`, after `add`
    """

    begin: Callable[..., Any] = nothing
    add: Callable[..., Any] = nothing
    publish: Callable[..., Any] = nothing
    differentiate: Callable[..., Any] = nothing
    acting: Acting = IDLE
    beside: Callable[..., Any] = nothing


@kernel
def point_axis(record: Any, elapsed: float) -> None:
    """The Earth's axis along the axes of the step, in `state.pole`.

    elapsed       for which these have turned                    [s]

    Checked  tests/tethered_deorbit/test_perturbed.py: axes change nothing
    """
    pole = record[0].state_pole
    pole[0] = 0.0
    pole[1] = 0.0
    pole[2] = 1.0
    turn_vectors_back(record, -elapsed, pole, 3)


def make_perturbing(interface: Interface, layout: StateLayout | None = None) -> Perturbing:
    """The kernels of a table, which asks for the layout, or of what is named among `GROUPS`; ValueError where there is
    no orbit to disturb."""
    terms = interface.terms
    if "friction" in terms and layout is not None:
        rubbing = make_friction(interface, layout)
        add_friction = rubbing.disturbing.add

        @kernel
        def slide(record: Any, state: Array, rate: Array, since: float, elapsed: float) -> None:
            """See `Perturbing`.

            Checked  tests/tethered_deorbit/test_friction.py
            """
            add_friction(record, state, rate)

        return Perturbing(add=slide, acting=rubbing.acting, beside=rubbing.disturbing.beside)
    named = [group for group in GROUPS if group in terms]
    if not named:
        return Perturbing()
    if terms["environment"] == "none":
        raise ValueError(f"{named[0]} = {terms[named[0]]!r} needs an orbit, and environment = 'none' has none")
    parts: list[Disturbing] = []
    acting = IDLE
    looks = any(group in terms for group in SKY) or terms.get("air") == "nrlmsis"
    point_sky = sky.make_point_sky("moon" in terms.get("third_bodies", "")) if looks else nothing
    if "oblateness" in terms:
        parts.append(zonals.ZONALS[terms["oblateness"]])
    if "air" in terms:
        tabled = terms["air"] == "nrlmsis"
        parts.append(
            air.make_air(msis.make_density(make_reader(interface.tables, NAME)) if tabled else air.exponential)
        )
    if "third_bodies" in terms:
        parts.append(sky.make_attraction(terms["third_bodies"]))
    if "shadow" in terms:
        shadow, acting = sunlight.make_shadow(terms["shadow"], point_sky)
        parts.append(shadow)
    if "sunlight" in terms:
        parts.append(sunlight.PRESSURE)
    if "electrodynamic" in terms:
        field: Callable[..., Any] = electrodynamic.dipole
        if terms["electrodynamic"] == "igrf":
            field = electrodynamic.make_igrf(make_reader(interface.tables, field_table.NAME))
        parts.append(electrodynamic.make_electrodynamic(terms, field))
    all_of_them = together(parts)
    point = point_axis if any(group in terms for group in TURNS) else nothing
    point_field = FIELDS[terms["electrodynamic"]] if "electrodynamic" in terms else nothing

    @kernel
    def add(record: Any, state: Array, rate: Array, since: float, elapsed: float) -> None:
        """See `Perturbing`.

        Checked  tests/tethered_deorbit/test_perturbed.py, test_sky.py
        """
        point(record, elapsed)
        now = record[0].state_begin + (since - record[0].state_since)
        point_sky(record, now, elapsed)
        point_field(record, now, elapsed)
        all_of_them.add(record, state, rate)

    @kernel
    def publish(record: Any, time: float) -> None:
        """See `Perturbing`.

        Checked  tests/tethered_deorbit/test_perturbed.py, test_sky.py
        """
        point(record, 0.0)
        point_sky(record, time, 0.0)
        point_field(record, time, 0.0)
        all_of_them.publish(record, time)

    @kernel
    def differentiate(record: Any, center: Array, velocity: Array) -> None:
        """See `Perturbing`.

        Checked  tests/tethered_deorbit/test_perturbed.py: derivatives
        """
        point(record, 0.0)
        all_of_them.differentiate(record, center, velocity)

    begin = sky.forget_sky if looks else nothing
    told = differentiate if all_of_them.differentiate is not nothing else nothing
    return Perturbing(begin, add, publish, told, acting, all_of_them.beside)
