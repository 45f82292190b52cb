"""Where the thruster's beam goes: how much of it meets the target, and whether the line lies in it."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

from fmu_src.interface import Interface
from fmu_src.tethered_deorbit.idle import nothing
from orbital.kernel import kernel
from orbital.vectors import Array, norm

INSIDE = 0.95
"""Share of the beam within its half-angle."""
SPREAD = math.sqrt(-2.0 * math.log(1.0 - INSIDE))
"""Half-angle's radius over the standard deviation of a beam that is normal in both directions across."""


class Plume(NamedTuple):
    """Kernels of the beam; as it stands, those of a scene that does not ask.

    add(record, state, rate, force, x, y, z)      its push on the target, added to the rate, for a force [N] along
                                                  (x, y, z), of any length, on the chaser
    publish(record, state, force, x, y, z)        its outputs
    """

    add: Callable[..., Any] = nothing
    publish: Callable[..., Any] = nothing


def make_plume(terms: Mapping[str, str], interface: Interface) -> Plume:
    """The kernels of the beam, if the scene names it.

    The beam leaves at the chaser's centre of mass against the force, and is normal across: 95 % lie within the
    half-angle. The target shows a square face of side w across the line of centres, at the distance d along the beam
    and e aside of it,

        share = (erf((w/2 - e)/(sigma sqrt(2))) + erf((w/2 + e)/(sigma sqrt(2))))/2 erf(w/(2 sigma sqrt(2))),
        sigma = d tan(half-angle)/sqrt(-2 ln 0.05)

    and takes the momentum of what meets it. Behind the thruster the share is zero.

    Valid    a beam that nothing reflects; a face that stays across, seen along a side of the square
    Source   integral of a normal density over a square; ours
    Checked  tests/tethered_deorbit/test_plume.py
    """
    if "plume" not in terms:
        return Plume()
    scale = 1.0 / math.sqrt(2.0)

    @kernel
    def meets(record: Any, state: Array, force: float, x: float, y: float, z: float) -> float:
        """Share of the beam that meets the target [-].

        Checked  tests/tethered_deorbit/test_plume.py
        """
        r = record[0]
        length = math.sqrt(x * x + y * y + z * z)
        apart = norm(state[6:9])
        if not (length > 0.0 and apart > 0.0 and force != 0.0):
            return 0.0
        sign = -1.0 if force > 0.0 else 1.0
        along = sign * (x * state[6] + y * state[7] + z * state[8]) / length
        if not along > 0.0:
            return 0.0
        aside = math.sqrt(max(0.0, apart * apart - along * along))
        sigma = along * math.tan(r.plume_half_angle) / SPREAD
        half = 0.5 * r.plume_face
        first, second = math.erf((half - aside) / sigma * scale), math.erf((half + aside) / sigma * scale)
        return 0.5 * (first + second) * math.erf(half / sigma * scale)

    @kernel
    def add(record: Any, state: Array, rate: Array, force: float, x: float, y: float, z: float) -> None:
        """The push on the target: share |F| along the beam.

            R'' -= share F u/M,   rho'' -= share F u/m_t

        Checked  tests/tethered_deorbit/test_plume.py
        """
        r = record[0]
        if not r.plume_pushes:
            return
        share = meets(record, state, force, x, y, z)
        if share == 0.0:
            return
        length = math.sqrt(x * x + y * y + z * z)
        on_center = share * force / (r.state_total_mass * length)
        on_target = share * force / (r.target_mass * length)
        for i, u in enumerate((x, y, z)):
            rate[3 + i] -= on_center * u
            rate[9 + i] -= on_target * u

    @kernel
    def publish(record: Any, state: Array, force: float, x: float, y: float, z: float) -> None:
        """Share on the target [-], the push of that [N], and whether the line of centres lies within the half-angle.

        Checked  tests/tethered_deorbit/test_plume.py
        """
        r = record[0]
        share = meets(record, state, force, x, y, z)
        r.plume_share = share
        r.plume_force = share * abs(force)
        length, apart = math.sqrt(x * x + y * y + z * z), norm(state[6:9])
        r.plume_on_line = 0
        if length > 0.0 and apart > 0.0 and force != 0.0:
            sign = -1.0 if force > 0.0 else 1.0
            along = sign * (x * state[6] + y * state[7] + z * state[8]) / length
            if along >= math.cos(r.plume_half_angle) * apart:
                r.plume_on_line = 1

    return Plume(add, publish)
