"""The ledger of a hand-off: each conserved quantity before and after, and what is knowingly missing from it.

Linear momentum is booked with velocities as seen in the orbital frame of the target's initial centre of mass. Angular
momentum and kinetic energy are booked in axes that coincide with that frame at the instant but do not turn
(u = v + w x r, w = (0, 0, n)): only there does a spin relative to inertial space add to an orbital part. Geocentric
sums would hide everything: 1e-12 of the geocentric angular momentum is 160 N m s.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from dcone_cosim.appendage import Hinged
from dcone_cosim.errors import HandoffError
from dcone_cosim.findings import Finding
from dcone_cosim.handoff import Body, Handoff, HeldTurning, Values, Vector, held_bodies, spin_energy

CLOSURE = 1e-12
"""Largest difference of a row, as a share of the sum of the magnitudes that enter."""
AXES = ("radial", "along-track", "cross-track")


@dataclass(frozen=True)
class Check:
    """A size the removal computes from what it was handed, against the same size before."""

    quantity: str
    given: float
    found: float
    tolerance: float
    unit: str


@dataclass(frozen=True)
class LedgerRow:
    """One conserved quantity across the hand-off.

    before       sum over the bodies of the capture
    after        sum over the bodies the removal holds, from what it was read back to hold
    accounted    what is meant to be missing from `after`, found independently, and `account` says what it is
    magnitude    sum of the sizes of everything that enters
    """

    quantity: str
    unit: str
    before: float
    after: float
    accounted: float
    account: str
    magnitude: float

    @property
    def difference(self) -> float:
        return self.before - self.after - self.accounted

    @property
    def closure(self) -> float:
        """|difference| as a share of the sum of magnitudes."""
        if self.magnitude == 0.0:
            return 0.0 if self.difference == 0.0 else math.inf
        return abs(self.difference) / self.magnitude

    @property
    def closed(self) -> bool:
        return self.closure <= CLOSURE

    @classmethod
    def of(cls, told: Mapping[str, Any]) -> LedgerRow:
        """The row that `as_dict` told of."""
        before, after, accounted = (float(told[name]) for name in ("before", "after", "accounted"))
        size = float(told["sum_of_magnitudes"])
        return cls(told["quantity"], told["unit"], before, after, accounted, told["account"], size)

    def as_dict(self) -> dict[str, str | float | bool]:
        return {
            "quantity": self.quantity,
            "unit": self.unit,
            "before": self.before,
            "after": self.after,
            "accounted": self.accounted,
            "account": self.account,
            "difference": self.difference,
            "sum_of_magnitudes": self.magnitude,
            "relative_closure": self.closure,
            "closed": self.closed,
        }


def require_closed(rows: Iterable[LedgerRow], more: Sequence[str] = ()) -> None:
    """`HandoffError` with every row that does not close, and with what else is found wrong."""
    broken = [
        f"{row.quantity}: before {row.before:.17g} {row.unit}, after {row.after:.17g} {row.unit}, "
        f"difference {row.difference:.3g} {row.unit} is {row.closure:.3g} of the sum of magnitudes"
        for row in rows
        if not row.closed
    ]
    broken += more
    if broken:
        raise HandoffError("hand-off violated: the ledger does not close\n  " + "\n  ".join(broken))


def closure_finding(place: str, rows: Sequence[LedgerRow]) -> Iterator[Finding]:
    """To what share of what enters the worst row closes; none without rows."""
    if rows:
        worst = max(row.closure for row in rows)
        yield Finding(place, "ledger_closure", "ledger closes to, relative to what enters it", worst)


def ledger(
    handed: Handoff, removal: Values, turning: HeldTurning | None = None, moving: Hinged | None = None
) -> list[LedgerRow]:
    """Every conserved quantity, before from the capture, after from what the removal was read back to hold.

    turning      of its target, None for a point
    moving       of an appendage that is held fast, orbital axes: as the scene says; or as it swings in the capture,
                 the spin and energy of whose target then have it in them
    """
    before = [handed.chaser, handed.target, handed.catch]
    chaser, target = held_bodies(removal)
    if turning is not None:
        target = replace(target, spin=turning.spin, inertia=turning.inertia)
    after = [chaser, target]
    rows = _sum_rows(before, after)
    rows += _angular_rows(before, after, handed.joint, handed.turning, moving if handed.swing is None else None)
    if turning is not None:
        rows += _inertia_rows(handed.joint, target)
    rows.append(_energy_row(handed, after, moving))
    return rows


def _inertia_rows(joint: Body, held: Body) -> Iterator[LedgerRow]:
    """Moments of inertia of target and net, along orbital axes."""
    size = float(np.abs(joint.inertia).sum())
    for i, first in enumerate(AXES):
        for j, second in enumerate(AXES[i:], i):
            was, now = float(joint.inertia[i, j]), float(held.inertia[i, j])
            yield LedgerRow(f"inertia, target and net, {first}, {second}", "kg m2", was, now, 0.0, "", size)


def _sum_rows(before: list[Body], after: list[Body]) -> list[LedgerRow]:
    """Mass, mass moment and linear momentum, of each body and of all.

    The sums alone would not see two bodies that exchange momentum, or change places.
    """
    sides = (("chaser", before[:1], after[:1]), ("target and net", before[1:], after[1:]), ("all", before, after))
    rows = []
    total = sum(b.mass for b in before)
    for side, old, new in sides:
        was, now = math.fsum(b.mass for b in old), math.fsum(b.mass for b in new)
        rows.append(LedgerRow(f"mass, {side}", "kg", was, now, 0.0, "", total))
    for quantity, unit, name in (("mass moment", "kg m", "position"), ("linear momentum", "N s", "velocity")):
        size = sum(b.mass * float(np.linalg.norm(getattr(b, name))) for b in before)
        for side, old, new in sides:
            for axis, label in enumerate(AXES):
                was, now = (math.fsum(b.mass * float(getattr(b, name)[axis]) for b in part) for part in (old, new))
                rows.append(LedgerRow(f"{quantity}, {side}, {label}", unit, was, now, 0.0, "", size))
    return rows


def _orbital_parts(bodies: list[Body], turning: Vector) -> list[Vector]:
    """Angular momentum of each body's centre of mass about the joint centre of mass, non-turning axes [N m s]."""
    mass = sum(b.mass for b in bodies)
    center = sum((b.mass * b.position for b in bodies), np.zeros(3)) / mass
    rate = sum((b.mass * b.velocity for b in bodies), np.zeros(3)) / mass
    parts = []
    for b in bodies:
        arm = b.position - center
        parts.append(b.mass * np.cross(arm, b.velocity - rate + np.cross(turning, arm)))
    return parts


def _angular_rows(
    before: list[Body], after: list[Body], joint: Body, turning: Vector, moving: Hinged | None
) -> list[LedgerRow]:
    orbital, kept = _orbital_parts(before, turning), _orbital_parts(after, turning)
    moved = sum(_orbital_parts(before[1:], turning), np.zeros(3))
    spins = [b.spin for b in before] + ([] if moving is None else [moving.momentum])
    size = sum(float(np.linalg.norm(p)) for p in orbital)
    size_spin = sum(float(np.linalg.norm(p)) for p in (*spins, moved))
    carried = after[1].inertia.any()
    account = "" if carried else "dropped: a point target has no spin"
    rows = []
    for axis, label in enumerate(AXES):
        rows.append(
            LedgerRow(
                f"angular momentum, orbital part, {label}",
                "N m s",
                math.fsum(float(p[axis]) for p in orbital),
                math.fsum(float(p[axis]) for p in kept),
                float(moved[axis]),
                "became spin when the net joined the target",
                size,
            )
        )
    for axis, label in enumerate(AXES if moving else ()):
        was = float(moving.momentum[axis]) if moving else 0.0
        name = f"angular momentum, relative part of the appendage, {label}"
        rows.append(LedgerRow(name, "N m s", was, 0.0, was, "became spin when the appendage was held fast", size_spin))
    for axis, label in enumerate(AXES):
        rows.append(
            LedgerRow(
                f"angular momentum, spin part, {label}",
                "N m s",
                math.fsum(float(p[axis]) for p in (*spins, moved)),
                float(after[1].spin[axis]),
                0.0 if carried else float(joint.spin[axis]),
                account,
                size_spin,
            )
        )
    return rows


def _energy_row(handed: Handoff, after: list[Body], moving: Hinged | None) -> LedgerRow:
    turning = handed.turning

    def of_motion(body: Body) -> float:
        velocity = body.inertial_velocity(turning)
        return 0.5 * body.mass * float(velocity @ velocity)

    before = [of_motion(b) for b in (handed.chaser, handed.target, handed.catch)]
    before += [handed.turning_energy, handed.catch_energy]
    joint = handed.joint
    frozen = 0.0 if moving is None else moving.lost(joint.inertia)
    swinging = 0.0 if moving is None else moving.energy(joint.spin, joint.inertia)
    if handed.swing is None and moving is not None:
        before.append(swinging)
    held = spin_energy(after[1])
    spun = spin_energy(handed.joint) + (0.0 if handed.swing is None else swinging)
    dropped = 0.0 if after[1].inertia.any() else spun
    target, catch = handed.target, handed.catch
    closing = catch.inertial_velocity(turning) - target.inertial_velocity(turning)
    reduced = target.mass * catch.mass / handed.joint.mass
    meeting = 0.5 * reduced * float(closing @ closing)
    lost = meeting + handed.turning_energy + handed.catch_energy - spun
    return LedgerRow(
        "kinetic energy",
        "J",
        math.fsum(before),
        math.fsum([*(of_motion(b) for b in after), held]),
        lost + dropped + frozen,
        f"{lost:.6g} J lost where net and target become one body"
        + (f", {dropped:.6g} J dropped with the spin" if dropped else "")
        + (f", {frozen:.6g} J lost as the appendage was held fast" if moving else ""),
        math.fsum(abs(e) for e in before),
    )
