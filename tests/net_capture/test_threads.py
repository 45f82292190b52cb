"""One thread between two masses, threads in series, and the kernels uncompiled."""

import math

import numpy as np
import pytest

from fmu_src.net_capture.planes import (
    DAMPING,
    FX,
    INVERSE_MASS,
    LENGTH,
    MASS,
    NODE_PLANES,
    STIFFNESS,
    STRIP_NUMBERS,
    P,
    U,
    X,
    complete_strips,
)
from fmu_src.net_capture.threads import make_threads, thread_tension
from orbital.kernel import kernel
from tests.conftest import FREE
from tests.net_capture.memory import Bench, graph, nodes, planes
from tests.validation import closed_form

K, XI, L = 13740.0, 0.106, 1.0
SLOTS = 8
A, B = 0, 4
"""Nodes of a strip of up to four lanes."""


@pytest.fixture(scope="module")
def bench():
    return Bench(FREE)


@pytest.fixture(scope="module")
def kernels(bench):
    """Taut lanes and pull of the threads, as the leapfrog scheme has them, and the kick."""
    threads = make_threads(bench.parts, P, U)
    pull_lanes, total = threads.pull, threads.total

    @kernel
    def pull(p, reals, slots, numbers, a, b, taut, earlier):
        return total(pull_lanes(p, reals, slots, numbers, 0, a, b, 0, taut, earlier))

    return threads.taut, pull, bench.parts.gravity.kick_group


class Strip:
    """A strip of four threads between eight nodes of a memory of its own, driven by the model's own kernels."""

    def __init__(self, bench, kernels, m, d, h):
        self.taut_lanes, self.pull_lanes, self.kick = kernels
        self.p, self.h = bench.record.copy()[0], h
        self.p.solver_substep = h
        self.work = np.zeros(NODE_PLANES * SLOTS)
        self.planes = self.work.reshape(NODE_PLANES, SLOTS)
        self.planes[X, B:] = L
        self.planes[INVERSE_MASS] = 1.0 / m
        self.numbers = np.zeros(STRIP_NUMBERS)
        self.numbers[[LENGTH, STIFFNESS, DAMPING]] = L, K, d
        self.p.strips = 1
        complete_strips(self.p, self.numbers)
        self.earlier = 0

    def taut(self, lanes=0b1111):
        """Lanes longer than their rest length."""
        return int(self.taut_lanes(self.work, SLOTS, X, A, B, lanes, L * L))

    def pull(self, taut):
        """Add the forces of these lanes; what their dashpots take."""
        self.p.thread_tension_peak = 0.0
        lanes, earlier = np.uint64(taut), np.uint64(self.earlier)
        return self.pull_lanes(self.p, self.work, SLOTS, self.numbers, A, B, lanes, earlier)

    def step(self):
        """Forces, kick, drift; the largest tension."""
        self.p.thread_tension_peak = 0.0
        taut = self.taut(0b0001)
        if taut:
            self.pull(taut)
        self.earlier = taut
        self.planes[X : X + 3] += self.h * self.planes[U : U + 3]
        for group in (A, B):
            self.kick(self.p, self.work, group, SLOTS, self.h, 0.0)
        return float(self.p.thread_tension_peak)


def two_masses(bench, kernels, m, d, stretch_rate, h, steps):
    """Two masses on one thread along x; returns lengths and tensions."""
    strip = Strip(bench, kernels, m, d, h)
    for plane in (U, P):
        strip.planes[plane, [A, B]] = (-0.5 * stretch_rate, 0.5 * stretch_rate)
    lengths, tensions = [L], [0.0]
    for _ in range(steps):
        tensions.append(strip.step())
        lengths.append(strip.planes[X, B] - strip.planes[X, A])
    return np.array(lengths), np.array(tensions)


def test_taut_frequency_is_that_of_the_reduced_mass(bench, kernels, validated):
    """A half swing lasts pi / omega with omega = sqrt(k / mu), mu = m / 2."""
    m = 5.5e-4
    omega = math.sqrt(K / (0.5 * m))
    h = 0.01 / omega
    lengths, tensions = two_masses(bench, kernels, m, 0.0, 0.1, h, 400)
    taut = np.nonzero(lengths > L)[0]
    half_swing = (taut[-1] - taut[0] + 1) * h
    found, formula = 0.5 / half_swing, closed_form("sqrt(k/mu)/(2 pi)")
    validated(formula, "one thread, two masses: taut frequency", found, omega / math.tau, "Hz", rel=5e-3)
    assert half_swing != pytest.approx(math.pi / math.sqrt(K / m), rel=5e-3)
    assert tensions[1:] == pytest.approx(K * np.maximum(lengths[:-1] - L, 0.0), rel=1e-6)


def test_logarithmic_decrement_gives_the_dashpot(validated):
    """Of a preloaded thread, which never goes slack: offset the rest length and let it ring."""
    m = 5.5e-4
    mu = 0.5 * m
    d = 2.0 * 0.05 * math.sqrt(K * mu)
    omega = math.sqrt(K / mu)
    h = 0.002 / omega
    # relative coordinate under a constant stretching force: the thread stays taut, and rings about the preload
    preload = 1e-3
    s, v = preload + 5e-4, 0.0
    peaks, previous, before = [], s, s
    for _ in range(20000):
        force = K * preload - thread_tension(L + s, v, L, K, d)
        v += h * force / mu
        s += h * v
        if before < previous >= s:
            peaks.append(previous - preload)
        before, previous = previous, s
    decrement = np.mean(np.log(np.array(peaks[:-1]) / np.array(peaks[1:]))[:4])
    zeta = 0.05
    expected = 2.0 * math.pi * zeta / math.sqrt(1.0 - zeta * zeta)
    formula = closed_form("2 pi zeta/sqrt(1 - zeta^2)")
    validated(formula, "one thread, two masses: logarithmic decrement", decrement, expected, rel=5e-3)
    assert decrement != pytest.approx(2.0 * math.pi * 0.051 / math.sqrt(1.0 - 0.051**2), rel=5e-3)


def test_slack_thread_pulls_exactly_nothing(validated):
    slack = [thread_tension(length, 5.0, L, K, 1.0) for length in (0.5, 0.999, L)]
    validated(closed_form("a rope never pushes"), "force of a slack thread", slack, 0.0, "N", abs=0.0)
    for function in (thread_tension, thread_tension.py_func):
        assert function(0.999, 5.0, L, K, 1.0) == 0.0
        assert function(L, 5.0, L, K, 1.0) == 0.0
        assert function(L + 1e-6, -1e3, L, K, 1.0) == 0.0  # shortening fast: a rope never pushes
        assert function(L + 1e-3, 0.0, L, K, 1.0) == pytest.approx(13.74)
        assert function(math.nan, 0.0, L, K, 1.0) == 0.0  # what is not a length does not pull


def test_compiled_and_uncompiled_tension_agree():
    generator = np.random.default_rng(1)
    for length, rate in zip(generator.uniform(0.9, 1.1, 50), generator.normal(size=50), strict=True):
        assert thread_tension(length, rate, L, K, 0.3) == thread_tension.py_func(length, rate, L, K, 0.3)


def test_only_stretched_threads_are_found(bench, kernels):
    """A bit for each; a thread at its rest length, one without a length and one that is none are not among them."""
    strip = Strip(bench, kernels, 1.0, 0.3, 1e-5)
    strip.planes[X, B:] = (1.0 + 1e-12, 1.0, 0.999, 1.5)
    assert strip.taut() == 0b1001
    assert strip.taut(0b0111) == 0b0001
    strip.planes[X, B] = math.nan
    assert strip.taut() == 0b1000


@pytest.mark.parametrize("stretch", [1e-9, 1e-6, 1e-4, 1.9e-3, 2.1e-3, 0.03, 0.2])
def test_threads_pull_as_the_formula_says(bench, kernels, stretch):
    """Along the thread, opposite on its ends, and never pushing; the shortening is summed up to 0.2 % of stretch.

    Lane 2 is slack; lane 3 shortens so fast that its dashpot would push.
    """
    damping = 0.3
    strip = Strip(bench, kernels, 1.0, damping, 1e-5)
    generator = np.random.default_rng(4)
    ways = generator.normal(size=(4, 3))
    ways /= np.linalg.norm(ways, axis=1)[:, None]
    lengths = L * (1.0 + stretch * np.array([1.0, 0.5, -0.5, 0.9]))
    rates = np.array([0.7, -0.4, 1.0, -1e6]) * min(1.0, 1e3 * stretch)
    places, speeds = generator.normal(size=(2, 4, 3))
    for axis in range(3):
        strip.planes[X + axis, :4] = places[:, axis]
        strip.planes[X + axis, 4:] = places[:, axis] + lengths * ways[:, axis]
        for plane in (P + axis, U + axis):
            strip.planes[plane, :4] = speeds[:, axis]
            strip.planes[plane, 4:] = speeds[:, axis] + rates * ways[:, axis]
    assert strip.taut() == 0b1011
    strip.pull(0b1011)
    # the length itself is rounded: 2e-16 of it in the stretch, of which the force is K times as large
    close = {"rel": 1e-11, "abs": K * 2e-15}
    largest = 0.0
    for lane in range(4):
        tension = thread_tension(lengths[lane], rates[lane], L, K, damping)
        largest = max(largest, tension)
        force = strip.planes[FX : FX + 3, lane]
        assert force == pytest.approx(tension * ways[lane], **close)
        assert np.array_equal(strip.planes[FX : FX + 3, lane + 4], -force)
    assert largest > 0.0
    assert not strip.planes[FX : FX + 3, [2, 3]].any()
    assert strip.p.thread_tension_peak == pytest.approx(largest, **close)
    assert strip.p.thread_peak_index == 1


@pytest.mark.parametrize("taut", [0b1111, 0b11111111, 0b000100010001, 0b1_0000_0000_1000, 0b1_1111_0111_1110])
def test_in_a_chain_every_knot_gets_both_its_threads(bench, kernels, taut):
    """A strip along a row: vectors that follow one another, gaps between them, and an end in the midst of one."""
    _, pull, _ = kernels
    count, slots = 13, 16
    generator = np.random.default_rng(taut)
    planes = np.zeros((NODE_PLANES, slots))
    planes[X, : count + 1] = 1.001 * np.arange(count + 1)
    planes[X : X + 3, : count + 1] += generator.normal(size=(3, count + 1)) * 2e-4
    planes[P : P + 3, : count + 1] = generator.normal(size=(3, count + 1)) * 1e-3
    planes[U : U + 3] = planes[P : P + 3]
    numbers = np.zeros(STRIP_NUMBERS)
    damping = 0.3
    numbers[[LENGTH, STIFFNESS, DAMPING]] = L, K, damping
    p = bench.record.copy()[0]
    p.strips, p.thread_tension_peak = 1, 0.0
    complete_strips(p, numbers)
    pull(p, planes.reshape(-1), slots, numbers, 0, 1, np.uint64(taut), np.uint64(taut))
    expected = np.zeros((3, slots))
    for lane in range(count):
        if taut >> lane & 1:
            way = planes[X : X + 3, lane + 1] - planes[X : X + 3, lane]
            length = np.linalg.norm(way)
            rate = (planes[P : P + 3, lane + 1] - planes[P : P + 3, lane]) @ way / length
            force = thread_tension(length, rate, L, K, damping) * way / length
            expected[:, lane] += force
            expected[:, lane + 1] -= force
    np.testing.assert_allclose(planes[FX : FX + 3], expected, rtol=1e-9, atol=K * 4e-15)
    assert np.abs(planes[FX : FX + 3].sum(1)).max() < 1e-13


@pytest.mark.parametrize("segments", [1, 2, 5])
def test_static_stretch_is_that_of_the_whole_thread(shoot, validated, segments):
    """A side of the net of one mesh pulled by F stretches by F L / EA, whatever the number of segments: in series."""
    net = shoot({"net.side": 2.0, "net.mesh": 1.0, "net.segments": segments, "net.fold_side": 0.1})
    threads = graph(net)
    assert np.ptp(threads.stiffness) == np.ptp(threads.length) == 0.0
    stiffness, length = threads.stiffness[0], threads.length[0]
    area = 0.33 / (1440.0 * 12.0)
    force = 1.0
    stretch = sum(force / stiffness for _ in range(segments))
    assert length * segments == pytest.approx(1.0, rel=1e-15)
    expected = force * 1.0 / (70e9 * area)
    formula = closed_form("F L/EA")
    validated(formula, "thread cut into segments: static stretch", stretch, expected, "m", rel=1e-6)
    assert stretch != pytest.approx(force * 1.01 / (70e9 * area), rel=1e-6)
    assert thread_tension(length + force / stiffness, 0.0, length, stiffness, 0.0) == pytest.approx(force, rel=1e-6)


@pytest.mark.parametrize(("segments", "mesh"), [(1, 2.0), (2, 2.0), (3, 2.0), (2, 8.0)])
def test_cutting_threads_keeps_mass_and_length(shoot, segments, mesh):
    net = shoot({"net.mesh": mesh, "net.segments": segments})
    knots = round(24.0 / mesh) + 1
    assert net["net.threads"] == 2 * segments * knots * (knots - 1)
    assert net["net.nodes"] == knots * knots + 2 * (segments - 1) * knots * (knots - 1)
    assert net["catch.mass"] == pytest.approx(0.33 + 2.0 + 0.15, rel=1e-12)
    assert len(nodes(net)) == net["net.nodes"]
    assert planes(net)[MASS].sum() == pytest.approx(0.33 + 2.0 + 0.15, rel=1e-12)
    threads = graph(net)
    assert len(threads.length) == net["net.threads"]
    assert threads.length.sum() == pytest.approx(2.0 * knots * 24.0, rel=1e-12)


def test_cut_net_opens_like_the_whole_one(shoot):
    """Discretisation, not design: the mouth area hardly moves."""
    areas = []
    for segments in (1, 2, 3):
        net = shoot({"net.mesh": 2.0, "net.segments": segments})
        net.step(8.0)
        areas.append(net["mouth.area"])
    assert areas[1:] == pytest.approx([areas[0]] * 2, rel=0.02)
