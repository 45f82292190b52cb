"""What a sizing asks: factor of safety, what else the line has to bear, how much is tried. A scene's table [sizing] says it,
the command line goes before that, and what neither says has a default that the report tells.

    [sizing]
    factor_of_safety = 2.0
    least_breaking_load = "200 N"
    mission_time = "3 yr"
    cut_probability = "1 %"
    flux = "1.05e-1 1/(m2 yr)"        # of particles larger than flux_size, through a surface that turns at random
    flux_size = "0.25 mm"
    flux_exponent = 2.5
    [sizing.ranges]
    "removal.thrust.level" = ["-0.02 N", "-0.005 N"]
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields

from dcone_cosim.scene.expected import Expected

YEAR = 365.25 * 86400.0
FLUX_SOURCE = (
    "1.05e-5 (d/cm)^-2.5 per m2 and year: the small particles of Kessler, Reynolds and Anz-Meador, NASA TM 100471 (1989), "
    "without its factors for altitude, inclination and growth, which are within 3 of one in low orbit; take ORDEM or MASTER "
    "where it governs"
)


@dataclass(frozen=True)
class Options:
    """How a sizing is done.

    factor_of_safety      on the highest tension [1]
    least_breaking_load   that handling asks for, whatever the line bears in space [N]
    mission_time          that the line is out [s]; None: until the scene's thrust has brought the pair down
    cut_probability       that debris cuts the line in that time, at most [1]
    flux, flux_size, flux_exponent   f(d) = flux (d/flux_size)^-flux_exponent  [1/(m2 s)], [m], [1]
    samples, steps        runs of the uncertain values at random; points of a sensitivity
    offset                of the pull from the chaser's centre of mass, where the scene has none [m]
    torque                of the chaser's attitude control, where the scene has none [N m]
    ranges                key of the scene: least and largest value, as texts
    """

    factor_of_safety: float = 2.0
    least_breaking_load: float = 0.0
    mission_time: float | None = None
    cut_probability: float = 0.01
    flux: float = 1.05e-5 * 0.1**-2.5 / YEAR
    flux_size: float = 1e-3
    flux_exponent: float = 2.5
    samples: int = 64
    steps: int = 5
    offset: float = 0.1
    torque: float = 0.2
    ranges: Mapping[str, Sequence[str]] = field(default_factory=dict)


DEFAULT = Options()
QUICK = Options(samples=12, steps=3)


def keys() -> dict[str, Expected]:
    """What a scene's table [sizing] may say, beside `ranges`."""
    positive = {"minimum": 0.0, "open_minimum": True}
    return {
        "factor_of_safety": Expected("1", example="2.0", minimum=1.0),
        "least_breaking_load": Expected("N", example="200 N", minimum=0.0),
        "mission_time": Expected("s", example="3 yr", **positive),  # type: ignore[arg-type]
        "cut_probability": Expected("1", example="1 %", maximum=0.99, share=True, **positive),  # type: ignore[arg-type]
        "flux": Expected("1/m2.s", example="1e-9 1/(m2 s)", **positive),  # type: ignore[arg-type]
        "flux_size": Expected("m", example="1 mm", **positive),  # type: ignore[arg-type]
        "flux_exponent": Expected("1", example="2.5", minimum=1.0, open_minimum=True),
        "offset": Expected("m", example="0.1 m", minimum=0.0),
        "torque": Expected("N.m", example="0.2 N m", **positive),  # type: ignore[arg-type]
    }


NAMES = tuple(row.name for row in fields(Options))
