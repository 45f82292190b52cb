"""The hand-off judged from outside: sums over raw mass points in inertial axes, no formula of the mapping used."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from dcone_cosim.handoff import (
    CAPTURE_OUTPUTS,
    CAPTURE_PARAMETERS,
    REMOVAL_SETS,
    Body,
    Handoff,
    held_bodies,
    mean_motion,
    prepare,
    rotation_matrix,
    spin_energy,
    spin_speeds,
    without_recoil,
)
from dcone_cosim.ledger import LedgerRow, ledger
from tests.cosim.raw_world import RATE, Array, Points, World, world
from tests.validation import Validated, other_code

SEEDS = range(6)
AXES = ("radial", "along-track", "cross-track")
UNITS = {
    "mass": "kg",
    "mass moment": "kg m",
    "linear momentum": "N s",
    "angular momentum": "N m s",
    "kinetic energy": "J",
}
CLOSE = 1e-12
"""Of the size of what enters."""


def handed(seed: int, **more: float) -> tuple[World, Handoff]:
    made = world(seed)
    return made, prepare(made.outputs() | more, RATE)


def of_removal(made: World, values: Mapping[str, float]) -> Points:
    """Chaser and target as the removal would set them out from its parameters: two mass points, inertial axes."""

    def vector(name: str) -> Array:
        return np.array([values[f"start.{name}[{i}]"] for i in (1, 2, 3)])

    masses = np.array([values["chaser.mass"], values["target.mass"]])
    shares = np.array([-masses[1], masses[0]])[:, None] / masses.sum()
    places = vector("center_position") + shares * vector("relative_position")
    seen = vector("center_velocity") + shares * vector("relative_velocity")
    places = places @ made.axes.T
    return Points(masses, places, seen @ made.axes.T + np.cross(RATE * made.axes[:, 2], places))


def close(found: object, expected: object, size: float) -> None:
    np.testing.assert_allclose(np.asarray(found), np.asarray(expected), rtol=0.0, atol=CLOSE * size)


def test_what_is_read_and_set_is_all_there_is() -> None:
    """What the mapping reads, the raw world tells; what it sets is what a pair of points is."""
    assert set(CAPTURE_OUTPUTS) | {"chaser.mass", "target.mass"} == set(world(0).outputs())
    assert set(CAPTURE_PARAMETERS) == {
        "chaser.mass",
        "target.mass",
        *(f"chaser.start_velocity[{i}]" for i in (1, 2, 3)),
    }
    assert set(REMOVAL_SETS) == set(handed(0)[1].parameters)
    assert len(REMOVAL_SETS) == 2 + 4 * 3


def test_the_frame_turns_with_a_circular_orbit() -> None:
    assert mean_motion(800e3) == pytest.approx(1.0381289e-3, rel=1e-7)
    sidereal_day = 86164.0905
    assert math.tau / mean_motion(35786e3) == pytest.approx(sidereal_day, rel=1e-4)


@pytest.mark.parametrize("seed", SEEDS)
def test_attitude(seed: int) -> None:
    turn = Rotation.random(random_state=seed)
    np.testing.assert_allclose(rotation_matrix(turn.as_quat(scalar_first=True)), turn.as_matrix(), atol=1e-15)


@pytest.mark.parametrize("seed", SEEDS)
def test_the_removal_begins_with_the_momentum_and_place_of_the_points(seed: int) -> None:
    made, found = handed(seed)
    pair = of_removal(made, found.parameters)
    for side, points in enumerate((made.chaser, made.joint)):
        size = float(points.mass.sum())
        place, rate = points.center()
        close(pair.mass[side], points.mass.sum(), size)
        close(pair.position[side], place, 20.0)
        close(pair.mass[side] * pair.velocity[side], points.momentum(), size)
        close(pair.velocity[side], rate, 1.0)
    close(pair.momentum(), made.all.momentum(), 3000.0)


@pytest.mark.parametrize("seed", SEEDS)
def test_bodies_have_the_spin_inertia_and_energy_of_their_points(seed: int) -> None:
    made, found = handed(seed)
    for body, points in ((found.target, made.target), (found.catch, made.net), (found.joint, made.joint)):
        place, rate = points.center()
        assert body.mass == pytest.approx(points.mass.sum(), rel=1e-14)
        close(made.axes @ body.position, place, 10.0)
        close(made.axes @ body.inertial_velocity(found.turning), rate, 1.0)
        close(made.axes @ body.spin, points.spin(), float((points.mass @ np.abs(points.position)).max()))
        close(made.axes @ body.inertia @ made.axes.T, points.inertia(), float(np.trace(points.inertia())))
    inner = made.net.energy() - 0.5 * made.net.mass.sum() * float(made.net.center()[1] @ made.net.center()[1])
    close(found.catch_energy, inner, made.net.energy())
    for body, points in ((found.target, made.target), (found.joint, made.joint)):
        assert spin_energy(body) == pytest.approx(points.energy_if_rigid(), rel=1e-11)
    point = Body(1.0, np.zeros(3), np.zeros(3))
    assert (point.spin.tolist(), point.inertia.tolist()) == ([0.0] * 3, [[0.0] * 3] * 3)
    assert spin_energy(replace(point, spin=np.ones(3))) == 0.0
    close(found.vertex, made.vertex @ made.axes, 10.0)
    assert found.reach == made.reach


def expected_rows(made: World) -> dict[str, tuple[float, float, float, float]]:
    """Before, after, accounted and sum of magnitudes of every row, from the points.

    After: the chaser, and the joint body's mass in its centre. Momenta are those seen in the turning frame; angular
    momenta and energies inertial.
    """
    chaser, joint = made.chaser, made.joint
    groups = [made.chaser, made.target, made.net]
    masses = [float(g.mass.sum()) for g in groups]
    total = sum(masses)
    rows = {}
    for side, mass in (("chaser", masses[0]), ("target and net", masses[1] + masses[2]), ("all", total)):
        rows[f"mass, {side}"] = (mass, mass, 0.0, total)
    seen = [made.in_frame(g) for g in groups]
    for quantity, which in (("mass moment", 1), ("linear momentum", 2)):
        sums = [g.mass @ g.parts()[which] for g in seen]
        size = sum(float(np.linalg.norm(s)) for s in sums)
        for side, value in (("chaser", sums[0]), ("target and net", sums[1] + sums[2]), ("all", sum(sums))):
            for axis, label in enumerate(AXES):
                rows[f"{quantity}, {side}, {label}"] = (value[axis], value[axis], 0.0, size)

    def as_one(points: Points) -> Points:
        place, rate = points.center()
        return Points(np.array([points.mass.sum()]), place[None], rate[None])

    pair = made.all.center()
    three = sum((as_one(g) for g in groups[1:]), as_one(groups[0]))
    two = as_one(chaser) + as_one(joint)
    orbital = three.spin(pair) @ made.axes
    kept = two.spin(pair) @ made.axes
    size = sum(float(np.linalg.norm(as_one(g).spin(pair))) for g in groups)
    spin = joint.spin() @ made.axes
    # spin that the joining makes: of two bodies about their common centre
    joining = (as_one(made.target) + as_one(made.net)).spin() @ made.axes
    spins = sum(float(np.linalg.norm(g.spin())) for g in groups[1:])
    for axis, label in enumerate(AXES):
        rows[f"angular momentum, orbital part, {label}"] = (orbital[axis], kept[axis], joining[axis], size)
        rows[f"angular momentum, spin part, {label}"] = (
            spin[axis],
            0.0,
            spin[axis],
            spins + float(np.linalg.norm(joining)),
        )
    before, after = made.all.energy(), two.energy()
    rows["kinetic energy"] = (before, after, before - after, before)
    return rows


@pytest.mark.parametrize("seed", SEEDS)
def test_every_row_is_the_sum_over_the_points(validated: Validated, seed: int) -> None:
    made, found = handed(seed)
    rows = {row.quantity: row for row in ledger(found, found.parameters)}
    wanted = expected_rows(made)
    assert set(rows) == set(wanted)
    for quantity, (before, after, accounted, size) in wanted.items():
        row = rows[quantity]
        close(row.before, before, size)
        close(row.after, after, size)
        close(row.accounted, accounted, size)
        assert row.magnitude == pytest.approx(size, rel=1e-9), quantity
        assert row.closed, quantity
        assert row.unit == UNITS[quantity.split(",")[0]]
    sums = other_code("sums over raw mass points in inertial axes")
    for kind, unit in UNITS.items():
        of = [quantity for quantity in wanted if quantity.split(",")[0] == kind]
        found_after, after = [rows[q].after for q in of], [wanted[q][1] for q in of]
        allowed = np.array([CLOSE * wanted[q][3] for q in of])
        validated(sums, f"{kind} handed over", found_after, after, unit, abs=allowed)


def test_the_accounts_say_what_is_lost_and_what_is_dropped() -> None:
    made, found = handed(1)
    rows = {row.quantity: row for row in ledger(found, found.parameters)}
    lost, dropped = map(float, re.findall(r"([-+.e0-9]+) J", rows["kinetic energy"].account))
    assert dropped == pytest.approx(made.joint.energy_if_rigid(), rel=1e-5)
    place_of_joint = Points(np.array([made.joint.mass.sum()]), *(x[None] for x in made.joint.center()))
    after = made.chaser.energy() + place_of_joint.energy()
    assert lost == pytest.approx(made.all.energy() - after - made.joint.energy_if_rigid(), rel=1e-5)
    assert "lost" in rows["kinetic energy"].account.split(",")[0]
    assert "spin" in rows["kinetic energy"].account.split(",")[1]
    joined = "became spin when the net joined the target"
    assert rows["angular momentum, orbital part, radial"].account == joined
    assert rows["angular momentum, spin part, radial"].account == "dropped: a point target has no spin"
    assert {row.account for name, row in rows.items() if "m" in name and row.unit in ("kg", "kg m", "N s")} == {""}


def test_sizes_are_those_of_the_capture() -> None:
    """What a removal holds otherwise does not count in them, nor the sign of an energy."""
    _, found = handed(3)
    size = {row.quantity: row.magnitude for row in ledger(found, found.parameters)}
    wrong = {name: 2.0 * value for name, value in found.parameters.items()}
    assert {row.quantity: row.magnitude for row in ledger(found, wrong)} == size
    plus, minus = (
        next(row for row in ledger(replace(found, catch_energy=energy), found.parameters) if row.unit == "J")
        for energy in (5.0, -5.0)
    )
    assert plus.magnitude == pytest.approx(minus.magnitude, rel=1e-14)
    assert plus.before == pytest.approx(minus.before + 10.0, rel=1e-14)


@pytest.mark.parametrize("name", REMOVAL_SETS)
def test_a_row_opens_from_1e_12_on(name: str) -> None:
    """Of what enters its row, whichever value the removal holds otherwise than it was told; below, none does."""
    _, found = handed(2)
    size = found.parameters[name] if "mass" in name else 12.0 if "position" in name else 5e-3
    for part, opens in ((0.1e-12, False), (200e-12, True)):
        wrong = dict(found.parameters)
        wrong[name] += part * size
        assert any(not row.closed for row in ledger(found, wrong)) is opens


def test_closure_is_a_share_of_what_enters() -> None:
    for difference, closed in ((3.9e-12, True), (4.1e-12, False), (-4.1e-12, False)):
        row = LedgerRow("x", "kg", 2.0 + difference, 1.5, 0.5, "why", 4.0)
        assert row.difference == pytest.approx(difference, rel=1e-3)
        assert row.closed is closed
        assert row.closure == pytest.approx(abs(difference) / 4.0, rel=1e-3)
        told = row.as_dict()
        assert told == {
            "quantity": "x",
            "unit": "kg",
            "before": 2.0 + difference,
            "after": 1.5,
            "accounted": 0.5,
            "account": "why",
            "difference": row.difference,
            "sum_of_magnitudes": 4.0,
            "relative_closure": row.closure,
            "closed": closed,
        }
    assert LedgerRow("x", "kg", 1e-12, 0.0, 0.0, "", 1.0).closed
    assert LedgerRow("x", "kg", 0.0, 0.0, 0.0, "", 0.0).closure == 0.0
    assert LedgerRow("x", "kg", 1e-30, 0.0, 0.0, "", 0.0).closure == math.inf
    assert not LedgerRow("x", "kg", 1e-30, 0.0, 0.0, "", 0.0).closed


@pytest.mark.parametrize("seed", SEEDS)
def test_what_is_held_are_the_points(seed: int) -> None:
    made, found = handed(seed)
    for body, points in zip(held_bodies(found.parameters), (made.chaser, made.joint), strict=True):
        place, rate = points.center()
        assert body.mass == pytest.approx(points.mass.sum(), rel=1e-14)
        close(made.axes @ body.position, place, 20.0)
        close(made.axes @ body.inertial_velocity(found.turning), rate, 1.0)
        assert not body.spin.any()


@pytest.mark.parametrize("seed", SEEDS)
def test_without_recoil_the_chaser_has_its_speed_before_the_shot(seed: int) -> None:
    """The same places and masses; the target rests in the frame, as the points would with no momentum in it."""
    made, found = handed(seed)
    start = np.array([0.03, -0.02, 0.01])
    calm = of_removal(made, without_recoil(found, start))
    recoiled = of_removal(made, found.parameters)
    np.testing.assert_array_equal(calm.mass, recoiled.mass)
    close(calm.position, recoiled.position, 20.0)
    seen = made.in_frame(calm)
    close(seen.velocity[0], start, 1.0)
    close(seen.velocity[1], np.zeros(3), 1.0)


def test_what_is_told_of_a_spin_is_arithmetic_one_can_follow() -> None:
    """A body of 100, 200, 300 kg m2 with 5 N m s about its first axis turns at 0.05 rad/s; the target reaches
    3 m from its centre of mass. From 10 mm/s, 0.01 N on 2000 kg over 4 m of slack: v^2 = 1e-4 + 2 x 5e-6 x 4."""
    _, found = handed(0)
    spin = np.array([5.0, 0.0, 0.0])
    joint = Body(1000.0, np.array([0.0, 3.0, 0.0]), np.array([0.0, 0.03, 0.0]), spin, np.diag([100.0, 200.0, 300.0]))
    chaser = Body(2000.0, np.array([0.0, -9.0, 0.0]), np.array([0.0, 0.02, 0.0]))
    handed_over = replace(found, chaser=chaser, joint=joint, reach=3.0)
    for thrust in (-0.01, 0.01):
        check = spin_speeds(handed_over, 4.0, thrust)
        assert check.attachment_speed == pytest.approx(0.15, rel=1e-14)
        assert check.tug_speed == pytest.approx(math.sqrt(1.4e-4), rel=1e-12)
    for slack in (0.0, -1.0):
        assert spin_speeds(handed_over, slack, -0.01).tug_speed == pytest.approx(0.01, rel=1e-12)
    slim = replace(handed_over, joint=replace(joint, inertia=np.diag([0.4, 200.0, 300.0])))
    assert spin_speeds(slim, 4.0, -0.01).attachment_speed == pytest.approx(37.5, rel=1e-12)
    point = replace(handed_over, joint=replace(joint, inertia=np.zeros((3, 3))))
    assert spin_speeds(point, 4.0, -0.01).attachment_speed == 0.0
