"""A target whose appendage swings about a hinge: its free motion, against two bodies in coordinates of their own that
constraints hold together, and closed forms."""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.net_capture.on_target import Kernels
from tests.net_capture.two_bodies import (
    AXIS,
    EDGE,
    FLAT,
    POINT,
    TERMS,
    WING,
    TwoBodies,
    body_turn,
    design_attitude,
    free_motion,
    moving,
    tables_of,
)


@pytest.fixture(scope="module")
def law():
    return Kernels(TERMS | {"contact": "inelastic"}, tables_of()[0])


@pytest.fixture(scope="module")
def told(law):
    """Kernels of the target that the tests ask."""
    return dict(zip(("tell", "fly"), free_motion(law), strict=True))


RATE, SWING = np.array([0.15, -0.1, 0.2]), {"start_angle": 0.4, "start_rate": -0.3, "stiffness": 60.0, "damping": 4.0}


def test_it_tumbles_and_swings_as_two_bodies_that_constraints_hold_together(law, told):
    scene, tables, attitude = moving(law, rate=RATE, **SWING)
    two = TwoBodies(WING, POINT, AXIS, 60.0, 4.0)
    start = two.start(attitude, attitude.apply(RATE), 0.4, -0.3)
    spin, record = scene.p["target_spin"].copy(), scene.record
    told["tell"](record)
    energy = float(scene.p["target_energy"] + scene.p["hinge_energy"])
    parts = two.parts(start)
    kinetic = sum(
        0.5 * two.masses[k] * v @ v + 0.5 * w @ turn.as_matrix() @ two.moments[k] @ turn.as_matrix().T @ w
        for k, (_, turn, v, w) in enumerate(parts)
    )
    assert energy == pytest.approx(kinetic + 0.5 * 60.0 * 0.4**2, rel=1e-12)
    told["fly"](record, 0.0, 0.01, 900)
    end = two.fly(start, 9.0)
    assert scene.p["hinge_now"][6] == pytest.approx(two.angle(end), abs=2e-9)
    assert abs(two.angle(end) - 0.4) > 0.1
    (place, turn, _, w), (_, _, _, other) = two.parts(end)
    assert (design_attitude(scene, tables) * turn.inv()).magnitude() < 2e-9
    told["tell"](record)
    np.testing.assert_allclose(body_turn(tables)[0].apply(scene.p["target_rate"]), turn.inv().apply(w), atol=3e-9)
    told["tell"](record)
    assert scene.p["hinge_rates"][3] == pytest.approx((other - w) @ turn.apply(two.axis), abs=3e-9)
    np.testing.assert_array_equal(scene.p["target_spin"], spin)
    lost = float(scene.p["hinge_loss"])
    assert lost > 1.0
    assert scene.p["target_energy"] + scene.p["hinge_energy"] + lost == pytest.approx(energy, abs=1e-8 * energy)
    # where the rest's centre of mass lies about that of the whole
    solid_turn, centre = body_turn(tables)
    own = solid_turn.inv().apply(two.centres[0] - centre) - scene.p["hinge_shift"]
    np.testing.assert_allclose(
        Rotation.from_quat(scene.p["target_pose"], scalar_first=True).apply(own), place, atol=1e-8
    )


def test_its_free_motion_is_of_order_four(law, told):
    ends = []
    for step, steps in ((0.04, 100), (0.02, 200), (0.0025, 1600)):
        scene, _, _ = moving(law, rate=RATE, **SWING)
        told["fly"](scene.record, 0.0, step, steps)
        ends.append(np.concatenate([scene.p["target_pose"], scene.p["hinge_now"][6:9]]))
    coarse, fine = (np.linalg.norm(end - ends[-1]) for end in ends[:2])
    assert math.log2(coarse / fine) == pytest.approx(4.0, abs=0.1)


def test_a_frame_that_turns_changes_nothing_but_what_is_seen(law, told):
    seen = []
    for rate in (0.0, 0.05):
        scene, _, _ = moving(law, rate=RATE, **SWING)
        told["fly"](scene.record, rate, 0.002, 1000)
        back = Rotation.from_rotvec([0.0, 0.0, 2.0 * rate])
        pose = back * Rotation.from_quat(scene.p["target_pose"], scalar_first=True)
        seen.append([*pose.as_matrix().ravel(), *back.apply(scene.p["target_spin"]), scene.p["hinge_now"][6]])
    np.testing.assert_allclose(seen[0], seen[1], atol=1e-6)


def reduced(entries):
    """Moment that a spring of the hinge feels [kg m2], of two bodies in line that turn in a plane.

    (A C - B^2)/(A + C + 2 B),   A = I1 + mu l1^2,   C = I2 + mu l2^2,   B = mu l1 l2
    """
    (m1, m2), lengths = [e["mass"] for e in entries], (EDGE[2], entries[1]["position"][2] - EDGE[2])
    moments = [e["mass"] * (e["size"][1] ** 2 + e["size"][2] ** 2) / 12.0 for e in entries]
    mu = m1 * m2 / (m1 + m2)
    a, c = (moment + mu * length**2 for moment, length in zip(moments, lengths, strict=True))
    b = mu * lengths[0] * lengths[1]
    return (a * c - b * b) / (a + c + 2.0 * b)


@pytest.mark.parametrize("ratio", [0.0, 0.05])
def test_its_spring_swings_at_the_frequency_of_the_reduced_moment(law, told, ratio):
    frequency, moment = 2.0 * math.pi * 0.3, reduced(FLAT)
    stiffness, damping = moment * frequency**2, 2.0 * ratio * moment * frequency
    scene, _, _ = moving(law, FLAT, EDGE, [1.0, 0.0, 0.0], start_angle=1e-4, stiffness=stiffness, damping=damping)
    rung, step = frequency * math.sqrt(1.0 - ratio**2), 1e-3
    for steps in (700, 1400, 6000):
        told["fly"](scene.record, 0.0, step, steps)
        time = step * (steps if steps == 700 else 2100 if steps == 1400 else 8100)
        shrunk = 1e-4 * math.exp(-ratio * frequency * time)
        want = shrunk * (math.cos(rung * time) + ratio * frequency / rung * math.sin(rung * time))
        assert scene.p["hinge_now"][6] == pytest.approx(want, abs=1e-11)


def test_it_is_stopped_at_its_limit_and_the_loss_is_booked(law, told):
    scene, _, _ = moving(law, limit=0.5, start_rate=0.6, stiffness=20.0)
    told["tell"](scene.record)
    energy, spin = float(scene.p["target_energy"] + scene.p["hinge_energy"]), scene.p["target_spin"].copy()
    most = 0.0
    for _ in range(3000):
        told["fly"](scene.record, 0.0, 1e-3, 1)
        most = max(most, float(scene.p["hinge_now"][6]))
    told["tell"](scene.record)
    assert 0.5 < most < 0.5006
    assert scene.p["hinge_now"][6] < 0.49
    assert scene.p["hinge_loss"] > 0.3 * energy
    assert scene.p["target_energy"] + scene.p["hinge_energy"] + scene.p["hinge_loss"] == pytest.approx(energy, rel=1e-6)
    np.testing.assert_array_equal(scene.p["target_spin"], spin)


@pytest.mark.parametrize("stiffness", [1e6, 1e9])
def test_a_spring_however_stiff_holds_it_as_if_it_were_rigid(law, told, stiffness):
    scene, _, _ = moving(law, rate=RATE, stiffness=stiffness)
    told["tell"](scene.record)
    energy = float(scene.p["target_energy"])
    told["fly"](scene.record, 0.0, 1e-3, 300)
    told["tell"](scene.record)
    assert abs(scene.p["hinge_now"][6]) < 60.0 / stiffness
    assert scene.p["target_energy"] + scene.p["hinge_energy"] == pytest.approx(energy, rel=1e-6)
