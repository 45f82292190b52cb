"""Faults put on purpose into parts that came later: a conducting line, a table with friction, a line of nodes, contact
by a spring, bent threads, the hull."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pytest

from dcone_cosim import build
from dcone_cosim.criteria import Evidence
from dcone_cosim.phases.capture_criteria import criteria as of_capture
from dcone_cosim.phases.capture_criteria import shot_momentum
from dcone_cosim.phases.removal_criteria import criteria as of_removal
from fmu_src.tethered_deorbit.interface import MODEL
from tests.conftest import FREE
from tests.plain import PlainInstance, plain
from tests.stability import COARSE_NET
from tests.tethered_deorbit import low

__all__ = ["plain"]
CONDUCTING = {"reel": "locked", "electrodynamic": "dipole"}
LINE = {
    "start.condition": 3, "start.relative_position[1]": 4990.0, "tether.rest_length": 5000.0,
    "orbit.epoch": low.EPOCH, "orbit.altitude": 500e3, "orbit.inclination": 0.9, "tether.youngs_modulus": 1e9,
    "electrodynamic.resistance": 150.0,
}  # fmt: skip


def towed(terms: Mapping[str, str], values: Mapping[str, float], step: float, count: int = 10) -> Evidence:
    i = PlainInstance(MODEL, terms, values)
    outputs = [n for n, _, v, _ in i.interface.scalars() if v.causality == "output"]
    settable = [n for n, _, v, _ in i.interface.scalars() if v.causality in ("parameter", "input")]
    rows = []
    for _ in range(count + 1):
        rows.append([i.time, *(i[name] for name in outputs)])
        i.step(step)
    columns = dict(zip(("time", *outputs), np.array(rows, dtype=float).T, strict=True))
    known = {"environment": "central", "target": "point", "chaser": "point", **terms}
    return Evidence(columns, {name: float(i[name]) for name in settable}, known, count * step)


def conducted(**values: float) -> Evidence:
    """Twenty minutes of a line that conducts, soft so that its steps are long."""
    return towed(CONDUCTING, LINE | {name.replace("__", "."): value for name, value in values.items()}, 120.0)


def red(criteria: Callable[[Evidence], Any], evidence: Evidence, of: set[str]) -> set[str]:
    """Of these criteria those that are broken; all of them were looked at."""
    found = {one.key: one for one in criteria(evidence) if one.key in of}
    assert found.keys() == of
    return {key for key, one in found.items() if not one.value <= one.stable}


@pytest.mark.usefixtures("plain")
def test_a_current_that_flows_the_wrong_way_is_red() -> None:
    """It would drive the pair on: a resistance below zero, which no scene can have. So is a work a fifth too large."""
    asked = {"generates", "orbit_taken"}
    sound = conducted()
    assert float(np.abs(sound.columns["electrodynamic.orbit_power"]).min()) > 1.0
    assert red(of_removal, sound, asked) == set()
    assert red(of_removal, conducted(electrodynamic__resistance=-150.0), asked) == {"generates"}
    columns = dict(sound.columns)
    columns["electrodynamic.orbit_power"] = 1.2 * columns["electrodynamic.orbit_power"]
    assert red(of_removal, Evidence(columns, sound.values, sound.terms, 1200.0), asked) == {"orbit_taken"}


SLED = {
    "chaser.mass": 30.0, "target.mass": 12.0, "start.condition": 3, "start.relative_position[2]": 1.99,
    "start.relative_velocity[2]": 1.0, "tether.rest_length": 2.0, "tether.youngs_modulus": 5e8,
    "tether.diameter": 5e-4, "tether.damping_ratio": 0.0, "friction.coefficient": 0.05, "thrust.level": -30.0,
}  # fmt: skip
TABLE = {"reel": "locked", "environment": "none", "friction": "coulomb", "thrust": "along_track"}


def instead(sound: Evidence, **changed: Any) -> Evidence:
    """With other columns, or values of these names."""
    given = {name.replace("__", "."): value for name, value in changed.items()}
    columns = {name: given.get(name, column) for name, column in sound.columns.items()}
    values = {name: given.get(name, value) for name, value in sound.values.items()}
    return Evidence(columns, values, sound.terms, 1.0, sound.tugs)


@pytest.mark.usefixtures("plain")
def test_sleds_have_what_thrust_gave_and_friction_left() -> None:
    """On a table, where nothing damps: from both sides, through a snap."""
    asked = {"work", "work_lost", "friction_takes"}
    sound = towed(TABLE, SLED, 0.05)
    assert sound.columns["tether.tug_count"][-1] >= 1
    loss = sound.columns["friction.loss"]
    assert loss[-1] > 1.0
    assert red(of_removal, sound, asked) == set()
    assert red(of_removal, instead(sound, friction__loss=1.1 * loss), asked) == {"work"}
    assert red(of_removal, instead(sound, friction__loss=0.9 * loss), asked) == {"work_lost"}
    assert red(of_removal, instead(sound, friction__loss=-loss), asked) == {"work_lost", "friction_takes"}
    assert red(of_removal, instead(sound, thrust__level=-20.0), asked) == {"work"}
    assert red(of_removal, instead(sound, thrust__level=-40.0), asked) == {"work_lost"}
    damped = instead(sound, tether__damping_ratio=0.05, friction__loss=0.9 * loss)
    assert red(of_removal, damped, asked - {"work_lost"}) == set(), "a damped line may take it"


@pytest.mark.usefixtures("plain")
@pytest.mark.parametrize(("thrust", "asked"), [("along_track", "work"), ("tether", "pushes")])
def test_what_is_asked_of_an_orbit_is_asked_of_the_work_without_a_field(thrust: str, asked: str) -> None:
    """What stands in the place of another criterion is told of such a tow, and what it stands for is not."""
    sound = towed(TABLE | {"thrust": thrust}, SLED, 0.05)
    told = {one.key for one in of_removal(sound)}
    places = build.instead("tethered_deorbit", sound.terms)
    assert places == {"orbit": asked, "jacobi": asked, "jacobi_falls": asked}
    assert asked in told
    assert not places.keys() & told
    assert "orbit" not in build.instead("tethered_deorbit", {**sound.terms, "environment": "central"})


def test_a_line_of_nodes_whose_dashpots_give_is_red() -> None:
    """What they take is small beside the integral, which would not notice."""
    columns = {"time": np.arange(3.0), "lumped.heat": np.array([0.0, 1e-3, 1.1e-3])}
    for flipped, broken in ((1.0, set()), (-1.0, {"lumped_takes"})):
        changed = columns | {"lumped.heat": flipped * columns["lumped.heat"]}
        assert red(of_removal, Evidence(changed, {}, {"lumped": "nodes"}, 2.0), {"lumped_takes"}) == broken


def wrapped(**changed: Any) -> Evidence:
    """What a run with contact, bent threads and an index tells at three instants: a ball's hull, one metre off."""
    radius = np.array([2.0, 1.5, 1.2])
    columns: dict[str, Any] = {
        "time": np.array([0.0, 1.0, 2.0]),
        "energy.kinetic": np.full(3, 9.0),
        "energy.remainder": np.zeros(3),
        "contact.loss": np.array([0.0, 1.0, 2.0]),
        "wrap.passed": np.zeros(3),
        "wrap.passed_slack": np.zeros(3),
        "quality.hull_volume": 4.0 / 3.0 * np.pi * radius**3,
        "quality.hull_surface": 4.0 * np.pi * radius**2,
        "quality.offset": np.ones(3),
        **{f"catch.position[{axis}]": np.full(3, float(axis == 2)) for axis in (1, 2, 3)},
        **{f"target.position[{axis}]": np.zeros(3) for axis in (1, 2, 3)},
    }
    columns |= {name.replace("__", "."): value for name, value in changed.items()}
    terms: Mapping[str, str] = {"contact": "penalty", "gravity": "hill"}
    return Evidence(columns, {}, terms, 2.0)


@pytest.mark.parametrize(
    ("changed", "broken"),
    [
        ({}, set()),
        ({"contact__loss": np.array([0.0, 1.0, 0.8])}, {"contact_takes"}),
        ({"wrap__passed": np.array([0.0, 0.0, 1.0])}, {"through"}),
        ({"wrap__passed_slack": np.array([0.0, 0.0, 1.0])}, {"through"}),
        ({"quality__hull_volume": np.array([34.0, 14.0, 7.0])}, {"hull"}),
        ({"quality__hull_volume": np.array([33.0, 14.0, -7.0])}, {"hull"}),
        ({"quality__offset": np.array([1.0, 1.0, 1.001])}, {"offset"}),
    ],
)
def test_what_gives_energy_goes_through_or_is_of_no_body_is_red(changed: dict[str, Any], broken: set[str]) -> None:
    """A dashpot of the wrong sign gives back what it took; a hull fuller than a ball, or turned inside out."""
    asked = {"contact_takes", "through", "hull", "offset"}
    assert red(of_capture, wrapped(**changed), asked) == broken


def flown(speeds: list[float], terms: Mapping[str, str], **columns: Any) -> Evidence:
    """A net whose centre of mass flies along the shot at these shares of the shot's speed, each for a second."""
    axes = {f"chaser.start_{what}[{i}]": 0.0 for what in ("position", "velocity") for i in (1, 2, 3)}
    values = {**COARSE_NET, **axes, "chaser.start_position[2]": -20.0, **{f"shot.axis[{i}]": 0.0 for i in (1, 2, 3)}}
    count = len(speeds)
    mass = np.full(count, 2.48)
    velocity = np.array(speeds) * shot_momentum(Evidence({}, values, terms, 0.0)) / mass
    found: dict[str, Any] = {"time": np.arange(float(count)), "catch.mass": mass}
    for i in (1, 2, 3):
        along = velocity if i == 2 else np.zeros(count)
        found[f"catch.velocity[{i}]"] = along
        found[f"catch.position[{i}]"] = np.concatenate([[0.0], np.cumsum(along[:-1])]) - 20.0 * (i == 2)
    found |= {name.replace("__", "."): column for name, column in columns.items()}
    return Evidence(found, values, terms, float(count - 1))


def test_a_net_flies_straight_on_from_its_canister_until_something_pulls() -> None:
    """At the speed of the shot; from a canister that holds on to it, at that with which it leaves; not while a load
    pulls, nor on a line that drags."""
    asked, held = {"flight"}, [0.2, 0.5, 0.8, 0.8, 0.8]
    assert red(of_capture, flown([1.0] * 5, FREE), asked) == set()
    assert red(of_capture, flown(held, FREE), asked) == asked
    wall, stowed = FREE | {"wall": "plain"}, np.array([9, 4, 0, 0, 0])
    assert red(of_capture, flown(held, wall, wall__stowed=stowed), asked) == set()
    assert red(of_capture, flown([0.2, 0.5, 0.8, 0.7, 0.8], wall, wall__stowed=stowed), asked) == asked
    pulled = {f"pull_off__impulse[{i}]": np.array([0.0, 0.0, 0.0, i == 2, i == 2]) for i in (1, 2, 3)}
    late = flown([1.0, 1.0, 1.0, 0.6, 0.6], FREE, **pulled)
    assert red(of_capture, late, asked) == set()
    assert red(of_capture, flown([1.0, 0.6, 0.6, 0.6, 0.6], FREE, **pulled), asked) == asked
    drags = flown(held, FREE | {"tether": "dragging"})
    assert "flight" not in {one.key for one in of_capture(drags)}
