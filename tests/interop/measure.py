"""The tools, and what each makes of the two runs: measured once, for the tests and for the packaging's README."""

from __future__ import annotations

import functools
from collections.abc import Iterable
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version

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
JOBS = ("binary", "decimal", "moved")
"""What each tool is asked for: both grids, and the binary one with a parameter moved."""


@functools.cache
def job(tool: str, case: str, which: str) -> Job:
    given = CASES[case]
    if which == "moved":
        return moved(given.job("binary", TOOLS[tool].coarse), given)
    return given.job(which, TOOLS[tool].coarse)


@functools.cache
def found(tool: str, case: str) -> Found:
    """What the tool made of all its jobs; the first call runs it."""
    return run_tool(f"{tool}_tool", [job(tool, case, which) for which in JOBS])


def theirs(tool: str, case: str, which: str) -> list[Row]:
    return found(tool, case).rows[JOBS.index(which)]


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
            cells = (TOOLS[tool].title, found(tool, case).version, about.title)
            verdicts = [verdict(tool, case, which) for which in ("binary", "decimal")]
            lines[tool, case] = "| " + " | ".join([*cells, *verdicts]) + " |"
    return lines
