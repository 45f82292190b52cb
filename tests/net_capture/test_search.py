"""When a row may be left alone: no node of it comes near the target before, however its threads pull and it moves."""

import numpy as np
import pytest

from fmu_src.net_capture.contact.search import HASTE, make_search
from fmu_src.net_capture.planes import INVERSE_MASS, MASS, P, X
from tests.net_capture.memory import Bench, graph_of, planes_of
from tests.plain import plain

__all__ = ["plain"]
TERMS = {"net": "square", "gravity": "none", "target": "box", "contact": "inelastic"}
RADIUS, STEP, LONGEST = 3.0, 1e-4, 2000
CENTRE = np.array([1.0, -2.0, 0.5])


@pytest.fixture(scope="module")
def bench():
    made = Bench(TERMS)
    made.search = make_search(made.parts, LONGEST)
    p = made.p
    p.solver_substep, p.envelope_radius = STEP, RADIUS
    p.target_place[:] = CENTRE
    return made


def lay(bench, distances, speeds):
    """Put the first row's nodes so far from the target's middle, flying so fast towards it."""
    generator = np.random.default_rng(8)
    memory, pitch = planes_of(bench.p, bench.work, bench.parts.terms), int(bench.p.row_pitch)
    ways = generator.normal(size=(pitch, 3))
    ways /= np.linalg.norm(ways, axis=1)[:, None]
    memory[X : X + 3, :pitch] = (CENTRE + distances[:, None] * ways).T
    memory[P : P + 3, :pitch] = (-speeds[:, None] * ways).T


def reached(distance, speed, pull):
    """When a body at a speed, drawn at an acceleration, has come this far [s]: v t + a t^2 / 2 = d."""
    if pull == 0.0:
        return distance / speed
    return (np.sqrt(speed * speed + 2.0 * pull * distance) - speed) / pull


@pytest.mark.parametrize("force", [0.0, 0.3, 20.0])
@pytest.mark.parametrize(("haste", "near", "fast"), [(0.0, 3.2, 4.0), (0.2, 5.0, 3.0), (7.0, 40.0, 0.1)])
def test_no_node_comes_near_before_its_row_is_looked_at(bench, force, haste, near, fast):
    """Straight at the target, pulled there by as many threads as meet at a node, the target coming to meet it: as late
    as that allows, but for two substeps and a rounding down."""
    p, generator = bench.p, np.random.default_rng(2)
    pitch = int(p.row_pitch)
    distances = generator.uniform(near, near + 10.0, pitch)
    speeds = generator.uniform(0.01, fast, pitch)
    distances[3], speeds[5] = near, fast
    lay(bench, distances, speeds)
    p.contact_haste, p.contact_force, p.contact_pull = haste, force, 12.0
    steps = bench.search.clear_steps(p, bench.work, 0, force > 0.0)
    soonest = min(reached(d - RADIUS, v + haste, 12.0 * force) for d, v in zip(distances, speeds, strict=True))
    assert 0 < steps <= min(soonest / STEP, LONGEST)
    bound = reached(near - RADIUS, fast + haste, 12.0 * force)
    assert steps >= min(bound / STEP - 3.1, LONGEST)


def test_a_node_within_reach_is_looked_at_in_every_substep(bench):
    distances, speeds = np.full(int(bench.p.row_pitch), 9.0), np.zeros(int(bench.p.row_pitch))
    distances[2] = 0.9 * RADIUS
    lay(bench, distances, speeds)
    bench.p.contact_haste = 0.0
    assert bench.search.clear_steps(bench.p, bench.work, 0, False) == 0


@pytest.mark.usefixtures("plain")
def test_the_largest_pull_is_that_of_a_node_where_most_threads_meet(bench):
    """As many threads as meet at a node at most, over the lightest mass."""
    memory = planes_of(bench.p, bench.work, bench.parts.terms)
    memory[INVERSE_MASS] = np.divide(1.0, memory[MASS], out=np.zeros_like(memory[MASS]), where=memory[MASS] > 0.0)
    meeting = np.bincount(graph_of(bench.p, bench.work, bench.parts.terms).ends.ravel())
    expected = meeting.max() / memory[MASS][memory[MASS] > 0.0].min()
    assert meeting.max() == 4
    assert bench.search.largest_pull(bench.p, bench.work) == pytest.approx(expected, rel=1e-12)


@pytest.mark.usefixtures("plain")
def test_rows_are_looked_at_again_when_the_target_or_a_thread_gains(bench):
    p, hurries = bench.p, bench.search.hurries
    p.contact_haste = p.contact_force = p.contact_reckoned = 0.0
    p.target_drift[:] = 0.0
    assert not hurries(p)
    p.target_drift[0] = 2.0
    assert hurries(p)
    assert p.contact_haste == pytest.approx(1.5 * 2.0 + HASTE)
    assert not hurries(p)
    p.target_drift[0] = 2.9
    assert not hurries(p)
    p.contact_force = 5.0
    assert hurries(p)
    assert not hurries(p)


@pytest.mark.usefixtures("plain")
def test_rows_are_looked_at_again_when_the_winches_or_the_tether_begin_to_pull():
    """Of what pulls besides threads nothing was reckoned: once when it begins, and after a rest again."""
    bench = Bench(TERMS | {"closing": "winches", "tether": "slack"})
    p, hurries = bench.p, make_search(bench.parts, LONGEST).hurries
    p.contact_haste = p.contact_force = p.contact_reckoned = p.tether_vertex_tension = 0.0
    p.closing_t_start, p.contact_besides = -1.0, 0
    p.target_drift[:] = 0.0
    assert not hurries(p)
    p.tether_vertex_tension = 2.0
    assert hurries(p)
    assert not hurries(p)
    p.tether_vertex_tension = 0.0
    assert not hurries(p)
    p.closing_t_start = 0.5
    assert hurries(p)
    assert not hurries(p)


@pytest.mark.usefixtures("plain")
def test_rows_are_looked_at_again_when_a_tether_that_drags_begins_to_pull():
    bench = Bench(TERMS | {"tether": "dragging"})
    p, hurries = bench.p, make_search(bench.parts, LONGEST).hurries
    p.contact_haste = p.contact_force = p.contact_reckoned = p.tether_vertex_tension = p.tether_drag = 0.0
    p.contact_besides = 0
    p.target_drift[:] = 0.0
    assert not hurries(p)
    p.tether_drag = 0.5
    assert hurries(p)
    assert not hurries(p)
