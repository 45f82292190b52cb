"""The energy book of all bodies: closes in every combination of terms, and sees what is left out of it."""

import numpy as np
import pytest

from tests.conftest import CAPTURE, CAPTURE_HILL, FREE

FLIGHT = {"net.mesh": 2.0, "closing.time": 11.2}


def entered(net):
    """Energy that has come into the scene: the shot's, and the winches'."""
    work = net["closing.work"] if "closing" in net.interface.terms else 0.0
    return 9.0 + max(work, 0.0)


@pytest.mark.parametrize("terms", [FREE, CAPTURE, CAPTURE_HILL])
@pytest.mark.parametrize("ratio", [0.0, 0.106])
def test_the_remainder_stays_below_one_per_cent(shoot, terms, ratio):
    flight = {name: value for name, value in FLIGHT.items() if name.partition(".")[0] != "closing" or terms is not FREE}
    turning = {} if terms is FREE else {"target.start_rate[1]": 0.05, "target.start_rate[3]": 0.05}
    net = shoot(flight | turning | {"net.damping_ratio": ratio}, terms)
    for _ in range(36):
        net.step(0.5)
        assert abs(net["energy.remainder"]) < 0.01 * entered(net)


def test_the_book_by_hand(shoot):
    """Every entry an output, so that whoever reads them can add them up."""
    net = shoot(FLIGHT | {"target.start_rate[3]": 0.05}, CAPTURE_HILL)

    def now():
        chaser = 0.5 * net["chaser.mass"] * sum(net.array("chaser_velocity") ** 2)
        bodies = net["energy.total"] + net["target.energy"] + chaser + net["energy.potential"]
        return bodies + net["thread.dissipated"] + net["cord.dissipated"] + net["contact.loss"] - net["closing.work"]

    start = now()
    net.step(17.0)
    assert net["energy.remainder"] == pytest.approx(start - now(), abs=1e-12)
    # none of the entries could be missing without its being seen
    for entry in ("thread.dissipated", "cord.dissipated", "contact.loss", "closing.work"):
        assert abs(net[entry]) > 0.02 * 9.0


def test_potential_is_that_of_the_orbital_frame(shoot):
    """Independent: sum of m n^2 (z^2 - 3 x^2)/2 of all bodies, less n times the target's spin about the third axis."""
    net = shoot(FLIGHT | {"target.start_rate[3]": 0.05, "chaser.start_position[1]": 7.0}, CAPTURE_HILL)
    net.step(4.0)
    n = np.sqrt(3.986004418e14 / 7178137.0**3)
    first, _, third = np.diag(inertia(net)) + net["catch.mass"] * outer(net.array("catch_position"))
    second = inertia(net)[1, 1] + net["catch.mass"] * outer(net.array("catch_position"))[1]
    xx, zz = 0.5 * (second + third - first), 0.5 * (first + second - third)
    potential = 0.5 * n * n * (zz - 3.0 * xx)
    for mass, place in ((2000.0, net.array("chaser_position")), (1000.0, net.array("target_position"))):
        potential += 0.5 * mass * n * n * (place[2] ** 2 - 3.0 * place[0] ** 2)
    potential -= n * net["target.spin[3]"]
    assert net["energy.potential"] == pytest.approx(potential, rel=1e-9)


def inertia(net):
    i11, i22, i33, i12, i13, i23 = net.array("catch_inertia")
    return np.array([[i11, i12, i13], [i12, i22, i23], [i13, i23, i33]])


def outer(r):
    """Diagonal of the inertia of a unit mass at r."""
    return np.array([r[1] ** 2 + r[2] ** 2, r[2] ** 2 + r[0] ** 2, r[0] ** 2 + r[1] ** 2])


def test_a_reels_tension_signal_does_the_work_of_what_it_brings_in(shoot):
    """0.3 N at the vertex in flight: the work is booked, and without it the book would not close."""
    net = shoot(FLIGHT, CAPTURE)
    net.step(7.0)
    before = net["tether.paid_out"]
    net["tether.vertex_tension"] = 0.3
    net.step(1.5)
    assert net["tether.work"] == pytest.approx(0.3 * (before - net["tether.paid_out"]), rel=1e-3)
    assert abs(net["energy.remainder"]) < 0.01 * 9.0 < 0.5 * abs(net["tether.work"])


@pytest.mark.parametrize("start", [5.0, 100.0, -50.0, 1e6])
def test_the_same_capture_at_any_start_time(start):
    """All times of the model count from its start: the winches do too."""
    from fmu_src.instance import Instance
    from fmu_src.net_capture.interface import MODEL

    change = {"net.mesh": 2.0, "closing.time": 9.5, "chaser.start_position[2]": -17.0}
    nets = [Instance(MODEL, CAPTURE_HILL, change).initialise(at) for at in (0.0, start)]
    for _ in range(28):
        for net in nets:
            net.step(0.5)
    first, other = nets
    assert first["captured"] == 1
    for name in ("t_capture", "closing.t_start", "contact.first_time", "mouth.t80", "mouth.t_max", "solver.steps"):
        assert other[name] == first[name]
    assert first["closing.t_start"] == pytest.approx(9.5)
    for field in ("bullet_position", "target_spin", "catch_velocity", "chaser_velocity"):
        np.testing.assert_array_equal(first.array(field), other.array(field))
