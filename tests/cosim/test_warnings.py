"""What a user may not expect is said in one sentence each, and only where it is so: every case has its twin."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import pytest

from dcone_cosim.loading import load, shipped
from dcone_cosim.phases.removal_report import approach
from dcone_cosim.recorder import TugLog
from dcone_cosim.reports.warnings import warnings
from dcone_cosim.results import RunResult
from dcone_cosim.scene.data import Scene
from fmu_src.cautions import Range
from fmu_src.net_capture import cautions as of_nets
from fmu_src.tethered_deorbit import cautions as of_tows
from tests.cosim.conftest import Dcone
from tests.cosim.test_summary import found, removal_run

MakeScene = Callable[..., Scene]


def cautions(scene: str, *settings: str) -> str:
    return "\n".join(load(scene, settings).cautions)


SAID = dict.fromkeys(
    ("large-conf2", "large-conf2-holds", "large-conf3", "large-conf3-holds"), "so it can hardly count as captured"
)
"""What shipped scenes are warned of, as they say themselves: the paper's nets that can not be drawn together behind
their target."""


@pytest.mark.parametrize("scene", shipped())
def test_the_shipped_scenes_give_no_cause(scene: str) -> None:
    told = cautions(scene).splitlines()
    assert len(told) == (scene in SAID)
    assert all(SAID[scene] in line for line in told)


@pytest.mark.parametrize(
    ("scene", "setting", "twin", "said"),
    [
        ("table2-deorbit", "orbit.altitude=119 km", "orbit.altitude=121 km", "orbit.altitude: 119 km is below 120 km"),
        ("mission", "orbit.altitude=119 km", "orbit.altitude=121 km", "orbit.altitude: 119 km is below 120 km"),
        ("table2-deorbit", "removal.thrust.level=0.01 N", "removal.thrust.level=0 N", "thrust.level: 0.01 N in the"),
        ("table2-deorbit", "removal.thrust.offset=0.02 N", "removal.thrust.offset=5 mN", "thrust.level: 0.01 N in the"),
        ("table2-deorbit", "removal.tether.damping_ratio=0.51", "removal.tether.damping_ratio=0.5", "2 zeta v"),
        ("table1-capture", "capture.net.damping_ratio=0.51", "capture.net.damping_ratio=0.5", "2 zeta v"),
        ("table1-capture", "capture.solver.step_ratio=0.79", "capture.solver.step_ratio=0.77", "0.774 would hold them"),
        ("table1-capture", "capture.closing.rings=0", "capture.closing.rings=1", "loops of 24.2 m, and 16 m let this"),
        ("mission", "capture.closing.rings=0", "capture.closing.rings=2", "a minute; 1 would hold it"),
        ("mission", "capture.closing.damping_ratio=0.6", "capture.closing.damping_ratio=0.4", "2 zeta v"),
    ],
)  # fmt: skip
def test_before_a_run(scene: str, setting: str, twin: str, said: str) -> None:
    assert cautions(scene, setting).count(said) == 1
    assert cautions(scene, twin) == ""


def test_a_frame_that_stands_still_in_the_capture_alone(tmp_path: Path) -> None:
    text = Path(shipped()["mission"]).read_text()
    (tmp_path / "still.toml").write_text(text.replace('law = "hill"', 'law = "none"'))
    assert 'capture.gravity: law = "none" lets the orbital frame stand still' in cautions(str(tmp_path / "still.toml"))
    assert "gravity" not in cautions("mission") + cautions("table1-capture")


def test_the_perigee_counts() -> None:
    """a (1 - e) = 6978.137 km x 0.93 is 111.5 km over the equatorial radius."""
    assert "the perigee at 111.5" in cautions("table2-deorbit", "orbit.altitude=600 km", "orbit.eccentricity=0.07")
    assert cautions("table2-deorbit", "orbit.altitude=600 km", "orbit.eccentricity=0.06") == ""


def test_an_isp_that_was_not_given(tmp_path: Path) -> None:
    text = Path(shipped()["table2-deorbit"]).read_text()
    lines = [line for line in text.splitlines() if not line.startswith("specific_impulse")]
    (tmp_path / "mine.toml").write_text("\n".join(lines))
    assert "removal.thrust.specific_impulse: not given; the propellant is that of 3000 s" in cautions(
        str(tmp_path / "mine.toml")
    )
    assert cautions(str(tmp_path / "mine.toml"), "removal.thrust.level=0 N") == ""


def after(
    make_scene: MakeScene,
    columns: dict[str, Sequence[float]],
    removal: Mapping[str, float] | None = None,
    reach: float | None = None,
) -> str:
    """The warnings of a removal with these columns and parameters, of a target that was handed over with this reach."""
    run = removal_run(make_scene("removal"), columns, [100.0, 160.0, 220.0], TugLog(1))
    masses = {"chaser.mass": 2000.0, "target.mass": 1000.0}
    run.parameters |= {"removal": {**masses, **(removal or {})}}
    if reach is not None:
        run.handovers["removal"] = SimpleNamespace(reach=reach)  # type: ignore[assignment]
    return "\n".join(warnings(run))


def test_propellant_beyond_two_hundredths_of_the_mass(make_scene: MakeScene) -> None:
    """Of 3000 kg, 60 kg are that."""
    assert "60.1 kg were used, 2 % of the pair's mass" in after(make_scene, {"chaser.propellant": [0.0, 30.0, 60.1]})
    assert after(make_scene, {"chaser.propellant": [0.0, 30.0, 59.9]}) == ""


@pytest.mark.parametrize("output", ["tether.tension_peak", "tether.tension"])
def test_a_line_strained_beyond_its_fibre(make_scene: MakeScene, output: str) -> None:
    """EA = 60 GPa x pi (0.2 mm)^2 / 4 = 1884.96 N: Kevlar 29, nearest in stiffness, breaks at 3.6 %, 67.86 N."""
    line = {"tether.youngs_modulus": 60e9, "tether.diameter": 0.2e-3}
    told = after(make_scene, {output: [0.0, 68.5, 1.0]}, line)
    assert "68.5 N, which is 3.63 % of its E A; Kevlar 29, of which it may be, breaks at 3.6 %" in told
    assert after(make_scene, {output: [0.0, 67.2, 1.0]}, line) == ""
    stiff = {**line, "tether.youngs_modulus": 110e9}
    assert "Kevlar 49" in after(make_scene, {output: [0.0, 0.025 * 110e9 * 3.1416e-8, 1.0]}, stiff)
    assert after(make_scene, {output: [0.0, 0.023 * 110e9 * 3.1416e-8, 1.0]}, stiff) == ""
    soft = {**line, "tether.youngs_modulus": 5e9}
    assert after(make_scene, {output: [0.0, 0.19 * 5e9 * 3.1416e-8, 1.0]}, soft) == ""
    assert "nylon 66" in after(make_scene, {output: [0.0, 0.21 * 5e9 * 3.1416e-8, 1.0]}, soft)


def capture_run(scene: Scene, columns: dict[str, Sequence[float]], parameters: dict[str, float]) -> RunResult:
    run = removal_run(scene, columns, [0.0, 1.0], TugLog(1))
    run.phases = {"capture": run.phases["removal"]}
    run.parameters = {"capture": parameters}
    return run


def test_threads_and_cord(make_scene: MakeScene) -> None:
    """Table 1: 1200 m of thread weigh 0.33 kg, so A = 0.19097 mm2 and EA = 13,368 N; the nylon cord has 903 N."""
    scene = make_scene("capture")
    square = replace(scene.phases[0].main, terms={"net": "square", "closing": "winches"})
    scene = replace(scene, phases=(replace(scene.phases[0], main=square),))
    net = {"net.side": 24.0, "net.mesh": 1.0, "net.mass": 0.33, "net.density": 1440.0, "net.youngs_modulus": 70e9}
    net["net.damping_ratio"] = 0.106
    columns = {"thread.tension_max": [0.0, 485.0], "cord.tension_max": [0.0, 150.0]}
    cord = {**net, "closing.axial_stiffness": 903.0}
    (thread,) = warnings(capture_run(scene, columns, cord))
    assert thread.startswith("capture: a thread of the net bore 485 N, which is 3.63 % of its E A; Kevlar 29")
    columns = {"thread.tension_max": [0.0, 478.0], "cord.tension_max": [0.0, 185.0]}
    (told,) = warnings(capture_run(scene, columns, cord))
    assert (
        "the closing cord bore 185 N, which is 20.5 % of its E A; nylon 66, of which it may be, breaks at 20 %" in told
    )
    given = replace(square, parameters={"closing.axial_stiffness": 903.0})
    scene = replace(scene, phases=(replace(scene.phases[0], main=given),))
    columns["cord.tension_max"] = [0.0, 22.0]
    assert "Kevlar 49, of which it may be, breaks at 2.4 %" in warnings(capture_run(scene, columns, cord))[0]


def test_a_capture_that_did_not_last(make_scene: MakeScene) -> None:
    """And a book that leaves over more than a hundredth of what came in: 0.3 J of 9 J and of 12 J of the winches."""
    scene = make_scene("capture")
    (told,) = warnings(capture_run(scene, {"t_capture": [-1.0, 15.2], "t_lost": [-1.0, 28.4]}, {}))
    assert told == "capture.t_lost: the target, captured at 15.2 s, was out of the net at 28.4 s"
    assert not warnings(capture_run(scene, {"t_capture": [-1.0, 15.2], "t_lost": [-1.0, -1.0]}, {}))
    book = {"energy.kinetic": [9.0, 8.0], "closing.work": [0.0, 12.0], "energy.remainder": [0.0, -0.3]}
    (told,) = warnings(capture_run(scene, book, {}))
    assert told.startswith("capture.energy.remainder: the book leaves 0.3 J over of the 21 J that came in, 1.4 %")
    assert not warnings(capture_run(scene, book | {"energy.remainder": [0.0, -0.2]}, {}))


def test_a_pair_that_came_down_into_the_air(make_scene: MakeScene) -> None:
    assert "the pair came down: 119 km is below 120 km" in after(make_scene, {"altitude": [200e3, 140e3, 119e3]})
    assert after(make_scene, {"altitude": [200e3, 140e3, 121e3]}) == ""
    assert after(make_scene, {"altitude": [119e3, 118e3, 117e3]}) == "", "which is said before the run"


def test_an_orbit_that_rose(make_scene: MakeScene) -> None:
    """By a thrust whose direction alone does not tell it; not by the pair's own motion, 7 mm at 7178 km."""
    rising = {"separation": [12.0] * 3, "center.semi_major_axis": [7178e3, 7178e3 + 50.0, 7178e3 + 100.0]}
    thrust = {"thrust.level": 0.01}
    assert "removal.thrust.level: the orbit was raised, by 100 m" in after(make_scene, rising, thrust)
    assert "raised" not in after(make_scene, rising)
    level = {"separation": [12.0] * 3, "center.semi_major_axis": [7178e3, 7178e3, 7178e3 + 0.005]}
    assert "raised" not in after(make_scene, level, thrust)


class TestApproach:
    def test_bodies_that_would_meet(self, make_scene: MakeScene) -> None:
        """25 x 10 x 5 m: the corners are 13.693 m from the centre."""
        reach = 0.5 * math.hypot(25.0, 10.0, 5.0)
        told = after(make_scene, {"separation": [20.0, 5.65, 18.0]}, reach=reach)
        assert "within 5.65 m, 60 s after the removal began, by the rows recorded" in told
        assert "the target reaches 13.7 m from its centre, and the chaser is taken to reach 1 m" in told
        assert "may meet" in after(make_scene, {"separation": [20.0, 14.69, 18.0]}, reach=reach)
        assert after(make_scene, {"separation": [20.0, 14.70, 18.0]}, reach=reach) == ""

    def test_bodies_of_no_known_size(self, make_scene: MakeScene) -> None:
        assert "each is taken to reach 1 m" in after(make_scene, {"separation": [12.0, 1.9, 12.0]})
        assert after(make_scene, {"separation": [12.0, 2.1, 12.0]}) == ""

    def test_what_the_fmu_watched_counts_before_the_rows(self, make_scene: MakeScene) -> None:
        columns = {
            "separation": [12.0, 8.0, 12.0],
            "approach.distance": [12.0, 6.5, 6.5],
            "approach.time": [0.0, 44.0, 44.0],
        }
        run = removal_run(make_scene("removal"), columns, [100.0, 160.0, 220.0], TugLog(1))
        assert approach(run.phases["removal"]) == (6.5, 44.0, False)
        rows = found(run)
        assert (rows["approach"].label, rows["approach"].value, rows["approach_time"].value) == (
            "least distance",
            6.5,
            44.0,
        )
        del columns["approach.time"]
        run = removal_run(make_scene("removal"), columns, [100.0, 160.0, 220.0], TugLog(1))
        assert approach(run.phases["removal"]) == (8.0, 60.0, True)
        assert found(run)["approach"].label == "least distance recorded"


def test_they_are_told_everywhere_and_change_no_exit_code(dcone: Dcone, tmp_path: Path) -> None:
    settings = ("--set", "removal.tether.damping_ratio=0.7", "--set", "removal.duration=1 h")
    code, out, err = dcone("run", "table2-deorbit", "-o", "out", "--no-figures", *settings)
    assert code == 0
    assert err.count("warning: removal.tether.damping_ratio: 0.7 is above 0.5") == 1
    (told,) = json.loads((tmp_path / "out" / "summary.json").read_text())["warnings"]
    assert told.startswith("removal.tether.damping_ratio: 0.7")
    code, out, err = dcone("validate", "table2-deorbit", *settings)
    assert (code, err.count("warning: removal.tether.damping_ratio")) == (0, 1)
    code, out, _ = dcone("validate", "table2-deorbit", "--json", *settings)
    assert (code, json.loads(out)[0]["warnings"]) == (0, [told])


def test_of_an_fmu_from_elsewhere_nothing_is_known_beforehand(make_scene: MakeScene, tmp_path: Path) -> None:
    scene = load("table2-deorbit", ("removal.tether.damping_ratio=0.7",))
    assert scene.cautions
    from dcone_cosim import build

    main = scene.phases[0].main
    (path,) = build.ensure([(main.model, main.terms)], print)
    text = (
        f"""[removal]\nfmu = "{path}"\nmacro_step = "10 s"\nduration = "1 h"\n[removal.tether]\ndamping_ratio = 0.7\n"""
    )
    (tmp_path / "mine.toml").write_text(text)
    assert load(str(tmp_path / "mine.toml")).cautions == ()
    assert math.isclose(load(str(tmp_path / "mine.toml")).phases[0].main.parameters["tether.damping_ratio"], 0.7)


def test_wheels_at_their_limits_are_told() -> None:
    """Where they were in any row, with how far the chaser was off."""
    columns = {"aocs.deviation": Range(0.0, 0.1, 0.0, 0.02)}
    for limited, said in ((1.0, True), (0.0, False)):
        columns["aocs.limited"] = Range(0.0, limited, 0.0, 0.0)
        told = [c for c in of_tows.after({}, (), {"aocs": "wheels"}, columns.get) if c.about == "aocs.limited"]
        assert (len(told) == 1) is said
        assert not said or "5.73 deg" in told[0].sentence


def test_seams_that_nodes_slip_into_are_told(tmp_path: Path) -> None:
    """A slit of 1 mm beneath both ends of a boom; one that stands on its body face to face has none."""
    scene = tmp_path / "boom.toml"
    for length, pairs in (("0.798 m", ("1 and 2", "2 and 3")), ("0.8 m", ())):
        scene.write_text(shipped()["big-panel"].read_text().replace('"0.84 m"', f'"{length}"'))
        told = [line for line in load(str(scene)).cautions if "narrow slit" in line]
        assert [line.partition(" touch")[0] for line in told] == [
            f"capture.target.parts: pieces {pair}" for pair in pairs
        ]


def test_threads_that_go_through_the_target_are_told() -> None:
    """How many, taut, or slack as far as is known."""
    for name, sentence in (
        ("wrap.passed", "taut threads went through the target 13 times: less holds than it seems"),
        (
            "wrap.passed_slack",
            "it was lost 13 times how a slack thread lies, which may have gone through: less holds than it seems",
        ),
    ):
        for passed, said in ((13.0, True), (0.0, False)):
            columns = {name: Range(0.0, passed, 0.0, passed)}
            found = [c.sentence for c in of_nets.after({}, (), {"wrap": "round"}, columns.get) if c.about == name]
            assert (found == [sentence]) is said
