"""Whether what is told of an error is no less than it: the table in dcone_cosim/README.md.

    python -m tests.accuracy.evidence.bounds [SCENE ...]

judges each scene of tests/accuracy/test_met.py, of which the table of settings knows nothing, at each accuracy, keeps
the rows in bounds.json, those of other scenes as they were, and prints them. A tow takes seconds, a net minutes; FMUs
of other schemes are built first.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping, Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Any

from dcone_cosim.accuracy.show import percent
from dcone_cosim.errors import InputError
from tests.accuracy.test_met import SCENES, judged

COMMAND = "python -m tests.accuracy.evidence.bounds"
FILE = Path(__file__).with_suffix(".json")
ASKED = (0.01, 0.001)
OF_TOWS = (2e-5, 1e-7)
"""Asked of tows that do not scatter too."""


def row(name: str, asked: float) -> dict[str, Any]:
    made: dict[str, Any] = {"scene": name, "asked": asked, "version": version("dcone-cosim")}
    try:
        found = judged(SCENES[name], asked)
    except InputError as error:
        return made | {"refused": str(error).splitlines()[-1].strip()}
    told = {"estimated": found.estimated, "true": found.true, "unsure": found.unsure}
    return made | {"setting": found.setting, "runs": found.runs} | {k: float(f"{v:.2g}") for k, v in told.items()}


def table(rows: Sequence[Mapping[str, Any]]) -> str:
    """As Markdown, what comes to the same in one row."""
    told: dict[tuple[str, str], list[str]] = {}
    for one in rows:
        told.setdefault((one["scene"], _found(one)), []).append(percent(one["asked"]))
    lines = ["| scene | asked | told | truly | with |", "| --- | --- | --- | --- | --- |"]
    lines += [f"| {scene} | {', '.join(asked)} | {found} |" for (scene, found), asked in told.items()]
    return "\n".join(lines)


def _found(one: Mapping[str, Any]) -> str:
    if "refused" in one:
        return f"refused | | {one['refused'].partition(': ')[2].partition(';')[0].partition(' (')[0]}"
    runs = f", mean of {one['runs']} runs" if one["runs"] > 1 else ""
    unsure = f" ± {percent(one['unsure'])}" if one["unsure"] > 0.05 * one["true"] else ""
    return f"{percent(one['estimated'])} | {percent(one['true'])}{unsure} | `{one['setting']}`{runs}"


def main(names: Sequence[str]) -> None:
    rows = json.loads(FILE.read_text(encoding="utf-8"))["rows"] if FILE.is_file() else []
    for name in names or SCENES:
        case = SCENES[name]
        fine = OF_TOWS if case.fine and case.fine[0].startswith("removal") and not case.refused else ()
        found = []
        for asked in (*ASKED, *fine):
            found.append(row(name, asked))
            print(found[-1], file=sys.stderr, flush=True)
        rows = [one for one in rows if one["scene"] != name] + found
        order = list(SCENES)
        rows.sort(key=lambda one: (order.index(one["scene"]), -one["asked"]))
        kept = ",\n".join(json.dumps(one) for one in rows)
        FILE.write_text(f'{{"command": "{COMMAND}",\n "rows": [\n{kept}\n]}}\n', encoding="utf-8")
    print(table(rows))


if __name__ == "__main__":
    main(sys.argv[1:])
