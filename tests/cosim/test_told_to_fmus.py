"""What an FMU is told beside its numbers: texts, and the tolerance of its own solver; from a scene and from a package.

The FMU of these tests shows both in the place of its target's mass: the length of its String `label`, or the tolerance.
"""

from __future__ import annotations

import zipfile
from pathlib import Path

import pytest

from dcone_cosim.errors import InputError
from dcone_cosim.loading import load
from dcone_cosim.progress import Progress
from dcone_cosim.scene.data import Scene
from dcone_cosim.scene_fmus import SceneFmus
from tests.cosim.fmus.build import build

SCENE = '[removal]\nfmu = "my_removal.fmu"\nmacro_step = "10 s"\nduration = "100 s"\n'
LABEL = (
    '<ScalarVariable name="label" valueReference="1" causality="parameter" variability="fixed" initial="exact">'
    '<String start="none"/></ScalarVariable></ModelVariables>'
)
URI = "http://ssp-standard.org/SSP1/SystemStructure"
PACKAGE = f"""<?xml version="1.0"?>
<ssd:SystemStructureDescription version="1.0" name="told" xmlns:ssd="{URI}Description" xmlns:ssc="{URI}Common"
  xmlns:ssv="{URI}ParameterValues">
<ssd:System name="told"><ssd:Elements>
<ssd:Component name="tow" source="resources/my_removal.fmu" type="application/x-fmu-sharedlibrary">
<ssd:Connectors><ssd:Connector name="label" kind="parameter"><ssc:String/></ssd:Connector></ssd:Connectors>
<ssd:ParameterBindings><ssd:ParameterBinding><ssd:ParameterValues>
<ssv:ParameterSet version="1.0" name="p"><ssv:Parameters>
<ssv:Parameter name="label"><ssv:String value="seven c"/></ssv:Parameter>
</ssv:Parameters></ssv:ParameterSet>
</ssd:ParameterValues></ssd:ParameterBinding></ssd:ParameterBindings>
</ssd:Component></ssd:Elements></ssd:System>
EXPERIMENT</ssd:SystemStructureDescription>
"""


def labelled(xml: str) -> str:
    return xml.replace("</ModelVariables>", LABEL)


def with_experiment(**attributes: object) -> str:
    told = " ".join(f'{key}="{value}"' for key, value in attributes.items())
    return f"<DefaultExperiment {told}/>"


def of(fmu: Path, text: str = SCENE, *settings: str) -> Scene:
    (fmu.parent / "mine.toml").write_text(text)
    return load(str(fmu.parent / "mine.toml"), settings)


def package(
    fmu: Path, experiment: str = '<ssd:DefaultExperiment startTime="0" stopTime="9"/>', *settings: str
) -> Scene:
    with zipfile.ZipFile(fmu.parent / "it.ssp", "w") as archive:
        archive.write(fmu, "resources/my_removal.fmu")
        archive.writestr("SystemStructure.ssd", PACKAGE.replace("EXPERIMENT", experiment))
    return load(str(fmu.parent / "it.ssp"), settings)


def shown(scene: Scene) -> float:
    """What the FMU shows once it has begun."""
    with SceneFmus(scene, Progress()) as archives:
        component = archives.instantiate(scene.phases[0].name, "it")
        component.enter_initialisation(0.0)
        component.exit_initialisation()
        found = component.get(["target.mass"])["target.mass"]
        component.close()
    return found


@pytest.fixture(scope="module")
def fmu(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return build(tmp_path_factory.mktemp("texts"), "removal", "TEXTS", change=labelled)


class TestTexts:
    @pytest.mark.parametrize("isolate", ["", "isolate = true\n"], ids=["here", "isolated"])
    def test_in_a_scene(self, fmu: Path, isolate: str) -> None:
        scene = of(fmu, f'{SCENE}{isolate}label = "a longer text, µ"\n')
        assert scene.phases[0].main.texts == {"label": "a longer text, µ"}
        assert shown(scene) == len("a longer text, µ".encode())
        assert shown(of(fmu)) == 1000.0, "twin: without one it is as the file has it"

    def test_on_the_command_line_and_under_parameters(self, fmu: Path) -> None:
        assert shown(of(fmu, SCENE, "removal.label=four")) == 4.0
        assert shown(of(fmu, f'{SCENE}[removal.parameters]\nlabel = "two x"\n')) == 5.0
        with pytest.raises(InputError, match=r"removal\.label = 5.*expected a text, in quotes"):
            of(fmu, f"{SCENE}label = 5\n")

    def test_in_a_package(self, fmu: Path) -> None:
        step = "removal.macro_step=1 s"
        assert shown(package(fmu, '<ssd:DefaultExperiment stopTime="9"/>', step)) == len("seven c")
        assert shown(package(fmu, '<ssd:DefaultExperiment stopTime="9"/>', step, "tow.label=xy")) == 2.0

    def test_it_is_kept_in_the_provenance(self, fmu: Path) -> None:
        with SceneFmus(of(fmu, SCENE, "removal.label=four"), Progress()) as archives:
            assert archives.facts()["removal"]["fmu"]["texts"] == {"label": "four"}


class TestTolerance:
    def made(self, folder: Path, **experiment: object) -> Path:
        def change(xml: str) -> str:
            return labelled(xml).replace("<ModelVariables>", f"{with_experiment(**experiment)}<ModelVariables>")

        return build(folder, "removal", "TOLERANCE", "TEXTS", change=change)

    @pytest.mark.parametrize("isolate", ["", "isolate = true\n"], ids=["here", "isolated"])
    def test_of_the_file_or_of_the_scene(self, tmp_path: Path, isolate: str) -> None:
        fmu = self.made(tmp_path / "a", tolerance="1e-7")
        assert shown(of(fmu, SCENE + isolate)) == 1e-7
        assert shown(of(fmu, f"{SCENE}{isolate}solver_tolerance = 1e-9\n")) == 1e-9
        assert shown(of(self.made(tmp_path / "b", stopTime="1"), SCENE + isolate)) == -1.0, "none is told where none is"

    def test_of_a_package(self, tmp_path: Path) -> None:
        fmu = self.made(tmp_path, tolerance="1e-7")
        rest = '<ssd:DefaultExperiment stopTime="9"/>', "removal.macro_step=1 s"
        assert shown(package(fmu, *rest)) == 1e-7
        assert shown(package(fmu, *rest, "removal.solver_tolerance=1e-3")) == 1e-3

    def test_ours_have_their_own(self) -> None:
        with pytest.raises(InputError, match="a model of ours has tolerances of its own"):
            load("mission", ["removal.solver_tolerance=1e-3"])

    @pytest.mark.parametrize(
        ("experiment", "start", "duration"),
        [
            ("", 2.5, 17.5),
            ('<ssd:DefaultExperiment startTime="4"/>', 4.0, 16.0),
            ('<ssd:DefaultExperiment stopTime="5"/>', 2.5, 2.5),
            ('<ssd:DefaultExperiment startTime="0" stopTime="5"/>', 0.0, 5.0),
        ],
    )
    def test_start_stop_and_step_are_the_files(
        self, tmp_path: Path, experiment: str, start: float, duration: float
    ) -> None:
        """What the structure does not tell, the FMU's own default experiment does."""
        fmu = self.made(tmp_path, startTime="2.5", stopTime="20", stepSize="0.5")
        (phase,) = package(fmu, experiment).phases
        assert (phase.start, phase.duration, phase.macro_step) == (start, duration, 0.5)
