"""What the program asks of a kind of phase. `Phase` itself is the plainest: any system, stepped and recorded.

A kind is one module of this package with a `PHASE`, an instance of a class that says here what is its own. The scene's
keys and checks, the master, the summary and the figures ask the kind; none of them knows a phase by its name.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

from dcone_cosim.contract import FAILED_OUTCOMES, NEVER, OUTCOMES, Need
from dcone_cosim.criteria import Criterion, Evidence, finite
from dcone_cosim.events import Event
from dcone_cosim.findings import Finding
from dcone_cosim.fmu.component import Steppable
from dcone_cosim.phases.stepping import PhaseLoop
from dcone_cosim.progress import Progress
from dcone_cosim.quantities import Quantity, at
from dcone_cosim.results import Begun, Handover, PhaseResult, RunResult
from dcone_cosim.scene.data import PhaseScene, Scene
from dcone_cosim.scene.expected import Expected
from dcone_cosim.scene.mistakes import Mistake
from dcone_cosim.scene.toml_lines import Path as KeyPath
from dcone_cosim.scenery import Chart, Clip
from dcone_cosim.states import Keeper, KeptState

Figure = tuple[str, Callable[[Path], object]]
"""File name, and what draws it there."""
Instantiate = Callable[[str, str], Steppable]
"""`instantiate(phase, name)` makes a component of that phase's FMU."""
Adopt = Callable[[PhaseScene], None]
"""`adopt(phase)` makes ready for a phase with other FMUs than its scene has for it."""

LEAST_RANGE = 1e-9
"""Share of an output's size below which its range is rounding."""
MOST_OUTPUTS = 12
"""Outputs of a plain phase that the summary shows; all are in its columns."""


class Loop(Protocol):
    """Steps a component through its phase."""

    result: PhaseResult
    keeper: Keeper | None

    def take_up(self, state: KeptState, earlier: PhaseResult, changed: Mapping[str, float]) -> None:
        """Go on from a kept state, with other values of some variables from there on, SI."""

    def run(self) -> PhaseResult: ...


class Main(Protocol):
    """The main component of a phase while its scene is read: a file or a model of ours with terms, its variables, and
    where the scene gives a value."""

    @property
    def fmu(self) -> Path | None: ...
    @property
    def terms(self) -> Mapping[str, str]: ...
    @property
    def slots(self) -> Mapping[str, Any]: ...
    @property
    def given(self) -> Mapping[str, KeyPath]: ...


@dataclass(frozen=True)
class Document:
    """A scene that is being read: its tables, the main components of its phases, and which phases are to be run."""

    tables: Mapping[str, Any]
    mains: Mapping[str, Main]
    chosen: Sequence[str]

    def before(self, phase: str) -> str:
        """The phase that hands over to this one; "" for none."""
        place = self.chosen.index(phase) if phase in self.chosen else 0
        return self.chosen[place - 1] if place else ""

    def after(self, phase: str) -> str:
        """The phase that this one hands over to; "" for none."""
        rest = self.chosen[self.chosen.index(phase) + 1 :] if phase in self.chosen else ()
        return rest[0] if rest else ""


@dataclass(frozen=True)
class Options:
    """Options of a phase that has none."""


@dataclass(frozen=True)
class Stage:
    """A phase on its turn.

    before, after   the phases that hand over to it and that it hands over to, None for none
    keeper          of states on the way, None where none is to be kept
    begun           what the run goes on from, where that is a state of this phase
    later           phases that may come after it, in their order
    tables          whether its rows are kept: without that only its figures are wanted
    """

    run: RunResult
    phase: PhaseScene
    before: PhaseScene | None
    after: PhaseScene | None
    instantiate: Instantiate
    progress: Progress
    keeper: Keeper | None = None
    begun: Begun | None = None
    later: Sequence[PhaseScene] = ()
    tables: bool = True

    def next_of(self, result: PhaseResult) -> PhaseScene | None:
        """The phase that takes over what this one came to, None for none: after a failure one that tries again."""
        from dcone_cosim.phases import kind_of

        return next((one for one in self.later if kind_of(one.name).retries == failed(result)), None)


def failed(result: PhaseResult) -> bool:
    """Whether a phase did not come to what it is for, so that one like it may try again."""
    return result.located is None and result.outcome in (*FAILED_OUTCOMES, OUTCOMES[0])


class Phase:
    """A kind of phase.

    name           of its table in a scene, and of its columns in a run folder; "" for a system by its own name
    model          of ours that is built for it, "" for none
    follows        kinds that can hand over to it
    alone          whether it can be the first of a scene
    keys           of its table that concern the master, beside `macro_step` and `duration`
    handoff_keys   of the table [handoff], how it takes over
    handoff_gone   keys that it had, and what there is in their place
    examples       values of `macro_step` and `duration`, for advice
    wanted         variables that the master looks for in its FMU, by what they are needed for
    recognised_by  variables by which a component of a package is taken for the main one of such a phase
    takes          outputs and parameters of the phase before that it takes over, by name
    takes_too      the same, of those that the phase before may lack
    taken_over     names of parameters that a hand-over to it sets; one that ends in a dot stands for a whole table
    retries        it takes over from a phase that has failed, and is left out where none has
    begins_at_zero whether its FMU has to be told to begin at 0
    own_clock      its times count from its begin, whatever time its FMU is told
    tugs_file      name of the table of its tugs
    prefix         before the names of its pictures and of the tables of its net
    keeps_nodes    the positions of a net's knots are kept of it
    chaotic        its figures are samples: they part company however small a change is
    judged_by      names of its quantities; none: those of its outputs
    to_its_end     settings of its table with which it goes on to its end, whatever comes of it
    """

    name = ""
    model = ""
    follows: Sequence[str] = ()
    alone = True
    keys: Mapping[str, Expected] = {}
    handoff_keys: Mapping[str, Expected] = {}
    handoff_gone: Mapping[str, str] = {}
    examples = ("0.1 s", "30 s")
    wanted: Sequence[tuple[Need, Sequence[str]]] = ()
    recognised_by: Sequence[str] = ()
    takes: Sequence[str] = ()
    takes_too: Sequence[str] = ()
    taken_over: Sequence[str] = ()
    retries = False
    begins_at_zero = False
    own_clock = False
    tugs_file = "tugs"
    prefix = ""
    keeps_nodes = False
    chaotic = False
    judged_by: Sequence[str] = ()
    to_its_end: Sequence[str] = ()

    # the scene

    def options(self, found: Mapping[str, Any], main: Main | None) -> Any:
        """The options of a phase, from those of its `keys` that are told; `main` None where it is not known."""
        return Options()

    def hand_over(self, options: Any) -> str:
        """What ends the phase and begins the next, one of `contract.HAND_OVER`."""
        return NEVER

    def faults(self, document: Document) -> Iterator[Mistake]:
        """Keys of a scene that do not go together, before any value is looked at."""
        yield from ()

    def value_faults(self, before: PhaseScene | None, own: PhaseScene, tables: Mapping[str, Any]) -> Iterator[Mistake]:
        """Values, each well formed, that do not go together."""
        yield from ()

    def joined(self, before: PhaseScene, own: PhaseScene) -> tuple[PhaseScene, PhaseScene]:
        """Both with what one tells and the other leaves to it."""
        return before, own

    def notes(self, offered: Mapping[str, Any]) -> Sequence[str]:
        """What is to be said beforehand of a hand-over to an FMU that offers these variables."""
        return ()

    def cautions(self, before: PhaseScene | None, own: PhaseScene) -> Iterator[str]:
        """What a hand-over between such phases means that its user may not expect."""
        yield from ()

    def by_itself(self, own: PhaseScene) -> PhaseScene:
        """A phase that hands over, as it is when another tool runs it alone."""
        return own

    def takes_over(self, variable: str) -> bool:
        """Whether a hand-over to it sets this parameter."""
        name = variable.partition("[")[0]
        return any(name == own or (own.endswith(".") and name.startswith(own)) for own in self.taken_over)

    def values_taken(self, before: PhaseScene) -> dict[str, float]:
        """Parameters that are known before the run to be handed over, SI."""
        return {}

    # the run

    def take_over(self, stage: Stage) -> Handover | None:
        """What the phase before has left, checked; `HandoffError` if the phase cannot carry it.

        None where no other phase comes before. It is among the run's handovers even when it is refused.
        """
        return None

    def loop(self, stage: Stage, component: Steppable, start: float) -> Loop:
        """What steps the phase from `start`, the time that its FMU is told to begin at [s]."""
        phase = stage.phase
        origin = start if self.own_clock else 0.0
        stepped = self.stepped_by(stage, component)
        return stepped(component, phase.macro_step, start, phase.duration, stage.progress, origin)

    def stepped_by(self, stage: Stage, component: Steppable) -> type[PhaseLoop]:
        """The kind of its loop."""
        return PhaseLoop

    def judge(self, stage: Stage, result: PhaseResult) -> None:
        """Let the run fail if the phase did not come to what the next one needs."""

    def probe(self, stage: Stage, component: Steppable, result: PhaseResult) -> dict[str, float]:
        """What is found out of the FMU of the phase before, `stage`, when all else has been read of it, which may be
        stepped for that; `HandoffError` where it shows nothing."""
        return {}

    def leaves(self, run: RunResult, phase: PhaseScene, left: Mapping[str, float]) -> dict[str, float]:
        """What the next phase asked for, as it was read from the FMU, in the frame that the next one knows."""
        return dict(left)

    def afterwards(self, stage: Stage, result: PhaseResult) -> None:
        """What else is to be run once the phase is over and its FMU closed."""

    # the reports

    def clock(self, run: RunResult) -> str:
        """What its times count from, in words."""
        return "time of the phase's FMU" if not self.own_clock else f"since the {self.spoken} began"

    @property
    def spoken(self) -> str:
        """Its name in a sentence."""
        return self.name.replace("_", " ")

    def findings(self, run: RunResult, result: PhaseResult) -> Iterator[Finding]:
        """What the summary tells of it: a phase that nothing is known of by its outputs."""
        name = next(name for name, its in run.phases.items() if its is result)
        yield Finding(name, "simulated", "simulated", result.end - result.start, "s")
        recorder = result.recorder
        if not len(recorder):
            return
        last = recorder.last()
        for output in [key for key in last if key != "time"][:MOST_OUTPUTS]:
            unit = recorder.units[output]
            yield Finding(name, output, f"{output} at the end", last[output], "" if unit == "1" else unit)

    def events(self, run: RunResult, result: PhaseResult) -> Iterator[Event]:
        """What happened in it, in the order of its own time."""
        found = [Event(result.name, "begins", result.start), *self.own_events(result)]
        found.append(Event(result.name, "its FMU ends" if result.ended_by else "ends", result.end))
        yield from sorted(found, key=lambda event: event.time)

    def own_events(self, result: PhaseResult) -> Iterator[Event]:
        """What happens in phases of this kind alone."""
        yield from ()

    def quantities(self, run: RunResult, result: PhaseResult, instants: Sequence[float]) -> Iterator[Quantity]:
        """By what it is judged when it is computed in another way: of a phase that nothing is known of, its outputs.

        instants    by its own times, at which curves are compared [s]
        """
        recorder = result.recorder
        for name in recorder.names[1:] if len(recorder) else ():
            if recorder.kinds[name] == "Real":
                column = recorder[name]
                scale = max(float(column.max() - column.min()), float(abs(column).max()) * LEAST_RANGE)
                if scale > 0.0:
                    curve = at(recorder, name, instants).tolist()
                    yield Quantity(name, name, curve, recorder.units[name], scale, "its range")

    def criteria(self, evidence: Evidence) -> Iterator[Criterion]:
        """What must hold of it however stiff or extreme it is."""
        yield finite(evidence)

    def laden(self, phase: PhaseScene) -> tuple[Mapping[str, float], float] | None:
        """Parameters with which it begins in the state in which a step costs most, and when it comes to that by itself
        [s]; None where all steps cost much the same."""
        return None

    def rounding(self, phase: PhaseScene) -> float | None:
        """Share of the energy below which an error of its book may be rounding [1]; None where all of it may be."""
        return 2e-6

    def spreads(self, run: RunResult, result: PhaseResult) -> Mapping[str, float]:
        """Relative spread [1] of those of its figures that are one sample of many, by key."""
        return {}

    def handover_spreads(self) -> Mapping[str, float]:
        """The same of the figures of what it took over."""
        return {}

    def warnings(self, run: RunResult, result: PhaseResult) -> Iterator[str]:
        """What came out that a user may not expect, beside what its model has to say."""
        yield from ()

    def figures(self, run: RunResult, result: PhaseResult) -> Iterator[Figure]:
        """The figures that there is data for."""
        yield from ()

    def clip(self, run: RunResult, result: PhaseResult) -> Clip | None:
        """What moved in it, for a page; None where that is not known."""
        return None

    def charts(self, run: RunResult, result: PhaseResult) -> Iterator[Chart]:
        """Its histories, for a page."""
        yield from ()

    def marks(self, result: PhaseResult) -> list[tuple[float, str]]:
        """Instants that only phases of this kind have, tugs left out, and what they are."""
        return [(event.time, event.what) for event in self.own_events(result) if event.peak != event.peak]

    def without_figure(self, scene: Scene, result: PhaseResult) -> Iterator[str]:
        """Why there is no figure where one might be expected."""
        yield from ()
