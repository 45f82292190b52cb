"""A case as little data, and what a worker does with it.

A worker is sent the text of the scene with what is different in this case, reads it, runs it with the FMUs that it has
loaded, and sends back what the campaign asks for. So whoever hands out cases does next to nothing for each.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

from dcone_cosim.campaign.outcomes import TOLD_BY
from dcone_cosim.cases.case import Case
from dcone_cosim.cases.rows import Row, refused
from dcone_cosim.cases.work import run_case, tell_summary
from dcone_cosim.errors import InputError
from dcone_cosim.results import RunResult
from dcone_cosim.scene.data import Scene
from dcone_cosim.scene.mistakes import SceneError
from dcone_cosim.scenes.reading import parse

WITHOUT = "without_recoil"
"""In the names of the figures of that tow."""


@dataclass(frozen=True)
class Ground:
    """What all cases have in common.

    text, name, source, folder    of the scene, see `scenes.reading.parse`
    record     figures that are kept, none for all
    """

    text: str
    name: str
    source: str
    folder: str
    isolate: bool | None = None
    record: tuple[str, ...] = ()

    def scene(self, settings: tuple[str, ...]) -> Scene:
        """The scene of a case; `InputError` where its values do not go together."""
        return parse(self.text, self.name, self.source, Path(self.folder), settings).isolating(self.isolate)


def ground_of(base: Scene, isolate: bool | None = None, record: tuple[str, ...] = ()) -> Ground:
    """Of a scene as it has been read."""
    return Ground(base.text, base.name, base.source, str(Path(base.source).parent), isolate, record)


@dataclass(frozen=True)
class Shot:
    """One case; plain data.

    key        under which its row is kept: the hash of its settings, of what they are set in, and of the code
    number     in the campaign, from 1; 0 for the scene as it is
    settings   `KEY=VALUE`, what the command line would have to set to run it alone
    """

    key: str
    number: int
    settings: tuple[str, ...]
    ground: Ground


def run_shot(shot: Shot) -> Row:
    """The row of a case, whatever happens in it; FMUs stay loaded for the next."""
    try:
        scene = shot.ground.scene(shot.settings)
    except InputError as error:
        return refused(shot.key, _in_one_line(error))
    kept = shot.ground.record if shot.number else ()
    case = Case(shot.key, spared(scene, kept), shot.settings, seed=shot.number)
    return run_case(case, partial(_tell, kept=kept), tables=False)


def spared(scene: Scene, kept: Collection[str]) -> Scene:
    """The scene without the tow that is made beside it as if the shot had no recoil, where none of these figures, of
    which none means all, is of that.

    Checked  tests/campaign/test_spared.py
    """
    if not kept or any(WITHOUT in name for name in kept):
        return scene
    return replace(scene, handoff=replace(scene.handoff, compare_without_recoil=False))


def _in_one_line(error: InputError) -> str:
    if not isinstance(error, SceneError):
        return str(error)
    return "; ".join(f"{row['key']} = {row['given']}: {row['expected']}" for row in error.rows())


def _tell(case: Case, result: RunResult, timings: Mapping[str, float], kept: tuple[str, ...]) -> Row:
    """The row with the figures that are asked for, and those that say how it came out."""
    row = tell_summary(case, result, timings)
    if not kept:
        return row
    wanted = {*kept, *TOLD_BY}
    figures: dict[str, Any] = {name: value for name, value in row.figures.items() if name in wanted}
    units = {name: unit for name, unit in row.units.items() if name in figures}
    shown_in = {name: unit for name, unit in row.shown_in.items() if name in figures}
    return replace(row, figures=figures, units=units, shown_in=shown_in)
