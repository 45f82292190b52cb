"""The hand-off: what joins, what is conserved, what is dropped, and that the ledger would notice a mistake."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from dcone_cosim.handoff import (
    CAPTURE_OUTPUTS,
    CAPTURE_PARAMETERS,
    Body,
    Handoff,
    held_bodies,
    join,
    mean_motion,
    prepare,
    rotation_matrix,
    spin_energy,
    spin_speeds,
    without_recoil,
)
from dcone_cosim.ledger import CLOSURE, ledger

RATE = mean_motion(800e3)


def points(generator: np.random.Generator, count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Masses, positions and velocities of a cloud of points."""
    return generator.uniform(0.01, 1.0, count), generator.normal(0, 3, (count, 3)), generator.normal(0, 1, (count, 3))


def cloud_outputs(masses: np.ndarray, places: np.ndarray, rates: np.ndarray) -> dict[str, float]:
    """What a capture FMU says of a net made of these points: all from the definition, in the turning frame."""
    mass = masses.sum()
    center, rate = masses @ places / mass, masses @ rates / mass
    arms, seen = places - center, rates - rate
    spin = (masses[:, None] * np.cross(arms, seen)).sum(axis=0)
    inertia = sum(m * (a @ a * np.eye(3) - np.outer(a, a)) for m, a in zip(masses, arms, strict=True))
    values = {"catch.mass": mass, "energy.kinetic": 0.5 * float(masses @ (rates**2).sum(axis=1))}
    for name, vector in (("position", center), ("velocity", rate), ("spin", spin)):
        values |= {f"catch.{name}[{i + 1}]": vector[i] for i in range(3)}
    order = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
    return values | {f"catch.inertia[{k + 1}]": inertia[i, j] for k, (i, j) in enumerate(order)}


def capture_values(seed: int, cloud: bool = True) -> dict[str, float]:
    """Random capture outputs, all sizes as in a real shot, the net a real cloud of points."""
    generator = np.random.default_rng(seed)
    values = {name: float(generator.normal()) for name in (*CAPTURE_OUTPUTS, *CAPTURE_PARAMETERS)}
    attitude = generator.normal(size=4)
    attitude /= np.linalg.norm(attitude)
    inertia = np.array([900.0, 1400.0, 1600.0])
    body_rate = generator.normal(0, 1e-3, 3)
    spin = rotation_matrix(attitude) @ (inertia * body_rate)
    values |= {f"target.attitude[{i + 1}]": attitude[i] for i in range(4)}
    for i in range(3):
        values |= {f"target.inertia[{i + 1}]": inertia[i], f"target.rate[{i + 1}]": body_rate[i]}
        values |= {f"target.spin[{i + 1}]": spin[i]}
        values |= {f"chaser.position[{i + 1}]": -20.0 * (i == 1) + 0.1 * values[f"chaser.position[{i + 1}]"]}
        values |= {f"{body}.velocity[{i + 1}]": 5e-3 * generator.normal() for body in ("chaser", "target")}
    values |= {"chaser.mass": 2000.0, "target.mass": 1000.0}
    return values | cloud_outputs(*points(generator, 40)) if cloud else values


def held(handed: Handoff) -> dict[str, float]:
    return dict(handed.parameters)


@pytest.mark.parametrize("seed", range(20))
def test_every_row_closes(seed: int) -> None:
    handed = prepare(capture_values(seed), RATE)
    rows = ledger(handed, held(handed))
    assert {row.quantity.split(",")[0] for row in rows} == {
        "mass",
        "mass moment",
        "linear momentum",
        "angular momentum",
        "kinetic energy",
    }
    assert max(row.closure for row in rows) <= CLOSURE


@pytest.mark.parametrize(
    ("name", "factor", "quantity"),
    [
        ("target.mass", 1.01, "mass, target and net"),
        ("start.relative_velocity[2]", -1.0, "linear momentum, chaser, along-track"),
        ("start.center_velocity[1]", 1.01, "linear momentum, all, radial"),
        ("start.relative_position[2]", 1.01, "angular momentum, orbital part, cross-track"),
        ("start.relative_position[2]", -1.0, "mass moment, target and net, along-track"),
        ("chaser.mass", 1.0 + 1e-9, "mass, chaser"),
    ],
)
def test_a_mistake_opens_the_ledger(name: str, factor: float, quantity: str) -> None:
    handed = prepare(capture_values(3), RATE)
    wrong = held(handed)
    wrong[name] *= factor
    open_rows = {row.quantity for row in ledger(handed, wrong) if not row.closed}
    assert quantity in open_rows


def test_a_spin_with_the_wrong_sign_opens_the_ledger() -> None:
    handed = prepare(capture_values(5), RATE)
    flipped = replace(handed, joint=replace(handed.joint, spin=-handed.joint.spin))
    assert any("spin part" in row.quantity for row in ledger(flipped, held(handed)) if not row.closed)


def test_joining_agrees_with_the_sum_over_points() -> None:
    """Two clouds joined are one cloud: spin, inertia and momentum from the definition, in axes that do not turn."""
    generator = np.random.default_rng(7)
    turning = np.array([0.0, 0.0, RATE])
    clouds = [points(generator, 30), points(generator, 50)]

    def rigid(masses: np.ndarray, places: np.ndarray, rates: np.ndarray) -> Body:
        mass = masses.sum()
        center, rate = masses @ places / mass, masses @ rates / mass
        arms = places - center
        seen = rates - rate + np.cross(turning, arms)
        spin = (masses[:, None] * np.cross(arms, seen)).sum(axis=0)
        inertia = sum(m * (a @ a * np.eye(3) - np.outer(a, a)) for m, a in zip(masses, arms, strict=True))
        return Body(mass, center, rate, spin, inertia)

    joint = join(rigid(*clouds[0]), rigid(*clouds[1]), turning)
    whole = rigid(*(np.concatenate(part) for part in zip(*clouds, strict=True)))
    for found, expected in (
        (joint.position, whole.position),
        (joint.velocity, whole.velocity),
        (joint.spin, whole.spin),
        (joint.inertia, whole.inertia),
    ):
        np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-11)


@pytest.mark.parametrize("seed", range(5))
def test_joining_never_makes_energy(seed: int) -> None:
    handed = prepare(capture_values(seed), RATE)
    row = next(row for row in ledger(handed, held(handed)) if row.quantity == "kinetic energy")
    assert row.accounted - spin_energy(handed.joint) > 0.0


def test_what_is_held_is_what_was_given() -> None:
    handed = prepare(capture_values(11), RATE)
    chaser, target = held_bodies(handed.parameters)
    np.testing.assert_allclose(chaser.position, handed.chaser.position, atol=1e-12)
    np.testing.assert_allclose(chaser.velocity, handed.chaser.velocity, atol=1e-15)
    np.testing.assert_allclose(target.position, handed.joint.position, atol=1e-12)
    np.testing.assert_allclose(target.velocity, handed.joint.velocity, atol=1e-15)


def test_without_recoil_only_the_velocities_differ() -> None:
    handed = prepare(capture_values(2), RATE)
    calm = without_recoil(handed, np.zeros(3))
    changed = {name for name, value in calm.items() if value != handed.parameters[name]}
    assert changed == {f"start.{what}_velocity[{i}]" for what in ("center", "relative") for i in (1, 2, 3)}
    assert all(calm[name] == 0.0 for name in changed)


def test_what_a_fast_spin_does_to_the_line_is_told() -> None:
    """4 x 8 x 4 m, 1000 kg, 5 deg/s about a short axis: 582 N m s."""
    values = capture_values(1)
    inertia = 1000.0 / 12.0 * np.array([64.0 + 16.0, 32.0, 80.0])
    values |= {f"target.attitude[{i}]": float(i == 1) for i in range(1, 5)}
    for i in range(3):
        values |= {f"target.inertia[{i + 1}]": inertia[i], f"target.spin[{i + 1}]": 0.0}
    values["target.reach"] = 24.0**0.5
    for rate in (np.radians(5.0), 0.0):
        values["target.spin[1]"] = inertia[0] * rate
        handed = prepare(values | cloud_outputs(np.ones(1), np.zeros((1, 3)), np.zeros((1, 3))), 0.0)
        check = spin_speeds(handed, 22.0, -0.01)
        if rate:
            assert np.linalg.norm(handed.joint.spin) == pytest.approx(582.0, rel=0.01)
            assert check.attachment_speed > 0.3
