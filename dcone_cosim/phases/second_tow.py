"""A second tow: the line of the removal is cut, and the chaser tows on with another, from where both bodies are.

altitude = |r| - R,   tan i = |(h_x, h_y)|/h_z,   tan raan = h_x/(-h_y)         the circle through the point
start.center_velocity = (e_r . v, e_t . v - sqrt(mu/r), 0)                      as seen in its turning frame
start.relative_velocity = rho' + (w - n) x rho,   w = h/r^2, n = sqrt(mu/r^3)   rho' in the removal's frame
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from dcone_cosim.contract import ENDED, HANDED_OVER
from dcone_cosim.errors import HandoffError
from dcone_cosim.findings import Finding
from dcone_cosim.fmu.component import Steppable
from dcone_cosim.handoff import Vector
from dcone_cosim.ledger import LedgerRow, closure_finding, require_closed
from dcone_cosim.level import (
    ATTITUDE,
    CENTER,
    GROUP,
    INERTIA,
    PLACE,
    RATE,
    RATE_FRAME,
    SHAPE,
    TURNING_SETS,
    carries_spin,
    needed,
)
from dcone_cosim.line import ATTACHMENT, REST_LENGTH
from dcone_cosim.phases import removal
from dcone_cosim.phases.phase import Stage
from dcone_cosim.phases.removal import EACH, RELATIVE, Tow
from dcone_cosim.pulled import COMPLIANCE
from dcone_cosim.results import Handover, PhaseResult, RunResult
from dcone_cosim.scene.data import PhaseScene
from dcone_cosim.scene.mistakes import Mistake
from dcone_cosim.scene.toml_lines import given_at
from orbital.constants import EARTH_EQUATORIAL_RADIUS, EARTH_MU
from orbital.rotations import from_matrix, multiply

BODIES = ("chaser", "target")
AXES = ("x", "y", "z")
TENSION = "tether.tension"
EPOCH = "orbit.epoch"
NODES, NET = "lumped", "net"
GIVES = "net.compliance"
SPIN = tuple(f"target.spin{each}" for each in EACH)
TURNED = (*(f"target.attitude[{i}]" for i in (1, 2, 3, 4)), *(f"target.rate{each}" for each in EACH))
ROUNDING = 8.0 * 2.0**-52
"""Share of the largest coordinate by which a relative state may differ: it is formed again from geocentric ones [1]."""


def vector(values: Mapping[str, float], name: str) -> Vector:
    return np.array([values[f"{name}{each}"] for each in EACH])


def begun_again(left: Mapping[str, float]) -> dict[str, float]:
    """Parameters of a removal that begins where another has left both bodies.

    left    its masses, and its outputs center.* (inertial) and relative.* (orbital frame of the centre of mass), SI

    Source   the frames of `orbital.frames`; the circle through a point and along its velocity's plane
    Checked  tests/cosim/test_second_tow.py
    """
    position, velocity = vector(left, "center.position"), vector(left, "center.velocity")
    momentum = np.cross(position, velocity)
    radius, spin = float(np.linalg.norm(position)), float(np.linalg.norm(momentum))
    radial, normal = position / radius, momentum / spin
    along = np.cross(normal, radial)
    raan = math.atan2(normal[0], -normal[1]) if normal[0] or normal[1] else 0.0
    node = np.array([math.cos(raan), math.sin(raan), 0.0])
    from_node = math.atan2(float(position @ np.cross(normal, node)), float(position @ node))
    relative, rate = vector(left, "relative.position"), vector(left, "relative.velocity")
    turning = spin / radius**2 - math.sqrt(EARTH_MU / radius**3)
    rate = rate + turning * np.array([-relative[1], relative[0], 0.0])
    seen = np.array([radial @ velocity, along @ velocity - math.sqrt(EARTH_MU / radius), 0.0])
    found = {
        "orbit.altitude": radius - EARTH_EQUATORIAL_RADIUS,
        "orbit.eccentricity": 0.0,
        "orbit.inclination": math.atan2(math.hypot(normal[0], normal[1]), normal[2]),
        "orbit.raan": raan,
        "orbit.argument_of_perigee": 0.0,
        "orbit.true_anomaly": from_node,
        **{f"{body}.mass": left[f"{body}.mass"] for body in BODIES},
    }
    for name, value in (
        ("center_position", np.zeros(3)),
        ("center_velocity", seen),
        ("relative_position", relative),
        ("relative_velocity", rate),
    ):
        found |= {f"start.{name}{each}": float(x) for each, x in zip(EACH, value, strict=True)}
    return found


def turning_again(left: Mapping[str, float], inertial: float) -> dict[str, float]:
    """Parameters of a target that turns on where another tow has left it.

    left        its inertia and attachment, its outputs target.attitude (to inertial axes) and target.rate, and the
                centre's, SI
    inertial    value of the choice by which rates are relative to inertial space

    Source   the frame of `begun_again`: its axes are radial, along-track and cross-track
    Checked  tests/cosim/test_second_tow.py
    """
    position, velocity = vector(left, "center.position"), vector(left, "center.velocity")
    normal = np.cross(position, velocity)
    basis = np.array([position, np.cross(normal, position), normal])
    basis /= np.linalg.norm(basis, axis=1)[:, None]
    to_orbital = np.empty(4)
    from_matrix(to_orbital, basis)
    attitude = np.empty(4)
    multiply(attitude, to_orbital, np.array([left[name] for name in TURNED[:4]]))
    found = {name: float(x) for name, x in zip(ATTITUDE, attitude, strict=True)}
    found |= {name: left[rate] for name, rate in zip(RATE, TURNED[4:], strict=True)}
    return found | {name: left[name] for name in (*INERTIA, *PLACE)} | {RATE_FRAME: inertial}


@dataclass
class TowHandover:
    """The hand-over from one tow to the next: what was left, and whether the next one holds it.

    time     since the tow before began [s]
    left     `SecondTow.takes` as the tow before left them, SI
    """

    time: float
    start: float
    phase: PhaseScene
    left: Mapping[str, float]
    reach: float | None
    rows: list[LedgerRow] = field(default_factory=list)
    failure: str = ""

    def parameters(self, component: Steppable) -> dict[str, float]:
        found = begun_again(self.left) | {"start.condition": self.phase.choice("start.condition", HANDED_OVER)}
        if ATTACHMENT in component.variables and ATTACHMENT in self.left:
            found[ATTACHMENT] = self.left[ATTACHMENT]
        if GIVES in component.variables and GIVES in self.left:
            found[GIVES] = self.left[GIVES]
        epoch = self.left.get(EPOCH, self.phase.setting(EPOCH))
        if EPOCH in component.variables and epoch is not None:
            found[EPOCH] = epoch + self.time
        if self.turns:
            inertial = self.phase.choice(RATE_FRAME, "inertial")
            found |= turning_again(self.left, inertial)
            found |= {name: self.left[name] for name in (*CENTER, *SHAPE.values()) if name in self.left}
        return found

    @property
    def turns(self) -> bool:
        """Whether the target turns."""
        return carries_spin(self.left) and carries_spin(self.phase.main.defaults)

    def close(self, component: Steppable) -> None:
        """Mass, mass moment and momentum of each body by the inertial outputs of both, and the relative state."""
        given = (GIVES,) if GIVES in self.left and GIVES in component.variables else ()
        held = component.get([*SecondTow.takes, *given, *(SPIN if self.turns else ())])
        self.rows = list(_rows(self.left, held))
        moved = []
        for name, of in (("relative.position", "position"), ("relative.velocity", "velocity")):
            apart = float(np.linalg.norm(vector(held, name) - vector(self.left, name)))
            largest = max(float(np.linalg.norm(vector(self.left, f"{body}.{of}"))) for body in BODIES)
            if not apart <= ROUNDING * largest:
                moved.append(f"{name}: differs by {apart:.3g}, more than rounding, {ROUNDING * largest:.3g}, explains")
        require_closed(self.rows, moved)

    def recall(self, told: Mapping[str, Any]) -> None:
        self.rows, self.failure = [LedgerRow.of(row) for row in told["rows"]], told["failure"]

    def findings(self) -> list[Finding]:
        place = f"hand-off to {self.phase.name}"
        apart = float(np.linalg.norm(vector(self.left, "relative.position")))
        speed = float(np.linalg.norm(vector(self.left, "relative.velocity")))
        rows = [
            Finding(place, "time", "after the tow before began", self.time, "s"),
            Finding(place, "distance", "distance chaser to target", apart, "m"),
            Finding(place, "relative_speed", "relative speed", speed, "m/s", shown_in="mm/s"),
            Finding(place, "tension_cut", "tension of the tether as it was cut", self.left[TENSION], "N"),
        ]
        return [*rows, *closure_finding(place, self.rows)]

    def told(self) -> dict[str, Any]:
        return {
            "time": {"value": self.time, "unit": "s", "clock": "since the tow before began"},
            "rows": [row.as_dict() for row in self.rows],
            "left": dict(self.left),
            "failure": self.failure,
        }


def _rows(before: Mapping[str, float], after: Mapping[str, float]) -> Iterator[LedgerRow]:
    """Conserved quantities in inertial axes about the Earth's centre, of what both FMUs say of the same instant."""
    for body in BODIES:
        old, new = before[f"{body}.mass"], after[f"{body}.mass"]
        yield LedgerRow(f"mass, {body}", "kg", old, new, 0.0, "", old)
        for quantity, unit, of in (("mass moment", "kg m", "position"), ("linear momentum", "N s", "velocity")):
            was, now = old * vector(before, f"{body}.{of}"), new * vector(after, f"{body}.{of}")
            size = float(np.linalg.norm(was))
            for axis, x, y in zip(AXES, was.tolist(), now.tolist(), strict=True):
                yield LedgerRow(f"{quantity}, {body}, {axis}", unit, x, y, 0.0, "", size)
    if GIVES in after:
        yield LedgerRow(COMPLIANCE, "m/N", before[GIVES], after[GIVES], 0.0, "", before[GIVES])
    if SPIN[0] in after:
        was, now = vector(before, "target.spin"), vector(after, "target.spin")
        for axis, x, y in zip(AXES, was.tolist(), now.tolist(), strict=True):
            yield LedgerRow(
                f"angular momentum, spin of the target, {axis}", "N m s", x, y, 0.0, "", float(np.linalg.norm(was))
            )


class SecondTow(Tow):
    name = "second_tow"
    follows = ("removal",)
    alone = False
    takes = (
        *("chaser.mass", "target.mass", TENSION),
        *(f"{body}.{of}{each}" for body in (*BODIES, "center") for of in ("position", "velocity") for each in EACH),
        *RELATIVE,
    )
    takes_too = (ATTACHMENT, GIVES, EPOCH, *TURNING_SETS, *CENTER, *SHAPE.values(), *SPIN, *TURNED)
    taken_over = (*Tow.taken_over, GIVES)
    tugs_file = "second_tow_tugs"
    figure_names = ("second_tow_orbital_radius.png", "second_tow_tether_tension.png")

    def value_faults(self, before: PhaseScene | None, own: PhaseScene, tables: Mapping[str, Any]) -> Iterator[Mistake]:
        """Those of every tow; the mass of a line of nodes would come from nowhere, or be gone; the net is in both."""
        yield from super().value_faults(before, own, tables)
        for phase in (before, own):
            if phase is not None and NODES in phase.main.terms:
                text = "has mass, which is not handed over from one tow to the next; leave it out"
                yield Mistake((phase.name, NODES), given_at(tables, (phase.name, NODES)), text)
        has = [phase for phase in (before, own) if phase is not None and NET in phase.main.terms]
        if before is not None and len(has) == 1 and before.main.fmu is None and own.main.fmu is None:
            lacks = before.name if has[0] is own else own.name
            text = f"holds the target in both tows: give [{lacks}.{NET}] as well, or leave this out"
            yield Mistake((has[0].name, NET), given_at(tables, (has[0].name, NET)), text)

    def values_taken(self, before: PhaseScene) -> dict[str, float]:
        return {name: value for body in BODIES if (value := before.setting(name := f"{body}.mass")) is not None}

    def take_over(self, stage: Stage) -> Handover | None:
        """Where the tow before left both bodies; `HandoffError` where the new line is too short for that."""
        if stage.before is None:  # taken out of its scene, with what was handed over as its own values
            return None
        run, phase, tow = stage.run, stage.phase, stage.run.phases[stage.before.name]
        left, earlier = run.left[stage.before.name], run.handovers.get(stage.before.name)
        reach = None if earlier is None else earlier.reach
        record = TowHandover(tow.end - tow.start, tow.origin + tow.end, phase, left, reach)
        run.handovers[self.name] = record
        if carries_spin(left) and not carries_spin(phase.main.defaults):
            turning = needed(phase, stage.before.main.terms.get(GROUP, ""))
            if turning is None:
                raise HandoffError(
                    f"hand-off refused: the target of the {stage.before.name} turns, and that of the {self.spoken} is "
                    f'a point, which cannot carry its spin; leave out [{self.name}.target] body = "point"'
                )
            record.phase = phase = turning
        if tow.outcome == ENDED:
            raise HandoffError(f"hand-off refused: the FMU of the {stage.before.name} ended itself\n  {tow.ended_by}")
        length, apart = phase.setting(REST_LENGTH), float(np.linalg.norm(vector(left, "relative.position")))
        arm = left.get(ATTACHMENT, math.hypot(*(left.get(name, 0.0) for name in PLACE)))
        reaches = math.inf if length is None else length + arm
        if apart > reaches:
            raise HandoffError(
                f"hand-off refused: the bodies are {apart:.6g} m apart, and the new line reaches {reaches:.6g} m: "
                f"{self.name}.{REST_LENGTH} must be larger"
            )
        self.foresee(stage)
        return record

    def clock(self, run: RunResult) -> str:
        record = run.handovers.get(self.name)
        before = f", which was {record.time!r} s after the tow before began" if record is not None else ""
        return f"since the hand-over{before}"

    def spreads(self, run: RunResult, result: PhaseResult) -> Mapping[str, float]:
        """At least those of the tow before, where that is chaotic."""
        before = run.phases[removal.PHASE.name]
        return {**removal.PHASE.spreads(run, before), **super().spreads(run, result)}


PHASE = SecondTow()
