"""Contact with a free tumbling box: momenta, the impulse itself, surfaces and girth, and capture as a whole."""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fmu_src.instance import ModelFault
from fmu_src.net_capture.interface import OUTCOMES
from fmu_src.net_capture.planes import P, U
from fmu_src.net_capture.shapes.box import box_distance, box_girth
from tests.conftest import CAPTURE, CAPTURE_HILL
from tests.net_capture.memory import planes, shown
from tests.validation import closed_form, other_code

TUMBLE = {"target.start_rate[1]": 0.02, "target.start_rate[3]": 0.03}


def test_box_distance_inside_outside_and_on_an_edge():
    half = np.array([2.0, 4.0, 2.0])
    normal = np.zeros(3)
    for function in (box_distance, box_distance.py_func):
        assert function(normal, np.array([5.0, 0.0, 0.0]), half) == 3.0
        assert normal.tolist() == [1.0, 0.0, 0.0]
        assert function(normal, np.array([0.0, -3.5, 0.0]), half) == -0.5
        assert normal.tolist() == [0.0, -1.0, 0.0]
        assert function(normal, np.array([5.0, 8.0, 0.0]), half) == pytest.approx(5.0)
        assert normal == pytest.approx([0.6, 0.8, 0.0])


def test_girth_is_that_of_the_shorter_edges():
    for function in (box_girth, box_girth.py_func):
        assert function(np.array([4.0, 8.0, 4.0])) == 16.0
        assert function(np.array([8.0, 4.0, 4.0])) == 16.0


def bodies(net):
    chaser = 0.5 * net["chaser.mass"] * sum(net.array("chaser_velocity") ** 2)
    return net["energy.total"] + net["target.energy"] + chaser - net["closing.work"] + net["contact.loss"]


PEAKS = {0: (8.0, 22.0, 80.0, 280.0), 1: (30.0, 200.0, 50.0, 300.0)}
"""By rings: bounds of the largest tension of a thread and of the cord [N], one sample each. Without rings an ensemble
of another code has 12 to 15 N and 125 to 185 N; with them the closed net stops the bullets, and eight seeds had 45 to
125 N and 98 to 173 N."""


@pytest.mark.parametrize("rings", PEAKS)
def test_capture_of_table_1_keeps_momenta_and_loses_energy(shoot, validated, rings):
    own = {"closing.time": 11.2, "closing.speed": 5.0, "closing.stall_force": 10.0 if rings == 0 else 5.0}
    net = shoot(own | {"closing.rings": rings} | TUMBLE, CAPTURE)
    spin = net.array("angular_momentum").copy()
    scale = np.abs(spin).max()
    previous = bodies(net)
    while net.time < 20.0 - 1e-9:
        net.step(0.05)
        assert np.abs(net.array("momentum")).max() < 1e-9 * 4.6
        assert net.array("angular_momentum") == pytest.approx(spin, abs=1e-8 * scale)
        # nothing but winches and dashpots: 1e-5 of the spin energy is the midpoint rule's share
        assert bodies(net) <= previous + 1e-5
        previous = bodies(net)
    assert OUTCOMES[int(net["outcome"])] == "captured"
    trial = other_code("a trial of another code")
    validated(trial, "Table 1: time of the capture", net["t_capture"], unit="s", within=(14.5, 16.0))
    assert net["mouth.cord_length"] < net["mouth.girth"] == 16.0
    # with rings the net is drawn tight, and may hold a winch back before its pair is locked
    assert net["closed"] == 1 or (rings and net["mouth.cord_length"] < 0.25 * net["mouth.girth"])
    assert 9.5 < net["contact.first_time"] < 11.5
    assert 0.0 < net["contact.loss"] < 9.0 + net["closing.work"]
    least_thread, most_thread, least_cord, most_cord = PEAKS[rings]
    assert least_thread < net["thread.tension_max"] < most_thread
    assert least_cord < net["cord.tension_max"] < most_cord
    if rings == 0:
        peaks = other_code("an ensemble of another code; ours is one sample")
        thread, cord = net["thread.tension_max"], net["cord.tension_max"]
        validated(peaks, "Table 1: peak thread tension (theirs: 12 to 15)", thread, unit="N", within=PEAKS[0][:2])
        validated(peaks, "Table 1: peak cord tension (theirs: 125 to 185)", cord, unit="N", within=PEAKS[0][2:])
    # the scheme's own error, of what came in
    assert abs(net["energy.remainder"]) < 0.01 * (9.0 + net["closing.work"])


def test_a_knot_held_by_the_surface_has_no_speed_into_it(shoot):
    """What threads press on the target stands still: a dashpot that saw the half kick its thread gives it, which the
    surface takes back, would pull at a speed that is not there (in version 0.3.0 metres per second, and 2 % of the
    energy)."""
    net = shoot({"closing.time": 11.2} | TUMBLE, CAPTURE)
    net.step(16.5)
    held = 0
    for _ in range(40):
        net.step(net["solver.substep"])
        w, x, y, z = net.array("target_pose")
        turn = Rotation.from_quat([x, y, z, w]).as_matrix()
        arms = shown(net) - net.array("target_place")
        surface = net.array("target_drift") + np.cross(net.array("target_omega"), arms)
        after, predicted = (shown(net, first) - surface for first in (U, P))
        body, half = arms @ turn, 0.5 * net.array("target_size")
        for node in np.flatnonzero((np.abs(body) < half + 1e-6).all(axis=1)):
            faces = np.flatnonzero(np.abs(np.abs(body[node]) - half) < 1e-6)
            if len(faces) == 1 and abs(after[node] @ turn[:, faces[0]]) < 1e-3:
                held += 1
                # the target yields by less to what touches it later in the substep; half a kick of 1 N is 0.05 m/s
                assert abs(predicted[node] @ turn[:, faces[0]]) < 2e-3
    assert held > 100


def test_every_impulse_turns_the_target_at_once(shoot):
    """What is touched next in a substep meets a target that turns as its angular momentum says: I w = L."""
    net = shoot({"closing.time": 11.2} | TUMBLE, CAPTURE)
    net.step(16.0)
    struck = 0
    for _ in range(40):
        before = net.array("target_spin").copy()
        net.step(net["solver.substep"])
        turn, spin = net.array("target_turn"), net.array("target_spin")
        omega = turn @ (turn.T @ spin / net.array("target_inertia"))
        np.testing.assert_allclose(net.array("target_omega"), omega, rtol=0.0, atol=1e-13)
        struck += np.abs(spin - before).max() > 1e-6
    assert struck > 10


def test_a_lost_reaction_would_break_the_momentum(shoot):
    """The twin: had the target not taken the opposite impulse, the balance above would miss by newton seconds."""
    net = shoot({"closing.time": 11.2} | TUMBLE, CAPTURE)
    net.step(13.0)
    taken = np.abs(net.array("target_velocity")).max() * net["target.mass"]
    assert taken > 1e-3 * 4.6


@pytest.mark.parametrize("restitution", [0.3, 1.0])
def test_bounces_give_nothing(shoot, restitution):
    """Nodes that threads hold to the surface bounce on it thousands of times. What all of them take is a sum of
    (1 - e^2) m v_n^2 / 2: it does not fall, and at restitution 1 it is nothing. Thrown back at the instant they reached
    the surface, at a speed of half a substep earlier or later, they were given 0.3 J here, and 6 J of 40 J by a mesh of
    1 m."""
    net = shoot({"net.mesh": 3.0, "contact.restitution": restitution, "closing.time": 11.2} | TUMBLE, CAPTURE)
    before, taken = net.array("angular_momentum").copy(), [0.0]
    while net.time < 17.0 - 1e-9:
        net.step(0.01)
        taken.append(net["contact.loss"])
    entered = 9.0 + net["closing.work"]
    assert net["contact.impulse"] > 1.0
    # 20 m from the target's centre, with 4.6 N s
    assert net.array("angular_momentum") == pytest.approx(before, abs=1e-9 * 92.0)
    # but for what brings nodes back that the tumbling target has run into, at 1 cm/s
    assert np.max(np.maximum.accumulate(taken) - taken) < 1e-5 * entered
    if restitution == 1.0:
        assert np.abs(taken).max() < 1e-6 * entered
    else:
        assert taken[-1] > 0.05 * entered
    assert abs(net["energy.remainder"]) < 0.01 * entered


@pytest.mark.parametrize("restitution", [0.0, 0.5])
def test_a_node_bounces_with_the_restitution_asked_for(shoot, validated, restitution):
    """A straight shot of heavy bullets at a near wall: the loss of energy tells the normal speed that came back."""
    wall = {f"target.size[{i}]": size for i, size in ((1, 60.0), (2, 2.0), (3, 60.0))}
    net = shoot(
        wall
        | {
            "bullets.angle": 0.3,
            "contact.restitution": restitution,
            "chaser.start_position[2]": -6.0,
            "target.mass": 1e12,
            "vertex.mass": 0.0,
        },
        CAPTURE,
    )
    while net["contact.first_time"] < 0.0:
        before = net.array("bullet_velocity").copy()
        net.step(0.001)
    arrived = before[:, 1].max()
    assert 2.7 < arrived < 3.0 * math.cos(0.3)
    assert 5.0 / (3.0 * math.cos(0.3)) < net["contact.first_time"] < 5.0 / arrived
    back, allowed = net.array("bullet_velocity")[:, 1], 0.01 * float(arrived)
    formula = closed_form("-e v_n")
    validated(formula, "bullets that meet a wall: speed after", back, -restitution * before[:, 1], "m/s", abs=allowed)


def test_settled_comes_after_captured(shoot):
    net = shoot({"net.mesh": 2.0, "closing.time": 11.2, "settling.speed": 0.3}, CAPTURE)
    while net.time < 60.0 and not net["settled"]:
        net.step(0.5)
    assert net["settled"] == 1
    assert OUTCOMES[int(net["outcome"])] == "settled"
    assert net.time > net["t_capture"] + 2.0


@pytest.mark.parametrize(
    ("change", "outcome"),
    [
        ({"shot.axis[2]": 1.0, "shot.axis[1]": 1.6, "closing.time": 9.0}, "missed"),
        ({"closing.time": 6.0, "closing.speed": 8.0}, "slipped_off"),
        ({"closing.speed": 0.1, "closing.timeout": 3.0}, "not_closed"),
        ({"tether.length": 15.0}, "tether_taut"),
    ],
)
def test_failed_shots_say_why(shoot, change, outcome):
    net = shoot({"net.mesh": 2.0} | change, CAPTURE)
    while net.time < 25.0 and int(net["outcome"]) == 0:
        net.step(0.5)
    assert OUTCOMES[int(net["outcome"])] == outcome
    assert net["captured"] == 0
    assert net["t_capture"] == -1.0


@pytest.mark.parametrize("trigger", ["first_contact", "distance", "command"])
def test_every_trigger_closes_the_mouth(shoot, trigger):
    kind = ("time", "first_contact", "distance", "command").index(trigger)
    net = shoot({"net.mesh": 2.0, "closing.trigger": kind}, CAPTURE)
    while net.time < 22.0 and not net["captured"]:
        if trigger == "command" and net.time > 11.0:
            net["close.command"] = True
        net.step(0.25)
    assert net["closing.t_start"] > 9.0
    assert net["captured"] == 1


def test_tension_at_the_vertex_goes_to_net_and_chaser(shoot):
    net = shoot({"closing.time": 30.0}, CAPTURE)
    net.step(8.0)
    net["tether.vertex_tension"] = 2.0
    before = net.array("chaser_velocity").copy()
    net.step(1.0)
    assert np.abs(net.array("momentum")).max() < 1e-9
    gained = (net.array("chaser_velocity") - before)[1] * net["chaser.mass"]
    assert gained == pytest.approx(2.0, rel=0.05)


def test_free_bodies_follow_clohessy_wiltshire(shoot, validated):
    """Gravity hill: the joint centre of mass of everything follows the closed form through contact and closing."""
    from orbital.constants import EARTH_EQUATORIAL_RADIUS, EARTH_MU
    from orbital.hill import clohessy_wiltshire

    drift = {"chaser.start_velocity[1]": 0.01, "chaser.start_velocity[2]": 0.02, "chaser.start_velocity[3]": 0.01}
    net = shoot({"closing.time": 11.2} | TUMBLE | drift, CAPTURE_HILL)
    n = math.sqrt(EARTH_MU / (EARTH_EQUATORIAL_RADIUS + 800e3) ** 3)

    def centre():
        masses = np.array([net["catch.mass"], net["target.mass"], net["chaser.mass"]])
        names = ("catch", "target", "chaser")
        at = sum(m * net.array(f"{name}_position") for m, name in zip(masses, names, strict=True))
        speed = sum(m * net.array(f"{name}_velocity") for m, name in zip(masses, names, strict=True))
        return at / masses.sum(), speed / masses.sum()

    position, velocity = centre()
    net.step(18.0)
    assert net["captured"] == 1
    expected_position, expected_velocity = clohessy_wiltshire(position, velocity, n, 18.0)
    reached_position, reached_velocity = centre()
    moved = np.abs(expected_position - position).max()
    formula, allowed = closed_form("Clohessy and Wiltshire"), 1e-4 * float(moved)
    what = "capture with gravity: centre of mass of all bodies"
    validated(formula, what, reached_position, expected_position, "m", abs=allowed)
    allowed = 1e-4 * float(np.abs(expected_velocity).max())
    what = "capture with gravity: its velocity"
    validated(formula, what, reached_velocity, expected_velocity, "m/s", abs=allowed)
    twin, _ = clohessy_wiltshire(position, velocity, 1.01 * n, 18.0)
    assert reached_position != pytest.approx(twin, abs=1e-4 * moved)


def test_gravity_bends_the_shot_by_decimetres(shoot):
    """2 n v = 6e-3 m/s2 at 3 m/s: 0.2 to 0.4 m over 20 m flown."""
    straight, bent = (shoot({"closing.time": 30.0}, terms) for terms in (CAPTURE, CAPTURE_HILL))
    for net in (straight, bent):
        net.step(9.5)
    assert 0.1 < bent["catch.position[1]"] - straight["catch.position[1]"] < 0.4


def test_target_spins_like_a_free_body(shoot, validated):
    """No contact: angular momentum constant, energy of spin constant, a full turn about a principal axis on time."""
    rate = 0.5
    net = shoot({"target.start_rate[2]": rate, "closing.time": 50.0}, CAPTURE)
    net.step(1.0)
    angle = 2.0 * math.atan2(net["target.attitude[3]"], net["target.attitude[1]"])
    validated(closed_form("w t"), "target that spins about an axis: angle", angle, rate * 1.0, "rad", rel=1e-8)
    tumbling = shoot({f"target.start_rate[{i}]": 0.3 * i for i in (1, 2, 3)} | {"closing.time": 50.0}, CAPTURE)
    energy, spin = tumbling["target.energy"], tumbling.array("target_spin").copy()
    tumbling.step(8.0)
    kept = closed_form("Euler's equations without a torque")
    validated(kept, "target that tumbles: energy of spin over 8 s", tumbling["target.energy"], energy, "J", rel=1e-7)
    turned = tumbling.array("target_spin")
    validated(kept, "target that tumbles: angular momentum over 8 s", turned, spin, "N m s", rel=1e-12)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"net.mesh": 0.7}, "whole number"),
        ({"net.fold_side": 30.0}, "fold_side"),
        ({"net.mesh": 0.05}, "too many meshes"),
        ({f"chaser.start_position[{i}]": 0.0 for i in (1, 2, 3)}, "shot.axis"),
        ({"chaser.start_position[2]": -1.0}, "inside the target"),
        ({"target.start_attitude[1]": 2.0}, "quaternion"),
        (
            {
                "target.principal_inertia[1]": 1.0,
                "target.principal_inertia[2]": 1.0,
                "target.principal_inertia[3]": 5.0,
            },
            "triangle",
        ),
    ],
)
def test_impossible_scenes_are_refused(shoot, change, words):
    with pytest.raises(ModelFault, match=words):
        shoot(change, CAPTURE)


@pytest.mark.parametrize(
    "change",
    [
        {"net.youngs_modulus": 70e12, "net.mesh": 4.0},
        {"net.damping_ratio": 5.0, "net.mesh": 3.0},
        {"bullets.speed": 60.0, "net.mesh": 2.0, "closing.time": 0.5},
        {"bullets.mass": 1e-3, "net.mesh": 2.0},
        {"target.mass": 1.0, "net.mesh": 2.0, "target.start_rate[2]": 3.0},
        {"closing.speed": 50.0, "closing.stall_force": 1e4, "closing.axial_stiffness": 1e6, "net.mesh": 2.0},
    ],
)
def test_stiff_and_extreme_cases_stay_finite(shoot, change):
    net = shoot(change, CAPTURE)
    budget = net["energy.total"] + net["target.energy"]
    while net.time < 8.0:
        net.step(0.5)
    assert np.isfinite(planes(net)).all()
    assert net["energy.total"] <= budget + net["closing.work"] * (1.0 + 1e-6) + 1e-6


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"net.youngs_modulus": 1e200}, "below a nanosecond"),
        ({"net.youngs_modulus": 1e300, "net.mass": 1e-300}, "below a nanosecond"),
    ],
)
def test_a_net_too_stiff_to_be_stepped_is_refused(shoot, change, words):
    with pytest.raises(ModelFault, match=words):
        shoot(change, CAPTURE)
