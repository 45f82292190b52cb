"""The list of near pairs against all pairs, by numpy: nothing that touches is missed, and every pass is counted."""

import numpy as np

from fmu_src.instance import Instance
from fmu_src.net_capture.interface import MODEL
from tests.net_capture.crossing import LIGHT, TOUCHING, Pairs, tangle
from tests.net_capture.memory import shown
from tests.net_capture.test_self_contact import HEAP

THICK = HEAP["self_contact.thickness"]


def test_no_pair_that_touches_is_missed():
    """As a heap tumbles, thread by thread through one another: as many overlap as numpy finds among all pairs."""
    net = tangle(5, HEAP | {"net.side": 6.0})
    pairs, most, lists = Pairs(net), 0, net["self_contact.lists"]
    for _ in range(60):
        net.step(37.0 * net["solver.substep"])
        overlapping = int(np.count_nonzero(pairs.gaps(shown(net)) < THICK))
        assert net["self_contact.pairs"] + net["self_contact.left_out"] == overlapping
        most = max(most, overlapping)
    assert most > 50
    assert net["self_contact.lists"] - lists > 20


def test_every_pass_is_counted():
    """Threads that hardly push go through one another, in every substep as often as numpy finds at the roots of all
    pairs' volumes."""
    net = tangle(6, HEAP | {"net.side": 4.0, "self_contact.duration": 100.0, "self_contact.thickness": 1e-4})
    pairs, before, found = Pairs(net), shown(net), 0
    assert net["self_contact.passed"] == 0
    for _ in range(500):
        net.step(net["solver.substep"])
        now = shown(net)
        assert net["self_contact.passed"] == found  # up to the last substep
        found += pairs.passes(before, now)
        before = now
    assert found > 50


def test_what_overlaps_in_the_canister_is_left_out_until_it_parts():
    """Laid in a small square the threads overlap as numpy finds; as it opens they part, and none is flung off."""
    stowed = HEAP | LIGHT | {"bullets.mass": 0.05, "bullets.speed": 3.0}
    net = Instance(MODEL, TOUCHING, stowed | {"net.fold_side": 0.1}).initialise()
    pairs = Pairs(net)
    overlapping = int(np.count_nonzero(pairs.gaps(shown(net)) < THICK))
    assert net["self_contact.at_start"] == net["self_contact.left_out"] == overlapping > 100
    left = overlapping
    energy = net["energy.total"]
    for _ in range(20):
        net.step(0.15)
        assert net["self_contact.left_out"] <= left
        left = net["self_contact.left_out"]
        assert net["energy.total"] < energy * (1.0 + 1e-9)
    assert left < 0.2 * overlapping
