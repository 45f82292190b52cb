"""Bodies round which the line can wrap, each a file with its geometry and its rows. A new one is listed here."""

from __future__ import annotations

from fmu_src.tethered_deorbit.surfaces.box import BOX
from fmu_src.tethered_deorbit.surfaces.cylinder import CYLINDER
from fmu_src.tethered_deorbit.surfaces.hull import HULL
from fmu_src.tethered_deorbit.surfaces.surface import Surface

SURFACES: dict[str, Surface] = {surface.name: surface for surface in (BOX, CYLINDER, HULL)}
