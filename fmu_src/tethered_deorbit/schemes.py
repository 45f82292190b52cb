"""The schemes that integrate the pair, by the name a scene gives them; each is a file of `fmu_src/integrators`."""

from __future__ import annotations

from fmu_src.integrators.dop853 import make_dop853
from fmu_src.integrators.gauss import make_gauss
from fmu_src.integrators.radau import make_radau

SCHEMES = {"dop853": make_dop853, "gauss": make_gauss, "radau": make_radau}
