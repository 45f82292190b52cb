"""A similar breadboard: powers by hand, the same opening over t/s, what it says can not be kept."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from dcone_cosim.commands import write_scene
from dcone_cosim.errors import InputError
from dcone_cosim.loading import load
from dcone_cosim.scene.data import Scene
from dcone_cosim.scenes.scaled import power, share_of
from fmu_src.instance import Instance
from fmu_src.net_capture.interface import MODEL
from tests.conftest import FREE

S = 1.0 / 16.0
AT = (4.0, 6.0, 8.0, 9.0)


@pytest.fixture(scope="module")
def pair(tmp_path_factory: pytest.TempPathFactory) -> tuple[Scene, Scene, str]:
    path = write_scene(str(tmp_path_factory.mktemp("scaled") / "small"), "table1-capture", "1/16")[0]
    return load("table1-capture"), load(str(path)), Path(path).read_text()


@pytest.mark.parametrize(
    ("unit", "expected"),
    [
        ("m", 1),
        ("s", 1),
        ("kg", 3),
        ("m/s", 0),
        ("Pa", 0),
        ("kg/m3", 0),
        ("N", 2),
        ("rad/s", -1),
        ("kg.m2", 5),
        ("1", 0),
    ],
)
def test_powers_are_those_of_similarity(unit: str, expected: int) -> None:
    assert power(unit) == expected


def test_every_value_takes_its_share(pair: tuple[Scene, Scene, str]) -> None:
    large, small, _ = (pair[0].phases[0], pair[1].phases[0], pair[2])
    assert (small.duration, small.macro_step) == pytest.approx((S * large.duration, S * large.macro_step), rel=1e-10)
    assert small.options.snapshots == pytest.approx([S * time for time in large.options.snapshots], rel=1e-10)
    for name, exponent in (
        *(("net.side", 1), ("net.mesh", 1), ("net.mass", 3), ("net.fold_side", 1), ("bullets.mass", 3)),
        *(("bullets.speed", 0), ("net.youngs_modulus", 0), ("net.density", 0), ("net.damping_ratio", 0)),
        *(("closing.axial_stiffness", 2), ("closing.stall_force", 2), ("closing.lock_length", 1), ("closing.time", 1)),
        *(("target.mass", 3), ("target.start_rate[3]", -1), ("chaser.start_position[2]", 1), ("closing.timeout", 1)),
    ):
        assert small.setting(name) == pytest.approx(S**exponent * (large.setting(name) or 0.0), rel=1e-10), name


def opening(scene: Scene, share: float, more: dict[str, float] | None = None) -> list[float]:
    """A/A0 at the same t/s."""
    phase = scene.phases[0]
    known = {v for v, _, row, _ in MODEL.interface(FREE).scalars() if row.causality == "parameter"}
    values = {**phase.main.defaults, **phase.main.parameters, "net.mesh": 2.0 * share, **(more or {})}
    net = Instance(MODEL, FREE, {name: value for name, value in values.items() if name in known}).initialise()
    found = []
    for time in AT:
        net.step(share * time - net.time)
        found.append(float(net["mouth.area_ratio"]))
    return found


def test_it_opens_as_the_large_one(pair: tuple[Scene, Scene, str]) -> None:
    """The same A/A0 at the same t/s within 1 %; with masses by the square of the share it is another net."""
    large, small = opening(pair[0], 1.0), opening(pair[1], S)
    assert small == pytest.approx(large, rel=0.01)
    assert max(large) > 0.8
    heavier = {"net.mass": S**2 * 0.33}
    assert np.abs(np.array(opening(pair[1], S, heavier)) / large - 1.0).max() > 0.01


def test_it_says_what_can_not_be_kept(pair: tuple[Scene, Scene, str]) -> None:
    text = pair[2]
    head = text[: text.index("title")]
    for word in ("gravity", "drag", "E:"):
        assert f"# - {word}" in head
    fall = 0.5 * 9.80665 * (30.0 / 16.0) ** 2
    assert f"falls {fall:.3g} m" in head
    assert "threads of 0.0308 mm" in head  # of 0.493 mm, by the mass


@pytest.mark.parametrize("given", ["0", "-1/2", "2", "1/0", "half", ""])
def test_a_share_that_is_none_is_told(given: str) -> None:
    with pytest.raises(InputError, match="expected a share above 0 and up to 1, such as 1/16"):
        share_of(given)


def test_a_tow_can_not_be_scaled(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="does not begin with a capture"):
        write_scene(str(tmp_path / "small"), "table2-deorbit", "1/16")
    assert not list(tmp_path.iterdir())
