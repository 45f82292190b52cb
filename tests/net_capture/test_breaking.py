"""Threads that break: a pair on one thread by hand, and a whole net whose book still closes."""

import math

import numpy as np
import pytest

from fmu_src.instance import Instance
from fmu_src.net_capture.composition import Composition
from fmu_src.net_capture.interface import MODEL, refusals
from fmu_src.net_capture.planes import LANES, MASS, STRIP_WORDS
from tests.conftest import FREE
from tests.net_capture.memory import nodes, planes, shown
from tests.net_capture.taut_pair import PER_MASS, STIFFNESS, pair, state

BREAKS = FREE | {"break": "breaks", "volume": "plain"}
"""As in `test_volume`."""
RATE = 2.0
"""At which the two part [m/s]."""
OMEGA = math.sqrt(PER_MASS * STIFFNESS)
LARGEST = RATE * math.sqrt(STIFFNESS / PER_MASS)
"""Tension [N] of the swing that begins so, undamped: v sqrt(k m)."""


def parted(strength, ratio=0.0):
    """That pair, just taut, with threads of that strength, after one look."""
    changes = {"net.damping_ratio": ratio, "break.strength": strength, "solver.step_ratio": 0.02}
    net = pair("leapfrog", 0.0, RATE, changes, BREAKS)
    net.step(0.0)
    return net


def momentum(net):
    return planes(net)[MASS, nodes(net)] @ shown(net, 17)


def test_a_thread_breaks_when_its_tension_is_its_strength_and_both_nodes_fly_on():
    """By hand: k s = P at sin(w t) = P / (v sqrt(k m)); from then on the rate stays v cos(w t), and P^2/2k is gone."""
    strength = 0.6 * LARGEST
    net = parted(strength)
    before, left = momentum(net), net["energy.remainder"]
    net.step(0.6 * math.pi / OMEGA)
    expected = math.asin(0.6) / OMEGA
    assert (net["break.count"], net["break.first"]) == (1, 1)
    assert expected <= net["break.time"] <= expected + 1.01 * net["solver.substep"]
    stretch, rate = state(net)
    assert rate == pytest.approx(RATE * math.cos(OMEGA * net["break.time"]), rel=1e-3)
    assert rate == pytest.approx(0.8 * RATE, rel=2e-2)
    flown = 0.6 * math.pi / OMEGA - net["break.time"]
    assert stretch == pytest.approx(RATE / OMEGA * math.sin(OMEGA * net["break.time"]) + rate * flown, rel=1e-3)
    bore = STIFFNESS * RATE / OMEGA * math.sin(OMEGA * net["break.time"])
    assert net["break.energy"] == pytest.approx(bore**2 / (2.0 * STIFFNESS), rel=1e-3)
    assert net["thread.tension_max"] == pytest.approx(strength, rel=3e-2)
    assert net["energy.elastic"] == 0.0
    np.testing.assert_allclose(momentum(net), before, atol=1e-15 * RATE)
    assert abs(net["energy.remainder"] - left) < 1e-3 * 0.5 * RATE**2 / PER_MASS


def test_its_twin_a_hundredth_stronger_than_the_swing_holds():
    net = parted(1.01 * LARGEST)
    net.step(1.2 * math.pi / OMEGA)
    assert (net["break.count"], net["break.time"], net["break.energy"]) == (0, -1.0, 0.0)
    assert state(net)[1] == pytest.approx(-RATE, rel=1e-2)


def test_what_the_dashpot_took_before_stays_booked():
    """With damping the book closes over the break as well as without it."""
    net = parted(0.6 * LARGEST, 0.1)
    left = net["energy.remainder"]
    net.step(0.6 * math.pi / OMEGA)
    assert net["break.count"] == 1
    whole = 0.5 * RATE**2 / PER_MASS
    assert net["thread.dissipated"] > 0.01 * whole
    assert abs(net["energy.remainder"] - left) < 5e-3 * whole


SHOT = {"net.mesh": 2.0, "net.damping_ratio": 0.106}


def flown(terms, changes=None, duration=14.0):
    """Table 1's net at 2 m, opened and jerked taut."""
    net = Instance(MODEL, terms, SHOT | (changes or {})).initialise()
    for _ in range(round(duration / 0.5)):
        net.step(0.5)
    return net


def there(net):
    """Threads that are left, a lane of a strip each."""
    at = planes(net).nbytes // 8
    strips = net.work[at : at + STRIP_WORDS * int(net.record["strips"][0])].view(np.int64).reshape(-1, STRIP_WORDS)
    return sum(int(lanes).bit_count() for lanes in strips[:, LANES].view(np.uint64))


@pytest.fixture(scope="module")
def whole():
    return flown(FREE)


def test_a_strength_that_is_not_reached_changes_no_bit(whole):
    net = flown(BREAKS, {"break.strength": 1.01 * whole["thread.tension_max"]})
    assert net["break.count"] == 0
    np.testing.assert_array_equal(shown(net), shown(whole))
    assert net["energy.remainder"] == whole["energy.remainder"]


def test_a_net_that_tears(whole):
    """Momentum as of the net that holds, the book closed by what the breaks took, and a lane less for each thread."""
    net = flown(BREAKS, {"break.strength": 0.5 * whole["thread.tension_max"]})
    torn = int(net["break.count"])
    assert torn > 0
    assert there(whole) - there(net) == torn
    np.testing.assert_allclose(net.array("momentum"), whole.array("momentum"), atol=1e-12)
    assert net["break.energy"] > 1e-4
    assert abs(net["energy.remainder"]) < 0.01 * 9.0
    assert net["thread.tension_max"] < 0.6 * whole["thread.tension_max"]
    again = flown(BREAKS, {"break.strength": 0.5 * whole["thread.tension_max"]})
    np.testing.assert_array_equal(shown(again), shown(net))
    again.initialise()
    assert (again["break.count"], there(again)) == (0, there(whole))


def test_other_schemes_keep_threads_whole():
    with pytest.raises(ValueError, match="break needs solver = 'leapfrog'"):
        Composition(MODEL, MODEL.interface(BREAKS | {"solver": "rk4"}).terms)
    terms = dict(MODEL.interface(BREAKS | {"solver": "rk4"}).terms)
    values = {name: float(start) for name, _, _, start in MODEL.interface(terms).scalars()}
    assert [refusal.name for refusal in refusals(terms, values)] == ["solver.scheme"]
    assert not refusals(dict(MODEL.interface(BREAKS).terms), values)
