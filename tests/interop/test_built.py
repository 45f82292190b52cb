"""Each tool runs FMUs that hold the values of their scene, and sets none: it gives the bits of a run with them set."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from dcone_cosim import build
from dcone_cosim.fmu.archive import Archive
from tests.interop.cases import CASES, by_component, differing, multiples
from tests.interop.children import run_tool
from tests.interop.job import Job
from tests.interop.measure import TOOLS, job, ours

pytestmark = [pytest.mark.interop, pytest.mark.slow]


def furnished(given: Job, case: str, folder: Path) -> Job:
    """The job on an FMU that starts with its parameters, so that none is left to set."""
    about = CASES[case]
    experiment = build.Experiment(0.0, about.length, given.step, case)
    wanted = build.Furnished(case, given.identifier, about.terms, given.parameters, experiment)
    (path,) = build.write_fmus([wanted], (), folder, print)
    with Archive(path) as archive:
        return replace(given, fmu=str(path), guid=archive.guid, parameters={})


@pytest.mark.parametrize("tool", TOOLS)
def test_with_nothing_set_it_gives_the_masters_bits(tool: str, tmp_path: Path) -> None:
    if not TOOLS[tool].version:
        pytest.skip(f"{TOOLS[tool].package} is not installed: it has no wheel for this platform")
    jobs = [furnished(job(tool, case, "binary"), case, tmp_path) for case in CASES]
    found = run_tool(f"{tool}_tool", jobs).rows
    for place, case in enumerate(CASES):
        assert differing(ours(tool, case, "binary"), found[place]) == []


@pytest.mark.parametrize("case", CASES)
def test_with_the_models_own_values_the_bits_are_others(case: str) -> None:
    """The twin: the same with nothing set on an FMU that was given nothing."""
    plain = replace(job("fmpy", case, "binary"), parameters={})
    assert differing(ours("fmpy", case, "binary"), by_component(plain, multiples))
