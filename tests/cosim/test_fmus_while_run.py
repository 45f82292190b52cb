"""The FMUs of a scene while it runs: one component or several, what they refuse, and that nothing is left open."""

from __future__ import annotations

from pathlib import Path

import pytest

from dcone_cosim.coupling.coupled import Coupled
from dcone_cosim.errors import FmuError, InputError
from dcone_cosim.loading import load
from dcone_cosim.progress import Progress
from dcone_cosim.scene.data import Scene
from dcone_cosim.scene_fmus import SceneFmus
from tests.cosim.fmus.build import build

ALONE = '[removal]\nfmu = "my_removal.fmu"\nmacro_step = "10 s"\nduration = "100 s"\n'
OTHER = '[removal.components.other]\nfmu = "{}"\n[removal.components.other.tether]\nlength = "15 m"\n'


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("fmus")
    for phase, name, switches in (
        ("removal", "my_removal", ()),
        ("capture", "my_capture", ()),
        ("capture", "refusing", ("REFUSES",)),
    ):
        build(folder / name, phase, *switches).rename(folder / f"{name}.fmu")
    return folder


def read(folder: Path, text: str) -> Scene:
    (folder / "mine.toml").write_text(text)
    return load(str(folder / "mine.toml"))


def test_one_is_itself_and_two_are_coupled(folder: Path) -> None:
    with SceneFmus(read(folder, ALONE), Progress()) as archives:
        alone = archives.instantiate("removal", "first")
        assert (type(alone).__name__, alone.name) == ("IsolatedComponent", "first")
        alone.close()
        assert set(archives.facts()["removal"]) == {"fmu"}
    with SceneFmus(read(folder, ALONE + OTHER.format("my_capture.fmu")), Progress()) as archives:
        both = archives.instantiate("removal", "first")
        assert isinstance(both, Coupled)
        assert both.get(["other.tether.length"]) == {"other.tether.length": 15.0}
        both.close()
        facts = archives.facts()["removal"]
        assert facts["components"]["other"]["parameters"]["tether.length"] == 15.0
        assert facts["coupling"]["method"] == "gauss_seidel"
        assert facts["coupling"]["step"] == {"value": 10.0, "unit": "s"}


@pytest.mark.parametrize(("isolate", "kind"), [("true", "IsolatedComponent"), ("false", "Component")])
def test_isolated_where_the_scene_says_so(folder: Path, isolate: str, kind: str) -> None:
    text = ALONE.replace("macro_step", f"isolate = {isolate}\nmacro_step")
    with SceneFmus(read(folder, text), Progress()) as archives:
        component = archives.instantiate("removal", "first")
        assert type(component).__name__ == kind
        component.close()


def test_its_folders_are_gone_afterwards(folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    scene = read(folder, ALONE + OTHER.format("my_capture.fmu"))
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    with SceneFmus(scene, Progress()):
        assert len([path for path in tmp_path.iterdir() if path.is_dir()]) == 2
    assert not list(tmp_path.iterdir())
    (folder / "gone.fmu").write_bytes((folder / "my_capture.fmu").read_bytes())
    scene = read(folder, ALONE + OTHER.format("gone.fmu"))
    (folder / "gone.fmu").unlink()
    with pytest.raises(FmuError, match=r"gone\.fmu: no such file"):
        SceneFmus(scene, Progress())
    assert not list(tmp_path.iterdir())


class Refusing:
    """Stands in for a component that does not take a value."""

    def __init__(self, error: Exception) -> None:
        self.error, self.closed = error, False

    def set(self, _: object) -> None:
        raise self.error

    def close(self) -> None:
        self.closed = True


@pytest.mark.parametrize(("earlier", "kind"), [(False, InputError), (True, FmuError)])
def test_a_value_refused(folder: Path, monkeypatch: pytest.MonkeyPatch, earlier: bool, kind: type[Exception]) -> None:
    """Bad input at the start of a run; after a phase whose results are worth keeping, a failure of the FMU."""
    from dcone_cosim.fmu.steppable import CallError

    text = ALONE + OTHER.format("my_capture.fmu")
    if earlier:
        text = '[capture]\nfmu = "my_capture.fmu"\nmacro_step = "0.5 s"\nduration = "20 s"\n' + text.replace(
            "[removal.components", '[removal.tether]\nrest_length = "14 m"\n[removal.components', 1
        )
    scene = read(folder, text)
    made: list[Refusing] = []

    def one(*_: object) -> Refusing:
        made.append(Refusing(CallError("other", "", "tether.length is odd", "x.fmu: fmi2SetReal gave Error", "Error")))
        return made[-1]

    with SceneFmus(scene, Progress()) as archives:
        monkeypatch.setattr(archives, "_one", one)
        with pytest.raises(
            kind, match=r"mine\.toml: other of the removal cannot begin\n  line \d+: tether\.length is odd"
        ):
            archives.instantiate("removal", "removal")
    assert [component.closed for component in made] == [True, True]
