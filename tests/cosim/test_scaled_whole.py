"""All that has a dimension takes its share, wherever a scene says it: by dimensional analysis, apart from the code's.

With mass, length and time scaled by s3, s and s, what astropy counts in kg^a m^b s^c takes s^(3a + b + c).
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from astropy import units

from dcone_cosim import build
from dcone_cosim.commands import write_scene
from dcone_cosim.errors import InputError
from dcone_cosim.loading import find, load, shipped
from dcone_cosim.scene.data import Scene

S = 0.5
OF_A_PLACE = ("orbit.altitude", "gravity.acceleration", "air.")
QUANTITY = re.compile(r"\s*([-+0-9.eE]+)\s*([A-Za-z].*|/.*)")


def scale_of(unit: units.UnitBase) -> float:
    base_units = unit.decompose()
    bases = dict(zip(base_units.bases, base_units.powers, strict=True))
    mass, length, time = (float(bases.get(base, 0)) for base in (units.kg, units.m, units.s))
    return float(S ** (3.0 * mass + length + time))


def quantities(told: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[tuple[Any, ...], units.Quantity]]:
    """Every value with a unit in a document, and where it stands."""
    if isinstance(told, dict | list):
        for key, inner in told.items() if isinstance(told, dict) else enumerate(told):
            yield from quantities(inner, (*path, key))
    elif isinstance(told, str) and (found := QUANTITY.fullmatch(told)) and path[-1] != "title":
        yield path, float(found[1]) * units.Unit(found[2])


def at(document: Any, path: tuple[Any, ...]) -> Any:
    for part in path:
        document = document[part]
    return document


def captures() -> list[str]:
    return [name for name in shipped() if tomllib.loads(find(name).read_text()).get("capture")]


def written(tmp_path: Path, origin: str) -> tuple[str, Scene]:
    path = write_scene(str(tmp_path / "small"), origin, "1/2")[0]
    return path.read_text(), load(str(path))


@pytest.mark.parametrize("origin", captures())
def test_each_quantity_of_a_shipped_capture_takes_its_share(tmp_path: Path, origin: str) -> None:
    given = tomllib.loads(find(origin).read_text())
    text, small = written(tmp_path, origin)
    head, told = text[: text.index("title =")], tomllib.loads(text)
    for path, value in quantities(given):
        if path[0] not in told:
            assert f"[{path[0]}]" in head, path
            continue
        expected = value * scale_of(value.unit)
        if path[0] == "orbit" and path[1] not in told["orbit"]:
            continue  # without an orbital frame no phase has it
        name = ".".join(key for key in path if isinstance(key, str)).removeprefix("capture.")
        if name.startswith(OF_A_PLACE) and scale_of(value.unit) != 1.0:
            # where nothing goes by the orbit, what is said of it is kept without a word
            assert name in head or (path[0] == "orbit" and "hill" not in str(told["capture"])), path
            expected = value
        found = dict(quantities(at(told, path[:1]), path[:1]))[path]
        assert found.to_value(value.unit) == pytest.approx(expected.value, rel=1e-10, abs=0.0), path
    large = load(origin).phases[0].main
    before, after = ({**main.values, **main.asked} for main in (large, small.phases[0].main))
    for row in build.settable(build.CATALOGUE[large.model].interface(large.terms)):
        if row.kind == "Real" and row.section not in ("orbit", "gravity", "air"):
            for variable in row.element_names():
                expected_si = before[variable] * scale_of(units.Unit(row.unit))
                assert after[variable] == pytest.approx(expected_si, rel=1e-9), variable


NODES = """node, x [cm], y [m], role
1, -300, -3, corner
2, 300, -3, corner
3, 300, 3, corner
4, -300, 3, corner
5, 0, 0.5, vertex
"""
THREADS = """from, to, length [m], diameter [mm], stiffness [N/m], mass [g], damping [N s/m]
1, 2, , 0.8, , ,
2, 3, 6.4, , 5000, 3, 0.06
3, 4, , 0.8, , ,
4, 1, , 0.8, , ,
1, 5, , 0.8, , ,
2, 5, , 0.8, , ,
3, 5, , 0.8, , ,
4, 5, , 0.8, , ,
"""
OWN = """
[capture]
macro_step = "0.02 s"
duration = "6 s"
hand_over = "none"
[capture.net]
shape = "table"
node_file = "n.csv"
thread_file = "t.csv"
youngs_modulus = "70 GPa"
density = "1440 kg/m3"
damping_ratio = 0.106
fold_side = "0.4 m"
[capture.gravity]
law = "none"
[capture.bullets]
mass = "1.27 kg"
[capture.vertex]
mass = "0.15 kg"
[capture.chaser]
mass = "2000 kg"
start_position = ["0 m", "-12 m", "0 m"]
[capture.closing]
diameter = "2 mm"
material = "nylon 66"
"""


def own_net(tmp_path: Path, text: str = OWN) -> str:
    folder = tmp_path / "large"
    folder.mkdir()
    (folder / "n.csv").write_text(NODES)
    (folder / "t.csv").write_text(THREADS)
    (folder / "g.csv").write_text("0, 0, 0, 0\n1, 0, 0, -9.81\n")
    (folder / "large.toml").write_text(text)
    return str(folder / "large.toml")


def test_the_files_of_a_net_are_scaled_beside_the_scene(tmp_path: Path) -> None:
    text, small = written(tmp_path, own_net(tmp_path, OWN[: OWN.index("[capture.closing]")]))
    nodes, threads = (small.phases[0].main.tables[f"net.{name}_file"] for name in ("node", "thread"))
    assert nodes.file == tmp_path / "small-n.csv"
    assert nodes.numbers[:, 2:5] == pytest.approx(
        np.array([[-1.5, -1.5, 0], [1.5, -1.5, 0], [1.5, 1.5, 0], [-1.5, 1.5, 0], [0, 0.25, 0]])
    )
    # length s, diameter s, stiffness kg/s2: s, mass s3, dashpot kg/s: s2
    assert threads.numbers[1, 3:] == pytest.approx([3.2, 0.0, 2500.0, 0.003 / 8.0, 0.06 / 4.0])
    assert threads.numbers[0, 3:] == pytest.approx([0.0, 0.0004, 0.0, 0.0, -1.0])
    assert 'node_file = "small-n.csv"' in text


def test_what_is_of_a_place_stays_and_is_named(tmp_path: Path) -> None:
    given = OWN[: OWN.index("[capture.closing]")].replace('law = "none"', 'law = "history"\nhistory = "g.csv"')
    text, small = written(tmp_path, own_net(tmp_path, given))
    assert "of a place: gravity.history" in text[: text.index("title =")]
    assert 'history = "large/g.csv"' in text
    assert small.phases[0].main.tables["gravity.history"].numbers[1, 0] == 1.0


def test_files_that_are_there_are_not_touched(tmp_path: Path) -> None:
    (tmp_path / "small-t.csv").write_text("mine")
    with pytest.raises(InputError, match=r"small-t\.csv is there already and was not touched"):
        written(tmp_path, own_net(tmp_path, OWN[: OWN.index("[capture.closing]")]))
    assert (tmp_path / "small-t.csv").read_text() == "mine"
    assert not list(tmp_path.glob("small*.toml"))
    assert not (tmp_path / "small-n.csv").exists()
