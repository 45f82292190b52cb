"""What a scene says of a hinged appendage, what goes with it, and what is refused by its name."""

from pathlib import Path

import numpy as np
import pytest

from dcone_cosim import build
from dcone_cosim.criteria import Evidence
from dcone_cosim.errors import HandoffError
from dcone_cosim.handoff import require_rigid
from dcone_cosim.loading import load, shipped
from dcone_cosim.phases import capture_clip, capture_criteria
from dcone_cosim.phases.capture_report import findings
from dcone_cosim.recorder import Recorder
from dcone_cosim.results import PhaseResult, RunResult
from dcone_cosim.scene.data import Scene
from dcone_cosim.scene.mistakes import SceneError
from dcone_cosim.scenes.new import new_scene
from tests.cosim.test_warnings import cautions

NAME = "hinged-panel"
INERTIA = 'principal_inertia = ["9 kg m2", "9 kg m2", "9 kg m2"]'
TOW = '\n[removal]\nmacro_step = "1 s"\nduration = "1 h"\n'


def text() -> str:
    return shipped()[NAME].read_text()


def without_hinge(scene: str) -> str:
    return scene[: scene.index("[capture.hinge]")] + scene[scene.index("[capture.contact]") :]


def refused(tmp_path: Path, scene: str) -> str:
    file = tmp_path / "mine.toml"
    file.write_text(scene)
    with pytest.raises(SceneError) as caught:
        load(str(file))
    return str(caught.value)


def test_the_scene_that_is_shipped() -> None:
    main = load(NAME).phases[0].main
    told = {row.key: row for row in build.implied("net_capture", main.values, main.terms)}
    assert 0.09 < told["hinge.frequency"].value < 0.11
    assert told["hinge.mass"].value == pytest.approx(22.0)
    assert told["hinge.dies_out"].value == pytest.approx(2.0 * told["hinge.moment"].value / 0.4)
    assert cautions(NAME) == ""


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda s: s.replace("hinged = true\n", ""), "one or more of them must say `hinged = true`"),
        (lambda s: s.replace('mass = "700 kg"', 'mass = "700 kg"\nhinged = true'), "must not be hinged"),
        (lambda s: s.replace("axis = [1.0, 0.0, 0.0]", "axis = [0.0, 0.0, 0.0]"), "must be a direction"),
        (lambda s: s.replace('start_rate = "10 deg/s"', 'start_angle = "91 deg"'), "within hinge.limit, 90 deg"),
        (
            lambda s: s.replace("[capture.contact]", "[capture.wrap]\n\n[capture.contact]"),
            "cannot go together with [capture.wrap]: threads bend round bodies that do not move against one",
        ),
        (lambda s: s + TOW, "is held fast by the removal that follows, which needs for it"),
        (without_hinge, "piece 2 says `hinged = true`, which needs the table [capture.hinge]"),
        (
            lambda s: s.replace('shape = "union"', f'shape = "union"\n{INERTIA}'),
            "they follow from the pieces of both bodies",
        ),
    ],
    ids=["none", "all", "axis", "beyond", "wrap", "removal", "no hinge", "inertia"],
)  # fmt: skip
def test_what_does_not_go_with_it_is_refused(tmp_path: Path, change, said: str) -> None:  # type: ignore[no-untyped-def]
    assert said in refused(tmp_path, change(text()))


def test_another_shape_is_refused(tmp_path: Path) -> None:
    scene = text()
    scene = scene[: scene.index("[[capture.target.parts]]")] + scene[scene.index("[capture.hinge]") :]
    told = refused(tmp_path, scene.replace('shape = "union"', 'shape = "sphere"'))
    assert "capture.target.shape" in told
    assert "target.parts" not in told, "which a sphere has not"


def test_a_new_scene_shows_no_table_that_is_made_of_its_keys() -> None:
    """A scene can not give it: what is known of both bodies follows from the pieces."""
    (_, shown) = new_scene(shipped()["mission"].read_text(), "mission", "mine").split("# [capture.hinge]", 1)
    keys = [line.lstrip("# ").split(" =")[0] for line in shown.split("\n\n")[0].splitlines() if " = " in line]
    assert {"stiffness", "position", "axis", "limit"} <= set(keys)
    assert "body" not in keys


def test_a_capture_that_tells_of_a_hinge_hands_nothing_over() -> None:
    """Also an FMU in a file, of which no scene knows what is in it."""
    require_rigid(("target.attitude[1]",))
    with pytest.raises(HandoffError, match="an appendage that swings"):
        require_rigid(("target.attitude[1]", "hinge.angle"))


def swung() -> PhaseResult:
    """Rows of a capture whose wing swings."""
    angle, place = np.radians([0.0, 12.0, -9.0, 4.0]), np.zeros(4)
    rows = {"hinge.angle": ("rad", "Real", angle), "hinge.loss": ("J", "Real", np.array([0.0, 0.1, 0.25, 0.3]))}
    rows |= {f"{body}.position[{i}]": ("m", "Real", place + i) for body in ("chaser", "target") for i in (1, 2, 3)}
    rows |= {f"target.attitude[{i}]": ("1", "Real", place + (i == 1)) for i in (1, 2, 3, 4)}
    return PhaseResult("capture", 0.0, Recorder.of({"time": ("s", "Real", np.arange(4.0)), **rows}))


def test_a_run_tells_how_far_it_swung() -> None:
    found = {one.key: one for one in findings(RunResult(scene=Scene("one", "", "", ())), swung())}
    told = {name: (one.value, one.unit, one.shown_in) for name, one in found.items() if name.startswith("hinge.")}
    assert told == {
        "hinge.loss": (0.3, "J", ""),
        "hinge.angle_max": (np.radians(12.0), "rad", "deg"),
        "hinge.angle_min": (np.radians(-9.0), "rad", "deg"),
        "hinge.angle": (np.radians(4.0), "rad", "deg"),
    }
    (chart,) = (one for one in capture_clip.charts(swung(), ()) if one.key == "hinge")
    np.testing.assert_allclose(chart.series[0].y, [0.0, 12.0, -9.0, 4.0])
    assert chart.unit == "deg"


def test_a_page_has_the_angle_of_its_frames() -> None:
    """And which corners swing: those of boom and wing."""
    phase = load(NAME).phases[0]
    run = RunResult(scene=Scene("one", "", "", (phase,)), parameters={"capture": dict(phase.main.values)})
    clip = capture_clip.clip(run, phase, swung(), ())
    assert clip is not None
    assert clip.swing is not None
    assert clip.surface is not None
    np.testing.assert_allclose(np.degrees(clip.swing.angle), [0.0, 12.0, -9.0, 4.0])
    assert clip.swing.corners.sum() == len(clip.surface[0]) - 8
    assert not clip.swing.corners[:8].any()
    assert not any("hinge" in note for note in clip.notes)


def test_pictures_follow_the_angle() -> None:
    """At angle 0 the corners are those of the surface; at another the wing has turned about its edge, and the centre of
    mass of the whole has stayed where it was."""
    main = load(NAME).phases[0].main
    values = {**main.values, **main.made}
    surface, swing = build.target_surface(values, main.terms), build.target_swing(values, main.terms)
    assert surface is not None
    assert swing is not None
    np.testing.assert_allclose(swing(0.0), surface[0], atol=1e-15)
    moved, drawn = swing(0.5), np.array(surface[0])
    # of 722 kg the 22 kg of boom and wing, 0.2 and 0.9 m from the hinge: about the first axis they swing to -y
    away = (2.0 * 0.2 + 20.0 * 0.9) / 722.0 * np.array([0.0, -np.sin(0.5), np.cos(0.5) - 1.0])
    np.testing.assert_allclose(moved[:8], drawn[:8] - away, atol=1e-12)
    edge = np.array([0.0, 0.0, 1.0 - (2.0 * 1.2 + 20.0 * 1.9) / 722.0])
    before, after = drawn[-8:] - edge, moved[-8:] + away - edge
    c, s = np.cos(0.5), np.sin(0.5)
    np.testing.assert_allclose(after, before @ np.array([[1.0, 0.0, 0.0], [0.0, c, s], [0.0, -s, c]]), atol=1e-12)


@pytest.mark.parametrize(("angle", "depth"), [(0.5, 0.05), (0.0, 0.0), (-0.5, 0.0)])
def test_how_deep_a_node_lies_is_judged_at_the_angle(angle: float, depth: float) -> None:
    """A node in the middle of the wing as it is at 0.5 rad is half its thickness deep then, and else out of it."""
    main = load(NAME).phases[0].main
    values = {**main.values, **main.made}
    swing = build.target_swing(values, main.terms)
    assert swing is not None
    middle = swing(0.5)[-8:].mean(axis=0)
    columns = {"time": np.zeros(1), "hinge.angle": np.array([angle])}
    columns |= {f"target.position[{i}]": np.array([float(i)]) for i in (1, 2, 3)}
    columns |= {f"target.attitude[{i}]": np.array([float(i == 1)]) for i in (1, 2, 3, 4)}
    nodes = {0: np.array([middle + np.array([1.0, 2.0, 3.0])])}
    evidence = Evidence(columns, values, main.terms, 1.0, nodes=nodes)
    (found,) = capture_criteria._depth(evidence)
    assert found.value == pytest.approx(depth, abs=1e-12)
