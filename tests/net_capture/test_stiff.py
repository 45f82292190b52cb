"""Schemes for stiff nets against linear algebra and closed forms; what they keep beyond the leapfrog's bound."""

import json
import math
from itertools import pairwise

import numpy as np
import pytest

from dcone_cosim.loading import load
from dcone_cosim.scene.mistakes import SceneError
from fmu_src.instance import Instance, ModelFault
from fmu_src.net_capture import cautions
from fmu_src.net_capture.interface import MODEL
from fmu_src.net_capture.schemes import MOST_RATIO, ros2, xpbd
from tests.conftest import FREE
from tests.net_capture.evidence import schemes as evidence
from tests.net_capture.taut_net import Reference
from tests.net_capture.taut_pair import PER_MASS, matrix_of, pair, state
from tests.net_capture.test_schemes import begin, with_substeps
from tests.validation import closed_form

ROS2, XPBD = FREE | {"solver": "ros2"}, FREE | {"solver": "xpbd"}
SCENE = """
title = "a net with strong dashpots"
phases = ["capture"]
[capture]
macro_step = "0.1 s"
duration = "1 s"
[capture.net]
shape = "square"
[capture.gravity]
law = "none"
[capture.solver]
scheme = "ros2"
step_ratio = 50
"""
GAMMA = 1.0 - math.sqrt(0.5)


def ros2_factor(z):
    """R(z) = (1 + (1 - 2 gamma) z) / (1 - gamma z)^2 of a matrix."""
    inverse = np.linalg.inv(np.eye(2) - GAMMA * z)
    return (np.eye(2) + (1.0 - 2.0 * GAMMA) * z) @ inverse @ inverse


def euler_factor(z):
    """1 / (1 - z): a single thread's constraint, with compliance and dashpot, is the implicit Euler scheme."""
    return np.linalg.inv(np.eye(2) - z)


TOLD = {"ros2": "(1 + (1 - 2 gamma) z)/(1 - gamma z)^2", "xpbd": "1/(1 - z)"}
FACTORS = {"ros2": ros2_factor, "xpbd": euler_factor}


@pytest.mark.parametrize("scheme", FACTORS)
@pytest.mark.parametrize("ratio", [0.0, 0.5, 10.0, 1000.0])
@pytest.mark.parametrize("times", [0.3, 30.0])
def test_a_taut_thread_follows_the_schemes_own_factor(validated, scheme, ratio, times):
    """One substep of two masses is R(h A), h 0.3 and 30 times the leapfrog's bound."""
    start = np.array([1e-3, 0.05])
    net = pair(scheme, *start, {"net.damping_ratio": ratio, "solver.step_ratio": times})
    h = net["solver.substep"]
    net.step(h)
    expected = FACTORS[scheme](h * matrix_of(ratio)) @ start
    for name, unit, found, exact in zip(("stretch", "its rate"), ("m", "m/s"), state(net), expected, strict=True):
        what = f"{scheme}: a taut thread after a substep of 0.3 and 30 times the leapfrog's bound, {name}"
        validated(closed_form(TOLD[scheme]), what, float(found), float(exact), unit, abs=1e-12 + 1e-6 * abs(exact))
    # the twin: a spring and a dashpot that are off by a thousandth
    off = FACTORS[scheme](1.001 * h * matrix_of(ratio)) @ start
    assert not np.allclose(state(net), off, rtol=1e-6, atol=1e-12)


@pytest.mark.parametrize(("scheme", "error"), [("ros2", 2e-3), ("xpbd", 0.15)])
def test_an_overdamped_thread_stops_its_ends(validated, scheme, error):
    """s = w (exp(-p t) - exp(-q t)) / (q - p) while its tension is positive, p and q 500 times apart: at half as much
    again as the leapfrog's bound, where a quarter of the rate goes in a substep, the largest stretch is followed, as
    far as the order goes."""
    rate, times = 0.05, 1.5
    net = pair(scheme, 1e-9, rate, {"net.damping_ratio": 10.0, "solver.step_ratio": times})
    slow, fast = sorted(-np.linalg.eigvals(matrix_of(10.0)).real)
    assert fast > 500.0 * slow
    end = math.log(fast / slow) / (fast - slow)
    h = net["solver.substep"]
    steps = round(end / h)
    assert steps < 30
    net.step(steps * h)
    expected = rate * (math.exp(-slow * steps * h) - math.exp(-fast * steps * h)) / (fast - slow)
    formula = closed_form("w (exp(-p t) - exp(-q t))/(q - p)")
    what = f"{scheme}: stretch of an overdamped thread at 1.5 times the leapfrog's bound"
    validated(formula, what, float(state(net)[0]), expected, "m", rel=error)
    # all of the energy of the two masses is the dashpot's
    assert net["thread.dissipated"] == pytest.approx(0.5 * rate**2 / PER_MASS, rel=0.05)


@pytest.mark.parametrize("scheme", FACTORS)
def test_momenta_hold(scheme):
    """Of a net that moves and turns. An XPBD impulse lies along its thread as the substep begins, so it has no moment;
    ROS2 keeps the angular momentum to its order."""
    net = begin(with_substeps(FREE | {"solver": scheme}, 40, 0.106), Reference(0.106))
    linear, turning = net.array("momentum").copy(), net.array("angular_momentum").copy()
    assert np.abs(turning).max() > 0.05
    net.step(0.2)
    np.testing.assert_allclose(net.array("momentum"), linear, atol=1e-14)
    np.testing.assert_allclose(net.array("angular_momentum"), turning, atol={"ros2": 1e-8, "xpbd": 1e-14}[scheme])


@pytest.mark.parametrize(("damping", "times"), [(0.0, 50.0), (0.106, 50.0), (10.0, 3000.0)])
def test_ros2_gains_no_energy_beyond_the_bound(damping, times):
    """Of a net that opens at many times the leapfrog's bound; its bullets open it as they do at a small step."""
    values = {"net.mesh": 2.0, "net.damping_ratio": damping}
    net = Instance(MODEL, ROS2, values | {"solver.step_ratio": times}).initialise()
    assert net["solver.substep"] > 0.6 * times * net["solver.stability_bound"]
    energies = [net["energy.total"]]
    for _ in range(24):
        net.step(0.25)
        energies.append(net["energy.total"])
    assert max(b - a for a, b in pairwise(energies)) < 1e-9
    assert net["mouth.area"] == pytest.approx(253.9, rel=5e-3)
    assert np.abs(net.array("momentum")).max() < 1e-11


def test_the_leapfrog_does():
    """The twin, at three times its bound."""
    net = Instance(MODEL, FREE, {"net.mesh": 2.0, "solver.step_ratio": 3.0}).initialise()
    with pytest.raises(ModelFault, match="no longer finite"):
        net.step(3.0)


def test_what_cannot_be_solved_is_said():
    """A net a thousand times as stiff at three thousand times the bound; the leapfrog's bound itself is met."""
    values = {"net.youngs_modulus": 7e13, "solver.step_ratio": 3000.0}
    net = Instance(MODEL, ROS2, values).initialise()
    with pytest.raises(ModelFault, match=r"lower solver.step_ratio \(solver.step_ratio, value 3000, at"):
        net.step(2.0)
    net = Instance(MODEL, ROS2, values | {"solver.step_ratio": 1.0}).initialise()
    net.step(0.02)
    assert net["solver.tries"] >= net["solver.steps"] > 0


def test_the_books_of_small_steps_agree():
    """What the dashpots took, over 4 s at half the leapfrog's bound: ROS2 and XPBD against the leapfrog. At large steps
    XPBD's is no measure of anything, as its page says."""
    taken = {}
    for name, terms in (("leapfrog", FREE), ("ros2", ROS2), ("xpbd", XPBD)):
        net = Instance(MODEL, terms, {"net.mesh": 2.0, "solver.step_ratio": 0.1}).initialise()
        net.step(4.0)
        taken[name] = net["thread.dissipated"]
        assert abs(net["energy.remainder"]) < {"leapfrog": 0.01, "ros2": 0.01, "xpbd": 0.2}[name]
    assert taken["ros2"] == pytest.approx(taken["leapfrog"], rel=0.05)
    assert taken["xpbd"] == pytest.approx(taken["leapfrog"], rel=0.2)


def test_a_step_beyond_the_bound_is_taken_where_there_is_none():
    rows = {s: {v.name: v for v in MODEL.interface(FREE | {"solver": s}).variables} for s in evidence.SCHEMES}
    limits = {scheme: found["solver.step_ratio"].maximum for scheme, found in rows.items()}
    assert limits == {"leapfrog": 1.3, "rk4": 1.3, "ros2": MOST_RATIO, "xpbd": MOST_RATIO}
    # a row in another's place has its value reference
    assert list(rows["xpbd"]) == list(rows["leapfrog"])
    assert "none" in rows["xpbd"]["solver.stability_bound"].description
    assert "none" not in rows["rk4"]["solver.stability_bound"].description


def test_a_scene_may_say_so(tmp_path):
    scene = tmp_path / "stiff.toml"
    scene.write_text(SCENE)
    load(str(scene), [])
    with pytest.raises(SceneError, match=r"at most 1\.3"):
        load(str(scene), ['capture.solver.scheme="leapfrog"'])


def test_xpbd_is_refused_where_dashpots_are_weaker_than_its_own_damping(tmp_path):
    scene = tmp_path / "weak.toml"
    scene.write_text(SCENE.replace('scheme = "ros2"\nstep_ratio = 50', 'scheme = "xpbd"'))
    load(str(scene), ["capture.net.damping_ratio=0.05"])
    with pytest.raises(SceneError, match=r"net\.damping_ratio.*at least 0\.05"):
        load(str(scene), ["capture.net.damping_ratio=0.04"])
    load(str(scene), ["capture.net.damping_ratio=0.04", "capture.solver.step_ratio=0.1"])


def test_what_long_steps_cost_is_said_of_each_scheme():
    def said(scheme, ratio):
        net = Instance(MODEL, FREE | {"solver": scheme}, {"solver.step_ratio": ratio})
        values = {name: net[name] for name in ("net.side", "net.mesh", "net.segments", "net.mass", "net.density",
            "net.youngs_modulus", "net.damping_ratio", "bullets.mass", "solver.step_ratio")}  # fmt: skip
        return " ".join(caution.sentence for caution in cautions.before(values, (), net.interface.terms))

    assert "0.3 % and the energy by more than 1 %" in said("leapfrog", 1.0)
    assert "by more than 1 %" in said("xpbd", 10.0)
    assert "energy" not in said("xpbd", 10.0)
    assert said("xpbd", 1.0) == said("ros2", 1.0) == ""


def test_the_default_step_follows_the_damping():
    """omega h of Table 1's net: from 0.3 without dashpots to 2.5 (ROS2) and 3 (XPBD) at a damping ratio of 0.106."""
    rate = 4.0 * 13368.0 / 5.5e-4
    omega = math.sqrt(2.0 * rate)
    for ratio, expected in ((0.0, (0.3, 0.3)), (0.05, (1.3607, 1.7142)), (0.106, (2.5, 3.0)), (10.0, (2.5, 3.0))):
        damping_rate = 8.0 * ratio * math.sqrt(13368.0 / 5.5e-4)
        found = [omega * scheme.accurate_step(rate, damping_rate) for scheme in (ros2, xpbd)]
        np.testing.assert_allclose(found, expected, rtol=1e-3)


def judge_switching(rows):
    """Where a thread goes taut with a jump of its tension every scheme is of first order; without one, of second, XPBD
    of first."""
    for row in rows:
        order = 1.0 if row["damping_ratio"] > 0.0 or row["scheme"] == "xpbd" else 2.0
        assert row["order"] == pytest.approx(order, abs=0.3), row


def test_the_stored_order_at_switching_is_as_told():
    result = json.loads(evidence.RESULT.read_text())
    assert {row["scheme"] for row in result["switching"]} == set(evidence.SCHEMES)
    judge_switching(result["switching"])


@pytest.mark.parametrize("scheme", FACTORS)
def test_the_order_is_lost_at_switching(scheme):
    """A thin slice of it."""
    counts = (40, 80, 160)
    order = evidence.slope(counts, evidence.bounce_errors(scheme, 0.106, counts, 6))
    assert order == pytest.approx(1.0, abs=0.4)
