"""How thick the line has to be, of each material: a fixed point, since a thicker line snaps harder.

    in closed form   A = F^2 g^2 v^2 E m / (l sigma^2) + 2 F P / sigma, at the speed of the hardest tug
    by simulation    the diameter d at which F times the simulated peak of a line of that diameter is sigma pi d^2/4

The second is sought between two diameters, one too thin and one thick enough, in logarithms of both; the first is where
it begins. What is told is the thick end, and a run at it.

Checked  tests/sizing/test_fixed_point.py
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

from dcone_cosim.sizing.chaser import Asked
from dcone_cosim.sizing.ground import Ground, Values, stiffness, why
from orbital import tethers
from orbital.materials import Material

CLOSE = 0.005
"""Share to which the diameter is found [1]."""
ROUNDS = 14
"""Most that it may take."""
PATIENCE = 5
"""Runs after which the bracket is halved: where bounces change, the peak jumps with the diameter."""
APART = 1.25
"""Factor of the first steps outwards."""
JUMP = 0.02
"""Margin left at the fixed point from which on the peak is said to jump there [1]."""
THINNEST, THICKEST = 1e-6, 0.2
"""Diameters that are tried [m]."""
LINE, MODULUS = "tether.diameter", "tether.youngs_modulus"


@dataclass
class Search:
    """The search for one material.

    samples    values of the runs that count, beside the material's: the hardest of all that were made
    thin, thick   diameters [m] known to be too thin, and thick enough, each with log of capacity over demand
    """

    material: Material
    samples: Sequence[Values]
    start: float
    thin: tuple[float, float] | None = None
    thick: tuple[float, float] | None = None
    peak: float = math.nan
    failed: str = ""
    tried: list[tuple[float, float]] = field(default_factory=list)

    @property
    def done(self) -> bool:
        if self.failed:
            return True
        return self.thin is not None and self.thick is not None and self.thick[0] / self.thin[0] < 1.0 + CLOSE

    def next(self) -> float:
        """The diameter to try."""
        if self.thin is None and self.thick is None:
            return self.start
        if (
            self.thin is None or self.thick is None
        ):  # a snap grows with the diameter, and what a line bears with its square
            end = self.thin or self.thick
            assert end is not None
            step = math.exp(abs(end[1])) * (1.0 + CLOSE) * APART ** (len(self.tried) // 3)
            return end[0] * step if self.thick is None else end[0] / step
        (a, ya), (b, yb) = self.thin, self.thick
        width = math.log(b / a)
        if len(self.tried) >= PATIENCE:
            return a * math.exp(0.5 * width)
        share = ya / (ya - yb)  # where a straight line in logarithms meets zero
        beyond = min(0.25, 0.3 * CLOSE / width)  # so that the next run closes in from the other side
        share += beyond if abs(yb) < abs(ya) else -beyond
        return a * math.exp(min(max(share, 0.02), 0.98) * width)

    def take(self, diameter: float, peak: float, factor: float) -> None:
        """What the runs at a diameter came to, their largest tension [N]."""
        capacity = self.material.breaking_load(diameter)
        assert capacity is not None
        surplus = math.log(capacity / (factor * peak)) if peak > 0.0 else math.inf
        self.tried.append((diameter, peak))
        if surplus >= 0.0:
            if self.thick is None or diameter < self.thick[0]:
                self.thick, self.peak = (diameter, surplus), peak
                if self.thin is not None and self.thin[0] >= diameter:
                    self.thin = None
        elif self.thin is None or diameter > self.thin[0]:
            self.thin = (diameter, surplus)
            if self.thick is not None and self.thick[0] <= diameter:
                self.thick, self.peak = None, math.nan
        if not THINNEST < diameter < THICKEST:
            self.failed = f"no diameter from {THINNEST:g} to {THICKEST:g} m is just thick enough"


@dataclass(frozen=True)
class Snap:
    """A tug as the closed form takes it, SI: of which run, the speed at impact, the mass that it moves, the preload,
    the damped share of a snap, the line's length and E, and the diameter that bears it."""

    run: str
    speed: float
    mass: float
    preload: float
    share: float
    length: float
    youngs_modulus: float
    diameter: float

    def told(self, factor: float, strength: float) -> list[Asked]:
        """Each number of the closed form, and what it is for."""
        return [
            Asked("factor of safety, S", factor, "1", "[sizing] factor_of_safety"),
            Asked("strength of the line, sigma", strength, "Pa", "of the scene's material"),
            Asked("speed at impact, v", self.speed, "m/s", f"hardest tug of: {self.run}"),
            Asked("mass that it moves, m_r", self.mass, "kg", "from peak and speed of that tug"),
            Asked("tension it meets, P", self.preload, "N", "without tugs"),
            Asked("damped share of a snap, g", self.share, "1", "from tether.damping_ratio"),
            Asked("length of the line, l", self.length, "m", "tether.rest_length of that run"),
            Asked("stiffness of the line, E", self.youngs_modulus, "Pa", "of that run"),
            Asked("diameter", self.diameter, "m", "A = (S g v / sigma)^2 E m_r / l + 2 S P / sigma, pi d^2/4 = A"),
        ]


@dataclass(frozen=True)
class Required:
    """What a material needs.

    closed     diameter in closed form [m]
    diameter   by simulation [m], the largest tension at it [N]; NaN where it was not found
    mass       of the line at that diameter [kg]
    margin     of the run at that diameter, over the factor of safety [1]
    fixed      diameter that the peak of the scene's own line would ask for [m]: wrong, as the peak is not that of this
               line
    snap       what the closed form was made of, None where there is no tug
    """

    material: Material
    closed: float
    diameter: float
    peak: float
    mass: float
    margin: float
    fixed: float
    runs: int
    note: str = ""
    snap: Snap | None = None


def in_closed_form(
    own: Values,
    sample: Values,
    tug: tuple[float, float, float],
    steady: float,
    material: Material,
    safety: float,
    label: str = "",
) -> Snap:
    """A line of a material that bears this tug: time [s], peak [N] and speed [m/s] on the line of a run of that label.

    own, sample    values of the scene, and of the run beside them; its shares of diameter and stiffness apply to the
                   material's line too

    The mass that the tug moves follows from its peak, so that a target that turns counts with less than all of it.
    """
    assert material.strength is not None
    values = {**own, **sample}
    share = tethers.impact_share(values["tether.damping_ratio"])
    _, peak, speed = tug
    length = values["tether.rest_length"]
    k = stiffness(values)
    impact = max(peak * peak - 2.0 * peak * steady, 0.0)  # g^2 k m v^2 of T = P + sqrt(P^2 + g^2 k m v^2)
    mass = impact / (k * (share * speed) ** 2) if speed else 0.0
    softer = material.youngs_modulus * values[MODULUS] / own[MODULUS] * (values[LINE] / own[LINE]) ** 2
    area = tethers.snap_section(abs(speed), mass, length, softer, material.strength, safety, steady, share)
    return Snap(label, abs(speed), mass, steady, share, length, softer, tethers.diameter_of(area))


def at(
    ground: Ground, material: Material, diameter: float, samples: Sequence[Values], safety: float
) -> tuple[float, float]:
    """Largest tension [N] of these runs on a line of a diameter [m], and the margin of safety it leaves; NaN where one
    does not come to its end."""
    runs = list(ground.run([ground.case(_values(ground, material, diameter, s)) for s in samples], "what governs"))
    peak = math.nan if any(math.isnan(run.peak) for run in runs) else max(run.peak for run in runs)
    load = material.breaking_load(diameter)
    assert load is not None
    return peak, load / (safety * peak) - 1.0


def search(
    ground: Ground, materials: Sequence[tuple[Material, float]], samples: Sequence[Values], safety: float
) -> list[Search]:
    """Seek the diameter of every material at once, a round of runs for all of them at a time.

    materials   with the diameter to begin at [m]
    samples     values beside the scene's of the runs that count; a share of diameter or stiffness among them applies
                to the material's
    """
    searches = [Search(material, samples, start) for material, start in materials]
    for number in range(ROUNDS):
        going = [one for one in searches if not one.done]
        if not going:
            break
        diameters = [one.next() for one in going]
        cases = [
            ground.case(_values(ground, one.material, diameter, sample))
            for one, diameter in zip(going, diameters, strict=True)
            for sample in samples
        ]
        runs = list(ground.run(cases, f"diameters, round {number + 1}"))
        for i, (one, diameter) in enumerate(zip(going, diameters, strict=True)):
            of = runs[i * len(samples) : (i + 1) * len(samples)]
            bad = next((run for run in of if math.isnan(run.peak)), None)
            if bad is not None:
                one.failed = why(bad.row)
                continue
            one.take(diameter, max(run.peak for run in of), safety)
    return searches


def _values(ground: Ground, material: Material, diameter: float, sample: Values) -> dict[str, float]:
    """Values of a run with a line of a material and diameter; the sample's share of either applies to it."""
    own = ground.values
    shares = {name: sample.get(name, own[name]) / own[name] for name in (LINE, MODULUS)}
    return {
        **sample,
        LINE: diameter * shares[LINE],
        MODULUS: material.youngs_modulus * shares[MODULUS],
    }


def result(one: Search, snap: Snap | None, fixed: float, length: float, safety: float) -> Required:
    """What a search came to."""
    material, closed = one.material, math.nan if snap is None else snap.diameter
    if one.failed or one.thick is None:
        nan = math.nan
        return Required(material, closed, nan, nan, nan, nan, fixed, len(one.tried), one.failed or "not found", snap)
    diameter = one.thick[0]
    load = material.breaking_load(diameter)
    assert load is not None
    mass, margin = material.mass_per_metre(diameter) * length, load / (safety * one.peak) - 1.0
    note = "the peak jumps here with the diameter" if margin > JUMP else ""
    return Required(material, closed, diameter, one.peak, mass, margin, fixed, len(one.tried), note, snap)
