"""The validation page as Markdown: tables from the stored rows, and experiments whose data are not at hand.

Checked  tests/consistency/test_validation.py
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, NamedTuple

from scipy.stats import binomtest

from tests.validation import CLOSED_FORM, COMMAND, EXPERIMENT, LEVELS, OTHER_CODE, Row

INTRODUCTION = """# Validation

What the project computes, held against what others have: formulas on paper, other programs, experiments. Each row is
part of a test and has the tolerance that the test asserts; the numbers are those of one run. Where a test has several
cases, the one nearest to its tolerance is shown. What else is checked is in
[the table of checks](../tests/README.md#what-is-checked); figures of earlier versions that turned out wrong are in
[results that were wrong](results-that-were-wrong.md).
"""
HEADINGS = {CLOSED_FORM: "Closed form", OTHER_CODE: "Code against code", EXPERIMENT: "Experiment"}
INTRODUCTIONS = {
    CLOSED_FORM: "Formulas on paper: what the models compute is held against what can be written down.",
    OTHER_CODE: """Programs that share no line with what they judge: other integrators, formulations and languages. What
other tools make of our FMUs is told in [their own table](../fmu_src/packaging/README.md).""",
    EXPERIMENT: """What was measured. No experiment is published, in what could be read, with enough of its set-up to be
computed without guessing; a share of shots can be held against that of shots of ours, and says that both are of one
size, no more.""",
}
NO_EXPERIMENT = """No measured number is compared yet. None of the experiments below is published, in what could be
read, with enough of its set-up to be computed without guessing."""

SUBJECTS = {
    "Net and capture": ("tests/net_capture/", "tests/benchmarks/", "tests/accuracy/test_peers"),
    "Tow and reel": (
        "tests/tethered_deorbit/",
        "tests/reel_control/",
        "tests/consistency/test_table2",
        "tests/consistency/test_orbital_first_tug",
    ),
    "Hand-over and coupling": ("tests/cosim/", "tests/consistency/test_handoff"),
    "Orbits and formulas": ("tests/orbital/",),
}
"""Where a test stands by its path; each table is divided so."""

CAUGHT, SHOT = 20, 21
"""Of the nets shot on ESA's parabolic flights."""


class Open(NamedTuple):
    """A comparison that cannot be made: which, what is known of it, and what is missing."""

    name: str
    known: str
    missing: str


def interval(count: int, of: int) -> tuple[float, float]:
    """Wilson's interval of 95 % for a share."""
    found = binomtest(count, of).proportion_ci(0.95, "wilson")
    return float(found.low), float(found.high)


def open_experiments() -> tuple[Open, ...]:
    low, high = interval(CAUGHT, SHOT)
    return (
        Open(
            "ESA's net gun on parabolic flights (SKA Polska, Falcon 20, 2015)",
            "[the NRC](https://nrc.canada.ca/en/stories/national-research-council-canada-microgravity-research-"
            f"aircraft-tests-deorbiting-technology), which flew it: one net missed its target in {SHOT} parabolas, so "
            f"the share lies within {low:.3f} and {high:.3f} (95 %, Wilson's interval): the row above. "
            "[ESA's report](https://www.esa.int/ESA_Multimedia/Images/2015/03/Weightless_net_testing): 20 nets, "
            "at various speeds, at a model of a satellite",
            "side, mesh, thread and mass of the nets; masses and speeds of the weights in each shot; the carton from "
            "which the net leaves; size and place of the model; what counted as a miss",
        ),
        Open(
            "RemoveDEBRIS, net in orbit (2018)",
            "a net of 5 m was shot at a CubeSat that had been released and had inflated a structure, and caught it",
            "masses and speeds of the weights; mesh and thread; the target's spin; times of opening and closing. There "
            "is a video, but no tracks taken from it that could be read",
        ),
        Open(
            "PATENDER, parabolic flights",
            "a simulator of nets was judged by them (Cercos, Stefanescu, Medina and others)",
            "the tables could not be read: net, initial state of each shot, tracks",
        ),
        Open(
            "ADRiNET, tracks",
            "tracks of a net that was shot were taken",
            "the tables could not be read: net, shot, tracks",
        ),
        Open(
            "Si et al. (2021), one edge closed by a thread through rings",
            "an edge drawn shut on the ground, compared there with a model of rings that slide",
            "the tables of masses, lengths and friction, and the measured course of the edge "
            "([doi 10.1155/2021/8827141](https://doi.org/10.1155/2021/8827141))",
        ),
    )


def subject(test: str) -> str:
    for name, paths in SUBJECTS.items():
        if test.startswith(paths):
            return name
    raise ValueError(f"{test}: no subject of the page has this place (SUBJECTS)")


def function(test: str) -> str:
    """File and function of a test, without its parameters."""
    return test.partition("[")[0]


def merged(rows: Iterable[Row]) -> list[Row]:
    """One row for all cases of a test that compare the same: the one nearest to its tolerance, and of how many."""
    found: dict[tuple[str, str, str], Row] = {}
    for row in rows:
        key = (function(row["test"]), row["what"], row["source"])
        before = found.get(key)
        worst = row if before is None or row["share"] >= before["share"] else before
        found[key] = worst | {"of": row["of"] + (before["of"] if before else 0)}
    return list(found.values())


def number(value: float, step: float) -> str:
    """With digits down to a tenth of `step`, at least six and at most twelve."""
    if not math.isfinite(value) or value == 0.0:
        return f"{value:g}"
    digits = 12
    if step > 0.0:
        digits = math.floor(math.log10(abs(value))) - math.floor(math.log10(step)) + 2
    return f"{value:.{min(max(digits, 6), 12)}g}"


def small(value: float, unit: str = "") -> str:
    return f"{value:.2g}{unit}" if value else "0"


def cells(row: Row) -> list[str]:
    """What is expected and found, the difference and the tolerance."""
    tolerance, found, expected = row["tolerance"], row["found"], row["expected"]
    if "within" in tolerance:
        low, high = tolerance["within"]
        expected = f"above {low:g}" if high is None else f"below {high:g}" if low is None else f"{low:g} to {high:g}"
        return [expected, f"{found:.4g}", "inside", "-"]
    difference = abs(found - expected)
    if "abs" in tolerance:
        step = tolerance["abs"]
        told = number(found, step) if expected else small(found)
        return [number(expected, step), told, small(difference), small(step)]
    step, share = tolerance["rel"] * abs(expected), difference / abs(expected) if difference else 0.0
    scale = (100.0, " %") if tolerance["rel"] >= 1e-4 else (1.0, " relative")
    both = [small(scale[0] * part, scale[1]) for part in (share, tolerance["rel"])]
    return [number(expected, step), number(found, step), *both]


def line(row: Row) -> str:
    path, _, name = function(row["test"]).partition("::")
    link = f"[{name.removeprefix('test_').replace('_', ' ')}](../{path})"
    what = row["what"] + (f" (worst of {row['of']})" if row["of"] > 1 else "")
    parts = [what, row["source"], *cells(row), row["unit"] or "-", link]
    return "| " + " | ".join(part.replace("|", r"\|") for part in parts) + " |"


def table(rows: Sequence[Row]) -> list[str]:
    head = ("what", "source", "expected", "found", "difference", "tolerance", "unit", "test")
    return ["| " + " | ".join(head) + " |", "| " + " | ".join("---" for _ in head) + " |", *map(line, rows)]


def listed(entries: Iterable[Open]) -> list[str]:
    return [
        "| comparison | what is known | what is missing |",
        "| --- | --- | --- |",
        *(f"| {entry.name} | {entry.known} | {entry.missing} |" for entry in entries),
    ]


def _again(stored: Mapping[str, Any]) -> str:
    """Which rows were made after all the others, and when."""
    again = stored.get("again", {})
    if not again:
        return ""
    stamps = sorted({f"{stamp['date']}, version {stamp['version']}" for stamp in again.values()})
    return f" Those of {len(again)} test files were made again on {'; '.join(stamps)}."


def render(stored: Mapping[str, Any]) -> str:
    """The whole page."""
    rows = merged(stored["rows"])
    tools = stored["version"]
    out = [
        INTRODUCTION,
        f"Written by `{COMMAND}` on {stored['date']}, version {tools['dcone-cosim']} (numba {tools['numba']}, numpy "
        f"{tools['numpy']}): {len(rows)} rows from {len(stored['rows'])} comparisons." + _again(stored),
    ]
    for level in LEVELS:
        own = [row for row in rows if row["level"] == level]
        told = NO_EXPERIMENT if level == EXPERIMENT and not own else INTRODUCTIONS[level]
        out += ["", f"## {HEADINGS[level]}", "", told]
        for name in SUBJECTS:
            part = [row for row in own if subject(row["test"]) == name]
            if part:
                out += ["", f"### {HEADINGS[level]}: {name.lower()}", "", *table(part)]
    out += ["", "### Open experiments", "", *listed(open_experiments())]
    return "\n".join(out) + "\n"
