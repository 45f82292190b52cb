"""What cases have in common is run before them; some of it while they are still being checked.

Where the first two cases of a sweep have their first phases in common, all probably have. What comes of them is put in
its place once the folder of the sweep is there; if nobody has use for it, it is thrown away.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from concurrent.futures import Executor, Future, wait
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

from dcone_cosim import interrupts
from dcone_cosim.cases.beginnings import NOWHERE, Beginning, in_order, shared
from dcone_cosim.cases.case import Case
from dcone_cosim.cases.runner import LOOK
from dcone_cosim.cases.store import Store
from dcone_cosim.cases.work import run_beginning
from dcone_cosim.errors import Interrupted
from dcone_cosim.progress import Progress
from dcone_cosim.scene.data import Scene
from dcone_cosim.scratch import Scratch


class Early:
    """A beginning that is being run in a folder of its own, if there is one.

    firsts   the first two cases: their scenes, and what their FMUs are
    place    folder of the sweep, which need not be there yet
    kept     of `beginnings.shared`
    """

    def __init__(
        self,
        firsts: Sequence[tuple[Scene, Mapping[str, str]]],
        place: Path,
        workers: Executor,
        kept: Mapping[str, Path] = NOWHERE,
    ) -> None:
        self.kept = kept
        cases = [(Case(str(number), scene), fmus) for number, (scene, fmus) in enumerate(firsts)]
        found = shared(cases, place, kept)
        self._going: Future[None] | None = None
        if not found:
            return
        *_, beginning = next(iter(found.values())).parts()
        if beginning.is_there:
            return
        above = next(p for p in place.absolute().parents if p.is_dir())
        self.scratch = Scratch(above)
        self.beginning: Beginning = replace(beginning, folder=self.scratch.path / "beginning")
        self._going = workers.submit(run_beginning, self.beginning)

    def put(self, wanted: Sequence[Beginning]) -> None:
        """Once it is done, put it in its place, if it is one of these."""
        going = self._going
        if going is None:
            return
        for beginning in wanted:
            if beginning.key == self.beginning.key and not beginning.is_there:
                wait_for([going])
                beginning.folder.parent.mkdir(exist_ok=True)
                with suppress(OSError):  # it did not come about, or another process has just put its own there
                    self.beginning.folder.rename(beginning.folder)
                return

    def close(self) -> None:
        if self._going is not None:
            self._going.cancel()
            self.scratch.remove()


def begun_together(
    cases: Sequence[Case],
    identified: Mapping[str, Mapping[str, str]],
    store: Store,
    workers: Executor,
    progress: Progress,
    early: Early | None = None,
) -> list[Case]:
    """The cases, with what they have in common run once, as far as it is not there from before.

    identified    what the FMUs of a case are, by its key, of those that may have something in common
    """
    kept = NOWHERE if early is None else early.kept
    of = shared([(case, identified[case.key]) for case in cases if case.key in identified], store.folder, kept)
    missing = [case for case in cases if (row := store.get(case.key)) is None or not row.lasting]
    wanted = [of[case.key] for case in missing if case.key in of]
    if early is not None:
        early.put([part for last in wanted for part in last.parts()])
    for turn in in_order(wanted):
        progress.say(f"running {len(turn)} of what several cases begin with: {', '.join(turn[0].over)}")
        wait_for([workers.submit(run_beginning, beginning) for beginning in turn])
    return [replace(case, begins=of[case.key].begins) if case.key in of else case for case in cases]


def wait_for(going: Sequence[Future[None]]) -> None:
    """Until all are done, whatever came of them: what is not there is run in its cases, and they tell why."""
    while going:
        if interrupts.noted():
            raise Interrupted(f"interrupted by {interrupts.noted()}; no case was begun, and the same command goes on")
        going = list(wait(going, LOOK)[1])
