"""The first phases of a sweep, begun while its cases are still being checked.

Where the first two cases have them in common, all probably have. What comes of it is put in its place once the folder
of the sweep is there; if nobody has use for it, it is thrown away.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from concurrent.futures import Executor, Future, wait
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

from dcone_cosim import interrupts
from dcone_cosim.cases.beginnings import Beginning, shared
from dcone_cosim.cases.case import Case
from dcone_cosim.cases.runner import LOOK
from dcone_cosim.cases.work import run_beginning
from dcone_cosim.errors import Interrupted
from dcone_cosim.scene.data import Scene
from dcone_cosim.scratch import Scratch


class Early:
    """A beginning that is being run in a folder of its own, if there is one.

    firsts   the first two cases: their scenes, and what their FMUs are
    place    folder of the sweep, which need not be there yet
    """

    def __init__(self, firsts: Sequence[tuple[Scene, Mapping[str, str]]], place: Path, workers: Executor) -> None:
        cases = [(Case(str(number), scene), fmus) for number, (scene, fmus) in enumerate(firsts)]
        found = shared(cases, place)
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
                while not going.done():
                    if interrupts.noted():
                        raise Interrupted(f"interrupted by {interrupts.noted()}; no case was begun")
                    wait([going], LOOK)
                beginning.folder.parent.mkdir(exist_ok=True)
                with suppress(OSError):  # it did not come about, or another process has just put its own there
                    self.beginning.folder.rename(beginning.folder)
                return

    def close(self) -> None:
        if self._going is not None:
            self._going.cancel()
            self.scratch.remove()
