"""The shim alone, on the toy: the order of calls, NULL for everything that may be NULL, and the log."""

import ctypes
import re

import pytest

from fmu_src.packaging import link
from tests.packaging import toy
from tests.packaging.raw import ERROR, OK, WARNING, Count, Raw, doubles, integers, references

NULL = ctypes.c_void_p()


def at(name):
    """The value reference of a variable of the toy, as an array of one."""
    return references(toy.INTERFACE.references[name])


PHASES = ("instantiated", "initialising", "stepping", "discarded", "terminated", "broken")
"""Columns of the table of allowed calls in section 4.2.4 of the standard: a letter for each phase it is allowed in."""
CALLS = {
    "SetupExperiment": ("i", (False, 0.0, 0.0, False, 0.0)),
    "EnterInitializationMode": ("i", ()),
    "ExitInitializationMode": ("n", ()),
    "Terminate": ("sd", ()),
    "Reset": ("insdtb", ()),
    "SetDebugLogging": ("insdtb", (True, Count(0), None)),
    "GetReal": ("nsdtb", (at("x"), Count(1), doubles(0.0))),
    "GetInteger": ("nsdtb", (at("steps"), Count(1), integers(0))),
    "GetBoolean": ("nsdtb", (at("lit"), Count(1), integers(0))),
    "GetString": ("nsdtb", (None, Count(0), None)),
    "SetReal": ("ins", (at("push"), Count(1), doubles(0.0))),
    "SetBoolean": ("ins", (at("go"), Count(1), integers(0))),
    "SetInteger": ("in", (at("room"), Count(1), integers(2))),
    "SetString": ("ins", (None, Count(0), None)),
    "SetRealInputDerivatives": ("ins", (at("push"), Count(1), integers(1), doubles(0.0))),
    "GetRealOutputDerivatives": ("sdt", (at("x"), Count(1), integers(1), doubles(0.0))),
    "GetDirectionalDerivative": (
        "nsdt",
        (at("y"), Count(1), at("push"), Count(1), doubles(1.0), doubles(0.0)),
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
    text = (link.HEADERS / "fmi2FunctionTypes.h").read_text()
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
        "SetReal": (at("push"), Count(1), None),
        "GetBoolean": (at("lit"), Count(1), None),
        "SetDebugLogging": (True, Count(1), None),
        "SetRealInputDerivatives": (at("push"), Count(1), None, doubles(0.0)),
        "GetRealOutputDerivatives": (at("x"), Count(1), integers(1), None),
        "GetDirectionalDerivative": (at("y"), Count(1), None, Count(1), doubles(0.0), doubles(0.0)),
        "GetFMUstate": (None,),
        "SetFMUstate": (None,),
        "GetRealStatus": (2, None),
        "DeSerializeFMUstate": (None, Count(200), ctypes.byref(ctypes.c_void_p())),
        "SerializedFMUstateSize": (None, ctypes.byref(ctypes.c_size_t())),
    }.items():
        assert running.call(name, *arguments) == ERROR, name
    assert running.step(0.0, 1.0) == OK


def test_an_instance_needs_neither_callbacks_nor_name_but_the_guid(library, built_toy, make):
    bare = library.call("Instantiate", None, 1, built_toy.guid.encode(), None, None, False, True)
    assert bare
    assert library.call("DoStep", ctypes.c_void_p(bare), 0.0, 1.0, True) == ERROR
    library.call("FreeInstance", ctypes.c_void_p(bare))
    other = Raw(library, "{other}", built_toy.references)
    assert not other.component
    assert "the GUID {other} is not that of this FMU, {toy}" in other.last
    exchange = Raw(library, built_toy.guid, built_toy.references, kind=0)
    assert not exchange.component
    assert "co-simulation only" in exchange.last
    assert not library.call("Instantiate", None, 1, None, None, None, False, True)


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
    raw.call("GetReal", at("x"), Count(1), doubles(0.0))
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
