"""An FMU in a process of its own: the same numbers, and nothing of its troubles becomes ours."""

from __future__ import annotations

import io
import os
import pickle
import signal
import subprocess
import sys
import textwrap
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

from dcone_cosim import build as models
from dcone_cosim.coupling.coupled import Coupled
from dcone_cosim.coupling.options import Coupling
from dcone_cosim.errors import FmuError
from dcone_cosim.fmu import children, frames, isolation
from dcone_cosim.fmu.archive import Archive
from dcone_cosim.fmu.component import CallError, Component, output_names
from dcone_cosim.fmu.isolation import IsolatedComponent
from dcone_cosim.loading import load
from dcone_cosim.phases.stepping import PhaseLoop
from dcone_cosim.progress import Progress
from tests.cosim.fmus.build import build

Fmu = Callable[..., Archive]
ROOT = Path(__file__).parents[2]
FOR_READERS = {"reference", "ready", "watch", "remark", "getter", "refusal", "not_finite"}
"""What a component has for its readers alone."""


@pytest.fixture
def fmu(tmp_path: Path) -> Iterator[Fmu]:
    archives: list[Archive] = []

    def make(*switches: str, **more: object) -> Archive:
        archives.append(Archive(build(tmp_path / str(len(archives)), "removal", *switches, **more)))  # type: ignore[arg-type]
        return archives[-1]

    yield make
    for archive in archives:
        archive.close()


def is_alive(process: int) -> bool:
    try:
        state = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0]
    except OSError:
        return False
    return state != "Z"


def gone_within(process: int, seconds: float) -> bool:
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if not is_alive(process):
            return True
        time.sleep(0.05)
    return False


@pytest.mark.slow
def test_our_removal_gives_the_same_bits() -> None:
    """Outputs of 300 steps, and of a replay from a saved state, in this process and in another."""
    (phase,) = load("table2-deorbit").phases
    path = models.ensure([("tethered_deorbit", phase.main.terms)], lambda _: None)[0]
    rows = []
    with Archive(path) as archive:
        for make in (Component, IsolatedComponent):
            with make(archive, "tow") as component:
                assert component.variables is archive.variables
                component.set(phase.main.parameters)
                component.initialise(0.0, 1e5)
                read = component.reader(output_names(component.variables))
                found = [read().copy()]
                for i in range(300):
                    component.step(i * 10.0, 10.0)
                    if i == 200:
                        component.save("then")
                    found.append(read().copy())
                component.restore("then")
                found.append(read().copy())
                component.step(2010.0, 10.0)
                found.append(read().copy())
                rows.append((read.names, np.array(found), component.state_size()))
    (names, here, size), (names_there, there, size_there) = rows
    assert names == names_there
    assert size == size_there
    np.testing.assert_array_equal(here, there)
    np.testing.assert_array_equal(here[201], here[301])
    np.testing.assert_array_equal(here[202], here[302])
    assert not np.array_equal(here[201], here[202])


def test_readers_do_not_keep_what_has_changed(fmu: Fmu) -> None:
    with IsolatedComponent(fmu(), "tow") as component:
        component.set({"start.relative_velocity[1]": 1.0, "start.relative_position[1]": 5.0})
        component.initialise(0.0)
        first, second = component.reader(["separation"]), component.reader(["relative.position[1]"])
        for i in range(3):
            assert first()[0] == second()[0] == 5.0 + i
            component.step(float(i), 1.0)
        component.save()
        component.step(3.0, 1.0)
        assert first()[0] == 9.0
        component.restore()
        assert first()[0] == second()[0] == 8.0
        assert component.get(["separation"]) == {"separation": 8.0}


def test_what_it_prints_reaches_no_stream_of_ours(fmu: Fmu, capfd: pytest.CaptureFixture[str]) -> None:
    with IsolatedComponent(fmu("NOISE", when=-1.0), "tow") as component:
        component.initialise(0.0)
        for i in range(2000):
            component.step(float(i), 1.0)
        component.get(["separation"])
    written = capfd.readouterr()
    assert "noise" not in written.out + written.err
    with Component(fmu("NOISE", when=-1.0), "tow") as component:
        component.initialise(0.0)
        component.step(0.0, 1.0)
    assert "noise on stderr" in capfd.readouterr().err


def test_an_error_keeps_its_class_and_words(fmu: Fmu) -> None:
    with IsolatedComponent(fmu("DISCARD"), "tow") as component:
        with pytest.raises(FmuError, match=r"no variable 'seperation'; did you mean 'separation'"):
            component.get(["seperation"])
        component.initialise(0.0)
        component.save()
        with pytest.raises(CallError, match="too long for me") as caught:
            component.step(0.0, 80.0)
        assert (caught.value.status, caught.value.reached, caught.value.name) == ("Discard", 20.0, "tow")
        component.restore()
        component.step(0.0, 20.0)


def test_after_a_crash_every_call_says_so_and_closing_is_quiet(fmu: Fmu) -> None:
    component = IsolatedComponent(fmu("CRASH"), "tow")
    component.initialise(0.0)
    read = component.reader(["separation"])
    process = component._child.pid
    with pytest.raises(CallError, match="SIGSEGV") as caught:
        component.step(45.0, 10.0)
    assert caught.value.broken
    for again in (lambda: component.step(45.0, 10.0), read, component.save, lambda: component.get(["separation"])):
        with pytest.raises(CallError, match=r"tow at t = 45 s in a step of 10 s:\n.*SIGSEGV"):
            again()
    component.close()
    component.close()
    assert not is_alive(process)


@pytest.mark.parametrize(
    ("switch", "said"),
    [
        ('GARBLE="nonsense that is no frame"', "its process wrote into the stream of our answers"),
        ('GARBLE="dcF1\\5\\0\\0\\0[1,2]"', "its process wrote into the stream of our answers"),
        ('GARBLE="dcF1\\15\\0\\0\\0[null,[[0,1]]"', "its process wrote into the stream of our answers"),
        ('GARBLE="dcF1\\377\\377\\377\\377"', "its process wrote into the stream of our answers"),
        ("CLOSES", "its process closed the stream of our answers"),
        ("SIGNAL=40", "its process was ended by signal 40"),
    ],
)
def test_what_broke_is_told_truthfully(fmu: Fmu, switch: str, said: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Foreign code may write anything anywhere; it never was ended by a signal that we sent."""
    monkeypatch.setattr(isolation, "FAREWELL", 1.0)
    with IsolatedComponent(fmu(switch), "tow") as component:
        component.initialise(0.0)
        process = component._child.pid
        begin = time.monotonic()
        with pytest.raises(CallError, match=said) as caught:
            component.step(45.0, 10.0)
        assert "SIGKILL" not in str(caught.value)
        assert caught.value.broken
        assert time.monotonic() - begin < 5.0
        assert not is_alive(process)


def test_frames_carry_every_bit_and_run_nothing() -> None:
    class Touch:
        def __reduce__(self) -> tuple[object, ...]:
            return os.system, ("true",)

    values = [0.1, -0.0, 5e-324, 1.7976931348623157e308, float("inf"), float("-inf"), 2**53 + 1, None, "\u00e9\n", True]
    row = np.array([0.1, np.nan, -0.0]).tobytes()
    stream = io.BytesIO()
    frames.send(stream, (values, {"a": {"b": row}}))
    stream.seek(0)
    found, table = frames.receive(stream)
    assert list(map(repr, found)) == list(map(repr, values))
    assert table == {"a": {"b": row}}
    with pytest.raises(EOFError):
        frames.receive(stream)
    with pytest.raises(frames.Garbled):
        frames.receive(io.BytesIO(pickle.dumps(Touch())))
    with pytest.raises(frames.Garbled):
        frames.receive(io.BytesIO(frames.MARK + b"\3\0\0\0[1}"))


def test_a_hang_is_ended_in_time_and_a_slow_one_is_not(fmu: Fmu) -> None:
    with IsolatedComponent(fmu("HANG"), "tow", timeout=1.0) as component:
        component.initialise(0.0)
        for i in range(3):  # together longer than the timeout
            component.step(float(i), 1.0)
            time.sleep(0.4)
        begin = time.monotonic()
        with pytest.raises(CallError, match=r"did not answer within 1 s and was killed"):
            component.step(45.0, 10.0)
        assert 1.0 <= time.monotonic() - begin < 3.0


def test_a_closed_one_leaves_no_process(fmu: Fmu) -> None:
    component = IsolatedComponent(fmu(), "tow")
    process = component._child.pid
    component.initialise(0.0)
    component.close()
    assert not is_alive(process)
    with pytest.raises(FmuError, match="closed"):
        component.step(0.0, 1.0)


def test_children_made_ready_are_taken_or_ended(fmu: Fmu) -> None:
    """One that has died meanwhile is not taken."""
    children.make_ready(3)
    first, second, third = children._ready
    first.kill()
    first.wait()
    with IsolatedComponent(fmu(), "tow") as component:
        assert component._child is second
        component.initialise(0.0)
    children.dismiss()
    assert not children._ready
    assert not any(is_alive(child.pid) for child in (first, second, third))


def test_what_has_no_answer_goes_along_with_the_next_step(fmu: Fmu, monkeypatch: pytest.MonkeyPatch) -> None:
    """Inputs, a state kept, a step and a reading are one exchange; and one that is refused is told there."""
    asked: list[list[str]] = []
    monkeypatch.setattr(
        isolation, "send", lambda pipe, calls: asked.append([c[0] for c in calls]) or frames.send(pipe, calls)
    )
    with IsolatedComponent(fmu(), "tow") as component:
        component.set({"start.relative_velocity[1]": 1.0, "start.relative_position[1]": 5.0})
        component.initialise(0.0)
        read = component.reader(["separation"])
        read()
        component.step(0.0, 1.0)
        read()
        asked.clear()
        for i in range(1, 4):
            component.save()
            component.step(float(i), 1.0)
            read()
        component.restore()
        assert read()[0] == 8.0
        assert asked == [["save", "step"]] * 3 + [["restore", "read"]]
        component.set({"target.mass": 10.0})  # a parameter, which cannot be set any more
        with pytest.raises(CallError, match="no such Real can be set now"):
            component.step(3.0, 1.0)
        assert component.time == 3.0


def test_its_time_counts(fmu: Fmu) -> None:
    """The CPU time that a run tells holds that of the other process, alone and coupled."""
    with IsolatedComponent(fmu(), "tow") as component:
        before, own = component.cpu_apart(), time.process_time()
        assert before > 0.0
        component.initialise(0.0)
        result = PhaseLoop(Coupled("all", [component], [], Coupling()), 1.0, 0.0, 2000.0, Progress()).run()
        used, own = component.cpu_apart() - before, time.process_time() - own
        assert own + 0.5 * used < result.cpu < own + 1.1 * used
    assert component.cpu_apart() >= before + 0.9 * used, "and is known when it is gone"


def parent(archive: Archive, rest: str) -> subprocess.Popen[str]:
    """A process that isolates the FMU, prints its child's id, and does the rest."""
    program = f"""
        from pathlib import Path
        from dcone_cosim.fmu.archive import Archive
        from dcone_cosim.fmu.isolation import IsolatedComponent
        component = IsolatedComponent(Archive(Path({str(archive.path)!r})), "tow", 60.0)
        component.initialise(0.0)
        print(component._child.pid, flush=True)
    """
    return subprocess.Popen(
        [sys.executable, "-c", textwrap.dedent(program) + textwrap.dedent(rest)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        cwd=ROOT,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
    )


@pytest.mark.parametrize("rest", ["import time; time.sleep(60)", "component.step(45.0, 10.0)"], ids=["idle", "hanging"])
def test_it_dies_with_its_parent(fmu: Fmu, rest: str) -> None:
    """Also when the parent is killed and the FMU never returns."""
    with parent(fmu("HANG"), rest) as process:
        assert process.stdout is not None
        child = int(process.stdout.readline())
        time.sleep(0.5)
        assert is_alive(child)
        process.kill()
        process.wait()
        assert gone_within(child, 5.0)


@pytest.mark.parametrize(
    ("how", "said"), [("HANG", "did not answer within 1 s and was killed"), ("EXIT=0", "ended itself with exit code 0")]
)
def test_somebody_left_behind_keeps_nobody_waiting(fmu: Fmu, how: str, said: str) -> None:
    """The FMU starts a process that outlives it by 20 s and holds its streams open: they never end."""
    with IsolatedComponent(fmu("LEAVES", how), "tow", timeout=1.0) as component:
        component.initialise(0.0)
        begin = time.monotonic()
        with pytest.raises(CallError, match=said):
            component.step(45.0, 10.0)
        assert time.monotonic() - begin < 10.0


def test_ctrl_c_ends_a_step_that_hangs(fmu: Fmu) -> None:
    rest = """
        try:
            component.step(45.0, 10.0)
        except KeyboardInterrupt:
            component.close()
            print("interrupted", flush=True)
    """
    with parent(fmu("HANG"), rest) as process:
        assert process.stdout is not None
        child = int(process.stdout.readline())
        time.sleep(0.5)
        begin = time.monotonic()
        process.send_signal(signal.SIGINT)
        assert process.stdout.readline() == "interrupted\n"
        assert time.monotonic() - begin < 3.0
        assert gone_within(child, 1.0)


def test_one_that_cannot_be_instantiated(fmu: Fmu) -> None:
    archive = fmu(change=lambda xml: xml.replace('guid="', 'guid="other-'))
    for make in (Component, IsolatedComponent):
        with pytest.raises(FmuError, match="tow could not be instantiated"):
            make(archive, "tow")


def test_both_offer_the_same(fmu: Fmu) -> None:
    with IsolatedComponent(fmu(), "tow") as component:
        offered = {name for name in vars(Component) if not name.startswith("_")} - FOR_READERS
        assert offered <= set(dir(component))
        assert (component.can_save, component.can_interpolate) == (True, False)
