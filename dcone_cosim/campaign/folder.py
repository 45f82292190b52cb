"""The folder of a campaign: what is in it from the first moment, and how a case is found again.

study.json rows/           the result store; study.json has the campaign's text, and --cases
scene.toml fmus/           the scene with what the campaign sets in it
table.parquet table.csv    a row per case: number, values, outcome, figures; timings.parquet what each cost
summary.json               the answers
*.png report.html          pictures; all of it as one page
provenance.json            what made it
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from dcone_cosim.campaign.applied import base_of, inputs_of
from dcone_cosim.campaign.engine import Made
from dcone_cosim.campaign.inputs import Inputs
from dcone_cosim.campaign.outcomes import answered, outcome, settled
from dcone_cosim.campaign.reading import parse
from dcone_cosim.campaign.sampling import count_of, points
from dcone_cosim.campaign.spec import ADAPTIVE, SUBSET, Judged, Spec
from dcone_cosim.cases.store import STUDY
from dcone_cosim.cases.table import Column, Entry, columns
from dcone_cosim.errors import InputError
from dcone_cosim.run_reading import json_of
from dcone_cosim.scene.data import Scene

KIND = "a campaign"
TABLE, SUMMARY, SCENE = "table.parquet", "summary.json", "scene.toml"


def table(inputs: Inputs, made: Sequence[Made], derived: Mapping[str, Sequence[float]], judged: Judged) -> list[Column]:
    """Columns of the table: case, values, outcome, status, figures, key."""
    found = [Column("case", [one.number for one in made])]
    for place, one in enumerate(inputs.inputs):
        if one.texts:
            found.append(Column(one.name, [one.texts[int(case.values[place])] for case in made]))
        else:
            found.append(Column(one.name, [case.values[place] for case in made], one.unit))
    found.append(Column("outcome", [outcome(one.row, judged) if answered(one.row) else "no answer" for one in made]))
    taken = {column.name for column in found}
    rest = columns([Entry(one.row) for one in made])
    found += [Column(f"result.{c.name}", c.values, c.unit) if c.name in taken else c for c in rest[:-1]]
    found += [Column(name, list(column), "m") for name, column in derived.items()]
    return [*found, rest[-1]]


@dataclass(frozen=True)
class Kept:
    """A campaign as its folder has it."""

    folder: Path
    spec: Spec
    base: Scene
    inputs: Inputs


def study_of(folder: Path) -> Mapping[str, Any]:
    """What the folder of a campaign is of; `InputError` where it is none, or damaged.

    Checked  tests/campaign/test_folder.py
    """
    if not folder.is_dir():
        raise InputError(f"{folder} is not the folder of a campaign: {'a file' if folder.exists() else 'not there'}")
    if not (folder / STUDY).is_file():
        raise InputError(f"{folder} is not the folder of a campaign: it has no {STUDY}")
    told = json_of(folder / STUDY)
    if told.get("kind") != KIND:
        raise InputError(f"{folder} holds {told.get('kind', 'something else')}, not {KIND}")
    for name, kind in (("campaign", str), ("name", str), ("file", str), ("fmus", dict), ("code", dict)):
        if not isinstance(told.get(name), kind):
            raise _damaged(folder / STUDY, f"has no {name}")
    if type(told.get("cases", 1)) is not int:
        raise _damaged(folder / STUDY, f"has {told['cases']!r} cases")
    return told


def _damaged(file: Path, why: str) -> InputError:
    return InputError(f"{file} {why}: the folder of this campaign is damaged; give its command again with a new -o")


def kept(folder: Path) -> Kept:
    """The campaign of a folder; `InputError` where it is none."""
    told = study_of(folder)
    if not (folder / SCENE).is_file():
        raise _damaged(folder / SCENE, "is not there")
    spec = parse(told["campaign"], told["name"], told["file"], told.get("cases"))
    base = base_of(spec, folder / SCENE)
    spec = settled(spec, base)
    return Kept(folder, spec, base, inputs_of(spec, base))


def settings_of(found: Kept, number: int) -> tuple[str, ...]:
    """The settings of a case by its number, from 1; of 0 those of the scene as it is: none."""
    if number == 0:
        return ()
    spec, inputs = found.spec, found.inputs
    coordinates = [one.points for one in inputs.inputs]
    if spec.sampler in (ADAPTIVE, SUBSET):
        values = _from_table(found, number)
    else:
        count = count_of(spec, coordinates)
        most = spec.most if count is None else count
        if not 1 <= number <= most:
            raise InputError(f"case {number}: expected 0 for the scene as it is, or 1 to {most:,}")
        sequence = points(spec, coordinates)
        for _ in range(number - 1):
            next(sequence)
        values = inputs.values(next(sequence))
    return inputs.settings(values)


def _from_table(found: Kept, number: int) -> list[float]:
    """Values of a case from the table: where points hang on the rows before, they are not made again."""
    import pyarrow.parquet

    if not (found.folder / TABLE).is_file():
        raise InputError(f"{found.folder} is not complete: give the campaign's command again first")
    try:
        rows = pyarrow.parquet.read_table(found.folder / TABLE, columns=found.inputs.names)
    except (OSError, ValueError, KeyError) as error:
        raise _damaged(found.folder / TABLE, f"cannot be read ({error})") from None
    if not 1 <= number <= len(rows):
        raise InputError(f"case {number}: expected 0 for the scene as it is, or 1 to {len(rows):,}")
    return [
        float(one.texts.index(rows[one.name][number - 1].as_py()))
        if one.texts
        else float(rows[one.name][number - 1].as_py())
        for one in found.inputs.inputs
    ]


def summary_of(folder: Path) -> dict[str, Any] | None:
    """What `summary.json` tells; None where the campaign has not come to its end."""
    file = folder / SUMMARY
    if not file.is_file():
        return None
    told = json_of(file)
    for name, kind in (("title", str), ("said", list), ("figures", dict)):
        if not isinstance(told.get(name), kind):
            raise InputError(f"{file} has no {name}: it is damaged; give the campaign's command again, no case is lost")
    return told
