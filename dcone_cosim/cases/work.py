"""One case run in a worker, with the FMUs of the cases before kept loaded.

FMUs of ours are reset between two cases that differ in values alone. One from elsewhere may leave something behind in
its fmi2Reset, and the next case would have other numbers without a word. So the first time that instances of such FMUs
would be used again, the case is run twice, with them and with new ones. If its rows are equal, they are reset from
then on; otherwise each case has new ones.
"""

from __future__ import annotations

import time as clock
import traceback
from collections.abc import Callable, Mapping
from contextlib import suppress
from typing import Any

from dcone_cosim import loads
from dcone_cosim.cases.case import Case
from dcone_cosim.cases.rows import FAULT, Row, of_summary, refused
from dcone_cosim.errors import BAD_INPUT, FAILED_AFTER, FMU_FAILED, DconeError
from dcone_cosim.fmu.shelf import Shelf
from dcone_cosim.master import run_scene
from dcone_cosim.progress import Progress
from dcone_cosim.reports import summary
from dcone_cosim.results import RunResult
from dcone_cosim.scene.data import Scene
from dcone_cosim.scene_fmus import SceneFmus, fmus_of

FAILED_STATUS = "FMU failed"
Telling = Callable[[Case, RunResult, Mapping[str, float]], Row]
"""Makes the row of a run, with what it cost [s]."""


def tell_summary(case: Case, result: RunResult, timings: Mapping[str, float]) -> Row:
    """The row of a run with all figures of its summary."""
    loads.judge(result)
    return of_summary(case.key, summary.as_dict(result), timings)


class Fleet:
    """The FMUs of the scenes run last, unpacked and loaded.

    new      make every instance new
    """

    def __init__(self, new: bool = False) -> None:
        self.new = new
        self.shelf = Shelf()
        self._of: tuple[Any, ...] = ()
        self._fmus: SceneFmus | None = None
        self._proved = False

    def row(self, case: Case, tell: Telling = tell_summary) -> Row:
        """Run a case; whatever happens comes out as a row."""
        with_kept = self._get_ready(case.scene) and not self.new
        row = self._run(case, tell)
        if not with_kept or self._proved or not row.succeeded:
            return row
        self.shelf.clear()
        fresh = self._run(case, tell)
        self._proved = True
        if (row.figures, row.status) != (fresh.figures, fresh.status):
            self.new = True
            self.shelf.clear()
        return fresh

    def _get_ready(self, scene: Scene) -> bool:
        """Have the FMUs of the scene; whether instances of the case before may be used again."""
        of = fmus_of(scene)
        if self._fmus is not None and of == self._of:
            self._fmus.serve(scene)
            return True
        self.close()
        with suppress(DconeError, OSError):
            self._fmus = SceneFmus(scene, Progress(), self.shelf)
            self._of = of
            self._proved = all(about["ours"] for about in _about(self._fmus))
        return False

    def _run(self, case: Case, tell: Telling) -> Row:
        began, cpu = clock.perf_counter(), clock.process_time()
        try:
            if self._fmus is None:
                self._fmus = SceneFmus(case.scene, Progress(), self.shelf)
            result = run_scene(case.scene, self._fmus.instantiate, Progress(), self._fmus.adopt)
            apart = sum(max(phase.cpu, 0.0) for phase in result.phases.values())
            spent = max(clock.process_time() - cpu, apart)
            row = tell(case, result, {"cpu": spent, "wall": clock.perf_counter() - began})
        except DconeError as error:
            self.shelf.clear()
            if error.exit_code == BAD_INPUT:
                return refused(case.key, str(error).removeprefix(f"{case.scene.source}: "))
            return Row(case.key, FAILED_STATUS, error.exit_code, str(error))
        except Exception:
            self.shelf.clear()
            return Row(case.key, FAULT, FAILED_AFTER, f"a fault of this program:\n{traceback.format_exc()}")
        if result.exit_code == FMU_FAILED or self.new:
            self.shelf.clear()
        return row

    def close(self) -> None:
        fmus, self._fmus, self._of = self._fmus, None, ()
        if fmus is not None:
            fmus.close()


def _about(fmus: SceneFmus) -> list[Any]:
    facts = fmus.facts().values()
    return [about["fmu"] for phase in facts for about in (phase, *phase.get("components", {}).values())]


_fleet: Fleet | None = None


def run_case(case: Case, tell: Telling = tell_summary) -> Row:
    """Run a case in this process, whose FMUs stay loaded for the next."""
    global _fleet
    if _fleet is None:
        _fleet = Fleet()
    return _fleet.row(case, tell)
