"""What a tow found: its lines of the summary, and whether the bodies may have met."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from dcone_cosim import build
from dcone_cosim.events import Event
from dcone_cosim.findings import Finding
from dcone_cosim.phases import lowering, passive, released
from dcone_cosim.phases.chaser_report import of_chaser
from dcone_cosim.phases.end import of_end
from dcone_cosim.phases.nodes_report import of_nodes, of_table
from dcone_cosim.phases.tension import last_orbit, parting
from dcone_cosim.results import PhaseResult, RunResult

Array = npt.NDArray[np.float64]
SEVERAL = 1.5
"""Orbits from which on what rows tell is not called that of the last one [1]."""
UNKNOWN_EXTENT = 1.0
"""How far a body of which nothing is known is taken to reach from its centre of mass [m]."""


MODES = {
    "free": "share in free flight",
    "followed": "share with every vibration followed",
    "mapped": "share with vibration in closed form",
    "dumbbell": "share as a rigid dumbbell",
    "averaged": "share of many revolutions at once",
}
"""Ways in which a tow is computed, by the output `level.*` with the time spent so."""


class Approach(NamedTuple):
    """Least distance of the two centres of mass [m], when since the phase began [s], and whether from rows alone."""

    distance: float
    time: float
    recorded: bool


def approach(result: PhaseResult) -> Approach | None:
    """How near the two bodies came, by the FMU's own watch or, without that, by the rows there are."""
    recorder = result.recorder
    if not len(recorder):
        return None
    if {"approach.distance", "approach.time"} <= set(recorder.names):
        last = recorder.last()
        return Approach(last["approach.distance"], last["approach.time"], False)
    if "separation" not in recorder:
        return None
    row = int(np.argmin(recorder["separation"]))
    time = recorder["time"]
    return Approach(float(recorder["separation"][row]), float(time[row] - time[0]), True)


def findings(run: RunResult, phase: str, result: PhaseResult) -> Iterator[Finding]:
    """All lines of a tow, which is the phase of that name."""
    recorder = result.recorder
    elapsed = result.end - result.start
    # what an FMU went on beyond its last whole step may not be recorded
    whole = result.ended_by and result.end < result.ended_at
    told = "recorded, in whole steps" if whole else "simulated"
    yield Finding(phase, "simulated", told, elapsed, "s")
    yield from of_end(phase, result)
    begin = " the hand-over" if phase in run.handovers else ""
    yield from _of_tugs(phase, result, "", begin)
    if phase in run.comparisons:
        yield from _of_tugs(phase, run.comparisons[phase], "_without_recoil", begin)
    if not len(recorder):
        return
    yield from _of_tension(phase, result)
    yield from of_table(phase, result)
    yield from of_nodes(phase, result)
    last = recorder.last()
    if last.get("break.broken"):
        then = "" if result.ended_by else ", and both ends fly on,"
        yield Finding(phase, "broke_at", f"the tether broke{then} at", last["break.time"], "s")
    if phase not in run.handovers:
        yield from _of_appendage(phase, last)
    if "tether.wrapped" in recorder:
        yield from of_wrapping(phase, recorder["time"] - result.start, recorder["tether.wrapped"])
    for name, label, unit, shown_in in (
        ("separation", "distance at the end", "m", ""),
        ("altitude", "altitude at the end", "m", "km"),
        ("chaser.propellant", "propellant used", "kg", ""),
    ):
        if name in last:
            yield Finding(phase, name, label, last[name], unit, shown_in=shown_in)
    yield from of_chaser(phase, result, run.parameters.get(phase, {}))
    yield from _of_approach(phase, result)
    yield from lowering.findings(run, phase, result)
    yield from _of_safety(run, phase, result)
    yield from _of_environment(phase, result, last)
    yield from released.findings(run, phase, result)
    yield from _of_reel(run, phase, last)
    if "level.now" in last:
        yield from _of_modes(phase, last)
    elif "level.settled" in last:
        yield from _of_level(phase, result, last)


def of_wrapping(phase: str, elapsed: Array, wrapped: Array) -> Iterator[Finding]:
    """Whether the tether lay round the target in any row, how much of it [m], and from when on [s]; both (n,)."""
    yield Finding(phase, "wrapped", "tether round the target, at most (of rows)", float(np.max(wrapped)), "m")
    if np.any(wrapped > 0.0):
        first = float(elapsed[int(np.argmax(wrapped > 0.0))])
        yield Finding(phase, "wrapped_after", "it first lay round it after (of rows)", first, "s")


def _of_appendage(phase: str, last: Mapping[str, float]) -> Iterator[Finding]:
    """What the target's appendage, held fast at the begin, has done; after a hand-over that says so."""
    if "appendage.energy" in last:
        momentum = math.hypot(*(last[f"appendage.momentum[{i}]"] for i in (1, 2, 3)))
        yield Finding(
            phase, "appendage_momentum", "spin that the appendage, held fast, gave the target", momentum, "N m s"
        )
        yield Finding(phase, "appendage_energy", "energy lost as it was held fast", last["appendage.energy"], "J")


def _of_level(phase: str, result: PhaseResult, last: Mapping[str, float]) -> Iterator[Finding]:
    """When the line had come to rest, so that its vibration was stepped over; the rows tell when else."""
    times = round(last["level.times_settled"])
    yield Finding(phase, "times_settled", "times the tether came to rest", times)
    if last["level.settled"]:
        yield Finding(phase, "settled_since", "at rest until the end, from", last["level.settled_since"], "s")
    if times and len(result.recorder) > 1:
        share = float(np.mean(result.recorder["level.settled"]))
        yield Finding(phase, "settled_share", "share of the rows at rest", share)


def _of_environment(phase: str, result: PhaseResult, last: Mapping[str, float]) -> Iterator[Finding]:
    """What the pair has had of light, and what a line that conducts has taken from its orbit."""
    elapsed = result.end - result.start
    if "shadow.time" in last and elapsed > 0.0:
        yield Finding(phase, "shadows", "times in the Earth's shadow", int(last["shadow.count"]))
        yield Finding(phase, "shadow_share", "share of the time in it", last["shadow.time"] / elapsed)
    columns = result.recorder
    if "electrodynamic.power" in columns and len(columns) > 1:
        for key, label, unit in (("emf", "voltage", "V"), ("current", "current", "A"), ("force", "force on it", "N")):
            largest = float(np.max(np.abs(columns[f"electrodynamic.{key}"])))
            yield Finding(
                phase, f"electrodynamic_{key}", f"largest {label}, tether that conducts (of rows)", largest, unit
            )
        parted, _, ended_by = parting(columns)
        whole, until = slice(None, parted), f", until {ended_by}" if ended_by else ""
        time = columns["time"][whole]
        for key, label in (
            ("orbit_power", "mean power it takes from the orbit"),
            ("power", "mean of voltage times current"),
        ):
            if f"electrodynamic.{key}" in columns and len(time) > 1:
                mean = float(np.trapezoid(columns[f"electrodynamic.{key}"][whole], time) / (time[-1] - time[0]))
                yield Finding(phase, f"electrodynamic_{key}", f"{label}{until} (of rows)", mean, "W")


def _of_modes(phase: str, last: Mapping[str, float]) -> Iterator[Finding]:
    """How long the tow was computed in which way, and how much a tug may be off by that."""
    times = {mode: last.get(f"level.{mode}", 0.0) for mode in MODES}
    whole = sum(times.values())
    for mode, told in MODES.items():
        if times[mode] > 0.0 or (mode == "averaged" and "level.averaged" in last and whole > 0.0):
            yield Finding(phase, f"level_{mode}", told, times[mode] / whole)
    yield Finding(phase, "level_error", "bound of a tug's relative error", last["level.error"])
    if times["averaged"] > 0.0:
        yield Finding(phase, "level_revolutions", "revolutions so taken", round(last["level.revolutions"]))
        yield Finding(phase, "level_average_error", "bound of their relative error", last["level.average_error"])


def _of_tension(phase: str, result: PhaseResult) -> Iterator[Finding]:
    tension = last_orbit(result)
    if tension is None:
        return
    if not tension.is_orbit:
        when, window = "whole phase", "length of the phase, less than an orbit"
    elif tension.orbits < SEVERAL:
        when, window = "last orbit", "length of that last orbit, in whole steps"
    else:
        when, window = f"last {tension.orbits:.3g} orbits", "length of these, as far as rows are apart"
    if tension.until:
        when, window = f"{when} until {tension.until}", f"{window}, until {tension.until}"
    for what, value in (("mean", tension.mean), ("least", tension.least), ("largest", tension.largest)):
        sampled = " (of rows)" if what in tension.sampled else ""
        told: float | str = "not reported: tugs fall between the rows" if value is None else value
        yield Finding(phase, f"tension_{what}", f"{what} tension, {when}{sampled}", told, "N")
    yield Finding(phase, "tension_window", window, tension.window, "s")


def _of_approach(phase: str, result: PhaseResult) -> Iterator[Finding]:
    nearest = approach(result)
    if nearest is not None:
        recorded = " recorded" if nearest.recorded else ""
        yield Finding(phase, "approach", f"least distance{recorded}", nearest.distance, "m")
        yield Finding(phase, "approach_time", "least distance at", nearest.time, "s")


def room(values: Mapping[str, float], reach: float | None) -> float:
    """How near the centres may come before the bodies touch, or are nearer than the scene wants them, by what is known
    of their size [m].

    values   parameters of the tow, SI
    reach    of the target from its centre [m], None where the hand-over does not tell
    """
    chaser = values.get("ends.chaser_extent") or UNKNOWN_EXTENT
    size = [values[f"target.size[{i}]"] for i in (1, 2, 3) if f"target.size[{i}]" in values]
    if {"target.cylinder_radius", "target.cylinder_length"} <= values.keys():
        size = [2.0 * values["target.cylinder_radius"], values["target.cylinder_length"]]
    known = math.hypot(*size) / 2.0 if size else reach
    corners = [
        math.hypot(*(values[f"target.corner_{axis}[{i}]"] for axis in "xyz"))
        for i in range(1, sum(name.startswith("target.corner_x") for name in values) + 1)
    ]
    known = max(corners, default=known)
    target = known or values.get("ends.target_extent") or UNKNOWN_EXTENT
    return chaser + target + values.get("ends.clearance", 0.0)


def _of_safety(run: RunResult, phase: str, result: PhaseResult) -> Iterator[Finding]:
    record = run.handovers.get(phase)
    values = run.parameters.get(phase, {})
    for found in passive.worst(result.passive, room(values, None if record is None else record.reach)):
        yield Finding(phase, f"if_{found.what}", f"if {found.told}: least distance", found.distance, "m")
        yield Finding(phase, f"if_{found.what}_at", "the worst instant for it", found.time, "s")
        yield Finding(
            phase, f"if_{found.what}_meets", "instants after which they may meet", f"{found.meets} of {found.tried}"
        )


def unsafe(run: RunResult, phase: str, result: PhaseResult, reach: float | None) -> Iterator[str]:
    """Whether the bodies may meet if the tow stops on the way, or where the line has been cut."""
    needs = room(run.parameters.get(phase, {}), reach)
    yield from released.returning(phase, result, needs)
    for found in passive.worst(result.passive, needs):
        if found.meets:
            yield (
                f"{phase}: if {found.told} at {found.meets} of {found.tried} instants, the bodies may meet: at worst "
                f"their centres come within {found.distance:.3g} m, {found.after:.6g} s after {found.time:.6g} s; they "
                f"are taken to touch at {needs:.3g} m"
            )


def _of_reel(run: RunResult, phase: str, last: Mapping[str, float]) -> Iterator[Finding]:
    """What a reel has done, and what its loop is: rest, gains, poles and margins."""
    for name, label, unit in (
        ("reel.paid_out", "tether wound out at the end", "m"),
        ("reel.work", "work of the reel's motor", "J"),
        ("reel.heat", "heat of the brake", "J"),
        ("tether.heat", "heat of the tether's dashpot", "J"),
    ):
        if name in last:
            yield Finding(phase, name, label, last[name], unit)
    if "reel.limited" in last:
        yield Finding(phase, "reel.limited", "commands cut by a limit of the reel", int(last["reel.limited"]))
    if "reel.calmed" in last:
        calmed: float | str = last["reel.calmed"] or "not within the phase"
        yield Finding(phase, "reel.calmed", "target calm since", calmed, "s")
    main = next(one.main for one in run.scene.phases if one.name == phase)
    if main.fmu is None and phase in run.parameters:
        values = {**main.defaults, **run.inputs.get(phase, {}), **run.parameters[phase]}
        for row in build.implied(main.model, values, main.terms):
            if row.key.startswith("reel."):
                shown_in = "deg" if row.unit == "rad" else ""
                yield Finding(phase, row.key, row.label, row.value, row.unit, shown_in=shown_in)


def _of_tugs(phase: str, result: PhaseResult, suffix: str, begin: str) -> Iterator[Finding]:
    """Of one removal; `begin` is what its times count from, "" where that needs no word."""
    tugs = result.tugs
    if tugs is None:
        return
    note = " (had the shot no recoil)" if suffix else ""
    taut = result.is_taut_from_start
    if taut:
        yield Finding(phase, f"taut_from_start{suffix}", f"tether{note}", "taut from the start")
    label = "tugs after that" if taut else "tugs"
    yield Finding(phase, f"tugs{suffix}", f"{label}{note}", tugs.count - taut)
    if tugs.missed:
        label = f"of these not seen: more than {tugs.ring} in one macro step{note}"
        yield Finding(phase, f"tugs_missed{suffix}", label, tugs.missed)
    real = sorted(number for number in tugs.rows if not (taut and number == 1))
    if real:
        time, peak, speed = tugs.rows[real[0]]
        seen, mark = ("_seen", " seen") if real[0] > 1 + taut else ("", "")
        yield Finding(phase, f"first_tug{seen}{suffix}", f"first tug{mark} after{begin}{note}", time, "s")
        yield Finding(
            phase, f"first_tug{seen}_speed{suffix}", f"first tug{mark}, speed{note}", speed, "m/s", shown_in="mm/s"
        )
        yield Finding(phase, f"first_tug{seen}_peak{suffix}", f"first tug{mark}, peak{note}", peak, "N")
    recorder = result.recorder
    if tugs.missed and "tether.tension_peak" in recorder:
        largest = float(np.max(recorder["tether.tension_peak"]))
    elif tugs.rows:
        largest = max(peak for _, peak, _ in tugs.rows.values())
    else:
        return
    label = "largest tension" if taut else "largest tug, peak"
    seen, mark = ("_seen", " seen") if tugs.missed and "tether.tension_peak" not in recorder else ("", "")
    yield Finding(phase, f"largest_tug{seen}_peak{suffix}", f"{label}{mark}{note}", largest, "N")


def own_events(result: PhaseResult) -> Iterator[Event]:
    """Its tugs, how near the bodies came, and when the line broke."""
    taut, log = result.is_taut_from_start, result.tugs
    for number, (time, peak, speed) in sorted(log.rows.items()) if log is not None else ():
        label = "taut from the start" if taut and number == 1 else f"tug {number - taut}"
        yield Event(result.name, label, time, peak, speed)
    nearest = approach(result)
    if nearest is not None:
        yield Event(result.name, "bodies nearest", nearest.time)
    last = result.recorder.last() if len(result.recorder) else {}
    if last.get("break.broken"):
        yield Event(result.name, "line breaks", last["break.time"])
    if last.get("release.released"):
        yield Event(result.name, "line cut", last["release.time"])
        back = released.after_the_cut(result)
        if back is not None:
            yield Event(result.name, "bodies return nearest", back.after)


def meeting(phase: str, result: PhaseResult, reach: float | None) -> Iterator[str]:
    """Whether the bodies would meet, by what is known of how far they reach from their centres of mass.

    A target reaches as far as its farthest corner at most, so a pass that is told may still be a miss; none that is not
    told is a hit, as far as the chaser reaches no farther than is assumed.

    reach    of the target from its centre [m], None where that is not known
    """
    nearest = approach(result)
    if nearest is None:
        return
    if reach is None:
        reach = UNKNOWN_EXTENT
        assumed = f"each is taken to reach {UNKNOWN_EXTENT:g} m from its centre, as no size is known"
    else:
        assumed = (
            f"the target reaches {reach:.3g} m from its centre, "
            f"and the chaser is taken to reach {UNKNOWN_EXTENT:g} m from its own"
        )
    if nearest.distance < reach + UNKNOWN_EXTENT:
        recorded = ", by the rows recorded" if nearest.recorded else ""
        yield (
            f"{phase}: the bodies may meet: their centres came within {nearest.distance:.3g} m, {nearest.time:.6g} s "
            f"after the {phase.replace('_', ' ')} began{recorded}; {assumed}, and no contact is computed"
        )
