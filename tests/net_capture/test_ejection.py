"""Bullets that leave each in its own way: what is kept, what each gets, and chaser and held bullets as one body."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from fmu_src.instance import ModelFault
from fmu_src.net_capture import interface
from fmu_src.net_capture.interface import MODEL, refusals
from fmu_src.net_capture.planes import MASS
from tests.conftest import FREE
from tests.net_capture.memory import graph, planes, shown
from tests.net_capture.released import COARSE, EACH, RELEASED

SPEED, ANGLE = 3.0, math.radians(40.0)


def state(net):
    return {
        name: net.array(name).copy()
        for name in ("momentum", "angular_momentum", "chaser_spin", "bullet_position", "chaser_position")
    }


def test_momenta_and_energy_are_kept(shoot):
    """Of chaser and net, from before the shot on: all at rest then, so both are zero. Torques that hold the chaser's
    attitude are a part of that, which would be seen missing."""
    net = shoot(COARSE | EACH | {"solver.jitter[3]": 1e-3, "net.damping_ratio": 0.3}, RELEASED)
    scale = 4 * 0.5 * SPEED
    for _ in range(16):
        net.step(0.25)
        now = state(net)
        assert np.abs(now["momentum"]).max() < 1e-9 * scale
        assert np.abs(now["angular_momentum"]).max() < 1e-9 * scale * 20.0
        assert abs(net["energy.remainder"]) < 0.01 * net["ejection.work"]
        np.testing.assert_allclose(
            now["bullet_position"][3] - now["chaser_position"], [-0.25, 0.0, -0.25], rtol=0.0, atol=2e-3
        )
    assert np.abs(now["chaser_spin"]).max() > 0.3


def test_without_errors_it_is_the_plain_shot(shoot):
    ours, plain = shoot(COARSE, RELEASED), shoot({k: v for k, v in COARSE.items() if k[:6] != "tether"}, FREE)
    for net in (ours, plain):
        net.step(1.5)
    assert plain["thread.tension_max"] > 0.0
    for name in ("bullet_position", "vertex_position", "chaser_velocity"):
        np.testing.assert_allclose(ours.array(name), plain.array(name), rtol=0.0, atol=1e-9)


def directions(net, errors, turns):
    """Unit vectors of four bullets: the shot's axis tilted towards each diagonal, and turned about the axis."""
    first, second, axis = net.array("axes").reshape(3, 3)
    found = []
    for (a, b), error, turn in zip(((-1, -1), (1, -1), (1, 1), (-1, 1)), errors, turns, strict=True):
        tilt = Rotation.from_rotvec((ANGLE + error) * np.cross(axis, (a * first + b * second) / math.sqrt(2.0)))
        found.append(Rotation.from_rotvec(turn * axis).apply(tilt.apply(axis)))
    return np.array(found)


def test_each_bullet_gets_its_own_velocity(shoot):
    """Relative to the chaser just before: those of the start at once, the late one at its instant, when the chaser has
    the recoil of the others, and bullets and chaser the work of their masses."""
    net = shoot(COARSE | EACH, RELEASED)
    expected = directions(net, (0.0, 0.1, 0.0, 0.0), (0.2, 0.0, 0.0, 0.0)) * [[SPEED + 0.4], [SPEED], [SPEED], [SPEED]]
    order = [int(np.argmin(np.abs(expected[:3] - v).sum(axis=1))) for v in net.array("bullet_velocity")[:2]]
    assert order == [0, 1]
    np.testing.assert_allclose(net.array("bullet_velocity")[:2], expected[:2], rtol=0.0, atol=1e-12)
    chaser = net.array("chaser_velocity").copy()
    np.testing.assert_allclose(net.array("bullet_velocity")[2:], [chaser, chaser], rtol=0.0, atol=1e-12)
    mass = float(planes(net)[MASS][graph(net).bullets[0]])
    held = 40.0 + 2.0 * mass
    np.testing.assert_allclose(chaser, -mass * expected[:2].sum(axis=0) / held, rtol=0.0, atol=1e-12)
    work = 0.5 * mass * (3.4**2 + 9.0) + 0.5 * held * chaser @ chaser
    assert net["ejection.work"] == pytest.approx(work, rel=1e-12)
    assert net.array("ejection_left").tolist() == [0.0, 0.0, -1.0, -1.0]
    while net["ejection.left[3]"] < 0.0:
        before = net.array("chaser_velocity").copy()
        net.step(net["solver.substep"])
    assert net["ejection.left[3]"] == pytest.approx(0.35, abs=0.5 * net["solver.substep"])
    # no thread has pulled yet
    assert net["thread.tension_max"] == 0.0
    np.testing.assert_allclose(net.array("bullet_velocity")[2] - before, expected[2], rtol=0.0, atol=1e-9)
    left = 40.0 + mass
    np.testing.assert_allclose(net.array("chaser_velocity") - before, -mass * expected[2] / left, rtol=0.0, atol=1e-9)
    assert net["ejection.work"] - work == pytest.approx(0.5 * mass * 9.0 * (1.0 + mass / left), rel=1e-9)


STUCK = COARSE | {
    "ejection.stays[2]": True,
    "net.damping_ratio": 0.3,
    "net.youngs_modulus": 2e8,
    "solver.step_ratio": 0.2,
}


@pytest.fixture(scope="module")
def reference():
    """What joins a held bullet to the chaser as one mass, by scipy: `flown(net, time)` gives the chaser's velocity and
    all places."""

    def flown(net, time, heavier=0.0):
        made, slots = graph(net), np.flatnonzero(planes(net)[MASS] > 0.0)
        number = {slot: i for i, slot in enumerate(slots.tolist())}
        ends = np.array([[number[a], number[b]] for a, b in made.ends.tolist()])
        mass, place = planes(net)[MASS][slots].copy(), shown(net)
        rate = np.zeros_like(place)
        bullets = [number[slot] for slot in made.bullets.tolist()]
        rate[bullets] = net.array("bullet_velocity")
        stuck = bullets[1]
        own = mass.copy()
        own[stuck] += 40.0 + heavier

        def rates(_, y):
            x, v = y.reshape(2, -1, 3)
            way = x[ends[:, 1]] - x[ends[:, 0]]
            length = np.linalg.norm(way, axis=1)
            along = ((v[ends[:, 1]] - v[ends[:, 0]]) * way).sum(axis=1) / length
            pull = made.stiffness * (length - made.length) + made.damping * along
            pull = np.where(length > made.length, np.maximum(pull, 0.0), 0.0) / length
            force = np.zeros_like(x)
            np.add.at(force, ends[:, 0], pull[:, None] * way)
            np.add.at(force, ends[:, 1], -pull[:, None] * way)
            return np.concatenate([v, force / own[:, None]]).ravel()

        start = np.concatenate([place, rate]).ravel()
        end = solve_ivp(rates, (0.0, time), start, rtol=1e-7, atol=1e-9, max_step=2e-3).y[:, -1].reshape(2, -1, 3)
        return end[1][stuck], end[0]

    return flown


def test_a_held_bullet_and_the_chaser_are_one_body(shoot, reference):
    """The velocity that the threads give both, and every node, by other equations and another integrator."""
    net = shoot(STUCK, RELEASED)
    at_first = net.array("chaser_velocity").copy()
    velocity, places = reference(net, 3.0)
    lighter, _ = reference(net, 3.0, -1.0)
    net.step(3.0)
    pulled = np.linalg.norm(velocity - at_first)
    assert pulled > 0.05
    assert np.linalg.norm(net.array("chaser_velocity") - velocity) < 0.003 * pulled
    np.testing.assert_allclose(shown(net), places, rtol=0.0, atol=0.02)
    # a chaser that is 1 kg lighter is another one
    assert np.linalg.norm(net.array("chaser_velocity") - lighter) > 0.01 * pulled


@pytest.mark.parametrize(
    ("change", "name"),
    [
        ({"ejection.speed_error[2]": -3.5}, "no_way_out"),
        ({"ejection.angle_error[2]": 1.0}, "no_way_out"),
        ({f"ejection.stays[{i}]": True for i in range(1, 5)}, "none_leaves"),
        ({"ejection.delay[1]": 0.1, "spin.rate": 0.1}, "held_and_turning"),
        ({"ejection.stays[1]": True, "spin.chaser_rate[2]": 0.1}, "held_and_turning"),
    ],
    ids=str,
)
def test_what_makes_no_shot_is_refused_by_scene_and_fmu(shoot, change, name):
    with pytest.raises(ModelFault) as caught:
        shoot(COARSE | change, RELEASED)
    assert next(f.text for f in MODEL.faults if f.name == name) in str(caught.value)
    variables = [v for v in MODEL.interface(RELEASED).variables if v.causality == "parameter"]
    values = {n: s for v in variables for n, s in zip(v.element_names(), v.starts(), strict=True)}
    assert not refusals(RELEASED, values | COARSE, 10.0)
    assert refusals(RELEASED, values | COARSE | change, 10.0)


def test_other_schemes_and_late_bullets_are_refused():
    variables = [v for v in MODEL.interface(RELEASED).variables if v.causality == "parameter"]
    values = {n: s for v in variables for n, s in zip(v.element_names(), v.starts(), strict=True)} | COARSE
    found = refusals(RELEASED | {"solver": "rk4"}, values, 10.0)
    assert [r.name for r in found] == ["solver.scheme"] * 2
    (found,) = refusals(RELEASED, values | {"ejection.delay[2]": 11.0}, 10.0)
    assert found.name == "ejection.delay"
    found = refusals(
        RELEASED | {"ejection": "5"},
        values | {f"ejection.{k}[5]": 0.0 for k in ("speed_error", "angle_error", "delay", "stays")},
        10.0,
    )
    assert "ejection.number" in [r.name for r in found]


def test_a_scene_without_it_has_nothing_of_it():
    names = {v.name.partition(".")[0].partition("_")[0] for v in MODEL.interface(FREE).variables}
    assert not names & {"ejection", "spin", "ejector"}
    assert not any("chaser.spin" in v.name or "chaser_turned" in v.name for v in interface.BASE)
