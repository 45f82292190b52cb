"""A gallery of two scenes: pages and index; what is there stays, what fails is told."""

from __future__ import annotations

import re
from pathlib import Path

from dcone_cosim.errors import OVERLOADED
from dcone_cosim.loading import named, shipped
from dcone_cosim.progress import Progress
from dcone_cosim.report.gallery import DAY, GROUPS, cuts, group_of, make
from dcone_cosim.report.page import answer_of
from dcone_cosim.run_reading import read_run
from tests.report.conftest import Page
from tests.runs import COARSE


def test_pages_and_index(tmp_path: Path, kept: Path) -> None:
    """The scene is that of `kept`, so its FMUs are there."""
    scene = tmp_path / "small.toml"
    scene.write_text(named("mission", COARSE).text)
    bad = tmp_path / "bad.toml"
    bad.write_text(named("mission", COARSE).text)
    out = tmp_path / "gallery"
    index, failed = make([str(scene)], out, Progress())
    assert failed == {}
    page = Page(index.read_text())
    assert "small.html" in page.links
    assert "first tug" in page.text
    assert "Shot, capture and tow" in page.text
    assert "index.html" in Page((out / "small.html").read_text()).links
    assert Page((out / "small.html").read_text()).data["clips"][0]["net"]["tensions"]
    told = [row["since"] for row in answer_of(out / "small.html") if "as the target is a point" in row["since"]]
    assert len(told) == 2
    for since in told:
        off = re.search(r"off by [\d.]+ %, bounded by [\d.]+ %, as the target is a point$", since)
        assert off is not None
        assert off[0] in page.text, "a card tells what the page tells"
    assert answer_of(index) == []
    before = (out / "small.html").stat().st_mtime_ns
    make([str(scene)], out, Progress())
    assert (out / "small.html").stat().st_mtime_ns == before


def test_a_run_whose_lines_do_not_bear_it_is_not_among_those_that_do(bare: Path) -> None:
    run = read_run(bare)
    assert group_of(run) == GROUPS[0]
    run.fail("overloaded", "", OVERLOADED)
    assert group_of(run) == GROUPS[-1]


def test_long_phases_are_cut_to_a_day() -> None:
    long = [name for name in shipped() if cuts(name)]
    for name in long:
        assert max(phase.duration for phase in named(name, cuts(name)).phases) == DAY
    assert cuts("mission") == []
