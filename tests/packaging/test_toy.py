"""The shim alone, on a toy whose kernel is known in closed form: every call in every phase, derivatives, ends, log."""

import ctypes
import math

import pytest

from tests.packaging.raw import DISCARD, ERROR, OK, WARNING, Count, Library, Raw, doubles, integers, references

NULL = ctypes.c_void_p()


@pytest.fixture(scope="module")
def toy(built_toy):
    return built_toy


@pytest.fixture(scope="module")
def library(toy):
    return Library(toy.library)


@pytest.fixture
def make(toy, library):
    made = []

    def new(**more):
        made.append(Raw(library, toy.guid, toy.references, **more))
        return made[-1]

    yield new
    for raw in made:
        raw.free()


@pytest.fixture
def running(make):
    raw = make()
    assert raw.start() == OK
    return raw


# ---- values -------------------------------------------------------------------------------------------------------


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


def test_a_call_sets_all_or_nothing(running, toy):
    both = references(toy.references["push"], toy.references["gain"])
    assert running.call("SetReal", both, Count(2), doubles(7.0, 1.0)) == ERROR
    assert running.get("push") == 0.0


@pytest.mark.parametrize("reference", [0, 5, 10, 29, 10**6, 2**32 - 1])
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
    assert running.output_rate("x", order=2)[0] == ERROR
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


# ---- ends and refusals ----------------------------------------------------------------------------------------------


def test_the_models_own_end_is_a_discard_with_terminated_and_time(make):
    raw = make()
    raw.start({"end": 1.25})
    assert raw.step(0.0, 1.0) == OK
    assert not raw.ended()
    assert raw.step(1.0, 1.0) == DISCARD
    assert raw.said[-1] == (DISCARD, "logStatusDiscard", "the cart has arrived (index 0, value 0, at 1.25 s)")
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


def test_an_error_breaks_the_instance_until_it_is_reset(running, toy):
    running.set({"pull": 6.0})
    assert running.step(0.0, 1.0) == ERROR
    assert "the cart broke under (pull, value 6, at 0 s)" in running.last
    assert running.step(0.0, 1.0) == ERROR
    value = doubles(0.0)
    assert running.call("GetReal", references(toy.references["x"]), Count(1), value) == WARNING
    assert running.said[-1][1] == "logStatusWarning"
    assert running.call("Reset") == OK
    assert running.start() == OK
    assert running.step(0.0, 1.0) == OK


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


# ---- order of calls -------------------------------------------------------------------------------------------------

PHASES = ("instantiated", "initialising", "stepping", "discarded", "terminated", "broken")
"""Columns of the table of allowed calls in section 4.2.4 of the standard: a letter for each phase it is allowed in."""
CALLS = {
    "SetupExperiment": ("i", (False, 0.0, 0.0, False, 0.0)),
    "EnterInitializationMode": ("i", ()),
    "ExitInitializationMode": ("n", ()),
    "Terminate": ("sd", ()),
    "Reset": ("insdtb", ()),
    "SetDebugLogging": ("insdtb", (True, Count(0), None)),
    "GetReal": ("nsdtb", (references(13), Count(1), doubles(0.0))),
    "GetInteger": ("nsdtb", (references(21), Count(1), integers(0))),
    "GetBoolean": ("nsdtb", (references(19), Count(1), integers(0))),
    "GetString": ("nsdtb", (None, Count(0), None)),
    "SetReal": ("ins", (references(9), Count(1), doubles(0.0))),
    "SetBoolean": ("ins", (references(12), Count(1), integers(0))),
    "SetInteger": ("in", (references(8), Count(1), integers(2))),
    "SetString": ("ins", (None, Count(0), None)),
    "SetRealInputDerivatives": ("ins", (references(9), Count(1), integers(1), doubles(0.0))),
    "GetRealOutputDerivatives": ("sdt", (references(13), Count(1), integers(1), doubles(0.0))),
    "GetDirectionalDerivative": (
        "nsdt",
        (references(15), Count(1), references(9), Count(1), doubles(1.0), doubles(0.0)),
    ),
    "GetFMUstate": ("insdtb", (ctypes.byref(ctypes.c_void_p()),)),
    "DoStep": ("s", (0.0, 0.0, True)),
    "GetRealStatus": ("sdt", (2, ctypes.byref(ctypes.c_double()))),
    "GetBooleanStatus": ("sdt", (3, ctypes.byref(ctypes.c_int()))),
    "CancelStep": ("", ()),
    "EnterEventMode": ("", ()),
    "SetTime": ("", (0.0,)),
    "GetDerivatives": ("", (doubles(0.0), Count(1))),
}


def bring_to(raw, phase):
    """Take an instance into a phase."""
    if phase == "instantiated":
        return
    raw.call("EnterInitializationMode")
    if phase == "initialising":
        return
    raw.call("ExitInitializationMode")
    if phase in ("discarded", "broken"):
        raw.set({"pull": 5.0 if phase == "discarded" else 6.0})
        raw.step(0.0, 1.0)
    elif phase == "terminated":
        raw.call("Terminate")


@pytest.mark.parametrize("phase", PHASES)
@pytest.mark.parametrize("name", CALLS)
def test_each_call_is_allowed_in_its_phases_only(make, name, phase):
    raw = make()
    bring_to(raw, phase)
    letters, arguments = CALLS[name]
    letter = {"instantiated": "i", "initialising": "n"}.get(phase, phase[0])
    status = raw.call(name, *arguments)
    assert (status <= WARNING) == (letter in letters), raw.said
    if letter not in letters:
        assert raw.said[-1][0] == ERROR
        assert raw.last


def test_everything_is_there_and_takes_a_null_instance(library, make):
    """Every function of fmi2Functions.h is exported; none falls over without an instance."""
    from fmu_src.packaging import link

    text = (link.HEADERS / "fmi2FunctionTypes.h").read_text()
    import re

    names = re.findall(r"fmi2Status\s+fmi2(\w+)TYPE", text)
    assert len(names) > 35
    for name in names:
        assert library.call(name, NULL, *[NULL] * 7) == ERROR, name
    library.call("FreeInstance", NULL)
    assert library.call("GetVersion") == b"2.0"
    assert library.call("GetTypesPlatform") == b"default"


def test_null_arrays_are_refused(running):
    for name, arguments in {
        "GetReal": (None, Count(1), doubles(0.0)),
        "SetReal": (references(9), Count(1), None),
        "GetBoolean": (references(19), Count(1), None),
        "SetDebugLogging": (True, Count(1), None),
        "SetRealInputDerivatives": (references(9), Count(1), None, doubles(0.0)),
        "GetRealOutputDerivatives": (references(13), Count(1), integers(1), None),
        "GetDirectionalDerivative": (references(15), Count(1), None, Count(1), doubles(0.0), doubles(0.0)),
        "GetFMUstate": (None,),
        "SetFMUstate": (None,),
        "GetRealStatus": (2, None),
        "DeSerializeFMUstate": (None, Count(200), ctypes.byref(ctypes.c_void_p())),
        "SerializedFMUstateSize": (None, ctypes.byref(ctypes.c_size_t())),
    }.items():
        assert running.call(name, *arguments) == ERROR, name
    assert running.step(0.0, 1.0) == OK


def test_an_instance_needs_neither_callbacks_nor_name_but_the_guid(library, toy, make):
    bare = library.call("Instantiate", None, 1, toy.guid.encode(), None, None, False, True)
    assert bare
    assert library.call("DoStep", ctypes.c_void_p(bare), 0.0, 1.0, True) == ERROR
    library.call("FreeInstance", ctypes.c_void_p(bare))
    other = Raw(library, "{other}", toy.references)
    assert not other.component
    assert "the GUID {other} is not that of this binary, {toy}" in other.last
    exchange = Raw(library, toy.guid, toy.references, kind=0)
    assert not exchange.component
    assert "co-simulation only" in exchange.last
    assert not library.call("Instantiate", None, 1, None, None, None, False, True)


# ---- log ------------------------------------------------------------------------------------------------------------


def provoke(raw):
    """One message of each category, from a fresh start; the categories heard."""
    raw.said.clear()
    raw.call("Reset")
    raw.start()
    raw.set({"pull": 5.0})
    raw.step(0.0, 1.0)
    raw.call("Reset")
    raw.start({"pull": 6.0})
    raw.step(0.0, 1.0)
    raw.call("GetReal", references(13), Count(1), doubles(0.0))
    return {category for _, category, _ in raw.said}


def choose(raw, on, *categories):
    names = (ctypes.c_char_p * len(categories))(*(c.encode() for c in categories))
    return raw.call("SetDebugLogging", on, Count(len(categories)), names)


def test_log_categories_are_honoured(make):
    every = {"logStatusError", "logStatusDiscard", "logStatusWarning", "logEvents"}
    assert provoke(make()) == every
    quiet = make(logging=False)
    assert provoke(quiet) == {"logStatusError", "logStatusDiscard"}  # why something failed is told in any case
    for name in every:
        assert choose(quiet, True, name) == OK
        assert provoke(quiet) == {name}
    choose(quiet, True, "logEvents", "logStatusError")
    assert provoke(quiet) == {"logEvents", "logStatusError"}
    choose(quiet, True, "logAll")
    assert provoke(quiet) == every
    choose(quiet, False)
    assert provoke(quiet) == set()
    choose(quiet, True)
    assert provoke(quiet) == every
    assert any(text.startswith("initialised at 0 s") for _, _, text in quiet.said)


def test_an_unknown_category_is_an_error_and_changes_nothing(make):
    raw = make()
    assert choose(raw, False, "logEvents", "logMagic") == ERROR
    assert "there is no log category logMagic" in raw.last
    assert len(provoke(raw)) == 4


# ---- state ----------------------------------------------------------------------------------------------------------


def test_a_state_carries_everything_even_to_another_instance(make):
    one = make()
    one.start({"room": 50, "end": 3.0}, stop=9.0)
    one.set({"push": 1.5, "go": True})
    one.step(0.0, 1.0)
    one.ramp("push", 1.0)
    data = one.serialise(one.save())
    one.step(1.0, 1.0)
    two = make()
    status, state = two.deserialise(data)
    assert status == OK
    assert two.restore(state) == OK
    assert two.step(1.0, 1.0) == OK
    assert two.get("x", "y", "sum", "push") == one.get("x", "y", "sum", "push")
    assert two.step(2.0, 2.0) == DISCARD  # the end came along
    two.drop(state)


def damaged(data, at, new):
    return data[:at] + new + data[at + len(new) :]


def test_a_damaged_state_is_refused_wherever_it_is_damaged(make):
    raw = make()
    raw.start({"room": 7})
    state = raw.save()
    data = raw.serialise(state)
    assert len(data) == 144 + 8 * (29 + 7)
    for at in range(0, len(data), 3):
        status, other = raw.deserialise(damaged(data, at, bytes([data[at] ^ 0x41])))
        assert status == ERROR, at
        assert not other.value
    for size in (0, 1, 143, 144, len(data) - 1, len(data) - 8):
        assert raw.deserialise(data[:size])[0] == ERROR
    assert raw.deserialise(data + b"\0" * 8)[0] == ERROR
    for at, words in ((0, "no saved state"), (16, "belongs to the FMU"), (64, "version"), (72, "phase"), (120, "size")):
        raw.deserialise(damaged(data, at, (2**40 + 3).to_bytes(8, "little")))
        assert words in raw.last, at
    assert raw.deserialise(data)[0] == OK  # the twin: as it was, it is taken
    raw.drop(state)


def test_a_state_in_memory_is_checked_too(make):
    raw = make()
    raw.start()
    state = raw.save()
    memory = (ctypes.c_char * 144).from_address(state.value)
    whole = memory.raw
    for at, words in (
        (0, "no saved state"),
        (16, "belongs to the FMU"),
        (64, "version"),
        (72, "phase"),
        (120, "memory"),
    ):
        memory[:] = damaged(whole, at, (33).to_bytes(8, "little"))
        assert raw.restore(state) == ERROR
        assert words in raw.last, at
    memory[:] = whole
    assert raw.restore(state) == OK
    too_small = ctypes.create_string_buffer(10)
    assert raw.call("SerializeFMUstate", state, too_small, Count(10)) == ERROR
    raw.drop(state)
    assert not state.value
    assert raw.drop(state) == OK


def test_reset_is_a_fresh_instance_bit_for_bit(make):
    used, fresh = make(), make()
    used.start({"room": 90, "gain": 7.0}, stop=5.0)
    used.set({"push": 3.0, "go": True})
    used.ramp("push", 1.0)
    used.step(0.0, 1.0)
    used.call("Reset")
    assert used.serialise(used.save()) == fresh.serialise(fresh.save())
    used.set({"gain": 7.0})
    assert used.serialise(used.save()) != fresh.serialise(fresh.save())
