"""How far off each setting is, and how sure that is.

Errors are counted from the finest setting of an axis, its reference. The reference is judged by a second opinion: the
finest setting of another family, a scheme of its own where there is one, else the next finer one. Below where these two
agree, and below what the scatter of chaotic runs lets be told, nothing is claimed: that is the floor.

    error  e = max_i |m_i - r_i| / s_i          m, r: means over the runs of setting and reference
    floor  f = max(agreement, 2 max_i sqrt(d_i^2/n + d_r,i^2/n_r) / s_i, b / min s_i)
           d: standard deviations, b: what the quantity is told to at best
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from dcone_cosim.accuracy.plan import PhasePlan, Planned
from dcone_cosim.accuracy.settings import Setting, judges
from dcone_cosim.accuracy.work import CPU, STEPS
from dcone_cosim.cases.rows import Row

Array = npt.NDArray[np.float64]

ROUNDING = 1e-12
"""Relative size below which a scatter is the rounding of its mean [1]."""
SIGMAS = 2.0
"""Standard errors below which a difference tells nothing."""
LEAST_FOR_ORDER = 3
"""Settings that an observed order is drawn from."""
ALIKE = 1.05
"""Ratio of two CPU times up to which they are told apart by nothing but noise."""
SMALL, CLEAR = 0.2, 4.0
"""An order is drawn from errors below the first, and above so many floors."""


@dataclass
class Sample:
    """What the runs of one setting gave.

    means, spreads    of each quantity, value by value; `about` is how it is told, `values` are those of every run
    cpu               median of the steps' CPU time [s]
    steps             median of the solver's steps; 0: its FMU tells of none
    failed            of those that did not come to an end, why
    """

    setting: Setting
    runs: int = 0
    cpu: float = math.nan
    steps: float = 0.0
    means: dict[str, Array] = field(default_factory=dict)
    spreads: dict[str, Array] = field(default_factory=dict)
    about: dict[str, Mapping[str, Any]] = field(default_factory=dict)
    failed: str = ""
    values: dict[str, Array] = field(default_factory=dict)


@dataclass
class Judged:
    """A setting with its errors [1] and floors [1], by quantity; `worst` is of those that an accuracy means.

    typical    floor of the settings of its axis [1]
    """

    sample: Sample
    errors: dict[str, float]
    floors: dict[str, float]
    worst: float
    floor: float
    typical: float = 0.0

    @property
    def setting(self) -> Setting:
        return self.sample.setting

    @property
    def bound(self) -> float:
        """What it errs by at most, as far as it can be told [1]."""
        return max(self.worst, self.floor, self.typical)


@dataclass
class Axis:
    """All settings of an axis.

    reference    its finest setting, `second` the one that judges it, with their agreement [1]
    orders       slope of the worst error over the size, by family, where it can be told
    here         what the scene as it is errs by along this axis
    scatter      standard deviation of one run, of the quantity that scatters most, and which that is [1]
    """

    name: str
    points: list[Judged]
    reference: Setting
    second: Setting | None
    agreement: float
    orders: dict[str, float]
    here: Judged
    scatter: tuple[float, str]

    @property
    def families(self) -> list[str]:
        return list(dict.fromkeys(point.setting.family for point in self.points))


@dataclass
class Report:
    """A phase, judged.

    failure    why nothing could be judged, "" if something could; then it has no axes
    """

    plan: PhasePlan
    axes: list[Axis]
    quantities: dict[str, Mapping[str, Any]]
    failure: str = ""

    @property
    def numerics(self) -> Axis:
        """The axis on which settings are chosen by what they cost."""
        return self.axes[0]

    @property
    def here(self) -> float:
        """What the scene as it is errs by, over all axes [1]."""
        return sum(axis.here.bound for axis in self.axes)


def judge(plan: PhasePlan, rows: Mapping[str, Row]) -> Report:
    """All axes of a phase."""
    base = sample_of(plan.base, rows)
    samples = [sample_of(planned, rows) for planned in plan.settings]
    names = list(dict.fromkeys(s.setting.axis for s in samples))
    axes = [_axis(name, [s for s in samples if s.setting.axis == name], base) for name in names]
    about: dict[str, Mapping[str, Any]] = {}
    for sample in samples:
        about |= {key: told for key, told in sample.about.items() if key not in about}
    judged = [axis for axis in axes if axis is not None]
    failures = [sample.failed for sample in (base, *samples) if sample.failed]
    return Report(plan, judged, about, "" if judged else next(iter(failures), "it is judged by nothing"))


def sample_of(planned: Planned, rows: Mapping[str, Row]) -> Sample:
    found = Sample(planned.setting)
    mine = [rows[key] for key in planned.keys]
    good = [row for row in mine if row.samples and row.status not in ("refused", "fault", "lost", "FMU failed")]
    found.failed = next((row.message or row.status for row in mine if row not in good), "")
    found.runs = len(good)
    if not good or found.failed:
        return found
    found.cpu = float(np.median([row.timings[CPU] for row in good]))
    found.steps = float(np.median([row.timings[STEPS] for row in good]))
    for key in dict.fromkeys(key for row in good for key in row.samples):
        told = [row.samples[key] for row in good if key in row.samples]
        longest = max(len(one["values"]) for one in told)
        values = np.array([one["values"] for one in told if len(one["values"]) == longest], dtype=float)
        found.values[key] = values
        found.means[key] = values.mean(axis=0)
        found.spreads[key] = values.std(axis=0, ddof=1) if len(values) > 1 else np.zeros(longest)
        found.about[key] = told[0]
    return found


def _axis(name: str, samples: list[Sample], base: Sample) -> Axis | None:
    able = [sample for sample in samples if sample.means]
    if not able:
        return None
    own = able[0].setting.family
    assert not able[0].setting.peer
    by_setting = {sample.setting: sample for sample in able}
    reference, *others = (by_setting[setting] for setting in judges(list(by_setting)))
    # of several schemes the one that agrees best
    second = min(others, key=lambda s: _judge(s, reference, {}).worst, default=None)
    compared = [_judge(sample, reference, {}) for sample in samples]
    between = _judge(second, reference, {}) if second is not None else None
    agreement = dict(between.errors) if between is not None else {}
    if second is not None and second.setting.family == own:
        # the next finer one of the same scheme: the reference is nearer than that
        agreement = {key: min(value, _shrunk(value, second, reference)) for key, value in agreement.items()}
    points = [_judge(one.sample, reference, agreement) for one in compared]
    here = _judge(base, reference, agreement)
    typical = float(np.median([p.floor for p in points if math.isfinite(p.worst) and not p.setting.peer] or [0.0]))
    for point in (*points, here):
        point.typical = typical
    orders = {family: _order([p for p in points if p.setting.family == family]) for family in _families(points)}
    told = {family: order for family, order in orders.items() if math.isfinite(order)}
    meant = _worst(agreement, reference)
    return Axis(
        name,
        points,
        reference.setting,
        second.setting if second is not None else None,
        meant,
        told,
        here,
        _scatter(reference),
    )


def scatters(sample: Sample) -> dict[str, float]:
    """Standard deviation of one run by quantity, where it is more than rounding [1]."""
    found = {}
    for key, spread in sample.spreads.items():
        scale = sample.about[key]["scale"]
        sizes = np.abs(sample.means[key]) if scale == 0.0 else np.full(len(spread), scale)
        there = np.isfinite(spread) & (sizes > 0.0)
        scatter = float((spread[there] / sizes[there]).max()) if there.any() else 0.0
        if scatter > ROUNDING:
            found[key] = scatter
    return found


def _scatter(reference: Sample) -> tuple[float, str]:
    about = reference.about
    told = [(s, str(about[key]["label"])) for key, s in scatters(reference).items() if about[key]["meant"]]
    return max(told, default=(0.0, ""))


def _families(points: Sequence[Judged]) -> list[str]:
    return list(dict.fromkeys(point.setting.family for point in points))


def _shrunk(value: float, second: Sample, reference: Sample) -> float:
    """What is left of a difference once it falls at first order at least."""
    ratio = reference.setting.size / second.setting.size
    return value * ratio / (1.0 - ratio) if ratio < 1.0 else value


def _judge(sample: Sample, reference: Sample, agreement: Mapping[str, float]) -> Judged:
    errors, floors = {}, {}
    for key in reference.means:
        if sample.setting.peer and sample.means and key not in sample.means:
            continue  # it knows nothing of that
        error, floor = error_of(sample, reference, key)
        if not math.isnan(error):
            errors[key] = error
            floors[key] = max(floor, agreement.get(key, 0.0), resolution_of(reference, key))
    if not sample.means:
        errors = dict.fromkeys(errors, math.inf)
    return Judged(sample, errors, floors, _worst(errors, reference), _worst(floors, reference))


def _worst(of: Mapping[str, float], reference: Sample) -> float:
    meant = [value for key, value in of.items() if reference.about[key]["meant"]]
    return max(meant or of.values(), default=math.nan)


def error_of(sample: Sample, reference: Sample, key: str) -> tuple[float, float]:
    """Error and floor of a quantity [1]; not a number where nothing can be compared."""
    own, ref = sample.means.get(key), reference.means[key]
    if own is None or len(own) < len(ref):
        return math.inf, 0.0
    own = own[: len(ref)]
    scale = reference.about[key]["scale"]
    sizes = np.abs(ref) if scale == 0.0 else np.full(len(ref), scale)
    both = np.isfinite(own) & np.isfinite(ref) & (sizes > 0.0)
    if not both.any():
        return math.nan, 0.0
    if _alike(sample, reference, key):
        return 0.0, 0.0
    # a single run scatters as those of the reference do
    spread = reference.spreads[key] if sample.runs == 1 else sample.spreads[key][: len(ref)]
    scatter = spread**2 / max(sample.runs, 1)
    scatter = scatter + reference.spreads[key] ** 2 / max(reference.runs, 1)
    error = np.abs(own - ref)[both] / sizes[both]
    return float(error.max()), float(SIGMAS * (np.sqrt(scatter[both]) / sizes[both]).max())


def _alike(sample: Sample, reference: Sample, key: str) -> bool:
    """Whether runs from the same starts come to the same, bit for bit: then no scatter hides a difference."""
    one, other = sample.values.get(key), reference.values.get(key)
    if one is None or other is None or len(one) != sample.runs or len(other) != reference.runs:
        return False
    count = min(len(one), len(other))
    return one.shape[1] == other.shape[1] and np.array_equal(one[:count], other[:count], equal_nan=True)


def resolution_of(sample: Sample, key: str) -> float:
    """What a quantity is told to at best, however it is computed [1]."""
    about = sample.about[key]
    best = float(about.get("resolution", 0.0))
    if best == 0.0:
        return 0.0
    sizes = np.abs(sample.means[key])
    scale = about["scale"] or float(sizes[sizes > 0.0].min(initial=math.inf))
    return best / float(scale)


def _order(points: Sequence[Judged]) -> float:
    """Slope of the worst error over the size, where both are clear of floor and coarseness."""
    clear = [p for p in points if math.isfinite(p.worst) and CLEAR * p.floor < p.worst < SMALL]
    if len(clear) < LEAST_FOR_ORDER:
        return math.nan
    slope = np.polyfit(np.log([p.setting.size for p in clear]), np.log([p.worst for p in clear]), 1)[0]
    return float(slope)


def own(points: Sequence[Judged]) -> list[Judged]:
    """Those of our models, of which everything is meant."""
    return [point for point in points if not (point.setting.peer or point.setting.partial)]


def better_peers(points: Sequence[Judged]) -> list[Judged]:
    """Settings of other programs that no setting of ours is as cheap and as exact as, costs within `ALIKE` being one;
    what is far off is no answer."""
    peers = [p for p in points if p.setting.peer and p.bound < SMALL]
    ours = own(points)
    return [p for p in peers if not any(q.bound <= p.bound and q.sample.cpu <= ALIKE * p.sample.cpu for q in ours)]


def front(points: Sequence[Judged]) -> list[Judged]:
    """Those than which none is both more exact and as cheap, the cheapest first; costs within `ALIKE` are one."""
    able = [p for p in points if math.isfinite(p.bound)]
    best = [p for p in able if not any(_beats(q, p) for q in able)]
    return sorted(best, key=lambda p: p.sample.cpu)


def _beats(one: Judged, other: Judged) -> bool:
    """Whether it is more exact at no more cost, or as exact at less."""
    costs, other_costs = one.sample.cpu, other.sample.cpu
    if one.bound < other.bound:
        return costs <= ALIKE * other_costs
    return one.bound == other.bound and ALIKE * costs < other_costs


def cheapest(points: Sequence[Judged], accuracy: float) -> Judged | None:
    """The one that costs least among those that are as accurate [1]; of those that cost alike the most exact."""
    able = [p for p in points if p.bound <= accuracy]
    least = min((p.sample.cpu for p in able), default=math.nan)
    alike = [p for p in able if p.sample.cpu <= ALIKE * least]
    return min(alike, key=lambda p: p.bound, default=None)
