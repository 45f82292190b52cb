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
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from typing import Any

from dcone_cosim import loads
from dcone_cosim.cases.beginnings import Beginning, begun, write
from dcone_cosim.cases.case import Begins, Case
from dcone_cosim.cases.rows import FAULT, Row, of_summary, refused
from dcone_cosim.errors import BAD_INPUT, FAILED_AFTER, FMU_FAILED, DconeError
from dcone_cosim.fmu.shelf import Shelf
from dcone_cosim.master import run_scene
from dcone_cosim.progress import Progress
from dcone_cosim.reports import summary
from dcone_cosim.results import Begun, PhaseResult, RunResult
from dcone_cosim.running import Ran
from dcone_cosim.scene.data import Scene
from dcone_cosim.scene_fmus import SceneFmus, fmus_of

FAILED_STATUS = "FMU failed"
Telling = Callable[[Case, RunResult, Mapping[str, float]], Row]
"""Makes the row of a run, with what it cost [s]."""


def tell_summary(case: Case, result: RunResult, timings: Mapping[str, float]) -> Row:
    """The row of a run with all figures of its summary."""
    loads.judge(result)
    return of_summary(case.key, summary.as_dict(result), timings, summary.shown_in(result))


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
        self._begun: tuple[Begins, Begun] | None = None

    def row(self, case: Case, tell: Telling = tell_summary, tables: bool | None = None) -> Row:
        """Run a case; whatever happens comes out as a row.

        tables    whether `tell` asks for more than the summary: the rows of the phases; None: unless it is
                  `tell_summary`
        """
        if tables is None:
            tables = tell is not tell_summary
        with_kept = self.get_ready(case.scene) and not self.new
        row = self._run(case, tell, tables)
        if not with_kept or self._proved or not row.succeeded:
            return row
        self.shelf.clear()
        fresh = self._run(case, tell, tables)
        self._proved = True
        if (row.figures, row.status) != (fresh.figures, fresh.status):
            self.new = True
            self.shelf.clear()
        return fresh

    def begin(self, beginning: Beginning) -> None:
        """Run first phases that cases have in common, and keep them."""
        self.get_ready(beginning.scene)
        scene, started = beginning.scene, datetime.now(UTC)
        if self._fmus is None:
            return  # the cases tell why
        begun = self._begun_of(None if beginning.before is None else beginning.before.begins, scene)
        try:
            result = run_scene(
                scene, self._fmus.instantiate, Progress(), self._fmus.adopt, begun, until=beginning.until
            )
            write(beginning, Ran(result, self._fmus.facts(), started))
        except DconeError:
            self.shelf.clear()

    def _begun_of(self, begins: Begins | None, scene: Scene) -> Begun | None:
        """What a run goes on from; that of the case before is at hand."""
        if begins is None:
            return None
        if self._begun is None or self._begun[0] != begins:
            found = begun(begins, scene)
            self._begun = None if found is None else (begins, found)
        return None if self._begun is None else self._begun[1]

    def get_ready(self, scene: Scene) -> bool:
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

    def _run(self, case: Case, tell: Telling, tables: bool) -> Row:
        began, cpu = clock.perf_counter(), clock.process_time()
        try:
            if self._fmus is None:
                self._fmus = SceneFmus(case.scene, Progress(), self.shelf)
            before = self._begun_of(case.begins, case.scene)
            result = run_scene(case.scene, self._fmus.instantiate, Progress(), self._fmus.adopt, before, tables=tables)
            over = () if before is None else before.over
            apart = sum(max(phase.cpu, 0.0) for name, phase in result.phases.items() if name not in over)
            spent = max(clock.process_time() - cpu, apart)
            row = tell(case, result, {"cpu": spent, "wall": clock.perf_counter() - began})
            taken = {time: 0.0 for time in row.timings if time.partition(".")[0] in over}
            row = replace(row, timings={**row.timings, **taken}) if taken else row
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


def make_ready(scene: Scene | None = None) -> None:
    """Have imported what cases need, and the FMUs of a scene like them unpacked, before the first comes."""
    if scene is not None:
        _own_fleet().get_ready(scene)


def run_beginning(beginning: Beginning) -> None:
    """Run first phases in this process, whose FMUs stay loaded for the cases that go on from them."""
    _own_fleet().begin(beginning)


def run_case(case: Case, tell: Telling = tell_summary, tables: bool | None = None) -> Row:
    """Run a case in this process, whose FMUs stay loaded for the next; `tables` as in `Fleet.row`."""
    return _own_fleet().row(case, tell, tables)


@dataclass
class Kept:
    """A run, or the row that says why there is none."""

    result: RunResult | None
    row: Row

    @property
    def phase(self) -> PhaseResult | None:
        """The first phase, if it began."""
        return next(iter(self.result.phases.values()), None) if self.result is not None else None


def run_alone(scene: Scene) -> Kept:
    """Run a scene as a case of its own, and keep all that it found."""
    kept: list[RunResult] = []

    def tell(case: Case, result: RunResult, timings: Mapping[str, float]) -> Row:
        kept.append(result)
        return Row(case.key, result.status, result.exit_code, result.message)

    row = run_case(Case("", scene), tell)
    return Kept(kept[-1] if kept else None, row)


def _own_fleet() -> Fleet:
    global _fleet
    if _fleet is None:
        _fleet = Fleet()
    return _fleet
