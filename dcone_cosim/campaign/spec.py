"""What a campaign file says, once it has been read."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from dcone_cosim.scene.mistakes import Places
from dcone_cosim.scene.toml_lines import Path as KeyPath

MONTE_CARLO, HYPERCUBE, SOBOL, GRID, SALTELLI, ADAPTIVE, SUBSET = (
    *("monte-carlo", "latin-hypercube", "sobol", "grid", "saltelli", "adaptive", "subset"),
)
SAMPLERS = {
    MONTE_CARLO: "n independent cases",
    HYPERCUBE: "n cases, evenly spread in each value",
    SOBOL: "n cases of a scrambled Sobol sequence",
    GRID: "every value of each dispersion with every other",
    SALTELLI: "n (d + 2) cases for Sobol indices of d values",
    ADAPTIVE: "n cases over two or three values, put where the outcome changes",
    SUBSET: "n cases for each level of a rare failure",
}
RANDOM = (MONTE_CARLO, HYPERCUBE, SOBOL)
"""Those whose cases are samples of the dispersions, so that shares of them are probabilities."""


@dataclass(frozen=True)
class Dispersion:
    """A key whose value is uncertain.

    path           of its table in the file
    key            of the scene, perhaps with an element behind it, `capture.ejection.delay[2]`; or name of several keys
    distribution   a word of `distributions`
    told           its parameters as the file has them
    values         of a discrete one, as settings take them, or what they are called;  weights of these
    keys           that go together, each value having one for every key; none for `key` alone
    settings       of each value, where they are not those of `key` and its text
    points         of a grid
    together       correlation of the elements of a vector with one another [1]
    """

    path: KeyPath
    key: str
    distribution: str
    told: Mapping[str, Any] = field(default_factory=dict)
    values: Sequence[str] = ()
    weights: Sequence[float] = ()
    points: int = 0
    together: float = 0.0
    keys: tuple[str, ...] = ()
    settings: Sequence[tuple[str, ...]] = ()

    def settings_of(self, place: int) -> tuple[str, ...]:
        """What the command line would set for a value of a discrete one."""
        return self.settings[place] if self.settings else (f"{self.key}={self.values[place]}",)

    def design(self) -> list[Any]:
        """All that settles its numbers; plain data."""
        told = [self.key, self.distribution, dict(self.told), list(self.values), list(self.weights), self.points]
        return [*told, self.together, *([list(self.settings)] if self.settings else [])]


@dataclass(frozen=True)
class Correlation:
    """Two values whose normal scores are correlated [1]."""

    path: KeyPath
    between: tuple[str, str]
    coefficient: float


@dataclass(frozen=True)
class Until:
    """When a campaign has enough cases.

    confidence   of the interval of the probability [1]
    within       half its width at most [1]
    """

    confidence: float
    within: float
    text: str


@dataclass(frozen=True)
class Judged:
    """By what a case is judged beside what its phases say.

    too_near   a target that comes nearer to the chaser than this, from centre to centre, is too near [m]
    after      how long after the capture the target has to be in the net still [s]; infinite: to the end of the phase
    """

    too_near: float = 0.0
    after: float = math.inf

    def at_capture(self) -> Judged:
        return replace(self, after=0.0)


@dataclass(frozen=True)
class Success:
    """What counts as success: an outcome by its word, or a figure above or below a bound, SI, or both.

    unit       that the bound was given in; "1" for a bare number
    given      the bound as the file has it
    judged     when an outcome is judged, and what is too near
    said       whether the campaign's file says it
    margin     > 0 is success: the figure less the bound, or the bound less the figure
    """

    outcome: str = "captured"
    figure: str = ""
    bound: float = 0.0
    above: bool = True
    text: str = "captured"
    unit: str = "1"
    given: object = None
    said: bool = field(default=False, compare=False)
    judged: Judged = Judged()

    def margin(self, value: float) -> float:
        return value - self.bound if self.above else self.bound - value


@dataclass(frozen=True)
class Spec:
    """A campaign.

    places      where each key was written
    settings    of every case, as `--set` takes them
    most        cases at most, where `until` says when to end
    jitter      whether the solver's jitter is one of the inputs
    record      figures that are kept; empty: all of them. One that ends in "?" may be missing
    indices     figures whose sensitivities are told
    by          discrete dispersions for whose values, each combination of them, the answers are told as well
    factor_of_safety    of the diameter that a line would have to have
    """

    name: str
    title: str
    scene: str
    places: Places
    seed: int
    sampler: str
    n: int | None
    until: Until | None
    most: int
    jitter: bool
    record: tuple[str, ...]
    success: Success
    dispersions: tuple[Dispersion, ...]
    correlations: tuple[Correlation, ...]
    settings: tuple[str, ...]
    indices: tuple[str, ...]
    factor_of_safety: float
    by: tuple[str, ...] = ()

    @property
    def confidence(self) -> float:
        """Of every interval that is told."""
        return 0.95 if self.until is None else self.until.confidence

    @property
    def source(self) -> str:
        return self.places.source

    def design(self) -> dict[str, Any]:
        """All that settles which numbers a case of a certain number has; plain data."""
        told = [one.design() for one in self.dispersions]
        found: dict[str, Any] = {
            "sampler": self.sampler,
            "seed": self.seed,
            "jitter": self.jitter,
            "record": list(self.record),
            "dispersions": told,
            "correlations": [[*one.between, one.coefficient] for one in self.correlations],
        }
        if self.sampler not in (MONTE_CARLO, SOBOL, GRID):
            found["n"] = self.n
        if self.sampler in (ADAPTIVE, SUBSET):
            found["success"] = self.success.text
        return found
