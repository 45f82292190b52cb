"""Tables in an FMU's file: data beside one library, and no file without them."""

from __future__ import annotations

import hashlib
import re
import xml.etree.ElementTree as ET
import zipfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fmu_src.catalogue import MODELS
from fmu_src.packaging import builds, documentation, start_values, table_file
from fmu_src.packaging.description import Experiment
from fmu_src.tables import Table


def with_table():
    """A reel control whose motor brings a table, as far as its interface says."""
    model = MODELS["reel_control"]
    lag = replace(model.groups["motor"].terms["lag"], tables=(Table("torque", "N", "of the motor by its speed"),))
    return replace(model, groups={**model.groups, "motor": replace(model.groups["motor"], terms={"lag": lag})})


@pytest.fixture
def write(monkeypatch, tmp_path):
    """Write such an FMU; compiler and linker only pretend, and are counted."""
    called = []
    monkeypatch.setattr(builds.compile, "emit", lambda model, terms, ir, kept: (called.append("compiled"), ir.touch()))
    monkeypatch.setattr(
        builds.link, "link", lambda ir, header, library, targets: (called.append("linked"), library.touch())
    )
    plain = with_table().interface({"motor": "lag"})

    def make(name, given, stored=None):
        fmu = builds.build(stored or plain, tmp_path / "cache")
        path = tmp_path / name
        experiment = Experiment(0.0, 7.5, 2.0, "tow")
        builds.furnish({fmu: ["linux64"]}, plain.with_tables(given) if given else plain, experiment, path)
        with zipfile.ZipFile(path) as content:
            return {name: content.read(name) for name in content.namelist()}

    return make, called, plain


def test_another_table_costs_neither_compiler_nor_linker_and_is_another_guid(write):
    make, called, plain = write
    one = make("one", {"torque": [1.0, 2.0]}, stored=plain.with_tables({"torque": [5.0]}))
    two = make("two", {"torque": [1.0, 2.0, 3.0]})
    assert called == ["compiled", "linked"]
    assert {name for name in one if one[name] != two.get(name)} == {
        "modelDescription.xml",
        "documentation/index.html",
        start_values.PATH,
        table_file.PATH,
    }
    guids = {ET.fromstring(f["modelDescription.xml"]).get("guid") for f in (one, two)}
    keys = {start_values.library_of(f[start_values.PATH]) for f in (one, two)}
    assert (len(guids), len(keys)) == (2, 1)
    assert make("three", {"torque": [1.0, 2.0]}) == one


def test_no_fmu_is_written_without_its_tables(write, tmp_path):
    make, _, plain = write
    builds.build(plain.with_tables({"torque": [5.0]}), tmp_path / "cache")
    with pytest.raises(ValueError, match=r"this reel_control needs the table torque \(of the motor by its speed\)"):
        make("none", None)
    assert not (tmp_path / "none").exists()
    (kept,) = (tmp_path / "cache").glob("*.fmu")
    with zipfile.ZipFile(kept) as content:
        assert table_file.PATH not in content.namelist(), "what is built once serves all tables"


def test_the_page_lists_them(write):
    make, _, _ = write
    page = make("one", {"torque": [1.0, 2.0]})["documentation/index.html"].decode()
    section = page.partition("<h2>Tables of this FMU</h2>")[2].partition("<h2>")[0]
    cells = [re.sub("<.*?>", "", cell) for cell in re.findall(r"<td>(.*?)</td>", section)]
    digest = hashlib.sha256(np.array([1.0, 2.0]).tobytes()).hexdigest()
    assert cells == ["torque", "2", "N", digest[:16], "of the motor by its speed"]
    assert "Tables of this FMU" not in documentation.page(MODELS["reel_control"].interface({}), Path("nowhere"))
