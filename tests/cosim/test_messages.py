"""What an error quotes of an FMU: the words of the call that failed, the gravest first."""

from __future__ import annotations

from pathlib import Path

import fmpy.fmi2 as fmi2
import pytest

from dcone_cosim.errors import FmuError
from dcone_cosim.fmu.archive import Archive
from dcone_cosim.fmu.component import CallError, Component
from dcone_cosim.fmu.isolation import IsolatedComponent
from dcone_cosim.fmu.messages import Messages
from tests.cosim.fmus.build import build


@pytest.mark.parametrize(
    ("said", "words"),
    [
        ([], "the FMU gave no message"),
        ([(0, "hello"), (0, "")], "hello"),
        ([(0, "hello"), (1, "hot"), (3, "jammed"), (1, "hotter")], "jammed; hot; hotter"),
        ([(3, "jammed"), (1, "a"), (1, "b"), (1, "c")], "jammed; b; c"),
        ([(1, "hot"), (3, "first"), (3, "second"), (3, "third"), (3, "fourth")], "second; third; fourth"),
        ([(2, "too long"), (4, "ruins"), (3, "jammed")], "ruins; jammed; too long"),
        ([(77, "odd"), (0, "hello"), (1, "hot")], "odd; hot"),
    ],
)
def test_the_gravest_come_first(said: list[tuple[int, str]], words: str) -> None:
    messages = Messages()
    for status, text in said:
        messages.add(status, text)
    assert messages.words() == words
    messages.close()


@pytest.mark.parametrize("isolate", [False, True])
def test_a_refusal_is_not_blamed_on_an_earlier_call(tmp_path: Path, isolate: bool) -> None:
    """The FMU says "old news" while it is initialised."""
    with (
        Archive(build(tmp_path)) as archive,
        IsolatedComponent(archive, "tow") if isolate else Component(archive, "tow") as component,
    ):
        component.initialise(0.0)
        with pytest.raises(CallError) as caught:
            component.set({"tether.rest_length": 3.0})
        assert caught.value.said == "fmi2SetReal: no such Real can be set now"


def test_a_crash_is_not_blamed_on_an_earlier_call(tmp_path: Path) -> None:
    with Archive(build(tmp_path, "removal", "CRASH")) as archive, IsolatedComponent(archive, "tow") as component:
        component.initialise(0.0)
        with pytest.raises(CallError) as caught:
            component.step(45.0, 10.0)
        assert caught.value.said == "its process was ended by SIGSEGV; its last words: about to follow a bad pointer"


@pytest.mark.parametrize("isolate", [False, True])
def test_a_guid_of_another_build_is_named(tmp_path: Path, isolate: bool) -> None:
    with Archive(build(tmp_path, change=lambda xml: xml.replace('guid="', 'guid="other-'))) as archive:
        with pytest.raises(FmuError, match="tow could not be instantiated") as caught:
            IsolatedComponent(archive, "tow") if isolate else Component(archive, "tow")
        told = f"the guid {archive.guid!r} of its modelDescription.xml is not in its binary"
        assert told in str(caught.value)
        assert f"the guid given is {archive.guid}, that of this binary is {archive.guid[6:]}" in str(caught.value)
    with Archive(build(tmp_path, "removal", "REFUSES_WITHOUT_A_WORD")) as archive:
        with pytest.raises(FmuError, match="the FMU gave no message\n") as caught:
            Component(archive, "tow")
        assert "guid" not in str(caught.value)


@pytest.mark.parametrize(
    ("name", "kind", "value", "expected"),
    [
        ("start.condition", "Integer", 2.7, "a whole number of 32 bits, got 2.7"),
        ("start.condition", "Integer", float("nan"), "a whole number of 32 bits, got nan"),
        ("start.condition", "Integer", 2.0**31, "a whole number of 32 bits, got 2147483648.0"),
        ("start.condition", "Boolean", 0.5, "true or false, got 0.5"),
    ],
)
@pytest.mark.parametrize("isolate", [False, True])
def test_a_value_that_the_kind_cannot_hold(
    tmp_path: Path, isolate: bool, name: str, kind: str, value: float, expected: str
) -> None:
    def change(xml: str) -> str:
        return xml.replace("<Integer start", f"<{kind} start") if kind == "Boolean" else xml

    with Archive(build(tmp_path, change=change)) as archive:
        assert archive.variables[name].kind == kind
        with IsolatedComponent(archive, "tow") if isolate else Component(archive, "tow") as component:
            with pytest.raises(FmuError) as caught:
                component.set({"tether.rest_length": 7.0, name: value})
            assert str(caught.value) == f"tow: {name} is of kind {kind}; expected {expected}"
            assert component.get(["tether.rest_length"]) != {"tether.rest_length": 7.0}
            if kind == "Integer":
                component.set({name: 1.0})
                assert component.get([name]) == {name: 1.0}


def test_a_text_is_not_dropped_without_a_word(tmp_path: Path) -> None:
    note = (
        '<ScalarVariable name="note" valueReference="900" causality="parameter" variability="fixed">'
        '<String start="hello"/></ScalarVariable></ModelVariables>'
    )
    fmu = build(tmp_path, change=lambda xml: xml.replace("</ModelVariables>", note))
    with (
        Archive(fmu) as archive,
        Component(archive, "tow") as component,
        pytest.raises(FmuError, match="note is a String; only numbers can be set"),
    ):
        component.set({"note": 1.0})


def test_statuses_are_those_of_fmi() -> None:
    """The numbers above."""
    assert (fmi2.fmi2OK, fmi2.fmi2Warning, fmi2.fmi2Discard, fmi2.fmi2Error, fmi2.fmi2Fatal) == (0, 1, 2, 3, 4)
