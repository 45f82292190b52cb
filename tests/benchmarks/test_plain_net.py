"""The yardstick computes what the model computes: start, nodes up to the onset of chaos, momentum, and the mouth."""

import numpy as np
import pytest

from fmu_src.instance import Instance
from fmu_src.net_capture.interface import MODEL
from tests.benchmarks.plain_net import DEFAULTS, PlainNet
from tests.conftest import FREE
from tests.validation import other_code

PLAIN_C = other_code("the net in plain C, tests/benchmarks/plain_net.c")
NODES = FREE | {"nodes": "625"}
FIRST_PULLS = 0.4
"""[s] By then the corners of Table 1's net have been pulled at; a second later no two computations agree."""


def both(shoot, change=None, **wrong):
    """The model's net and the plain one, whose parameters may be wrong."""
    net = shoot(change, terms=NODES)
    return net, PlainNet({**(change or {}), **wrong}, net["solver.substep"])


def apart(net, plain):
    """Largest distance between the nodes of both along an axis [m]; the shot is along the second orbital axis."""
    x, y, z = plain.position
    nodes = net.array("node_position")[: plain.knots**2].reshape(plain.knots, plain.knots, 3)
    return np.abs(nodes - np.stack([x, z - 20.0, -y], axis=-1)).max()


@pytest.mark.parametrize("side", [24.0, 15.0])
def test_nodes_until_chaos(shoot, validated, side):
    """With 15 meshes a side four knots share the vertex."""
    net, plain = both(shoot, {"net.side": side})
    assert apart(net, plain) < 1e-14
    net.step(FIRST_PULLS)
    plain.step(FIRST_PULLS)
    assert net["thread.tension_max"] > 1.0
    peak = net["thread.tension_max"]
    validated(PLAIN_C, "Table 1: peak thread tension of the first 0.4 s", peak, plain.peak.max(), "N", rel=1e-7)
    validated(PLAIN_C, "Table 1: nodes after 0.4 s, largest distance", apart(net, plain), 0.0, "m", abs=2e-9)


TAUT_SOON = {"net.side": 2.0, "net.mass": 0.0025, "net.fold_side": 1.9}
"""Nine knots, of which the middle one is pulled at soon too."""


@pytest.mark.parametrize("wrong", ["net.damping_ratio", "net.youngs_modulus", "vertex.mass"])
def test_a_parameter_one_per_cent_off_would_be_noticed(shoot, wrong):
    right, plain = both(shoot, TAUT_SOON)
    _, off = both(shoot, TAUT_SOON, **{wrong: 1.01 * DEFAULTS[wrong]})
    for one in (right, plain, off):
        one.step(0.1)
    assert apart(right, plain) < 2e-9
    assert apart(right, off) > 1e-7


def test_dashpots_half_a_substep_late_would_be_noticed(shoot):
    """They see the velocity half a substep back: a scheme of first order."""
    net, late = both(shoot, TAUT_SOON)
    for _ in range(round(0.1 / late.substep)):
        late.fly(1)
        late.predicted[...] = late.velocity
    net.step(0.1)
    assert apart(net, late) > 1e-7


def test_momentum_is_constant(shoot, validated):
    net, plain = both(shoot)
    start = plain.momentum()
    plain.step(8.0)
    net.step(8.0)
    assert plain.momentum() == pytest.approx(start, abs=1e-12 * start[2])
    found, expected = net["catch.mass"] * net["catch.velocity[2]"], plain.momentum()[2]
    validated(PLAIN_C, "Table 1: momentum of the net after 8 s", found, expected, "N s", rel=1e-12)


def openings(make, seeds=6):
    """Mean and standard error of the mouth area every half second up to 8 s, over jittered starts."""
    curves = []
    for seed in range(1, seeds + 1):
        net, area = make(seed)
        curve = []
        for _ in range(16):
            net.step(0.5)
            curve.append(area(net))
        curves.append(curve)
    return np.mean(curves, axis=0), np.std(curves, axis=0, ddof=1) / np.sqrt(seeds)


def jittered(parameters, substep):
    def make(seed):
        plain = PlainNet(parameters, substep)
        plain.position += np.random.default_rng(seed).uniform(-1e-6, 1e-6, plain.position.shape)
        return plain, PlainNet.mouth_area

    return make


def test_the_mouth_opens_alike(validated):
    """Within what the chaos of six and six starts leaves open; a shot that is half a per cent fast is outside it."""

    def model(seed):
        change = {f"solver.jitter[{i}]": 1e-6 for i in (1, 2, 3)} | {"solver.seed": seed}
        return Instance(MODEL, NODES, change).initialise(), lambda net: net["mouth.area"]

    substep = model(0)[0]["solver.substep"]
    mean, error = openings(model)
    same, its_error = openings(jittered({}, substep))
    faster, _ = openings(jittered({"bullets.speed": 3.015}, substep))
    allowed = 1e-6 + 5.0 * np.hypot(error, its_error)
    what = "Table 1: mouth area every 0.5 s to 8 s, six starts of each (tolerance: five standard errors)"
    validated(PLAIN_C, what, mean, same, "m2", abs=allowed)
    assert (np.abs(faster - mean) > allowed).all()
