"""The C template's own promises: whose states it takes, and which messages it sends."""

from __future__ import annotations

import ctypes
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import fmpy.fmi2 as fmi2
import pytest

from dcone_cosim.fmu.archive import XML, Archive
from dcone_cosim.fmu.component import CallError, Component
from dcone_cosim.interface_kit import write_template
from dcone_cosim.phases.capture_loop import CaptureLoop, CapturePlan
from dcone_cosim.progress import Progress
from fmu_src.packaging.sources import SHIM
from tests.cosim.fmus.build import HEADERS, build

VERSION = 0
"""Where a serialised state has its version, a double."""


@pytest.fixture
def tow(tmp_path: Path) -> Iterator[Component]:
    with Archive(build(tmp_path)) as archive, Component(archive, "tow") as component:
        yield component


def serialised(component: Component) -> bytes:
    component.save()
    return bytes(component._fmu.serializeFMUstate(component._states[""]))


def take(component: Component, state: bytes) -> None:
    found = fmi2.fmi2FMUstate()
    data = (ctypes.c_char * len(state)).from_buffer_copy(state)
    component._call("fmi2DeSerializeFMUstate", component._fmu.component, data, len(state), ctypes.byref(found))
    component._states["taken"] = found
    component._times["taken"], component._steps_of["taken"] = 0.0, 0
    component.restore("taken")


def test_its_own_state_comes_back(tow: Component) -> None:
    """The twin of those below."""
    tow.set({"start.relative_velocity[1]": 1.0})
    tow.initialise(0.0)
    tow.step(0.0, 10.0)
    state, before = serialised(tow), tow.get(["separation", "relative.position[1]"])
    tow.step(10.0, 10.0)
    assert tow.get(["separation", "relative.position[1]"]) != before
    take(tow, state)
    assert tow.get(["separation", "relative.position[1]"]) == before


@pytest.mark.parametrize("what", ["guid", "version", "phase", "length"])
def test_a_state_of_another_is_refused(tow: Component, what: str) -> None:
    tow.initialise(0.0)
    state = bytearray(serialised(tow))
    guid = state.index(tow.archive.guid.encode())
    if what == "guid":
        state[guid] ^= 1
    elif what == "version":
        state[VERSION : VERSION + 8] = bytes(ctypes.c_double(2.0))
    elif what == "phase":
        state[guid - 8 : guid - 4] = bytes(ctypes.c_int(17))
    else:
        del state[-8:]
    with pytest.raises(CallError, match="these bytes are"):
        take(tow, bytes(state))


def heard(component: Component, on: bool, *categories: str) -> list[str]:
    """What it says at a step that is not allowed, and at its beginning: an error, and a warning."""
    names = (ctypes.c_char_p * len(categories))(*(name.encode() for name in categories))
    component._call("fmi2SetDebugLogging", component._fmu.component, int(on), len(categories), names)
    said: list[str] = []
    component._messages.add = lambda status, text: said.append(text)  # type: ignore[method-assign]
    component.initialise(0.0)
    with pytest.raises(CallError):
        component.enter_initialisation(0.0)
    return said


@pytest.mark.parametrize(
    ("on", "categories", "words"),
    [
        (True, (), ["old news", "fmi2SetupExperiment is not allowed now"]),
        (True, ("logAll",), ["old news", "fmi2SetupExperiment is not allowed now"]),
        (True, ("logStatusWarning",), ["old news"]),
        (True, ("logStatusError", "logEvents"), ["fmi2SetupExperiment is not allowed now"]),
        (False, (), []),
    ],
)
def test_it_says_what_was_asked_for(tow: Component, on: bool, categories: tuple[str, ...], words: list[str]) -> None:
    assert heard(tow, on, *categories) == words


def test_an_unknown_category_is_refused(tow: Component) -> None:
    with pytest.raises(CallError, match="there is no log category logEverything"):
        heard(tow, True, "logEverything")


def test_every_function_of_fmi_2_can_be_looked_up(tow: Component) -> None:
    """Those of model exchange refuse, and say why."""
    exported = set(re.findall(r"FMI2_Export fmi2\w+TYPE\s+(fmi2\w+);", (HEADERS / "fmi2Functions.h").read_text()))
    assert len(exported) > 40
    assert [name for name in sorted(exported) if not hasattr(tow._fmu.dll, name)] == []
    said: list[str] = []
    tow._messages.add = lambda status, text: said.append(text)  # type: ignore[method-assign]
    refused = tow._fmu.dll.fmi2EnterEventMode
    refused.argtypes = [ctypes.c_void_p]
    assert refused(tow._fmu.component) == fmi2.fmi2Error
    assert said == ["fmi2EnterEventMode: this FMU is for co-simulation only"]


def test_what_it_shares_is_ours(tmp_path: Path) -> None:
    write_template("removal", "c", tmp_path / "kit")
    sources = [path for path in sorted((tmp_path / "kit").iterdir()) if path.suffix in (".c", ".h")]
    shared = [path for path in sources if (SHIM / path.name).is_file()]
    assert [path.name for path in shared] == ["fmi2_absent.h", "fmi2_log.h"]
    assert [path.read_bytes() for path in shared] == [(SHIM / path.name).read_bytes() for path in shared]


def test_without_logging_errors_are_still_told(tmp_path: Path) -> None:
    said: list[tuple[str, str]] = []

    def log(_: Any, instance: bytes, status: int, category: bytes, message: bytes) -> None:
        said.append((category.decode(), message.decode()))

    with Archive(build(tmp_path)) as archive:
        listed = ElementTree.parse(archive.folder / XML).iterfind("LogCategories/Category")  # type: ignore[operator]
        slave = fmi2.FMU2Slave(
            guid=archive.guid, unzipDirectory=str(archive.folder), modelIdentifier=archive.identifier, instanceName="a"
        )
        callbacks = fmi2.fmi2CallbackFunctions()
        callbacks.logger = fmi2.fmi2CallbackLoggerTYPE(log)
        slave.instantiate(callbacks=callbacks, loggingOn=False)
        slave.setupExperiment(startTime=0.0)
        slave.enterInitializationMode()
        slave.exitInitializationMode()
        with pytest.raises(Exception, match="fmi2SetupExperiment"):
            slave.setupExperiment(startTime=0.0)
        slave.freeInstance()
        assert [category for category, _ in said] == ["logStatusError"]
        assert {"logStatusError", "logStatusDiscard", "logStatusWarning", "logEvents", "logAll"} == {
            category.get("name") for category in listed
        }


@pytest.mark.parametrize("start", [0.0, 100.0, -50.0])
def test_a_capture_at_any_start_time(tmp_path: Path, start: float) -> None:
    """Its net flies 16 m at 3 m/s, and `t_capture` counts from the shot."""
    with Archive(build(tmp_path, "capture")) as archive, Component(archive, "shot") as component:
        component.initialise(start)
        result = CaptureLoop(component, CapturePlan(0.5, 20.0, stop_there=True, start=start), Progress()).run()
    assert result.error is None
    assert result.located == pytest.approx(16.0 / 3.0, rel=1e-14)
    assert "t_capture" in result.located_by
    assert result.recorder["time"].tolist() == [0.5 * i for i in range(11)] + [result.located]
    assert result.recorder["catch.position[2]"][10] == pytest.approx(-1.0, abs=1e-12)
