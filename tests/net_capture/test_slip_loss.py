"""What threads and the closing cord lose where they slide over corners, or gain by a step: against the change of their
elastic energy, reckoned by hand."""

import math

import numpy as np
import pytest

from dcone_cosim.loading import load
from fmu_src.instance import Instance
from fmu_src.net_capture import bodies, near
from fmu_src.net_capture.contact.section import INSET
from fmu_src.net_capture.interface import MODEL
from fmu_src.net_capture.planes import U, X
from tests.net_capture.on_target import Kernels
from tests.net_capture.test_union_wrapping import DRAWN_IN, HEAVY, NETTED, TERMS, laid
from tests.net_capture.test_union_wrapping import box as piece
from tests.net_capture.test_wrapping import BOX, SIDES

LENGTH, STIFFNESS, HEAVY_NODE = 0.85, 1000.0, 50.0
TWO = laid(piece((2.0, 1.0, 1.0)), piece((1.0, 1.0, 1.0)))
"""Two bodies, one within the other."""


def kept_words(record, work):
    """States of all threads and stretches of cord among several bodies, and their ways, views [1], [near.FINE m]."""
    numbers, kept = int(record["wrap_numbers"]), near.KEPT + bodies.KEPT
    words = work.view(np.int64)[int(record["work_size"]) - kept * numbers :].reshape(kept, numbers)
    return words[near.STATE], words[near.WAY]


def test_a_thread_that_is_still_taut_as_it_has_slid_off_loses_the_difference():
    """Its nodes go apart as they draw it past the end of an edge: from then on it is taut along the straight way.

    What both nodes have lost of their energy is what the thread holds now and what is told to be lost."""
    places = np.array([(1.6, 3.9, 2.05), (2.05, 3.9, 1.6)])
    drawn = np.array([(-2.0, 1.0, 0.0), (0.0, 1.0, -2.0)])
    scene = Kernels(BOX).place(**SIDES).put([HEAVY_NODE] * 2, places, drawn).join(2, LENGTH, STIFFNESS, 0.0)
    scene.go(1e-4, 1060)
    before, apart = scene.planes[U : U + 3, :2].copy(), math.dist(*scene.planes[X : X + 3, :2].T)
    scene.go(1e-4, 1)
    speeds = 0.5 * (before + scene.planes[U : U + 3, :2])  # of the instant of the places
    kept = 0.5 * STIFFNESS * (apart - LENGTH) ** 2
    lost = 0.5 * HEAVY_NODE * ((drawn**2).sum() - (speeds**2).sum()) - kept
    assert (scene.p["wrap_slipped"], scene.p["wrap_passed"]) == (1, 0)
    assert kept > 0.02 * lost > 0.0
    assert scene.p["wrap_slip_loss"] == pytest.approx(lost, rel=2e-3)


@pytest.fixture(scope="module")
def among():
    return Kernels(TERMS | {"wrap": "plain"}, TWO)


@pytest.mark.parametrize("step", [5e-3, 0.7e-3, -0.6e-3, -0.9e-3])
def test_a_step_of_a_taut_way_is_booked_by_what_the_thread_holds(among, step):
    """A way of 0.2 m round one of two bodies that was to be longer by so much now, or shorter [m]."""
    scene = among.place(**HEAVY)
    corner, places = np.array((1.0 - INSET, 0.5 - INSET, 0.0)), np.array([(0.9, 0.505, 0.0), (1.005, 0.4, 0.0)])
    length = sum(math.dist(place, corner) for place in places) + 1e-4
    scene.put([1e3] * 2, places, [(-0.1, 0.0, 0.0), (0.0, -0.1, 0.0)]).join(2, length, STIFFNESS, 0.0)
    scene.go(1e-4, 500)
    states, ways = kept_words(scene.p, scene.work)
    assert (scene.p["wrap_slip_loss"], states[0]) == (0.0, near.BENT)
    ways[0] += round(step / near.FINE)
    stretch = sum(math.dist(place, corner) for place in scene.planes[X : X + 3, :2].T) - length
    scene.go(1e-4, 1)
    assert (scene.p["wrap_slipped"], scene.p["wrap_passed"], states[0]) == (1, 0, near.BENT)
    told = 0.5 * STIFFNESS * ((stretch + step) ** 2 - stretch**2)
    assert abs(told) > 1e-3
    assert scene.p["wrap_slip_loss"] == pytest.approx(told, rel=1e-6)


@pytest.mark.parametrize("step", [0.05, 2e-3, -2e-3])
def test_a_step_of_the_cord_is_booked_by_what_it_holds(step):
    """Of a stretch that bends round a target as the reels draw it: it was to be longer by so much now, or shorter."""
    terms = load("big-panel-wrapped").phases[0].main.terms  # other tests build an FMU of them
    net = Instance(MODEL, terms, DRAWN_IN, NETTED).initialise()
    net.step(3.0)
    h, first = net["solver.substep"], int(net.record["thread_numbers"][0])
    for _ in range(200):
        net.step(0.01)
        states, ways = kept_words(net.record[0], net.work)
        lengths = net.array("cord_length")[:4].copy()
        taut = (states[first:] == near.BENT) & (near.FINE * ways[first:] > 1.05 * lengths)
        if taut.any():
            break
    (bent, *_) = np.flatnonzero(taut)
    before, way = net["wrap.slip_loss"], near.FINE * ways[first + bent]
    ways[first + bent] += round(step / near.FINE)
    net.step(h)
    stretch, stiff = way - lengths[bent], net["closing.axial_stiffness"] / lengths[bent]
    told = 0.5 * stiff * ((stretch + step) ** 2 - stretch**2)
    assert net["wrap.slip_loss"] - before == pytest.approx(told, rel=1e-3)
