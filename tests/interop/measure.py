"""The tools, and what each makes of the two runs: measured once, for the tests and for the packaging's README."""

from __future__ import annotations

import functools
import tempfile
from collections.abc import Iterable
from dataclasses import dataclass, replace
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from dcone_cosim import build
from dcone_cosim.fmu.archive import Archive
from tests.interop.cases import (
    CASES,
    Points,
    added_up,
    added_up_to_the_end,
    by_component,
    differing,
    farthest,
    moved,
    multiples,
    multiples_of_equal_steps,
)
from tests.interop.children import Found, run_tool
from tests.interop.job import Job, Row

SPREAD = 1e-9
"""Relative difference allowed in a run's figures when a tool's times drift from the master's by rounding."""


@dataclass(frozen=True)
class Tool:
    """A tool that steps FMUs.

    title        in the table
    package      on PyPI
    points       the times it hands to the FMU, found by trial: with no other do all bits agree
    arithmetic   these in words, when they are not the master's
    coarse       its steps are so many times longer: for a tool that takes long over many outputs
    """

    title: str
    package: str
    points: Points = multiples
    arithmetic: str = ""
    coarse: int = 1

    @property
    def version(self) -> str:
        """That installed here, or nothing."""
        try:
            return version(self.package)
        except PackageNotFoundError:
            return ""


TOOLS = {
    "fmpy": Tool("fmpy, `simulate_fmu`", "fmpy"),
    "fmuloader": Tool("fmuloader, a loop t += h around it", "fmuloader", added_up, "t += h"),
    "libcosimpy": Tool("libcosimpy (libcosim; time in nanoseconds)", "libcosimpy"),
    "ecospy": Tool("ecospy (Ecos)", "ecospy", added_up, "t += h"),
    "syssimx": Tool("syssimx", "syssimx", added_up_to_the_end, "t += h, the last to the end", coarse=8),
    "container": Tool(
        "fmu-manipulation-toolbox, an FMU container run by fmpy",
        "fmu-manipulation-toolbox",
        multiples_of_equal_steps,
        "from i h by h",
    ),
}
JOBS = ("binary", "decimal", "moved", "built")
"""What each tool is asked for: both grids, and the binary one with a parameter moved, and with nothing to set."""


@functools.cache
def job(tool: str, case: str, which: str) -> Job:
    given = CASES[case]
    if which == "moved":
        return moved(given.job("binary", TOOLS[tool].coarse), given)
    if which == "built":
        fmu, guid = built(case, TOOLS[tool].coarse)
        return replace(given.job("binary", TOOLS[tool].coarse), fmu=fmu, guid=guid, parameters={})
    return given.job(which, TOOLS[tool].coarse)


@functools.cache
def folder() -> tempfile.TemporaryDirectory[str]:
    """Where FMUs are that start with the values of a run."""
    return tempfile.TemporaryDirectory()


@functools.cache
def built(case: str, coarse: int) -> tuple[str, str]:
    """Path and GUID of an FMU that starts with the parameters of a run, so that none is left to set."""
    given, about = CASES[case].job("binary", coarse), CASES[case]
    experiment = build.Experiment(0.0, about.length, given.step, case)
    wanted = build.Furnished(f"{case}-{coarse}", given.identifier, about.terms, given.parameters, experiment)
    (path,) = build.write_fmus([wanted], (), Path(folder().name), print)
    with Archive(path) as archive:
        return str(path), archive.guid


@functools.cache
def found(tool: str) -> Found:
    """What the tool made of all its jobs; the first call runs it."""
    return run_tool(f"{tool}_tool", [job(tool, case, which) for case in CASES for which in JOBS])


def theirs(tool: str, case: str, which: str) -> list[Row]:
    return found(tool).rows[list(CASES).index(case) * len(JOBS) + JOBS.index(which)]


@functools.cache
def _component(case: str, which: str, coarse: int, points: Points) -> list[Row]:
    tool = next(name for name, tool in TOOLS.items() if tool.coarse == coarse)
    return by_component(job(tool, case, which), points)


def ours(tool: str, case: str, which: str, points: Points = multiples) -> list[Row]:
    """The same job by our `Component`, over the master's points unless others are given."""
    return _component(case, which, TOOLS[tool].coarse, points)


def verdict(tool: str, case: str, which: str) -> str:
    """What the table says of one run."""
    given, about = job(tool, case, which), TOOLS[tool]
    length = f"{given.steps} steps of {given.step:g} s"
    found_here, master = theirs(tool, case, which), ours(tool, case, which)
    if not differing(master, found_here):
        return f"same bits over {length}"
    own = ours(tool, case, which, about.points)
    if not differing(own, found_here) and farthest(master, found_here, CASES[case].figures) <= SPREAD:
        spread = f"{SPREAD:g}".replace("e-0", "e-")
        return f"within {spread} over {length}: it steps {about.arithmetic}; same bits as the master's at those times"
    return "differs"


def rows(tools: Iterable[str]) -> dict[tuple[str, str], str]:
    """The lines of that README's table by tool and run."""
    lines = {}
    for tool in tools:
        for case, about in CASES.items():
            cells = (TOOLS[tool].title, found(tool).version, about.title)
            verdicts = [verdict(tool, case, which) for which in ("binary", "decimal")]
            lines[tool, case] = "| " + " | ".join([*cells, *verdicts]) + " |"
    return lines
