"""Columns that every reader takes: names that collide, outputs that are none, units; and steps of the same bits."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas
import pyarrow.parquet
import pytest

from dcone_cosim.coupling.coupled import Coupled
from dcone_cosim.coupling.options import Coupling
from dcone_cosim.fmu.component import VariableInfo
from dcone_cosim.phases.capture_loop import CaptureLoop, CapturePlan
from dcone_cosim.phases.stepping import PhaseLoop
from dcone_cosim.progress import Progress
from dcone_cosim.recorder import Recorder
from dcone_cosim.results import RunResult
from dcone_cosim.run_folder import phase_table
from dcone_cosim.running import nothing_recorded
from dcone_cosim.scene.data import Scene
from tests.cosim.mock_components import MockCapture, MockComponent


class Clocked(MockComponent):
    """Tells times in minutes of its own, under the name that the first column of a table has; steps of one length."""

    def __init__(self, name: str = "clocked", outputs: tuple[str, ...] = ("time", "x")) -> None:
        super().__init__(name, can_save=False)
        self.can_vary_step = False
        self.declare(outputs, "output")

    def step(self, time: float, size: float) -> None:
        super().step(time, size)
        self.values |= {name: self.time / 60.0 + 7.0 for name in self.values}


def run(component: object, macro_step: float = 0.1, start: float = 0.0, duration: float = 1.0):
    component.enter_initialisation(start)  # type: ignore[attr-defined]
    component.exit_initialisation()  # type: ignore[attr-defined]
    result = PhaseLoop(component, macro_step, start, duration, Progress()).run()  # type: ignore[arg-type]
    assert result.error is None
    return result


@pytest.mark.parametrize("of", ["alone", "main", "further"])
def test_an_output_called_time(tmp_path: Path, of: str) -> None:
    parts = {
        "alone": [Clocked()],
        "main": [Clocked("a"), Clocked("b", ("x",))],
        "further": [Clocked("a", ("x",)), Clocked("b")],
    }[of]
    result = run(parts[0] if len(parts) == 1 else Coupled("whole", parts, [], Coupling()))
    pyarrow.parquet.write_table(phase_table(result, "told"), tmp_path / "it.parquet")
    column = {"alone": "output.time", "main": "output.time", "further": "b.time"}[of]
    times = np.arange(11) * 0.1
    table, frame = pyarrow.parquet.read_table(tmp_path / "it.parquet"), pandas.read_parquet(tmp_path / "it.parquet")
    assert len(set(table.column_names)) == len(table.column_names)
    np.testing.assert_allclose(table["time"].to_numpy(), times, rtol=1e-12)
    np.testing.assert_allclose(frame["time"], times, rtol=1e-12)
    np.testing.assert_allclose(frame[column][1:], times[1:] / 60.0 + 7.0, rtol=1e-12)
    assert result.end == 1.0, "the phase's own clock is that of its steps"


def test_a_column_that_has_that_name_too() -> None:
    names = ["time", "output.time", "output.output.time"]
    recorder = Recorder(names, {n: VariableInfo(n, 0, "Real", "1", "output", "") for n in names})
    recorder.add(0.5, np.array([1.0, 2.0, 3.0]))
    assert len(set(recorder.names)) == 4
    assert recorder.last()["output.time"] == 2.0
    assert recorder["time"] == [0.5]


def test_units_are_where_pandas_looks(tmp_path: Path) -> None:
    component = Clocked()
    component.variables["x"] = VariableInfo("x", 1, "Real", "kg.m2", "output", "")
    pyarrow.parquet.write_table(phase_table(run(component), "since then"), tmp_path / "it.parquet")
    attributes = pandas.read_parquet(tmp_path / "it.parquet").attrs
    assert attributes["units"] == {"time": "s", "output.time": "1", "x": "kg.m2"}
    assert attributes["time"] == {"clock": "since then"}


def test_without_outputs_it_says_that_nothing_is_recorded(make_scene: Callable[..., Scene]) -> None:
    scene = make_scene("removal")
    told = nothing_recorded(RunResult(scene, {"plain": run(Clocked(outputs=()))}))
    assert told == ["nothing is recorded of the plain: its FMU has no outputs that are numbers"]
    assert nothing_recorded(RunResult(scene, {"plain": run(Clocked())})) == []


class TestStepsOfOneLength:
    """0.1 s has no end in binary: the difference of two multiples of it is seldom 0.1 s itself."""

    @pytest.mark.parametrize("start", [0.0, 1e6 + 1.0 / 3.0])
    def test_alone(self, start: float) -> None:
        component = Clocked()
        run(component, 0.1, start, 10.0)
        assert {size for _, size in component.calls} == {0.1}
        assert len(component.calls) == 100

    def test_twin_of_many_lengths(self) -> None:
        component = Clocked()
        component.can_vary_step = True
        run(component, 0.1, 0.0, 10.0)
        assert len({size for _, size in component.calls}) > 1

    @pytest.mark.parametrize("step", [0.0, 0.1])
    def test_coupled(self, step: float) -> None:
        parts = [Clocked("a"), Clocked("b")]
        run(Coupled("whole", parts, [], Coupling(step=step)), 0.1 if step == 0.0 else 0.3, 5.0, 6.0)
        assert {size for part in parts for _, size in part.calls} == {0.1}

    def test_in_a_capture(self) -> None:
        component = MockCapture(instant=1e9, can_save=False)
        component.can_vary_step = False
        component.enter_initialisation(1e5)
        component.exit_initialisation()
        CaptureLoop(component, CapturePlan(0.1, 5.0, start=1e5), Progress()).run()
        assert {size for _, size in component.calls} == {0.1}
        assert len(component.calls) == 50
