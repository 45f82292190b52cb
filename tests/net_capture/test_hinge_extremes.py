"""A hinge at the ends of its range: an appendage next to nothing, or nearly all; a dashpot that all but holds it; what
is faster than can be followed."""

import math

import numpy as np
import pytest

from dcone_cosim import build
from dcone_cosim.loading import load
from fmu_src.instance import Instance, ModelFault
from fmu_src.net_capture.appendage.laying import lightest, matrix
from fmu_src.net_capture.hinge import numbers as at
from fmu_src.net_capture.hinge.motion import FASTEST
from fmu_src.net_capture.interface import MODEL, refusals
from tests.conftest import CAPTURE
from tests.net_capture.on_target import Kernels
from tests.net_capture.two_bodies import EDGE, FLAT, TERMS, TwoBodies, design_attitude, free_motion, moving, tables_of

RATE = np.array([0.1, -0.15, 0.2])


def heavier(factor):
    """A wing on a body, so many times as heavy as it was."""
    return [FLAT[0], FLAT[1] | {"mass": factor * FLAT[1]["mass"]}]


@pytest.fixture(scope="module")
def law():
    return Kernels(TERMS | {"contact": "inelastic"}, tables_of()[0])


@pytest.fixture(scope="module")
def told(law):
    return free_motion(law)


@pytest.mark.parametrize("factor", [1e-8, 1e4])
def test_next_to_nothing_on_its_hinge_or_all_of_it(law, told, factor):
    """A wing of half a milligramme, and one of 500 tonnes: both as two bodies that constraints hold."""
    tell, fly = told
    entries = heavier(factor)
    soft = factor * 4.0 if factor < 1.0 else 4.0
    scene, tables, attitude = moving(law, entries, EDGE, [1.0, 0.0, 0.0], rate=RATE, start_rate=0.3, stiffness=soft)
    two = TwoBodies(entries, EDGE, np.array([1.0, 0.0, 0.0]), soft)
    tell(scene.record)
    energy = float(scene.p["target_energy"] + scene.p["hinge_energy"])
    fly(scene.record, 0.0, 2e-3, 1500)
    end = two.fly(two.start(attitude, attitude.apply(RATE), 0.0, 0.3), 3.0)
    assert scene.p["hinge_now"][6] == pytest.approx(two.angle(end), abs=1e-8)
    assert (design_attitude(scene, tables) * two.parts(end)[0][1].inv()).magnitude() < 1e-8
    tell(scene.record)
    assert scene.p["target_energy"] + scene.p["hinge_energy"] == pytest.approx(energy, rel=1e-9)


@pytest.mark.parametrize("damping", [1e3, 1e5])
def test_a_strong_dashpot_lets_it_creep(law, told, damping):
    """q = q0 exp(-k t/c), of a target at rest: inertia has no part in it."""
    tell, fly = told
    stiffness = 0.5 * damping
    scene, _, _ = moving(law, FLAT, EDGE, [1.0, 0.0, 0.0], start_angle=0.3, stiffness=stiffness, damping=damping)
    fly(scene.record, 0.0, 1e-3, 1000)
    assert scene.p["hinge_now"][6] == pytest.approx(0.3 * math.exp(-0.5), rel=2.0 * 60.0 / damping)
    tell(scene.record)
    stored = 0.5 * stiffness * 0.3**2
    left = scene.p["target_energy"] + scene.p["hinge_energy"] + scene.p["hinge_loss"]
    assert left == pytest.approx(stored, rel=1e-6)


def test_the_least_moment_is_that_of_the_angles_between_its_stops():
    tables, mass = tables_of()
    table = tables[at.BODY]
    finer = [mass / np.linalg.inv(matrix(table, q)[0])[3, 3] for q in np.linspace(-1.2, 1.2, 801)]
    assert mass * lightest(table) == pytest.approx(min(finer), rel=1e-4)
    assert max(finer) > 1.02 * min(finer)


def composed(**hinge):
    tables, mass = tables_of()
    terms = CAPTURE | {"target": "union", "hinge": "plain"}
    return terms, {"target.mass": mass, **{f"hinge.{name}": value for name, value in hinge.items()}}, tables


@pytest.mark.parametrize(("name", "power", "unit"), [("stiffness", 2, "N m/rad"), ("damping", 1, "N m s/rad")])
def test_faster_than_can_be_followed_is_refused(name, power, unit):
    """By its name with the most that there may be; just below, it is followed. An FMU whose value is set refuses it as
    it begins, in place of going on for ever."""
    main = load("hinged-panel").phases[0].main
    values = {**main.values, **main.made}
    most = values["target.mass"] * lightest(values[at.BODY]) * FASTEST**power
    for factor, number in ((0.99, 0), (1.01, 1)):
        found = [
            one
            for one in refusals(main.terms, values | {f"hinge.{name}": factor * most}, 24.0)
            if one.name == f"hinge.{name}"
        ]
        assert len(found) == number
    assert found[0].expected.startswith(f"must be at most {most:.3g} {unit}")
    terms, given, tables = composed(**{name: 1e12 if power == 1 else 1e18})
    with pytest.raises(ModelFault, match=r"spring or dashpot of the hinge"):
        Instance(MODEL, terms, given, tables).initialise()


@pytest.mark.parametrize("rates", [{"hinge.start_rate": -1.0}, {"target.start_rate[2]": 1.0}])
def test_an_fmu_that_turns_too_fast_to_follow_does_not_begin(rates):
    """The hinge's or the rest's: in place of going on for ever."""
    terms, given, tables = composed()
    for factor in (1.99, 2.01):
        instance = Instance(MODEL, terms, given | {name: one * factor * FASTEST for name, one in rates.items()}, tables)
        if factor > 2.0:
            with pytest.raises(ModelFault, match=r"turn by more than 200000 rad/s together"):
                instance.initialise()
        else:
            instance.initialise()


def test_its_extremes_are_asked_of_a_scene():
    main = load("hinged-panel").phases[0].main
    names = [one.name for one in build.extremes("net_capture", main.terms) if one.name.startswith("hinge")]
    assert len(names) == 5
