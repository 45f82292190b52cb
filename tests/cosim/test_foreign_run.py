"""FMUs that go wrong, swapped in: one clear error each, with what was reached before it intact."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from dcone_cosim.contract import check_contract
from dcone_cosim.errors import FMU_FAILED, HANDOFF_FAILED, SUCCESS, FmuError, InputError
from dcone_cosim.fmu.archive import Archive
from dcone_cosim.fmu.component import CallError, Component, Terminated
from dcone_cosim.fmu.isolation import IsolatedComponent
from dcone_cosim.master import run_scene
from dcone_cosim.phases import kinds
from dcone_cosim.phases.capture import CaptureOptions
from dcone_cosim.phases.capture_loop import CaptureLoop, CapturePlan
from dcone_cosim.progress import Progress
from dcone_cosim.reports import summary
from dcone_cosim.results import RunResult
from dcone_cosim.scene.data import Scene
from tests.cosim.fmus.build import build
from tests.cosim.mock_components import MockCapture
from tests.cosim.written import write

HANDS_OVER = kinds()["removal"].takes
"""What a capture hands over to a removal."""

Make = Callable[..., Scene]
ISOLATED, HERE = True, False


def swap_in(scene: Scene, removal: Path, isolate: bool = HERE, timeout: float = 20.0) -> RunResult:
    """The scene with a mock capture, and this FMU for the removal."""
    with Archive(removal) as archive:

        def instantiate(phase: str, name: str):
            if phase == "capture":
                return MockCapture(reports=True)
            return IsolatedComponent(archive, name, timeout) if isolate else Component(archive, name)

        return run_scene(scene, instantiate, Progress())


def test_a_sound_one_tows(make_scene: Make, tmp_path: Path) -> None:
    """The twin of all below: without a switch the same FMU runs to the end, and isolated with the same bits."""
    fmu = build(tmp_path)
    here, isolated = (swap_in(make_scene("capture", "removal"), fmu, isolate) for isolate in (HERE, ISOLATED))
    assert here.exit_code == isolated.exit_code == SUCCESS, here.message
    assert here.phases["removal"].outcome == "completed"
    assert here.handovers["removal"] is not None
    assert next(check.quantity for check in here.handovers["removal"].checks) == "separation"
    for name in here.phases["removal"].recorder.names:
        np.testing.assert_array_equal(here.phases["removal"].recorder[name], isolated.phases["removal"].recorder[name])


@pytest.mark.parametrize("isolate", [HERE, ISOLATED])
def test_a_call_refused_later_quotes_no_old_words(tmp_path: Path, isolate: bool) -> None:
    """It warned as it began; what it says of a variable it does not know is all that is told of that call."""

    def elsewhere(xml: str) -> str:
        for name in ("separation", "target.mass"):
            xml = re.sub(rf'name="{name}" valueReference="\d+"', f'name="{name}" valueReference="900"', xml)
        return xml

    for call in (lambda it: it.get(["separation"]), lambda it: it.set({"target.mass": 1.0})):
        with Archive(build(tmp_path, change=elsewhere)) as archive:
            component = IsolatedComponent(archive, "towing") if isolate else Component(archive, "towing")
            with component:
                component.initialise(0.0)
                with pytest.raises(CallError) as caught:
                    call(component)
        assert "old news" not in str(caught.value)
        assert "gave no message" not in str(caught.value)


def test_what_is_no_number_is_left_alone(make_scene: Make, tmp_path: Path) -> None:
    """A String parameter and an Enumeration beside what the master knows."""

    def change(xml: str) -> str:
        more = (
            '<ScalarVariable name="note" valueReference="900" causality="parameter" variability="fixed">'
            '<String start="hello"/></ScalarVariable>'
            '<ScalarVariable name="mode" valueReference="14" causality="parameter" variability="fixed">'
            '<Enumeration declaredType="modes" start="1"/></ScalarVariable>'
        )
        modes = '<SimpleType name="modes"><Enumeration><Item name="on" value="1"/></Enumeration></SimpleType>'
        xml = xml.replace("<LogCategories>", f"<TypeDefinitions>{modes}</TypeDefinitions><LogCategories>")
        return xml.replace("</ModelVariables>", f"{more}</ModelVariables>")

    with Archive(build(tmp_path, change=change)) as archive:
        assert archive.variables["note"].kind == "String"
        assert archive.variables["mode"].kind == "Integer"
        result = run_scene(make_scene("removal"), lambda _, name: Component(archive, name), Progress())
    assert result.exit_code == SUCCESS
    assert "mode" in result.parameters["removal"]
    assert "note" not in result.parameters["removal"]


@pytest.mark.parametrize(
    ("switch", "isolate", "words"),
    [
        ("CRASH", ISOLATED, ["ended by SIGSEGV", "about to follow a bad pointer"]),
        ("ABORT", ISOLATED, ["ended by SIGABRT"]),
        ("EXIT=3", ISOLATED, ["ended itself with exit code 3"]),
        ("EXIT=0", ISOLATED, ["ended itself with exit code 0"]),
        ("HANG", ISOLATED, ["did not answer within 2 s and was killed"]),
        ("NOT_A_NUMBER=SEPARATION", HERE, ["its output separation is nan"]),
        ("NOT_A_NUMBER=SEPARATION", ISOLATED, ["its output separation is nan"]),
        ("INFINITE=RELATIVE_POSITION_2", HERE, ["its output relative.position[2] is -inf"]),
        ("ERROR", HERE, ["the winch jammed", "gave Error"]),
        ("ERROR", ISOLATED, ["the winch jammed", "gave Error"]),
        ("SILENT_ERROR", HERE, ["the FMU gave no message", "gave Error"]),
        ("FATAL", HERE, ["my memory is in ruins", "gave Fatal"]),
        ("FATAL", ISOLATED, ["my memory is in ruins", "gave Fatal"]),
        ("DISCARD", HERE, ["this step is too long for me", "got at 49.6", "gave Discard"]),
        ("PENDING", HERE, ["answers its steps later", "gave Pending"]),
        ("LATE", HERE, ["answers its steps later", "called stepFinished"]),
        ("LATE", ISOLATED, ["answers its steps later", "called stepFinished"]),
    ],
)
def test_one_clear_error(make_scene: Make, tmp_path: Path, switch: str, isolate: bool, words: list[str]) -> None:
    """Each names the instance and the time; what was reached before it is in the folder, marked as failed."""
    timeout = 2.0 if switch == "HANG" else 20.0
    scene = make_scene("capture", "removal")
    result = swap_in(scene, build(tmp_path / "fmu", "removal", switch), isolate, timeout)
    assert result.exit_code == FMU_FAILED
    assert result.status == "FMU failed"
    for word in (*words, "removal at t = " if "its output" in words[0] else "removal", "my_removal.fmu"):
        assert word in result.message
    assert result.message.count("\n") == 2
    assert "in a step of 10 s" in result.message or "its output" in words[0]
    write(result, tmp_path / "run", summary.as_dict(result))
    provenance = json.loads((tmp_path / "run" / "provenance.json").read_text())
    assert (provenance["status"], provenance["exit_code"]) == ("FMU failed", FMU_FAILED)
    assert {"capture.parquet", "removal.parquet", "ledger.json"} <= {p.name for p in (tmp_path / "run").iterdir()}
    start = result.phases["removal"].start
    # steps of 10 s, and it goes wrong in the first that goes beyond 45 s
    assert result.phases["removal"].end == pytest.approx(start + 40.0)


def test_crashing_at_the_start_keeps_the_capture(make_scene: Make, tmp_path: Path) -> None:
    result = swap_in(make_scene("capture", "removal"), build(tmp_path, "removal", "CRASH_AT_START"), ISOLATED)
    assert (result.exit_code, result.status) == (FMU_FAILED, "FMU failed")
    assert "removal at the end of its initialisation:\n  its process was ended by SIGSEGV" in result.message
    assert len(result.phases["capture"].recorder) > 1


def test_one_that_refuses_what_it_is_given(make_scene: Make, tmp_path: Path) -> None:
    fmu = build(tmp_path, "removal", "REFUSES")
    assert swap_in(make_scene("capture", "removal"), fmu).exit_code == HANDOFF_FAILED
    with pytest.raises(InputError, match="does not suit me"):
        swap_in(make_scene("removal"), fmu)


def test_crashing_alone_is_no_bad_input(make_scene: Make, tmp_path: Path) -> None:
    with pytest.raises(FmuError, match="ended by SIGSEGV") as caught:
        swap_in(make_scene("removal"), build(tmp_path, "removal", "CRASH_AT_START"), ISOLATED)
    assert caught.value.exit_code == FMU_FAILED


def test_a_binary_that_does_not_load_keeps_the_capture(make_scene: Make, tmp_path: Path) -> None:
    fmu = build(tmp_path)
    with Archive(fmu) as archive:
        assert archive.folder is not None
        next(archive.folder.rglob("*.so")).write_bytes(b"no machine code")

        def instantiate(phase: str, name: str):
            return MockCapture(reports=True) if phase == "capture" else Component(archive, name)

        result = run_scene(make_scene("capture", "removal"), instantiate, Progress())
    assert (result.exit_code, result.status) == (FMU_FAILED, "FMU failed")
    assert "cannot be used" in result.message
    assert "capture" in result.phases


@pytest.mark.parametrize("isolate", [HERE, ISOLATED])
def test_its_own_end_is_no_failure(make_scene: Make, tmp_path: Path, isolate: bool) -> None:
    result = swap_in(make_scene("capture", "removal"), build(tmp_path / "fmu", "removal", "ENDS"), isolate)
    assert result.exit_code == SUCCESS
    phase = result.phases["removal"]
    assert phase.outcome == "ended"
    assert phase.ended_by == "the pair entered the atmosphere"
    assert phase.ended_at == pytest.approx(phase.start + 45.0)
    assert phase.end == pytest.approx(phase.start + 40.0)
    found = summary.as_dict(result)["removal"]
    assert found["ended_by"]["value"] == "the pair entered the atmosphere"
    assert found["ended_at"]["unit"] == "s"
    labels = [row.label for row in summary.findings(result) if row.key == "simulated"]
    assert labels[-1] == "recorded, in whole steps", "it went on beyond them, as ended_at says"
    from dcone_cosim.reports.figures import draw_all

    write(result, tmp_path / "run", summary.as_dict(result), draw=lambda p: draw_all(result, p))
    assert json.loads((tmp_path / "run" / "provenance.json").read_text())["exit_code"] == 0


def test_an_end_before_the_capture_is_a_failed_capture(make_scene: Make, tmp_path: Path) -> None:
    with Archive(build(tmp_path, "capture", "ENDS", when=3.0)) as archive:
        result = run_scene(make_scene("capture"), lambda _, name: Component(archive, name), Progress())
        assert result.exit_code == 3
        assert "ended at t = 3.25 s, not captured\n  the pair entered" in result.message
        (phase,) = make_scene("capture").phases
        flown = replace(phase, options=CaptureOptions("none"))
        scene = replace(make_scene("capture"), phases=(flown,))
        assert run_scene(scene, lambda _, name: Component(archive, name), Progress()).exit_code == SUCCESS


class TestCapture:
    """A foreign capture: its instant is located from saved states, if they restore."""

    @staticmethod
    def run(path: Path, isolate: bool = HERE):
        with (
            Archive(path) as archive,
            IsolatedComponent(archive, "shot") if isolate else Component(archive, "shot") as component,
        ):
            component.initialise(0.0)
            plan = CapturePlan(0.5, 20.0, stop_there=True)
            return CaptureLoop(component, plan, Progress()).run()

    def test_an_honest_one_is_located(self, tmp_path: Path) -> None:
        fmu = build(tmp_path, "capture")
        for isolate in (HERE, ISOLATED):
            result = self.run(fmu, isolate)
            assert result.error is None
            assert result.located == 16.0 / 3.0

    @pytest.mark.parametrize("isolate", [HERE, ISOLATED])
    def test_a_liar_is_found_out(self, tmp_path: Path, isolate: bool) -> None:
        for switch, words in (
            (
                "LIES=TETHER_PAID_OUT",
                "the step from 5 s to 5.5 s gave its output tether.paid_out as 21.5495 before, 22.0495",
            ),
            ("IGNORES_STATE", "at t = 5 s its output tether.paid_out was 15.045 before, 16.0495 after"),
        ):
            result = self.run(build(tmp_path / switch[:4], "capture", switch), isolate)
            assert result.error is not None
            assert str(result.error).startswith(f"shot: its state does not restore: {words}")
            assert "canGetAndSetFMUstate = false" in str(result.error)
            assert len(result.recorder) == 11

    def test_a_liar_that_says_it_cannot_is_taken_at_its_steps(self, tmp_path: Path) -> None:
        def honest(xml: str) -> str:
            return xml.replace('canGetAndSetFMUstate="true"', 'canGetAndSetFMUstate="false"')

        result = self.run(build(tmp_path, "capture", "LIES=TETHER_PAID_OUT", change=honest))
        assert result.error is None
        assert result.located == 5.5
        assert "cannot save its state" in result.located_by

    def test_one_of_fixed_steps_is_taken_at_them(self, tmp_path: Path) -> None:
        def fixed(xml: str) -> str:
            return xml.replace('canHandleVariableCommunicationStepSize="true"', "")

        result = self.run(build(tmp_path, "capture", change=fixed))
        assert result.located == 5.5
        assert "takes only steps of one length (it reports 5.33333333 s)" in result.located_by


class TestComponent:
    def test_no_call_after_fatal(self, tmp_path: Path) -> None:
        with Archive(build(tmp_path, "removal", "FATAL")) as archive:
            component = Component(archive, "tow")
            component.initialise(0.0)
            read = component.reader(["separation"])
            component.save()
            calls: list[str] = []
            call, step = component._fmu._call, component._do_step
            component._fmu._call = lambda name, *rest: (calls.append(name), call(name, *rest))[1]
            component._do_step = lambda *rest: (calls.append("fmi2DoStep"), step(*rest))[1]
            with pytest.raises(CallError, match="in ruins") as caught:
                component.step(45.0, 10.0)
            assert caught.value.status == "Fatal"
            for again in (
                lambda: component.step(45.0, 10.0),
                lambda: component.get(["separation"]),
                lambda: component.reader(["separation"]),
                read,
                component.save,
                component.restore,
            ):
                with pytest.raises(CallError, match=r"takes no further call:\n.*in ruins"):
                    again()
            component.close()
            assert calls == ["fmi2DoStep"]

    def test_a_discarded_step_says_how_far_it_came(self, tmp_path: Path) -> None:
        with Archive(build(tmp_path, "removal", "DISCARD")) as archive, Component(archive, "tow") as component:
            component.initialise(0.0)
            component.save()
            with pytest.raises(CallError) as caught:
                component.step(0.0, 80.0)
            assert (caught.value.status, caught.value.reached) == ("Discard", 20.0)
            assert not isinstance(caught.value, Terminated)
            component.restore()
            component.step(0.0, 20.0)

    @pytest.mark.parametrize("switch", ["NULL_LOG", "BAD_LOG"])
    def test_no_message_can_stop_us(self, tmp_path: Path, switch: str) -> None:
        with Archive(build(tmp_path, "removal", switch)) as archive, Component(archive, "tow") as component:
            component.initialise(0.0)
            component.step(45.0, 10.0)
            with pytest.raises(CallError, match="not allowed"):
                component.enter_initialisation(0.0)

    def test_a_parameter_may_be_infinite(self, tmp_path: Path) -> None:
        with Archive(build(tmp_path)) as archive, Component(archive, "tow") as component:
            component.set({"tether.rest_length": np.inf})
            component.initialise(0.0)
            assert component.get(["tether.rest_length"]) == {"tether.rest_length": np.inf}


@pytest.mark.parametrize(
    ("old", "new", "complaint"),
    [
        ('name="start.condition"', 'name="start.conditions"', r"start\.condition: missing; .*'start\.conditions'"),
        ('<Real unit="kg" start="1000.0" />', '<Integer start="1000" />', r"mass: its type is Integer; expected Real"),
        ('<Real unit="kg" start="1000.0" />', '<Real unit="m" start="1" />', r"mass: its unit is m; expected kg"),
        (
            'description="debris with the net that holds it" causality="parameter"',
            'description="debris with the net that holds it" causality="output"',
            r"target\.mass: its causality is output; expected parameter",
        ),
    ],
)
def test_what_the_contract_misses(tmp_path: Path, old: str, new: str, complaint: str) -> None:
    import re

    def change(xml: str) -> str:
        assert xml.count(old) == 1
        return xml.replace(old, new)

    with Archive(build(tmp_path / "odd", change=change)) as archive:
        (found,) = check_contract(archive, kinds()["removal"], True, HANDS_OVER)
        assert re.search(complaint, found)
    with Archive(build(tmp_path / "good")) as archive:
        assert check_contract(archive, kinds()["removal"], True, HANDS_OVER) == []
        assert isinstance(Component(archive, "it"), Component)
