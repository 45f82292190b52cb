"""A line of lumped nodes in orbit, against an integration of its own: absolute places in long double, by RK4."""

import numpy as np
import numpy.typing as npt
import pytest

from orbital.constants import EARTH_MU
from tests.plain import PlainInstance, plain
from tests.tethered_deorbit import lumped as pair
from tests.validation import Validated, other_code

__all__ = ["plain"]

pytestmark = pytest.mark.usefixtures("plain")
Longs = npt.NDArray[np.longdouble]
DENSITY, LENGTH, THRUST, COUNT = 60e3, 101.0, -0.05, 3
STEP, PER_SECOND = np.longdouble(1) / 128, 128
START = {
    "tether.rest_length": LENGTH,
    "thrust.level": THRUST,
    "start_relative_position": (60.0, 80.0, 10.0),
    "start_relative_velocity": (0.05, 0.02, 0.03),
}


class Independent:
    """Chaser, nodes and target as point masses at absolute places, chained by springs that pull and never push."""

    def __init__(self, i: PlainInstance) -> None:
        state, (places, rates) = pair.state_of(i).astype(np.longdouble), pair.nodes_of(i)
        center, velocity, apart_by, parting = state[:12].reshape(4, 3)
        share = np.longdouble(pair.CHASER) / np.longdouble(pair.CHASER + pair.TARGET)
        target, its_rate = center + share * apart_by, velocity + share * parting
        self.x: Longs = np.vstack([target - apart_by, target + places, target])
        self.v: Longs = np.vstack([its_rate - parting, its_rate + rates, its_rate])
        self.piece = np.longdouble(LENGTH) / (COUNT + 1)
        node = np.longdouble(DENSITY) * np.longdouble(pair.SECTION) * self.piece
        self.mass: Longs = np.array([pair.CHASER, *[node] * COUNT, pair.TARGET], dtype=np.longdouble)[:, None]

    def acceleration(self, x: Longs, v: Longs) -> Longs:
        a: Longs = -np.longdouble(EARTH_MU) * x / np.sqrt((x * x).sum(axis=1))[:, None] ** 3
        span = np.diff(x, axis=0)
        length = np.sqrt((span * span).sum(axis=1))
        tension = np.maximum(0, pair.AXIAL / self.piece * (length - self.piece))
        pull = (tension / length)[:, None] * span
        a[:-1] += pull / self.mass[:-1]
        a[1:] -= pull / self.mass[1:]
        along = v[0] - x[0] * (x[0] @ v[0]) / (x[0] @ x[0])
        a[0] += THRUST * along / np.sqrt(along @ along) / self.mass[0]
        return a

    def step(self, seconds: int) -> None:
        """Runge-Kutta's classical scheme."""
        h = STEP
        for _ in range(seconds * PER_SECOND):
            x, v = self.x, self.v
            first = self.acceleration(x, v)
            second = self.acceleration(x + h / 2 * v, v + h / 2 * first)
            third = self.acceleration(x + h / 2 * v + h * h / 4 * first, v + h / 2 * second)
            last = self.acceleration(x + h * v + h * h / 2 * second, v + h * third)
            self.x = x + h * v + h * h / 6 * (first + second + third)
            self.v = v + h / 6 * (first + 2 * second + 2 * third + last)


def test_gravity_and_pull_in_orbit(validated: Validated) -> None:
    """100 m of line at 800 km, pulled taut by the thrust: nodes within 1e-10 m; slack again, within 1e-6 m."""
    i = pair.lumped(COUNT, DENSITY, START, environment="central", thrust="along_track")
    peer = Independent(i)
    source = other_code("RK4 in long double, absolute places")
    for seconds, allowed, what in ((12, 1e-10, "pulled taut"), (8, 1e-6, "slack again")):
        i.step(float(seconds))
        peer.step(seconds)
        assert i["tether.impulse"] > 0.2
        apart_by, (places, _) = pair.state_of(i)[6:9], pair.nodes_of(i)
        mine = np.vstack([-apart_by, places])
        off = np.abs(mine - (peer.x[:-1] - peer.x[-1]).astype(float)).max()
        validated(
            source,
            f"three nodes in orbit, {what}: places of chaser and nodes from the target",
            off,
            0.0,
            "m",
            abs=allowed,
        )
