"""The gravity gradient's torque on the target: Euler's equations by scipy, librations, equilibrium, order and books."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from dcone_cosim.loading import load, shipped
from dcone_cosim.scene.mistakes import SceneError
from fmu_src.instance import Instance
from fmu_src.net_capture.interface import MODEL, refusals
from orbital.kernel import kernel
from tests.conftest import CAPTURE_HILL
from tests.net_capture.memory import Bench
from tests.validation import closed_form, other_code

BODY = {"net": "square", "gravity": "hill", "target": "box"}
NAMED = BODY | {"gravity_gradient": "plain"}
CAUGHT = CAPTURE_HILL | {"gravity_gradient": "plain"}
RATE = math.sqrt(3.986004418e14 / 7178137.0**3)
"""Mean motion at 800 km [rad/s]."""
INERTIA = np.array([1000.0, 3000.0, 2500.0])
TURNED = Rotation.from_euler("xyz", (0.3, -0.5, 0.9))
TUMBLING = np.array([0.02, -0.03, 0.025])


class Turning:
    """A target by the kernels of one substep, without a net: `place` it, `advance` it."""

    def __init__(self, terms=NAMED):
        bench = self.bench = Bench(terms)
        parts, self.p = bench.parts, bench.p
        put, drift, gradient = parts.target.place, parts.target.drift, parts.gradient
        prepare, frame_rate, measure = parts.gravity.start, parts.gravity.rate, parts.target.measure
        pulled = gradient is not None
        begin, kick, carry, tell = gradient[:4] if pulled else [None] * 4

        @kernel
        def place(record):
            p = record[0]
            prepare(p)
            fault = put(p)
            if pulled:
                begin(p)
            measure(p)
            if pulled:
                tell(p)
            return fault

        @kernel
        def advance(record, h, steps):
            p = record[0]
            for _ in range(steps):
                if pulled:
                    kick(p, 0.5 * h)
                drift(p, frame_rate(p), h)
                if pulled:
                    carry(p, frame_rate(p), h)
                    kick(p, 0.5 * h)
            measure(p)
            if pulled:
                tell(p)

        self._place, self._advance = place, advance

    def place(self, attitude=TURNED, rate=TUMBLING, inertia=INERTIA):
        x, y, z, w = attitude.as_quat()
        self.p.target_start_attitude[:] = w, x, y, z
        self.p.target_start_rate[:] = rate
        self.p.target_principal_inertia[:] = inertia
        assert self._place(self.bench.record) == 0
        return self

    def advance(self, time, h):
        self._advance(self.bench.record, h, round(time / h))
        return self

    def attitude(self):
        w, x, y, z = self.p.target_pose
        return Rotation.from_quat([x, y, z, w])

    def energy(self):
        """Jacobi integral of the turning [J]."""
        return self.p.target_energy - RATE * self.p.target_spin[2] + self.p.gravity_gradient_energy


@pytest.fixture(scope="module")
def turning():
    return Turning()


def by_scipy(time, attitude=TURNED, rate=TUMBLING, inertia=INERTIA, factor=3.0):
    """Attitude in the orbital frame and body rate after a time, from Euler's equations in inertial axes, by DOP853."""

    def change(t, y):
        w, v, rate = y[0], y[1:4], y[4:]
        up = Rotation.from_quat([*v, w]).inv().apply([math.cos(RATE * t), math.sin(RATE * t), 0.0])
        torque = factor * RATE * RATE * np.cross(up, inertia * up)
        spun = (torque - np.cross(rate, inertia * rate)) / inertia
        return [-0.5 * v @ rate, *(0.5 * (w * rate + np.cross(v, rate))), *spun]

    x, y, z, w = attitude.as_quat()
    found = solve_ivp(change, (0.0, time), [w, x, y, z, *rate], "DOP853", rtol=1e-13, atol=1e-15).y[:, -1]
    turned = Rotation.from_quat([*found[1:4], found[0]])
    return Rotation.from_euler("z", -RATE * time) * turned, found[4:]


def apart(one, other):
    """Angle between two attitudes [rad]."""
    return (one.inv() * other).magnitude()


def test_the_torque_is_that_of_the_formula(turning, validated):
    """3 mu/r^3 u x I u, with mu and r as they are, and V the work against it."""
    for seed in range(5):
        turned = Rotation.random(random_state=seed)
        p = turning.place(turned).p
        up = turned.inv().apply([1.0, 0.0, 0.0])
        strength = 3.0 * 3.986004418e14 / 7178137.0**3
        torque = turned.apply(strength * np.cross(up, INERTIA * up))
        source, what = closed_form("3 mu/r^3 u x I u"), "target of a net: torque of the gravity gradient"
        validated(source, what, p.gravity_gradient_torque, torque, "N m", abs=1e-14)
        assert p.gravity_gradient_energy == pytest.approx(
            0.5 * strength * (up @ (INERTIA * up) - INERTIA.sum() / 3.0), abs=1e-14
        )
        before = p.gravity_gradient_energy
        nudge = 1e-6
        after = turning.place(Rotation.from_rotvec(nudge * torque / np.linalg.norm(torque)) * turned).p
        assert (before - after.gravity_gradient_energy) / nudge == pytest.approx(np.linalg.norm(torque), rel=1e-4)


def test_a_tumbling_target_turns_as_by_scipy(turning, validated):
    """Euler's equations with the torque in inertial axes; without it, or off by 1 %, the attitude is another."""
    turning.place().advance(600.0, 1e-3)
    attitude, rate = by_scipy(600.0)
    source, what = other_code("scipy's DOP853, Euler's equations in inertial axes"), "target of a net in the gradient"
    validated(source, f"{what}: angle off after 600 s", apart(turning.attitude(), attitude), 0.0, "rad", abs=1e-8)
    validated(source, f"{what}: its rate then", turning.p.target_rate, rate, "rad/s", abs=1e-9)
    for factor in (0.0, 2.97):
        assert apart(by_scipy(600.0, factor=factor)[0], attitude) > 1e-5


@pytest.mark.parametrize(
    ("terms", "factor", "frame"), [(NAMED, 3.0, RATE), (BODY, 0.0, RATE), (BODY | {"gravity": "none"}, 0.0, 0.0)]
)
def test_attitude_and_spin_are_of_second_order(terms, factor, frame):
    """In a frame that turns, with the torque and without, and at rest: the error falls with the square of the
    substep."""
    turning = Turning(terms)
    attitude, rate = by_scipy(400.0, factor=factor)
    attitude = Rotation.from_euler("z", (RATE - frame) * 400.0) * attitude
    steps = (0.8, 0.4, 0.2, 0.1)
    turned, spun = [], []
    for h in steps:
        turning.place().advance(400.0, h)
        turned.append(apart(turning.attitude(), attitude))
        spun.append(np.abs(turning.p.target_rate - rate).max())
    for error in (turned, spun):
        assert np.polyfit(np.log(steps), np.log(error), 1)[0] == pytest.approx(2.0, abs=0.1)


@pytest.mark.parametrize("inertia", [(1000.0, 3000.0, 2500.0), (500.0, 600.0, 900.0)])
def test_it_librates_in_pitch_at_the_frequency_of_the_textbook(turning, validated, inertia):
    """n sqrt(3 (I2 - I1) / I3), axis 1 along the vertical and 3 along the orbit's normal: ten swings of 1e-4 rad."""
    frequency = RATE * math.sqrt(3.0 * (inertia[1] - inertia[0]) / inertia[2])
    still = np.array([0.0, 0.0, RATE])
    turning.place(Rotation.from_euler("z", 1e-4), still, np.array(inertia))
    h = 0.25
    stride = 32 * h
    angles = []
    while len(angles) * stride < 10.0 * 2.0 * math.pi / frequency:
        angles.append(turning.attitude().as_euler("xyz"))
        turning.advance(stride, h)
    angles = np.array(angles)
    assert np.abs(angles[:, :2]).max() < 1e-12
    pitch = angles[:, 2]
    rising = np.flatnonzero((pitch[:-1] < 0.0) & (pitch[1:] >= 0.0))
    crossed = stride * (rising + pitch[rising] / (pitch[rising] - pitch[rising + 1]))
    period = (crossed[-1] - crossed[0]) / (len(crossed) - 1)
    assert len(crossed) >= 9
    source = closed_form("n sqrt(3 (I2 - I1)/I3)")
    validated(source, "target of a net: libration in pitch", 2.0 * math.pi / period, frequency, "rad/s", rel=1e-6)


def test_it_rests_along_the_vertical_and_falls_over_across_it(turning):
    """The axis of least inertia along the vertical, that of the greatest along the normal: so it stays for an orbit.
    With the first two changed over, an offset grows as cosh of n sqrt(3 (I1 - I2) / I3) t."""
    still, orbit = np.array([0.0, 0.0, RATE]), 2.0 * math.pi / RATE
    turning.place(Rotation.identity(), still, np.array([500.0, 600.0, 900.0])).advance(orbit, 0.25)
    assert turning.attitude().magnitude() < 1e-12
    assert np.abs(turning.p.gravity_gradient_torque).max() < 1e-15
    growth = RATE * math.sqrt(3.0 * 100.0 / 900.0)
    turning.place(Rotation.from_euler("z", 1e-5), still, np.array([600.0, 500.0, 900.0])).advance(3000.0, 0.25)
    assert turning.attitude().as_euler("xyz")[2] == pytest.approx(1e-5 * math.cosh(growth * 3000.0), rel=1e-4)
    assert growth * 3000.0 > 1.5


def test_the_energy_of_the_turning_is_kept(turning):
    """Kinetic energy, less n times the spin about the normal, and the gradient's: what it is off by falls with the
    square of the substep or sooner, and is next to nothing beside what goes to and fro."""
    left = []
    for h in (0.2, 0.1, 0.05):
        start = turning.place().energy()
        told, moved = [], []
        for _ in range(200):
            turning.advance(10.0, h)
            told.append(turning.energy() - start)
            moved.append(turning.p.gravity_gradient_energy)
        left.append(np.abs(told).max())
    assert left[0] / left[1] > 3.8
    assert left[1] / left[2] > 3.8
    assert left[2] < 2e-4 * np.ptp(moved)


def test_what_it_gives_is_all_that_the_spin_changes_by(turning):
    """Less the angular impulse the spin stands still in inertial space, to rounding."""
    p = turning.place().p
    start = p.target_spin.copy()
    for n in range(1, 11):
        turning.advance(200.0, 0.01)
        left = Rotation.from_euler("z", n * 200.0 * RATE).apply(p.target_spin - p.gravity_gradient_angular_impulse)
        assert left == pytest.approx(start, rel=1e-9, abs=1e-9 * np.linalg.norm(start))
    assert np.linalg.norm(p.gravity_gradient_angular_impulse) > 1e-3 * np.linalg.norm(start)


def caught(terms=CAUGHT, **parameters):
    given = {"net.mesh": 4.0, "closing.time": 11.2, **{f"target.start_rate[{i + 1}]": TUMBLING[i] for i in range(3)}}
    turned = dict(zip((2, 3, 4, 1), TURNED.as_quat(), strict=True))
    given |= {f"target.start_attitude[{i}]": value for i, value in turned.items()}
    given |= {f"target.principal_inertia[{i + 1}]": INERTIA[i] for i in range(3)}
    given |= {name.replace("__", "."): value for name, value in parameters.items()}
    names = {name for row in MODEL.interface(terms).variables for name in row.element_names()}
    return Instance(MODEL, terms, {name: value for name, value in given.items() if name in names})


def test_a_whole_model_turns_its_target_as_by_scipy():
    """Before the net has come: 8 s in macro steps of any length, and the substep that the net asks for."""
    net = caught().initialise()
    for step in (1.0, 0.3337, 3.0, 3.6663):
        net.step(step)
    assert net["contact.first_time"] < 0.0
    attitude, rate = by_scipy(8.0)
    w, x, y, z = net.array("target_attitude")
    assert apart(Rotation.from_quat([x, y, z, w]), attitude) < 2e-9
    assert net.array("target_rate") == pytest.approx(rate, abs=1e-12)
    assert np.abs(by_scipy(8.0, factor=0.0)[1] - rate).max() > 1e-6


FREE_OF_CONTACT = [
    NAMED | {"solver": "rk4"},
    NAMED | {"solver": "rk4", "substeps": "following"},
    NAMED | {"solver": "ros2"},
    NAMED | {"solver": "ros2", "precision": "single"},
    NAMED | {"solver": "xpbd"},
    NAMED | {"substeps": "following"},
    NAMED | {"precision": "single"},
]
"""Every other way of stepping a net."""


@pytest.mark.parametrize(
    "terms", [CAUGHT, *(pytest.param(terms, marks=pytest.mark.evidence) for terms in FREE_OF_CONTACT)]
)
def test_whatever_steps_the_net_the_target_turns_to_second_order(terms):
    """Its spin is kicked and it turns in double precision beside the scheme, whatever that is: 4 s at 12 deg/s."""
    fast, soft = 5.0 * TUMBLING, {"net.youngs_modulus": 1e6}
    soft |= {f"target.start_rate[{i + 1}]": fast[i] for i in range(3)}
    attitude, rate = by_scipy(4.0, rate=fast)
    bound = caught(terms, **soft).initialise()["solver.stability_bound"]
    steps, turned, spun = [], [], []
    for count in (2, 4, 8):
        net = caught(terms, **soft, **{"solver.step_ratio": 0.01 / count / bound * (1.0 + 1e-6)}).initialise()
        net.step(4.0)
        w, x, y, z = net.array("target_attitude")
        steps.append(4.0 / net["solver.steps"])
        turned.append(apart(Rotation.from_quat([x, y, z, w]), attitude))
        spun.append(np.abs(net.array("target_rate") - rate).max())
    assert steps[0] > 2.5 * steps[2]
    for error in (turned, spun):
        assert np.polyfit(np.log(steps), np.log(error), 1)[0] == pytest.approx(2.0, abs=0.1)


def test_the_book_of_a_capture_closes():
    """A target of a million times the inertia, so that the gradient's energy moves by more than the shot has: the book
    closes within 1 % of shot and winches. Its potential is by hand that of all entries."""
    net = caught(
        **{f"target__principal_inertia[{i + 1}]": 1e6 * INERTIA[i] for i in range(3)}, orbit__altitude=100e3
    ).initialise()
    start = net.array("target_spin").copy(), net["gravity_gradient.energy"], net["energy.potential"]
    rate = math.sqrt(3.986004418e14 / 6478137.0**3)
    for _ in range(36):
        net.step(0.5)
        potential = 0.5 * 1000.0 * rate**2 * (
            net["target.position[3]"] ** 2 - 3.0 * net["target.position[1]"] ** 2
        ) + 0.5 * 2000.0 * rate**2 * (net["chaser.position[3]"] ** 2 - 3.0 * net["chaser.position[1]"] ** 2)
        rest = net["energy.potential"] - potential + rate * net["target.spin[3]"] - net["gravity_gradient.energy"]
        assert abs(rest) < 1e-2  # net and bullets, 2.5 kg
        assert abs(net["energy.remainder"]) < 0.01 * (9.0 + net["closing.work"])
    assert net["contact.first_time"] > 0.0
    assert abs(net["gravity_gradient.energy"] - start[1]) > 9.0
    given = np.linalg.norm(net.array("gravity_gradient_angular_impulse"))
    assert given > 1e3
    turned = Rotation.from_euler("z", 18.0 * rate).apply(
        net.array("target_spin") - net.array("gravity_gradient_angular_impulse")
    )
    assert np.abs(turned - start[0]).max() < 100.0  # what contact gave


@pytest.mark.parametrize("law", ["none", "uniform", "history"])
def test_without_an_orbit_it_is_refused(law):
    terms = {**NAMED, "gravity": law}
    rows = [v for v in MODEL.interface(terms).variables if v.causality == "parameter"]
    values = {n: s for v in rows for n, s in zip(v.element_names(), v.starts(), strict=True)}
    values |= {"chaser.start_position[2]": -20.0}
    (refusal,) = (r for r in refusals(terms, values, 10.0) if "gradient" in r.expected)
    assert (refusal.name, refusal.value) == ("gravity.law", f'"{law}"')
    with pytest.raises(ValueError, match="needs gravity = 'hill'"):
        Bench(terms, {"gravity.history": [[0.0, 0.0, 0.0, 0.0]]} if law == "history" else None)


def test_a_scene_names_it_by_its_table_and_needs_an_orbit(tmp_path):
    text = shipped()["tumbling"].read_text(encoding="utf-8") + "\n[capture.gravity_gradient]\n"
    scene = tmp_path / "gradient.toml"
    scene.write_text(text, encoding="utf-8")
    with pytest.raises(SceneError, match=r"capture\.gravity\.law.*orbit|law.*\[capture\.gravity_gradient\].*orbit"):
        load(str(scene))
    scene.write_text(text.replace('law = "none"', 'law = "hill"'), encoding="utf-8")
    assert load(str(scene)).phases[0].main.terms["gravity_gradient"] == "plain"


def test_a_scene_without_it_has_nothing_of_it():
    assert not any("gradient" in v.name for v in MODEL.interface(BODY).variables)
