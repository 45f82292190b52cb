"""Threads that push each other apart: two of them against closed forms, a tangle's books, a net folded over itself."""

import math

import numpy as np
import pytest

from fmu_src.cautions import Range
from fmu_src.implied import formula
from fmu_src.instance import Instance
from fmu_src.net_capture import cautions
from fmu_src.net_capture.composition import Composition
from fmu_src.net_capture.implied import substeps
from fmu_src.net_capture.interface import MODEL, refusals
from fmu_src.net_capture.planes import SHOWN_RATE
from fmu_src.net_capture.self_contact import segments
from fmu_src.net_capture.self_contact.holding import holding_speed
from tests.conftest import FREE
from tests.net_capture.crossing import LIGHT, ONE, OTHER, PAIR, THICKNESS, TOUCHING, Pairs, crossed, put, tangle
from tests.net_capture.memory import shown

pair_mass, spring, stiffening = map(formula, (segments.pair_mass, segments.spring, segments.stiffening))
DURATION = PAIR["self_contact.duration"]


def restitution(ratio):
    """Of a spring and a dashpot that push and never pull."""
    if ratio == 1.0:
        return math.exp(-2.0)
    return math.exp(-2.0 * ratio * math.acos(ratio) / math.sqrt(1.0 - ratio * ratio))


def lasting(ratio):
    """How long they push [s]."""
    if ratio == 1.0:
        return 2.0 * DURATION / math.pi
    return 2.0 * math.acos(ratio) / (math.pi / DURATION * math.sqrt(1.0 - ratio * ratio))


def bounce(ratio, share, phase, shares=(0.5, 0.5)):
    """Speed after a blow of 1 m/s over that before, at the closest points, and for how long there was a force [s]; at a
    share of the bound, the first contact so much of a substep before a grid point."""
    changes = {"self_contact.damping_ratio": ratio, "solver.step_ratio": share}
    step = crossed(1.0, 1.0, shares, **changes)["solver.substep"]
    net = crossed(1.0, THICKNESS + (1.0 - phase) * step, shares, **changes)
    speeds, pushed = shown(net, SHOWN_RATE), 0
    for _ in range(round(2.5 * DURATION / step)):
        net.step(step)
        now = shown(net, SHOWN_RATE)
        pushed += bool((now != speeds).any())
        speeds = now
    s, t = shares
    upper = (1.0 - s) * speeds[ONE[0]] + s * speeds[ONE[1]]
    lower = (1.0 - t) * speeds[OTHER[0]] + t * speeds[OTHER[1]]
    assert net["self_contact.touched"] == 1
    assert net["self_contact.pairs"] == 0
    return (upper - lower)[2], (pushed - 0.5) * step, net


PHASES = (0.1, 0.3, 0.5, 0.7, 0.9)


@pytest.mark.parametrize("ratio", [0.0, 0.2, 0.5, 1.0])
def test_crossed_threads_bounce_as_the_closed_form_says(ratio):
    """Restitution exp(-2 zeta acos(zeta) / sqrt(1 - zeta^2)), force for 2 acos(zeta) / omega_d to a substep; of order
    2, the mean over phases of the substep in which they meet."""
    errors = []
    for share in (0.2, 0.1, 0.05):
        bounces = [bounce(ratio, share, phase) for phase in PHASES]
        found, step = np.array([bounced[:2] for bounced in bounces]), bounces[0][2]["solver.substep"]
        errors.append(math.sqrt(np.mean((found[:, 0] / restitution(ratio) - 1.0) ** 2)))
    assert errors[-1] < 4e-3
    assert 0.5 * math.log2(errors[0] / errors[-1]) == pytest.approx(2.0, abs=0.25)
    assert found[:, 1].mean() == pytest.approx(lasting(ratio), abs=step)
    assert step < 0.04 * lasting(ratio)


def test_threads_that_meet_near_their_ends_give_back_as_much():
    """There both are lighter to each other by 1 / (s^2 + (1 - s)^2), so they part sooner; where they meet stays."""
    speed, lasted, net = bounce(0.0, 0.02, 0.5, (0.1, 0.3))
    light = (0.1**2 + 0.9**2 + 0.3**2 + 0.7**2) / 4.0 * 4.0
    assert speed == pytest.approx(1.0, rel=0.01)
    assert lasted == pytest.approx(DURATION / math.sqrt(light), rel=0.02)
    assert net["self_contact.force_max"] == pytest.approx(
        0.01 * math.pi / DURATION / math.sqrt(light), rel=0.01
    )  # m v omega, of m = 10 g at the middles


def test_a_book_of_two_threads():
    """Half of the energy is that of the common centre of mass; of the other half friction leaves e^2."""
    for ratio in (0.0, 0.5):
        _, _, net = bounce(ratio, 0.05, 0.5)
        lost = 0.5 * 0.01 * (1.0 - restitution(ratio) ** 2)
        assert net["self_contact.loss"] == pytest.approx(lost, rel=3e-3, abs=1e-18)
        assert abs(net["energy.remainder"]) < 2e-3 * 0.01


def test_energy_in_the_spring_is_what_they_have_given():
    """At the deepest of a blow without damping: v / omega deep, and all of it stored."""
    net = crossed(1.0, THICKNESS, **{"self_contact.damping_ratio": 0.0, "solver.step_ratio": 0.02})
    net.step(0.5 * DURATION)
    assert net["self_contact.depth"] == pytest.approx(DURATION / math.pi, rel=3e-3)
    assert net["self_contact.stored"] == pytest.approx(0.5 * 0.01, rel=5e-3)
    assert net["energy.elastic"] == net["self_contact.stored"]


HEAP = {
    "net.side": 8.0,
    "net.mesh": 1.0,
    "net.mass": 0.05,
    "net.youngs_modulus": 7e8,
    "net.fold_side": 2.0,
    "self_contact.thickness": 0.02,
    "self_contact.duration": 4e-3,
    "solver.step_ratio": 0.1,
}
"""144 threads of 20 mm, soft enough for substeps of 0.1 ms."""


@pytest.mark.parametrize("ratio", [0.0, 0.5])
def test_a_tangle_keeps_its_books(ratio):
    """A heap of threads that overlap bursts and is drawn taut, over and over: momenta to 1e-12, and the energy book to
    a share that falls with the substep."""
    left = []
    for share in (1.0, 0.5):
        changes = {"self_contact.damping_ratio": ratio, "solver.step_ratio": share * HEAP["solver.step_ratio"]}
        net = tangle(4, HEAP | changes, speed=0.5, size=0.3)
        start, spin, energy = net.array("momentum").copy(), net.array("angular_momentum").copy(), net["energy.total"]
        size = math.sqrt(2.0 * energy * net["catch.mass"])
        for _ in range(10):
            taken = net["self_contact.loss"]
            net.step(0.02)
            assert np.abs(net.array("momentum") - start).max() < 1e-12 * size
            assert np.abs(net.array("angular_momentum") - spin).max() < 1e-12 * size
            assert net["self_contact.loss"] >= taken
        left.append(abs(net["energy.remainder"]) / energy)
        assert net["self_contact.touched"] > 1000
        assert net["self_contact.margin_least"] > 2.0
        assert net["self_contact.loss"] > 0.5 * energy if ratio else net["self_contact.loss"] == 0.0
    assert left[0] < (0.003 if ratio else 0.01)
    assert left[1] < 0.75 * left[0]


SHEET = {"net.side": 4.0, "net.mesh": 0.5, "net.mass": 0.02, "net.youngs_modulus": 7e8, "net.fold_side": 2.0}
"""Of 81 knots; laid out with 0.3 m from knot to knot its threads are slack."""
THROWN = 1.0


def folded_over(terms, changes):
    """A net whose one half lies over the other, turned a little so that its threads cross those below, and is thrown
    at it from 5 cm above."""
    net = Instance(MODEL, terms, LIGHT | SHEET | changes).initialise()
    row, column = np.divmod(np.arange(81), 9)
    upper = row > 4
    x, y = 0.3 * (column - 4.0), 0.3 * np.where(upper, 8.0 - row, row)
    turn = np.where(upper, 0.2, 0.0)
    places = np.stack([np.cos(turn) * x - np.sin(turn) * y, np.sin(turn) * x + np.cos(turn) * y, 0.05 * upper], axis=1)
    speeds = np.zeros((81, 3))
    speeds[upper, 2] = -THROWN
    put(net, places, speeds)
    return net, upper


def through(net):
    """How many pairs of threads go through one another in 0.15 s, by numpy, and where all nodes are then."""
    pairs, before, count = Pairs(net), shown(net), 0
    for _ in range(150):
        net.step(1e-3)
        now = shown(net)
        count += pairs.passes(before, now)
        before = now
    return count, now


def test_a_net_folded_over_itself_goes_through_itself_only_without_it():
    """Numpy counts every thread of the upper half through those below; with contact none, and the layers part again."""
    net, upper = folded_over(FREE, {})
    count, places = through(net)
    assert count > 40
    assert places[upper, 2].mean() < places[~upper, 2].mean() - 0.05
    net, upper = folded_over(TOUCHING, {"self_contact.thickness": 0.01, "self_contact.duration": 1e-3})
    count, places = through(net)
    assert count == net["self_contact.passed"] == 0
    assert net["self_contact.touched"] > 40
    assert places[upper, 2].mean() > places[~upper, 2].mean()
    assert net["self_contact.depth"] < 0.5 * 0.01


def test_threads_as_thick_as_they_are():
    """Without a thickness they touch at the diameter of a solid round thread, and not beyond."""
    wide = math.sqrt(4.0 * 1.2e-6 / 12.0 / (math.pi * 1440.0))
    for apart, touched in ((1.002 * wide, 0), (0.998 * wide, 1)):
        net = crossed(1e-9, apart, **{"self_contact.thickness": 0.0})
        assert net["self_contact.touched"] == touched


def all_values(terms, values):
    """Every parameter by FMI name, these among them."""
    rows = [v for v in MODEL.interface(terms).variables if v.causality == "parameter"]
    return {name: start for v in rows for name, start in zip(v.element_names(), v.starts(), strict=True)} | values


@pytest.mark.parametrize(
    ("group", "term", "name"),
    [
        ("solver", "rk4", "solver.scheme"),
        ("solver", "xpbd", "solver.scheme"),
        ("precision", "single", "solver.precision"),
        ("substeps", "following", "solver.substeps"),
    ],
)
def test_what_it_does_not_go_with_is_refused(group, term, name):
    terms = TOUCHING | {group: term}
    found = [r for r in refusals(terms, all_values(terms, {"net.damping_ratio": 0.106}), 10.0) if r.name == name]
    assert len(found) == 1
    assert "[capture.self_contact]" in found[0].expected
    with pytest.raises(ValueError, match="touch each other"):
        Composition(MODEL, MODEL.interface(terms).terms)


def test_threads_thicker_than_half_a_piece_are_refused():
    values = all_values(TOUCHING, {"net.segments": 10, "self_contact.thickness": 0.06})
    (found,) = refusals(TOUCHING, values, 10.0)
    assert found.name == "self_contact.thickness"
    assert "0.05 m" in found.expected
    assert not refusals(TOUCHING, values | {"self_contact.thickness": 0.05}, 10.0)
    for group in ("wrap", "break", "table"):
        assert group in MODEL.groups["self_contact"].terms["plain"].excludes


def test_the_substep_follows_the_spring():
    """Twice what it adds at a node bounds the swing of two threads of like nodes, wherever they touch; and `inspect`
    tells the bound that the kernel takes."""
    rng = np.random.default_rng(7)
    told = 2.0 * stiffening(DURATION)
    spring_of = spring(pair_mass(*[100.0] * 4), DURATION)
    most = 0.0
    for s, t in [*rng.random((50, 2)), (0.0, 0.0), (1.0, 1.0)]:
        row = np.array([1.0 - s, s, t - 1.0, -t])
        most = max(most, np.linalg.eigvalsh(100.0 * spring_of * np.outer(row, row))[-1])
    assert most == pytest.approx(told, rel=1e-12)
    values = all_values(TOUCHING, {"self_contact.duration": 2e-4})
    net = Instance(MODEL, TOUCHING, {"self_contact.duration": 2e-4}).initialise()
    bound, step = substeps(values, net.interface.terms)
    assert net["solver.stability_bound"] == pytest.approx(bound, rel=1e-12)
    assert step >= net["solver.substep"] > 0.9 * step
    assert bound < substeps(values, {n: t for n, t in net.interface.terms.items() if n != "self_contact"})[0]


def test_a_crowd_is_told():
    """Where more touches at a node than the substep allows for, the margin falls."""
    net = tangle(4, HEAP | {"self_contact.damping_ratio": 0.0, "solver.step_ratio": 0.95}, speed=0.5, size=0.1)
    net.step(0.02)
    assert net["self_contact.margin_least"] < 1.0


@pytest.mark.parametrize("ratio", [0.0, 0.5, 1.0, 2.0])
def test_up_to_which_speed_threads_hold_each_other(ratio):
    """A hundredth slower they come back, a hundredth faster they go through; and that is counted."""
    most = holding_speed(THICKNESS, DURATION, ratio)
    for share, passed in ((0.99, 0), (1.01, 1)):
        changes = {"self_contact.damping_ratio": ratio, "solver.step_ratio": 0.02}
        net = crossed(share * most, THICKNESS, **changes)
        net.step(2.5 * DURATION)
        assert net["self_contact.passed"] == passed


def test_what_may_go_through_and_what_did_is_warned_of():
    values = all_values(TOUCHING, {"bullets.speed": 10.0})
    terms = MODEL.interface(TOUCHING).terms
    (told,) = cautions.before(values, (), terms)
    wide = math.sqrt(4.0 * 0.33 / 1200.0 / (math.pi * 1440.0))
    most = holding_speed(wide, 5e-4, 0.5)
    assert told.about == "self_contact.duration"
    assert f"{1e3 * wide:.3g} mm hold each other up to {most:.3g} m/s" in told.sentence
    assert f"{5e-4 * most / 10.0:.2g} s would hold" in told.sentence
    for slower in ({"bullets.speed": 0.99 * most}, {"self_contact.thickness": wide * 10.0 / most * 1.01}):
        assert not list(cautions.before(values | slower, (), terms))
    seen = {"self_contact.passed": Range(0.0, 7.0, 0.0, 7.0), "self_contact.margin_least": Range(0.8, 1.5, 1.5, 0.8)}
    told = {caution.about: caution.sentence for caution in cautions.after(values, (), terms, seen.get)}
    assert "7 times" in told["self_contact.passed"]
    assert "1.25 times the bound" in told["self_contact.margin_least"]


def test_a_scene_without_it_has_nothing_of_it():
    assert not any(v.name.startswith("self_contact") for v in MODEL.interface(FREE).variables)
