"""Each tool runs both FMUs and gives the master's bits, at the master's times or at those that it steps at itself."""

from __future__ import annotations

import tomllib
from dataclasses import replace
from pathlib import Path

import pytest
from packaging.requirements import Requirement

from tests.interop import readme
from tests.interop.cases import (
    CASES,
    added_up,
    added_up_to_the_end,
    by_component,
    differing,
    farthest,
    multiples,
    multiples_of_equal_steps,
)
from tests.interop.measure import SPREAD, TOOLS, job, ours, theirs

pytestmark = [pytest.mark.interop, pytest.mark.slow]

ROOT = Path(__file__).parents[2]
POINTS = (multiples, added_up, added_up_to_the_end, multiples_of_equal_steps)


def requirements() -> dict[str, Requirement]:
    """What pip is asked for, by the name of the package."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    asked = [Requirement(line) for line in (*project["dependencies"], *project["optional-dependencies"]["test"])]
    return {requirement.name: requirement for requirement in asked}


@pytest.fixture(params=[(tool, case) for tool in TOOLS for case in CASES], ids="-".join)
def run(request: pytest.FixtureRequest) -> tuple[str, str]:
    """A tool by name, and the run it is to repeat."""
    tool, case = request.param
    if not TOOLS[tool].version:
        pytest.skip(f"{TOOLS[tool].package} is not installed: it has no wheel for this platform")
    return tool, case


def test_every_tool_that_pip_offers_here_is_installed() -> None:
    asked = requirements()
    for tool in TOOLS.values():
        marker = asked[tool.package].marker
        if marker is None or marker.evaluate():
            assert tool.version, f"{tool.package} is missing; pip install -e '.[test]' brings it"
            assert asked[tool.package].specifier.contains(tool.version, prereleases=True)


def test_steps_that_a_double_holds_give_the_masters_bits(run: tuple[str, str]) -> None:
    assert differing(ours(*run, "binary"), theirs(*run, "binary")) == []


def test_other_steps_give_the_same_bits_at_the_times_the_tool_steps_at(run: tuple[str, str]) -> None:
    own = TOOLS[run[0]].points
    assert differing(ours(*run, "decimal", own), theirs(*run, "decimal")) == []


def test_at_other_times_the_tow_has_other_bits(run: tuple[str, str]) -> None:
    """Twin of the last: the order of additions is seen, so the bits tell how a tool steps."""
    tool, case = run
    if case != "removal":
        pytest.skip("the net's substeps end at their own times, whatever the macro step's last bits")
    found, own = theirs(*run, "decimal"), TOOLS[tool].points
    fitting = [points for points in POINTS if not differing(ours(*run, "decimal", points), found)]
    assert own in fitting
    assert (multiples in fitting) == (own is multiples)
    assert len(fitting) <= 2, "two of the four may be the same to the last bit, since the last step is short or is not"


def test_figures_stay_within_the_spread(run: tuple[str, str]) -> None:
    figures = CASES[run[1]].figures
    assert farthest(ours(*run, "decimal"), theirs(*run, "decimal"), figures) <= SPREAD


def test_a_moved_parameter_is_seen(run: tuple[str, str]) -> None:
    """Twin of all: a millionth more of one parameter, and neither bits nor figures are those of before."""
    master, moved = ours(*run, "binary"), theirs(*run, "moved")
    assert differing(master, moved)
    assert farthest(master, moved, CASES[run[1]].figures) > SPREAD
    assert differing(ours(*run, "moved"), moved) == []


def test_with_nothing_set_it_gives_the_masters_bits(run: tuple[str, str]) -> None:
    """On FMUs that hold the values of their scene."""
    assert job(*run, "built").parameters == {}
    assert differing(ours(*run, "binary"), theirs(*run, "built")) == []


@pytest.mark.parametrize("case", CASES)
def test_with_the_models_own_values_the_bits_are_others(case: str) -> None:
    """The twin: the same with nothing set on an FMU that was given nothing."""
    plain = replace(job("fmpy", case, "binary"), parameters={})
    assert differing(ours("fmpy", case, "binary"), by_component(plain, multiples))


@pytest.mark.parametrize("case", CASES)
def test_the_runs_are_worth_repeating(case: str) -> None:
    """All kinds of variables, a command that changes what comes after it and only that, contact and capture, tugs."""
    given = job("fmpy", case, "binary")
    assert {given.kinds[name] for name in given.outputs} == {"Real", "Integer", "Boolean"}
    rows = by_component(given, multiples)
    without = by_component(replace(given, commands=[]), multiples)
    ((at, _, _),) = given.commands
    before = sum(look <= at for look in given.looks)
    assert 0 < before < len(rows)
    assert differing(rows[:before], without[:before]) == []
    assert differing(rows[before:], without[before:])
    if case == "capture":
        assert rows[-1]["captured"] == 1.0
        assert float(rows[-1]["contact.nodes"]) > 0.0
        assert without[-1]["captured"] == 0.0
    else:
        assert float(rows[-1]["tether.tug_count"]) > 3.0


def test_the_readmes_table_is_what_was_measured() -> None:
    text = readme.PAGE.read_text(encoding="utf-8")
    able = [tool for tool, about in TOOLS.items() if about.version]
    assert readme.page(text, able, keep_versions=True) == text
    assert len(readme.written(text)) == len(CASES) * len(TOOLS) + 1
    for package, version in readme.versions(text).items():
        assert requirements()[package].specifier.contains(version, prereleases=True)
    wrong = text.replace("same bits over 64 steps of 0.25 s", "same bits over 65 steps of 0.25 s", 1)
    assert wrong != text == readme.page(wrong, able, keep_versions=True)
