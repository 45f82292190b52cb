"""The hash of a case changes with each thing that settles its numbers, and with nothing else."""

from __future__ import annotations

import pickle
from dataclasses import replace
from pathlib import Path

import pytest

from dcone_cosim.cases import case
from dcone_cosim.cases.case import Case, content, digest, identities, key_of
from dcone_cosim.loading import load, shipped
from dcone_cosim.resume.differences import differences
from dcone_cosim.scene.data import Scene, TableFile
from dcone_cosim.scenes.reading import parse, read_text

FMUS = {"removal": "{1}"}


def key(name: str = "table2-deorbit", *settings: str, fmus: dict[str, str] = FMUS, seed: int | None = None) -> str:
    return key_of(load(name, settings), fmus, seed)


@pytest.mark.parametrize(
    ("scene", "setting"),
    [
        ("table2-deorbit", "removal.tether.rest_length=12.000001 m"),
        ("table2-deorbit", "removal.macro_step=30 s"),
        ("table2-deorbit", "removal.duration=2 d"),
        ("table2-deorbit", "removal.thrust.level=-0.02 N"),
        ("table2-deorbit", "removal.thrust.direction=velocity"),
        ("table2-deorbit", "removal.start.leading=chaser"),
        ("table2-deorbit", "orbit.altitude=801 km"),
        ("table2-deorbit", "removal.solver.tolerance_separation=1e-6 m"),
        ("mission", "handoff.point_tolerance=0.3"),
        ("mission", "handoff.compare_without_recoil=false"),
        ("table1-capture", "capture.hand_over=none"),
        ("mission", 'phases=["capture"]'),
        ("mission", "capture.solver.seed=1"),
        ("reel-control", "removal.coupling.step=1 s"),
        ("reel-control", "removal.coupling.method=jacobi"),
        ("reel-control", "removal.components.controller.motor.time_constant=6 s"),
        ("reel-control", 'removal.connections=["removal.tether.length -> controller.length",'
         '"controller.tension -> removal.reel.tension"]'),
    ],
)  # fmt: skip
def test_what_matters(scene: str, setting: str) -> None:
    assert key(scene) != key(scene, setting)


@pytest.mark.parametrize(
    ("scene", "setting"),
    [
        ("table2-deorbit", "title=another"),
        ("table2-deorbit", "removal.tether.rest_length=1200 cm"),
        ("table2-deorbit", "removal.duration=24 h"),
        ("table2-deorbit", "removal.isolate=true"),
        ("table2-deorbit", "removal.start.leading=target"),
        ("mission", 'phases=["capture", "removal"]'),
        ("mission", "capture.solver.seed=0"),
        ("reel-control", "removal.coupling.control=fixed"),
    ],
)
def test_what_does_not(scene: str, setting: str) -> None:
    """Words, other units for the same value, defaults that are written out, and where an FMU runs."""
    assert key(scene) == key(scene, setting)


def test_the_file_and_its_comments_do_not_matter(tmp_path: Path) -> None:
    (tmp_path / "elsewhere.toml").write_text("# mine\n" + read_text(shipped()["table2-deorbit"]))
    assert key() == key(str(tmp_path / "elsewhere.toml"))


def test_fmus_code_and_seed_matter(monkeypatch: pytest.MonkeyPatch) -> None:
    keys = {key(), key(fmus={"removal": "{2}"}), key(seed=0), key(seed=1)}
    for other in ({"dcone-cosim": "9.9", "sources": case.code()["sources"]}, {**case.code(), "sources": "0"}):
        monkeypatch.setattr(case, "code", lambda other=other: other)
        keys.add(key())
    assert len(keys) == 6
    assert {len(one) for one in keys} == {64}


def with_table(scene: Scene, file: str, sha256: str) -> Scene:
    (phase,) = scene.phases
    table = TableFile(("removal", "thrust", "table"), Path(file), sha256, numbers=object())
    return replace(scene, phases=(replace(phase, main=replace(phase.main, tables={"thrust.table": table})),))


def test_a_table_counts_by_what_is_in_it() -> None:
    scene = load("table2-deorbit")
    here, there, other = (with_table(scene, *about) for about in (("a.csv", "1"), ("b/a.csv", "1"), ("a.csv", "2")))
    assert digest(content(here)) == digest(content(there))
    assert len({digest(content(one)) for one in (scene, here, other)}) == 3


@pytest.mark.parametrize("change", ['radius = "1.1 m"', 'mass = "801 kg"', 'position = ["0 m", "0 m", "2.21 m"]'])
def test_what_is_told_entry_by_entry_counts(change: str) -> None:
    """Parts of a target reach the FMU as a table of numbers. They were left out, and a folder of cases gave the rows of
    the target before for another one."""
    text = read_text(shipped()["upper-stage"])
    before = {"radius": 'radius = "1.2 m"', "mass": 'mass = "800 kg"', "position": 'position = ["0 m", "0 m", "2.2 m"]'}
    other = text.replace(before[change.split()[0]], change, 1)
    assert other != text
    one, two, same = (parse(each, "a", "a") for each in (text, other, f"# mine\n{text}"))
    assert digest(content(one)) == digest(content(same))
    assert digest(content(one)) != digest(content(two))
    assert "sources.target.parts" in [row.name for row in differences(one, two)]


def test_our_fmus_are_known_by_their_guid_and_others_by_their_bytes() -> None:
    """The archive of one of ours depends on how zlib packs it; its GUID on what it does."""
    ours, other = {"guid": "{g}", "sha256": "s", "ours": True}, {"guid": "{g}", "sha256": "s", "ours": False}
    facts = {"removal": {"fmu": ours, "components": {"controller": {"fmu": other}}}}
    assert identities(facts) == {"removal": "{g}", "removal, controller": "s"}


def test_a_case_is_plain_data() -> None:
    """It can be sent to another process, and means the same there."""
    one = Case("key", load("mission"), ("a=1",), {}, 3)
    assert pickle.loads(pickle.dumps(one)) == one
    assert len(pickle.dumps(one)) < 20_000
