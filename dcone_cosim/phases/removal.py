"""The removal: two bodies on an orbit, a line between them, and thrust; alone, or begun by what a capture leaves."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from dcone_cosim import build, pulled
from dcone_cosim.appendage import ANGLE, SWINGS
from dcone_cosim.contract import TUG_FIELDS, TUG_PREFIX
from dcone_cosim.criteria import Criterion, Evidence
from dcone_cosim.errors import HANDOFF_FAILED, FmuError, Interrupted
from dcone_cosim.events import Event
from dcone_cosim.findings import Finding
from dcone_cosim.fmu.component import Steppable
from dcone_cosim.handoff import (
    CAPTURE_OUTPUTS,
    CAPTURE_PARAMETERS,
    REMOVAL_SETS,
    line_drawn,
    mean_motion,
    prepare,
)
from dcone_cosim.level import CENTER, GROUP, SHAPE, TURNING_SETS
from dcone_cosim.line import ATTACHMENT, REST_LENGTH, line_notes, line_of
from dcone_cosim.phases import (
    chaos,
    expended,
    hastened,
    passive,
    pulled_net,
    recoil,
    removal_criteria,
    removal_quantities,
    removal_report,
    swinging,
    tow_clip,
)
from dcone_cosim.phases.phase import Document, Figure, Main, Phase, Stage
from dcone_cosim.phases.second_shot import since_first_shot
from dcone_cosim.phases.stepping import PhaseLoop
from dcone_cosim.phases.tension import orbital_period
from dcone_cosim.plots import tow
from dcone_cosim.quantities import Quantity
from dcone_cosim.results import Handover, PhaseResult, RunResult
from dcone_cosim.scene.data import SHARED, PhaseScene
from dcone_cosim.scene.expected import Expected
from dcone_cosim.scene.mistakes import Mistake, shown
from dcone_cosim.scene.toml_lines import Path, given_at
from dcone_cosim.scenery import Chart, Clip
from dcone_cosim.transaction import HandoffRecord, check_before
from orbital.constants import EARTH_EQUATORIAL_RADIUS

LINE = "tether.length"
"""Length of the line in the phase before, a capture: one and the same line."""
EACH = tuple(f"[{i}]" for i in (1, 2, 3))
_STATES = tuple(f"{body}.{what}" for body in ("chaser", "target", "center") for what in ("position", "velocity"))
RELATIVE = tuple(f"relative.{what}{each}" for what in ("position", "velocity") for each in EACH)


_TURNING = tuple(dict.fromkeys(name.partition("[")[0] for name in (*TURNING_SETS, *CENTER, *SHAPE.values())))


@dataclass(frozen=True)
class TowOptions(passive.PassiveOptions):
    """What concerns the master of a tow, how it is recorded included.

    record_every    time from row to row of the table [s]; 0: a row at every communication point
    """

    record_every: float = 0.0


class Tow(Phase):
    """What all tows of two bodies are, wherever they begin: what they want of their FMU, and what is told of them."""

    model = "tethered_deorbit"
    examples = ("60 s", "1 day")
    keys: Mapping[str, Expected] = {
        "record_every": Expected("s", example="1 h", minimum=1e-3),
        "safety_every": Expected("s", example="10 min", minimum=1e-3),
        "safety_horizon": Expected("s", example="3 h", minimum=1e-3),
    }
    own_clock = True
    wanted = (
        ("take-over", (*REMOVAL_SETS, "start.condition", "orbit.altitude", "orbit.true_anomaly")),
        ("slack", (ATTACHMENT,)),
        ("spin", TURNING_SETS),
        ("optional", (*CENTER, *SHAPE.values())),
        ("always", ("separation", "tether.tension")),
        ("optional", (REST_LENGTH, "thrust.level")),
        ("optional", RELATIVE),
        ("optional", ("tether.tension_peak", "tether.tension_least", "tether.impulse")),
        ("optional", ("approach.distance", "approach.time", "tether.taut", "tether.tug_count")),
        ("optional", tuple(f"{TUG_PREFIX}{i}].{field}" for i in (1, 2) for field in TUG_FIELDS)),
        ("optional", ("break.broken", "break.time", "release.released", "release.time")),
        ("optional", ("release.returned", "release.return_distance", "release.return_time")),
        ("optional", ("altitude", "center.semi_major_axis", "chaser.radius", "target.radius", "chaser.propellant")),
        ("hand-over", tuple(f"{whose}{each}" for whose in _STATES for each in EACH)),
    )
    taken_over: Sequence[str] = ("start.", ATTACHMENT, *_TURNING, *(name.partition("[")[0] for name in REMOVAL_SETS))
    judged_by = removal_quantities.NAMES
    figure_names = ("orbital_radius.png", "tether_tension.png")

    def faults(self, document: Document) -> Iterator[Mistake]:
        """Keys that the hand-off sets."""
        before = document.before(self.name)
        if not before:
            return
        for phase in (before, self.name):
            if document.mains[phase].terms.get("environment") == "none":
                text = f"has no orbit on which the {before} could hand over; run the phases apart"
                yield Mistake((phase, "environment", "field"), "none", text)
        own = (self.name,)
        text = f"is set by the hand-off from the {before}; leave it out"
        if self.alone:
            text += f", or run the {self.spoken} alone"
        tables = document.tables[self.name]
        for section, keys in tables.items():
            for key in keys if isinstance(keys, dict) else ():
                if self.takes_over(f"{section}.{key}"):
                    yield Mistake((*own, section, key), keys[key], text)
        for variable, path in document.mains[self.name].given.items():
            if path[:2] == (*own, "parameters") and self.takes_over(variable):
                yield Mistake(path, given_at(document.tables, path), text)

    def options(self, found: Mapping[str, Any], main: Main | None) -> TowOptions:
        return TowOptions(**found)

    def value_faults(self, before: PhaseScene | None, own: PhaseScene, tables: Mapping[str, Any]) -> Iterator[Mistake]:
        """Rows lie on the grid of the macro steps."""
        every = own.options.record_every if own.options is not None else 0.0
        steps = every / own.macro_step
        if every > 0.0 and not (round(steps) >= 1 and math.isclose(steps, round(steps), rel_tol=1e-9)):
            path = (own.name, "record_every")
            text = f"must be a whole number of macro steps, {own.macro_step:g} s each"
            yield Mistake(path, given_at(tables, path), text)

    def loop(self, stage: Stage, component: Steppable, start: float) -> PhaseLoop:
        loop = super().loop(stage, component, start)
        assert isinstance(loop, PhaseLoop), "that of `Phase`"
        every = stage.phase.options.record_every if stage.phase.options is not None else 0.0
        steps = round(every / stage.phase.macro_step)
        if steps > 1:
            loop.thin(steps)
        return loop

    def stepped_by(self, stage: Stage, component: Steppable) -> type[PhaseLoop]:
        options = stage.phase.options
        rows = options is not None and options.record_every > 0.0
        return hastened.Hastened if not rows and hastened.possible(stage, component) else PhaseLoop

    def foresee(self, stage: Stage) -> None:
        """Say beforehand that the propellant may not last."""
        told = expended.foreseen(stage.run, stage.phase)
        if told is not None:
            stage.progress.say(f"warning: {told}")

    def judge(self, stage: Stage, result: PhaseResult) -> None:
        """Whether the chaser had the propellant that the tow took."""
        told = expended.overdrawn(stage.run, result)
        if told is not None:
            stage.run.fail("propellant overdrawn", told, HANDOFF_FAILED)

    def afterwards(self, stage: Stage, result: PhaseResult) -> None:
        """What becomes of the pair if it stops on the way."""
        options = stage.phase.options
        if options is None or not math.isfinite(options.safety_every) or result.error is not None:
            return
        try:
            result.passive = passive.examine(stage, result)
        except Interrupted as error:
            stage.run.stop(error)
        except FmuError as error:
            stage.progress.say(f"passive safety is left out: {error}")

    def findings(self, run: RunResult, result: PhaseResult) -> Iterator[Finding]:
        return removal_report.findings(run, self.name, result)

    def own_events(self, result: PhaseResult) -> Iterator[Event]:
        return removal_report.own_events(result)

    def quantities(self, run: RunResult, result: PhaseResult, instants: Sequence[float]) -> Iterator[Quantity]:
        return removal_quantities.quantities(result, instants)

    def criteria(self, evidence: Evidence) -> Iterator[Criterion]:
        return removal_criteria.criteria(evidence)

    def spreads(self, run: RunResult, result: PhaseResult) -> Mapping[str, float]:
        return chaos.of_tow(result, isinstance(run.handovers.get(self.name), HandoffRecord))

    def warnings(self, run: RunResult, result: PhaseResult) -> Iterator[str]:
        record = run.handovers.get(self.name)
        reach = None if record is None else record.reach
        yield from removal_report.meeting(self.name, result, reach)
        yield from removal_report.unsafe(run, self.name, result, reach)
        if isinstance(record, HandoffRecord) and result.tugs is not None and 1 in result.tugs.rows:
            yield from pulled.warnings(self.name, record.net, result.tugs.rows[1][1])

    def figures(self, run: RunResult, result: PhaseResult) -> Iterator[Figure]:
        """The orbit of both bodies, and the tension of the line."""
        recorder, title = result.recorder, run.scene.title
        if len(recorder) < 2:
            return
        since = self._since(run)
        if {"chaser.radius", "target.radius"} <= set(recorder.names):
            yield self.figure_names[0], partial(tow.orbit, result, since, title)
        if "tether.tension" in recorder:
            yield self.figure_names[1], partial(tow.tension, result, run.comparisons.get(self.name), since, title)

    def _since(self, run: RunResult) -> str:
        return "time since the hand-over" if self.name in run.handovers else f"time since the {self.spoken} began"

    def clip(self, run: RunResult, result: PhaseResult) -> Clip | None:
        surface = None
        for phase in run.scene.phases:
            if phase.name == self.name or phase.main.model == self.model:
                continue
            values = {**run.parameters.get(phase.name, {}), **phase.main.made}
            found, swing = build.target_surface(values, phase.main.terms), build.target_swing(values, phase.main.terms)
            if found is not None:
                angle = run.left.get(phase.name, {}).get(ANGLE, 0.0)
                corners = np.array(found[0] if swing is None else swing(angle), dtype=float)
                surface = (corners, [list(face) for face in found[1]])
        since = self._since(run).partition(" ")[2]
        return tow_clip.clip(self.name, result, since, run.parameters.get(self.name, {}), surface)

    def charts(self, run: RunResult, result: PhaseResult) -> Iterator[Chart]:
        return tow_clip.charts(result, run.comparisons.get(self.name), self._since(run))

    def cautions(self, before: PhaseScene | None, own: PhaseScene) -> Iterator[str]:
        """Macro steps too short for the level of detail that takes many revolutions between two of them."""
        altitude = own.setting("orbit.altitude")
        if own.main.fmu is not None or own.main.terms.get("level") != "averaged" or altitude is None:
            return
        needed = build.LEAP_REVOLUTIONS * orbital_period(EARTH_EQUATORIAL_RADIUS + altitude)
        if own.macro_step <= needed:
            yield (
                f'{self.name}.level: detail = "averaged" takes no revolutions at once in macro steps of '
                f"{own.macro_step:g} s; it needs more than {build.LEAP_REVOLUTIONS:g} revolutions in one, here "
                f"{needed:.6g} s, and steps as event_map does"
            )


class Removal(Tow):
    name = "removal"
    follows: Sequence[str] = ("capture", "second_shot", "third_shot")
    handoff_keys: Mapping[str, Expected] = {
        "point_tolerance": Expected("1", example="1 %", minimum=0.0, share=True),
        "compare_without_recoil": Expected("1", kind="Boolean"),
        pulled.KEY: Expected("1", choices=pulled.HOW),
    }
    handoff_gone: Mapping[str, str] = {
        "spin_tolerance": "is gone: point_tolerance bounds what a point changes of the first tug, its spin and all, "
        'as in point_tolerance = "1 %"; that of a scene may have to be wider',
    }
    recognised_by: Sequence[str] = ("separation", *REMOVAL_SETS)
    takes: Sequence[str] = (*CAPTURE_OUTPUTS, *CAPTURE_PARAMETERS)
    takes_too: Sequence[str] = (LINE, *SWINGS)

    def faults(self, document: Document) -> Iterator[Mistake]:
        """The same, and orbits on which capture and removal do not fit together."""
        yield from super().faults(document)
        yield from pulled_net.faults(document, self.name)
        if not document.before(self.name):
            return
        orbit = document.tables.get(SHARED)
        eccentricity = orbit.get("eccentricity", 0.0) if isinstance(orbit, dict) else 0.0
        if eccentricity and isinstance(eccentricity, int | float):
            text = "must be 0 when a capture hands over: its frame turns evenly, as on a circular orbit"
            yield Mistake((SHARED, "eccentricity"), eccentricity, text)

    def value_faults(self, before: PhaseScene | None, own: PhaseScene, tables: Mapping[str, Any]) -> Iterator[Mistake]:
        """The one line of two phases: the same length in both, and more than the least it has to span at the shot: from
        the chaser to the nearest point that a target of that size can have, however it lies."""
        yield from super().value_faults(before, own, tables)
        if before is None:
            return
        paths: dict[str, Path] = {p: (p, *n.split(".")) for p, n in ((before.name, LINE), (own.name, REST_LENGTH))}
        told = {phase: given_at(tables, path) for phase, path in paths.items()}
        length = own.setting(REST_LENGTH)
        if length is None:
            return
        at = own.name if told[own.name] is not None or told[before.name] is None else before.name
        other = before.setting(LINE)
        if not math.isclose(length, length if other is None else other, rel_tol=1e-9):
            same = f"{before.name}.{LINE}"
            if told[own.name] is None:
                yield Mistake(paths[own.name], None, f"expected the length of the line, here or as {same}")
                return
            text = f"must equal {same} = {shown(told[before.name])}: both phases have the same line"
            yield Mistake(paths[own.name], told[own.name], text)
        start = [before.setting(f"chaser.start_{what}[{i}]") for what in ("position", "velocity") for i in (1, 2, 3)]
        known = [value for value in start if value is not None]
        if len(known) < len(start):
            return
        distance, speed = math.hypot(*known[:3]), math.hypot(*known[3:])
        values = before.main.values
        corners, _ = build.target_surface(values, before.main.terms) or ([], [])
        nearest = distance - max((math.hypot(*corner) for corner in corners), default=0.0)
        if length <= nearest - speed * before.duration:
            text = (
                f"must exceed {nearest:.6g} m, the distance from the chaser to the target's nearest point at the shot: "
            )
            yield Mistake(paths[at], told[at], text + "a locked line would start stretched", f"{length:g} m")

    def joined(self, before: PhaseScene, own: PhaseScene) -> tuple[PhaseScene, PhaseScene]:
        """Both with the line's length, where one of them leaves it to the other."""
        lengths = before.main.parameters.get(LINE), own.main.parameters.get(REST_LENGTH)
        return _with(before, LINE, lengths[1]), _with(own, REST_LENGTH, lengths[0])

    def notes(self, offered: Mapping[str, Any]) -> Sequence[str]:
        return line_notes(offered)

    def cautions(self, before: PhaseScene | None, own: PhaseScene) -> Iterator[str]:
        """Those of every tow, and frames that do not turn alike."""
        yield from super().cautions(before, own)
        law = None if before is None else before.main.terms.get("gravity", "hill")
        if before is not None and law != "hill":
            yield (
                f'{before.name}.gravity: law = "{law}" lets the orbital frame stand still in the {before.name}; it '
                f"turns in the {self.name}, which takes the velocities handed over as seen in it (n r: 12 mm/s at 12 m "
                'in low orbit). law = "hill" turns it in both'
            )

    def values_taken(self, before: PhaseScene) -> dict[str, float]:
        """The masses of the pair."""
        main = before.main
        return build.masses_after(main.values, main.terms) if main.fmu is None else {}

    def take_over(self, stage: Stage) -> Handover | None:
        """The capture's bodies and line as the removal's, of the level that carries them; `HandoffError` if none
        does."""
        if stage.before is None:
            return None
        run, phase, capture = stage.run, stage.phase, stage.run.phases[stage.before.name]
        left, altitude = run.left[stage.before.name], phase.setting("orbit.altitude")
        assert altitude is not None, "the contract asks for it"
        assert capture.located is not None, "it has handed over"
        held, main = run.parameters[stage.before.name], stage.before.main
        swung = swinging.held(stage.before, phase, held, left)
        handed = prepare(left, mean_motion(altitude), swung)
        if drawn := build.line_mass(phase.main.values, phase.main.terms):
            handed = line_drawn(handed, drawn)  # it was on the reel
        line = line_of(handed, left.get(LINE, phase.setting(REST_LENGTH)))
        start = capture.origin + capture.located
        earlier = since_first_shot(run, stage.before.name)
        record = HandoffRecord(capture.located, start, capture.located_by, phase, handed, line, earlier)
        run.handovers[self.name] = record
        record.net = pulled.Pulled.of(left, run.scene.handoff.net_compliance)
        record.shape = {name: held[name] for name in SHAPE if name in held}
        corners, record.shortfall = build.hull_corners({**held, **main.made}, main.terms, left.get(ANGLE, 0.0))
        record.shape |= corners
        check_before(record, run.scene.handoff, build.towed_surface(main.terms.get(GROUP, "")))
        self.foresee(stage)
        return record

    def probe(self, stage: Stage, component: Steppable, result: PhaseResult) -> dict[str, float]:
        """By how much the captured net gives, if that is wanted."""
        if stage.run.scene.handoff.net_compliance == pulled.GIVEN:
            return {}
        assert result.located is not None, "it has handed over"
        return pulled.pull(component, result.origin + result.located, stage.phase.macro_step).left()

    def afterwards(self, stage: Stage, result: PhaseResult) -> None:
        """The same removal with the shot's momentum left out: what the recoil changes."""
        super().afterwards(stage, result)
        record = stage.run.handovers.get(self.name)
        if isinstance(record, HandoffRecord) and stage.run.scene.handoff.compare_without_recoil:
            recoil.compare(self, stage, record)

    def clock(self, run: RunResult) -> str:
        record = run.handovers.get(self.name)
        if record is None:
            return super().clock(run)
        return f"since the hand-over, which was {record.time!r} s after the shot"

    def handover_spreads(self) -> Mapping[str, float]:
        return chaos.HAND_OFF


def _with(phase: PhaseScene, name: str, value: float | None) -> PhaseScene:
    """The phase with the value of a parameter that it has and does not tell."""
    main = phase.main
    if value is None or name in main.parameters or name not in main.defaults:
        return phase
    return replace(phase, main=replace(main, parameters={**main.parameters, name: value}))


PHASE = Removal()
