"""Several components as one: connections, beginning, variables, saved states, closing."""

from __future__ import annotations

from dataclasses import replace

import pytest

from dcone_cosim.coupling.coupled import Coupled
from dcone_cosim.coupling.options import Connection, Coupling
from dcone_cosim.errors import FmuError, InputError
from dcone_cosim.fmu.component import Terminated, output_names
from dcone_cosim.units import NO_UNIT, Unit
from tests.cosim.linear_components import LinearComponent, by_force, by_motion, coupled, error_at, run
from tests.cosim.mock_components import MockComponent

LENGTH, FORCE = (0, 1, 0, 0, 0, 0, 0, 0), (1, 1, -2, 0, 0, 0, 0, 0)


def pair(*connections: tuple[str, str, str, str]) -> Coupled:
    components, _ = by_force()
    return Coupled("tow", components, [Connection(*c) for c in connections], Coupling())


def typed(kind: str, other: str) -> None:
    one, two = MockComponent("one"), MockComponent("two")
    one.declare(["out"], "output", kind=kind)
    two.declare(["in"], "input", kind=other)
    Coupled("tow", [one, two], [Connection("one", "out", "two", "in")], Coupling())


def test_all_wrong_connections_are_told_at_once() -> None:
    with pytest.raises(InputError) as caught:
        pair(
            ("frist", "position", "second", "position"),
            ("first", "positoin", "second", "velocity"),
            ("first", "position", "second", "force"),
            ("first", "position", "second", "position"),
            ("first", "velocity", "second", "position"),
        )
    said = str(caught.value)
    assert "connections of the tow: 5 mistakes" in said
    assert "there is no component 'frist'; did you mean 'first'?" in said
    assert "first has no variable 'positoin'; did you mean 'position'?" in said
    assert "second.force is an output, not an input" in said
    assert "second.position is set by frist.position already" in said


def test_a_parameter_is_no_source() -> None:
    one, two = MockComponent("one"), MockComponent("two")
    one.declare(["gain"], "parameter")
    two.declare(["in"], "input")
    with pytest.raises(InputError, match=r"one\.gain is a parameter, not an output"):
        Coupled("tow", [one, two], [Connection("one", "gain", "two", "in")], Coupling())


@pytest.mark.parametrize(
    ("kind", "other"),
    [("Real", "Real"), ("Integer", "Real"), ("Boolean", "Integer"), ("Integer", "Boolean"), ("Boolean", "Boolean")],
)
def test_kinds_that_fit(kind: str, other: str) -> None:
    typed(kind, other)


@pytest.mark.parametrize(("kind", "other"), [("Real", "Integer"), ("Real", "Boolean"), ("String", "Real")])
def test_kinds_that_do_not_fit(kind: str, other: str) -> None:
    with pytest.raises(InputError, match=f"out is a {kind}, in is an? {other}"):
        typed(kind, other)


def test_dimensions_must_be_the_same() -> None:
    components, connections = by_force()
    first, second = components
    first.variables["position"] = replace(first.variables["position"], own=Unit("mm", LENGTH, 1e-3))
    second.variables["position"] = replace(second.variables["position"], own=Unit("m", LENGTH))
    Coupled("tow", components, connections, Coupling())
    second.variables["position"] = replace(second.variables["position"], own=Unit("N", FORCE))
    with pytest.raises(InputError, match=r"position is in mm, position in N: different dimensions"):
        Coupled("tow", components, connections, Coupling())
    second.variables["position"] = replace(second.variables["position"], own=NO_UNIT)
    Coupled("tow", components, connections, Coupling())


def test_turns_are_no_angle() -> None:
    """A speed counted in Hz is not taken for one in rad/s; where its unit is defined with the radians, it is."""
    components, connections = by_force()
    first, second = components
    frequency, angular = (0, 0, -1, 0, 0, 0, 0, 0), (0, 0, -1, 0, 0, 0, 0, 1)
    info = replace(first.variables["position"], own=Unit("Hz", frequency))
    second.variables["position"] = replace(second.variables["position"], own=Unit("rad/s", angular))
    first.variables["position"] = info
    with pytest.raises(InputError, match=r"position is in Hz, position in rad/s: Hz counts turns, rad/s an angle"):
        Coupled("tow", components, connections, Coupling())
    for other in (
        replace(info, own=Unit("1/s", frequency)),
        replace(info, own=Unit("Hz", angular, 6.283185307179586)),
    ):
        first.variables["position"] = other
        Coupled("tow", components, connections, Coupling())


def test_an_order_names_every_component_once() -> None:
    components, connections = by_force()
    for order in (("second",), ("second", "first", "first"), ("second", "frist")):
        with pytest.raises(InputError, match="must name every component once"):
            Coupled("tow", components, connections, Coupling(order=order))


@pytest.mark.parametrize("order", [(), ("second", "first")])
def test_components_step_in_the_order_given(order: tuple[str, ...]) -> None:
    components, connections = by_motion()
    seen: list[str] = []
    for component in components:
        component.step = _told(component, seen)  # type: ignore[method-assign]
    run(coupled(components, connections, order=order), 2.0, 1.0)
    assert seen == 2 * list(order or ("first", "second"))


def _told(component: LinearComponent, seen: list[str]):  # type: ignore[no-untyped-def]
    step = component.step

    def told(time: float, size: float) -> None:
        seen.append(component.name)
        step(time, size)

    return told


def test_outputs_and_inputs_agree_from_the_beginning() -> None:
    """Also along a chain of direct dependences that runs against the order of the components."""
    made, ends = [], []
    for i in range(5):
        made.append(LinearComponent(f"n{i}", ([[0]], [[0]], [[0]], [[2]]), ["in"], ["out"], [0.0]))
    made[4].values["in"] = 1.0
    ends = [Connection(f"n{i}", "out", f"n{i - 1}", "in") for i in range(4, 0, -1)]
    whole = coupled(made, ends)
    assert whole.get(["out", "n1.out", "n4.out"]) == {"out": 32.0, "n1.out": 16.0, "n4.out": 2.0}


def loop(gain: float, offset: float = 1.0) -> tuple[list[LinearComponent], list[Connection]]:
    """u = offset + gain * y, y = u: y = offset / (1 - gain)."""
    one = LinearComponent("one", ([[0]], [[0]], [[1]], [[gain]]), ["in"], ["out"], [offset])
    two = LinearComponent("two", ([[0]], [[0]], [[0]], [[1]]), ["in"], ["out"], [0.0])
    return [one, two], [Connection("one", "out", "two", "in"), Connection("two", "out", "one", "in")]


@pytest.mark.parametrize("gain", [0.5, -0.8, 0.95])
def test_an_algebraic_loop_that_settles(gain: float) -> None:
    assert coupled(*loop(gain)).get(["out"])["out"] == pytest.approx(1.0 / (1.0 - gain), rel=1e-10)


def test_an_algebraic_loop_that_settles_at_zero() -> None:
    components, connections = loop(0.5, 0.0)
    components[0].set({"in": 1.0})
    assert coupled(components, connections).get(["out"])["out"] == pytest.approx(0.0, abs=1e-11)


@pytest.mark.parametrize("gain", [1.01, -1.5, 3.0, -5.0, 1e30])
def test_an_algebraic_loop_that_does_not_is_named(gain: float) -> None:
    with pytest.raises(FmuError, match="algebraic loop") as caught:
        coupled(*loop(gain))
    assert "one.out -> two.in: from" in str(caught.value)
    assert "at t = 0 s" in str(caught.value)


def test_a_chain_that_ends_in_no_number_is_no_loop() -> None:
    """However long: what is not finite is told where it stands."""
    gains = [1.0, 1e200, 1e200, 1.0]
    made = [LinearComponent(f"n{i}", ([[0]], [[0]], [[0]], [[d]]), ["in"], ["out"], [0.0]) for i, d in enumerate(gains)]
    made[3].values["in"] = 1.0
    ends = [Connection(f"n{i}", "out", f"n{i - 1}", "in") for i in range(3, 0, -1)]
    with pytest.raises(FmuError, match=r"n1: out is inf at t = 0 s"):
        coupled(made, ends)


def test_an_output_that_is_no_number_is_named() -> None:
    components, connections = by_motion()
    whole = coupled(components, connections)
    components[1].c[0, 0] = float("nan")
    with pytest.raises(FmuError, match=r"second: position is nan at t = 0\.5 s"):
        whole.step(0.0, 0.5)


def test_variables_of_all_under_one_roof() -> None:
    components, connections = by_force()
    whole = coupled(components, connections)
    assert set(output_names(whole.variables)) == {"position", "velocity", "second.force"}
    assert whole.variables["second.force"].name == "second.force"
    read = whole.reader(["second.force", "velocity", "position"])
    whole.step(0.0, 0.1)
    found = dict(zip(read.names, read().tolist(), strict=True))
    assert found == {
        "second.force": components[1].values["force"],
        "velocity": components[0].values["velocity"],
        "position": components[0].values["position"],
    }
    whole.set({"second.position": 3.0})
    assert components[1].values["position"] == 3.0
    whole.step(0.1, 0.1)
    assert components[1].values["position"] == components[0].values["position"]
    with pytest.raises(FmuError, match=r"did you mean 'second\.force'"):
        whole.get(["second.forze"])


def test_names_that_collide_are_refused() -> None:
    components, connections = by_force()
    components[0].declare(["second.force"], "output")
    with pytest.raises(InputError, match="give that component another name"):
        Coupled("tow", components, connections, Coupling())


def test_the_main_component_may_bear_another_name() -> None:
    components, connections = by_force()
    components[0].name = "removal without recoil"
    Coupled("removal without recoil", components, connections, Coupling(), ("first", "second"))
    with pytest.raises(InputError, match="no component 'first'"):
        Coupled("removal without recoil", components, connections, Coupling())


@pytest.mark.parametrize("control", ["fixed", "error"])
@pytest.mark.parametrize("extrapolation", ["constant", "linear"])
def test_a_saved_state_replays_to_the_last_bit(control: str, extrapolation: str) -> None:
    whole = coupled(*by_force(), control=control, step=0.1, extrapolation=extrapolation, tolerance=1e-3)
    whole.step(0.0, 1.0)
    whole.save()
    whole.save("other")
    names = output_names(whole.variables)
    whole.step(1.0, 1.0)
    first = whole.get(names)
    whole.restore()
    whole.step(1.0, 0.5)
    whole.save()
    whole.restore("other")
    whole.step(1.0, 1.0)
    assert whole.get(names) == first


def test_coupling_steps_come_from_integers_and_land_exactly() -> None:
    components, connections = by_motion()
    whole = Coupled("pair", components, connections, Coupling(step=0.3))
    whole.enter_initialisation(2.0)
    whole.exit_initialisation()
    whole.step(2.0, 1.0)
    begins = [time for time, _ in components[0].calls]
    assert begins == [2.0 + k * 0.3 for k in range(4)]
    assert components[0].calls[-1][0] + components[0].calls[-1][1] == 3.0


def test_without_a_step_the_macro_step_is_taken() -> None:
    components, connections = by_motion()
    run(coupled(components, connections), 1.0, 0.25)
    assert [size for _, size in components[1].calls] == [0.25] * 4


def test_a_step_of_zero_length_does_nothing() -> None:
    components, connections = by_motion()
    coupled(components, connections).step(0.0, 0.0)
    assert components[0].calls == []


def test_statistics() -> None:
    whole = run(coupled(*by_motion(), step=0.3), 2.0, 1.0)
    found = whole.statistics
    assert (found["steps"], found["rejected"], found["forced"]) == (8, 0, 0)
    assert found["largest"] == pytest.approx(0.3)
    assert found["smallest"] == pytest.approx(0.1)


def test_all_are_closed_though_one_fails() -> None:
    components, connections = by_force()

    def broken() -> None:
        raise FmuError("first: gone")

    components[0].close = broken  # type: ignore[method-assign]
    whole = coupled(components, connections)
    with pytest.raises(FmuError, match="gone"):
        whole.close()
    assert components[1].closed


def test_a_crash_of_the_second_leaves_the_first_closable() -> None:
    components, connections = by_force()
    whole = coupled(components, connections)

    def crash(time: float, size: float) -> None:
        raise FmuError(f"second: its process died at t = {time:g} s")

    components[1].step = crash  # type: ignore[method-assign]
    with pytest.raises(FmuError, match="process died"):
        whole.step(0.0, 0.1)
    whole.close()
    assert components[0].closed
    assert components[1].closed


def test_rates_from_outside_are_refused() -> None:
    with pytest.raises(FmuError, match="no input derivatives"):
        coupled(*by_force()).set_rates({"force": 1.0})


def test_a_wrong_connection_gives_a_wrong_answer() -> None:
    """Twin of the tests against the exact solution: position and speed exchanged."""
    components, _ = by_force()
    ends = [("position", "velocity"), ("velocity", "position")]
    crossed = [Connection("first", a, "second", b) for a, b in ends] + [Connection("second", "force", "first", "force")]
    assert error_at(run(coupled(components, crossed, step=0.0125), 8.0, 1.0), 8.0) > 0.1
    assert error_at(run(coupled(*by_force(), step=0.0125), 8.0, 1.0), 8.0) < 0.03


def test_steps_of_one_length() -> None:
    """One such component makes the whole one; a step that its steps do not fill is refused before any is taken."""
    components, connections = by_motion()
    assert coupled(components, connections).can_vary_step
    components[1].can_vary_step = False
    whole = coupled(components, connections, step=0.3)
    assert not whole.can_vary_step
    with pytest.raises(
        FmuError, match=r"step of 1 s at t = 0 s is not a whole number of steps of 0\.3 s.* of second takes"
    ):
        whole.step(0.0, 1.0)
    assert components[0].calls == []
    run(coupled(components, connections, step=0.1), 3.0, 0.3)
    assert {round(size, 12) for _, size in components[1].calls} == {0.1}
    whole = coupled(components, connections)
    whole.step(0.0, 0.3)
    with pytest.raises(FmuError, match=r"step of 0\.2 s at t = 0\.3 s is not a whole number of steps of 0\.3 s"):
        whole.step(0.3, 0.2)


def test_of_steps_of_one_length_none_is_cut_to_meet_an_end() -> None:
    components, connections = by_motion()
    components[0].can_vary_step = False
    components[1].ends_at = 0.25
    with pytest.raises(Terminated):
        coupled(components, connections, step=0.1).step(0.0, 1.0)
    assert {round(size, 12) for _, size in components[0].calls} == {0.1}
