"""One thread between two masses, threads in series, and the kernels uncompiled."""

import math

import numpy as np
import pytest

from fmu_src.net_capture import threads
from fmu_src.net_capture.environment import kick
from fmu_src.net_capture.threads import drift, find_taut, pull, thread_tension
from fmu_src.net_capture.topology import FX, INVERSE_MASS, MASS, NODE_PLANES, P, U, gather

K, XI, L = 13740.0, 0.106, 1.0


def two_masses(m, d, stretch_rate, h, steps, tension=thread_tension):
    """Two masses on one thread along x, by the model's own kernels; returns lengths and tensions."""
    slots = 2
    nodes = np.zeros(NODE_PLANES * slots)
    planes = nodes.reshape(NODE_PLANES, slots)
    planes[0] = (0.0, L)
    planes[U] = planes[P] = (-0.5 * stretch_rate, 0.5 * stretch_rate)
    excess, lanes, peak = np.zeros(1), np.zeros(1), np.zeros(1)
    inverse = planes[INVERSE_MASS] = np.full(slots, 1.0 / m)
    lengths, tensions = [L], [0.0]
    for _ in range(steps):
        peak[:] = 0.0
        x, y, z = planes[0], planes[1], planes[2]
        if find_taut(excess, x[:1], y[:1], z[:1], x[1:], y[1:], z[1:], np.array([L * L])):
            gather(lanes, excess)
            pull(lanes, nodes, slots, 0, 1, peak, L, K, d, h)
        for axis in range(3):
            kick(planes[U + axis], planes[P + axis], planes[FX + axis], inverse, h)
            drift(planes[axis], planes[U + axis], planes[FX + axis], h)
        lengths.append(x[1] - x[0])
        tensions.append(peak[0])
    return np.array(lengths), np.array(tensions)


def test_taut_frequency_is_that_of_the_reduced_mass():
    """A half swing lasts pi / omega with omega = sqrt(k / mu), mu = m / 2."""
    m = 5.5e-4
    omega = math.sqrt(K / (0.5 * m))
    h = 0.01 / omega
    lengths, _ = two_masses(m, 0.0, 0.1, h, 400)
    taut = np.nonzero(lengths > L)[0]
    half_swing = (taut[-1] - taut[0] + 1) * h
    assert half_swing == pytest.approx(math.pi / omega, rel=5e-3)
    assert half_swing != pytest.approx(math.pi / math.sqrt(K / m), rel=5e-3)


def test_logarithmic_decrement_gives_the_dashpot():
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
    assert decrement == pytest.approx(2.0 * math.pi * zeta / math.sqrt(1.0 - zeta * zeta), rel=5e-3)
    assert decrement != pytest.approx(2.0 * math.pi * 0.051 / math.sqrt(1.0 - 0.051**2), rel=5e-3)


def test_slack_thread_pulls_exactly_nothing():
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


@pytest.mark.parametrize("segments", [1, 2, 5])
def test_static_stretch_is_that_of_the_whole_thread(shoot, segments):
    """A side of the net of one mesh pulled by F stretches by F L / EA, whatever the number of segments: in series."""
    net = shoot({"net.side": 2.0, "net.mesh": 1.0, "net.segments": segments, "net.fold_side": 0.1})
    stiffness = float(net.record["thread_stiffness"][0])
    length = float(net.record["thread_length"][0])
    area = 0.33 / (1440.0 * 12.0)
    force = 1.0
    stretch = sum(force / stiffness for _ in range(segments))
    assert length * segments == pytest.approx(1.0, rel=1e-15)
    assert stretch == pytest.approx(force * 1.0 / (70e9 * area), rel=1e-6)
    assert stretch != pytest.approx(force * 1.01 / (70e9 * area), rel=1e-6)
    assert threads.thread_tension(length + force / stiffness, 0.0, length, stiffness, 0.0) == pytest.approx(
        force, rel=1e-6
    )


@pytest.mark.parametrize(("segments", "mesh"), [(1, 2.0), (2, 2.0), (3, 2.0), (2, 8.0)])
def test_cutting_threads_keeps_mass_and_length(shoot, segments, mesh):
    net = shoot({"net.mesh": mesh, "net.segments": segments})
    knots = round(24.0 / mesh) + 1
    assert net["net.threads"] == 2 * segments * knots * (knots - 1)
    assert net["net.nodes"] == knots * knots + 2 * (segments - 1) * knots * (knots - 1)
    assert net["catch.mass"] == pytest.approx(0.33 + 2.0 + 0.15, rel=1e-12)
    slots = int(net.record["node_slots"][0])
    mass = net.work[MASS * slots : (MASS + 1) * slots]
    assert np.count_nonzero(mass) == net["net.nodes"]


def test_cut_net_opens_like_the_whole_one(shoot):
    """Discretisation, not design: the mouth area hardly moves."""
    areas = []
    for segments in (1, 2, 3):
        net = shoot({"net.mesh": 2.0, "net.segments": segments})
        net.step(8.0)
        areas.append(net["mouth.area"])
    assert areas[1:] == pytest.approx([areas[0]] * 2, rel=0.02)
