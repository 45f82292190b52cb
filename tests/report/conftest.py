"""Runs of which pages are made: the mission with a coarse net, with and without its net kept in full."""

from __future__ import annotations

import json
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import pytest

from dcone_cosim.commands import run_and_write
from dcone_cosim.progress import Progress
from dcone_cosim.report.page import of_folder
from tests.runs import COARSE, put


@pytest.fixture(scope="session")
def kept(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """With `--replay`, a state on the way, and figures."""
    done = run_and_write(
        "mission",
        tmp_path_factory.mktemp("kept") / "run",
        Progress(),
        settings=COARSE,
        save_at=["capture:4 s"],
        replay=True,
    )
    assert done.result.exit_code == 0
    return done.folder


@pytest.fixture(scope="session")
def bare(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """As it is: snapshots of the net, no tensions, no figures."""
    return put("mission", tmp_path_factory.mktemp("bare") / "run", COARSE)


class Page(HTMLParser):
    """What stands in a page.

    text    all that a reader sees, in order    links    of `href` and `src`
    rows    cells of every row of every table   data     what its scripts are given
    """

    def __init__(self, content: str) -> None:
        super().__init__()
        self.text, self.links, self.rows, self.scripts = "", list[str](), list[list[str]](), dict[str, str]()
        self._in, self._cell = "", False
        self.feed(content)
        self.data: dict[str, Any] = json.loads(self.scripts.get("data", "{}"))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = dict(attrs)
        self.links += [str(given[name]) for name in ("href", "src") if given.get(name)]
        if tag in ("script", "style"):
            self._in = given.get("id") or given.get("type") or tag
        if tag == "tr":
            self.rows.append([])
        if tag in ("td", "th"):
            self.rows[-1].append("")
            self._cell = True

    def handle_endtag(self, tag: str) -> None:
        if tag in ("script", "style"):
            self._in = ""
        if tag in ("td", "th"):
            self._cell = False

    def handle_data(self, data: str) -> None:
        if self._in:
            self.scripts[self._in] = self.scripts.get(self._in, "") + data
            return
        self.text += data
        if self._cell:
            self.rows[-1][-1] += data

    def row(self, *begins: str) -> list[str]:
        """The first row whose first cells are these."""
        return next(row for row in self.rows if row[: len(begins)] == list(begins))


@pytest.fixture(scope="session")
def page(kept: Path) -> Page:
    return Page(of_folder(kept, kept / "report.html"))
