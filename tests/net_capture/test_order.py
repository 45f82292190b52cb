"""The net's own loop is of second order, dashpots and cord included, and so is what its energy book leaves over."""

import numpy as np
import pytest

from fmu_src.net_capture.planes import P, U
from tests.net_capture.memory import planes, shown
from tests.net_capture.taut_net import Reference, begin, with_substeps
from tests.validation import other_code

SCIPY = other_code("the same net in numpy by scipy's DOP853")
COUNTS = (40, 80, 160)
TIME = 0.004
"""Seconds: the edges are pulled inward, and after a quarter of their swing threads would go slack."""


def slope(errors):
    return -np.polyfit(np.log(COUNTS), np.log(errors), 1)[0]


def run(shoot, ratio, flaw=None):
    """Errors of the positions and remainders of the book at the end, for each substep."""
    reference = Reference(ratio)
    exact, _ = reference.at(TIME)
    errors, remainders = [], []
    for count in COUNTS:
        net = begin(with_substeps(shoot, count, ratio), reference)
        start = net["energy.remainder"]
        for _ in range(round(TIME / 0.01 * count)):
            if flaw is not None:
                flaw(net)
            net.step(0.01 / count)
        errors.append(np.abs(shown(net) - exact).max())
        remainders.append(abs(net["energy.remainder"] - start))
    return errors, remainders


@pytest.mark.parametrize("ratio", [0.0, 0.106, 0.5])
def test_the_error_falls_with_the_square_of_the_substep(shoot, ratio):
    errors, remainders = run(shoot, ratio)
    assert slope(errors) == pytest.approx(2.0, abs=0.1)
    assert slope(remainders) == pytest.approx(2.0, abs=0.1)


def test_a_dashpot_half_a_substep_late_is_of_first_order(shoot):
    """The twin: the velocities half a substep back in place of the predicted ones."""

    def late(net):
        nodes = planes(net)
        nodes[P : P + 3] = nodes[U : U + 3]

    errors, _ = run(shoot, 0.106, late)
    assert slope(errors) == pytest.approx(1.0, abs=0.2)


def test_what_the_dashpots_take_is_what_the_net_loses(shoot, validated):
    """Against the independent integration: its energy at the end is the start's less `thread.dissipated`."""
    reference = Reference(0.106)
    lost = reference.energy(*reference.start()) - reference.energy(*reference.at(TIME))
    net = begin(with_substeps(shoot, 640, 0.106), reference)
    net.step(TIME)
    assert lost > 1e-4
    validated(SCIPY, "net with all threads taut: what the dashpots take", net["thread.dissipated"], lost, "J", rel=2e-3)
    left = reference.energy(*reference.at(TIME))
    validated(SCIPY, "net with all threads taut: energy left", net["energy.total"], left, "J", rel=1e-5)
