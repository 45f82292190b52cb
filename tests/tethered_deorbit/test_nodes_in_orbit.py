"""A line of lumped nodes in orbit, against an integration of its own: absolute places in long double, by RK4."""

from collections.abc import Callable

import numpy as np
import numpy.typing as npt
import pytest

from fmu_src.tethered_deorbit.environment.perturbed import make_perturbing
from orbital.constants import (
    EARTH_EQUATORIAL_RADIUS,
    EARTH_J2,
    EARTH_J3,
    EARTH_J4,
    EARTH_MU,
    EARTH_ROTATION_RATE,
    SUN_MU,
)
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

    def __init__(self, i: PlainInstance, disturbed: Callable[[Longs, Longs], Longs] | None = None) -> None:
        self.disturbed = disturbed
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
        if self.disturbed is not None:
            a += self.disturbed(x, v)
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


AIR = {
    "air.base_density": 1e-9,
    "air.base_altitude": 800e3,
    "air.scale_height": 50.0,
    "air.chaser_area": 2.0,
    "air.target_area": 1.0,
}
"""Air so dense, and thinning so fast over the line, that its difference between two nodes counts [SI]."""


def harmonic(x: Longs, degree: int, strength: float) -> Longs:
    """Acceleration by one zonal harmonic at places along rows [m/s^2], by the derivatives of Legendre's polynomials."""
    r = np.sqrt((x * x).sum(axis=1))[:, None]
    s = x[:, 2:] / r
    legendre = np.polynomial.legendre.Legendre.basis
    factor = EARTH_MU * np.longdouble(strength) * np.longdouble(EARTH_EQUATORIAL_RADIUS) ** degree / r ** (degree + 2)
    above, own = (legendre(n).deriv().convert(kind=np.polynomial.Polynomial) for n in (degree + 1, degree))
    pole = np.array([[0, 0, 1]], dtype=np.longdouble)
    return factor * (above(s) * x / r - own(s) * pole)


def dragged(x: Longs, v: Longs) -> Longs:
    """Acceleration of chaser, nodes and target by the air of `AIR` [m/s^2], rows as of `Independent`."""
    u = v - EARTH_ROTATION_RATE * np.column_stack([-x[:, 1], x[:, 0], 0 * x[:, 0]])
    altitude = np.sqrt((x * x).sum(axis=1)) - EARTH_EQUATORIAL_RADIUS
    density = AIR["air.base_density"] * np.exp((AIR["air.base_altitude"] - altitude) / AIR["air.scale_height"])
    piece = LENGTH / (COUNT + 1)
    of_node = [pair.DIAMETER * piece / (DENSITY * pair.SECTION * piece)] * COUNT
    shown = np.array([AIR["air.chaser_area"] / pair.CHASER, *of_node, AIR["air.target_area"] / pair.TARGET])
    speed = np.sqrt((u * u).sum(axis=1))
    found: Longs = -(1.1 * shown * density * speed)[:, None] * u
    return found


def test_a_flattened_earth_and_the_air_act_on_nodes(validated: Validated) -> None:
    """The same line on an orbit that both disturb; without either it would be off by micrometres and more."""
    terms = {"oblateness": "J2", "air": "exponential", "thrust": "along_track"}
    i = pair.lumped(COUNT, DENSITY, START | AIR, environment="central", **terms)
    both, neither = Independent(i, lambda x, v: harmonic(x, 2, EARTH_J2) + dragged(x, v)), Independent(i)
    only_air, only_flattened = Independent(i, dragged), Independent(i, lambda x, v: harmonic(x, 2, EARTH_J2))
    i.step(6.0)
    (places, _), off = pair.nodes_of(i), []
    for peer in (both, only_air, only_flattened, neither):
        peer.step(6)
        off.append(np.abs(places - (peer.x[1:-1] - peer.x[-1]).astype(float)).max())
    source = other_code("RK4 in long double, absolute places")
    what = "three nodes in orbit over a flattened Earth, in air: places from the target"
    validated(source, what, off[0], 0.0, "m", abs=1e-10)
    assert min(off[1:]) > 1e-6


@pytest.mark.parametrize(
    ("group", "term"), [("oblateness", "J2"), ("oblateness", "J4"), ("air", "exponential"), ("third_bodies", "sun")]
)
def test_what_disturbs_a_node_against_long_double(group: str, term: str) -> None:
    """What acts on a node less what acts on the target, by the difference of both in long double."""
    values = START | (AIR if group == "air" else {})
    i = pair.lumped(COUNT, DENSITY, values, environment="central", thrust="along_track", **{group: term})
    state, (places, rates) = pair.state_of(i), pair.nodes_of(i)
    found = np.zeros(3)
    make_perturbing(i.interface).beside(i.record, state, places[1], rates[1], found)
    both = Independent(i)
    x = both.x[[0, 2, 4]]
    if group == "oblateness":
        a = harmonic(x, 2, EARTH_J2)
        if term == "J4":
            a += harmonic(x, 3, EARTH_J3) + harmonic(x, 4, EARTH_J4)
    elif group == "air":
        a = dragged(both.x, both.v)[[0, 2, 4]]
    else:
        apart = x - i.record[0].state_sun.astype(np.longdouble)
        a = -np.longdouble(SUN_MU) * apart / np.sqrt((apart * apart).sum(axis=1))[:, None] ** 3
    expected = (a[1] - a[2]).astype(float)
    assert found == pytest.approx(expected, rel=1e-6, abs=1e-7 * np.abs(expected).max())
