"""The accuracy that a scene asks for: met, and shown to be met by runs of its own; or refused, with what would do.

What was measured of other scenes says where to begin. Each phase is then run with that setting and with another, a
chaotic one several times each, with jittered starts:

    error <= |difference| q,   q = r/(1 - r) of a coarser one, 1/(1 - r) of a finer one,   r = (finer/coarser size)^p

A step is compared with one twice as coarse (twice as fine where there is none), for errors that fall with its first
power at least, p = 1. With a tolerance errors fall as they will, not at all where something else holds the steps short,
so it is compared with the finest there is, for p = 1/2, and `TOLD` is added, by which schemes differ at their finest.
What a quantity is told to at best, and the bound that a level of detail keeps, are added. If all that is too much, the
next finer setting is tried.
What one run scatters no setting mends: its 95 % interval by Student's t is added to the error, and is brought down by
the mean of n runs where the scene allows so many. A phase that is not chaotic by nature is run once more from a start a
micrometre beside its own: where that comes to something else, it is taken for chaotic too.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

from dcone_cosim import build
from dcone_cosim.accuracy.judge import SIGMAS, Sample, error_of, resolution_of, sample_of, scatters
from dcone_cosim.accuracy.plan import Planned, Planner
from dcone_cosim.accuracy.settings import COUPLING, MACRO_STEP, NUMERICS, Setting, settings_of
from dcone_cosim.accuracy.show import percent
from dcone_cosim.accuracy.work import Measured, measure
from dcone_cosim.cases.alone import Alone
from dcone_cosim.cases.rows import Row
from dcone_cosim.cases.runner import Memory, Runner
from dcone_cosim.cases.workers import Workers, cores
from dcone_cosim.errors import FmuError, InputError
from dcone_cosim.loading import load
from dcone_cosim.progress import Progress
from dcone_cosim.quantities import BOUND
from dcone_cosim.results import Attained
from dcone_cosim.scene.data import Accuracy, PhaseScene, Scene

RUNS = 3
"""Of a chaotic phase with each of two settings."""
TOLD = 1e-8
"""What the finest tolerances err by themselves at most [1]: by other schemes, tests/accuracy/evidence/bounds.py."""
POWERS = {False: 1.0, True: 0.5}
"""With which errors fall at least, of steps and of tolerances [1]."""
APART = 1.9
"""Ratio of the sizes of two settings whose difference tells an error."""
RUNS_PARTED = 8
"""Of one that only a twin shows to be chaotic: it may take one of two courses, which few runs do not show."""
PARTED = 1e-5
"""Difference [1] from which on a twin has parted: a hundred times what a micrometre is to a line of ten metres."""
MARGIN = 1.3
"""More runs than the scatter asks for, which is known from few."""
Make = Callable[[Sequence[Planned], int], list[Sample]]
"""Runs each of some settings so many times."""


def as_asked(
    name: str, settings: Sequence[str], scene: Scene, isolate: bool | None, progress: Progress
) -> tuple[Scene, Mapping[str, Attained]]:
    """The scene with the settings that have the accuracy it asks for, if it does, and how exact each phase then is."""
    if scene.accuracy is None:
        return scene, {}
    changes, attained = attain(name, settings, scene, isolate, progress)
    return replace(scene, phases=load(name, [*settings, *changes], choose=False).isolating(isolate).phases), attained


@dataclass
class Ladder:
    """The settings of an axis, coarse to fine, and which of them is chosen."""

    axis: str
    settings: list[Setting]
    place: int

    @property
    def here(self) -> Setting:
        return self.settings[self.place]

    @property
    def partner(self) -> Setting | None:
        """The finest tolerance, of that itself the next; of steps the nearest that is twice as coarse, or as fine."""
        size = self.here.size
        if self.here.tolerance:
            others = [s for s in self.settings if s is not self.here]
            return min(others, key=lambda s: s.size, default=None)
        coarser = [s for s in self.settings if s.size >= APART * size]
        finer = [s for s in self.settings if s.size * APART <= size]
        return min(coarser, key=lambda s: s.size, default=max(finer, key=lambda s: s.size, default=None))


@dataclass
class Estimate:
    """By quantity: error [1], what of it no setting mends [1], standard deviation of one run [1], how much of the error
    may be chance [1], how it is called, and mean, standard deviation and unit of those that are one number."""

    errors: dict[str, float] = field(default_factory=dict)
    lasting: dict[str, float] = field(default_factory=dict)
    scatters: dict[str, float] = field(default_factory=dict)
    noises: dict[str, float] = field(default_factory=dict)
    labels: dict[str, str] = field(default_factory=dict)
    means: dict[str, tuple[str, float, float, str]] = field(default_factory=dict)
    made: int = 1

    def add(self, other: Estimate) -> None:
        """Of another axis: errors add up."""
        for key, error in other.errors.items():
            self.errors[key] = self.errors.get(key, 0.0) + error
        for key, least in other.lasting.items():
            self.lasting[key] = max(self.lasting.get(key, 0.0), least)
        self.scatters |= other.scatters
        self.noises |= other.noises
        self.labels |= other.labels
        self.means |= other.means
        self.made = max(self.made, other.made)

    def of_mean(self, key: str, runs: int) -> float:
        """What the mean of so many runs errs by [1]."""
        scatter = self.scatters.get(key, 0.0)
        if scatter == 0.0:
            return self.of_setting(key)
        return self.of_setting(key) + student(2 * (self.made - 1)) * scatter / math.sqrt(runs)

    def of_setting(self, key: str) -> float:
        """What it errs by without the scatter [1]."""
        return self.errors.get(key, 0.0) + self.lasting.get(key, 0.0)

    def worst(self, runs: int) -> str:
        return max(self.errors, key=lambda key: self.of_mean(key, runs))


def student(degrees: int) -> float:
    """Standard deviations, known to so many degrees of freedom, within which 95 % lie [1]: 2.8 of 4, 2.0 of 60."""
    from scipy.special import stdtrit

    return float(stdtrit(degrees, 0.975))


def attain(
    name: str, settings: Sequence[str], scene: Scene, isolate: bool | None, progress: Progress
) -> tuple[list[str], dict[str, Attained]]:
    """Settings of a scene that meet its accuracy, and how exact each phase is with them; `InputError` if none does.

    name, settings    with which the scene was loaded
    """
    assert scene.accuracy is not None
    changes = [change for phase in scene.phases if phase.chosen is not None for change in phase.chosen.changes]
    found: dict[str, Attained] = {}
    with Workers(cores()) as workers:
        for place, phase in enumerate(scene.phases):
            alone = Alone(name, [*settings, *changes], isolate, choose=False)
            if place:
                alone.begin(progress)
            attempt = _Attempt(alone, phase.name, scene.accuracy, workers, progress)
            more, found[phase.name] = attempt.attained()
            changes += more
    return changes, found


class _Attempt:
    """One phase, with the settings that were found for those before it."""

    def __init__(self, alone: Alone, phase: str, accuracy: Accuracy, workers: Workers, progress: Progress) -> None:
        self._phase, self._accuracy, self._progress = phase, accuracy, progress
        self._planner = Planner(alone, phase, progress)
        self._ladders = _ladders(self._planner.own)
        self._made: set[str] = set()
        self._few = RUNS
        self._runner = Runner(Memory(), workers, 2 * cores(), measure)

    def attained(self) -> tuple[list[str], Attained]:
        """Settings of the phase, beside those that the scene has already, and how exact it is with them."""
        asked = self._accuracy.asked
        if not self._ladders:
            return [], Attained(asked, "as it is", math.nan, "", 0.0, "")
        begun = [ladder.place for ladder in self._ladders]
        if not self._planner.chaotic and self._parts():
            self._planner.chaotic, self._few = True, RUNS_PARTED
        told, runs = self._refined(), 1
        scatter, noisy = max(((s, told.labels.get(k, "")) for k, s in told.scatters.items()), default=(0.0, ""))
        while told.of_mean(told.worst(runs), runs) > asked:
            # half of what is asked is left to the scatter of the mean
            needed = max(
                math.ceil(MARGIN * (2.0 * SIGMAS * scatter / asked) ** 2), self._few + 1, math.ceil(1.5 * runs)
            )
            if needed > self._accuracy.runs:
                raise InputError(self._beyond(scatter, noisy, needed))
            told, runs = self._estimate(needed), needed
        steps = zip(self._ladders, begun, strict=True)
        changes = [change for ladder, place in steps if ladder.place != place for change in ladder.here.changes]
        label, key = "; ".join(ladder.here.label for ladder in self._ladders), told.worst(runs)
        error, what = told.of_mean(key, runs), told.labels[key]
        means = told.means if runs > 1 else {}
        return changes, Attained(asked, label, error, what, scatter, noisy, runs, means, len(self._made))

    def _parts(self) -> bool:
        """Whether a twin that begins a micrometre beside it comes to something else: then a single run is a sample."""
        here, beside = (_with([change for one in self._ladders for change in one.here.changes], None) for _ in range(2))
        try:
            twin = self._planner.twin(beside)
        except InputError:
            return False  # nothing to move
        samples = self._of([here, beside], self._planner.cases(here, 1) | twin)
        keys = [key for key, about in samples[0].about.items() if self._counts(key, about["meant"])]
        apart = [error_of(samples[1], samples[0], key)[0] for key in keys]
        return max((one for one in apart if not math.isnan(one)), default=0.0) > PARTED

    def _beyond(self, scatter: float, noisy: str, needed: int) -> str:
        """Why one run, or as many as are allowed, cannot tell it."""
        allowed = self._accuracy.runs
        few = "one run" if allowed == 1 else f"the {allowed} runs that solver.runs allows"
        return (
            f"solver.accuracy = {percent(self._accuracy.asked)} is more than {few} can tell\n"
            f"  {self._phase}: {noisy} scatters by {percent(scatter)} (standard deviation) from run to run, whatever "
            f"the step; the mean of about {needed:,} runs would do: allow them with solver.runs, or name other "
            "quantities in solver.quantities"
        )

    def _at_best(self, told: Estimate, best: float) -> str:
        """Why no setting can tell it."""
        names = " and ".join(told.labels[key] for key, least in told.lasting.items() if least == best)
        return (
            f"solver.accuracy = {percent(self._accuracy.asked)} is more than any setting can tell\n  {self._phase}: "
            f"{names} is told to {percent(best)} at best; ask for that, or name other quantities in solver.quantities"
        )

    def _estimate(self, runs: int) -> Estimate:
        """Errors of all axes together."""
        told = Estimate()
        for ladder in self._ladders:
            told.add(self._axis(ladder, runs))
        return told

    def _refined(self) -> Estimate:
        """The estimate with settings fine enough that only scatter is left to be too much."""
        asked = self._accuracy.asked
        while True:
            axes = {ladder.axis: self._axis(ladder, self._few) for ladder in self._ladders}
            told = Estimate()
            for estimate in axes.values():
                told.add(estimate)
            if not told.errors:
                raise InputError(f"{self._phase}: it has none of {', '.join(self._accuracy.quantities)}")
            if (best := max(told.lasting.values(), default=0.0)) > asked:
                raise InputError(self._at_best(told, best))
            key = max(told.errors, key=told.of_setting)
            error, noise = told.of_setting(key), told.noises.get(key, 0.0)
            if error <= max(asked, noise):
                return told
            worst = max(self._ladders, key=lambda ladder: axes[ladder.axis].errors.get(key, 0.0))
            if worst.place + 1 >= len(worst.settings):
                raise InputError(
                    f"solver.accuracy = {percent(asked)} cannot be met\n  {self._phase}: {told.labels[key]} errs by "
                    f"{percent(error)} with the finest setting there is, {worst.here.label}"
                )
            worst.place += 1
            self._progress.say(f"{self._phase}: {told.labels[key]} {percent(error)} off; trying {worst.here.label}")

    def _axis(self, ladder: Ladder, runs: int) -> Estimate:
        """Errors along one axis, with the others as they are chosen, from so many runs of each of two settings."""
        partner = ladder.partner
        if partner is None:
            return Estimate()
        rest = [change for other in self._ladders if other is not ladder for change in other.here.changes]
        here, there = self._run([_with(rest, ladder.here), _with(rest, partner)], runs if self._planner.chaotic else 1)
        sizes, tolerance = (partner.size, ladder.here.size), ladder.here.tolerance
        ratio = (min(sizes) / max(sizes)) ** POWERS[tolerance]
        factor = (ratio if partner.size > ladder.here.size else 1.0) / (1.0 - ratio)
        least = TOLD if tolerance else 0.0
        bound = float(here.means[BOUND][0]) if tolerance and BOUND in here.means else 0.0
        told = Estimate(made=min(here.runs, there.runs))
        own, other = scatters(here), scatters(there)
        for key, about in {**there.about, **here.about}.items():
            error = _apart(here, there, key) * factor if self._counts(key, about["meant"]) else math.nan
            if math.isnan(error):
                continue
            told.errors[key], told.labels[key] = error + bound, str(about["label"])
            if key not in here.means:
                continue
            told.lasting[key] = least + resolution_of(here, key)
            if own.get(key, 0.0) > 0.0:
                scatter = math.sqrt(0.5 * (own[key] ** 2 + other.get(key, own[key]) ** 2))
                told.scatters[key], told.noises[key] = scatter, SIGMAS * scatter * math.sqrt(2.0 / runs) * factor
            if len(here.means[key]) == 1:
                mean, spread = float(here.means[key][0]), float(here.spreads[key][0])
                told.means[key] = (told.labels[key], mean, spread, str(about["unit"]))
        return told

    def _counts(self, key: str, meant: bool) -> bool:
        names = self._accuracy.quantities
        return key in names if names else meant

    def _run(self, planned: Sequence[Planned], runs: int) -> list[Sample]:
        cases: dict[str, Measured] = {}
        for one in planned:
            cases |= self._planner.cases(one, runs)
        return self._of(planned, cases)

    def _of(self, planned: Sequence[Planned], cases: Mapping[str, Measured]) -> list[Sample]:
        """What these cases of some settings come to."""
        self._progress.say(f"{self._phase}: {len(cases)} runs for the estimate of its error")
        self._made |= cases.keys()
        rows: dict[str, Row] = {row.key: row for row, _ in self._runner.rows(cases.values())}
        samples = [sample_of(one, rows) for one in planned]
        for sample in samples:
            if sample.failed:
                raise FmuError(f"{self._phase}, run for the estimate of its error: {sample.failed}")
        return samples


def _apart(here: Sample, there: Sample, key: str) -> float:
    """Difference of a quantity [1]; infinite where one of them lacks it or has less of it, as a tug less."""
    if key not in here.means or key not in there.means or len(here.means[key]) != len(there.means[key]):
        return math.inf
    return error_of(there, here, key)[0]


def _with(rest: Sequence[str], setting: Setting | None) -> Planned:
    own = setting if setting is not None else Setting("", "", 1.0, ())
    return Planned(Setting(own.axis, own.family, own.size, (*rest, *own.changes)))


def _ladders(phase: PhaseScene) -> list[Ladder]:
    """The axes along which a phase is refined: that of its model, or its macro step; and its coupling step."""
    settings = settings_of(phase, False, [])
    axes = {axis: [s for s in settings if s.axis == axis] for axis in dict.fromkeys(s.axis for s in settings)}
    if NUMERICS in axes or COUPLING in axes:
        axes.pop(MACRO_STEP, None)
    found = []
    for axis, of in axes.items():
        family = [s for s in of if s.family == of[0].family]
        if axis == NUMERICS and phase.main.terms.keys() & set(build.details(phase.main.model)):
            family.pop()  # for references: it leaves a level of detail nothing, and follows all
        found.append(Ladder(axis, family, _place(family, phase)))
    return found


def _place(settings: Sequence[Setting], phase: PhaseScene) -> int:
    """Which of them the phase has; the default one, or the nearest to it, if it has none of theirs."""
    for place, setting in enumerate(settings):
        told: Mapping[str, str] = dict(change.split("=", 1) for change in setting.changes)
        own = {key: phase.setting(key.partition(".")[2]) for key in told}
        numbers = {key: float(text.split()[0]) for key, text in told.items()}
        if told and all(math.isclose(own[k] or 0.0, v, rel_tol=1e-4) for k, v in numbers.items()):
            return place
    return min(range(len(settings)), key=lambda i: abs(math.log(settings[i].size)))
