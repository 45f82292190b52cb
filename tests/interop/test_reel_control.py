"""Two FMUs of ours, connected, in other tools: libcosim and ecos from the package, and in an FMU container.

All three hold the inputs over a step and step both FMUs from the same outputs, as our master does with Jacobi.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from lxml import etree

from dcone_cosim import loading
from dcone_cosim.master import run_scene
from dcone_cosim.progress import Progress
from dcone_cosim.recorder import Recorder
from dcone_cosim.scene_fmus import SceneFmus
from dcone_cosim.ssp.export import export_scene
from tests.cosim.ssp_packages import STRUCTURE, contents
from tests.interop import readme
from tests.interop.packages import Rows, in_tool, own
from tests.interop.reel_pair import (
    DIRECT,
    GRIDS,
    MAIN,
    SCENE,
    SPREAD,
    STEPS,
    at_its_times,
    differing,
    farthest,
    found,
    ours,
    package,
    packaged,
)

pytestmark = pytest.mark.interop

LATE = {"ecos": (), "libcosim": DIRECT, "container": DIRECT}
"""What arrives one step late in a tool: it reads the outputs of a step before it sets the inputs of the next."""

Run = tuple[str, str, Rows, Recorder, Rows]


@pytest.fixture(scope="module", params=[(tool, grid) for tool in LATE for grid in GRIDS], ids="-".join)
def run(request: pytest.FixtureRequest) -> Run:
    """Tool, grid, what tool and master made of it, and what our coupling makes of it at the tool's times."""
    tool, grid = request.param
    return tool, grid, found(tool, grid), ours(grid), at_its_times(tool, grid)


def test_a_removal_and_its_control_have_the_bits_of_our_jacobi(run: Run) -> None:
    tool, grid, theirs, by_master, at_their_times = run
    assert len(theirs) > 50
    assert differing(theirs, at_their_times, LATE[tool]) == []
    assert farthest(theirs, by_master, LATE[tool]) <= SPREAD
    assert bool(differing(theirs, by_master, LATE[tool])) == (grid == "decimal")


def test_what_depends_directly_on_an_input_is_late_where_it_is_read_first(run: Run) -> None:
    """Twin: a shift by one step is seen, so the outputs that are not shifted are told at the right time."""
    tool, _, theirs, by_master, _ = run
    wrong = () if LATE[tool] else DIRECT
    assert farthest(theirs, by_master, wrong) > 1e-6
    assert set(DIRECT) <= set(differing(theirs, by_master, wrong))


@pytest.mark.parametrize(
    "setting",
    [
        "controller.gain.derivative=2.36601 N.s/m",
        "controller.motor.time_constant=5.0001 s",
    ],
)
def test_another_control_is_seen(setting: str) -> None:
    """Twin: the tool's numbers come from both FMUs, with the package's values."""
    theirs = found("ecos", "binary")
    assert farthest(theirs, ours("binary")) == 0.0
    assert farthest(theirs, own(packaged("binary"), setting)) > SPREAD


@pytest.fixture(scope="module")
def without_motor(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Recorder]:
    """The pair with a control whose output depends on its inputs directly, and what our master makes of it."""
    folder = tmp_path_factory.mktemp("direct")
    text, motor, _ = loading.shipped()[SCENE].read_text().partition("[removal.components.controller.motor]")
    assert motor
    (folder / "direct.toml").write_text(text)
    path = package(folder, "binary", str(folder / "direct.toml"))
    return path, own(path)


@pytest.mark.parametrize("tool", LATE)
def test_a_control_without_a_motor_acts_a_step_late(tool: str, without_motor: tuple[Path, Recorder]) -> None:
    """The tools read its output before they set its inputs, our master after."""
    path, by_master = without_motor
    theirs = in_tool(tool, path, MAIN, GRIDS["binary"], STEPS)
    assert differing(theirs, by_master, LATE[tool])
    assert 1e-3 < farthest(theirs, by_master, LATE[tool]) < 1e-2


def test_the_readmes_line_of_the_pair_is_what_was_measured() -> None:
    text = readme.PAGE.read_text(encoding="utf-8")
    assert readme.page(text, [readme.PAIR[1]], keep_versions=True) == text
    wrong = text.replace("the master's Jacobi over 1000 steps", "the master's Jacobi over 999 steps", 1)
    assert wrong != text == readme.page(wrong, [readme.PAIR[1]], keep_versions=True)


def test_the_scenes_package_has_the_scenes_bits_and_its_coupling_step(tmp_path: Path) -> None:
    """As shipped, in macro steps of a minute: tools are told to exchange at the coupling step, we know both."""
    (path,) = export_scene(loading.load(SCENE), tmp_path, Progress()).paths
    root = etree.fromstring(contents(path)[STRUCTURE])
    (algorithm,) = root.iter("{*}FixedStepAlgorithm")
    scene = loading.load(SCENE)
    (phase,) = scene.phases
    assert (algorithm.get("baseStepSize"), phase.coupling.step, phase.macro_step) == ("2.0", 2.0, 60.0)
    with SceneFmus(scene, Progress()) as archives:
        by_scene = run_scene(scene, archives.instantiate, Progress()).phases[MAIN].recorder
    by_package = own(path)
    assert by_scene.names == by_package.names
    assert "controller.tension" in by_scene.names
    other = own(path, "controller.reel.length=12.001 m")
    same = [np.array_equal(by_scene[n], by_package[n], equal_nan=True) for n in by_scene.names]
    assert all(same)
    assert len(by_scene) == len(other) == 121
    assert not np.array_equal(by_scene["tether.length"], other["tether.length"])
