"""A net that turns as it leaves, and a chaser that does: velocities and momenta by rigid motion."""

import numpy as np
import pytest

from fmu_src.net_capture.planes import MASS, SHOWN_RATE
from tests.net_capture.memory import nodes, planes, shown
from tests.net_capture.released import COARSE, RELEASED

STILL = COARSE | {"bullets.speed": 0.0, "shot.roll": 0.3}


def laid(net):
    """Masses, places and velocities of all nodes."""
    return planes(net)[MASS][nodes(net)], shown(net), shown(net, SHOWN_RATE)


def test_the_spin_of_the_net_is_taken_from_the_chaser(shoot):
    net = shoot(STILL | {"spin.rate": 2.0}, RELEASED)
    mass, place, velocity = laid(net)
    arm = place - net.array("chaser_position")
    np.testing.assert_allclose(velocity, np.cross([0.0, 2.0, 0.0], arm), rtol=0.0, atol=1e-12)
    own = (mass[:, None] * np.cross(arm, velocity)).sum(axis=0)
    assert own[1] > 0.1
    np.testing.assert_allclose(net.array("chaser_spin"), -own, rtol=0.0, atol=1e-12)
    np.testing.assert_allclose(net.array("catch_spin"), own, rtol=0.0, atol=1e-12)
    np.testing.assert_allclose(net.array("angular_momentum"), 0.0, rtol=0.0, atol=1e-12)


def test_a_turning_chaser_gives_its_muzzle_a_speed(shoot):
    """w x (r + arm), whose mean is that of the muzzle: the chaser has the opposite momentum, and no turn is booked,
    since net and chaser turned together before."""
    rate, arm = np.array([0.03, 0.01, -0.02]), np.array([0.5, 1.5, -0.2])
    change = {f"spin.chaser_rate[{i}]": w for i, w in enumerate(rate, 1)}
    net = shoot(STILL | change | {f"spin.arm[{i}]": a for i, a in enumerate(arm, 1)}, RELEASED)
    mass, place, velocity = laid(net)
    from_muzzle = place - [0.0, -20.0, 0.0]
    np.testing.assert_allclose(velocity, np.cross(rate, from_muzzle + arm), rtol=0.0, atol=1e-12)
    np.testing.assert_allclose(net.array("chaser_velocity"), -mass.sum() / 40.0 * np.cross(rate, arm), atol=1e-12)
    assert not net.array("chaser_spin").any()
    np.testing.assert_allclose(net.array("momentum"), 0.0, atol=1e-12)


@pytest.mark.parametrize("turns", [True, False])
def test_a_turning_net_keeps_its_momenta_and_opens_by_itself(shoot, turns):
    """Without the bullets' speed nothing else opens it: a bullet flies straight on at w r until a thread pulls."""
    net = shoot(STILL | {"spin.rate": 4.0 if turns else 0.0}, RELEASED)
    first = net["mouth.area"]
    for _ in range(8):
        net.step(0.5)
        assert np.abs(net.array("momentum")).max() < 1e-10
        assert np.abs(net.array("angular_momentum")).max() < 1e-9
        assert abs(net["energy.remainder"]) < 0.01 * 0.5 * 2.0 * (4.0 * 0.36) ** 2
    assert (net["mouth.area"] > 50.0 * first) is turns
