"""A net on a low-friction table: a bullet that slides, what lies still, and the book of a net that is thrown open."""

import math

import numpy as np
import pytest

from fmu_src.net_capture.interface import MODEL, refusals
from fmu_src.net_capture.planes import MASS, U, X
from tests.conftest import FREE
from tests.net_capture.memory import graph, nodes, planes
from tests.validation import closed_form

ON_TABLE = FREE | {"table": "plain"}
MU, GRAVITY, SPEED = 0.02, 9.80665, 0.4
SLOWING = MU * GRAVITY
THROWN = {
    "net.side": 8.0,
    "net.mesh": 1.0,
    "bullets.speed": SPEED,
    "bullets.angle": 0.5 * math.pi,
    "table.coefficient": MU,
}


def test_a_bullet_slides_as_far_as_its_energy_lasts(shoot, validated):
    """Before its threads are tight: v - mu g t, at rest after v^2/(2 mu g), where it stays; mu m g s is lost."""
    net = shoot(THROWN, ON_TABLE)
    memory, bullets = planes(net), graph(net).bullets
    start = memory[X : X + 3, bullets].copy()
    mass = float(memory[MASS, bullets].sum())
    assert net["energy.total"] == pytest.approx(0.5 * mass * SPEED**2, rel=1e-9)
    net.step(1.0)
    paces = np.linalg.norm([net.array("bullet_velocity")], axis=2)[0]
    assert paces == pytest.approx(np.full(4, SPEED - SLOWING), rel=1e-9)
    assert net["energy.total"] + net["table.friction_loss"] == pytest.approx(0.5 * mass * SPEED**2, rel=1e-9)
    net.step(2.0)
    ways = np.linalg.norm(memory[X : X + 3, bullets] - start, axis=0)
    law = closed_form("v^2/(2 mu g)")
    validated(law, "a bullet on a table: the way to its stop", ways, SPEED**2 / (2.0 * SLOWING), "m", rel=1e-6)
    lost = closed_form("mu m g s")
    what = "bullets on a table: what friction has taken"
    validated(lost, what, net["table.friction_loss"], SLOWING * mass * float(ways.mean()), "J", rel=1e-5)
    assert net["thread.tension_max"] == 0.0
    rest = memory[X : X + 3, nodes(net)].copy()
    net.step(1.0)
    assert (memory[X : X + 3, nodes(net)] == rest).all()


def test_a_net_that_is_thrown_open_keeps_its_book_and_comes_to_rest(shoot):
    """At 3 m/s it is drawn open, in the plane alone; what it had is in dashpots and friction, and then it lies."""
    net = shoot(THROWN | {"bullets.speed": 3.0, "table.coefficient": 0.1}, ON_TABLE)
    before = net["energy.total"]
    memory, lying = planes(net), nodes(net)
    plane = memory[X + 1, lying].copy()
    still = memory[X : X + 3, lying[len(lying) // 2]].copy()
    net.step(0.3)
    assert (memory[X : X + 3, lying[len(lying) // 2]] == still).all()
    for _ in range(10):
        net.step(0.4)
        assert abs(net["energy.remainder"]) < 2e-3 * before
    assert net["mouth.area_max"] > 0.3 * 64.0
    assert net["thread.tension_max"] > 1.0
    assert memory[X + 1, lying] == pytest.approx(plane, abs=1e-9)
    net.step(10.0)
    assert net["energy.kinetic"] == 0.0
    assert (memory[U : U + 3, lying] == 0.0).all()
    shares = net["table.friction_loss"] / before, net["thread.dissipated"] / before
    assert sum(shares) + net["energy.elastic"] / before == pytest.approx(1.0, abs=2e-3)
    assert min(shares) > 0.02


def test_without_friction_it_is_a_net_without_a_table(shoot):
    """To rounding, which grows: rows that slide do not sleep."""
    free = {name: value for name, value in THROWN.items() if not name.startswith("table.")} | {"bullets.speed": 3.0}
    smooth, none = shoot(free | {"table.coefficient": 0.0}, ON_TABLE), shoot(free, FREE)
    for net in (smooth, none):
        net.step(0.5)
    assert none["thread.tension_max"] > 1.0
    for name in ("energy.kinetic", "mouth.area", "thread.tension_max", "bullet[1].position[1]"):
        assert smooth[name] == pytest.approx(none[name], rel=1e-10)


@pytest.mark.parametrize(
    ("terms", "values", "said"),
    [
        ({}, {"bullets.angle": 0.7}, "bullets.angle"),
        ({"net": "pyramid"}, {}, "net.shape"),
        ({"gravity": "hill"}, {}, "gravity.law"),
        ({"folding": "accordion"}, {}, "folding.pattern"),
        ({}, {"solver.jitter[3]": 1e-6}, "solver.jitter"),
    ],
)
def test_what_does_not_lie_on_a_table_is_refused(terms, values, said):
    chosen = MODEL.interface(ON_TABLE | terms)
    told = {v.name if not v.shape else name: start for v in chosen.variables if v.causality == "parameter"
            for name, start in zip(v.element_names(), v.starts(), strict=True)}  # fmt: skip
    found = refusals(chosen.terms, told | THROWN | values)
    assert any(one.name.startswith(said) and "table" in one.expected for one in found)
