"""A scene in Python: values go the way of `--set`, whatever type they have, and are refused as there."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from astropy import units

import dcone_cosim as dc
from dcone_cosim.api.said import settings_of, told
from dcone_cosim.errors import InputError
from dcone_cosim.loading import load


def test_the_package_imports_nothing_until_it_is_asked() -> None:
    code = (
        "import sys, dcone_cosim; print([m for m in sys.modules if m.startswith(('numpy', 'pandas', 'dcone_cosim.'))])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
    assert {"load_scene", "run", "sweep", "load_run", "Run"} <= set(dir(dc))
    with pytest.raises(AttributeError, match="no attribute 'runn'"):
        _ = dc.runn  # type: ignore[attr-defined]


def test_scenes_by_name_path_and_run(tmp_path: Path) -> None:
    scene = dc.load_scene("mission")
    assert (scene.name, scene.phases) == ("mission", ("capture", "removal"))
    assert "mission" in dc.list_scenes()
    (tmp_path / "mine.toml").write_text(scene.text)
    assert dc.load_scene(tmp_path / "mine.toml").phases == scene.phases
    with pytest.raises(InputError, match="did you mean 'mission'"):
        dc.load_scene("misson")
    assert "same_orbit" not in scene._repr_html_()
    assert "Mission" in scene._repr_html_()


def test_with_other_values() -> None:
    """By key, by table, and one after the other; the scene before stays as it was."""
    scene = dc.load_scene("mission")
    for other in (
        scene.with_({"removal.tether.diameter": "2 mm", "removal.duration": "1 h"}),
        scene.with_(removal={"tether.diameter": "2 mm", "duration": "1 h"}),
        scene.with_(removal={"tether": {"diameter": 2.0 * units.mm}, "duration": 1 * units.hour}),
        scene.with_({"removal.tether.diameter": "9 mm"}).with_(removal={"tether.diameter": "2 mm", "duration": "1 h"}),
        dc.load_scene("mission", removal={"tether.diameter": "2 mm", "duration": "1 h"}),
    ):
        removal = other.checked.phases[1]
        assert (removal.setting("tether.diameter"), removal.duration) == (2e-3, 3600.0)
        assert "removal.tether.diameter" in other.title
    assert scene.checked.phases[1].setting("tether.diameter") == 1e-3


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"removal.tether.diameter": 2.0}, "expected a length with its unit"),
        ({"removal.tether.diametre": "2 mm"}, "did you mean"),
        ({"removal.tether.diameter": "2 kg"}, "length"),
        ({"removal.tether.diameter": object()}, "expected a text with a unit"),
        ({}, "nothing is changed"),
    ],
)
def test_what_is_refused(changes: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError, match=said):
        dc.load_scene("mission").with_(changes)


@pytest.mark.parametrize(
    ("value", "text"),
    [
        ("2 mm", "2 mm"),
        ("0.5", '"0.5"'),
        ("true", '"true"'),
        ("", '""'),
        (True, "true"),
        (3, "3"),
        (0.1, "0.1"),
        (np.float64(0.25), "0.25"),
        (0.1 * units.m, '"0.1 m"'),
        (["0 m", "1 m"], '["0 m", "1 m"]'),
        ([1.0, 2.0] * units.km, '["1.0 km", "2.0 km"]'),
        (np.array([1, 2]), "[1, 2]"),
        (0.5 * units.dimensionless_unscaled, "0.5"),
    ],
)
def test_how_values_are_said(value: Any, text: str) -> None:
    assert told("key", value) == text


def test_every_bit_of_a_quantity_arrives() -> None:
    number = 0.1 + 0.2
    (setting,) = settings_of(
        {
            "removal.tether.rest_length": number * 50.0 * units.m,
        }
    )
    scene = load("table2-deorbit", [setting])
    assert scene.phases[0].setting("tether.rest_length") == number * 50.0
