"""Derivatives of outputs by inputs and in time, against differences of the outputs; and inputs that ramp."""

import itertools
import math

import numpy as np
import pytest

from tests.packaging.driven import TERMS, Driven, library_of
from tests.packaging.raw import DISCARD, OK, Library, Raw

TUG = {"thrust.level": -0.5, "start.separation": 11.9, "tether.damping_ratio": 0.3}
INPUTS = {"tethered_deorbit": {"reel.length_offset": 1e-4}, "reel_control": {"length": 1e-3, "length_rate": 1e-4}}
"""Inputs with a direct effect, and how far each is moved for a difference."""
NAMES = [n for n in INPUTS if n in TERMS]


@pytest.fixture
def begin(fmu):
    """Start an FMU by its C functions: a `Raw` and the names of its Real outputs."""
    made = []

    def make(name, parameters):
        path, folder = fmu(name)
        about = Driven(path, folder, None)
        names = {n: v.valueReference for n, v in about.variables.items()}
        raw = Raw(Library(library_of(folder)), about.description.guid, names)
        assert raw.start(parameters) == OK, raw.last
        made.append(raw)
        real = [n for n, v in about.variables.items() if v.causality == "output" and v.type == "Real"]
        return raw, real

    yield make
    for raw in made:
        raw.free()


def taut(begin, **more):
    """The removal with its line taut and pulling, a communication point after it went so."""
    raw, real = begin("tethered_deorbit", TUG | more)
    time = 0.0
    while raw.get("tether.tension") < 0.01:
        assert raw.step(time, 0.5) == OK
        time += 0.5
        assert time < 500.0
    return raw, real, time


def running(begin, name):
    """An FMU where its outputs do depend on its inputs."""
    if name == "tethered_deorbit":
        return taut(begin)
    raw, real = begin(name, {})
    raw.set({"length": 12.5, "length_rate": 0.01})
    assert raw.step(0.0, 1.0) == OK
    return raw, real, 1.0


@pytest.mark.parametrize("name", NAMES)
def test_directional_derivatives_equal_differences_of_the_outputs(begin, name):
    raw, real, _ = running(begin, name)
    found = 0
    for known, move in INPUTS[name].items():
        status, slopes = raw.directional(real, {known: 1.0})
        assert status == OK
        at = raw.get(known)
        sides = []
        for sign in (1.0, -1.0):
            assert raw.set({known: at + sign * move}) == OK
            sides.append(np.array(raw.get(*real)))
        raw.set({known: at})
        difference = (sides[0] - sides[1]) / (2.0 * move)
        size = np.maximum(np.abs(sides[0]), np.abs(sides[1]))
        # rounding of the outputs, and a piecewise linear law's next order
        tolerance = 4.0 * np.finfo(float).eps * size / move + 1e-6 * np.abs(difference)
        assert np.all(np.abs(slopes - difference) <= tolerance), (real, slopes, difference)
        found += np.count_nonzero(slopes)
        # the twin that must fail: off by a percent where there is any dependence
        assert not np.all(np.abs(1.01 * np.array(slopes) - difference) <= tolerance)
    assert found >= len(INPUTS[name])


@pytest.mark.parametrize("name", NAMES)
def test_directions_add_up(begin, name):
    raw, real, _ = running(begin, name)
    each = [np.array(raw.directional(real, {known: 1.0})[1]) for known in INPUTS[name]]
    weights = [2.0, -3.0][: len(each)]
    both = raw.directional(real, dict(zip(INPUTS[name], weights, strict=True)))[1]
    np.testing.assert_allclose(both, sum(w * e for w, e in zip(weights, each, strict=True)), rtol=1e-14)


@pytest.mark.parametrize("name", NAMES)
def test_outputs_depend_on_no_other_input_directly(begin, name):
    """What the XML calls independent keeps its bits when an input is set; what it calls dependent does not."""
    from fmu_src.catalogue import MODELS
    from fmu_src.packaging import dependence

    interface = MODELS[name].interface(TERMS[name])
    names = list(dependence.names_by_slot(interface))
    depends = {names[o]: {names[i] for i in on} for o, on in dependence.inputs_of(interface).items()}
    raw, real, _ = running(begin, name)
    inputs = [n for n, _, v, _ in interface.scalars() if v.causality == "input" and v.kind == "Real"]
    for known in inputs:
        at, before = raw.get(known), np.atleast_1d(raw.get(*real))
        raw.set({known: at + 0.001})
        after = np.atleast_1d(raw.get(*real))
        raw.set({known: at})
        changed = {n for n, a, b in zip(real, before, after, strict=True) if a != b}
        assert changed == {n for n in real if known in depends.get(n, ())}, known


def time_differences(raw, real, time, h):
    """Central differences of all outputs from a state, and the outputs' sizes; the input held."""
    state = raw.save()
    rows = []
    for k in (1, 2):
        raw.restore(state)
        for _ in range(k):
            assert raw.step(time, h) == OK
            time += h
        rows.append(np.array(raw.get(*real)))
        time -= k * h
    raw.restore(state)
    start = np.array(raw.get(*real))
    return state, start, rows


def test_output_derivatives_equal_differences_in_time(begin):
    """From a state: one step on, its derivatives; and the outputs a step before and after."""
    raw, real, time = taut(begin)
    h = 1e-3
    _, before, (_, after) = time_differences(raw, real, time, h)
    assert raw.step(time, h) == OK
    compared = 0
    for name, a, b in zip(real, before, after, strict=True):
        status, slope = raw.output_rate(name)
        if status == DISCARD:
            continue
        assert status == OK, raw.last
        difference = (b - a) / (2.0 * h)
        tolerance = 8.0 * np.finfo(float).eps * max(abs(a), abs(b)) / h + 1e-5 * abs(difference) + 1e-9
        assert abs(slope - difference) <= tolerance, (name, slope, difference)
        if abs(difference) > 200.0 * tolerance:
            assert abs(1.01 * slope - difference) > tolerance, name  # a percent off would be seen
            compared += 1
    assert compared > 15


def test_net_output_derivatives_equal_differences_in_time(begin):
    """In free flight between two substeps the net's bodies move straight, so any step within one will do."""
    raw, real = begin("net_capture", {"net.mesh": 6.0})
    assert raw.step(0.0, 0.5) == OK
    h = 1e-5
    before = np.array(raw.get(*real))
    assert raw.step(0.5, h) == OK
    after = np.array(raw.get(*real))
    compared = 0
    for name, a, b in zip(real, before, after, strict=True):
        status, slope = raw.output_rate(name)
        if status == OK:
            tolerance = 1e-3 * abs(slope) + 4.0 * np.finfo(float).eps * max(abs(a), abs(b)) / h + 1e-6
            assert abs(slope - (b - a) / h) <= tolerance, name
            compared += abs(slope) > 0.1
    assert compared > 5


def test_asking_for_derivatives_changes_no_bit(begin):
    """A life with questions at every point ends as one without."""
    ends = []
    for asks in (False, True):
        raw, real, time = taut(begin)
        for k in range(40):
            raw.set({"reel.length_offset": 1e-3 * math.sin(k)})
            if asks:
                assert raw.directional(real, {"reel.length_offset": 1.0})[0] == OK
                raw.output_rate("tether.tension")
                raw.get(*real)
            assert raw.step(time, 1.0) == OK
            time += 1.0
        ends.append(raw.get(*real))
    assert ends[0] == ends[1]


def pay_out(begin, parts, ramped, rate=2e-4, span=4.0):
    """The bodies' distance after the line's length has changed at a rate, in so many steps, held or ramped in each.

    Without damping: a line that is paid out damps its own stretch, one whose length jumps does not see the jump's rate.
    """
    raw, _, time = taut(begin, **{"tether.damping_ratio": 0.0})
    for k in range(parts):
        h = span / parts
        raw.set({"reel.length_offset": rate * k * h})
        if ramped:
            assert raw.ramp("reel.length_offset", rate) == OK
        assert raw.step(time + k * h, h) == OK
    return np.array(raw.get("relative.position[1]", "relative.position[2]", "tether.length"))


def test_a_ramp_is_the_limit_of_many_held_inputs_and_may_be_cut(begin):
    whole = pay_out(begin, 1, ramped=True)
    halves = pay_out(begin, 2, ramped=True)
    size = np.abs(pay_out(begin, 1, ramped=False) - whole).max()
    assert size > 1e-6
    assert np.abs(halves - whole).max() < 1e-8 * size
    errors = [np.abs(pay_out(begin, n, ramped=False) - whole).max() for n in (16, 32, 64)]
    orders = [math.log2(a / b) for a, b in itertools.pairwise(errors)]
    assert all(abs(order - 1.0) < 0.1 for order in orders), (errors, orders)
    # the twin that must fail: another rate is not the limit
    other = pay_out(begin, 1, ramped=True, rate=2.02e-4)
    assert np.abs(other - halves).max() > 100.0 * np.abs(halves - whole).max()
