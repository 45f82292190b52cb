"""A line of lumped nodes beside MoorDyn: a mass that swings on it, and one that falls into it and snaps."""

import json
import math

import numpy as np
import pytest

from tests.plain import plain
from tests.tethered_deorbit import lumped as pair
from tests.tethered_deorbit.evidence import moordyn
from tests.validation import Validated, other_code

__all__ = ["plain"]

pytestmark = pytest.mark.usefixtures("plain")
STORED = json.loads(moordyn.RESULT.read_text(encoding="utf-8"))
CHASER = 1e6
"""Whose thrust makes uniform gravity [kg]: the mass on the line pulls 1e-7 of it back."""


@pytest.mark.parametrize(
    ("case", "until", "apart", "pull"),
    [
        ("fall", 30.0, 1e-7, 1e-5),
        pytest.param("swing", 120.0, 1e-7, 1e-5, marks=pytest.mark.evidence),
    ],
)
def test_a_mass_on_a_line(validated: Validated, case: str, until: float, apart: float, pull: float) -> None:
    """Place of the mass and tension at the fixed end, every five seconds."""
    start = np.array(STORED[case]["start"])
    values = {
        "chaser.mass": CHASER,
        "target.mass": moordyn.MASS,
        "thrust.level": CHASER * moordyn.GRAVITY,
        "tether.youngs_modulus": moordyn.AXIAL / pair.SECTION,
        "start_relative_position": (*start[-1], 0.0),
    }
    i = pair.lumped(moordyn.PIECES - 1, moordyn.DENSITY, values, thrust="along_track")
    pair.put_nodes(i, np.column_stack([start[1:-1] - start[-1], np.zeros(moordyn.PIECES - 1)]))
    rows = np.array([row for row in STORED[case]["rows"] if row[0] <= until])
    found = []
    for _ in rows:
        i.step(moordyn.EVERY)
        found.append((i["relative.position[1]"], i["relative.position[2]"], i["tether.tension"]))
    mine, source = np.array(found), other_code(f"MoorDyn {STORED['moordyn']}")
    what = f"a mass that {case}s on a line of four nodes, {until:g} s"
    validated(source, f"{what}: its place", mine[:, :2], rows[:, 1:3], "m", abs=apart * pair.LENGTH)
    most = float(rows[:, 3].max())
    validated(source, f"{what}: tension at the fixed end", mine[:, 2], rows[:, 3], "N", abs=pull * most)
    assert math.isclose(moordyn.LENGTH, pair.LENGTH)
