"""What several cases have in common: the phases before all that is varied in them, run once.

A beginning is a run of a scene's first phases up to a hand-over. It is kept as the folder of a run, under the hash of
all that settles its numbers: the content of those phases and of the hand-overs between them, which phase comes next,
their FMUs, and the code. So it never matters what a varied key is called: the length of a line that two phases share
changes both of them.

    beginnings/KEY     the folder of a run that stops at a hand-over
"""

from __future__ import annotations

import shutil
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import takewhile
from pathlib import Path
from types import MappingProxyType

from dcone_cosim.cases.case import Begins, Case, code, content, digest, identities
from dcone_cosim.drafts import PROVENANCE, atomic_folder
from dcone_cosim.errors import InputError
from dcone_cosim.loading import load
from dcone_cosim.results import Begun, RunResult
from dcone_cosim.run_folder import fill
from dcone_cosim.run_reading import provenance_of, read_run
from dcone_cosim.running import Ran
from dcone_cosim.scene.data import Scene

FOLDER = "beginnings"
NOWHERE: Mapping[str, Path] = MappingProxyType({})


@dataclass(frozen=True)
class Beginning:
    """The first phases of a scene, to be run or to be gone on from; plain data.

    key      hash of all that settles its numbers
    scene    one that begins so
    over     names of these phases
    until    name of the phase that takes over from them
    folder   where it is kept
    before   a shorter one that this one goes on from, None where it begins at the beginning
    """

    key: str
    scene: Scene
    over: tuple[str, ...]
    until: str
    folder: Path
    before: Beginning | None = None

    @property
    def begins(self) -> Begins:
        return Begins(self.folder, self.over)

    def parts(self) -> Iterator[Beginning]:
        """This one, and those that it goes on from."""
        yield self
        if self.before is not None:
            yield from self.before.parts()

    @property
    def is_there(self) -> bool:
        return (self.folder / PROVENANCE).is_file()


def key_of_beginning(scene: Scene, fmus: Mapping[str, str], count: int) -> str:
    """Hash of the first phases of a scene.

    fmus    what each FMU is, see `case.identities`
    count   of the phases; another one comes after them

    Checked  tests/cases/test_beginnings.py
    """
    found, over = content(scene), [phase.name for phase in scene.phases[:count]]
    parts = {name: fmu for name, fmu in fmus.items() if name.partition(",")[0] in over}
    between = found["handoff"] if count > 1 else None
    return digest("beginning", found["phases"][:count], between, scene.phases[count].name, parts, code())


def kept_of(folder: Path) -> dict[str, Path]:
    """The beginnings that a run has left in its folder, by their keys; `InputError` where it is not the folder of one.

    A run that another version made, or whose accuracy was chosen, has none.

    Checked  tests/cases/test_beginnings.py: a sweep of a run
    """
    told, scene = provenance_of(folder), load(str(folder))
    if scene.accuracy is not None or told.get("packages", {}).get("dcone-cosim") != code()["dcone-cosim"]:
        return {}
    fmus, found = identities(told["phases"]), {}
    for count, phase in enumerate(scene.phases[:-1], start=1):
        if not told["phases"].get(phase.name, {}).get("left"):
            break
        found[key_of_beginning(scene, fmus, count)] = folder
    return found


def shared(
    cases: Sequence[tuple[Case, Mapping[str, str]]], folder: Path, kept: Mapping[str, Path] = NOWHERE
) -> dict[str, Beginning]:
    """The longest beginning that a case has in common with another, or with a run that is there, by the case's key.

    cases     with what their FMUs are
    folder    in which beginnings are kept
    kept      folders of others, by the keys of the beginnings there
    """
    keys = {
        case.key: [key_of_beginning(case.scene, fmus, count) for count in range(1, len(case.scene.phases))]
        for case, fmus in cases
    }
    often = Counter(key for own in keys.values() for key in own)
    made: dict[str, Beginning] = {}
    found = {}
    for case, _ in cases:
        names, before = [phase.name for phase in case.scene.phases], None
        for place, key in enumerate(keys[case.key], start=1):
            if often[key] < 2 and key not in kept:
                break
            if key not in made:
                over = tuple(names[:place])
                where = kept.get(key, folder / FOLDER / key)
                made[key] = Beginning(key, case.scene, over, names[place], where, before)
            before = made[key]
        if before is not None:
            found[case.key] = before
    return found


def in_order(wanted: Sequence[Beginning]) -> list[list[Beginning]]:
    """Those to be run, each once, in turns: what a turn goes on from is there after the one before it."""
    turns: dict[int, dict[str, Beginning]] = {}
    for last in wanted:
        for beginning in takewhile(lambda part: not part.is_there, last.parts()):
            turns.setdefault(len(beginning.over), {})[beginning.key] = beginning
    return [list(turns[length].values()) for length in sorted(turns)]


def write(beginning: Beginning, ran: Ran) -> None:
    """Keep what was run; another process may have been first, and says the same."""
    summary = {"status": ran.result.status, "message": ran.result.message, "until": beginning.until}
    with atomic_folder(beginning.folder) as draft:
        fill(draft.path, ran.result, ran.facts, summary, ran.started)
    if draft.folder.absolute() != beginning.folder.absolute():
        shutil.rmtree(draft.folder, ignore_errors=True)


def begun(begins: Begins, scene: Scene) -> Begun | None:
    """What is gone on from; None where it is not there or damaged: the case is then run from its beginning."""
    try:
        following = [phase.name for phase in scene.phases][len(begins.over)]
        before: RunResult = read_run(begins.folder, scene, following)
    except InputError:
        return None
    return Begun(before, begins.over) if tuple(before.phases) == begins.over else None
