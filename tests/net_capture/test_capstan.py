"""Friction of threads that bend over edges: what holds, what slides, and what that takes."""

import itertools
import math
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from fmu_src.net_capture.capstan import EXCESS, HELD, PARTS, WITH_FRICTION, make_capstan
from fmu_src.net_capture.contact.section import INSET, MOST
from fmu_src.net_capture.near import FINE
from fmu_src.net_capture.planes import U, X
from tests.net_capture.on_target import Kernels
from tests.plain import plain
from tests.validation import closed_form, other_code

__all__ = ["plain"]

BOX = {"net": "square", "gravity": "none", "target": "box", "contact": "inelastic", "wrap": "friction"}
SIDES = {"target_size": (4.0, 8.0, 4.0), "target_mass": 1e9}
EDGE = np.array([2.0 - INSET, 0.0, 2.0 - INSET])
MASS, SOFT, STIFF, MU, SLACK = 0.5, 2e3, 2e5, 0.3, 1e-3


@pytest.fixture(scope="module")
def kernels():
    return Kernels(BOX)


class Hung:
    """Two nodes on a thread over edges of a box, slack by a millimetre, each to be drawn straight away from its bend.

    bends, places     first and last bend, and the nodes
    between           way between both bends [m]
    """

    def __init__(self, kernels, places, bends, between, stiffness, **values):
        self.places, self.bends = np.array(places, float), np.array(bends, float)
        arms = self.places - self.bends
        self.far = np.linalg.norm(arms, axis=1)
        self.out = arms / self.far[:, None]
        self.unstretched = self.far.sum() + between + SLACK
        self.scene = kernels.place(**SIDES | {"wrap_friction": MU} | values)
        self.scene.put([MASS] * 2, self.places, np.zeros((2, 3))).join(
            2, self.unstretched, stiffness, 100.0 if stiffness == STIFF else 0.0
        )
        self.p, self.planes = self.scene.p, self.scene.planes

    def pulled(self, forces, steps, substep=1e-4):
        """Speed of the first node away from its bend, after each substep [m/s]."""
        _, speeds = self.scene.go(substep, steps, np.array(forces)[:, None] * self.out)
        return speeds @ self.out[0]

    def raised(self, start, end):
        """Slowly from forces to others: a jerk would ring, and slide."""
        for share in 0.5 - 0.5 * np.cos(np.linspace(0.0, math.pi, 101)):
            self.pulled(np.array(start) + share * (np.array(end) - start), 100)


def over_one(kernels, stiffness=STIFF, **values):
    """Over one edge."""
    return Hung(kernels, [(1.4, 0.0, 2.06), (2.06, 0.0, 1.4)], [EDGE] * 2, 0.0, stiffness, **values)


def over_a_panel(kernels):
    """Over two edges, round the rim of a panel of 0.3 m."""
    bends = [(2.0 - INSET, 0.0, 0.15 - INSET), (2.0 - INSET, 0.0, INSET - 0.15)]
    places = [(1.4, 0.0, 0.2), (1.4, 0.0, -0.2)]
    return Hung(kernels, places, bends, 0.3 - 2.0 * INSET, STIFF, target_size=(4.0, 8.0, 0.3))


def turn_of(hung):
    """Angle by which the thread turns from end to end, in the plane of both bends."""
    between = hung.bends[1] - hung.bends[0]
    if not between.any():
        return math.acos(-hung.out[0] @ hung.out[1])
    between = between / np.linalg.norm(between)
    return math.acos(-hung.out[0] @ between) + math.acos(between @ hung.out[1])


@pytest.mark.parametrize("lay", [over_one, over_a_panel], ids=["one edge", "two edges"])
def test_it_holds_up_to_exp_mu_phi_and_slides_beyond(kernels, validated, lay):
    """What slides is two masses on a cord: a = (F - g F') / m (1 + g), g = exp(mu phi)."""
    found, wanted = [], []
    for way in (1, -1):
        hung = lay(kernels)
        grip = math.exp(MU * turn_of(hung))
        hung.raised((0.0, 0.0), (10.0, 10.0))
        slid = float(hung.p["wrap_slide"])
        hung.raised((10.0, 10.0), (9.95 * grip, 10.0)[::way])
        assert hung.p["wrap_slide"] < slid + 3e-5, "but for what a piece between two edges stretches"
        assert np.abs(hung.pulled((9.95 * grip, 10.0)[::way], 2000)).max() < 2e-3
        hung.raised((9.95 * grip, 10.0)[::way], (11.0 * grip, 10.0)[::way])
        speeds = hung.pulled((11.0 * grip, 10.0)[::way], 2000)
        found.append(way * np.polyfit(1e-4 * np.arange(2000), speeds, 1)[0])
        wanted.append(grip / (MASS * (1.0 + grip)))
        assert hung.p["wrap_slide"] > slid + 0.05
    law = closed_form("(F - g F') / m (1 + g), g = exp(mu phi), Euler and Eytelwein")
    validated(law, "two nodes on a thread that slides over edges: acceleration", found, wanted, "m/s2", rel=5e-3)


def test_friction_takes_its_force_times_the_way_that_slid(kernels):
    hung = over_one(kernels)
    grip = math.exp(MU * turn_of(hung))
    hung.raised((0.0, 0.0), (10.0, 10.0))
    hung.raised((10.0, 10.0), (11.0 * grip, 10.0))
    slid, lost = float(hung.p["wrap_slide"]), float(hung.p["wrap_friction_loss"])
    hung.pulled((11.0 * grip, 10.0), 3000)
    tight = 11.0 * grip - grip / (1.0 + grip)
    slack, axial = tight / grip, STIFF * hung.unstretched
    slid, lost = hung.p["wrap_slide"] - slid, hung.p["wrap_friction_loss"] - lost
    assert slid > 0.1
    # as it passes, a piece is as long as halfway between both strains
    assert lost == pytest.approx((tight - slack) * slid * (1.0 + 0.5 * (tight + slack) / axial), rel=2e-3)


def test_without_friction_nothing_is_lost(kernels):
    hung = over_one(kernels, SOFT, wrap_friction=0.0)
    speeds = np.array([(-0.5, 0.0, 0.0), (0.0, 0.0, -0.2)])
    hung.planes[U : U + 3, :2] = speeds.T
    before = 0.5 * MASS * (speeds**2).sum()
    hung.scene.go(2e-5, 10000)
    assert hung.p["wrap_friction_loss"] == pytest.approx(0.0, abs=1e-9 * before)
    assert energy_of(hung) == pytest.approx(before, rel=1e-5)


def lengths_of(hung):
    return np.linalg.norm(hung.planes[X : X + 3, :2].T - EDGE, axis=1)


def energy_of(hung):
    """Of both nodes, and of a thread that lies without friction [J]."""
    stretch = max(0.0, lengths_of(hung).sum() - float(hung.unstretched))
    return 0.5 * MASS * (hung.planes[U : U + 3, :2] ** 2).sum() + 0.5 * SOFT * stretch**2


def by_scipy(places, speeds, forces, unstretched, span, every=2e-5):
    """The same two nodes in the plane, over a fixed edge, by DOP853; between its steps length slides over the edge.

    Places and velocities, what slid [m], and what energy is missing in the end [J].
    """
    edge, axial = EDGE[[0, 2]], SOFT * unstretched
    held = unstretched * np.linalg.norm(places[0] - edge) / np.linalg.norm(places - edge, axis=1).sum()
    slid = 0.0

    def pulls(far, held):
        return axial * np.maximum(0.0, far / np.array([held, unstretched - held]) - 1.0)

    def rates(_, y):
        arms = y[:4].reshape(2, 2) - edge
        far = np.linalg.norm(arms, axis=1)
        return np.concatenate((y[4:], ((forces - (pulls(far, held) / far)[:, None] * arms) / MASS).ravel()))

    y = np.concatenate((places.ravel(), speeds.ravel()))
    for _ in range(round(span / every)):
        y = solve_ivp(rates, (0.0, every), y, method="DOP853", rtol=1e-9, atol=1e-12).y[:, -1]
        arms = y[:4].reshape(2, 2) - edge
        far = np.linalg.norm(arms, axis=1)
        if far.sum() <= unstretched:
            held = unstretched * far[0] / far.sum()
            continue
        grip = math.exp(MU * (math.pi - math.acos(arms[0] @ arms[1] / far.prod())))
        near, other = pulls(far, held)
        for share in (grip, 1.0 / grip):

            def beyond(u, share=share, far=far):
                return (far[0] / u - 1.0) - share * (far[1] / (unstretched - u) - 1.0)

            if (near > share * other) if share > 1.0 else (near < share * other):
                found = brentq(beyond, 1e-3 * unstretched, 0.999 * unstretched, xtol=1e-14)
                slid += abs(found - held)
                held = found
                break
    whole = np.array([held, unstretched - held])
    kept = 0.5 * MASS * (y[4:] ** 2).sum() + (0.5 * axial * np.maximum(0.0, far - whole) ** 2 / whole).sum()
    given = 0.5 * MASS * (speeds**2).sum() + (forces * (y[:4].reshape(2, 2) - places)).sum()
    return y[:4].reshape(2, 2), y[4:].reshape(2, 2), slid, given - kept


def test_as_scipy_has_it(kernels, validated):
    """Nodes that are drawn outwards and thrown: the thread slides, holds, and its ends go on swinging."""
    places, speeds = np.array([(1.4, 2.06), (2.06, 1.4)]), np.array([(-1.5, 0.1), (0.1, 0.6)])
    hung = over_one(kernels, SOFT)
    hung.planes[U : U + 3 : 2, :2] = speeds.T
    forces = 10.0 * hung.out
    hung.scene.go(1e-5, 10000, forces)
    there, then, slid, lost = by_scipy(places, speeds, forces[:, [0, 2]], float(hung.unstretched), 0.1)
    source = other_code("scipy's DOP853, a thread in its plane")
    validated(source, "thread that slides over an edge: nodes", hung.planes[X : X + 3 : 2, :2].T, there, "m", abs=3e-4)
    np.testing.assert_allclose(hung.planes[U : U + 3 : 2, :2].T, then, atol=1e-2)
    validated(source, "thread that slides over an edge: way", float(hung.p["wrap_slide"]), slid, "m", rel=0.01)
    assert float(hung.p["wrap_friction_loss"]) == pytest.approx(lost, rel=0.01)
    assert lost > 0.05


def test_the_book_of_thrown_nodes_closes_with_the_square_of_the_substep(kernels):
    """Threads aslant over an edge, some of them at a corner: their bends wander along it while friction holds them."""
    draw, left, lost = np.random.default_rng(5), [], 0.0
    for number in range(16):
        aside = draw.uniform(-0.3, 0.3, 2) + (3.9 if number % 2 else 0.0)
        deep = draw.uniform(0.1, 0.5, 2)
        places = np.array([(2.02, aside[0], 2.0 - deep[0]), (2.0 - deep[1], aside[1], 2.02)])
        speeds = draw.normal(0.0, 0.7, (2, 3)) - ((0.0, 0.0, 1.0), (1.0, 0.0, 0.0))
        masses = draw.uniform(0.003, 0.02, 2)
        length = deep.sum() + 0.06 + 0.5 * abs(aside[0] - aside[1])
        left.append([])
        for substep in (6e-5, 3e-5, 1.5e-5):
            scene = kernels.place(**SIDES | {"wrap_friction": 0.1})
            scene.put(masses, places, speeds).join(2, length, 13368.0 / length, 0.0).go(substep, round(0.3 / substep))
            p, now = scene.p, scene.planes[U : U + 3, :2].T
            losses = p["wrap_friction_loss"] + p["wrap_slip_loss"] + p["contact_loss"]
            left[-1].append(0.5 * (masses[:, None] * (now**2 - speeds**2)).sum() + losses)
        lost += p["wrap_friction_loss"]
    mean = np.abs(left).mean(axis=0)
    assert lost > 0.01
    print(mean, np.sum(left, axis=0), lost)
    assert abs(np.sum(left, axis=0)[1]) < 0.01 * lost
    assert np.log2(mean[0] / mean[2]) / 2.0 == pytest.approx(2.0, abs=0.3)


def test_nodes_on_a_thread_over_a_tumbling_light_body_keep_both_momenta(kernels):
    hung = over_one(kernels, SOFT, target_mass=3.0, target_start_rate=(0.2, 0.1, 0.4))
    hung.planes[U : U + 3, :2] = np.array([(-1.5, 0.2, 0.1), (0.1, 0.4, 0.6)]).T
    before = momenta(hung)
    hung.scene.go(2e-5, 5000)
    for now, then in zip(momenta(hung), before, strict=True):
        assert now == pytest.approx(then, abs=1e-12 * np.abs(then).max())
    assert hung.p["wrap_friction_loss"] > 0.01
    assert np.linalg.norm(hung.p["target_drift"]) > 0.05


def momenta(hung):
    """Linear and angular momentum of nodes and body [N s], [N m s]."""
    places, speeds = (hung.planes[first : first + 3, :2].T for first in (X, U))
    held = hung.p["target_mass"] * hung.p["target_drift"]
    turning = np.cross(places, MASS * speeds).sum(axis=0) + np.cross(hung.p["target_place"], held)
    return MASS * speeds.sum(axis=0) + held, turning + hung.p["target_spin"]


@pytest.mark.usefixtures("plain")
@pytest.mark.parametrize(
    ("chain", "lengths", "parts"),
    [
        ((5, 1, 3), (0.31, 0.51, 0.2), (0.3, 0.5, 0.2)),
        ((1, 3), (0.9, 0.2), (0.8, 0.2)),
        ((5, 1), (0.31, 0.8), (0.3, 0.7)),
        ((4, 5, 1, 3), (0.1, 0.2, 0.51, 0.2), (0.1, 0.2, 0.5, 0.2)),
        ((5, 1, 3, 0), (0.31, 0.51, 0.05, 0.15), (0.3, 0.5, 0.05, 0.15)),
        ((1, 3, 0), (0.82, 0.06, 0.14), (0.8, 0.06, 0.14)),
        ((4, 5, 1), (0.2, 0.1, 0.8), (0.2, 0.1, 0.7)),
        ((2, 4), (0.3, 0.9), (0.25, 0.75)),
        ((5, 1, 2), (0.4, 0.4, 0.4), (1 / 3, 1 / 3, 1 / 3)),
    ],
)
def test_a_piece_keeps_what_it_holds_as_edges_come_and_go(chain, lengths, parts):
    """By hand, of a thread of 1 m that lay over faces 5, 1, 3 with 0.3, 0.5 and 0.2 m of it on each."""
    words = np.zeros(WITH_FRICTION, np.int64)
    words[HELD], words[PARTS : PARTS + 2] = 3, np.round(np.array((0.3, 0.5)) / FINE)
    planes = {f"wrap_{name}": np.zeros(MOST + 1) for name in ("was", "parts", "pulls", "drags")}
    planes |= {"wrap_spans": np.zeros((MOST, 4)), "wrap_edges": np.zeros((MOST, 3))}
    names = {"wrap_before": np.array(((5, 1), (1, 3))), "wrap_names": np.array(list(itertools.pairwise(chain)))}
    p = SimpleNamespace(
        wrap_numbers=1, **{name: 10 * faces[:, 0] + faces[:, 1] for name, faces in names.items()}, **planes
    )
    p.wrap_pieces = np.array([(0.0, 0.0, 0.0, length) for length in lengths])
    energy = make_capstan().stretch(p, words, 0, len(chain) - 1, sum(lengths), 1.0, 100.0)
    assert p.wrap_parts[: len(parts)] == pytest.approx(np.array(parts), abs=1e-12)
    stretch = np.maximum(0.0, np.array(lengths) - parts)
    assert energy == pytest.approx((50.0 * stretch**2 / parts).sum(), rel=1e-9)
    assert words[EXCESS] == 0
