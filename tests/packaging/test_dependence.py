"""What each FMU says its outputs depend on, against what happens when inputs and parameters are changed."""

import math

import numpy as np
import pytest

from tests.packaging.driven import Driven, library_of
from tests.packaging.raw import ERROR, OK, Library, Raw

CASES = {
    "net_capture": {"net.mesh": 6.0, "net.youngs_modulus": 7e6, "closing.axial_stiffness": 9.0},
    "tethered_deorbit": {"thrust.level": -0.5, "start.separation": 11.9, "tether.damping_ratio": 0.3},
    "removal, linear": {"start.separation": 11.0},
    "removal, commanded": {"reel.tension": 0.3},
    "reel_control": {"length": 12.5, "length_rate": 0.01},
    "reel control, motor": {"length": 12.5, "length_rate": 0.01},
}
"""Values that set something going, by FMU."""
DERIVED = [name for name in CASES if name != "net_capture"]
"""A net can not be: its mesh comes in whole numbers."""
MOVES = (1e-3, 0.3, -0.3, 40.0)
"""By how much a Real input is changed; large ones make a line taut or slack."""


class World:
    """One FMU by its C functions, with what its XML says of dependencies."""

    def __init__(self, path, folder, values):
        about = Driven(path, folder, None)
        self.description, self.values = about.description, values
        self.variables = about.variables
        self.outputs = {k: self.named(k) for k in ("Real", "Integer", "Boolean")}
        self.direct = self.listed(self.description.outputs)
        self.at_start = self.listed(self.description.initialUnknowns)
        self._library, self._made = Library(library_of(folder)), []
        self._references = {n: v.valueReference for n, v in self.variables.items()}

    def named(self, kind):
        return [n for n, v in self.variables.items() if v.causality == "output" and v.type == kind]

    @staticmethod
    def listed(unknowns):
        return {u.variable.name: {d.name for d in u.dependencies} for u in unknowns}

    def fresh(self, more=()):
        """An instance in initialization mode."""
        raw = Raw(self._library, self.description.guid, self._references)
        self._made.append(raw)
        assert raw.set(self.values | dict(more)) == OK, raw.last
        assert raw.call("SetupExperiment", False, 0.0, 0.0, False, 0.0) == OK
        assert raw.call("EnterInitializationMode") == OK
        return raw

    def read(self, raw):
        """Every output by name."""
        return {
            n: value
            for kind, names in self.outputs.items()
            if names
            for n, value in zip(names, np.atleast_1d(raw.get(*names, kind=kind)), strict=True)
        }

    def close(self):
        for raw in self._made:
            raw.free()


@pytest.fixture
def world(fmu, request):
    made = World(*fmu(request.param), CASES[request.param])
    yield made
    made.close()


def moved(world, raw, name):
    """An input's value, and others to try."""
    v = world.variables[name]
    at = raw.get(name, kind=v.type)
    if v.type == "Boolean":
        return bool(at), [not at]
    return at, [at + move for move in MOVES]


def changed(world, raw, known):
    """Outputs that change when an input is set, by any of several moves; the input is put back."""
    before = world.read(raw)
    at, others = moved(world, raw, known)
    found = set()
    for value in others:
        assert raw.set({known: value}) == OK, raw.last
        found |= {n for n, x in world.read(raw).items() if x != before[n]}
    assert raw.set({known: at}) == OK
    assert world.read(raw) == before
    return found


@pytest.mark.parametrize("world", CASES, indirect=True)
def test_outputs_depend_on_the_inputs_that_are_declared_and_on_no_others(world):
    """At communication points, pulling and not; the motor's tension is a state, which no input moves at once."""
    raw = world.fresh()
    assert raw.call("ExitInitializationMode") == OK
    inputs = [n for n, v in world.variables.items() if v.causality == "input"]
    found = {name: set() for name in inputs}
    step = 0.05 if "net.mesh" in world.values else 2.0
    for k in range(4):
        assert raw.step(k * step, step) == OK
        for name in inputs:
            found[name] |= changed(world, raw, name)
    for name in inputs:
        assert found[name] == {n for n, on in world.direct.items() if name in on}, name
    assert set(world.direct) == {n for names in world.outputs.values() for n in names}


@pytest.mark.parametrize("world", CASES, indirect=True)
def test_at_the_start_outputs_depend_on_what_is_declared(world):
    """Nothing that is not declared has an effect; each input that is declared has one on some output."""
    base = world.read(world.fresh())
    effects = {}
    for name, v in world.variables.items():
        if v.causality != "input":
            continue
        _, others = moved(world, world.fresh(), name)
        ends = [world.read(world.fresh({name: value})) for value in others]
        effects[name] = {n for end in ends for n, x in end.items() if x != base[n]}
    for name, effect in effects.items():
        declared = {n for n, on in world.at_start.items() if name in on}
        assert effect <= declared, name
        assert bool(effect) == bool(declared), name


def difference(world, name, at, known_step, real):
    """Change of Real outputs by a value, from fresh instances on both sides, or on that side where one can start.

    Of second order, with steps of its own; and how large rounding and the next order may be.
    """
    ends = {}
    for k in (-2, -1, 1, 2):
        raw = world.fresh()
        if raw.set({name: at + k * known_step}) == OK and raw.call("ExitInitializationMode") == OK:
            ends[k] = np.atleast_1d(raw.get(*real))
    raw = world.fresh()
    ends[0] = np.atleast_1d(raw.get(*real))
    if {-2, -1, 1, 2} <= set(ends):
        slope, wide = (ends[1] - ends[-1]) / 2.0, (ends[2] - ends[-2]) / 4.0
    else:
        s = 1 if {1, 2} <= set(ends) else -1
        slope = s * (4.0 * ends[s] - 3.0 * ends[0] - ends[2 * s]) / 2.0
        wide = s * (ends[2 * s] - ends[0]) / 2.0
    sizes = np.maximum(np.abs(ends[0]), [float(world.variables[n].nominal or 0.01) for n in real])
    rounding = 8.0 * np.finfo(float).eps * sizes / known_step
    return slope / known_step, rounding + np.abs(slope - wide) / known_step


@pytest.mark.parametrize("world", DERIVED, indirect=True)
def test_at_the_start_every_pair_has_the_derivative_of_fresh_instances(world):
    """Each unknown by each Real it is said to depend on: OK and right. By any other input: OK and zero."""
    assert world.description.coSimulation.providesDirectionalDerivative
    real = world.outputs["Real"]
    raw, pairs, found = world.fresh(), 0, 0
    for name, v in world.variables.items():
        if v.causality not in ("parameter", "input") or v.type != "Real":
            continue
        status, told = raw.directional(real, {name: 1.0})
        assert status == OK, (name, raw.last)
        at = raw.get(name)
        step = 3e-5 * (abs(at) or 1.0)
        expected, error = difference(world, name, at, step, real)
        for n, slope, e, around in zip(real, told, expected, error, strict=True):
            if name not in world.at_start[n]:
                assert slope == 0.0, (n, name)
            tolerance = around + 1e-7 * abs(e)
            assert abs(slope - e) <= tolerance, (n, name, slope, e, around)
            pairs += 1
            if abs(e) > 500.0 * tolerance:
                assert abs(1.01 * slope - e) > tolerance, (n, name)  # a percent off would be seen
                found += 1
    assert pairs == len(real) * sum(
        v.causality in ("parameter", "input") and v.type == "Real" for v in world.variables.values()
    )
    assert found >= (1 if len(real) == 1 else 100)


@pytest.mark.parametrize("world", DERIVED, indirect=True)
def test_while_stepping_derivatives_are_by_inputs_alone(world):
    raw = world.fresh()
    assert raw.call("ExitInitializationMode") == OK
    for name, v in world.variables.items():
        if v.type != "Real":
            continue
        status, told = raw.directional(world.outputs["Real"], {name: 1.0})
        assert (status == OK) == (v.causality == "input"), name
        if v.causality == "input":
            for n, slope in zip(world.outputs["Real"], told, strict=True):
                assert slope == 0.0 or name in world.direct[n]
        elif v.causality == "parameter":
            assert f"{name} is no input" in raw.last


@pytest.mark.parametrize("world", ["net_capture"], indirect=True)
def test_an_fmu_without_directional_derivatives_says_so(world):
    assert not world.description.coSimulation.providesDirectionalDerivative
    raw = world.fresh()
    assert raw.directional(["mouth.area"], {"net.side": 1.0})[0] == ERROR
    assert "provides no directional derivatives" in raw.last


@pytest.mark.parametrize("world", ["reel control, motor"], indirect=True)
def test_a_motors_tension_begins_with_what_is_asked(world):
    """k_p by the length and k_d by its rate at the start, where a step later they are zero."""
    raw = world.fresh()
    gains = raw.get("gain.proportional", "gain.derivative")
    for known, gain in zip(("length", "length_rate"), gains, strict=True):
        assert raw.directional(["tension"], {known: 1.0}) == (OK, [pytest.approx(gain, rel=1e-10)])
    status, slopes = raw.directional(["tension"], {"gain.proportional": 1.0})
    assert (status, slopes) == (OK, [pytest.approx(12.5 - 12.0, rel=1e-10)])
    assert raw.call("ExitInitializationMode") == OK
    assert raw.directional(["tension"], {"length": 1.0}) == (OK, [0.0])
    assert math.isclose(gains[0], 0.004155)
