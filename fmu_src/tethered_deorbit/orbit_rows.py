"""The variables of what disturbs an orbit: the flattening of the Earth's field, and the air."""

from __future__ import annotations

from fmu_src.interface import Group, Term
from fmu_src.rows import at_least_zero, output, parameter, positive, state, vector
from fmu_src.tethered_deorbit import stress

_ROOM = (
    vector("state.pole", "1", "the Earth's axis along the axes of the step", "state"),
    state("state.perturbing[#][#]", "1", "room for vectors", shape=(5, 3)),
)

OBLATENESS = Group(
    {
        "J2": Term(
            "the Earth is flattened: its second zonal harmonic acts on each of the two bodies",
            _ROOM,
            extremes=stress.OBLATENESS,
        )
    },
    selector="zonal",
    optional=True,
    follows=lambda terms, values: "J2",
)

AIR = Group(
    {
        "exponential": Term(
            "air whose density falls with altitude and that turns with the Earth drags each of the two bodies",
            (
                positive("air.base_density", "kg/m3", "at air.base_altitude; as it stands, of the standard atmosphere "
                         "at 400 km", 3.725e-12, 10.0),
                parameter("air.base_altitude", "m", "above the equatorial radius", 400e3, 0.0, 2e6, display_unit="km"),
                positive("air.scale_height", "m", "over which the density falls to 1/e", 58.515e3, 1e6,
                         display_unit="km"),
                at_least_zero("air.drag_coefficient", "1", "of both bodies", 2.2, 10.0),
                at_least_zero("air.chaser_area", "m2", "that the chaser shows the air", 10.0, 1e6),
                at_least_zero("air.target_area", "m2", "that the target shows the air", 10.0, 1e6),
                output("air.density", "kg/m3", "at the centre of mass", 1e-12),
                output("air.chaser_drag", "N", "on the chaser", 1e-4),
                output("air.target_drag", "N", "on the target", 1e-4),
                *_ROOM,
            ),
            extremes=stress.AIR,
        ),
    },
    selector="law",
    optional=True,
    follows=lambda terms, values: "exponential",
)  # fmt: skip
