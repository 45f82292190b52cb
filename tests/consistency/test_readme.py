"""The README's commands do what it says: each is run as it stands, in an empty folder."""

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

README = Path(__file__).parents[2] / "README.md"
COMMANDS = [
    line
    for block in re.findall(r"^```sh\n(.*?)^```$", README.read_text(), re.DOTALL | re.MULTILINE)
    for line in block.splitlines()
    if line.strip()
]


def test_two_lines_are_two():
    (block,) = re.findall(r"^```sh two-lines\n(.*?)^```$", README.read_text(), re.DOTALL | re.MULTILINE)
    assert len(block.splitlines()) == 2
    assert "dcone run mission" in block
    assert "pytest" in block


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("readme")


@pytest.mark.parametrize("command", COMMANDS)
def test_command_runs(command, folder):
    program, *arguments = shlex.split(command)
    assert program == "dcone"
    done = subprocess.run(
        [str(Path(sys.executable).with_name("dcone")), *arguments],
        cwd=folder,
        env=os.environ,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr


def test_figures_of_the_readme_are_there():
    for path in re.findall(r"!\[.*?\]\((.*?)\)", README.read_text()):
        assert (README.parent / path).is_file()
