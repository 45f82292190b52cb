"""Ejectors whose own data give the bullets' speed: what pneumatic guns and springs have in common.

They are no part of an FMU: the speed is designed as a scene is read, and the FMU has it as its parameter.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from fmu_src.extremes import Extreme, times
from fmu_src.implied import Implied
from fmu_src.interface import Term, Undesigned, Variable
from fmu_src.net_capture.release import pneumatic, springs
from fmu_src.rows import at_least_zero, parameter

Values = Mapping[str, float]

SCATTER: tuple[Variable, ...] = (
    at_least_zero(
        "ejector.scatter", "1", "standard deviation of the speed from barrel to barrel, over the speed", 0.0, 1.0
    ),
    parameter("ejector.seed", "1", "which scatter", 0, 0, 2**31 - 1, kind="Integer"),
)


def scattered(speed: float, values: Values, terms: Mapping[str, str]) -> dict[str, float]:
    """The bullets' speed [m/s], and the error of each that scatter makes.

    Checked  tests/net_capture/test_ejectors.py
    """
    found = {"bullets.speed": speed}
    share = values["ejector.scatter"]
    if share > 0.0:
        if "ejection" not in terms:
            raise Undesigned(
                "ejector.scatter", f"{share:g}", "needs the table [capture.ejection], whose errors it gives"
            )
        drawn = np.random.default_rng(int(values["ejector.seed"])).standard_normal(int(terms["bullets"]))
        found |= {f"ejection.speed_error[{i}]": float(speed * share * x) for i, x in enumerate(drawn, 1)}
    return found


def _pneumatic(values: Values, asked: Values, terms: Mapping[str, str]) -> dict[str, float]:
    shot = pneumatic.shot(pneumatic.gun_of({**values, **asked}, int(terms["bullets"])), int(asked["ejector.shot"]))
    return scattered(shot.speed, asked, terms)


def _springs(values: Values, asked: Values, terms: Mapping[str, str]) -> dict[str, float]:
    return scattered(springs.push({**values, **asked}).speed, asked, terms)


PARTS = {
    "pneumatic": Term(
        "the bullets' speed is that of gas guns: gas, reservoir, valve and barrel",
        asked=(*pneumatic.ROWS, *SCATTER),
        design=_pneumatic,
        extremes=(
            Extreme(
                "a valve like a pinhole",
                "gas hisses behind bullets that creep: the design's own integration, stiff",
                "energy_gained",
                {"ejector.valve_area": 1e-8},
            ),
            Extreme(
                "a valve that opens wholly at once",
                "pressures that are one",
                "energy_gained",
                {"ejector.valve_area": 0.0},
            ),
        ),
    ),
    "springs": Term(
        "the bullets' speed is that of springs: stiffness, stroke, and a bound of the impulse",
        asked=(*springs.ROWS, *SCATTER),
        design=_springs,
        extremes=(
            Extreme(
                "springs a thousand times as stiff",
                "bullets thirty times as fast",
                "energy_gained",
                {"ejector.stiffness": times("ejector.stiffness", 1e3), "ejector.most_impulse": 0.0},
                duration=1.0,
            ),
        ),
    ),
}
"""By the name a scene gives them."""


def rows(values: Values, terms: Mapping[str, str]) -> Iterator[Implied]:
    """What an ejector comes to, where its data are among the values."""
    if "ejector.scatter" not in values:
        return
    if terms.get("ejector") == "pneumatic":
        yield from pneumatic.rows(values, int(terms["bullets"]))
    else:
        yield from springs.rows(values)
