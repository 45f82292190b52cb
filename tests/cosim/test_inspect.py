"""What a scene implies: by hand for the paper's tables, and to the bit what the models themselves compute with."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping

import pytest

from dcone_cosim import build
from dcone_cosim.loading import load
from fmu_src.instance import Instance
from fmu_src.net_capture.planes import MASS
from tests.cosim.conftest import Dcone
from tests.net_capture.memory import graph, nodes, planes


def implied(scene: str, *settings: str, phase: int = 0) -> dict[str, float]:
    chosen = load(scene, settings).phases[phase]
    values = {**chosen.main.defaults, **chosen.main.parameters}
    return {row.key: row.value for row in build.implied(chosen.main.model, values, chosen.main.terms)}


def instance(scene: str, *settings: str, phase: int = 0) -> Instance:
    """The model of a scene's phase, initialised in this process."""
    chosen = load(scene, settings).phases[phase]
    return Instance(build.CATALOGUE[chosen.main.model], chosen.main.terms, chosen.main.parameters).initialise()


def close(found: Mapping[str, float], expected: Mapping[str, float]) -> None:
    for key, value in expected.items():
        assert found[key] == pytest.approx(value, rel=2e-5), key


def test_table_1_by_hand() -> None:
    """1200 m of thread, 0.33 kg of 1440 kg/m3 and 70 GPa: A = 0.33/(1440 x 1200); a knot has two metres of it.

    The corners, half a kilogram and a metre of thread each, leave at 3 m/s and 40 deg.
    """
    close(
        implied("table1-capture"),
        {
            "thread.area": 1.909722e-7,
            "thread.diameter": 4.93105e-4,
            "thread.axial_stiffness": 13368.06,
            "thread.stiffness": 13368.06,
            "thread.dashpot": 0.212 * math.sqrt(13368.06 * 5.5e-4),
            "knot.mass": 5.5e-4,
            "edge.mass": 4.125e-4,
            "corner.mass": 0.500275,
            "catch.mass": 2.48,
            "shot.momentum": 4.598790,
            "shot.energy": 9.00495,
            "shot.recoil": 2.299395e-3,
            "shot.opening": 23.5 / (math.sqrt(2.0) * 0.8390996),
            "cord_locked.stiffness": 3612.0,
            "cord_locked.period": 2.0 * math.pi * math.sqrt(0.25 / 3612.0),
            "cord_open.stiffness": 37.625,
            "cord_open.period": 2.0 * math.pi * math.sqrt(0.25 / 37.625),
        },
    )


def test_a_shot_square_to_its_axis_has_no_momentum() -> None:
    """Bullets thrown in the plane of the mouth: their energy is whole, and nothing recoils."""
    square, usual = implied("deployment", "capture.bullets.angle=90 deg"), implied("deployment")
    assert square["shot.momentum"] == square["shot.recoil"] == 0.0 < usual["shot.momentum"]
    close(square, {"shot.energy": usual["shot.energy"]})


def test_table_2_by_hand() -> None:
    close(
        implied("table2-deorbit"),
        {
            "pair.reduced_mass": 666.66667,
            "line.area": 7.853982e-7,
            "line.axial_stiffness": 47123.89,
            "line.stiffness": 3926.99,
            "line.dashpot": 0.1 * math.sqrt(3926.99 * 666.66667),
            "line.period": 2.588835,
            "orbit.period": 6052.4135,
            "tide.tension": 0.0258651,
            "vbar.critical_thrust": 0.0775953,
        },
    )


@pytest.mark.parametrize(
    ("scene", "settings"),
    [
        ("table1-capture", ()),
        ("mission", ("capture.net.damping_ratio=0.3",)),
        ("table1-capture", ("capture.net.segments=3", "capture.net.mesh=3 m")),
    ],
)
def test_the_net_is_that_of_the_model(scene: str, settings: tuple[str, ...]) -> None:
    """Stiffness and dashpot to the bit; masses as the model lays them out; the energy that it measures at the shot."""
    rows, model = implied(scene, *settings), instance(scene, *settings)
    segments, knots = int(model["net.segments"]), round(model["net.side"] / model["net.mesh"]) + 1
    threads = graph(model)
    assert set(threads.stiffness) == {rows["thread.stiffness"] * segments}
    assert set(threads.damping) == {rows["thread.dashpot"] * segments}
    mass = planes(model)[MASS, nodes(model)]
    grid = mass[: knots * knots].reshape(knots, knots)
    laid_out = [grid[0, 0], grid[0, 1], grid[1, 1]]
    assert laid_out == pytest.approx([rows["corner.mass"], rows["edge.mass"], rows["knot.mass"]], rel=1e-12)
    if segments > 1:
        assert mass[knots * knots] == pytest.approx(rows["thread_node.mass"], rel=1e-12)
    assert float(mass.sum()) == pytest.approx(rows["catch.mass"], rel=1e-12)
    assert model["energy.kinetic"] == pytest.approx(rows["shot.energy"], rel=1e-12)
    recoil = math.sqrt(sum(model[f"chaser.velocity[{i}]"] ** 2 for i in (1, 2, 3)))
    assert recoil == pytest.approx(rows["shot.recoil"], rel=1e-12)


@pytest.mark.parametrize(
    "settings",
    [
        (),
        ("removal.tether.diameter=2 mm", "removal.chaser.mass=500 kg", "removal.tether.damping_ratio=0.2"),
        ("removal.reel.length_offset=1.5 m",),
    ],
)
def test_the_line_is_that_of_the_model_to_the_bit(settings: tuple[str, ...]) -> None:
    rows, record = implied("table2-deorbit", *settings), instance("table2-deorbit", *settings).record[0]
    assert record["state_stiffness"] == rows["line.stiffness"]
    assert record["state_damping"] == rows["line.dashpot"]
    assert record["state_reduced_mass"] == rows["pair.reduced_mass"]
    assert 2.0 * math.pi / record["state_frequency"] == rows["line.period"]
    assert 2.0 * math.pi / record["state_mean_motion"] == rows["orbit.period"]


def test_a_reel_that_works_feeds_the_tide_forward(tmp_path) -> None:
    text = "\n".join(
        [
            '[removal]\nmacro_step = "10 s"\nduration = "1 h"',
            '[removal.reel]\nlaw = "linear"\nlength = "15 m"',
            '[removal.start]\nseparation = "15 m"',
            '[removal.thrust]\ndirection = "along_track"\nlevel = "0 N"',
        ]
    )
    (tmp_path / "mine.toml").write_text(text)
    rows, model = implied(str(tmp_path / "mine.toml")), instance(str(tmp_path / "mine.toml"))
    assert model.record[0]["state_feed_forward"] == rows["tide.tension"]
    assert "line.area" not in rows


def test_it_is_shown_with_units_and_told_to_machines(dcone: Dcone) -> None:
    code, out, _ = dcone("inspect", "table1-capture")
    assert code == 0
    lines = [" ".join(line.split()) for line in out.splitlines()]
    assert "section of a thread 0.190972 mm2" in lines
    assert "stiffness of a thread from knot to knot 13368.1 N/m" in lines
    assert "momentum of the shot 4.59879 N s" in lines
    work = instance("table1-capture").work.size
    assert f": {work:,} of work memory," in " ".join(out.split())
    code, out, _ = dcone("inspect", "table1-capture", "--json")
    (component,) = json.loads(out)["components"]
    rows = component["implied"]
    assert rows["thread.area"] == {"label": "section of a thread", "value": pytest.approx(1.909722e-7), "unit": "m2"}
    substep = rows["solver.substep"]["value"]
    assert substep <= rows["solver.stability_bound"]["value"]
    assert rows["solver.substeps"]["value"] == pytest.approx(30.0 / substep)
    assert "gravity: none" in component["terms"]["in"]


def test_a_removal_after_a_capture_has_the_masses_that_are_handed_over(dcone: Dcone) -> None:
    """1000 kg and 6.07 kg of net, bullets and vertex, against 2000 kg."""
    code, out, _ = dcone("inspect", "mission", "--json")
    assert code == 0
    removal = json.loads(out)["components"][1]
    assert removal["phase"] == "removal"
    assert removal["implied"]["pair.reduced_mass"]["value"] == pytest.approx(2000.0 * 1006.07 / 3006.07, rel=1e-12)
