"""The net's mass from the diameter of its thread, and the diameter from the mass."""

import pytest

from dcone_cosim.errors import InputError
from dcone_cosim.scenes.reading import parse
from fmu_src.net_capture.implied import rows

SCENE = """
title = "a net"
phases = ["capture"]
[capture]
duration = "1 s"
macro_step = "0.1 s"
[capture.net]
shape = "{shape}"
{sides}
mesh = "{mesh} m"
density = "1440 kg/m3"
{mass}
[capture.gravity]
law = "none"
"""
SECTION = '\n[capture.section]\ndiameter = "1 mm"\n'


def main_of(text):
    return parse(text, "a net", "net.toml").phases[0].main


@pytest.mark.parametrize(
    ("sides", "mesh", "mass"),
    [("36 m", 0.1, 29.4), ("36 m", 1.0, 3.01), ("18 m", 0.25, 2.97), ("18 m", 1.0, 0.77), ("30 m, 26 m", 0.5, 3.59)],
)
def test_a_net_of_threads_of_1_mm_weighs_what_it_does_by_hand(sides, mesh, mass):
    """rho pi/4 d^2 [a (b/l + 1) + b (a/l + 1)] of 1 mm of aramid, worked out apart from this project's code."""
    width, _, height = sides.partition(", ")
    told = f'width = "{width}"\nheight = "{height}"' if height else f'side = "{width}"'
    text = SCENE.format(shape="rectangle" if height else "square", sides=told, mesh=mesh, mass="")
    found = main_of(text + SECTION)
    assert found.values["net.mass"] == pytest.approx(mass, rel=5e-3)
    told = {row.key: row.value for row in rows(found.values, found.terms)}
    assert told["thread.diameter"] == pytest.approx(1e-3, rel=1e-12)


def test_a_scene_says_mass_or_diameter():
    text = SCENE.format(shape="square", sides='side = "6 m"', mesh=1.0, mass='mass = "0.2 kg"')
    found = main_of(text)
    assert found.values["net.mass"] == 0.2
    with pytest.raises(InputError, match="follows from what this scene asks for"):
        parse(text + SECTION, "a net", "net.toml")
