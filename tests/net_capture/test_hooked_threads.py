"""Threads that hang on thin pieces: once a straight thread has crossed one it still lies on the side where it was.

How it lies is judged by the nodes alone, in plain numpy: by how far one has turned about the axis of a boom against the
other, counted on through whole turns, the shortest way of that class round a circle is known in closed form. A thread
that has gone through is one for which that is longer than the thread.
"""

import math

import numpy as np
import pytest

from fmu_src.net_capture.contact.section import INSET, MOST
from fmu_src.net_capture.planes import U, X
from fmu_src.net_capture.shapes import hulls, pieces
from tests.net_capture.on_target import Kernels
from tests.net_capture.test_union_wrapping import HEAVY, TERMS, box, laid

RADIUS, LENGTH, MASS, STIFFNESS, TOGETHER = 0.04, 1.0, 0.1, 2000.0, 10


def boom_of(radius):
    """A boom along the third axis between two blocks, all in the middle."""
    boom = {"shape": pieces.CYLINDER, "radius": radius, "length": 3.0, "mass": 4.0}
    return laid(boom, box((2.0, 2.0, 0.5), (0.0, 0.0, -1.7)), box((2.0, 2.0, 0.5), (0.0, 0.0, 1.7)))


BOOM = boom_of(RADIUS)
ROUND = TERMS | {"target": "cylinder"}


@pytest.fixture(scope="module")
def kernels():
    return Kernels(TERMS, BOOM)


def way_round(a, b, turned, radius):
    """Shortest way [m] between two points past a circle about the third axis, if the second stands by the angle
    `turned` [rad] farther than the first, through whole turns."""
    far, other = math.hypot(*a[:2]), math.hypot(*b[:2])
    free = sum(math.acos(min(1.0, radius / each)) for each in (far, other))
    if abs(turned) <= free:
        flat = math.sqrt(max(0.0, far * far + other * other - 2.0 * far * other * math.cos(turned)))
    else:
        flat = sum(math.sqrt(max(0.0, each * each - radius * radius)) for each in (far, other))
        flat += radius * (abs(turned) - free)
    return math.hypot(flat, b[2] - a[2])


class Thrown:
    """Two nodes on a slack thread beside a boom, followed for so long.

    longest   the longest that the way of its class has been, over the thread [m]
    least     the least turn of one node about the boom against the other, beyond half a turn [rad]
    """

    def __init__(self, kernels, tables, places, speeds, radius=RADIUS, span=1.5, substep=1e-4, length=LENGTH, **sizes):
        self.scene = kernels.place(tables, **HEAVY | {"wrap_friction": 0.0} | sizes)
        self.scene.put([MASS] * 2, places, speeds).join(2, length, STIFFNESS, 0.0)
        self.p, self.planes = self.scene.p, self.scene.planes
        self.before = 0.5 * MASS * (np.asarray(speeds) ** 2).sum()
        self.longest, self.most, turned = -math.inf, 0.0, None
        for _ in range(round(span / substep / TOGETHER)):
            self.scene.go(substep, TOGETHER)
            a, b = self.planes[X : X + 3, :2].T
            angle = math.atan2(b[1], b[0]) - math.atan2(a[1], a[0])
            if turned is None:
                turned = math.remainder(angle, 2.0 * math.pi)
            turned += math.remainder(angle - turned, 2.0 * math.pi)
            self.most = max(self.most, abs(turned) - math.pi)
            self.now = way_round(a, b, turned, radius - INSET) - length
            if sum(self.counted) > 0:
                break
            self.longest = max(self.longest, self.now)

    def energy(self):
        return 0.5 * MASS * float((self.planes[U : U + 3, :2] ** 2).sum())

    @property
    def counted(self):
        return int(self.p["wrap_passed"]), int(self.p["wrap_passed_slack"])


def test_a_slack_thread_that_crosses_a_boom_is_held_and_keeps_its_energy(kernels):
    """It meets the boom in its middle, hangs on it, swings its nodes together and comes free where it came from."""
    places, speeds = [(0.06, 0.35, 0.0), (0.06, -0.35, 0.0)], [(-1.0, 0.0, 0.0)] * 2
    thrown = Thrown(kernels, BOOM, places, speeds)
    assert thrown.most > 0.0, "the straight thread has gone through"
    assert thrown.longest < 0.02
    assert thrown.counted == (0, 0)
    assert thrown.p["wrap_impulse"] > 0.1
    assert thrown.energy() == pytest.approx(thrown.before, rel=1e-3)


def thrown_at(kernels, tables, number, radius, length=LENGTH):
    """A thread thrown at the boom aslant, its nodes beside it by so much."""
    draw = np.random.default_rng([7, number])
    y, z = draw.uniform(0.1, 0.4, 2), draw.uniform(-0.2, 0.2, 2)
    places = [(radius + 0.02, y[0], z[0]), (radius + 0.02, -y[1], z[1])]
    speeds = draw.normal((-1.0, 0.0, 0.0), 0.4, (2, 3))
    return Thrown(kernels, tables, places, speeds, radius, 1.0, 2e-4, length)


def test_no_thrown_thread_passes_a_boom_by_the_turns_of_its_nodes(kernels):
    """Wound up by more than a turn they hold; one that is wound twice slips, and that is told."""
    found = [thrown_at(kernels, BOOM, number, RADIUS) for number in range(20)]
    for each in found:
        assert each.longest < 0.03 or each.p["wrap_slipped"] > 0
    assert sum(each.longest < 0.03 for each in found) >= 19
    assert not any(sum(each.counted) for each in found)
    assert sum(each.most > 0.0 for each in found) > 10
    assert max(each.most for each in found if each.longest < 0.03) > math.pi


def test_threads_wound_round_a_thick_boom_hold(kernels):
    """Of a cylinder of forty faces edges are kept for a whole turn."""
    thick = boom_of(0.3)
    assert hulls.faces_round(0.3) == MOST
    held = [thrown_at(kernels, thick, number, 0.3, 1.2) for number in range(12)]
    assert not any(sum(each.counted) for each in held)
    assert max(each.longest for each in held) < 0.03
    assert max(each.most for each in held) > 0.3, "wound round more than half of it"


@pytest.mark.parametrize(("length", "told"), [(1.5, 0), (2.4, 1)])
def test_a_thread_wound_farther_than_is_kept_is_told_once(length, told):
    """Taut, its nodes flung round a cylinder from both sides: they wind it up until they meet the surface."""
    places = [(0.31, 0.495 * length, 0.0), (0.31, -0.495 * length, 0.0)]
    sizes = {"target_radius": 0.3, "target_length": 6.0}
    wound = Thrown(Kernels(ROUND), None, places, [(-2.0, 0.0, 0.0)] * 2, 0.3, 2.0, 2e-4, length, **sizes)
    assert (wound.most > math.pi) == (told == 1)
    assert sum(wound.counted) == told
    assert wound.longest < 0.02, "up to where it is told"
