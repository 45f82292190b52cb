"""Drag of the air, against closed forms: a bullet alone, a flat net that falls, threads along their own way."""

import math

import numpy as np
import pytest

from fmu_src.instance import Instance
from fmu_src.net_capture.interface import MODEL
from fmu_src.net_capture.planes import FX, SHOWN, SHOWN_RATE, complete_strips
from orbital.kernel import kernel
from tests.conftest import FREE
from tests.net_capture.laid import Layer
from tests.net_capture.memory import graph, planes
from tests.validation import closed_form

AIR = {**FREE, "gravity": "uniform", "air": "quadratic", "nodes": "169"}
"""Of the scene breadboard-nylon."""
WEIGHTLESS = {f"gravity.acceleration[{i}]": 0.0 for i in (1, 2, 3)}
RHO, SPEED = 1.225, 20.0


def shoot(parameters):
    return Instance(MODEL, AIR, {"net.mesh": 2.0, **parameters}).initialise()


LIGHT = {
    **WEIGHTLESS,
    "net.mass": 1e-7,
    "vertex.mass": 0.0,
    "bullets.angle": 0.0,
    "bullets.speed": SPEED,
    "bullets.mass": 0.5,
    "air.thread_drag": 0.0,
    "air.bullet_diameter": 0.3,
    "air.bullet_drag": 0.47,
}


def test_a_bullet_alone_slows_as_the_closed_form(validated):
    """v0 / (1 + v0 t / L), L = 2 m / (rho C A); one of 1 % more air does not."""
    length = 2.0 * 0.5 / (RHO * 0.47 * math.pi * 0.15**2)
    net = shoot(LIGHT)
    found, wanted = [], []
    for _ in range(4):
        net.step(0.1)
        expected = SPEED / (1.0 + SPEED * net.time / length)
        found.append(net["bullet[1].velocity[2]"])
        wanted.append(expected)
    law = closed_form("v0 / (1 + v0 t / L), L = 2 m / (rho C A)")
    validated(law, "bullet alone in air: speed", found, wanted, "m/s", rel=2e-6)
    assert net["bullet[1].velocity[2]"] < 0.8 * SPEED
    kept = 0.5 * 4 * 0.5 * (SPEED**2 - expected**2)
    assert net["air.dissipated"] == pytest.approx(kept, rel=1e-5)
    thicker = SPEED / (1.0 + 1.01 * SPEED * net.time / length)
    assert net["bullet[1].velocity[2]"] != pytest.approx(thicker, rel=1e-3)


SHEET = {
    "net.fold_side": 23.99,
    "net.density": 1440.0,
    "bullets.mass": 1e-9,
    "bullets.speed": 0.0,
    "vertex.mass": 0.0,
    "air.bullet_drag": 0.0,
    "air.thread_drag": 1.1,
}
"""The net spread out, with nothing on it: every knot has drag for its mass as every other."""


def diameter(net):
    """Of its threads [m], by mass and length."""
    length = 2 * 13 * 24.0
    return math.sqrt(4.0 * net["net.mass"] / (math.pi * 1440.0 * length))


def test_a_spread_net_falls_at_its_terminal_velocity(validated):
    """v = v_t tanh(g t / v_t), v_t2 = pi rho_thread d g / (2 rho C)."""
    net = shoot({**SHEET, "gravity.acceleration[1]": 0.0, "gravity.acceleration[2]": 9.81})
    limit = math.sqrt(math.pi * 1440.0 * diameter(net) * 9.81 / (2.0 * RHO * 1.1))
    found, wanted = [], []
    for until in (0.2, 0.5, 2.5):
        while net.time < until - 1e-9:
            net.step(0.1)
        found.append(net["catch.velocity[2]"])
        wanted.append(limit * math.tanh(9.81 * net.time / limit))
    law = closed_form("v_t tanh(g t / v_t), v_t2 = pi rho_thread d g / 2 rho C")
    validated(law, "spread net that falls in air: speed", found, wanted, "m/s", rel=1e-4)
    assert net["catch.velocity[2]"] == pytest.approx(limit, rel=2e-3)
    assert limit != pytest.approx(math.sqrt(1.01) * net["catch.velocity[2]"], rel=2e-3)


@pytest.mark.parametrize(("axis", "share"), [(2, 1.0), (1, 0.5)])
def test_threads_along_their_own_way_have_no_drag(axis, share):
    """Across its plane all threads of a flat net stand in the stream, within it every second."""
    net = shoot({**SHEET, **WEIGHTLESS, f"chaser.start_velocity[{axis}]": 3.0})
    power = 0.5 * RHO * 1.1 * diameter(net) * 624.0 * share * 3.0**3
    mass, time = net["catch.mass"], 0.01
    net.step(time)
    left = 3.0 / (1.0 + power * time / (mass * 3.0**2))
    assert net["air.dissipated"] == pytest.approx(0.5 * mass * (3.0**2 - left**2), rel=2e-3)


def test_no_air_is_too_thick_for_the_substep():
    """A net shot into something a million times as thick stops, and gains nothing on the way."""
    net = shoot({**WEIGHTLESS, "air.density": 1e6, "bullets.speed": 30.0})
    energy = net["energy.total"]
    for _ in range(20):
        net.step(0.01)
        assert net["energy.total"] <= energy * (1.0 + 1e-9)
        energy = net["energy.total"]
    assert energy < 1e-6 * 0.5 * 2.0 * 30.0**2


def test_the_book_of_a_net_in_air_closes():
    """What the air took of a shot, within half a hundredth; and which way it pushed."""
    net = shoot({"gravity.acceleration[1]": -9.81, "bullets.speed": 10.0})
    start = net.array("momentum").copy()
    for _ in range(20):
        net.step(0.1)
    taken = net["air.dissipated"]
    assert taken > 50.0
    assert abs(net["energy.remainder"]) < 0.005 * taken
    impulse = net.array("momentum") - start - net["catch.mass"] * np.array([-9.81, 0.0, 0.0]) * net.time
    assert impulse[1] < -1.0, "drag against the shot"
    assert impulse[0] > 1.0, "drag against the fall"


def one_by_one(p, memory, drawn, density_of):
    """Drag on every node [N] and its power [W] as shown, thread by thread and bullet by bullet."""
    place, rate = (memory[plane : plane + 3].T for plane in (SHOWN, SHOWN_RATE))
    half, steady = 0.5 * p["air_density"], 0.5 / p["solver_substep"]
    force, power = np.zeros_like(place), 0.0
    for number, ((a, b), length, mass) in enumerate(zip(drawn.ends, drawn.length, drawn.mass, strict=True)):
        across = math.sqrt(4.0 * mass / (math.pi * density_of(number) * length))
        chord = place[b] - place[a]
        chord = chord / max(np.linalg.norm(chord), length)
        for end in (a, b):
            cross = rate[end] - chord * (chord @ rate[end])
            drag = min(half * p["air_thread_drag"] * across * 0.5 * length * np.linalg.norm(cross), steady * 0.5 * mass)
            force[end] -= drag * cross
            power += drag * cross @ rate[end]
    for node in drawn.bullets:
        speed = np.linalg.norm(rate[node])
        drag = half * p["air_bullet_drag"] * 0.25 * math.pi * p["air_bullet_diameter"] ** 2 * speed
        drag = min(drag, steady * p["bullets_mass"])
        force[node] -= drag * rate[node]
        power += drag * speed**2
    return force, power


@pytest.mark.parametrize("thick", [1.0, 1e3])
def test_drag_on_every_node_is_that_of_its_threads(thick):
    """Slack and taut threads in strips along rows and across, longer and shorter than a vector, a rope of
    the net's material and leads of another; in
    thick air most ends are held to half their speed."""
    layer = Layer("rectangle", edge="plain", leads="plain", air="quadratic")
    pull_shown, properties = layer.parts.air.pull_shown, layer.parts.memory.properties

    @kernel
    def pull(record, work):
        complete_strips(record[0], properties(record[0], work))
        pull_shown(record[0], work)

    mesh = {"net.width": 12.0, "net.height": 3.0, "net.mesh": 1.0, "net.mass": 0.4, "net.density": 1440.0}
    rigged = {"edge.diameter": 3e-3, "edge.density": 1440.0, "leads.segments": 7, "leads.density": 970.0}
    laid = layer.lay(mesh | rigged | {"solver.substep": 1e-3, "air.density": thick * RHO})
    p, memory, slots = laid.p, laid.planes, laid.slots
    draw = np.random.default_rng(5)
    memory[SHOWN : SHOWN + 3, slots] *= draw.uniform(0.3, 1.6, (3, len(slots)))
    memory[SHOWN_RATE : SHOWN_RATE + 3, slots] = draw.normal(0.0, 4.0, (3, len(slots)))
    memory[FX : FX + 3] = 0.0
    pull(laid.record, laid.work)
    own = len(laid.graph.ends) - 4 * 7
    force, power = one_by_one(p, memory, laid.graph, lambda n: 1440.0 if n < own else 970.0)
    np.testing.assert_allclose(memory[FX : FX + 3].T, force, rtol=1e-12, atol=1e-13 * np.abs(force).max())
    assert p["air_power"] == pytest.approx(power, rel=1e-12)


def test_what_drag_takes_of_the_momentum():
    net = shoot({**WEIGHTLESS, "bullets.speed": 10.0})
    net.step(0.8)
    drawn, given = graph(net), net.record[0]
    force, power = one_by_one(given, planes(net), drawn, lambda number: net["net.density"])
    assert given["air_power"] == pytest.approx(power, rel=1e-5), "of predicted velocities"
    before = net.array("momentum").copy()
    net.step(net["solver.substep"])
    later, _ = one_by_one(given, planes(net), drawn, lambda number: net["net.density"])
    taken = (net.array("momentum") - before) / net["solver.substep"]
    expected = 0.5 * (force + later).sum(axis=0)
    np.testing.assert_allclose(taken, expected, rtol=1e-3, atol=1e-3 * np.abs(expected).max())
    assert np.abs(expected).max() > 0.1


def test_a_scene_without_air_has_nothing_of_it():
    rows = {v.name for v in MODEL.interface(FREE).variables}
    assert not any("air" in name.split(".")[0].split("_") for name in rows)
