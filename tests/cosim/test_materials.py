"""Materials in a scene: what follows from a name, what the scene says itself, and names that are none."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from dcone_cosim.loading import load
from dcone_cosim.scene.data import ComponentScene, Scene
from dcone_cosim.scene.mistakes import SceneError
from dcone_cosim.scenes.new import new_scene
from dcone_cosim.scenes.reading import parse, read_text
from orbital.materials import MATERIALS

SCENES = Path(__file__).parents[2] / "dcone_cosim" / "scenes"
TOW = """
[orbit]
altitude = "800 km"
[removal]
macro_step = "60 s"
duration = "1 h"
[removal.reel]
law = "locked"
[removal.thrust]
direction = "along_track"
level = "-0.01 N"
specific_impulse = "3000 s"
"""
NET = """
[capture]
macro_step = "0.05 s"
duration = "8 s"
[capture.gravity]
law = "none"
"""
MINE = """
[materials.mine]
youngs_modulus = "20 GPa"
density = "1000 kg/m3"
strength = "1 GPa"
damping_ratio = 0.08
source = "our test of 3 May"
"""


def read(text: str) -> Scene:
    return parse(text, "made", "made.toml")


def main_of(text: str) -> ComponentScene:
    return read(text).phases[0].main


def mistakes(text: str) -> str:
    with pytest.raises(SceneError) as caught:
        read(text)
    return str(caught.value)


def test_a_name_gives_what_the_scene_does_not_say() -> None:
    """By hand: 2920 MPa over 0.785398 mm2 are 2293.36 N."""
    main = main_of(TOW + '[removal.break]\n[removal.tether]\nmaterial = "kevlar 29"\n')
    assert main.parameters["tether.youngs_modulus"] == 70.5e9
    assert main.parameters["break.strength"] == pytest.approx(2293.36, rel=1e-5)
    assert "tether.damping_ratio" not in main.parameters, "no sheet tells it"
    assert main.lines["tether"].strength == 2.92e9
    assert set(main.lines["tether"].follows) == {"tether.youngs_modulus", "break.strength"}
    thicker = main_of(TOW + '[removal.break]\n[removal.tether]\ndiameter = "2 mm"\nmaterial = "Kevlar 29"\n')
    assert thicker.parameters["break.strength"] == pytest.approx(4 * 2293.36, rel=1e-5)


def test_what_the_scene_says_itself_counts_and_is_known_apart() -> None:
    text = TOW + '[removal.break]\nstrength = "900 N"\n[removal.tether]\nyoungs_modulus = "60 GPa"\n'
    main = main_of(text + 'material = "Kevlar 29"\nstrength = "1 GPa"\n')
    assert main.parameters["tether.youngs_modulus"] == 60e9
    assert main.parameters["break.strength"] == 900.0
    assert main.lines["tether"].strength == 1e9
    assert main.lines["tether"].apart == pytest.approx({"tether.youngs_modulus": 70.5e9, "break.strength": 785.398})
    as_told = main_of(TOW + '[removal.tether]\nmaterial = "Kevlar 29"\nyoungs_modulus = "70.5 GPa"\n')
    assert as_told.lines["tether"].apart == {}


def test_a_strength_needs_no_material() -> None:
    main = main_of(TOW + '[removal.break]\n[removal.tether]\nstrength = "1 GPa"\n')
    assert main.lines["tether"].material is None
    assert main.parameters["break.strength"] == pytest.approx(785.398, rel=1e-6)
    assert "tether.youngs_modulus" not in main.parameters


def test_a_braid() -> None:
    main = main_of(TOW + '[removal.tether]\nmaterial = "Technora"\nform = "braid"\n')
    assert main.parameters["tether.youngs_modulus"] == pytest.approx(0.35 * 7500 * 9.80665e6)
    assert main.lines["tether"].strength == pytest.approx(0.41 * 347 * 9.80665e6)


def test_threads_and_cord() -> None:
    """By hand: E A of 1 mm Kevlar 49 is 112.4 GPa x 0.785398 mm2 = 88,278.8 N; of 0.5 mm nylon, 4.56 GPa: 895.35 N."""
    net = '[capture.net]\nshape = "square"\nside = "24 m"\nmaterial = "Zylon HM"\n'
    main = main_of(NET + net + '[capture.closing]\ndrive = "winches"\nmaterial = "Kevlar 49"\ndiameter = "1 mm"\n')
    assert (main.parameters["net.youngs_modulus"], main.parameters["net.density"]) == (270e9, 1560.0)
    assert main.parameters["closing.axial_stiffness"] == pytest.approx(88278.8, rel=1e-6)
    assert main.lines["closing"].diameter == 1e-3
    usual = main_of(NET + net + '[capture.closing]\ndrive = "winches"\nmaterial = "nylon"\n')
    assert usual.parameters["closing.axial_stiffness"] == pytest.approx(895.35, rel=1e-5)
    told = main_of(NET + net + '[capture.closing]\ndrive = "winches"\nmaterial = "nylon"\naxial_stiffness = "903 N"\n')
    assert told.parameters["closing.axial_stiffness"] == 903.0


def test_threads_that_may_break() -> None:
    """By hand: 0.33 kg over 1200 m and 1440 kg/m3 are 0.190972 mm2, of 2920 MPa 557.64 N."""
    net = '[capture.net]\nshape = "square"\nside = "24 m"\nmesh = "1 m"\nmass = "0.33 kg"\nmaterial = "Kevlar 29"\n'
    main = main_of(NET + net + "[capture.break]\n")
    assert main.parameters["break.strength"] == pytest.approx(557.64, rel=1e-5)
    assert main_of(NET + net + '[capture.break]\nstrength = "40 N"\n').parameters["break.strength"] == 40.0
    said = mistakes(NET + net + '[capture.break]\n[capture.solver]\nscheme = "rk4"\n')
    assert 'capture.solver.scheme = "rk4": keeps all threads whole; [capture.break] needs "leapfrog"' in said


def test_a_reel_without_an_elastic_line_has_one_all_the_same() -> None:
    text = TOW.replace('"locked"', '"linear"') + '[removal.tether]\nmaterial = "PBO"\ndiameter = "0.5 mm"\n'
    line = main_of(text).lines["tether"]
    assert line.material is MATERIALS["Zylon HM"]
    assert line.diameter == 0.5e-3
    assert line.follows == ()


def test_a_material_of_ones_own() -> None:
    main = main_of(TOW + MINE + '[removal.tether]\nmaterial = "mine"\n')
    assert main.parameters["tether.youngs_modulus"] == 20e9
    assert main.parameters["tether.damping_ratio"] == 0.08
    material = main.lines["tether"].material
    assert material is not None
    assert (material.strength, material.strain_at_break, material.form) == (1e9, None, "yarn")
    assert material.sources["strength"] == "our test of 3 May"
    braid = main_of(TOW + MINE + '[removal.tether]\nmaterial = "mine"\nform = "braid"\n')
    assert braid.parameters["tether.youngs_modulus"] == pytest.approx(7e9)
    as_braid = TOW + MINE + 'form = "braid"\n[removal.tether]\nmaterial = "mine"\n'
    assert main_of(as_braid).parameters["tether.youngs_modulus"] == 20e9, "these figures are of the braid"
    assert 'line 22: removal.tether.material = "mine": is a braid' in mistakes(as_braid + 'form = "yarn"\n')


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (
            TOW + '[removal.tether]\nmaterial = "Kevlar 39"\n',
            ('line 14: removal.tether.material = "Kevlar 39": no material of that name; did you mean \'Kevlar',),
        ),
        (TOW + MINE + '[removal.tether]\nmaterial = "minee"\n', ("did you mean 'mine'?",)),
        (TOW + '[removal.tether]\nmaterail = "nylon"\n', ("line 14: removal.tether.mat", "did you mean 'material'?")),
        (TOW + "[removal.tether]\nmaterial = 29\n", ("removal.tether.material = 29: expected a text",)),
        (TOW + '[removal.tether]\nmaterial = "nylon"\nform = "rope"\n', ("expected one of yarn, braid",)),
        (TOW + '[removal.tether]\nform = "braid"\n', ("removal.tether.form", "needs a material beside it")),
        (TOW + '[removal.tether]\nstrength = "3 kN"\n', ("removal.tether.strength", "is a force")),
        (TOW + '[removal.tether]\nstrength = "0 GPa"\n', ("must be greater than 0 GPa",)),
        (TOW + '[materials.mine]\nyoungs_modulus = "1 GPa"\n', ("materials.mine.density missing: expected, such as",)),
        (TOW + MINE + 'strenght = "1 GPa"\n', ("materials.mine.strenght", "did you mean 'strength'?")),
        (TOW + "[materials]\nmine = 3\n", ("expected a table [materials.mine]",)),
        (
            NET
            + '[capture.net]\nshape = "square"\n[capture.closing]\ndrive = "winches"\ndiameter = "1 mm"\n',
            ("capture.closing.diameter", "without a material or axial_stiffness beside it"),
        ),
    ],
)  # fmt: skip
def test_what_is_refused(text: str, told: tuple[str, ...]) -> None:
    said = mistakes(text)
    for part in told:
        assert part in said


def test_a_material_with_a_mistake_is_not_told_as_unknown_too() -> None:
    said = mistakes(TOW + MINE.replace('"20 GPa"', "20") + '[removal.tether]\nmaterial = "mine"\n')
    assert "materials.mine.youngs_modulus = 20: a bare number has no unit" in said
    assert "no material of that name" not in said


def bare(text: str) -> str:
    """A scene without the names of its materials."""
    return re.sub(r'^(material = .*|axial_stiffness = "903 N".*)\n', "", text, flags=re.MULTILINE)


@pytest.mark.parametrize("name", sorted(path.stem for path in SCENES.glob("*.toml")))
def test_a_name_alone_changes_no_number_of_our_scenes(name: str) -> None:
    """What reaches the FMUs is the same with and without; twin below: where the scene leaves the stiffness out."""
    text = read_text(SCENES / f"{name}.toml")
    for with_name, without in zip(read(text).phases, read(bare(text)).phases, strict=True):
        for one, other in zip(with_name.components, without.components, strict=True):
            assert {**one.defaults, **one.parameters} == {**other.defaults, **other.parameters}
            assert one.terms == other.terms


def test_a_name_changes_what_is_left_out() -> None:
    text = read_text(SCENES / "table2-deorbit.toml").replace('youngs_modulus = "60 GPa"\n', "")
    one, other = (read(t).phases[0].main for t in (text, bare(text)))
    assert {**one.defaults, **one.parameters} != {**other.defaults, **other.parameters}


@pytest.mark.parametrize("name", ["mission", "heavy-8t", "table1-capture", "deployment", "tumbling-mission"])
def test_our_scenes_name_what_their_lines_are_of(name: str) -> None:
    for phase in load(name).phases:
        wanted = {"tether"} if phase.name == "removal" else {"net"}
        wanted |= {"closing"} if "closing" in phase.main.terms else set()
        assert {table for table, line in phase.main.lines.items() if line.strength} == wanted


def test_a_material_that_is_set_tells_what_does_not_follow() -> None:
    """Whoever sets one for a run may believe that its stiffness follows; a scene as it is needs no such word."""
    (told,) = load("table2-deorbit", ["removal.tether.material=Technora"]).notes
    assert told == "removal.tether.youngs_modulus is as the scene says; Technora, yarn, has 7.355e+10, SI"
    assert load("table2-deorbit").notes == ()


def test_a_new_scene_keeps_materials() -> None:
    text = TOW + MINE + '[removal.tether]\nmaterial = "mine"\nstrength = "0.9 GPa"\n'
    again = read(new_scene(text, "made", "again.toml"))
    assert again.phases[0].main.lines == read(text).phases[0].main.lines
    assert "# [materials.mine]" in new_scene(TOW, "made", "again.toml")
