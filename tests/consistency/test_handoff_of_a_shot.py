"""The hand-off in the midst of a real shot, judged from the nodes themselves: positions and masses out of the work
memory of the net, velocities by how far each node goes, the target as six points that turn; sums in inertial axes."""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from dcone_cosim.handoff import CAPTURE_OUTPUTS, CAPTURE_PARAMETERS, mean_motion, prepare
from dcone_cosim.ledger import ledger
from dcone_cosim.line import line_of
from fmu_src.net_capture.planes import MASS
from tests.conftest import CAPTURE_HILL
from tests.cosim.raw_world import Points
from tests.net_capture import memory
from tests.validation import other_code

pytestmark = pytest.mark.slow

NODES = other_code("sums over the nodes of the net in inertial axes")
RATE = mean_motion(800e3)
TURNING = np.array([0.0, 0.0, RATE])
SHOT = {
    "closing.time": 11.2,
    "target.start_rate[1]": 0.02,
    "target.start_rate[3]": 0.03,
    "chaser.start_velocity[1]": 0.01,
    "chaser.start_velocity[2]": 0.02,
    "chaser.start_velocity[3]": 0.01,
}


def nodes(net):
    """Masses and positions of all nodes, bullets and vertex in them."""
    return memory.planes(net)[MASS, memory.nodes(net)], memory.shown(net)


@pytest.fixture(scope="module")
def shot():
    """A shot at 8 s, the net open: outputs and parameters, and the raw points of chaser, target and net."""
    from fmu_src.instance import Instance
    from fmu_src.net_capture.interface import MODEL

    net = Instance(MODEL, CAPTURE_HILL, SHOT).initialise()
    substep = float(net.record["solver_substep"][0])
    net.step(round(8.0 / substep) * substep)
    seen = []
    for _ in range(3):
        net.step(substep)
        outputs = {name: net[name] for name in (*CAPTURE_OUTPUTS, *CAPTURE_PARAMETERS)}
        seen.append((nodes(net)[1], outputs))
    assert net["contact.first_time"] < 0.0, "a touch changes velocities between two places"
    values = seen[1][1]
    mass, place = nodes(net)[0], seen[1][0]
    velocity = (seen[2][0] - seen[0][0]) / (2.0 * substep)

    def vector(name):
        return np.array([values[f"{name}[{i}]"] for i in (1, 2, 3)])

    def inertial(mass, place, seen_velocity):
        return Points(mass, place, seen_velocity + np.cross(TURNING, place))

    a, b, c = net.array("target_size")
    # six points on the axes with the moments of a uniform box: m x^2 sums to M a^2 / 12
    arms = np.diag([a, b, c]) * math.sqrt(6.0 / 24.0)
    body = np.concatenate([arms, -arms])
    turn = Rotation.from_quat([values[f"target.attitude[{i}]"] for i in (1, 2, 3, 4)], scalar_first=True).as_matrix()
    center = vector("target.position")
    swing = np.cross(vector("target.rate"), body) @ turn.T
    here = vector("target.velocity") + np.cross(TURNING, center)
    target = Points(np.full(6, values["target.mass"] / 6.0), center + body @ turn.T, here + swing)
    chaser = inertial(
        np.array([values["chaser.mass"]]), vector("chaser.position")[None], vector("chaser.velocity")[None]
    )
    return values, chaser, target, inertial(mass, place, velocity)


def test_the_catch_is_the_sum_of_its_nodes(shot):
    values, _, target, net = shot
    found = prepare(values, RATE)
    for body, points in ((found.catch, net), (found.target, target), (found.joint, target + net)):
        place, rate = points.center()
        assert body.mass == pytest.approx(points.mass.sum(), rel=1e-12)
        assert body.position == pytest.approx(place, abs=1e-10)
        assert body.inertial_velocity(found.turning) == pytest.approx(rate, abs=2e-6)
        assert body.inertia == pytest.approx(points.inertia(), abs=1e-9 * np.trace(points.inertia()))
        assert body.spin == pytest.approx(points.spin(), abs=2e-6 * np.trace(points.inertia()) + 1e-9)
    inner = net.energy() - 0.5 * net.mass.sum() * float(net.center()[1] @ net.center()[1])
    assert found.catch_energy == pytest.approx(inner, rel=1e-4)
    # the twin: the frame's turning is seen in all of these
    still = prepare(values, 0.0)
    assert still.joint.spin != pytest.approx((target + net).spin(), abs=1e-2)
    assert still.catch.spin != pytest.approx(net.spin(), abs=1e-3)


def test_the_ledger_is_that_of_the_raw_states(shot, validated):
    values, chaser, target, net = shot
    found = prepare(values, RATE)
    rows = {row.quantity: row for row in ledger(found, found.parameters)}
    everything = chaser + target + net
    mass = rows["mass, all"].before
    validated(NODES, "shot of Table 1 at 8 s: mass of all", mass, everything.mass.sum(), "kg", rel=1e-12)
    energy = rows["kinetic energy"]
    validated(NODES, "shot of Table 1 at 8 s: kinetic energy", energy.before, everything.energy(), "J", rel=1e-4)
    for axis, label in enumerate(("radial", "along-track", "cross-track")):
        orbital = rows[f"angular momentum, orbital part, {label}"]
        spin = rows[f"angular momentum, spin part, {label}"]
        size = orbital.magnitude + spin.magnitude
        # what became spin is in both parts, once as accounted for
        whole = orbital.before + spin.before - orbital.accounted
        assert whole == pytest.approx(everything.spin()[axis], abs=1e-6 * size)
        assert spin.accounted == pytest.approx((target + net).spin()[axis], abs=1e-6 * size)
    assert all(row.closed for row in rows.values())


def test_the_line_is_that_between_chaser_and_net(shot, validated):
    values, chaser, target, net = shot
    line = line_of(prepare(values, RATE), 100.0)
    knots = round(math.sqrt(len(net.mass)))
    vertex = net.position[(knots * knots) // 2]
    reach, attachment = math.dist(chaser.position[0], vertex), math.dist(vertex, (target + net).center()[0])
    validated(NODES, "shot of Table 1 at 8 s: chaser to the net's vertex", line.reach, reach, "m", abs=1e-9)
    validated(NODES, "shot of Table 1 at 8 s: vertex to the joint centre", line.attachment, attachment, "m", abs=1e-9)
