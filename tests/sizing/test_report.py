"""The numbers of the report by hand: margins, bounds, what a fixed peak would say, and what the loads are of."""

from __future__ import annotations

import io
import math

import pytest
from rich.console import Console

from dcone_cosim.loading import load
from dcone_cosim.master import run_scene
from dcone_cosim.progress import Progress
from dcone_cosim.scene_fmus import SceneFmus
from dcone_cosim.sizing import required, show
from dcone_cosim.sizing.result import Sizing
from dcone_cosim.sizing.section import ROW, Head, Section, text
from dcone_cosim.sizing.work import loads_of
from orbital.materials import MATERIALS
from tests.sizing.conftest import SAFETY, SHORT

STRENGTH = 2.92e9 * math.pi * 1e-6 / 4.0
"""Load at which the scene's 1 mm of Kevlar 29 breaks [N]."""
UNDAMPED = "as it is, without damping"


def test_a_cell_is_in_the_unit_of_its_head() -> None:
    heads = (Head("d", "d", "m", "mm"), Head("s", "s", "1", "%"), Head("t", "t", "s", "day"), Head("n", "n"))
    assert [head.shown(value) for head, value in zip(heads, (1.5e-3, 0.25, 43200.0, 7), strict=True)] == [
        "1.5", "25", "0.5", "7",
    ]  # fmt: skip
    assert [head.title for head in heads] == ["d [mm]", "s [%]", "t [day]", "n"]


def test_a_value_with_a_unit_of_its_own_is_in_one_that_is_read() -> None:
    heads = (text("what", "what"), Head("value", "value", ROW), text("unit", "unit"))
    given = ((6e10, "Pa"), (3e6, "Pa"), (1e-3, "m"), (12.0, "m"), (8e5, "m"), (0.05, "1"), (0.0, "m"), (-0.01, "N"))
    section = Section("asked", "", "", heads, [("", *row) for row in given])
    assert [row[1:] for row in section.cells()] == [
        ["60", "GPa"], ["3", "MPa"], ["1", "mm"], ["12", "m"], ["800", "km"], ["0.05", ""], ["0", "m"], ["-0.01", "N"],
    ]  # fmt: skip
    assert section.columns()[1].values == [value for value, _ in given], "files stay SI"


def test_margins_are_over_the_factor_of_safety(done: Sizing) -> None:
    """Of the line of each run: where its diameter is what differs it bears as its section does."""
    loads = done["loads"].set_index("run")
    for run, row in loads.iterrows():
        if str(run).startswith(("at random", "each at")):
            continue
        share = float(str(run).split()[-2]) if str(run).startswith("line diameter") else 1.0
        assert row.margin == pytest.approx(STRENGTH * share**2 / (SAFETY * row.peak) - 1.0, rel=1e-9), run
    assert {"line diameter 0.95 mm", "line diameter 1.05 mm"} <= set(loads.index)
    hardest = loads.drop(UNDAMPED).sort_values("peak").iloc[-1]
    (line,) = (text for text in done.said if "margin of safety" in text)
    assert f"margin of safety {hardest.margin:+.3g}" in line


def test_the_bound_has_no_damping(done: Sizing) -> None:
    scene = load("table2-deorbit", [*SHORT, "removal.tether.damping_ratio=0.0"])
    with SceneFmus(scene, Progress()) as fmus:
        log = run_scene(scene, fmus.instantiate, Progress()).phases["removal"].tugs
    assert log is not None
    bound = done["loads"].set_index("run").peak[UNDAMPED]
    assert bound == pytest.approx(max(peak for _, peak, _ in log.rows.values()), rel=1e-12)


def test_what_a_fixed_peak_would_say(done: Sizing) -> None:
    """Of the hardest of all runs on the scene's own line."""
    loads = done["loads"]
    hardest = loads[loads.run != UNDAMPED].peak.max()
    row = done["required"].set_index("material").loc["Technora yarn"]
    assert MATERIALS["Technora"].strength is not None
    assert row.wrong_from_peak == pytest.approx(
        math.sqrt(4.0 * SAFETY * hardest / (math.pi * MATERIALS["Technora"].strength))
    )


def test_the_closed_form_can_be_worked_out_again(done: Sizing) -> None:
    """By its own numbers alone, and as the table of required lines has it."""
    told = done["closed"].set_index("what")["value"]
    factor, strength, speed, mass, preload, share, length, modulus, diameter = told
    assert factor == SAFETY
    area = (factor * share * speed / strength) ** 2 * modulus * mass / length + 2.0 * factor * preload / strength
    assert diameter == pytest.approx(math.sqrt(4.0 * area / math.pi), rel=1e-9)
    assert diameter == pytest.approx(done["required"].iloc[0]["closed"], rel=1e-12)


def test_the_diameter_that_governs_has_a_run(done: Sizing) -> None:
    """What it is for: the line of that diameter holds its own largest tension."""
    *loads, run = done["governs"].to_dict("records")
    assert run["diameter"] == max(row["diameter"] for row in loads)
    strength = done["closed"].set_index("what")["value"].iloc[1]
    margin = strength * math.pi * run["diameter"] ** 2 / 4.0 / (SAFETY * run["size"]) - 1.0
    assert f"margin of {margin:+.3g}" in run["how"]
    assert margin >= 0.0


def test_what_is_sized_is_told(done: Sizing) -> None:
    told = done["inputs"].set_index("what").value
    assert told["stiffness of the line"] == pytest.approx(60e9 * math.pi * 1e-6 / 4.0 / 12.0, rel=1e-12)
    assert told["reduced mass"] == pytest.approx(2000.0 / 3.0, rel=1e-12)
    assert told["altitude"] == 800e3


def test_the_answer_tells_what_may_be_off(done: Sizing) -> None:
    """The default flux, which three factors are left out of; a debris that tumbles; a beam that meets the debris."""
    said = " ".join(done.said)
    assert "a factor of 27 either way, and that diameter by one of 9" in said
    region = done["region"]
    assert f"up to {region.peak.max():.4g} N" in said
    ways = done["disposal"]
    (part,) = (one for one in done.sections if one.key == "disposal")
    assert f"{100 * ways.beam.max():.0f} % of a beam" in part.said[0]


def test_every_range_has_both_its_ends(done: Sizing) -> None:
    found = done["ranges"].set_index("what")
    assert found.loc["thrust.level"].low == "-0.012 N"
    assert found.loc["thrust.level"].why == "told"
    assert (found.loc["line stiffness E"].low, found.loc["line stiffness E"].high) == ("48 GPa", "72 GPa")
    assert found.loc["line stiffness E"].peak_low < found.loc["line stiffness E"].peak_high
    worse = done["loads"].set_index("run").peak["each at its worse end"]
    assert worse > found[["peak_low", "peak_high"]].max().max()


def test_shares_of_a_sample_apply_to_the_line_that_is_sought(done: Sizing) -> None:
    assert done.study is not None
    own = done.study.ground.values
    sample = {
        "tether.diameter": 1.05 * own["tether.diameter"],
        "tether.youngs_modulus": 0.8 * own["tether.youngs_modulus"],
    }
    found = required._values(done.study.ground, MATERIALS["Technora"], 2e-3, sample)
    assert found["tether.diameter"] == pytest.approx(2.1e-3)
    assert found["tether.youngs_modulus"] == pytest.approx(0.8 * MATERIALS["Technora"].youngs_modulus)


def test_loads_of_a_run() -> None:
    """Steps in which the line was slack for a while are none of a taut line."""
    scene = load("table2-deorbit", SHORT)
    with SceneFmus(scene, Progress()) as fmus:
        result = run_scene(scene, fmus.instantiate, Progress()).phases["removal"]
    found = loads_of(result, history=True)
    assert found["peak"] == max(peak for _, peak, _ in found["tugs"])
    assert len(found["angles"]) == len(found["tugs"])
    assert all(0.0 < least <= most for _, least, most in found["taut"])
    assert "taut" not in loads_of(result, history=False)
    lengthening = found["extremes"]["tether.length_rate"]
    assert lengthening[0] < lengthening[1] < lengthening[2]


def test_no_word_of_a_head_is_cut_in_two() -> None:
    """On a terminal of 80 letters, by the table with the longest heads."""
    heads = (
        text("way", "engine"), Head("a", "thrust", "N"), Head("b", "Isp", "s"), Head("c", "dv", "m/s"),
        Head("d", "propellant", "kg"), Head("e", "time", "s", "day"), Head("f", "power", "W"),
        Head("g", "steady tension", "N"), Head("beam", "beam lost on the debris", "1", "%"),
    )  # fmt: skip
    row = ("electric, as `electric-tug`", 0.25, 3000.0, 332.4, 33.71, 3.97e6, 6129.0, 0.08333, 0.7606)
    console = Console(width=80, file=io.StringIO())
    show._show(Section("disposal", "Bringing it down", "purpose", heads, [row]), console)
    printed = console.file.getvalue()  # type: ignore[attr-defined]
    for word in ("thrust", "propellant", "steady", "tension", "electric-tug"):
        assert word in printed
