"""Numbers of ours held against numbers of others: checked where they are computed, told on one page.

    python -m tests.validation

runs the tests that use the fixture `validated` and writes `.readme/validation.json` and, from it,
`.readme/validation.md`; the extra `peers`, and brahe, have to be installed. With test files named after it, these alone
are run, and the rows of all others stay; the page says which. In any other run the fixture checks the same comparisons,
and that the page tells of each as it is: so the page says nothing that no test checks, and a test that is changed
without the page fails.

Checked  tests/consistency/test_validation.py
"""

from __future__ import annotations

import argparse
import json
import math
import os
import subprocess
import sys
from collections.abc import Mapping, Sequence
from datetime import date
from functools import cache
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
import pytest

ROOT = Path(__file__).parents[1]
RESULT = ROOT / ".readme" / "validation.json"
PAGE = RESULT.with_suffix(".md")
COMMAND = "python -m tests.validation"
OPTION = "--validation"
CLOSED_FORM, OTHER_CODE, EXPERIMENT = LEVELS = ("closed form", "code against code", "experiment")

OTHERS = frozenset({"brahe"})
"""Programs that are compared with and are no extra of ours."""

Row = dict[str, Any]
Numbers = float | Sequence[float] | npt.NDArray[np.float64]


class Source(NamedTuple):
    """Where a number comes from that is not ours: one of LEVELS, and the formula, program or publication."""

    level: str
    name: str


def closed_form(formula: str) -> Source:
    return Source(CLOSED_FORM, formula)


def other_code(which: str) -> Source:
    return Source(OTHER_CODE, which)


def experiment(publication: str) -> Source:
    return Source(EXPERIMENT, publication)


class Validated:
    """Comparisons of one test: `validated(closed_form("F L/EA"), "stretch", found, expected, "m", rel=1e-6)`.

    Exactly one of the tolerances is given:

    rel      largest difference, as a share of what is expected
    abs      largest difference, in the unit; may be an array
    within   lowest and highest value, None where there is no end; then nothing else is expected

    Numbers may be arrays: each is checked, and the one nearest to its tolerance is told.
    """

    def __init__(self, test: str, stored: Mapping[tuple[str, str], Sequence[Row]], folder: Path | None = None) -> None:
        self.test, self.stored, self.folder = test, stored, folder

    def __call__(
        self,
        source: Source,
        what: str,
        found: Numbers,
        expected: Numbers | None = None,
        unit: str = "",
        *,
        rel: float | None = None,
        abs: Numbers | None = None,
        within: tuple[float | None, float | None] | None = None,
    ) -> None:
        if source.level not in LEVELS:
            raise ValueError(f"{source.level}: a level is one of {', '.join(LEVELS)}")
        if sum(kind is not None for kind in (rel, abs, within)) != 1 or (expected is None) != (within is not None):
            raise ValueError("a comparison has what is expected and one of rel and abs, or within alone")
        row: Row = {"level": source.level, "what": what, "source": source.name, "unit": unit, "test": self.test}
        row |= _inside(found, within) if within is not None else _near(found, expected, rel, abs)
        told = f"{what}: {row['found']!r} {unit}, expected {row['expected']!r}, tolerance {row['tolerance']!r}"
        assert row["share"] <= 1.0, told
        if self.folder is not None:
            _append(self.folder, row)
        else:
            alike = np.ndim(0.0 if expected is None else expected) == 0, np.ndim(0.0 if abs is None else abs) == 0
            _told_as_it_is(row, self.stored.get((self.test, what), ()), *alike)


def _near(found: Numbers, expected: Numbers | None, rel: float | None, abs: Numbers | None) -> Row:
    ours, theirs = np.broadcast_arrays(np.asarray(found, float), np.asarray(expected, float))
    allowed = np.broadcast_to(np.abs(theirs) * rel if rel is not None else np.asarray(abs, float), ours.shape)
    assert ours.size, "nothing to compare"
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.where(ours == theirs, 0.0, np.abs(ours - theirs) / allowed).ravel()
    worst = int(share.argmax())  # one that is not a number if there is any, which is not below one either
    tolerance = {"rel": rel} if rel is not None else {"abs": float(allowed.ravel()[worst])}
    return {
        "expected": float(theirs.ravel()[worst]),
        "found": float(ours.ravel()[worst]),
        "tolerance": tolerance,
        "share": float(share[worst]),
        "of": ours.size,
    }


def _inside(found: Numbers, within: tuple[float | None, float | None]) -> Row:
    ours = np.asarray(found, float).ravel()
    low, high = within
    ends = [end for end in within if end is not None]
    assert ours.size, "nothing to compare"
    inside = (ours >= (-np.inf if low is None else low)) & (ours <= (np.inf if high is None else high))
    nearest = np.min([np.abs(ours - end) for end in ends], axis=0)
    half = 0.5 * (ends[1] - ends[0]) if len(ends) == 2 else np.abs(ends[0]) + nearest
    share = np.where(inside, 1.0 - nearest / np.maximum(half, np.finfo(float).tiny), np.inf)
    worst = int(share.argmax())
    return {
        "expected": None,
        "found": float(ours[worst]),
        "tolerance": {"within": [low, high]},
        "share": max(0.0, float(share[worst])),
        "of": ours.size,
    }


def _append(folder: Path, row: Row) -> None:
    """One file for each process of a run: nobody writes into another's."""
    folder.mkdir(parents=True, exist_ok=True)
    with (folder / f"{os.environ.get('PYTEST_XDIST_WORKER', 'main')}.jsonl").open("a", encoding="utf-8") as file:
        file.write(json.dumps(row) + "\n")


def _told_as_it_is(row: Row, stored: Sequence[Row], one_expected: bool, one_tolerance: bool) -> None:
    """That the stored result holds this comparison: same source, unit and tolerance, and the same number expected.

    one_expected, one_tolerance    the same for all elements: elsewhere the worst may be another one than it was
    """

    def same(other: Row) -> bool:
        mine, its = row["tolerance"], other["tolerance"]
        if mine.keys() != its.keys() or any(row[key] != other[key] for key in ("level", "source", "unit", "of")):
            return False
        if "abs" in mine:  # which may have been computed
            alike = not one_tolerance or math.isclose(mine["abs"], its["abs"], rel_tol=1e-3)
        elif "within" in mine:
            alike = all(_same_end(*ends) for ends in zip(mine["within"], its["within"], strict=True))
        else:
            alike = bool(mine == its)
        if "within" in mine or not one_expected:
            return alike
        return alike and abs(row["expected"] - other["expected"]) <= max(allowed(row), allowed(other))

    assert any(map(same, stored)), (
        f"{row['test']}: the validation page does not tell '{row['what']}' as it is here; `{COMMAND}` writes it anew"
    )


def _same_end(mine: float | None, its: float | None) -> bool:
    if mine is None or its is None:
        return mine is its
    return math.isclose(mine, its, rel_tol=1e-9)


def allowed(row: Row) -> float:
    """Largest difference, in the unit."""
    tolerance = row["tolerance"]
    return float(tolerance["abs"] if "abs" in tolerance else tolerance["rel"] * abs(row["expected"]))


@cache
def stored_rows() -> Mapping[tuple[str, str], Sequence[Row]]:
    """Rows of the stored result by test and what is compared; empty before there is one."""
    rows: dict[tuple[str, str], list[Row]] = {}
    for row in json.loads(RESULT.read_text(encoding="utf-8"))["rows"] if RESULT.is_file() else ():
        rows.setdefault((row["test"], row["what"]), []).append(row)
    return rows


def keep_validating(config: pytest.Config, items: list[pytest.Item]) -> None:
    """With the option, of all tests those that compare."""
    if config.getoption(OPTION) is None:
        return
    kept = [item for item in items if "validated" in getattr(item, "fixturenames", ())]
    config.hook.pytest_deselected(items=[item for item in items if item not in kept])
    items[:] = kept


def gathered(folder: Path) -> list[Row]:
    """Rows of all processes: by file, and within it as the tests run, which one process does."""
    lines = [line for file in sorted(folder.glob("*.jsonl")) for line in file.read_text(encoding="utf-8").splitlines()]
    return sorted(map(json.loads, lines), key=file_of)


def result(rows: Sequence[Row]) -> dict[str, Any]:
    """What is stored: rows of a run, and what made them."""
    return {
        "command": COMMAND,
        "version": {name: version(name) for name in ("dcone-cosim", "numba", "numpy")},
        "date": date.today().isoformat(),
        "rows": list(rows),
    }


def renewed(stored: Mapping[str, Any], rows: Sequence[Row], files: Sequence[str]) -> dict[str, Any]:
    """The same after a run of some files: their rows in place of those they had, and what made these, by file."""
    kept = [row for row in stored["rows"] if file_of(row) not in files]
    stamp = {"version": version("dcone-cosim"), "date": date.today().isoformat()}
    again = {**stored.get("again", {}), **dict.fromkeys(files, stamp)}
    every = sorted([*kept, *rows], key=file_of)
    return {**{key: value for key, value in stored.items() if key != "rows"}, "again": again, "rows": every}


def file_of(row: Row) -> str:
    return str(row["test"]).partition("::")[0]


def write(stored: Mapping[str, Any]) -> None:
    """The result, a row a line, and its page."""
    from tests.validation_page import render

    rows = ",\n".join(json.dumps(row) for row in stored["rows"])
    head = json.dumps({key: value for key, value in stored.items() if key != "rows"}, indent=1)
    RESULT.write_text(head.removesuffix("\n}") + ',\n "rows": [\n' + rows + "\n]}\n", encoding="utf-8")
    PAGE.write_text(render(stored), encoding="utf-8")


def main(arguments: Sequence[str] | None = None) -> int:
    from dcone_cosim.accuracy.peers import PEERS

    parser = argparse.ArgumentParser(prog=COMMAND, description="Run the comparisons and write the validation page.")
    parser.add_argument("-n", default="auto", metavar="PROCESSES", help="as pytest's (default: one for each core)")
    parser.add_argument("tests", nargs="*", help="test files whose rows alone are made anew (default: all)")
    given = parser.parse_args(arguments)
    files = [Path(name).resolve().relative_to(ROOT).as_posix() for name in given.tests]
    packages = {peer.package for kind in PEERS.values() for peer in kind} | OTHERS
    missing = {package for package in packages if find_spec(package) is None}
    if missing:
        told = f"their rows would be lost; pip install -e '.[test,peers]' {' '.join(OTHERS)} brings them"
        parser.error(f"not installed: {', '.join(sorted(missing))}: {told}")
    with TemporaryDirectory() as folder:
        markers = "not bench and not release"
        command = [sys.executable, "-m", "pytest", "-q", "-n", given.n, "-m", markers, f"{OPTION}={folder}"]
        command += files or ["tests"]
        done = subprocess.run(command, cwd=ROOT, check=False).returncode
        if done == 0:
            rows = gathered(Path(folder))
            stored = json.loads(RESULT.read_text(encoding="utf-8")) if files else {}
            write(renewed(stored, rows, files) if files else result(rows))
        else:
            print("The run has failed: the page stays as it was.", file=sys.stderr)
    return done


if __name__ == "__main__":
    sys.exit(main())
