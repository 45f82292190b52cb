"""What of a tow may be moved in its page, how far, and what each sets in the model.

A value is moved in the unit that it is shown in, and the model gets `offset + slope * SI` of it for each of its
variables. What a scene can say itself has the offset 0 and the slope 1. Two are estimates, and told as such: speed of
the shot, of which only the momentum is followed, and spin of a target that a net hands over.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, field, replace
from typing import Any

import numpy as np

from dcone_cosim.handoff import without_recoil
from dcone_cosim.results import RunResult
from dcone_cosim.scene.data import PhaseScene
from dcone_cosim.transaction import HandoffRecord
from dcone_cosim.units import by_name

SHOT = "bullets.speed"
EACH = tuple(f"[{i}]" for i in (1, 2, 3))
SPIN = tuple(f"target.start_rate{each}" for each in EACH)
THRUST = "thrust.level"
REST_LENGTH = "tether.rest_length"
SLOWEST, FASTEST = 0.7, 1.4
"""Shares of the shot's speed between which its momentum alone is followed."""
DIGITS = 12
"""Of a value as it is shown, so that what a scene says as 0.1 is 0.1."""


@dataclass(frozen=True)
class Row:
    """A value of the scene that may be moved: FMI name, what it is called, unit, shares of the run's own value between
    which it moves, and whether evenly in its logarithm."""

    name: str
    label: str
    unit: str
    low: float
    high: float
    log: bool = False


ROWS = (
    Row("tether.diameter", "diameter of the tether", "mm", 0.1, 10.0, True),
    Row("tether.youngs_modulus", "Young's modulus of the tether", "GPa", 0.1, 10.0, True),
    Row("tether.damping_ratio", "damping ratio of the tether", "1", 0.01, 20.0, True),
    Row(REST_LENGTH, "length of the tether", "m", 0.5, 5.0, True),
    Row(THRUST, "thrust", "N", 0.0, 5.0),
)
"""Of a tow."""
SHOTS = (
    Row(SHOT, "speed of the bullets", "m/s", 0.5, 2.0),
    Row("bullets.angle", "angle of the shot", "deg", 0.25, 2.0),
    Row("bullets.mass", "mass of a bullet", "kg", 0.25, 4.0, True),
    Row("net.damping_ratio", "damping ratio of the threads", "1", 0.1, 10.0, True),
)
"""Of a shot."""


@dataclass(frozen=True)
class Knob:
    """One such value of a run.

    key        of the scene, as `--set` has it
    label      what it is;  unit   that it is shown in, "" for none
    factor     SI value over the one that is shown
    value, low, high    shown: of the run, least and largest
    log        whether it moves evenly in its logarithm
    sets       offset and slope by FMI name
    written    the value of `--set`, with {} for the number;  list   for numbers in it, each a share of what is shown
    also       keys that have the same value
    again      whether the run has to be made again from its beginning, the net shot anew
    estimate   what is left out, "" for nothing
    """

    key: str
    label: str
    unit: str
    factor: float
    value: float
    low: float
    high: float
    log: bool
    sets: Mapping[str, tuple[float, float]]
    also: tuple[str, ...] = ()
    shares: tuple[float, ...] = field(default=())
    again: bool = False
    estimate: str = ""

    def told(self) -> dict[str, Any]:
        return asdict(self)


def knobs_of(phase: PhaseScene, bounds: Mapping[str, tuple[float, float]], run: RunResult) -> Iterator[Knob]:
    """Those that a tow has.

    bounds     least and largest value of each parameter of its FMU, SI

    Checked  tests/report/test_knobs.py
    """
    values = {**phase.main.defaults, **phase.main.parameters}
    record = run.handovers.get(phase.name)
    handed = isinstance(record, HandoffRecord)
    before = "capture" if handed else ""
    for row in ROWS:
        value = values.get(row.name, math.nan)
        if row.name in bounds and math.isfinite(value) and value:
            told = f"{row.label}, {signed(phase.main.terms)}" if row.name == THRUST else row.label
            yield _own(phase.name, replace(row, label=told), value, bounds[row.name], before)
    if isinstance(record, HandoffRecord):
        yield from _shot(record, run, before)
    yield from _spin(phase.name, values, bounds, run, before)


def knobs_of_shot(phase: PhaseScene, bounds: Mapping[str, tuple[float, float]]) -> Iterator[Knob]:
    """Those that a shot has."""
    values = {**phase.main.defaults, **phase.main.parameters}
    for row in SHOTS:
        value = values.get(row.name, math.nan)
        if row.name in bounds and math.isfinite(value) and value:
            yield _own(phase.name, row, value, bounds[row.name], "")


def signed(terms: Mapping[str, str]) -> str:
    """What the sign of a thrust means."""
    direction = terms.get("thrust", "").replace("_", " ")
    return f"{direction} (minus: against it)" if direction else "minus: against its direction"


def _shown(si: float, factor: float) -> float:
    return float(f"{si / factor:.{DIGITS}g}")


def _own(phase: str, row: Row, value: float, bounds: tuple[float, float], before: str) -> Knob:
    factor = by_name(row.unit).factor
    ends = sorted((row.low * value, row.high * value))
    low, high = (_shown(min(max(end, bounds[0]), bounds[1]), factor) for end in ends)
    joined = row.name == REST_LENGTH and bool(before)
    return Knob(
        f"{phase}.{row.name}",
        row.label,
        "" if row.unit == "1" else row.unit,
        factor,
        _shown(value, factor),
        low,
        high,
        row.log,
        {row.name: (0.0, 1.0)},
        (f"{before}.tether.length",) if joined else (),
        again=joined,
    )


def _shot(record: HandoffRecord, run: RunResult, before: str) -> Iterator[Knob]:
    """Speed of the shot: the velocities that its momentum has left grow with it.

    v = v_0 + (V / V_run) (v_run - v_0)      v_0 without the shot's momentum
    """
    capture = run.parameters[before]
    speed = capture.get(SHOT, 0.0)
    own = record.handed.parameters
    if not speed > 0.0:
        return
    still = without_recoil(record.handed, np.array([capture[f"chaser.start_velocity{each}"] for each in EACH]))
    names = [name for name in own if "velocity" in name]
    sets = {name: (still[name], (own[name] - still[name]) / speed) for name in names}
    text = "the net is not shot again: its places and instants stay, velocities follow the shot's momentum"
    yield Knob(
        f"{before}.{SHOT}", "speed of the shot, by its momentum alone", "m/s", 1.0, _shown(speed, 1.0),
        _shown(SLOWEST * speed, 1.0), _shown(FASTEST * speed, 1.0), False, sets, again=True, estimate=text,
    )  # fmt: skip


def _spin(
    phase: str, values: Mapping[str, float], bounds: Mapping[str, Any], run: RunResult, before: str
) -> Iterator[Knob]:
    """How fast the target turns, about the axis that it turns about."""
    rate = np.array([values.get(name, 0.0) for name in SPIN])
    size = float(np.linalg.norm(rate))
    if not size > 0.0 or not set(SPIN) <= bounds.keys():
        return
    sets = {name: (0.0, float(part)) for name, part in zip(SPIN, rate / size, strict=True)}
    factor = by_name("deg/s").factor
    key, said, shares = f"{phase}.target.start_rate", "", rate / size
    if before:
        own = np.array([run.parameters[before].get(name, 0.0) for name in SPIN])
        if not own.any():
            return
        key, shares = f"{before}.target.start_rate", own / size
        said = "of net and target as they were handed over; the net is not shot again"
    yield Knob(
        key, "spin of the target", "deg/s", factor, _shown(size, factor), 0.0, _shown(4.0 * size, factor), False,
        sets, shares=tuple(map(float, shares)), again=bool(before), estimate=said,
    )  # fmt: skip
