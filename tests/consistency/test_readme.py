"""The READMEs' commands do what they say, each run as it stands; and what a README points to is there.

The blocks marked `sh` and `python` of one README run in the order of the page, in a folder of their own that is empty
at first: a command may use what one above it has written. The first command of the first page is run as it is typed,
and its Python too; all else runs in this process, which has loaded already what a command loads.
"""

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from dcone_cosim import cli

ROOT = Path(__file__).parents[2]
README = ROOT / "README.md"
PLACES = (".readme", "dcone_cosim", "fmu_src", "orbital", "tests")
PAGES = [README, *sorted(page for place in PLACES for page in (ROOT / place).rglob("*.md"))]
HERE = "here"
"""In this process: dcone, or a piece of Python."""
LONGEST = 200
"""Lines that a newcomer is asked to read."""


def blocks(text, language):
    """The fenced blocks of a language, in order."""
    return re.findall(rf"^```{language}\n(.*?)^```$", text, re.DOTALL | re.MULTILINE)


def steps(page):
    """Commands by line and pieces of Python, in the order of the page."""
    alone = page == README
    for language, block in re.findall(r"^```(sh|python)\n(.*?)^```$", page.read_text(), re.DOTALL | re.MULTILINE):
        if language == "python":
            yield [sys.executable if page == README else HERE, "-c", block]
            continue
        for line in filter(str.strip, block.splitlines()):
            program, *arguments = shlex.split(line)
            assert program == "dcone", f"{line}: only dcone is run here"
            yield [str(Path(sys.executable).with_name("dcone")) if alone else HERE, *arguments]
            alone = False


def named(page):
    return page.relative_to(ROOT).as_posix()


def prose(text):
    """The page without its blocks, indented ones included."""
    text = re.sub(r"^```.*?^```$", "", text, flags=re.DOTALL | re.MULTILINE)
    return re.sub(r"^    .*$", "", text, flags=re.MULTILINE)


def anchors(text):
    """What headings can be linked to by, as GitHub makes it: lower case, no punctuation, hyphens for blanks."""
    heads = re.findall(r"^#+ (.*)$", prose(text), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", head.lower()).replace(" ", "-") for head in heads}


def dead_links(page, text):
    """Links of a page that lead nowhere: files that are not there, headings that a page does not have."""
    for link in re.findall(r"\]\(([^)\s]+)\)", prose(text)):
        if re.match(r"[a-z]+:", link):
            continue
        path, _, anchor = link.partition("#")
        there = (page.parent / path).resolve() if path else page
        if not there.is_file() or (anchor and anchor not in anchors(text if there == page else there.read_text())):
            yield link


def lost_files(text):
    """Files of the tests that a page names, in prose or in a command, and that are not there."""
    for path in re.findall(r"\btests/[\w/.-]*\w", text):
        if not (ROOT / path).exists():
            yield path
    for module in re.findall(r"python -m (tests[.\w]*\w)", text):
        place = ROOT / module.replace(".", "/")
        if not (place.with_suffix(".py").is_file() or (place / "__main__.py").is_file()):
            yield module


@pytest.fixture(scope="module")
def folders(tmp_path_factory):
    """A folder for each page."""
    return {page: tmp_path_factory.mktemp("page") for page in PAGES}


STEPS = [
    pytest.param(page, step, id=f"{named(page)}: {' '.join(step[1:]).partition(chr(10))[0]}")
    for page in PAGES
    for step in steps(page)
]


@pytest.mark.parametrize(("page", "command"), STEPS)
def test_command_runs(page, command, folders, monkeypatch, capfd):
    if command[0] == HERE:
        monkeypatch.chdir(folders[page])
        if command[1] == "-c":
            exec(compile(command[2], f"{named(page)}, Python", "exec"), {"__name__": "__main__"})
            return
        monkeypatch.setattr(sys, "argv", ["dcone", *command[1:]])
        with pytest.raises(SystemExit) as stop:
            cli.main()
        assert not stop.value.code, "".join(capfd.readouterr())
        return
    done = subprocess.run(
        command,
        cwd=folders[page],
        env=os.environ,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr


def test_two_lines_are_two():
    (block,) = blocks(README.read_text(), "sh two-lines")
    assert len(block.splitlines()) == 2
    assert "dcone run mission" in block
    assert "pytest" in block


def test_the_first_page_is_short():
    assert len(README.read_text().splitlines()) <= LONGEST


def test_every_page_is_within_reach_of_the_first():
    """By links alone, so that no page is forgotten; the templates' is written for who uses them."""
    seen, found = set(), [README]
    while found:
        page = found.pop()
        if page in seen:
            continue
        seen.add(page)
        links = re.findall(r"\]\(([^)\s#]+\.md)", page.read_text())
        found += [(page.parent / link).resolve() for link in links]
    templates = ROOT / "dcone_cosim" / "templates"
    assert {page for page in PAGES if templates not in page.parents} == seen


@pytest.mark.parametrize("page", PAGES, ids=named)
def test_links_and_pictures_lead_somewhere(page):
    text = page.read_text()
    assert list(dead_links(page, text)) == []
    wrong = text + "\n[one](no-such-page.md) [two](#no-such-heading) ![three](none.png)\n"
    assert list(dead_links(page, wrong)) == ["no-such-page.md", "#no-such-heading", "none.png"]


@pytest.mark.parametrize("page", PAGES, ids=named)
def test_files_of_the_tests_that_are_named_are_there(page):
    text = page.read_text()
    assert list(lost_files(text)) == []
    wrong = text + "\n`pytest tests/none/test_such.py`, `python -m tests.none.such`\n"
    assert list(lost_files(wrong)) == ["tests/none/test_such.py", "tests.none.such"]
