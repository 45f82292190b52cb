"""How a folder comes to be whole or not at all.

It is filled under another name beside its place, forced to disk and renamed. A folder that came to be in its place
meanwhile is never touched: the results then go beside it under the next free name. What fails removes its draft; what
dies cannot, and the next one here removes the draft for it (see `scratch`).
"""

from __future__ import annotations

import itertools
import json
import os
import shutil
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager, suppress
from pathlib import Path

from dcone_cosim import placed
from dcone_cosim.errors import InputError
from dcone_cosim.interrupts import postponed
from dcone_cosim.names import check_text
from dcone_cosim.scratch import Scratch

PROVENANCE = "provenance.json"
"""The file by which a folder is known as that of a run; its `files` are all that the run wrote."""
LITTER = (".DS_Store", "Thumbs.db", "desktop.ini")
"""What file managers leave in every folder that they show."""
TOLD = 5
"""How many files of others a refusal names."""


def check_free(folder: Path, force: bool) -> None:
    """Refuse a place that is taken, before any work is done; an empty folder is free."""
    if not _is_free(folder):
        if not force:
            raise InputError(f"{folder} already exists; choose another place with -o, or replace it with --force")
        written = _written(folder)
        if written is None:
            raise InputError(f"{folder} is not the folder of a run: --force will not replace it")
        others = _others(folder, written)
        if others:
            more = f" and {len(others) - TOLD} more" if len(others) > TOLD else ""
            raise InputError(
                f"{folder} holds what no run wrote there: {', '.join(others[:TOLD])}{more}; "
                "--force replaces the files of a run alone: move these, or choose another place with -o"
            )
    _try_place(folder, folder.absolute().parents)


def check_folder(folder: Path) -> None:
    """Refuse a folder that files cannot be written to, before any work is done; one that is not there is made later."""
    if folder.exists() and not folder.is_dir():
        raise InputError(f"{folder} is not a folder")
    _try_place(folder, (folder.absolute(), *folder.absolute().parents))


def _try_place(folder: Path, parents: Sequence[Path]) -> None:
    """Refuse a place where no folder can be made, by making one of that name, in the first of the parents that is
    there, that does not stay."""
    check_text(str(folder))
    place = folder.absolute()
    above = next(p for p in parents if os.path.lexists(p))
    try:
        with Scratch(above) as trial:
            (trial / place.relative_to(above)).mkdir(parents=True, exist_ok=True)
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) else str(error)
        raise InputError(f"{folder} cannot be written: {reason}") from None


def _is_free(folder: Path) -> bool:
    if not os.path.lexists(folder):
        return True
    return folder.is_dir() and not folder.is_symlink() and not any(folder.iterdir())


def contents(folder: Path) -> list[str]:
    """Every file below, and every folder that has none, relative to it."""
    found = []
    for path in folder.rglob("*"):
        if path.is_symlink() or not path.is_dir() or not any(path.iterdir()):
            found.append(path.relative_to(folder).as_posix())
    return sorted(found)


def _written(folder: Path) -> set[str] | None:
    """The files that a run wrote into its folder, as its provenance lists them; None where no run has written."""
    try:
        told = json.loads((folder / PROVENANCE).read_text(encoding="utf-8"))
        return {str(name) for name in told.get("files", [PROVENANCE])}
    except (OSError, ValueError, TypeError, AttributeError):
        return None


def _others(folder: Path, written: set[str]) -> list[str]:
    """What is in the folder of a run beside the files that the run wrote."""
    return [name for name in contents(folder) if name not in written and name.rpartition("/")[2] not in LITTER]


class Draft:
    """The folder to fill, `path`, and, once it has taken its name, where that is: `folder`.

    removed      drafts that runs left here which are no more
    """

    def __init__(self, path: Path, folder: Path, removed: int) -> None:
        self.path, self.folder, self.removed = path, folder, removed


@contextmanager
def atomic_folder(folder: Path, force: bool = False) -> Iterator[Draft]:
    """A folder to fill, which takes its name only when the block ends well; otherwise nothing is left.

    force        replace a run of that name; otherwise what has the name by then keeps it, and the draft gets `name-2`
    """
    place = folder.absolute()
    made = [p for p in place.parents if not p.exists()]
    empty = place.is_dir() and _is_free(place)
    scratch = None
    try:
        place.parent.mkdir(parents=True, exist_ok=True)
        scratch = Scratch(place.parent)
        path = scratch.path
        path.chmod(0o755)
        draft = Draft(path, folder, scratch.removed)
        yield draft
        with ThreadPoolExecutor() as pool:  # one wait for the disk, not one for each file
            list(pool.map(to_disk, [*path.rglob("*"), path]))
        with postponed():
            if not (force and _replace(scratch, place)):
                draft.folder = folder.with_name(_take_name(scratch, place, empty).name)
            placed.note(draft.folder)
        to_disk(place.parent)
    finally:
        if scratch is not None:
            scratch.remove()
        for parent in made:
            with suppress(OSError):
                parent.rmdir()  # never one that holds what has just been written


def _replace(scratch: Scratch, place: Path) -> bool:
    """Put the draft in the place of an earlier run, which stays if that fails; False when there is none, or files of
    others have come into it meanwhile."""
    written = _written(place)
    if written is None or _others(place, written):
        return False
    scratch.name_place(place.name)
    place.rename(scratch.old)
    try:
        scratch.path.rename(place)
    except BaseException:
        scratch.old.rename(place)
        raise
    shutil.rmtree(scratch.old, ignore_errors=True)
    return True


def _take_name(scratch: Scratch, place: Path, empty: bool) -> Path:
    """Give the draft its name, or the first free one of `name-2`, `name-3`, ...: never one that something else has.

    Making an empty folder claims a name: it fails when there is anything, and a rename replaces nothing but an empty
    folder. `empty`: the place was an empty folder from the beginning, which need not be claimed.
    """
    for number in itertools.count(1):
        name = place if number == 1 else place.with_name(f"{place.name}-{number}")
        claimed = False
        scratch.name_place(name.name)
        try:
            if not (empty and number == 1 and name.is_dir()):
                name.mkdir()
                claimed = True
            if os.name == "nt":
                name.rmdir()
            scratch.path.rename(name)
        except OSError:
            if claimed:
                with suppress(OSError):
                    name.rmdir()
            if not os.path.lexists(name):
                raise
        except BaseException:
            if claimed and scratch.path.exists():
                with suppress(OSError):
                    name.rmdir()
            raise
        else:
            return name
    raise AssertionError("there is always a next number")


def to_disk(path: Path) -> None:
    """Have the system write a file, or the names in a folder, to its disk now."""
    if os.name == "nt" and path.is_dir():
        return
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
