"""The schemes of one net: each has the order it declares, they agree on the opening, and their books close."""

import numpy as np
import pytest

from dcone_cosim.loading import load
from dcone_cosim.scene.mistakes import SceneError
from fmu_src.instance import Instance
from fmu_src.net_capture.interface import MODEL
from fmu_src.net_capture.planes import SHOWN, P, U, X
from fmu_src.net_capture.schemes import rk4
from tests.conftest import CAPTURE, FREE
from tests.net_capture.memory import nodes, planes
from tests.net_capture.taut_net import PARAMETERS, Reference
from tests.validation import other_code

RK4, ROS2, XPBD = (FREE | {"solver": name} for name in ("rk4", "ros2", "xpbd"))
ORDERS = {
    "leapfrog": (FREE, 2.0, (40, 80, 160)),
    "rk4": (RK4, 4.0, (40, 80, 160)),
    "ros2": (ROS2, 2.0, (40, 80, 160)),
    "xpbd": (XPBD, 1.0, (80, 160, 320)),
}
"""Terms, the order declared, and substeps in a hundredth of a second."""
NEWER = ("ros2", "xpbd")
"""Whose kernels with a tether a run of the tests does not have anyway."""
TIME = 0.004
"""Seconds: the edges are pulled inward, and after a quarter of their swing threads would go slack."""


def with_substeps(terms, count, ratio):
    """An instance of so many substeps in a hundredth of a second."""
    values = PARAMETERS | {"net.damping_ratio": ratio}
    probe = Instance(MODEL, terms, values).initialise()
    share = 0.01 / count / probe["solver.stability_bound"] * (1.0 + 1e-6)
    net = Instance(MODEL, terms, values | {"solver.step_ratio": share}).initialise()
    assert net["solver.substep"] == 0.01 / count
    return net


def begin(net, reference):
    """Put the reference's start into the model: for the leapfrog velocities half a substep back, and its book's."""
    x, v = reference.start()
    leaps = net.interface.terms["solver"] == "leapfrog"
    half = 0.5 * net["solver.substep"] if leaps else 0.0
    kept, slots = planes(net), nodes(net)
    kept[X : X + 3, slots] = x.T
    kept[P : P + 3, slots] = v.T
    kept[U : U + 3, slots] = (v - half * reference.acceleration(x, v)).T
    net.record["thread_loss"] = -half * reference.power(x, v)
    net.step(0.0)
    return net


def slope(counts, errors):
    return -np.polyfit(np.log(counts), np.log(errors), 1)[0]


@pytest.mark.parametrize("ratio", [0.0, 0.106, 0.5])
@pytest.mark.parametrize("scheme", ORDERS)
def test_the_error_falls_with_the_order_declared(validated, scheme, ratio):
    terms, order, counts = ORDERS[scheme]
    reference = Reference(ratio)
    exact, speeds = reference.at(TIME)
    errors, late, remainders = [], [], []
    for count in counts:
        net = begin(with_substeps(terms, count, ratio), reference)
        start = net["energy.remainder"]
        net.step(TIME)
        shown = planes(net)[:, nodes(net)]
        errors.append(np.abs(shown[SHOWN : SHOWN + 3].T - exact).max())
        late.append(np.abs(shown[SHOWN + 3 : SHOWN + 6].T - speeds).max())
        remainders.append(abs(net["energy.remainder"] - start))
    scipy = other_code("the same net in numpy by scipy's DOP853")
    found = slope(counts, errors)
    validated(scipy, f"{scheme}: order of the error, all threads taut", found, order, abs=0.1)
    assert slope(counts, late) == pytest.approx(order, abs=0.1)
    assert slope(counts, remainders) > order - 0.1


def test_a_dashpot_a_hundredth_off_would_be_seen():
    """The twin: what is solved is then not quite what the reference solves, and no step mends it."""
    terms, _, counts = ORDERS["rk4"]
    reference = Reference(0.106)
    exact, _ = reference.at(TIME)
    errors = []
    for count in counts:
        net = begin(with_substeps(terms, count, 0.106 * 1.01), reference)
        net.step(TIME)
        errors.append(np.abs(planes(net)[SHOWN : SHOWN + 3, nodes(net)].T - exact).max())
    assert slope(counts, errors) < 1.0


@pytest.fixture(scope="module")
def opened():
    """Table 1's net after 6 s by every scheme, at its default step."""
    found = {}
    for name, (terms, _, _) in ORDERS.items():
        found[name] = Instance(MODEL, terms).initialise()
        found[name].step(6.0)
    return found


@pytest.mark.parametrize("scheme", ["rk4", "ros2", "xpbd"])
def test_all_open_the_net_alike(opened, scheme):
    leapfrog, other = opened["leapfrog"], opened[scheme]
    assert other["mouth.area"] == pytest.approx(leapfrog["mouth.area"], rel=1e-3)
    assert other["mouth.area"] > 200.0
    assert other["mouth.area"] != leapfrog["mouth.area"]
    np.testing.assert_allclose(other.array("bullet_position"), leapfrog.array("bullet_position"), atol=0.01)
    np.testing.assert_allclose(other.array("catch_position"), leapfrog.array("catch_position"), atol=1e-9)
    # within 1 % of the shot's energy, whoever took it
    assert other["energy.total"] == pytest.approx(leapfrog["energy.total"], abs=0.01 * 9.0)


def test_the_dashpots_take_alike(opened):
    """Of the schemes that follow the threads' swings, each within 1 % of the shot's energy."""
    taken = opened["leapfrog"]["thread.dissipated"]
    assert taken > 1.0
    assert opened["rk4"]["thread.dissipated"] == pytest.approx(taken, abs=0.01 * 9.0)


@pytest.mark.parametrize(
    ("scheme", "turning", "left"),
    [("leapfrog", 1e-11, 0.01), ("rk4", 1e-10, 0.01), ("ros2", 1e-5, 0.15), ("xpbd", 1e-10, 0.15)],
)
def test_the_book_of_each_closes(opened, scheme, turning, left):
    """Central forces keep the angular momentum: the leapfrog and XPBD to rounding, a scheme of several stages to its
    order. The two that step over the threads' swings take from them what the book then leaves over."""
    net = opened[scheme]
    assert abs(net["energy.remainder"]) < left * 9.0
    assert np.abs(net.array("momentum")).max() < 1e-11
    np.testing.assert_allclose(net.array("angular_momentum"), 0.0, atol=turning)


@pytest.mark.parametrize("scheme", ["rk4", "ros2", "xpbd"])
@pytest.mark.parametrize(("other", "terms"), [("contact", CAPTURE), ("closing", CAPTURE)])
def test_others_go_without_impulses(scheme, other, terms):
    """Contact and closing are each refused alone."""
    alone = {name: term for name, term in terms.items() if name not in {"contact", "closing", "settling"} - {other}}
    with pytest.raises(ValueError, match=f"solver = '{scheme}' cannot go together with {other}"):
        MODEL.interface(alone | {"solver": scheme})
    assert MODEL.interface(alone).terms["solver"] == "leapfrog"


def test_a_scene_that_asks_for_both_is_told_so():
    with pytest.raises(SceneError) as caught:
        load("table1-capture", ['capture.solver.scheme="rk4"'])
    told = str(caught.value)
    assert "capture.solver.scheme" in told
    assert "cannot go together with [capture.contact] and [capture.closing]" in told


def test_a_scheme_that_is_none_is_named():
    with pytest.raises(SceneError, match=r"capture\.solver\.scheme") as caught:
        load("table1-capture", ['capture.solver.scheme="rk5"'])
    assert "leapfrog" in str(caught.value)
    assert "rk4" in str(caught.value)


@pytest.mark.parametrize("zeta", [0.0, 0.03, 0.3, 0.9, 1.5, 5.0])
def test_rk4_is_stable_up_to_its_bound(zeta):
    """Of x'' = -w2 x - 2 zeta w x', by the scheme's own growth factor; a few per cent beyond it can be unstable."""
    omega = 440.0
    eigenvalues = np.roots([1.0, 2.0 * zeta * omega, omega * omega])
    step = rk4.longest_step(0.5 * omega * omega, zeta * omega)

    def growth(h):
        z = h * eigenvalues
        return np.abs(1.0 + z + z**2 / 2.0 + z**3 / 6.0 + z**4 / 24.0).max()

    assert growth(step) <= 1.0 + 1e-12
    assert growth(1.13 * step) > 1.0
    assert rk4.accurate_step(0.5 * omega * omega, zeta * omega) < step


@pytest.mark.evidence
@pytest.mark.parametrize("scheme", ["leapfrog", "rk4", *(pytest.param(s, marks=pytest.mark.evidence) for s in NEWER)])
def test_the_tether_pulls_net_and_chaser_alike(scheme):
    """A constant tension does T (s0 - s1), s the distance from vertex to chaser; whatever the scheme's stages, net and
    chaser take the same impulse."""
    values = {"net.mesh": 2.0}
    if scheme in NEWER:
        # at their default steps they take more than 5 mJ of the threads' swings by themselves
        values["solver.step_ratio"] = {"ros2": 0.1, "xpbd": 0.02}[scheme]
    net = Instance(MODEL, FREE | {"solver": scheme, "tether": "slack"}, values).initialise()
    net.step(9.0)
    before, left = net["tether.paid_out"], net["energy.remainder"]
    assert before > 1.0
    net["tether.vertex_tension"] = 0.2
    for _ in range(20):
        net.step(0.1)
    done = 0.2 * (before - net["tether.paid_out"])
    assert abs(done) > 1.0
    assert net["tether.work"] == pytest.approx(done, rel=1e-9)
    assert abs(net["energy.remainder"] - left) < 5e-3
    assert np.abs(net.array("momentum")).max() < 1e-11
