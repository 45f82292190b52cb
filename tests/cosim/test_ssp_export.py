"""Packages of scenes: valid by the schema, the same bytes each time, and run to the same bits as the scene."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path

import fmpy.ssp.ssd
import numpy as np
import pytest
from lxml import etree

from dcone_cosim import build, loading
from dcone_cosim.coupling.options import Coupling
from dcone_cosim.errors import InputError
from dcone_cosim.loading import load
from dcone_cosim.master import run_scene
from dcone_cosim.progress import Progress
from dcone_cosim.results import RunResult
from dcone_cosim.scene_fmus import SceneFmus
from dcone_cosim.ssp import system
from dcone_cosim.ssp.export import export_scene, identifier
from tests.cosim.ssp_packages import STRUCTURE, changed, contents, packed
from tests.runs import COARSE

SHORT = """
title = "A tow for ten minutes"
[orbit]
altitude = "800 km"
[removal]
macro_step = "10 s"
duration = "{duration}"
[removal.reel]
law = "locked"
[removal.tether]
rest_length = "12 m"
youngs_modulus = "60 GPa"
[removal.thrust]
direction = "along_track"
level = "-0.01 N"
"""
PAIR = """
[removal]
macro_step = "10 s"
duration = "600 s"
connections = ["removal.tether.tension -> other.thrust.offset"]
[removal.reel]
law = "locked"
[removal.components.other]
fmu = "other.fmu"
[removal.components.other.parameters]
"thrust.level" = "-0.02 N"
"tether.damping_ratio" = 0.1
[removal.coupling]
method = "jacobi"
step = "5 s"
"""
SCHEMAS = Path(fmpy.ssp.ssd.__file__).parent / "schema"


def run(path: Path | str, *settings: str) -> RunResult:
    scene = loading.load(str(path), settings)
    with SceneFmus(scene, Progress()) as archives:
        return run_scene(scene, archives.instantiate, Progress())


def same(one: RunResult, other: RunResult, phase: str = "removal") -> bool:
    """Whether every column of a phase has the same bits."""
    first, second = one.phases[phase].recorder, other.phases[phase].recorder
    if first.names != second.names or len(first) != len(second):
        return False
    return all(np.array_equal(first.column(n), second.column(n), equal_nan=True) for n in first.names)


@pytest.fixture
def tow(tmp_path: Path) -> Path:
    path = tmp_path / "tow.toml"
    path.write_text(SHORT.format(duration="600 s"))
    return path


@pytest.fixture
def pair(tmp_path: Path) -> Path:
    """A removal whose tension pushes the chaser of another removal: a second FMU, and a connection."""
    (tmp_path / "tow.toml").write_text(SHORT.format(duration="600 s"))
    main = loading.load(str(tmp_path / "tow.toml")).phases[0].main
    shutil.copy(build.ensure([(main.model, main.terms)], print)[0], tmp_path / "other.fmu")
    path = tmp_path / "pair.toml"
    path.write_text(PAIR)
    return path


@pytest.mark.parametrize("form", ["inline", "ssv"])
def test_a_package_runs_to_the_bits_of_its_scene(tow: Path, tmp_path: Path, form: str) -> None:
    done = export_scene(load(str(tow)), tmp_path / "out", Progress(), form=form)
    assert [path.name for path in done.paths] == ["tow-removal.ssp"]
    by_scene, by_package = run(tow), run(done.paths[0])
    assert same(by_scene, by_package)
    assert by_package.phases["removal"].outcome == "completed"
    assert by_package.scene.title == "A tow for ten minutes"


def test_another_value_gives_other_bits(tow: Path, tmp_path: Path) -> None:
    """The twin of the round trip: the package's values do reach the FMU."""
    (package,) = export_scene(load(str(tow)), tmp_path / "out", Progress()).paths
    assert not same(run(tow), run(package, "removal.thrust.level=-0.0101 N"))
    assert same(run(tow, "removal.thrust.level=-0.0101 N"), run(package, "removal.thrust.level=-0.0101 N"))


def test_several_components_keep_their_connections_and_coupling(pair: Path, tmp_path: Path) -> None:
    (package,) = export_scene(load(str(pair)), tmp_path, Progress()).paths
    by_scene, by_package = run(pair), run(package)
    phase = by_package.scene.phases[0]
    assert [component.name for component in phase.components] == ["removal", "other"]
    assert phase.macro_step == by_scene.scene.phases[0].macro_step == 10.0
    assert phase.connections == by_scene.scene.phases[0].connections
    assert phase.coupling == by_scene.scene.phases[0].coupling
    assert "other.tether.tension" in by_package.phases["removal"].recorder
    assert same(by_scene, by_package)


@pytest.fixture
def linear(pair: Path, tmp_path: Path) -> Callable[[str], RunResult]:
    """The pair with something else on its connection."""

    def make(attributes: str) -> RunResult:
        (package,) = export_scene(load(str(pair)), tmp_path, Progress()).paths
        closing = f"><ssc:LinearTransformation {attributes}/></ssd:Connection>"
        old = 'endConnector="thrust.offset"'
        return run(changed(package, tmp_path / "linear.ssp", (f"{old}/>", f"{old}{closing}")))

    return make


def test_a_linear_transformation_stands_between_output_and_input(linear: Callable[[str], RunResult]) -> None:
    """With the factor 0 the offset alone pushes, as much as the same push given from the start; a factor counts."""
    pushed = linear('factor="0" offset="0.005"')
    recorder = pushed.phases["removal"].recorder
    unlike = linear('factor="0" offset="0.006"').phases["removal"].recorder
    assert not np.array_equal(recorder["other.separation"], unlike["other.separation"])
    assert np.array_equal(recorder["separation"], unlike["separation"])
    (connection,) = linear('factor="2" offset="1"').scene.phases[0].connections
    assert (connection.factor, connection.offset) == (2.0, 1.0)


def test_other_tools_are_told_the_coupling_step(pair: Path, tmp_path: Path) -> None:
    """It is the only step they have; changed by hand, it is our macro step too."""
    (package,) = export_scene(load(str(pair)), tmp_path, Progress()).paths
    told = ('baseStepSize="5.0"', 'baseStepSize="20.0"')
    phase = system.load(changed(package, tmp_path / "longer.ssp", told)).phases[0]
    assert (phase.macro_step, phase.coupling.step) == (20.0, 5.0)


def test_without_our_annotation_the_contract_tells_the_phase(pair: Path, tmp_path: Path) -> None:
    """Its step is then the one that is written for all tools."""
    (package,) = export_scene(load(str(pair)), tmp_path, Progress()).paths
    files = contents(package)
    root = etree.fromstring(files[STRUCTURE])
    root.remove(root.findall("{*}Annotations")[-1])
    files[STRUCTURE] = etree.tostring(root)
    phase = system.load(packed(tmp_path / "plain.ssp", files)).phases[0]
    assert (phase.name, phase.main.name, phase.macro_step, phase.duration) == ("removal", "removal", 5.0, 600.0)
    assert phase.coupling == Coupling()


def test_the_bytes_depend_on_the_scene_alone(tow: Path, tmp_path: Path) -> None:
    (first,) = export_scene(load(str(tow)), tmp_path / "one", Progress()).paths
    (second,) = export_scene(load(str(tow)), tmp_path / "two", Progress()).paths
    assert first.read_bytes() == second.read_bytes()
    tow.write_text(SHORT.format(duration="610 s"))
    (other,) = export_scene(load(str(tow)), tmp_path / "three", Progress()).paths
    assert first.read_bytes() != other.read_bytes()


def _errors(content: bytes, schema: str) -> list[str]:
    rules = etree.XMLSchema(file=str(SCHEMAS / schema))
    rules.validate(etree.fromstring(content))
    return [entry.message for entry in rules.error_log]


@pytest.mark.parametrize("form", ["inline", "ssv"])
def test_what_is_written_is_valid_by_the_schemas_of_ssp(pair: Path, tmp_path: Path, form: str) -> None:
    (package,) = export_scene(load(str(pair)), tmp_path, Progress(), form=form).paths
    files = contents(package)
    assert _errors(files[STRUCTURE], "SystemStructureDescription.xsd") == []
    sets = [name for name in files if name.endswith(".ssv")]
    assert sets == ["resources/other.ssv"]
    for name in sets:
        assert _errors(files[name], "SystemStructureParameterValues.xsd") == []
    assert _errors(files[STRUCTURE].replace(b'version="1.0"', b'version="x"', 1), "SystemStructureDescription.xsd")
    assert fmpy.ssp.ssd.read_ssd(str(package)).system.elements[0].name == "removal"


def test_lists_carry_no_attributes_and_prefixes_are_those_that_tools_look_for(tow: Path, tmp_path: Path) -> None:
    """libcosim takes an attribute of a list, a namespace among them, for an item; ecos too knows prefixes only."""
    (package,) = export_scene(load(str(tow)), tmp_path, Progress()).paths
    text = contents(package)[STRUCTURE]
    root = etree.fromstring(text)
    for name in ("Elements", "Connectors", "ParameterBindings", "Parameters", "Annotations", "Connections"):
        for row in root.iter("{*}" + name):
            assert not row.attrib
            assert row.nsmap == root.nsmap, "a namespace declared below the root"
    assert {row.prefix for row in root.iter()} == {"ssd", "ssc", "ssv", "osp", "oms", "dcone"}
    assert b"ssd:Enumeration" not in text


def test_inputs_that_nothing_is_connected_to_can_be_left_out(pair: Path, tmp_path: Path) -> None:
    closed = export_scene(load(str(pair)), tmp_path / "closed", Progress(), open_inputs=False).paths[0]
    opened = export_scene(load(str(pair)), tmp_path / "open", Progress()).paths[0]

    def inputs(package: Path) -> set[str]:
        root = etree.fromstring(contents(package)[STRUCTURE])
        return {row.get("name") for row in root.iter("{*}Connector") if row.get("kind") == "input"}

    assert inputs(closed) == {"thrust.offset"}
    assert inputs(closed) < inputs(opened)


def test_a_removal_without_its_run_is_noted(tmp_path: Path) -> None:
    done = export_scene(load("mission"), tmp_path, Progress())
    assert done.paths[0].name == "mission-capture.ssp"
    (note,) = done.notes
    assert "--from-run" in note


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda folder: None, "provenance.json"),
        (lambda folder: (folder / "provenance.json").write_text("{"), "not valid JSON"),
        (
            lambda folder: (
                (folder / "provenance.json").write_text('{"scene": "other"}'),
                (folder / "scene.toml").write_text("title = 'other'"),
            ),
            "that run was of another scene, 'other'; expected one of 'mission'; or export its own, .*scene.toml",
        ),
        (
            lambda folder: (
                (folder / "provenance.json").write_text('{"scene": "mission", "settings": ["removal.duration=1 h"]}'),
                (folder / "scene.toml").write_text("title = 'mission'"),
            ),
            "that run of 'mission' had other values than asked for here; its own are --set 'removal.duration=1 h'; or",
        ),
        (
            lambda folder: (
                (folder / "provenance.json").write_text('{"scene": "mission", "settings": []}'),
                (folder / "scene.toml").write_text("title = 'mission'"),
            ),
            "that run of 'mission' had other values than the scene has here; run it again; or",
        ),
    ],
)
def test_a_folder_that_is_no_run_of_the_scene_is_refused(tmp_path: Path, make, said: str) -> None:
    folder = tmp_path / "run"
    folder.mkdir()
    make(folder)
    with pytest.raises(InputError, match=said):
        export_scene(load("mission"), tmp_path / "out", Progress(), from_run=folder)
    assert not (tmp_path / "out").exists()


def test_nothing_is_left_where_nothing_can_be_written(tow: Path, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="not a folder"):
        export_scene(load(str(tow)), tmp_path / "file", Progress())
    with pytest.raises(InputError, match="inline"):
        export_scene(load(str(tow)), tmp_path / "out", Progress(), form="inlin")
    assert not (tmp_path / "out").exists()


@pytest.mark.slow
def test_a_mission_in_two_packages_has_the_bits_of_the_mission(tmp_path: Path) -> None:
    from dcone_cosim.commands import run_and_write

    whole = run_and_write("mission", tmp_path / "run", Progress(), with_figures=False, settings=COARSE).result
    capture, removal = export_scene(
        load("mission", COARSE), tmp_path / "out", Progress(), from_run=tmp_path / "run"
    ).paths
    assert same(whole, run(capture), "capture")
    handed_over = run(removal)
    assert handed_over.phases["removal"].origin == whole.handovers["removal"].time
    assert same(whole, handed_over)
    shutil.rmtree(tmp_path / "run")


def test_names_that_other_tools_take() -> None:
    assert identifier("table1-capture") == "table1_capture"
    assert identifier("1 a") == "_1_a"
