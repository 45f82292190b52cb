"""Runs a driver in a process of its own: the tools' native libraries clash, may crash, and leave threads behind."""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from tests.interop.job import Job, Row, write

ROOT = Path(__file__).parents[2]
TIMEOUT = 300.0
"""Longest time a tool may take for its jobs [s]: against hangs. On a machine of its own it needs a few, syssimx ten."""


@dataclass(frozen=True)
class Found:
    """What a tool gave: its version, and for each job a row of outputs per look."""

    version: str
    rows: list[list[Row]]


def run_tool(driver: str, jobs: Sequence[Job]) -> Found:
    """Let a driver do the jobs; a crash, a hang or a refusal fails the test with all it wrote."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        write(folder / "jobs.json", jobs)
        command = [sys.executable, "-m", f"tests.interop.drivers.{driver}", str(folder / "jobs.json")]
        done = subprocess.run(
            [*command, str(folder / "found.json")],
            cwd=ROOT,
            capture_output=True,
            text=True,
            timeout=TIMEOUT,
            check=False,
        )
        assert done.returncode == 0, f"{driver} ended with {done.returncode}\n{done.stdout}\n{done.stderr}"
        found = json.loads((folder / "found.json").read_text())
    return Found(found["version"], found["rows"])
