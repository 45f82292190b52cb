"""The shim alone, on a toy whose kernel is known in closed form: values, derivatives, ramps, ends and refusals."""

import math

import pytest

from tests.packaging.raw import DISCARD, ERROR, OK, WARNING, Count, doubles, references


def test_it_computes_what_its_kernel_says(running):
    assert running.set({"push": 2.0, "pull": 0.5}) == OK
    assert running.step(0.0, 0.5) == OK
    assert running.get("x") == 1.0
    assert running.get("y") == 1.0 + 3.0 * 2.0 + 2.0 * 0.5
    assert running.get("grid[3].at[2]") == 5.0
    assert running.get("steps", kind="Integer") == 1
    assert running.get("lit", kind="Boolean") == 1


def test_outputs_follow_inputs_before_the_next_step(running):
    """An output that depends on an input directly is worked out anew once it was set."""
    running.step(0.0, 1.0)
    assert running.get("y") == 0.0
    running.set({"pull": 1.0})
    assert running.get("y") == 2.0
    assert running.get("x") == 0.0


@pytest.mark.parametrize(
    ("name", "value", "words"),
    [
        ("gain", 1.0, "gain is a parameter, fixed once the initialisation is over"),
        ("grid[2].at[1]", 1.0, "grid[2].at[1] is an output and can not be set"),
        ("push", math.nan, "push was given a number that is not finite"),
        ("push", 10.1, "push = 10.1 m/s is out of its bounds"),
        ("steps", 1.0, "is no variable of the type asked for"),
    ],
)
def test_a_value_that_can_not_be_set_is_named(running, name, value, words):
    assert running.set({name: value}) == ERROR
    assert words in running.last
    assert running.set({"push": 10.0}) == OK


def test_a_call_sets_all_or_nothing(running, built_toy):
    both = references(built_toy.references["push"], built_toy.references["gain"])
    assert running.call("SetReal", both, Count(2), doubles(7.0, 1.0)) == ERROR
    assert running.get("push") == 0.0


@pytest.mark.parametrize("reference", [0, 5, 6, 7, 12, 31, 10**6, 2**32 - 1])
def test_hidden_and_unknown_references_are_refused(running, reference):
    value = doubles(0.0)
    assert running.call("GetReal", references(reference), Count(1), value) == ERROR
    assert running.call("SetReal", references(reference), Count(1), value) == ERROR


def test_parameters_are_checked_when_they_are_used(make):
    raw = make()
    assert raw.start({"gain": 0.0}) == ERROR
    assert "gain = 0 1 is out of its bounds: it must be finite, greater than 0 and at most 100" in raw.last
    assert raw.set({"gain": 1.0}) == OK
    assert raw.call("ExitInitializationMode") == OK


# ---- derivatives --------------------------------------------------------------------------------------------------


def test_a_ramp_is_integrated_exactly_and_two_halves_are_one_whole(make):
    ends = []
    for parts in (1, 2):
        raw = make()
        raw.start()
        raw.set({"push": 1.0})
        for k in range(parts):
            assert raw.ramp("push", 4.0) == OK
            assert raw.step(2.0 * k / parts, 2.0 / parts) == OK
        assert raw.get("push") == 9.0
        ends.append(raw.get("x", "y"))
    assert ends[0] == ends[1] == [10.0, 10.0 + 3.0 * 9.0]


def test_a_ramp_lasts_one_step(running):
    running.ramp("push", 1.0)
    running.step(0.0, 1.0)
    running.step(1.0, 1.0)
    assert running.get("x") == 0.5 + 1.0
    running.ramp("push", 1.0)
    running.set({"push": 0.0})  # which takes the rate back
    running.step(2.0, 1.0)
    assert running.get("x") == 1.5


def test_a_ramp_that_leaves_the_bounds_is_refused_and_the_instance_lives(running):
    running.ramp("push", 6.0)
    assert running.step(0.0, 2.0) == ERROR
    assert "push = 12 m/s is out of its bounds" in running.last
    assert running.step(0.0, 1.0) == OK


def test_ramps_of_other_inputs_and_orders_are_refused(running):
    assert running.ramp("pull", 1.0) == ERROR
    assert "pull is held over a step" in running.last
    assert running.ramp("push", 1.0, order=2) == ERROR
    assert "order 2, expected 1" in running.last
    assert running.ramp("x", 1.0) == ERROR
    assert running.ramp("push", math.inf) == ERROR


def test_output_derivatives(running):
    running.set({"push": 2.0})
    running.ramp("push", 0.5)
    assert running.output_rate("x") == (OK, 2.0)
    assert running.output_rate("y") == (OK, 2.0 + 3.0 * 0.5)
    assert running.output_rate("sum")[0] == DISCARD
    assert "sum has no derivative" in running.last
    assert running.output_rate("x", order=2) == running.output_rate("y", order=3) == (OK, 0.0)
    assert running.output_rate("sum", order=2)[0] == DISCARD
    assert running.output_rate("x", order=0)[0] == running.output_rate("x", order=-1)[0] == ERROR
    assert running.output_rate("push")[0] == ERROR


def test_directional_derivatives_equal_differences(running):
    at = {"push": 1.0, "pull": -1.0}
    along = {"push": 0.25, "pull": 4.0}
    status, slopes = running.directional(["y", "x"], along)
    sides = []
    for sign in (1.0, -1.0):
        running.set({n: at[n] + sign * along[n] for n in at})
        sides.append(running.get("y", "x"))
    assert status == OK
    assert slopes == [(a - b) / 2.0 for a, b in zip(*sides, strict=True)] == [3.0 * 0.25 + 2.0 * 4.0, 0.0]
    assert running.directional(["lit"], along)[0] == ERROR
    assert running.directional(["y"], {"gain": 1.0})[0] == ERROR
    assert "gain is no input" in running.last


def test_at_the_start_derivatives_are_those_of_the_start(make):
    """By parameters too; y = gain push + 2 pull there, and x = 0."""
    raw = make()
    raw.set({"gain": 4.0, "push": 1.5, "pull": -1.0})
    raw.call("EnterInitializationMode")
    assert raw.directional(["y", "x"], {"push": 0.25, "pull": 3.0}) == (OK, [4.0 * 0.25 + 2.0 * 3.0, 0.0])
    status, slopes = raw.directional(["y", "x"], {"gain": 2.0, "push": 1.0})
    assert status == OK
    assert slopes == pytest.approx([1.5 * 2.0 + 4.0, 0.0], rel=1e-11)
    assert raw.directional(["y"], {"room": 1.0})[0] == raw.directional(["y"], {"x": 1.0})[0] == ERROR
    assert raw.directional(["gain"], {"push": 1.0})[0] == ERROR
    before = raw.get("x", "y")
    assert raw.call("ExitInitializationMode") == OK
    assert raw.get("x", "y") == before == [0.0, 4.0]


@pytest.mark.parametrize("gain", [100.0, 99.999, 1e-9, 1e-300, 5e-324])
def test_at_a_bound_a_derivative_is_that_of_the_inner_side(make, gain):
    raw = make()
    raw.set({"gain": gain, "push": 1.5})
    raw.call("EnterInitializationMode")
    status, slopes = raw.directional(["y"], {"gain": 1.0})
    assert status == OK
    assert slopes == pytest.approx([1.5], rel=1e-9)
    raw.said.clear()
    raw.set({"gain": 101.0})
    assert raw.directional(["y"], {"gain": 1.0})[0] == ERROR
    assert "gain = 101" in raw.last


def test_where_no_start_is_near_a_derivative_is_refused_and_the_instance_lives(make):
    raw = make()
    raw.set({"gain": 42.0, "push": 1.5})
    raw.call("EnterInitializationMode")
    assert raw.directional(["y"], {"gain": 1.0})[0] == DISCARD
    assert "no derivative by gain: the model can start on neither side of 42" in raw.last
    assert raw.directional(["y"], {"push": 1.0}) == (OK, [42.0])
    assert raw.call("ExitInitializationMode") == OK
    assert raw.get("y") == 63.0


# ---- ends and refusals ----------------------------------------------------------------------------------------------


def test_the_models_own_end_is_a_discard_with_terminated_and_time(make):
    raw = make()
    raw.start({"end": 1.25})
    assert raw.step(0.0, 1.0) == OK
    assert not raw.ended()
    assert raw.step(1.0, 1.0) == DISCARD
    assert raw.said[-1] == (DISCARD, "logStatusDiscard", "the cart has arrived (value 0, at 1.25 s)")
    assert raw.ended()
    assert raw.real_status() == (OK, 1.25)
    assert raw.get("x") == 0.0
    assert raw.step(1.25, 0.1) == ERROR  # a tool that goes on does not loop
    assert "at its own end" in raw.last
    assert raw.call("Terminate") == OK


def test_a_discarded_step_can_be_taken_back(running):
    state = running.save()
    running.set({"pull": 5.0})
    assert running.step(0.0, 1.0) == DISCARD
    assert not running.ended()
    assert running.real_status() == (OK, 0.0)
    assert running.step(0.0, 0.5) == ERROR
    assert running.restore(state) == OK
    assert running.step(0.0, 0.5) == OK
    running.drop(state)


def test_an_error_breaks_the_instance_until_it_is_reset(running, built_toy):
    running.set({"pull": 6.0})
    assert running.step(0.0, 1.0) == ERROR
    assert "the cart broke under (pull, value 6, at 0 s)" in running.last
    assert running.step(0.0, 1.0) == ERROR
    value = doubles(0.0)
    assert running.call("GetReal", references(built_toy.references["x"]), Count(1), value) == WARNING
    assert running.said[-1][1] == "logStatusWarning"
    assert running.call("Reset") == OK
    assert running.start() == OK
    assert running.step(0.0, 1.0) == OK


DIGIT = math.ulp(6000.0)


@pytest.mark.parametrize("back", [20, 4, 2])
def test_a_step_shorter_than_the_rounding_behind_it_is_none(make, back):
    """In last digits of the time. The FMU is ahead of its master then, and lets it come."""
    raw = make()
    raw.start({"push": 1.0})
    assert raw.step(0.0, 6000.0) == OK
    before = raw.get("x", "y")
    assert raw.ramp("push", 0.5) == OK
    assert raw.step(6000.0 - back * DIGIT, 2.0 * DIGIT) == OK
    assert raw.get("steps", kind="Integer") == 1
    assert raw.get("x", "y") == before
    assert raw.output_rate("y") == (OK, 1.0)  # the ramp went with its step
    assert raw.step(6000.0 - (back - 2) * DIGIT, 2.0) == OK
    assert raw.get("x") == pytest.approx(6002.0 - (back - 2) * DIGIT, abs=DIGIT)
    assert raw.get("steps", kind="Integer") == 2


def test_a_step_that_reaches_beyond_the_rounding_is_made(make):
    """The twin."""
    raw = make()
    raw.start({"push": 1.0})
    raw.step(0.0, 6000.0)
    assert raw.step(6000.0 - 20 * DIGIT, 40 * DIGIT) == OK
    assert raw.get("x") == pytest.approx(6000.0 + 20 * DIGIT, abs=DIGIT)
    assert raw.step(6000.0 - 10 * DIGIT, 2 * DIGIT) == ERROR


@pytest.mark.parametrize("begin", [0.0, 6e3, 1e6, 1e9, -1e6])
def test_a_master_that_stands_still_is_told_so_at_any_time(make, begin):
    """A thousand steps of 1 ms from one and the same time: answered OK, they would not move."""
    raw = make()
    raw.start({"push": 1.0, "end": 2e9}, begin=begin)
    assert raw.step(begin, 1e-3) == OK
    for wrong in (begin, begin + 2e-3, begin + 0.99e-3, begin + 1.01e-3):
        assert raw.step(wrong, 1e-3) == ERROR, wrong
        assert "the FMU stands at" in raw.last
    for k in range(1, 1000):
        assert raw.step(begin + k * 1e-3, 1e-3) == OK
    assert raw.get("steps", kind="Integer") == 1000
    assert raw.get("x") == pytest.approx(1.0, abs=1e-3 * abs(begin) * 1e-9 + 1e-12)


@pytest.mark.parametrize("begin", [0.0, 1e6, 1e7])
def test_times_that_a_master_adds_up_are_taken(make, begin):
    """By t += h, and as i h; a master whose clock counts nanoseconds is off by that of a step of 1 ms."""
    for times in ("added", "multiplied", "nanoseconds"):
        raw = make()
        raw.start({"push": 1.0, "end": 2e9}, begin=begin, stop=begin + 1.0)
        time = begin
        for k in range(1000):
            assert raw.step(time, 1e-3) == OK, raw.last
            time = time + 1e-3 if times == "added" else begin + (k + 1) * 1e-3
            time = round(time, 9) if times == "nanoseconds" else time
        assert raw.get("steps", kind="Integer") == 1000


@pytest.mark.parametrize("stop", [1.0, 1e6, 1e9])
def test_a_step_beyond_the_stop_is_refused_at_any_time(make, stop):
    raw = make()
    raw.start(stop=stop)
    assert raw.step(0.0, stop - 1e-3) == OK
    assert raw.step(raw.real_status()[1], 2e-3) == ERROR
    assert "beyond the stop time" in raw.last
    assert raw.step(raw.real_status()[1], 1e-3) == OK
    assert raw.step(raw.real_status()[1], 1e-3) == ERROR


def test_the_stop_time_holds(make):
    raw = make()
    raw.start(stop=1.0)
    assert raw.step(0.0, 0.5) == OK
    assert raw.step(0.5, 0.6) == ERROR
    assert "beyond the stop time" in raw.last
    assert raw.step(0.5, 0.5 + 1e-10) == OK  # masters that add up times drift
    assert raw.step(1.0, 0.1) == ERROR
    late = make()
    assert late.call("SetupExperiment", False, 0.0, 1.0, True, 0.5) == ERROR
    free = make()
    free.start()
    assert free.step(0.0, 100.0) == OK


@pytest.mark.parametrize(("time", "size"), [(1.0, 1.0), (0.0, -1.0), (math.nan, 1.0), (0.0, math.nan), (0.0, math.inf)])
def test_a_step_that_can_not_be_is_refused(running, time, size):
    assert running.step(time, size) == ERROR
    assert running.step(0.0, 0.0) == OK
    assert running.get("steps", kind="Integer") == 0
