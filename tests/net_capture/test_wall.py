"""Friction in the canister: a node that slides, a thread that a bullet draws off, and a net that leaves in order."""

import math

import numpy as np
import pytest

from fmu_src.instance import Instance
from fmu_src.net_capture.interface import MODEL, refusals
from fmu_src.net_capture.planes import MASS, SHOWN, U, X
from tests.conftest import FREE
from tests.net_capture.memory import graph, nodes, planes
from tests.validation import closed_form

PACKED = FREE | {"folding": "accordion", "wall": "plain"}
FIRM = {"wall.friction": 0.1, "wall.pressing": 3.0}


def shoot(parameters):
    return Instance(MODEL, PACKED, parameters).initialise()


STILL = {
    "net.side": 4.0,
    "net.mesh": 2.0,
    "net.mass": 0.01,
    "canister.width": 0.3,
    "canister.depth": 1.5,
    "chaser.mass": 5.0,
    "bullets.speed": 0.0,
    "wall.friction": 0.1,
    "wall.pressing": 0.05,
}


def test_a_node_slides_as_far_as_coulomb_has_it(validated):
    """Pushed in the canister, it stops after u^2 m / 2 F against the chaser, and stays; the chaser has its momentum."""
    net = shoot(STILL)
    memory, slots, first = planes(net), nodes(net), graph(net)
    middle = slots[4]
    mass, hangs = memory[MASS, middle], 4 * 0.5 * 2.0
    force = 0.005 * hangs
    memory[U : U + 3, middle] += (0.0, 0.0, 0.4)
    start = memory[X : X + 3, middle].copy()
    speed = 0.4
    # the chaser and all that holds on to it; bullets do not
    whole = 5.0 + memory[MASS, slots].sum() - mass - memory[MASS, graph(net).bullets].sum()
    light = 1.0 / mass + 1.0 / whole
    duration = speed / (force * light)
    assert first.length.max() == 2.0
    net.step(0.5 * duration)
    assert net["thread.tension_max"] == 0.0
    assert 0.0 < net["wall.friction_loss"] < 0.9 * 0.5 * speed**2 / light
    # also on the way, between two substeps
    kinetic = net["energy.kinetic"] + 0.5 * 5.0 * (net.array("chaser_velocity") ** 2).sum()
    assert kinetic + net["wall.friction_loss"] == pytest.approx(0.5 * mass * speed**2, rel=1e-9)
    net.step(duration)
    validated(
        closed_form("u^2 / 2 F (1/m + 1/M)"),
        "node that slides in the canister: its way against the chaser",
        (memory[X + 2, middle] - start[2]) - net["chaser.position[3]"],
        0.5 * speed**2 / (force * light),
        "m",
        rel=2e-3,
    )
    assert net["wall.friction_loss"] == pytest.approx(0.5 * speed**2 / light, rel=1e-7)
    assert net.array("momentum")[2] == pytest.approx(mass * speed, rel=1e-12)
    rest = memory[X : X + 3, middle] - net.array("chaser_position")
    net.step(1.0)
    np.testing.assert_allclose(memory[X : X + 3, middle] - net.array("chaser_position"), rest, atol=1e-12)


DEEP, SPEED, BULLET, HELD, PIECE = 0.5, 3.0, 0.5, 0.6, 0.125
"""How deep in the canister all threads lie [m], of the bullets [m/s], [kg], what holds a metre of thread [N/m], and how
long a piece of it is [m]."""
DRAWN = {
    "wall.friction": 0.3,
    "wall.pressing": 2.0,
    "net.side": 4.0,
    "net.mesh": 2.0,
    "net.segments": 16,
    "net.mass": 2.4e-3,
    "net.youngs_modulus": 1.4e9,
    "canister.width": 0.3,
    "canister.depth": 0.3,
    "vertex.mass": 1e-6,
    "chaser.mass": 1e6,
    "bullets.speed": SPEED,
    "bullets.mass": BULLET,
    "bullets.angle": 0.0,
}


def test_a_bullet_that_draws_a_thread_off_slows_as_the_closed_form(validated):
    """m v dv = -F ds. All threads lie one behind the other, and each bullet draws off two: of each the part that is
    under way to the muzzle pulls, from a way of DEEP on a length of DEEP."""
    net = shoot(DRAWN)
    memory, slots = planes(net), nodes(net)
    muzzle = net.record[0]["axes"][6:9].copy()
    memory[X : X + 3, slots] = (net.array("chaser_position") - DEEP * muzzle)[:, None]
    found, expected = [], []
    while True:
        net.step(0.05)
        way = muzzle @ (net.array("bullet_position")[0] - net.array("chaser_position")) + DEEP
        if way > 1.9:
            break
        if way > DEEP:
            found.append(float(muzzle @ net.array("bullet_velocity")[0]))
            # half a piece of thread hangs on the bullet, which nothing holds
            work = 2.0 * HELD * (0.5 * DEEP**2 + DEEP * (way - 0.5 * PIECE - DEEP))
            expected.append(math.sqrt(SPEED**2 - 2.0 * work / BULLET))
    assert len(found) > 5
    assert expected[-1] < 0.8 * SPEED
    lost = closed_form("m v dv = -F ds, F = mu p z of each of two threads")
    slowed, told = ((SPEED**2 - np.array(speeds) ** 2).tolist() for speeds in (found, expected))
    what = "bullet that draws threads off a canister: loss of its speed squared"
    validated(lost, what, slowed, told, "m2/s2", rel=0.01)
    assert abs(net["energy.remainder"]) < 0.01 * net["wall.friction_loss"]


SHOT = {
    **FIRM,
    "net.side": 6.0,
    "net.mesh": 1.0,
    "net.segments": 2,
    "canister.width": 0.3,
    "canister.depth": 0.3,
    "vertex.mass": 1e-3,
    "chaser.mass": 40.0,
    "solver.jitter[1]": 1e-4,
    "shot.roll": 0.3,
}


def test_a_net_leaves_in_order_and_all_keeps_its_books():
    """No node moves in the canister before its neighbour has drawn at it; momenta, the chaser's turn among them, hold
    to rounding, and the energy book to a hundredth of the shot."""
    net = shoot(SHOT)
    memory, ends = planes(net), graph(net).ends
    slots = nodes(net)
    held = memory[-1]
    near = {node: set() for node in slots.tolist()}
    for a, b in ends.tolist():
        near[a].add(b)
        near[b].add(a)
    within = np.flatnonzero(held > 0.0)
    assert len(within) == net["wall.stowed"] == len(slots) - 4
    energy, spin = net["energy.kinetic"], net.array("angular_momentum").copy()
    net.step(0.02)  # the chaser recoils, and takes along all that lies in the canister
    lying = memory[SHOWN : SHOWN + 3].T - net.array("chaser_position")
    most, moved, stowed = 0, set(graph(net).bullets.tolist()), len(within)
    while net["wall.stowed"] > 0:
        net.step(0.01)
        assert net.time < 10.0
        assert net["wall.stowed"] <= stowed
        stowed = net["wall.stowed"]
        places = memory[SHOWN : SHOWN + 3].T - net.array("chaser_position")
        fresh = [i for i in within.tolist() if i not in moved and np.abs(places[i] - lying[i]).max() > 1e-5]
        most = max(most, len(fresh))
        # one look may see several of one thread set out
        while fresh:
            drawn = [i for i in fresh if near[i] & moved]
            assert drawn, fresh
            moved.update(drawn)
            fresh = [i for i in fresh if i not in moved]
        assert np.abs(net.array("momentum")).max() < 1e-12 * 6.0
        assert np.abs(net.array("angular_momentum") - spin).max() < 1e-12 * 120.0
        assert abs(net["energy.remainder"]) < 0.01 * energy
    assert most < 0.2 * len(within), "by and by, not at one look"
    assert 0.5 < net["wall.emptied"] <= net.time
    assert (held == 0.0).all()
    assert 0.1 * energy < net["wall.friction_loss"] < energy
    assert np.abs(net.array("chaser_spin")).max() > 1e-6
    taken = net["wall.friction_loss"]
    net.step(0.5)
    assert net["wall.friction_loss"] == taken


def test_a_net_that_is_held_fast_takes_nothing():
    """Packed so hard that none is drawn off: bullets swing on threads that damp nothing, and friction does no work."""
    net = shoot(SHOT | {"wall.pressing": 1e7, "net.damping_ratio": 0.0})
    energy, stowed = net["energy.kinetic"], net["wall.stowed"]
    reached = 0.0
    for _ in range(60):
        net.step(0.05)
        reached = max(reached, net["thread.tension_max"])
    assert net["wall.stowed"] == stowed
    assert reached > 10.0
    assert net["wall.friction_loss"] == pytest.approx(0.0, abs=1e-3 * energy)
    assert abs(net["energy.remainder"]) < 0.01 * energy


def test_without_friction_nothing_is_held():
    """The same shot: what lies in the canister stays behind as the chaser recoils, and nothing is lost there."""
    net = shoot(SHOT | {"wall.friction": 0.0})
    net.step(0.2)
    assert net["wall.friction_loss"] == 0.0
    within = np.flatnonzero(planes(net)[-1] > 0.0)
    assert len(within) > 100
    # not one is carried along by the chaser, which goes back at its recoil
    assert net.array("chaser_velocity")[1] < -0.05
    assert np.median(planes(net)[U + 1, within]) == pytest.approx(0.0, abs=1e-12)


def test_it_goes_with_a_canister_and_the_leapfrog():
    rows = [v for v in MODEL.interface(PACKED).variables if v.causality == "parameter"]
    values = {n: s for v in rows for n, s in zip(v.element_names(), v.starts(), strict=True)}
    found = refusals({**PACKED, "solver": "rk4"}, values, 10.0)
    assert [r.name for r in found] == ["solver.scheme"]
    assert [r.name for r in refusals({**PACKED, "substeps": "following"}, values, 10.0)] == ["solver.substeps"]
    flat = [r.name for r in refusals({**PACKED, "folding": "flat"}, values | {"net.fold_side": 0.5}, 10.0)]
    assert flat == ["folding.pattern"]
    assert not refusals(PACKED, values, 10.0)


def test_a_scene_without_it_has_nothing_of_it():
    assert not any(v.name.startswith("wall") for v in MODEL.interface(FREE).variables)
