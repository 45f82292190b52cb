"""A closed net is pulled at its vertex: the books of the load, and what is told of the threads."""

import math

import numpy as np
import pytest

from fmu_src.net_capture.interface import GROUPS
from fmu_src.net_capture.planes import SHOWN, SHOWN_RATE
from fmu_src.net_capture.pull_off import STANDS, load
from fmu_src.net_capture.refusal import Scene
from tests.net_capture.holding import HOLDING
from tests.net_capture.memory import graph, planes
from tests.validation import closed_form

CAUGHT = {"net.mesh": 2.0, "jam.time": 1e9, "tether.length": 100.0, "solver.jitter[1]": 1e-6}
PULL = {"pull_off.force": 20.0, "pull_off.delay": 1.0, "pull_off.ramp": 0.5, "pull_off.duration": 1.5}


def pulled(shoot, change):
    net = shoot(CAUGHT | PULL | change, HOLDING)
    net.step(12.0)
    while STANDS[net["pull_off.stands"]] in ("waiting", "pulled") and net.time < 30.0:
        net.step(0.05)
        yield net


@pytest.mark.parametrize("direction", [(0.0, 0.0, 0.0), (0.0, -3.0, 4.0)])
def test_momentum_grows_by_the_impulse_of_the_load_and_energy_by_its_work(validated, shoot, direction):
    """All of the impulse is F0 (ramp + duration), 40 N s; its direction is the chaser's, or as told."""
    change = {f"pull_off.direction[{i + 1}]": d for i, d in enumerate(direction)}
    for net in pulled(shoot, change):
        impulse, moment = net.array("pull_off_impulse"), net.array("pull_off_angular_impulse")
        assert np.abs(net.array("momentum") - impulse).max() < 1e-9 * 40.0
        assert np.abs(net.array("angular_momentum") - moment).max() < 1e-9 * 40.0 * 20.0
    assert net["captured"] == 1
    assert STANDS[net["pull_off.stands"]] == "held"
    pull = closed_form("F (ramp + duration)")
    validated(pull, "pull-off test: impulse of the load", np.linalg.norm(impulse), 40.0, "N s", rel=1e-4)
    momentum = np.linalg.norm(net.array("momentum"))
    validated(pull, "pull-off test: momentum of all bodies, at rest before", momentum, 40.0, "N s", rel=1e-4)
    if any(direction):
        assert impulse / 40.0 == pytest.approx(np.array(direction) / 5.0, abs=1e-4)
    else:
        assert impulse[1] < -0.9 * 40.0
    assert net["pull_off.work"] > 1.0
    assert abs(net["energy.remainder"]) < 0.03 * (9.0 + net["closing.work"] + net["pull_off.work"])
    assert net["pull_off.drawn_max"] > 0.1
    assert net["pull_off.t_start"] == pytest.approx(net["t_capture"] + 1.0, abs=0.0101)


def test_the_threads_that_bear_most_are_told(shoot):
    """Worked out again from the nodes: every thread's own tension, sorted."""
    for net in pulled(shoot, {}):
        if net["pull_off.load"] < 20.0:
            continue
        at, rate = planes(net)[SHOWN : SHOWN + 3], planes(net)[SHOWN_RATE : SHOWN_RATE + 3]
        told = graph(net)
        tensions = {}
        threads = zip(told.ends, told.length, told.stiffness, told.damping, strict=True)
        for number, ((a, b), length, stiffness, damping) in enumerate(threads, 1):
            way = at[:, b] - at[:, a]
            now = np.linalg.norm(way)
            if now > length:
                pace = way @ (rate[:, b] - rate[:, a]) / now
                tensions[number] = max(stiffness * (now - length) + damping * pace, 0.0)
        order = sorted(tensions, key=tensions.__getitem__, reverse=True)[:5]
        assert net.array("pull_off_hardest_thread").tolist() == order
        assert net.array("pull_off_hardest_tension") == pytest.approx([tensions[n] for n in order], rel=1e-6)
        return
    raise AssertionError("the whole load never came")


def test_a_load_beyond_what_threads_bear_is_told_by_their_tension(shoot):
    """2 kN on a net whose threads break at 1.07 kN: the load comes to the vertex along more than one of them."""
    strength = 2.92e9 * 0.33 / (1440.0 * 624.0)
    for net in pulled(shoot, {"pull_off.force": 2000.0}):
        at_most = net["pull_off.tension_max"]
    assert strength < at_most == net["thread.tension_max"]
    assert net["pull_off.hardest[1].tension"] > 500.0


@pytest.mark.parametrize(("at", "stands", "inside"), [(20.0, "held", 1.0), (3.0, "slipped_off", 0.0)])
def test_a_load_may_come_at_a_time(shoot, at, stands, inside):
    """On a net that is closed; and on one that flies, where nothing of a target has ever been inside."""
    net = shoot(CAUGHT | PULL | {"pull_off.after": 2, "pull_off.time": at, "pull_off.delay": 0.0}, HOLDING)
    net.step(at + 3.0)
    assert STANDS[net["pull_off.stands"]] == stands
    assert net["pull_off.inside[2]"] == pytest.approx(inside, abs=0.1)
    assert net["pull_off.t_start"] == pytest.approx(at, abs=0.011)


def test_the_load_rises_stays_and_falls():
    class Record:
        pull_off_t_start, pull_off_force, pull_off_ramp, pull_off_duration = 10.0, 8.0, 2.0, 3.0

    record = Record()
    loads = [load.py_func(record, t) for t in (9.0, 10.0, 11.0, 12.0, 15.0, 16.0, 17.0, 18.0)]
    assert loads == pytest.approx([0.0, 0.0, 4.0, 8.0, 8.0, 4.0, 0.0, 0.0])
    record.pull_off_t_start = -1.0
    assert load.py_func(record, 11.0) == 0.0
    assert math.isclose(8.0 * (2.0 + 3.0), np.trapezoid([0, 8, 8, 0], [10, 12, 15, 17]))


@pytest.mark.parametrize(
    ("values", "terms", "blamed"),
    [
        ({"pull_off.after": 0}, {}, []),
        ({"pull_off.after": 1}, {}, ["pull_off.after"]),
        ({"pull_off.after": 1}, {"settling": "speed"}, []),
        ({"pull_off.after": 0}, {"substeps": "following"}, ["solver.substeps"]),
    ],
)
def test_what_never_comes_is_refused(values, terms, blamed):
    refuses = GROUPS["pull_off"].terms["plain"].refuses
    assert [refusal.name for refusal in refuses(Scene(terms, values, 30.0, {}))] == blamed


@pytest.mark.parametrize(("rings", "stands"), [(0, "slipped_off"), (1, "held")])
def test_a_net_whose_loops_let_the_target_pass_is_pulled_off(shoot, rings, stands):
    """Without the ring between two bullets the loops are longer than the target's girth; the twin with it holds."""
    *_, net = pulled(shoot, {"closing.rings": rings, "pull_off.force": 100.0, "pull_off.duration": 12.0})
    slip = math.sqrt(sum(net[f"pull_off.slip[{i}]"] ** 2 for i in (1, 2, 3)))
    assert STANDS[net["pull_off.stands"]] == stands, (net.time, slip)
    assert (slip > 3.0) == (rings == 0)
    assert 20.0 < net["pull_off.tension_max"] < 558.0
