"""An appendage that swings in the capture is held fast as the tow begins: mass, inertia, centre and hinge at the angle
of then, momenta and energy by two bodies."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from dcone_cosim import build
from dcone_cosim.errors import HandoffError
from dcone_cosim.handoff import Handoff, prepare
from dcone_cosim.line import line_of
from dcone_cosim.loading import load, shipped
from dcone_cosim.phases import swinging
from dcone_cosim.scene.mistakes import SceneError
from dcone_cosim.transaction import HandoffRecord, close_ledger
from tests.cosim.raw_world import RATE, Points, world
from tests.cosim.test_appendage import Removal
from tests.net_capture.two_bodies import body_turn
from tests.plain import plain

__all__ = ["plain"]
TOW = """
[removal]
macro_step = "1 s"
duration = "1 h"

[removal.target]
body = "rigid"

[removal.appendage]

[removal.reel]
law = "locked"

[removal.tether]
rest_length = "13 m"
diameter = "1 mm"
"""
ANGLE, SPEED = 0.7, -0.4
SPIN = np.array([0.05, -0.03, 0.08])
"""Rate of the rest of the target, its axes [rad/s]."""
BOXES = (
    (np.array([1.6, 1.8, 2.0]), 700.0, np.array([0.0, 0.0, 0.0])),
    (np.array([0.2, 0.2, 0.44]), 2.0, np.array([0.0, 0.0, 1.2])),
    (np.array([1.6, 0.1, 1.0]), 20.0, np.array([0.0, 0.0, 1.9])),
)
"""Edges, mass and place of body, boom and wing; the latter two swing about the first axis, through (0, 0, 1)."""
PARTS = """
[[capture.target.parts]]
shape = "box"
size = ["1.6 m", "1.8 m", "2 m"]
mass = "700 kg"

[[capture.target.parts]]
shape = "box"
size = ["20 cm", "20 cm", "0.44 m"]
mass = "2 kg"
position = ["0 m", "0 m", "1.2 m"]
hinged = true

[[capture.target.parts]]
shape = "box"
size = ["1.6 m", "10 cm", "1 m"]
mass = "20 kg"
position = ["0 m", "0 m", "1.9 m"]
hinged = true

"""
HINGE, AXIS = np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0])


def scene(tow: str = TOW) -> str:
    """The shipped one of boxes alone, in Hill's gravity, with a tow."""
    text = shipped()["hinged-panel"].read_text().replace('law = "none"', 'law = "hill"')
    text = text.replace('hand_over = "none"', 'hand_over = "tether_taut"').replace("16 m", "13 m")
    return text[: text.index("[[capture.target.parts]]")] + PARTS + text[text.index("[capture.hinge]") :] + tow


def loaded(tmp_path: Path, text: str) -> Any:
    file = tmp_path / "mine.toml"
    file.write_text(text)
    return load(str(file))


def as_points() -> tuple[Points, Points]:
    """Rest and appendage at the angle, design axes, each box as the eight points that have its moments: where they are,
    and how fast, with the rest at rest but for its turning about the origin."""
    signs = np.array(np.meshgrid(*[[-1.0, 1.0]] * 3)).reshape(3, -1).T
    swung = Rotation.from_rotvec(ANGLE * AXIS)
    found = []
    for swings in (False, True):
        masses, places, speeds = [], [], []
        for edges, mass, middle in BOXES[1:] if swings else BOXES[:1]:
            corners = middle + signs * edges / np.sqrt(12.0)
            if swings:
                corners = HINGE + swung.apply(corners - HINGE)
            masses.append(np.full(8, mass / 8.0))
            places.append(corners)
            relative = np.cross(SPEED * AXIS, corners - HINGE) if swings else 0.0
            speeds.append(np.cross(SPIN, corners) + relative)
        found.append(Points(*map(np.concatenate, (masses, places, speeds))))
    return found[0], found[1]


class Handed:
    """Such a target in the place of the other world's, as its capture tells of it, and what is handed over."""

    def __init__(self, tmp_path: Path) -> None:
        self.world = world(3)
        self.phases = loaded(tmp_path, scene()).phases
        main = self.phases[0].main
        # from body axes, those of the whole at angle 0, to design axes
        self.design = body_turn(main.made)[0]
        rest, part = as_points()
        target = rest + part
        center, drift = target.center()
        to_frame = self.world.attitude * self.design.inv()
        place, seen = (
            np.array([self.world.outputs()[f"target.{n}[{i}]"] for i in (1, 2, 3)]) for n in ("position", "velocity")
        )
        turned = to_frame.as_matrix()
        # velocities in axes that do not turn, along those of the frame
        speeds = (target.velocity - drift) @ turned.T + seen + np.cross([0.0, 0.0, RATE], place)
        self.target = Points(target.mass, place + (target.position - center) @ turned.T, speeds)
        body = self.design.inv().as_matrix()
        inertia = body @ target.inertia() @ body.T
        made = self.world.outputs() | {
            "target.mass": float(target.mass.sum()),
            "hinge.angle": ANGLE,
            "hinge.rate": SPEED,
        }
        made |= {f"target.spin[{i + 1}]": float(x) for i, x in enumerate(self.target.spin())}
        made |= {f"target.inertia[{i + 1}]": float(inertia[i, i]) for i in range(3)}
        pairs = ((0, 1), (0, 2), (1, 2))
        self.left = made | {f"target.products[{k + 1}]": float(inertia[pair]) for k, pair in enumerate(pairs)}
        values = main.values
        appendage = swinging.held(self.phases[0], self.phases[1], values, self.left)
        self.found: Handoff = prepare(self.left, RATE, appendage)
        self.record = HandoffRecord(10.0, 10.0, "told", self.phases[1], self.found, line_of(self.found, 13.0))
        net = self.world.in_frame(self.world.net)
        moved = net.velocity + np.cross([0.0, 0.0, RATE], net.position)
        self.joint = self.target + Points(net.mass, net.position, moved)


@pytest.fixture
def handed(tmp_path: Path) -> Handed:
    return Handed(tmp_path)


def test_the_whole_is_handed_over_at_the_angle_of_now(handed: Handed, plain: None) -> None:
    """Sums over points: mass, inertia and spin of target and net, before and after, to 1e-12; energy that is lost."""
    component: Any = Removal(handed.record)
    close_ledger(handed.record, component)
    assert handed.record.failure == ""
    told = component.instance
    turn = handed.world.attitude.as_matrix()
    inertia = turn.T @ handed.joint.inertia() @ turn
    held = np.array([told[f"target.inertia[{i}]"] for i in range(1, 7)])
    wanted = inertia[(0, 1, 2, 0, 0, 1), (0, 1, 2, 1, 2, 2)]
    np.testing.assert_allclose(held, wanted, atol=1e-12 * np.abs(inertia).max())
    assert np.abs(wanted[3:]).max() > 0.1
    assert told["target.mass"] == pytest.approx(handed.joint.mass.sum(), rel=1e-15)
    spin = handed.joint.spin()
    row = {one.quantity: one for one in handed.record.rows}
    after = [row[f"angular momentum, spin part, {axis}"].after for axis in ("radial", "along-track", "cross-track")]
    np.testing.assert_allclose(after, spin, atol=1e-12 * np.abs(spin).max())
    # what the FMU makes of the rest's rate and the appendage's own
    rest = np.array([told[f"target.start_rate[{i}]"] for i in (1, 2, 3)])
    made = inertia @ rest + np.array([told[f"appendage.momentum[{i}]"] for i in (1, 2, 3)])
    np.testing.assert_allclose(turn @ made, spin, atol=1e-12 * np.abs(spin).max())
    assert np.linalg.norm(made - inertia @ rest) > 0.01 * np.linalg.norm(spin)
    # the energy before is that of all points
    drift = handed.target.center()[1]
    turning = handed.target.energy() - 0.5 * handed.target.mass.sum() * drift @ drift
    assert handed.found.turning_energy == pytest.approx(turning, rel=1e-9)
    figures = {one.key: one.value for one in handed.record.findings()}
    energy = row["kinetic energy"]
    assert energy.before - energy.after == pytest.approx(figures["energy_lost"] + figures["appendage_energy"], rel=1e-9)
    assert figures["appendage_energy"] == pytest.approx(told["appendage.energy"], rel=1e-9)
    assert told["appendage.energy"] > 0.5


def test_without_net_the_rest_turns_on_as_it_did(handed: Handed) -> None:
    """Of a net that weighs nothing what is handed over is the rest's own rate, and the appendage's relative to it."""
    left = handed.left | {"catch.mass": 1e-12} | {f"catch.{n}[{i}]": 0.0 for n in ("spin",) for i in (1, 2, 3)}
    left |= {f"catch.inertia[{i}]": 0.0 for i in range(1, 7)}
    found = prepare(left, RATE, handed.found.appendage)
    rate = np.linalg.solve(found.joint.inertia, found.joint.spin)
    wanted = (handed.world.attitude * handed.design.inv()).apply(SPIN)
    np.testing.assert_allclose(rate, wanted, atol=1e-12)


def test_the_appendage_is_where_two_boxes_are(handed: Handed) -> None:
    """Mass, centre, inertia and hinge by hand, from the centre of mass of the whole at the angle."""
    rest, part = as_points()
    center, own = (rest + part).center()[0], handed.found.appendage
    body = handed.design.inv()

    def vector(name: str) -> np.ndarray:
        return np.array([own[f"appendage.{name}[{i}]"] for i in (1, 2, 3)])

    assert own["appendage.mass"] == pytest.approx(22.0, rel=1e-14)
    np.testing.assert_allclose(vector("center"), body.apply(part.center()[0] - center), atol=1e-13)
    np.testing.assert_allclose(np.cross(vector("hinge") - body.apply(HINGE - center), vector("axis")), 0.0, atol=1e-13)
    np.testing.assert_allclose(vector("axis"), body.apply(AXIS), atol=1e-14)
    inertia = body.as_matrix() @ part.inertia() @ body.as_matrix().T
    told = [own[f"appendage.inertia[{i}]"] for i in range(1, 7)]
    np.testing.assert_allclose(told, inertia[(0, 1, 2, 0, 0, 1), (0, 1, 2, 1, 2, 2)], atol=1e-12)


def test_its_hull_is_that_of_the_angle(handed: Handed) -> None:
    main = handed.phases[0].main
    values = {**main.values, **main.made}
    corners, _ = build.hull_corners(values, main.terms, ANGLE)
    swing = build.target_swing(values, main.terms)
    assert swing is not None
    found = np.array([[corners[f"target.corner_{axis}[{k}]"] for axis in "xyz"] for k in range(1, 7)])
    drawn = swing(ANGLE)
    assert max(float(np.abs(drawn - corner).sum(axis=1).min()) for corner in found) < 1e-12
    assert build.hull_corners(values, main.terms)[0] != corners


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda s: s.replace("[removal.appendage]\n", ""), "is held fast by the removal that follows"),
        (lambda s: s.replace('body = "rigid"', 'body = "point"'), "is held fast by the removal that follows"),
        (
            lambda s: s.replace("[removal.appendage]\n", '[removal.appendage]\nmass = "20 kg"\n'),
            "is set by the hand-off from the capture, which has [capture.hinge]; leave it out",
        ),
    ],
    ids=["no appendage", "point", "numbers"],
)
def test_what_the_tow_must_be_is_told(tmp_path: Path, change: Any, said: str) -> None:
    with pytest.raises(SceneError) as caught:
        loaded(tmp_path, change(scene()))
    assert said in str(caught.value)


def test_of_a_capture_from_elsewhere_it_is_refused(handed: Handed) -> None:
    """A file tells the angle, and not what swings; nor has a tow room that knows no appendage."""
    shot, tow = handed.phases
    terms = {name: term for name, term in shot.main.terms.items() if name != "hinge"}
    with pytest.raises(HandoffError, match=r"swings \(hinge.angle\); of a capture FMU from elsewhere"):
        swinging.held(_with(shot, terms=terms), tow, shot.main.values, handed.left)
    without = {name: value for name, value in tow.main.defaults.items() if not name.startswith("appendage.")}
    with pytest.raises(HandoffError, match=r"the removal needs for it \[removal.appendage\]"):
        swinging.held(shot, _with(tow, defaults=without), shot.main.values, handed.left)


def _with(phase: Any, **changed: Any) -> Any:
    return replace(phase, main=replace(phase.main, **changed))
