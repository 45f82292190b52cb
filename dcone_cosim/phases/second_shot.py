"""A second shot after one that has failed: the chaser goes back to its place, and shoots another net.

The net that failed drifts away. The target flies and turns on free of forces until the second shot, whose frame begins
at its centre of mass; what is left for the next phase is told in the frame of the first shot, moved on with the orbit.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from dcone_cosim.findings import Finding
from dcone_cosim.fmu.component import Steppable
from dcone_cosim.handoff import CAPTURE_OUTPUTS, CAPTURE_PARAMETERS, Vector, frame_rate, require_rigid
from dcone_cosim.ledger import AXES, LedgerRow, closure_finding, require_closed
from dcone_cosim.level import ATTITUDE, RATE
from dcone_cosim.phases import kinds
from dcone_cosim.phases.capture import Capture, CaptureOptions
from dcone_cosim.phases.expended import NET, Expended, expended, net_mass
from dcone_cosim.phases.phase import Document, Main, Phase, Stage
from dcone_cosim.results import Handover, RunResult
from dcone_cosim.scene.data import PhaseScene
from dcone_cosim.scene.expected import TEXT, Expected
from dcone_cosim.scene.mistakes import Mistake, shown
from dcone_cosim.scene.toml_lines import given_at
from orbital.manoeuvres import flown, two_impulses

MASS = "chaser.mass"
INERTIA = tuple(f"target.inertia[{i}]" for i in (1, 2, 3))
NOTHING = np.zeros(3)
LONGEST_RELOAD = 86400.0
"""Fourteen low orbits: what Hill's equations leave out, air and flattening first, counts by then [s]."""
ADDED = ("chaser", "target", "vertex", "catch")
"""Bodies of a capture whose places and velocities are told in its frame."""


def vector(values: Mapping[str, float], name: str) -> Vector:
    return np.array([values[f"{name}[{i}]"] for i in (1, 2, 3)])


def elements(name: str, value: Vector) -> dict[str, float]:
    return {f"{name}[{i}]": float(x) for i, x in enumerate(value, 1)}


@dataclass(frozen=True)
class FurtherShotOptions(CaptureOptions):
    """What concerns the master of another shot.

    like     phase that it is like
    reload   from the end of the shot before to this one [s]
    """

    like: str = ""
    reload: float = 0.0


@dataclass
class ShotHandover:
    """From a shot that failed to the next.

    time       from the shot before to this one                                                      [s]
    earlier    from the first shot to the shot before                                                [s]
    rate       at which the orbital axes turn                                                        [rad/s]
    reload     time between the two                                                                  [s]
    left       what the shot before left, in the frame of the first
    burns      the two changes of velocity of the chaser, orbital axes                               [m/s]
    origin     where the frame of this shot begins, and its velocity, in the frame of the first      [m], [m/s]
    """

    time: float
    earlier: float
    phase: PhaseScene
    rate: float
    reload: float
    left: Mapping[str, float]
    expended: Expended
    burns: tuple[Vector, Vector]
    origin: tuple[Vector, Vector]
    start: float = 0.0
    reach: float | None = None
    rows: list[LedgerRow] = field(default_factory=list)
    failure: str = ""

    def parameters(self, component: Steppable) -> dict[str, float]:
        from orbital.tumbling import turned_freely  # takes scipy, which other runs do without

        attitude = np.array([self.left[f"target.attitude[{i}]"] for i in (1, 2, 3, 4)])
        rate, inertia = vector(self.left, "target.rate"), np.array([self.left[name] for name in INERTIA])
        turned, rate = turned_freely(attitude, rate, inertia, self.rate, self.reload)
        names = (*ATTITUDE, *RATE)
        turning = dict(zip(names, (*turned.tolist(), *rate.tolist()), strict=True))
        return {MASS: self.expended.chaser} | {
            name: value for name, value in turning.items() if name in component.variables
        }

    def close(self, component: Steppable) -> None:
        """Masses, spin of the target and place and speed of the chaser, by what the FMU of this shot says itself."""
        names = (MASS, "target.mass", NET, "chaser.position", "chaser.start_velocity", "target.spin")
        each = [one for name in names for one in ((name,) if "mass" in name else elements(name, np.zeros(3)))]
        self.rows = list(_rows(self, component.get(each)))
        require_closed(self.rows)

    def recall(self, told: Mapping[str, Any]) -> None:
        self.rows, self.failure = [LedgerRow.of(row) for row in told["rows"]], told["failure"]

    def findings(self) -> list[Finding]:
        place = f"hand-off to {self.phase.name}"
        drift = float(np.linalg.norm(self.origin[1]))
        rows = [
            Finding(place, "time", "shot again, after the shot before", self.time, "s"),
            *self.expended.findings(place, bool(self.failure)),
            Finding(place, "target_speed", "speed that the shots so far gave the target", drift, "m/s", 0.0, "mm/s"),
        ]
        return [*rows, *closure_finding(place, self.rows)]

    def told(self) -> dict[str, Any]:
        return {
            "time": {"value": self.time, "unit": "s", "clock": "since the shot before"},
            "rows": [row.as_dict() for row in self.rows],
            "burns": {"value": [list(burn) for burn in self.burns], "unit": "m/s"},
            "propellant": {"value": self.expended.propellant, "unit": "kg"},
            "impulse": {"value": self.expended.impulse, "unit": "N s"},
            "origin": {"position": {"value": self.origin[0], "unit": "m"}},
            "left": dict(self.left),
            "failure": self.failure,
        }


def _rows(record: ShotHandover, held: Mapping[str, float]) -> Iterator[LedgerRow]:
    """Masses; momenta of the target; the chaser's state, flown from burn to burn; what drifts away is accounted for."""
    left, spent = record.left, record.expended
    mass, before, net = left["target.mass"], spent.before, left[NET]
    aboard = held[MASS] + held[NET]
    yield LedgerRow("mass, chaser and nets aboard", "kg", before, aboard, spent.propellant, "propellant", before)
    yield LedgerRow("mass, target", "kg", mass, held["target.mass"], 0.0, "", mass)
    drifts = "drifts away with the net that failed"
    whole = before + mass + net
    after = aboard + held["target.mass"]
    yield LedgerRow("mass, all", "kg", whole, after, net + spent.propellant, f"propellant, and what {drifts}", whole)
    lost, own = net * vector(left, "catch.velocity"), mass * vector(left, "target.velocity")
    _, carried = flown(record.origin[0], record.origin[1], record.rate, -record.reload)
    yield from _by_axis(
        ("linear momentum, target and net", "N s"), lost + own, held["target.mass"] * carried, [lost, own], lost, drifts
    )
    place = vector(left, "chaser.position") - vector(left, "target.position")
    speed = vector(left, "chaser.velocity") - vector(left, "target.velocity")
    burns, reload = record.burns, record.reload
    there, arriving = flown(place, speed + burns[0], record.rate, reload)
    moved = [reload * burn for burn in burns]
    now = vector(held, "chaser.position")
    yield from _by_axis(("place of the chaser from the target", "m"), there, now, [place, there, *moved])
    now = vector(held, "chaser.start_velocity")
    yield from _by_axis(("velocity of the chaser from the target", "m/s"), arriving + burns[1], now, [speed, *burns])
    spin, angle = vector(left, "target.spin"), record.rate * reload
    c, s = np.cos(angle), np.sin(angle)
    seen = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]]) @ spin
    yield from _by_axis(("angular momentum, spin of the target", "N m s"), seen, vector(held, "target.spin"), [spin])


def _by_axis(
    what: tuple[str, str],
    before: Vector,
    after: Vector,
    entering: Sequence[Vector],
    accounted: Vector = NOTHING,
    account: str = "",
) -> Iterator[LedgerRow]:
    """A row for each axis of a vector that is kept.

    what       quantity and unit
    entering   of which the sum of magnitudes is
    """
    size = float(sum(np.linalg.norm(one) for one in entering))
    for axis, was, now, meant in zip(AXES, before.tolist(), after.tolist(), accounted.tolist(), strict=True):
        yield LedgerRow(f"{what[0]}, {axis}", what[1], was, now, meant, account, size)


def about_handover(kind: Phase, document: Document) -> Iterator[Mistake]:
    """Keys that a hand-over to such a phase sets, and the engine that its chaser needs."""
    before, told = document.before(kind.name), document.tables.get("handoff", {})
    if not before:
        return
    if isinstance(told, dict) and "specific_impulse" not in told:
        text = 'expected, of the chaser\'s engine, such as "220 s"'
        yield Mistake(("handoff", "specific_impulse"), None, text)
    text = f"is set by the hand-off from the {before}; leave it out"
    for section, keys in document.tables[kind.name].items():
        for key in keys if isinstance(keys, dict) else ():
            if kind.takes_over(f"{section}.{key}"):
                yield Mistake((kind.name, section, key), keys[key], text)


def about_net(own: PhaseScene, tables: Mapping[str, Any]) -> Iterator[Mistake]:
    """A net of ours that is heavier than the whole chaser: that of the first phase, no later one tells it."""
    if own.main.fmu is not None:
        return
    mass, told = own.main.defaults[MASS], ""
    for first in kinds():
        for path in ((first, *MASS.split(".")), (first, "parameters", MASS)):
            given = given_at(tables, path)
            if given is not None and not told:
                mass, told = Expected("kg").read_each([given])[0], f"{'.'.join(path)} = {shown(given)}"
    net = net_mass(own, None)
    if net >= mass:
        at = (own.name, "net", "mass")
        text = f"must be less, with bullets and vertex, than {told or f'that of the chaser, {mass:g} kg'}"
        yield Mistake(at, given_at(tables, at), f"{text}; these are {net:.6g} kg")


class FurtherShot(Capture):
    """Another shot of the same mission; it is left out where the one before has caught the target."""

    alone = False
    retries = True
    keys: Mapping[str, Expected] = {
        **Capture.keys,
        "like": Expected("1", TEXT),
        "reload": Expected("s", example="60 s", minimum=0.0, maximum=LONGEST_RELOAD, open_minimum=True),
    }
    handoff_keys: Mapping[str, Expected] = {
        "specific_impulse": Expected("s", example="220 s", minimum=0.0, open_minimum=True),
        "propellant": Expected("kg", example="40 kg", minimum=0.0, open_minimum=True),
    }
    takes = (*CAPTURE_OUTPUTS, *CAPTURE_PARAMETERS)
    taken_over = (MASS, "target.start_attitude", "target.start_rate")

    def __init__(self, name: str, follows: Sequence[str]) -> None:
        self.name, self.follows, self.prefix = name, follows, f"{name}_"

    def options(self, found: Mapping[str, Any], main: Main | None) -> FurtherShotOptions:
        own = {key: value for key, value in found.items() if key in ("like", "reload")}
        plain = super().options({key: value for key, value in found.items() if key not in own}, main)
        return FurtherShotOptions(**vars(plain), **own)

    def faults(self, document: Document) -> Iterator[Mistake]:
        """Keys that the hand-over sets, and what it has to be told."""
        yield from super().faults(document)
        if document.before(self.name) and "reload" not in document.tables[self.name]:
            yield Mistake((self.name, "reload"), None, 'expected, time between the two shots, such as "60 s"')
        yield from about_handover(self, document)

    def value_faults(self, before: PhaseScene | None, own: PhaseScene, tables: Mapping[str, Any]) -> Iterator[Mistake]:
        yield from super().value_faults(before, own, tables)
        yield from about_net(own, tables) if before is not None else ()

    def cautions(self, before: PhaseScene | None, own: PhaseScene) -> Iterator[str]:
        """A return beyond what `two_impulses` is good for."""
        yield from super().cautions(before, own)
        rate, reload = frame_rate(own), own.options.reload
        if before is not None and rate * reload >= np.pi:
            yield (
                f"{self.name}.reload: {reload:g} s is half an orbit, {np.pi / rate:.6g} s, or more: near each half "
                "orbit the two burns that bring the chaser back grow without bound"
            )

    def take_over(self, stage: Stage) -> Handover | None:
        """The chaser brought back to its place, and the target as it then lies; `HandoffError` without propellant."""
        if stage.before is None:
            return None
        run, phase, before = stage.run, stage.phase, stage.before
        left, shot = run.left[before.name], run.phases[before.name]
        require_rigid(shot.recorder.names)
        reload, rate = phase.options.reload, frame_rate(phase)
        target = vector(left, "target.position"), vector(left, "target.velocity")
        chaser = vector(left, "chaser.position") - target[0], vector(left, "chaser.velocity") - target[1]
        burns = two_impulses(*chaser, *_goal(run, phase, before), rate, reload)
        speed = float(sum(np.linalg.norm(burn) for burn in burns))
        record = ShotHandover(
            shot.end + reload,
            since_first_shot(run, before.name),
            phase,
            rate,
            reload,
            left,
            Expended.nothing(left[MASS]),
            burns,
            flown(*target, rate, reload),
        )
        run.handovers[self.name] = record
        record.expended = expended(run, phase, left[MASS], speed, net_mass(phase, left.get(NET)))
        record.expended.check()
        return record

    def leaves(self, run: RunResult, phase: PhaseScene, left: Mapping[str, float]) -> dict[str, float]:
        """What it left, in the frame of the first shot moved on along the orbit: its own begins at the target."""
        record = run.handovers.get(self.name)
        if not isinstance(record, ShotHandover):
            return dict(left)
        result = run.phases[self.name]
        since = result.end if result.located is None else result.located
        place, speed = flown(*record.origin, record.rate, since)
        moved = dict(left)
        for name in ADDED:
            for of, by in (("position", place), ("velocity", speed)):
                if f"{name}.{of}[1]" in left:
                    moved |= elements(f"{name}.{of}", vector(left, f"{name}.{of}") + by)
        within, seen = vector(left, "catch.velocity"), vector(moved, "catch.velocity")
        moved["energy.kinetic"] += 0.5 * left[NET] * float(seen @ seen - within @ within)
        return moved

    def clock(self, run: RunResult) -> str:
        record = run.handovers.get(self.name)
        before = f", which was {record.time!r} s after the shot before" if record is not None else ""
        return f"since this shot{before}"


def _goal(run: RunResult, phase: PhaseScene, before: PhaseScene) -> tuple[Vector, Vector]:
    """Place [m] and velocity [m/s] from the target that a shot begins with, by its scene; of a file that does not offer
    them those of the shot before."""
    names = ([f"chaser.start_{of}[{i}]" for i in (1, 2, 3)] for of in ("position", "velocity"))
    place, speed = (np.array([phase.setting(name) or 0.0 for name in each]) for each in names)
    if phase.setting("chaser.start_position[1]") is None:
        recorder = run.phases[before.name].recorder
        place = recorder.vector("chaser.position")[0] - recorder.vector("target.position")[0]
    return place, speed


def since_first_shot(run: RunResult, phase: str) -> float:
    """Time from the first shot at a target to the shot of a phase at the same one [s]."""
    record = run.handovers.get(phase)
    return record.earlier + record.time if isinstance(record, ShotHandover) else 0.0


PHASE = FurtherShot("second_shot", ("capture",))
