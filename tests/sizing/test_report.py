"""The numbers of the report by hand: margins, bounds, what a fixed peak would say, and what the loads are of."""

from __future__ import annotations

import math

import pytest

from dcone_cosim.loading import load
from dcone_cosim.master import run_scene
from dcone_cosim.progress import Progress
from dcone_cosim.scene_fmus import SceneFmus
from dcone_cosim.sizing import required
from dcone_cosim.sizing.result import Sizing
from dcone_cosim.sizing.work import loads_of
from orbital.materials import MATERIALS
from tests.sizing.conftest import SAFETY, SHORT

STRENGTH = 2.92e9 * math.pi * 1e-6 / 4.0
"""Load at which the scene's 1 mm of Kevlar 29 breaks [N]."""


def test_margins_are_over_the_factor_of_safety(done: Sizing) -> None:
    loads = done["loads"]
    for row in loads.itertuples():
        assert row.margin == pytest.approx(STRENGTH / (SAFETY * row.peak) - 1.0, rel=1e-9)
    hardest = loads[loads.run != "without damping, a bound"].peak.max()
    (line,) = (text for text in done.said if "margin of safety" in text)
    assert f"margin of safety {STRENGTH / (SAFETY * hardest) - 1.0:+.3g}" in line


def test_the_bound_has_no_damping(done: Sizing) -> None:
    scene = load("table2-deorbit", [*SHORT, "removal.tether.damping_ratio=0.0"])
    with SceneFmus(scene, Progress()) as fmus:
        log = run_scene(scene, fmus.instantiate, Progress()).phases["removal"].tugs
    assert log is not None
    bound = done["loads"].set_index("run").peak["without damping, a bound"]
    assert bound == pytest.approx(max(peak for _, peak, _ in log.rows.values()), rel=1e-12)


def test_what_a_fixed_peak_would_say(done: Sizing) -> None:
    """Of the hardest of all runs on the scene's own line."""
    loads = done["loads"]
    hardest = loads[loads.run != "without damping, a bound"].peak.max()
    row = done["required"].set_index("material").loc["Technora yarn"]
    assert MATERIALS["Technora"].strength is not None
    assert row.fixed == pytest.approx(math.sqrt(4.0 * SAFETY * hardest / (math.pi * MATERIALS["Technora"].strength)))


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
