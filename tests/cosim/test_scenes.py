"""The scenes that come with the program, and how a scene becomes parameters."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Iterator
from typing import Any

import pytest

from dcone_cosim import build
from dcone_cosim.contract import HANDED_OVER, OUTCOMES
from dcone_cosim.loading import find, load, shipped, title_of
from dcone_cosim.scene.toml_lines import Path, dotted, key_lines, line_of
from dcone_cosim.scenes.reading import parse


def test_the_three_scenes_are_there() -> None:
    assert {"table1-capture", "table2-deorbit", "mission"} <= set(shipped())
    assert all(title_of(path) for path in shipped().values())


@pytest.mark.parametrize("name", sorted(shipped()))
def test_a_shipped_scene_says_only_what_its_model_has(name: str) -> None:
    scene = load(name)
    assert scene.text == find(name).read_text()
    for phase in scene.phases:
        interface = build.CATALOGUE[phase.main.model].interface(phase.main.terms)
        assert set(phase.main.parameters) <= set(interface.references)
        assert set(phase.main.parameters) <= set(phase.main.defaults)


def test_table_2_is_the_papers() -> None:
    (phase,) = load("table2-deorbit").phases
    assert phase.main.parameters == {
        "chaser.mass": 2000.0,
        "target.mass": 1000.0,
        "orbit.altitude": 800e3,
        "orbit.inclination": math.radians(98.0),
        "start.condition": 0.0,
        "start.leading": 0.0,
        "start.separation": 10.0,
        "tether.rest_length": 12.0,
        "tether.diameter": 1e-3,
        "tether.youngs_modulus": 60e9,
        "tether.damping_ratio": 0.05,
        "thrust.level": -0.01,
        "thrust.specific_impulse": 3000.0,
    }
    physics = {"reel": "locked", "thrust": "along_track", "environment": "central"}
    assert phase.main.terms == physics | {"solver": "dop853", "target": "point", "chaser": "point"}
    assert (phase.macro_step, phase.duration) == (60.0, 86400.0)


def test_table_1_is_the_papers() -> None:
    (phase,) = load("table1-capture").phases
    expected = {
        "net.side": 24.0,
        "net.mass": 0.33,
        "bullets.mass": 0.5,
        "bullets.speed": 3.0,
        "bullets.angle": math.radians(40.0),
        "vertex.mass": 0.15,
        "target.size[1]": 4.0,
        "target.size[2]": 8.0,
        "target.size[3]": 4.0,
    }
    assert expected.items() <= phase.main.parameters.items()
    assert phase.options.snapshots == [0.0, 5.32, 7.24, 9.13, 11.21, 12.32, 13.8, 15.0]


def test_the_orbit_goes_to_every_phase_that_has_it() -> None:
    capture, removal = load("mission").phases
    assert capture.main.parameters["orbit.altitude"] == removal.main.parameters["orbit.altitude"] == 800e3
    assert "orbit.inclination" not in capture.main.parameters
    assert "orbit.inclination" in removal.main.parameters


def test_what_is_not_named_is_not_in_the_fmu() -> None:
    text = find("table1-capture").read_text()
    less = text.replace('[capture.contact]\nlaw = "inelastic"\n', "")
    assert "contact" in parse(text, "a", "a").phases[0].main.terms
    assert "contact" not in parse(less, "a", "a").phases[0].main.terms


def test_a_phase_can_be_run_alone() -> None:
    text = find("mission").read_text().replace('["capture", "removal"]', '["capture"]')
    assert [phase.name for phase in parse(text, "a", "a").phases] == ["capture"]


def test_the_contract_names_what_our_models_mean() -> None:
    capture, removal = (build.CATALOGUE[model] for model in ("net_capture", "tethered_deorbit"))
    outcome = next(v for v in capture.base if v.name == "outcome")
    condition = next(v for v in removal.base if v.name == "start.condition")
    assert outcome.choices == OUTCOMES
    assert HANDED_OVER in condition.choices


def test_lines_of_keys() -> None:
    text = '# first\ntitle = "a # b"\n\n[orbit]\nheight = 1\n[capture . net] # why\nsize = [\n  "1 m",\n]\na.b = 2\n'
    lines = key_lines(text)
    assert lines == {
        ("title",): 2,
        ("orbit",): 4,
        ("orbit", "height"): 5,
        ("capture",): 6,
        ("capture", "net"): 6,
        ("capture", "net", "size"): 7,
        ("capture", "net", "size", 0): 8,
        ("capture", "net", "a"): 10,
        ("capture", "net", "a", "b"): 10,
    }
    assert line_of(lines, ("capture", "net", "missing")) == 6
    assert line_of(lines, ("nowhere",)) is None


ODD = '''"odd [key]" = """
[no]
x = 1"""
when = 1979-05-27 07:32:00 # a date
[a . "b.c"] # = [
size = [
  "1 m", # , ]
  ["a]", {b = 1, "c.d".e = "}"}],
]
p = {x = "}", y = [1, 2]}
[[t]]
k = 1
[[t]]
k = \'\'\'
]\'\'\'
[t.u]
v = ""
w = "\\""
'''


def paths(value: Any, above: Path = ()) -> Iterator[Path]:
    """Every key and element of a document."""
    inner = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, below in inner:
        yield (*above, key)
        yield from paths(below, (*above, key))


def test_every_key_and_element_has_its_line() -> None:
    lines = key_lines(ODD)
    assert set(lines) == set(paths(tomllib.loads(ODD)))
    shown = {dotted(path): line for path, line in lines.items()}
    assert shown['"odd [key]"'] == 1
    assert shown['a."b.c".size[1]'] == 7
    assert shown['a."b.c".size[2][2]."c.d".e'] == 8
    assert shown['a."b.c".p.y[2]'] == 10
    assert (shown["t[1].k"], shown["t[2].k"], shown["t[2].u.w"]) == (12, 14, 18)


@pytest.mark.parametrize("name", sorted(shipped()))
def test_every_key_of_a_shipped_scene_has_a_line(name: str) -> None:
    text = find(name).read_text()
    lines = key_lines(text)
    assert set(lines) == set(paths(tomllib.loads(text)))
    rows = text.splitlines()
    for path, line in lines.items():
        key = next(str(part) for part in reversed(path) if isinstance(part, str))
        assert key in rows[line - 1] or isinstance(path[-1], int)


@pytest.mark.parametrize("cut", range(0, 200, 7))
def test_a_text_cut_short_has_the_lines_before_the_cut(cut: int) -> None:
    """Nothing loops or fails, whatever the text."""
    whole = key_lines(ODD)
    assert all(whole.get(path, line) == line for path, line in key_lines(ODD[:cut]).items() if path[:1] != ("t",))
