"""The hand-off as a transaction: what it may not carry is refused before, what the removal holds is judged after.

The mapping itself is `handoff`'s, the line's `line`'s; here they are held against the capture and the removal FMU.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from dcone_cosim.errors import HandoffError
from dcone_cosim.fmu.component import Steppable
from dcone_cosim.handoff import REMOVAL_SETS, Handoff, SpinCheck, check_spin, held_bodies
from dcone_cosim.ledger import LedgerRow, ledger
from dcone_cosim.line import ATTACHMENT, LINE_HELD, REST_LENGTH, Line, line_rows
from dcone_cosim.scenes.scene import PhaseScene

CROSS_CHECK = 1e-4
"""Relative agreement asked of what the removal computes with what was handed over. It forms its outputs in the frame of
the pair's centre of mass, turned and turning a little differently: by the offset over the radius, 3e-6 for 20 m."""


@dataclass(frozen=True)
class Check:
    """A size the removal computes from what it was handed, against the same size before."""

    quantity: str
    given: float
    found: float
    tolerance: float
    unit: str


@dataclass
class HandoffRecord:
    """The transaction as it went: what was mapped, its ledger, the spin check, and why it failed if it did.

    time              of the hand-over, since the shot [s]
    line_parameters   what is set in the removal so that its line is the capture's
    """

    time: float
    located_by: str
    handed: Handoff
    line: Line
    spin: SpinCheck
    line_parameters: dict[str, float] = field(default_factory=dict)
    rows: list[LedgerRow] = field(default_factory=list)
    checks: list[Check] = field(default_factory=list)
    failure: str = ""


def check_before(record: HandoffRecord, phase: PhaseScene, tolerance: float) -> None:
    """Refuse a hand-off that the removal could not carry truthfully.

    phase        the removal
    tolerance    spin allowed to the attachment, as a share of the first tug's speed
    """
    handed, line = record.handed, record.line
    elastic, commanded = phase.setting(REST_LENGTH), phase.setting("reel.length")
    length = commanded if elastic is None else elastic
    slack = 0.0 if length is None else length + line.attachment - line.distance
    spin = check_spin(handed, slack, phase.setting("thrust.level") or 0.0, tolerance)
    record.spin = spin
    if elastic is not None and line.overrun:
        raise HandoffError(
            f"hand-off refused: at t = {record.time:.6g} s the chaser and the net's vertex are {line.reach:.6g} m "
            f"apart, the tether is {line.length:.6g} m long; give it more, or shoot from nearer"
        )
    if not spin.accepted:
        raise HandoffError(
            "hand-off refused: the removal's point target cannot carry the spin, and the spin would change the answer\n"
            f"  spin of target and net {float(np.linalg.norm(handed.joint.spin)):.4g} N m s "
            f"moves the tether's end at up to {spin.attachment_speed:.4g} m/s,\n"
            f"  {spin.share:.3g} times the {spin.tug_speed:.4g} m/s of the first tug; "
            f"handoff.spin_tolerance allows {spin.tolerance:g}\n"
            "  a removal whose target is a rigid body would carry it"
        )


def close_ledger(record: HandoffRecord, component: Steppable) -> None:
    """Read back what the removal holds, fill the ledger, and compare what it computed from it."""
    missing = [name for name in REMOVAL_SETS if name not in component.variables]
    if missing:
        raise HandoffError(f"hand-off violated: the removal FMU lacks {', '.join(missing)}")
    held = component.get([*REMOVAL_SETS, *(name for name in LINE_HELD if name in component.variables)])
    chaser, target = held_bodies(held)
    apart = float(np.linalg.norm(target.position - chaser.position))
    record.rows = ledger(record.handed, held) + line_rows(record.line, record.line_parameters, held, apart)
    record.checks = _cross_check(record, component)
    broken = [
        f"{row.quantity}: before {row.before:.17g} {row.unit}, after {row.after:.17g} {row.unit}, "
        f"difference {row.difference:.3g} {row.unit} is {row.closure:.3g} of the sum of magnitudes"
        for row in record.rows
        if not row.closed
    ]
    broken += [
        f"{c.quantity}: handed over {c.given:.12g} {c.unit}, the removal computes {c.found:.12g} {c.unit}"
        for c in record.checks
        if not abs(c.found - c.given) <= c.tolerance
    ]
    if broken:
        raise HandoffError("hand-off violated: the ledger does not close\n  " + "\n  ".join(broken))


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
    checks = []
    for label, names, given, tolerance, unit in expected:
        if all(name in component.variables for name in names):
            found = component.get(names)
            checks.append(Check(label, given, float(np.linalg.norm([found[n] for n in names])), tolerance, unit))
    return checks


def _elements(name: str) -> tuple[str, ...]:
    return tuple(f"{name}[{i}]" for i in (1, 2, 3))
