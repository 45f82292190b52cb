"""What is uncertain of a tow, how far, and the runs that look into all of it.

Each value at both of its ends, the others as they are; every choice; and all together at random.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from dcone_cosim import build
from dcone_cosim.errors import InputError
from dcone_cosim.sizing.ground import Ground
from dcone_cosim.units import Unit, by_name, spoken

SEED = 13
"""Of the samples at random."""
SHARES: tuple[tuple[str, str, float, float, str], ...] = (
    ("thrust.level", "thrust", 0.9, 1.1, "10 %: an engine's throttle and its calibration"),
    ("tether.rest_length", "line length", 0.98, 1.02, "2 %: pay-out of a reel"),
    ("tether.diameter", "line diameter", 0.95, 1.05, "5 %: a braid's make"),
    ("tether.youngs_modulus", "line stiffness E", 0.8, 1.2, "20 %: braids bed in, and stiffen when fast"),
    ("tether.damping_ratio", "line damping", 0.5, 2.0, "half to twice: no data sheet tells it"),
    ("chaser.mass", "chaser mass", 0.95, 1.05, "5 %: propellant"),
    ("target.mass", "debris mass", 0.9, 1.1, "10 %: what is left in its tanks"),
    ("start.separation", "separation at the start", 0.9, 1.1, "10 %: navigation, and no farther than the line reaches"),
)
"""Default ranges as shares of the scene's values: FMI name, label, ends, why. All ours."""
VECTORS: tuple[tuple[str, str, float, float, str], ...] = (
    ("target.start_rate", "debris spin", 0.0, 2.0, "none to twice: seen from outside"),
    ("target.attachment", "attachment on the debris", 0.8, 1.2, "20 %: where the net draws together"),
    ("start.relative_velocity", "speed handed over", 0.9, 1.1, "10 %: momentum of the shot and of the closing"),
)
CHOICES = (("start.condition", "start"), ("start.leading", "who leads"))
TAKEN_OVER = "handed_over"


@dataclass(frozen=True)
class Uncertain:
    """One uncertain value.

    names      FMI names that go together
    ends       values at the low and the high end, by name, SI
    labels     of the ends, for a reader
    smooth     a number, not a choice: it may lie between
    """

    key: str
    label: str
    ends: tuple[Mapping[str, float], Mapping[str, float]]
    labels: tuple[str, str]
    why: str
    smooth: bool = True

    def at(self, share: float) -> dict[str, float]:
        """Values at a share of the way from the low to the high end."""
        if not self.smooth:
            return dict(self.ends[int(share >= 0.5)])
        low, high = self.ends
        return {name: low[name] + share * (high[name] - low[name]) for name in low}


@dataclass
class Sample:
    """One run: values beside those of the scene, and what it is."""

    label: str
    values: dict[str, float] = field(default_factory=dict)


def uncertain(ground: Ground, ranges: Mapping[str, Sequence[str]]) -> list[Uncertain]:
    """All that is uncertain of the tow: what the scene or the options say, and the defaults for the rest."""
    own = [_told(ground, key, ends) for key, ends in ranges.items()]
    taken = {name for one in own for name in one.ends[0]}
    found = [one for one in _defaults(ground) if not taken & set(one.ends[0])]
    return [*own, *found]


def _defaults(ground: Ground) -> Iterator[Uncertain]:
    values, main = ground.values, ground.phase.main
    for name, label, low, high, why in SHARES:
        value = values.get(name, 0.0)
        if name == "start.separation" and (ground.handed_over or "start.condition" not in main.choices):
            continue
        ends = [value * low, value * high]
        if name == "start.separation":  # a line that begins stretched is no start
            ends[1] = min(ends[1], max(value, 0.999 * values["tether.rest_length"]))
        if value and ends[0] != ends[1]:
            unit = _unit(ground, name)
            yield Uncertain(
                name, label, ({name: ends[0]}, {name: ends[1]}), (_say(ends[0], unit), _say(ends[1], unit)), why
            )
    for name, label, low, high, why in VECTORS:
        parts = [f"{name}[{i}]" for i in (1, 2, 3)]
        if all(part in values for part in parts) and any(values[part] for part in parts):
            if name.startswith("start.") and not ground.handed_over:
                continue
            lows, highs = ({part: share * values[part] for part in parts} for share in (low, high))
            yield Uncertain(name, label, (lows, highs), (f"x {low:g}", f"x {high:g}"), why)
    if not ground.handed_over:
        for name, label in CHOICES:
            names = [one for one in main.choices.get(name, ()) if one != TAKEN_OVER]
            here = values.get(name)
            for one in names:
                value = main.choices[name].index(one)
                if here is not None and value != here:
                    now = main.choices[name][int(here)]
                    yield Uncertain(
                        f"{name}={one}",
                        label,
                        ({name: here}, {name: float(value)}),
                        (now, one),
                        "each that there is",
                        False,
                    )


def _unit(ground: Ground, name: str) -> Unit:
    """The unit in which a person would write it."""
    rows = build.all_rows(build.CATALOGUE[ground.phase.main.model])
    return next((by_name(row.display_unit or row.unit) for row in rows if row.name == name), by_name("1"))


def _say(value: float, unit: Unit) -> str:
    return f"{unit.from_si(value):.4g} {spoken(unit.name)}".strip()


def _told(ground: Ground, key: str, ends: Sequence[str]) -> Uncertain:
    """The range of a key that a scene or an option tells, by what the scene with it comes to."""
    if len(ends) != 2:
        raise InputError(f"sizing range of {key}: {len(ends)} values; expected the least and the largest")
    phase = ground.name
    if not key.startswith(f"{phase}."):
        raise InputError(f"sizing range of {key}: expected a key of [{phase}], such as {phase}.thrust.level")
    found: list[dict[str, Any]] = []
    for end in ends:
        try:
            scene = ground.alone.scene_of(phase, [f"{key}={end}"])
        except InputError as error:
            raise InputError(f"sizing range of {key}: {error}") from None
        main = scene.phases[0].main
        found.append({**main.defaults, **main.parameters})
    low, high = found
    names = [name for name in low if low[name] != high.get(name)]
    if not names:
        raise InputError(f"sizing range of {key}: {ends[0]} and {ends[1]} come to the same")
    kept = [{name: float(one[name]) for name in names} for one in found]
    return Uncertain(key, key.removeprefix(f"{phase}."), (kept[0], kept[1]), (ends[0], ends[1]), "told")


def ends(ranges: Sequence[Uncertain]) -> list[tuple[Uncertain, Sample]]:
    """A run at either end of each, the others as they are; of a choice at what is not the scene's own."""
    return [
        (one, Sample(f"{one.label} {text}", dict(end)))
        for one in ranges
        for end, text in zip(one.ends, one.labels, strict=True)
        if one.smooth or end is one.ends[1]
    ]


def at_random(ranges: Sequence[Uncertain], count: int) -> list[Sample]:
    """So many runs with all of them at random, evenly spread in each value (a Latin hypercube)."""
    from scipy.stats import qmc

    if not ranges or not count:
        return []
    cube = qmc.LatinHypercube(len(ranges), rng=np.random.default_rng(SEED)).random(count)
    found = []
    for number, shares in enumerate(cube.tolist()):
        values: dict[str, float] = {}
        for one, share in zip(ranges, shares, strict=True):
            if one.smooth or share >= 0.5:  # several values of one choice: the last that is drawn
                values |= one.at(share)
        found.append(Sample(f"at random, {number + 1}", values))
    return found
