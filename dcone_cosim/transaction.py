"""The hand-off as a transaction: what it may not carry is refused before, what the removal holds is judged after.

The mapping itself is `handoff`'s, the line's `line`'s; here they are held against the capture and the removal FMU.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from dcone_cosim.appendage import APPENDAGE, Hinged, asked, hinged
from dcone_cosim.contract import HANDED_OVER
from dcone_cosim.errors import HandoffError
from dcone_cosim.findings import Finding
from dcone_cosim.fmu.component import Steppable
from dcone_cosim.handoff import (
    REMOVAL_SETS,
    Handoff,
    SpinSpeeds,
    held_bodies,
    rotation_matrix,
    spin_energy,
    spin_speeds,
)
from dcone_cosim.ledger import Check, LedgerRow, closure_finding, ledger, require_closed
from dcone_cosim.level import (
    GROUP,
    POINT,
    RATE_FRAME,
    TURNING_SETS,
    PointBound,
    carrier,
    carries_spin,
    held_turning,
    needed,
    point_bound,
    turning_parameters,
)
from dcone_cosim.line import (
    ATTACHMENT,
    LINE_HELD,
    OFFSET,
    REST_LENGTH,
    SLACK,
    Line,
    attached_rows,
    drawn_rows,
    line_parameters,
    line_rows,
)
from dcone_cosim.pulled import TAKES, Pulled
from dcone_cosim.scene.data import HandoffOptions, PhaseScene

HAND_OFF, FIRST = "hand-off", "removal"
"""Under what a hand-over is told, and the tow that needs no name beside it."""
HULL = "hull"
"""Level of a target that is towed as the hull of some of its corners."""
CROSS_CHECK = 1e-4
"""Relative agreement asked of what the removal computes with what was handed over. It forms its outputs in the frame of
the pair's centre of mass, turned and turning a little differently: by the offset over the radius, 3e-6 for 20 m."""


@dataclass
class HandoffRecord:
    """The transaction as it went: what was mapped, its ledger, the spin check, and why it failed if it did.

    time              of the hand-over, since the shot [s]
    start             the same, as time that the removal's FMU is told to begin at [s]
    phase             the removal, with the level of its target
    earlier           from the first shot at this target to the one that caught it [s]
    bound             by how much a point would err
    shape             of the capture's target, `level.SHAPE`, or the corners of its hull
    shortfall         by which the target reaches beyond that hull at most [m]
    line_parameters   what is set in the removal so that its line is the capture's
    turning           what is set in it so that its target turns as the capture's; empty for a point
    net               by how much the captured net gives, None where it was not pulled
    """

    time: float
    start: float
    located_by: str
    phase: PhaseScene
    handed: Handoff
    line: Line
    earlier: float = 0.0
    spin: SpinSpeeds = field(default_factory=SpinSpeeds)
    bound: PointBound = field(default_factory=PointBound)
    shape: dict[str, float] = field(default_factory=dict)
    shortfall: float = 0.0
    line_parameters: dict[str, float] = field(default_factory=dict)
    turning: dict[str, float] = field(default_factory=dict)
    rows: list[LedgerRow] = field(default_factory=list)
    checks: list[Check] = field(default_factory=list)
    failure: str = ""
    net: Pulled | None = None

    @property
    def reach(self) -> float:
        return self.handed.reach

    def parameters(self, component: Steppable) -> dict[str, float]:
        """Masses, relative state, anomaly of the orbit, the line and the target's turning, as far as it offers them."""
        if carries_spin(component.variables):
            inertial = self.phase.choice(RATE_FRAME, "inertial") if RATE_FRAME in self.phase.main.choices else 0.0
            self.turning = turning_parameters(self.handed, self.shape, component.variables, inertial)
            self.turning |= self.asked_appendage
        else:
            self.line_parameters = line_parameters(self.line, component.variables)
        since = self.earlier + self.time
        anomaly = advanced(self.phase.setting("orbit.true_anomaly") or 0.0, self.handed.turning[2] * since)
        begun = {"orbit.true_anomaly": anomaly, "start.condition": self.phase.choice("start.condition", HANDED_OVER)}
        epoch = self.phase.setting("orbit.epoch")
        if epoch is not None and "orbit.epoch" in component.variables:
            begun["orbit.epoch"] = epoch + since
        net = {} if self.net is None else self.net.parameters(component.variables)
        return self.handed.parameters | begun | self.line_parameters | self.turning | net

    @property
    def asked_appendage(self) -> dict[str, float]:
        """Parameters of the target's appendage, from the centre of mass of target and net; empty where it has none."""
        shift = self.handed.target.position - self.handed.joint.position
        known = self.handed.appendage.get if self.handed.appendage else self.phase.setting
        return asked(known, rotation_matrix(self.handed.attitude).T @ shift)

    @property
    def appendage(self) -> Hinged | None:
        """The motion of its appendage that the target loses, orbital axes; None where it has none."""
        moving = hinged(self.handed.parameters | self.asked_appendage)
        return None if moving is None else moving.along(rotation_matrix(self.handed.attitude))

    @property
    def turns(self) -> bool:
        """Whether the removal's target turns."""
        return carries_spin(self.phase.main.defaults)

    @property
    def level(self) -> str:
        """Name of the removal's target: a term of ours, or what a file offers."""
        return self.phase.main.terms.get(GROUP, "rigid" if self.turns else POINT)

    @property
    def reason(self) -> str:
        """Why it is this level."""
        worst = f"a point's first tug may be off by {100 * self.bound.largest:.3g} %"
        if self.bound.largest == np.inf:
            worst = "by the first tug the attachment may be out of sight, and the line wraps"
        than = "more than" if not self.bound.accepted else "within"
        left = "" if self.turns or self.bound.accepted else ", but the scene or its FMU leaves no other level"
        return f"{worst}: {than} the {100 * self.bound.tolerance:g} % of handoff.point_tolerance{left}"

    def close(self, component: Steppable) -> None:
        close_ledger(self, component)

    def recall(self, told: Mapping[str, Any]) -> None:
        self.rows = [LedgerRow.of(row) for row in told["rows"]]
        self.checks = [Check(**check) for check in told["cross_checks"]]
        more = {name: float(v) for name, v in told["set_in_removal"].items() if name not in self.handed.parameters}
        self.line_parameters, self.turning = ({}, more) if RATE_FRAME in more else (more, {})
        self.failure = told["failure"]

    def findings(self) -> list[Finding]:
        """Under "hand-off" of the first tow, by its name of a later one."""
        place = HAND_OFF if self.phase.name == FIRST else f"{HAND_OFF} to {self.phase.name}"
        return [replace(finding, phase=place) for finding in findings(self)]

    def told(self) -> dict[str, Any]:
        """All of it, with units."""
        handed, bound, line = self.handed, self.bound, self.line
        return {
            "time": {"value": self.time, "unit": "s", "clock": "since the shot"},
            "located_by": self.located_by,
            "rows": [row.as_dict() for row in self.rows],
            "cross_checks": [vars(check) for check in self.checks],
            "spin": {
                "dropped": {"value": 0.0 if self.turns else float(np.linalg.norm(handed.joint.spin)), "unit": "N m s"},
                "attachment_speed": {"value": self.spin.attachment_speed, "unit": "m/s"},
                "tug_speed": {"value": self.spin.tug_speed, "unit": "m/s"},
            },
            "level": {
                "target": self.level,
                "reason": self.reason,
                "beyond_hull": {"value": self.shortfall if self.level == HULL else 0.0, "unit": "m"},
                "spin": {"value": float(np.linalg.norm(handed.joint.spin)), "unit": "N m s"},
                "rate_relative_to_line": {"value": bound.rate, "unit": "rad/s"},
                "angle_at_first_tug": {"value": bound.angle, "unit": "rad"},
                "first_tug": {"value": bound.tug_time, "unit": "s"},
                "tug_speed": {"value": bound.tug_speed, "unit": "m/s"},
                "bound_time": bound.time,
                "bound_peak": bound.peak,
                "tolerance": bound.tolerance,
            },
            "joint_body": {
                "mass": {"value": handed.joint.mass, "unit": "kg"},
                "position": {"value": handed.joint.position, "unit": "m"},
                "velocity": {"value": handed.joint.velocity, "unit": "m/s"},
                "spin": {"value": handed.joint.spin, "unit": "N m s"},
                "inertia": {"value": handed.joint.inertia, "unit": "kg m2"},
            },
            "line": {
                "length": {"value": line.length, "unit": "m"},
                "attachment_distance": {"value": line.attachment, "unit": "m"},
                "slack": {"value": line.slack, "unit": "m"},
            },
            **({} if self.net is None else {"net": self.net.told()}),
            "set_in_removal": handed.parameters | self.line_parameters | self.turning,
            "failure": self.failure,
        }


def advanced(anomaly: float, by: float) -> float:
    """True anomaly on a circular orbit moved on [rad], kept within one turn, as the removal's bounds ask."""
    return float(np.remainder(anomaly + by, 2.0 * np.pi))


def check_before(record: HandoffRecord, options: HandoffOptions, surface: str) -> None:
    """Take the level of target that is needed; refuse a hand-off that the removal could not carry truthfully.

    surface      term of the capture's target, "" where there is none
    """
    phase, handed, line = record.phase, record.handed, record.line
    elastic, commanded = phase.setting(REST_LENGTH), phase.setting("reel.length")
    length = commanded if elastic is None else elastic
    thrust = phase.setting("thrust.level") or 0.0
    slack = 0.0 if length is None else length + line.attachment - line.distance
    record.spin = spin_speeds(handed, slack, thrust)
    between = 0.0 if length is None else length - line.reach
    record.bound = bound = point_bound(handed, line, between, thrust, options.point_tolerance)
    if elastic is not None and line.overrun:
        raise HandoffError(
            f"hand-off refused: at t = {record.time:.6g} s the chaser and the net's vertex are {line.reach:.6g} m "
            f"apart, the tether is {line.length:.6g} m long; give it more, or shoot from nearer"
        )
    if record.turns or bound.accepted:
        return
    turning = needed(phase, surface)
    if turning is None:
        raise HandoffError(
            "hand-off refused: the removal's point target cannot carry what the capture leaves\n"
            f"  spin of target and net {float(np.linalg.norm(handed.joint.spin)):.4g} N m s, "
            f"{record.spin.attachment_speed:.4g} m/s at the tether's end; "
            f"the first tug at {record.spin.tug_speed:.4g} m/s\n"
            f"  {record.reason}\n"
            f"  {carrier(phase, surface)} would carry it"
        )
    record.phase = turning


def close_ledger(record: HandoffRecord, component: Steppable) -> None:
    """Read back what the removal holds, fill the ledger, and compare what it computed from it."""
    missing = [name for name in REMOVAL_SETS if name not in component.variables]
    if missing:
        raise HandoffError(f"hand-off violated: the removal FMU lacks {', '.join(missing)}")
    there = [name for name in (*LINE_HELD, *TAKES, *TURNING_SETS, *APPENDAGE) if name in component.variables]
    held = component.get([*REMOVAL_SETS, *there])
    chaser, target = held_bodies(held)
    turning = held_turning(held)
    apart = target.position - chaser.position
    if turning is None:
        of_line = line_rows(record.line, record.line_parameters, held, float(np.linalg.norm(apart)))
    else:
        of_line = attached_rows(record.line, held, turning.attachment, apart)
    of_line += drawn_rows(record.handed, component) + ([] if record.net is None else record.net.rows(held))
    record.rows = ledger(record.handed, held, turning, record.appendage) + of_line
    record.checks = _cross_check(record, component)
    wrong = (c for c in record.checks if not abs(c.found - c.given) <= c.tolerance)
    text = "{0.quantity}: handed over {0.given:.12g} {0.unit}, the removal computes {0.found:.12g} {0.unit}"
    require_closed(record.rows, [text.format(check) for check in wrong])


def _cross_check(record: HandoffRecord, component: Steppable) -> list[Check]:
    """Sizes that do not depend on the frame they are formed in, as far as the component gives the outputs for them."""
    handed, attachment = record.handed, record.line_parameters.get(ATTACHMENT)
    joint, chaser = handed.joint, handed.chaser
    relative, rate = joint.position - chaser.position, joint.velocity - chaser.velocity
    distance, speed = float(np.linalg.norm(relative)), float(np.linalg.norm(rate))
    turned = CROSS_CHECK * (speed + float(np.linalg.norm(handed.turning)) * distance)
    expected = [
        ("separation", ("separation",), distance, CROSS_CHECK * distance, "m"),
        ("size of relative.position", _elements("relative.position"), distance, CROSS_CHECK * distance, "m"),
        ("size of relative.velocity", _elements("relative.velocity"), speed, turned, "m/s"),
    ]
    if attachment is not None:
        length = abs(distance - attachment)
        expected.append(("size of tether.length", ("tether.length",), length, CROSS_CHECK * distance, "m"))
    if record.turning:
        moving, spun = record.appendage, joint.spin
        if moving is not None:
            spun = spun + moving.momentum
            own, lost = float(np.linalg.norm(moving.momentum)), moving.lost(joint.inertia)
            expected += [
                ("size of appendage.momentum", _elements("appendage.momentum"), own, CROSS_CHECK * own, "N m s"),
                ("appendage.energy", ("appendage.energy",), lost, CROSS_CHECK * moving.own_energy, "J"),
            ]
        spin, span = float(np.linalg.norm(spun)), record.line.reach
        turns = float(np.linalg.norm(np.linalg.solve(joint.inertia, spun)))
        expected += [
            ("size of target.spin", _elements("target.spin"), spin, CROSS_CHECK * spin, "N m s"),
            ("size of target.rate", _elements("target.rate"), turns, CROSS_CHECK * turns, "rad/s"),
            ("tether.span", ("tether.span",), span, CROSS_CHECK * span, "m"),
        ]
    checks = []
    for label, names, given, tolerance, unit in expected:
        if all(name in component.variables for name in names):
            found = component.get(names)
            checks.append(Check(label, given, float(np.linalg.norm([found[n] for n in names])), tolerance, unit))
    return checks


def _elements(name: str) -> tuple[str, ...]:
    return tuple(f"{name}[{i}]" for i in (1, 2, 3))


def findings(record: HandoffRecord) -> Iterator[Finding]:
    handed, bound = record.handed, record.bound
    relative = handed.joint.velocity - handed.chaser.velocity
    distance = handed.joint.position - handed.chaser.position
    spin, energy = float(np.linalg.norm(handed.joint.spin)), spin_energy(handed.joint)
    yield Finding("hand-off", "time", "handed over, after the shot", record.time, "s")
    yield Finding("hand-off", "mass", "mass of target and net", handed.joint.mass, "kg")
    yield Finding("hand-off", "distance", "distance chaser to target", float(np.linalg.norm(distance)), "m")
    yield Finding(
        "hand-off", "relative_speed", "relative speed", float(np.linalg.norm(relative)), "m/s", shown_in="mm/s"
    )
    yield Finding("hand-off", "target", "target in the removal", record.level)
    yield Finding("hand-off", "target_reason", "why so", record.reason)
    if record.level == HULL and record.shortfall > 0.0:
        yield Finding("hand-off", "beyond_hull", "it reaches beyond its hull there by at most", record.shortfall, "m")
    what = ("spin", "carried over") if record.turns else ("spin_dropped", "dropped (a point target has none)")
    yield Finding("hand-off", what[0], f"spin {what[1]}", spin, "N m s")
    what = (
        ("spin_energy", "of the spin carried over") if record.turns else ("spin_energy_dropped", "of the dropped spin")
    )
    yield Finding("hand-off", what[0], f"energy {what[1]}", energy, "J")
    yield Finding(
        "hand-off", "body_rate", "target turns, relative to the tether, at", bound.rate, "rad/s", shown_in="deg/s"
    )
    if not record.turns:
        speed = record.spin.attachment_speed
        yield Finding(
            "hand-off", "attachment_speed", "its spin moves the tether's end by at most", speed, "m/s", shown_in="mm/s"
        )
    yield Finding(
        "hand-off", "tug_speed", "speed of the first tug, estimated", record.spin.tug_speed, "m/s", shown_in="mm/s"
    )
    if np.isfinite(bound.largest):
        yield Finding(
            "hand-off",
            "point_bound_time",
            "a point target shifts the time of the first tug by at most",
            bound.time,
            shown_in="%",
        )
        yield Finding(
            "hand-off",
            "point_bound_peak",
            "a point target changes the peak of the first tug by at most",
            bound.peak,
            shown_in="%",
        )
    yield from _of_line(record)
    yield from () if record.net is None else record.net.findings("hand-off")
    if record.rows:
        yield from closure_finding("hand-off", record.rows)
        book = next(row for row in record.rows if row.quantity == "kinetic energy")
        lost = book.accounted - (0.0 if record.turns else spin_energy(handed.joint))
        if (moving := record.appendage) is not None:
            frozen = moving.lost(handed.joint.inertia)
            lost -= frozen
            size = float(np.linalg.norm(moving.momentum))
            yield Finding(
                "hand-off", "appendage_momentum", "spin that its appendage, held fast, gives it", size, "N m s"
            )
            yield Finding("hand-off", "appendage_energy", "energy lost as it is held fast", frozen, "J")
        yield Finding("hand-off", "energy_lost", "energy lost as the net joins", lost, "J")


def _of_line(record: HandoffRecord) -> Iterator[Finding]:
    """Which line was handed over, and what is not as it was."""
    line = record.line
    if line.length is not None:
        yield Finding("hand-off", "line", "tether, chaser to net's vertex", line.length, "m")
    yield Finding(
        "hand-off", "attachment_distance", "net's vertex to the target's centre of mass", line.attachment, "m"
    )
    for row in record.rows:
        if row.quantity == SLACK:
            yield Finding("hand-off", "slack", "slack of the tether", row.before, "m")
            yield Finding("hand-off", "slack_after", "slack of the tether in the removal", row.after, "m")
        if row.quantity == OFFSET and row.account:
            yield Finding("hand-off", "line_carried", "tether", row.account)
