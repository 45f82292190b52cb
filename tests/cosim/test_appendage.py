"""An appendage that the removal holds fast: the hand-over books what that takes, and the FMU makes the same of it."""

from typing import Any

import numpy as np
import pytest

from dcone_cosim.errors import HandoffError
from dcone_cosim.handoff import Handoff, prepare
from dcone_cosim.line import line_of
from dcone_cosim.loading import load
from dcone_cosim.transaction import HandoffRecord, close_ledger
from fmu_src.instance import Instance
from fmu_src.tethered_deorbit.interface import MODEL
from tests.cosim.raw_world import RATE, Points, world
from tests.plain import PlainInstance, plain

__all__ = ["plain"]
SPEED = np.radians(2.0)
PANEL = np.array([[1.6, 0.3, 0.0], [2.8, 0.3, 0.1], [1.6, -0.3, 0.1], [2.8, -0.3, -0.2]])
"""Four points of 8 kg on the target, from its centre of mass, body axes; they turn about a hinge along axis 2."""
HINGE, AXIS = np.array([1.2, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])


class Removal:
    """The FMU's kernels as a component."""

    def __init__(self, record: HandoffRecord, spoiled: float = 0.0) -> None:
        terms = {name: term for name, term in record.phase.main.terms.items() if term}
        self.variables = Instance(MODEL, terms).interface.references
        component: Any = self
        given: dict[str, Any] = dict(record.phase.main.parameters) | record.parameters(component)
        if spoiled:
            given["appendage.rate"] += spoiled
        self.instance = PlainInstance(MODEL, terms, given)

    def get(self, names: list[str]) -> dict[str, float]:
        return {name: float(self.instance[name]) for name in names}


def asked() -> list[str]:
    panel = Points(np.full(4, 8.0), PANEL, np.zeros((4, 3)))
    inertia, center = panel.inertia(), panel.center()[0]
    places = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
    values = {
        "mass": '"32 kg"',
        "inertia": str([f"{inertia[place]!r} kg m2".replace("np.float64(", "").replace(")", "") for place in places]),
        "center": str([f"{float(x)!r} m" for x in center]),
        "hinge": str([f"{float(x)!r} m" for x in HINGE]),
        "axis": str(AXIS.tolist()),
        "rate": '"2 deg/s"',
    }
    return ['removal.target.body="box"', *(f"removal.appendage.{name}={value}" for name, value in values.items())]


def handed_over() -> tuple[Handoff, HandoffRecord]:
    made = world(3)
    found = prepare(made.outputs(), RATE)
    removal = load("tumbling-mission", tuple(asked())).phases[1]
    return found, HandoffRecord(10.0, 10.0, "told", removal, found, line_of(found, 14.0))


def test_the_ledger_closes_with_it(plain: None) -> None:
    """Spin and energy before are those of the target, the net, and four points that turn about the hinge, by sums."""
    made = world(3)
    found, record = handed_over()
    component: Any = Removal(record)
    close_ledger(record, component)
    assert record.failure == ""
    rows = {row.quantity: row for row in record.rows}
    to_frame = made.attitude.as_matrix()
    # the same target and net as one body, on it four points whose velocities differ by the hinge's turning
    relative = np.cross(SPEED * AXIS, PANEL - HINGE) @ to_frame.T
    center = found.joint.position
    places = found.target.position + PANEL @ to_frame.T - center
    momentum = (8.0 * np.cross(places, relative)).sum(axis=0)
    for axis, label in enumerate(("radial", "along-track", "cross-track")):
        row = rows[f"angular momentum, relative part of the appendage, {label}"]
        assert row.before == pytest.approx(momentum[axis], abs=1e-12 * float(np.abs(momentum).max()))
        after = rows[f"angular momentum, spin part, {label}"].after
        assert after == pytest.approx(found.joint.spin[axis] + momentum[axis], rel=1e-9)
    turning = np.linalg.solve(found.joint.inertia, found.joint.spin)
    drift = (8.0 * relative).sum(axis=0) / found.joint.mass
    extra = 0.5 * 8.0 * float((relative**2).sum()) - 0.5 * found.joint.mass * float(drift @ drift)
    extra += float(turning @ momentum)
    spun = found.joint.spin + momentum
    lost = 0.5 * float(found.joint.spin @ turning) + extra
    lost -= 0.5 * float(spun @ np.linalg.solve(found.joint.inertia, spun))
    told = {finding.key: finding.value for finding in record.findings()}
    assert told["appendage_energy"] == pytest.approx(lost, rel=1e-10)
    assert told["spin"] == pytest.approx(float(np.linalg.norm(spun)), rel=1e-12)
    assert told["spin_energy"] == pytest.approx(
        0.5 * float(spun @ np.linalg.solve(found.joint.inertia, spun)), rel=1e-12
    )
    assert told["appendage_momentum"] == pytest.approx(float(np.linalg.norm(momentum)), rel=1e-12)
    assert component.instance["appendage.energy"] == pytest.approx(lost, rel=1e-10)
    assert "lost as the appendage was held fast" in rows["kinetic energy"].account


def test_another_rate_in_the_removal_is_seen(plain: None) -> None:
    _, record = handed_over()
    component: Any = Removal(record, spoiled=1e-3)
    with pytest.raises(HandoffError, match=r"spin part(.|\n)*kinetic energy(.|\n)*appendage\.momentum"):
        close_ledger(record, component)


def test_the_scene_that_is_shipped() -> None:
    scene = load("held-panel")
    assert not scene.cautions
    main = scene.phases[1].main
    assert main.terms["appendage"] == "frozen"
    assert main.parameters["appendage.rate"] == pytest.approx(np.radians(4.0))
