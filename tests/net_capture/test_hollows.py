"""A node that comes to several walls of a hollow within one substep."""

import numpy as np
import pytest

from fmu_src.net_capture.contact import inelastic
from fmu_src.net_capture.planes import INVERSE_MASS, MASS, P, U, X
from orbital.kernel import kernel
from tests.net_capture.memory import Bench, planes_of
from tests.plain import plain

__all__ = ["plain"]

TERMS = {"net": "square", "gravity": "none", "target": "box", "contact": "inelastic"}
STEP, NODE = 1e-3, 0.5


@kernel
def corner_distance(p, normal, point):
    """Of a body that fills all but x > 0 and z > 0."""
    axis = 0 if point[0] < point[2] else 2
    for i in range(3):
        normal[i] = 1.0 if i == axis else 0.0
    return point[axis]


@pytest.fixture(params=[True, False], ids=["hollow", "convex"])
def touched(request, plain):
    """Place and velocity after a substep, momentum and angular momentum of the target, and the loss."""
    bench, patch = Bench(TERMS), pytest.MonkeyPatch()
    parts, p = bench.parts, bench.p
    shape = parts.target.shape._replace(distance=corner_distance, faces=None if request.param else True)
    parts.target = parts.target._replace(shape=shape)
    patch.setattr(inelastic, "make_contact", lambda composition, touch: touch)
    touch = inelastic.make(parts)
    patch.undo()

    def found(begin, velocity, target=1e9):
        planes = planes_of(p, bench.work, parts.terms)
        planes[MASS, 0], planes[INVERSE_MASS, 0] = NODE, 1.0 / NODE
        planes[X : X + 3, 0] = np.add(begin, STEP * np.array(velocity))
        planes[U : U + 3, 0] = planes[P : P + 3, 0] = velocity
        p.target_mass, p.target_inertia[:], p.target_turn[:] = target, target, np.eye(3)
        for name in ("place", "drift", "spin", "omega"):
            p[f"target_{name}"][:] = 0.0
        p.contact_loss, p.contact_restitution, p.solver_substep = 0.0, 0.0, STEP
        touch(p, bench.work, 0, STEP)
        return (
            planes[X : X + 3, 0].copy(),
            planes[U : U + 3, 0].copy(),
            p.target_drift.copy(),
            p.target_spin.copy(),
            p.contact_loss,
        )

    return found, request.param


def test_it_ends_on_both_walls(touched):
    """At 100 m/s towards the one, 3 cm before it, and sinking on the other: each takes what is towards it."""
    found, hollow = touched
    place, velocity, _, _, loss = found((0.03, 0.0, 0.001), (-100.0, 3.0, -5.0))
    assert place[2] == pytest.approx(0.001, abs=1e-9)
    if not hollow:
        assert place[0] == pytest.approx(-0.07), "the twin: the other wall is not looked at"
        return
    assert place == pytest.approx((0.03, 0.003, 0.001), abs=1e-9)
    assert velocity == pytest.approx((0.0, 3.0, 0.0), abs=1e-6)
    assert loss == pytest.approx(0.5 * NODE * (100.0**2 + 5.0**2), rel=1e-6)


def test_the_target_takes_the_opposite_of_all(touched):
    found, _ = touched
    begin, velocity = np.array((0.03, 0.2, 0.001)), np.array((-100.0, 3.0, -5.0))
    place, after, drift, spin, _ = found(begin, velocity, target=4.0)
    assert NODE * after + 4.0 * drift == pytest.approx(NODE * velocity, abs=1e-12)
    turned = np.cross(place, NODE * after) + np.cross(STEP * drift, 4.0 * drift) + spin
    assert turned == pytest.approx(np.cross(begin, NODE * velocity), abs=1e-12)
    assert place[2] - STEP * drift[2] > -1e-3


def test_a_node_that_comes_to_one_wall_alone_is_left_at_that(touched):
    found, _ = touched
    place, velocity, _, _, _ = found((0.3, 0.0, 0.001), (-100.0, 0.0, -5.0))
    assert place == pytest.approx((0.2, 0.0, 0.001), abs=1e-9)
    assert velocity == pytest.approx((-100.0, 0.0, 0.0), abs=1e-6)
