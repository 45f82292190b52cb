"""The gravity gradient on a target whose appendage swings: two bodies in the tide of a circular orbit, by scipy; its
potential, order and Jacobi's energy."""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from orbital.kernel import kernel
from tests.net_capture.memory import Bench
from tests.net_capture.two_bodies import AXIS, POINT, TERMS, WING, TwoBodies, body_turn, tables_of

NAMED = TERMS | {"gravity": "hill", "gravity_gradient": "plain"}
ORBIT = math.sqrt(3.986004418e14 / 7178137.0**3)
"""Mean motion at 800 km [rad/s]."""
ATTITUDE = Rotation.from_euler("xyz", (0.3, -0.5, 0.9))
RATE, ANGLE, SPEED = np.array([0.004, -0.006, 0.005]), 0.3, 0.002
STIFFNESS, DAMPING = 0.003, 0.02


class InTheTide(TwoBodies):
    """Both bodies in inertial axes, in the field of an orbit: a force on each centre of mass, a torque about it."""

    share = 1.0

    def rates(self, time, y):
        out = super().rates(time, y)
        up, forces = np.array([math.cos(ORBIT * time), math.sin(ORBIT * time), 0.0]), np.zeros(12)
        for k, (place, turn, _, _) in enumerate(self.parts(y)):
            moments = turn.as_matrix() @ self.moments[k] @ turn.as_matrix().T
            forces[6 * k : 6 * k + 3] = self.masses[k] * ORBIT**2 * (3.0 * (up @ place) * up - place)
            forces[6 * k + 3 : 6 * k + 6] = 3.0 * ORBIT**2 * np.cross(up, moments @ up)
        gained = self.solve(y, self.share * forces, self.constraints(y)[0], np.zeros(5))
        for k in (0, 1):
            out[13 * k + 7 : 13 * k + 13] += gained[6 * k : 6 * k + 6]
        return out


class Swinging:
    """Such a target in Hill's frame, by the kernels of one substep, without a net."""

    def __init__(self):
        self.tables, self.mass = tables_of(limit=2.0)
        self.bench = Bench(NAMED, self.tables)
        parts, self.p = self.bench.parts, self.bench.p
        put, drift, tell, ready = parts.target.place, parts.target.drift, parts.target.measure, parts.gravity.start
        frame_rate, (begin, kick, carry, measure) = parts.gravity.rate, parts.gradient[:4]

        @kernel
        def place(record):
            p = record[0]
            ready(p)
            fault = put(p)
            begin(p)
            tell(p)
            measure(p)
            return fault

        @kernel
        def advance(record, h, steps):
            p = record[0]
            for _ in range(steps):
                kick(p, 0.5 * h)
                drift(p, frame_rate(p), h)
                carry(p, frame_rate(p), h)
                kick(p, 0.5 * h)
            tell(p)
            measure(p)

        self._place, self._advance = place, advance

    def place(self, attitude=ATTITUDE, angle=ANGLE, rate=RATE, speed=SPEED, damping=0.0):
        p = self.p
        p.target_mass, p.hinge_stiffness, p.hinge_damping = self.mass, STIFFNESS, damping
        p.target_start_attitude[:] = attitude.as_quat(scalar_first=True)
        p.target_start_rate[:] = rate
        p.hinge_start_angle, p.hinge_start_rate = angle, speed
        assert self._place(self.bench.record) == 0
        return self

    def advance(self, time, h):
        self._advance(self.bench.record, h, round(time / h))
        return self

    @property
    def attitude(self):
        """Of the rest, from its design axes to the frame."""
        return Rotation.from_quat(self.p.target_pose, scalar_first=True) * body_turn(self.tables)[0].inv()

    @property
    def energy(self):
        """Jacobi's, of turning and swinging, with what the dashpot took [J]."""
        p = self.p
        return p.target_energy + p.hinge_energy + p.hinge_loss - ORBIT * p.target_spin[2] + p.gravity_gradient_energy


@pytest.fixture(scope="module")
def swinging():
    return Swinging()


def by_scipy(time, damping=DAMPING, share=1.0):
    """Attitude of the rest in the frame, and angle of the hinge."""
    two = InTheTide(WING, POINT, AXIS, STIFFNESS, damping)
    two.share = share
    end = two.fly(two.start(ATTITUDE, ATTITUDE.apply(RATE), ANGLE, SPEED), time)
    return Rotation.from_euler("z", -ORBIT * time) * two.parts(end)[0][1], two.angle(end)


def apart(swinging, wanted):
    attitude, angle = wanted
    return np.array([(swinging.attitude.inv() * attitude).magnitude(), abs(swinging.p.hinge_now[6] - angle)])


def test_it_turns_and_swings_as_two_bodies_in_the_tide(swinging):
    """And is of second order: by 4 with every halving of the substep. Without the tide, or 1 % of it, it is not so."""
    wanted, steps = by_scipy(400.0), (2.0, 1.0, 0.5)
    left = np.array([apart(swinging.place(damping=DAMPING).advance(400.0, h), wanted) for h in steps])
    for error in left.T:
        assert np.polyfit(np.log(steps), np.log(error), 1)[0] == pytest.approx(2.0, abs=0.1)
    swinging.place(damping=DAMPING).advance(400.0, 0.02)
    assert apart(swinging, wanted).max() < 1e-6
    assert np.abs(apart(swinging, by_scipy(400.0, share=0.0))).min() > 3e-3
    assert apart(swinging, by_scipy(400.0, share=0.99)).min() > 3e-5


def test_what_acts_on_the_hinge_is_the_slope_of_the_potential(swinging):
    """And the potential is that of both bodies in the tide, (1/2) k sum of m (x.x - 3 (u.x)^2), by their moments."""
    two = TwoBodies(WING, POINT, AXIS)

    def potential(angle):
        total, up = 0.0, np.array([1.0, 0.0, 0.0])
        for k, (place, turn, _, _) in enumerate(two.parts(two.start(ATTITUDE, np.zeros(3), angle, 0.0))):
            moments = turn.as_matrix() @ two.moments[k] @ turn.as_matrix().T
            second = 0.5 * np.trace(moments) * np.eye(3) - moments + two.masses[k] * np.outer(place, place)
            total += 0.5 * ORBIT**2 * (np.trace(second) - 3.0 * up @ second @ up)
        return total

    for angle in (-0.9, 0.0, 0.3, 1.4):
        p = swinging.place(angle=angle, rate=np.zeros(3), speed=0.0).p
        assert p.gravity_gradient_energy == pytest.approx(potential(angle), rel=1e-12)
        before = p.hinge_now[7]
        swinging.advance(1e-6, 1e-6)
        slope = (potential(angle + 1e-4) - potential(angle - 1e-4)) / 2e-4
        wanted = -slope - STIFFNESS * angle
        assert abs(slope) > 1e-6
        assert (p.hinge_now[7] - before) / 1e-6 == pytest.approx(wanted, rel=1e-5)


def test_the_energy_in_the_orbit_is_kept(swinging):
    """What Jacobi's energy is off by falls with the square of the substep, and is little of what goes to and fro."""
    left = []
    for h in (2.0, 1.0, 0.5):
        start = swinging.place(damping=DAMPING).energy
        told, moved = [], []
        for _ in range(100):
            swinging.advance(20.0, h)
            told.append(swinging.energy - start)
            moved.append(swinging.p.gravity_gradient_energy)
        left.append(np.abs(told).max())
    assert left[0] / left[1] > 3.8
    assert left[1] / left[2] > 3.8
    assert left[2] < 2e-3 * np.ptp(moved)
