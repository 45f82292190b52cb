"""Materials against the figures of their sheets, by hand."""

import math

import pytest

from orbital import materials
from orbital.materials import MATERIALS, Material, UnknownMaterial, named


def test_a_millimetre_of_kevlar_29() -> None:
    """By hand: A = 0.785398 mm2; 2920 MPa, 70.5 GPa and 1.44 g/cm3 over it, of DuPont's technical guide."""
    kevlar = named("Kevlar 29")
    assert kevlar.breaking_load(1e-3) == pytest.approx(2293.36, rel=1e-5)
    assert kevlar.axial_stiffness(1e-3) == pytest.approx(55370.6, rel=1e-5)
    assert kevlar.mass_per_metre(1e-3) == pytest.approx(1.130973e-3, rel=1e-6)
    assert kevlar.diameter_for(2293.36) == pytest.approx(1e-3, rel=1e-5)
    assert kevlar.breaking_load(2e-3) == pytest.approx(4 * 2293.36, rel=1e-5)


SHEETS = {
    # GPa, kg/m3, GPa, %; tenacities by hand, such as 24.5 cN/dtex x 1.39 g/cm3 = 3.41 GPa
    "nylon 66": (4.56, 1140, 0.958, 20),
    "Kevlar 29": (70.5, 1440, 2.92, 3.6),
    "Kevlar 49": (112.4, 1440, 3.00, 2.4),
    "Technora": (73.7, 1390, 3.41, 4.5),
    "Dyneema SK75": (120, 970, 3.30, 3.5),
    "Vectran HT": (74.6, 1410, 3.24, 3.8),
    "Zylon AS": (180, 1540, 5.8, 3.5),
    "Zylon HM": (270, 1560, 5.8, 2.5),
}


@pytest.mark.parametrize("name", SHEETS)
def test_the_sheets(name: str) -> None:
    modulus, density, strength, strain = SHEETS[name]
    found = MATERIALS[name]
    assert found.youngs_modulus / 1e9 == pytest.approx(modulus, rel=5e-3)
    assert found.density == pytest.approx(density, rel=1e-12)
    assert found.strength is not None
    assert found.strength / 1e9 == pytest.approx(strength, rel=5e-3)
    assert found.strain_at_break == pytest.approx(strain / 100, rel=1e-12)


def test_zylon_is_what_a_maker_of_cords_says_of_it() -> None:
    """Imattec, read in place of Toyobo's own sheet: 37 cN/dtex, 1150 and 1720 cN/dtex; 1 cN/dtex is 1e5 J/kg."""
    for name, modulus in (("Zylon AS", 1150.0), ("Zylon HM", 1720.0)):
        found = MATERIALS[name]
        assert found.strength is not None
        assert found.strength / found.density == pytest.approx(37.0e5, rel=0.02)
        assert found.youngs_modulus / found.density == pytest.approx(modulus * 1e5, rel=0.02)


def test_all_of_them_are_there() -> None:
    assert set(MATERIALS) == set(SHEETS)


@pytest.mark.parametrize("name", SHEETS)
def test_each_figure_has_a_source_and_none_is_invented(name: str) -> None:
    found = MATERIALS[name]
    for figure in ("youngs_modulus", "density", "strength", "strain_at_break"):
        assert len(found.sources[figure]) > 20
    assert found.damping_ratio is None
    assert "damping_ratio" not in found.sources


@pytest.mark.parametrize("name", SHEETS)
def test_a_fibre_breaks_about_where_its_modulus_says(name: str) -> None:
    """Independent of one another in the sheets: strength over modulus, and elongation; none is off by half."""
    found = MATERIALS[name]
    assert found.strength is not None
    assert found.strain_at_break is not None
    assert 0.6 < found.strength / found.youngs_modulus / found.strain_at_break < 1.3


def test_a_braid_of_dyneema_breaks_as_one_that_is_sold() -> None:
    """3/16 in of AmSteel-Blue: 5,400 lbf = 24.02 kN; twin: its yarn would bear more than twice that."""
    braid, yarn = named("HMPE", "braid"), named("HMPE")
    bears, as_yarn = braid.breaking_load(4.7625e-3), yarn.breaking_load(4.7625e-3)
    assert bears is not None
    assert as_yarn is not None
    assert bears == pytest.approx(24020, rel=0.02)
    assert as_yarn > 2 * 24020


def test_a_braid_is_lighter_softer_and_weaker_and_says_why() -> None:
    braid, yarn = named("Technora", "braid"), named("Technora")
    assert braid.form == "braid"
    assert braid.mass_per_metre(1e-3) == pytest.approx(0.67 * yarn.mass_per_metre(1e-3))
    assert braid.axial_stiffness(1e-3) == pytest.approx(0.35 * yarn.axial_stiffness(1e-3))
    assert braid.breaking_load(1e-3) == pytest.approx(0.41 * (yarn.breaking_load(1e-3) or 0.0))
    assert "assumed" in braid.sources["youngs_modulus"]
    assert braid.braided() is braid


@pytest.mark.parametrize("name", ["kevlar 29", "KEVLAR 29", "Kevlar-29", "kevlar29"])
def test_capitals_spaces_and_dashes_do_not_count(name: str) -> None:
    assert named(name) is MATERIALS["Kevlar 29"]


@pytest.mark.parametrize(
    ("kind", "grade"), [("nylon", "nylon 66"), ("hmpe", "Dyneema SK75"), ("PBO", "Zylon HM"), ("Vectran", "Vectran HT")]
)
def test_a_kind_stands_for_a_grade(kind: str, grade: str) -> None:
    assert named(kind).name == grade


def test_a_misspelt_one_names_the_nearest() -> None:
    with pytest.raises(UnknownMaterial, match=r"no material is called 'Kevlar 39'; did you mean 'Kevlar [24]9'\?") as e:
        named("Kevlar 39")
    assert e.value.nearest in MATERIALS
    with pytest.raises(UnknownMaterial, match="no material is called 'steel wire'; known: ") as e:
        named("steel wire")
    assert e.value.nearest == ""


def test_own_ones_go_before_those_of_the_table() -> None:
    mine = Material("technora", 70e9, 1400.0)
    assert named("Technora", own={"technora": mine}) is mine
    assert named("Technora") is MATERIALS["Technora"]
    assert named("PBO", own={"PBO": mine}) is mine
    assert mine.breaking_load(1e-3) is None
    assert mine.diameter_for(100.0) is None
    assert mine.braided().strength is None


def test_margin_of_safety_by_hand() -> None:
    """3 GPa against 1 GPa: 2; with a factor of 2: 0.5; against 4 GPa: -0.25."""
    assert materials.margin_of_safety(3e9, 1e9) == pytest.approx(2.0)
    assert materials.margin_of_safety(3e9, 1e9, factor=2.0) == pytest.approx(0.5)
    assert materials.margin_of_safety(3e9, 4e9) == pytest.approx(-0.25)
    assert materials.margin_of_safety(3e9, 0.0) == math.inf
