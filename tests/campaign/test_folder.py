"""Folders that are no campaign's, or are damaged: told in words, whatever is there instead."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from dcone_cosim.campaign.commands import shown
from dcone_cosim.campaign.folder import KIND, _from_table, kept
from dcone_cosim.errors import InputError
from tests.campaign.conftest import TOW
from tests.cosim.conftest import Dcone

SUBSET = (
    'title = "t"\nscene = "table2-deorbit"\nseed = 1\nsampler = "subset"\nn = 10\n'
    'success = { figure = "removal.largest_tug_peak", below = "50 N" }\n'
    '[[dispersion]]\nkey = "removal.thrust.level"\ndistribution = "normal"\ndeviation = "5 %"\n'
)


def study(folder: Path, **other: object) -> Path:
    folder.mkdir(exist_ok=True)
    told = {"kind": KIND, "campaign": TOW + "jitter = true\n", "name": "t", "file": "t.toml", "fmus": {}, "code": {}}
    whole = {name: value for name, value in (told | other).items() if value is not None}
    (folder / "study.json").write_text(json.dumps(whole))
    return folder


def put(folder: Path, name: str, text: str) -> Path:
    folder.mkdir(exist_ok=True)
    (folder / name).write_text(text)
    return folder


def file(folder: Path) -> Path:
    folder.write_text("a file")
    return folder


def empty(folder: Path) -> Path:
    folder.mkdir()
    return folder


RUN = '{"scene": "edt", "title": "a run", "status": "completed"}'


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda folder: folder, "is not the folder of a campaign: not there"),
        (file, "is not the folder of a campaign: a file"),
        (empty, "is not the folder of a campaign: it has no study.json"),
        (lambda folder: put(folder, "summary.json", RUN), "is not the folder of a campaign: it has no study.json"),
        (lambda folder: study(folder, kind="a sweep over x"), "holds a sweep over x, not a campaign"),
        (lambda folder: study(folder, kind=None), "holds something else, not a campaign"),
        (lambda folder: put(folder, "study.json", '{"kind": "a camp'), "study.json cannot be read"),
        (lambda folder: put(folder, "study.json", "[]"), "study.json cannot be read"),
        (lambda folder: study(folder, campaign=None), "study.json has no campaign: the folder of this campaign is"),
        (lambda folder: study(folder, fmus=[]), "study.json has no fmus: the folder of this campaign is damaged"),
        (study, "scene.toml is not there: the folder of this campaign is damaged"),
        (lambda folder: put(study(folder), "scene.toml", "title = "), "is not valid TOML"),
    ],
)
def test_what_is_no_folder_of_a_campaign(make: Callable[[Path], Path], said: str, tmp_path: Path, dcone: Dcone) -> None:
    folder = make(tmp_path / "there")
    for command in (("show",), ("rerun", "1")):
        code, _, err = dcone("campaign", command[0], str(folder), *command[1:])
        assert (code, said in err) == (2, True), err


@pytest.mark.parametrize("text", [RUN, '{"title": "t", "said": [', '{"title": "t", "said": [], "figures": 3}', "3"])
def test_a_damaged_summary(text: str, tmp_path: Path) -> None:
    folder = put(study(tmp_path / "there"), "summary.json", text)
    with pytest.raises(InputError, match=r"summary.json (has no (said|figures): it is damaged|cannot be read)"):
        shown(folder)


def test_a_damaged_table(tmp_path: Path) -> None:
    """A rare failure's points are in the table alone."""
    from dcone_cosim.loading import load

    folder = put(study(tmp_path / "there", campaign=SUBSET), "scene.toml", load("table2-deorbit").text)
    found = kept(folder)
    with pytest.raises(InputError, match="is not complete"):
        _from_table(found, 1)
    (folder / "table.parquet").write_text("PAR1 no table")
    with pytest.raises(InputError, match=r"table\.parquet cannot be read .*: the folder of this campaign is damaged"):
        _from_table(found, 1)
