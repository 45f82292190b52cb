"""A scene to start from, and the schema that editors check it with: both follow from the models' tables."""

from __future__ import annotations

import json
import re
import tomllib
from functools import cache
from pathlib import Path
from typing import Any

import jsonschema
import pytest

from dcone_cosim import build
from dcone_cosim.commands import write_scene, write_schema
from dcone_cosim.errors import InputError
from dcone_cosim.loading import find, load, shipped
from dcone_cosim.phases import kinds
from dcone_cosim.scenes.keys import expected_of
from dcone_cosim.scenes.new import new_scene
from dcone_cosim.scenes.reading import parse
from dcone_cosim.scenes.schema import schema

ONE_BY_ONE = re.compile(r"^# (\[[\w.]+\]|\w+ = .*)$", re.MULTILINE)


def begun(origin: str) -> str:
    return new_scene(find(origin).read_text(), origin, "mine.toml")


@cache
def validator() -> jsonschema.Draft7Validator:
    return jsonschema.Draft7Validator(schema())


def valid(document: dict[str, Any]) -> None:
    validator().validate(document)


class TestNew:
    @pytest.mark.parametrize("origin", sorted(shipped()))
    def test_it_says_the_same(self, origin: str) -> None:
        assert parse(begun(origin), "mine", "mine.toml").phases == load(origin).phases

    @pytest.mark.parametrize("origin", sorted(shipped()))
    def test_every_comment_is_a_key_with_its_default(self, origin: str) -> None:
        """With each mark taken away on its own the scene still holds, and a parameter keeps its value to the bit."""
        text = begun(origin)
        plain = parse(text, "mine", "mine.toml")
        tried = 0
        for match in ONE_BY_ONE.finditer(text):
            if match[1].startswith("[") or _in_marked_table(text, match.start()):
                continue
            scene = parse(text[: match.start()] + match[1] + text[match.end() :], "mine", "mine.toml")
            tried += 1
            for before, after in zip(plain.phases, scene.phases, strict=True):
                assert {**after.main.defaults, **after.main.parameters} == {
                    **before.main.defaults,
                    **before.main.parameters,
                }
        assert tried > (2 if origin == "deployment" else 5)  # it says nearly all that it has

    def test_what_parameters_say_is_not_lost(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        """They were dropped, and the scene begun from that one shot at another speed without a word."""
        text = find("table1-capture").read_text()
        without = text.replace('\nspeed = "3 m/s"\n', "\n", 1)
        assert without != text
        told = '[capture.parameters]\n"bullets.speed" = "2.5 m/s"\nshot.roll = "5 deg"\n'
        monkeypatch.chdir(tmp_path)
        (tmp_path / "theirs.toml").write_text(without + told)
        path, _ = write_scene("mine", "theirs.toml")
        mine, theirs = load(str(path)), load("theirs.toml")
        assert mine.phases[0].main.parameters == theirs.phases[0].main.parameters
        assert mine.phases[0].main.parameters["bullets.speed"] == 2.5
        assert mine.phases == theirs.phases
        assert path.read_text().count("\nspeed = ") == text.count("\nspeed = ")

    def test_what_a_component_is_told_is_not_lost(self) -> None:
        text = (
            find("reel-control")
            .read_text()
            .replace('model = "reel_control"\n', 'model = "reel_control"\nisolate = true\n')
        )
        text += '\n[removal.components.controller.parameters]\nfeed_forward = "0.125 N"\n'
        mine, theirs = (parse(one, "a", "a").phases[0] for one in (new_scene(text, "theirs", "mine.toml"), text))
        assert mine == theirs
        assert mine.others[0].parameters["feed_forward"] == 0.125

    def test_what_stands_at_the_top_is_not_lost(self) -> None:
        text = find("table2-deorbit").read_text() + (
            '[solver]\naccuracy = "1 %"\nquantities = ["first_tug"]\n[handoff]\ncompare_without_recoil = false\n'
            '[sizing]\nfactor_of_safety = 3.0\nflux_sizes = ["0.1 mm", "1 mm"]\n'
            'flux_values = ["0.3 /(m2 yr)", "0.003 /(m2 yr)"]\n'
            '[sizing.ranges]\n"removal.thrust.level" = ["0.01 N", "0.03 N"]\n'
        )
        mine, theirs = (parse(one, "a", "a", choose=False) for one in (new_scene(text, "theirs", "mine.toml"), text))
        assert mine.sizing == theirs.sizing
        assert mine.sizing["factor_of_safety"] == 3.0
        assert list(mine.sizing["ranges"]) == ["removal.thrust.level"]
        assert (mine.accuracy, mine.handoff) == (theirs.accuracy, theirs.handoff)

    def test_a_key_that_would_be_lost_is_told(self, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr("dcone_cosim.scenes.new.SIZING_KEYS", {})
        with pytest.raises(InputError, match=r"theirs: .* would lose sizing\.factor_of_safety"):
            new_scene(find("mission").read_text() + "[sizing]\nfactor_of_safety = 3.0\n", "theirs", "mine.toml")

    def test_what_a_target_asks_beyond_the_bounds_is_told(self) -> None:
        """0 and 90 deg lie within the bounds of the FMU, and no net ever reaches a target with them."""
        text = begun("table1-capture")
        assert "with a target neither 0 nor 90 deg" in text
        assert "with a target above 0" in text
        for value in ("angle=0 deg", "angle=90 deg", "speed=0 m/s"):
            with pytest.raises(InputError, match=f"bullets.{value[:5]}"):
                load("table1-capture", (f"capture.bullets.{value}",))

    def test_a_marked_table_can_be_brought_in(self) -> None:
        text = begun("mission")
        marked = text[text.index("# [capture.settling]") :].split("\n\n")[0]
        brought_in = text.replace(marked, ONE_BY_ONE.sub(r"\1", marked))
        assert parse(brought_in, "mine", "mine.toml").phases[0].main.terms["settling"] == "speed"

    @pytest.mark.parametrize("phase", ["capture", "removal"])
    def test_the_words_are_the_tables(self, phase: str) -> None:
        """Every parameter is there with the table's own sentence and bounds; a line that lacks one would be found."""
        text = re.sub(r"\n#   ", " ", begun("mission"))
        scene = next(p for p in load("mission").phases if p.name == phase)
        rows = [
            v
            for v in build.settable(build.CATALOGUE[scene.main.model].interface(scene.main.terms))
            if v.section != "orbit"
        ]
        owned = (
            ("start.", "target.mass", "target.attachment_distance", "chaser.mass") if phase == "removal" else ("\0",)
        )
        told = [v for v in rows if not build.scene_name(v).startswith(owned)]
        assert len(told) > 8
        for v in told:
            assert v.description in text
            assert expected_of(v).bounds() in text
            assert re.search(rf"^(# )?{v.key} = ", text, re.MULTILINE)

    def test_it_never_replaces_a_file(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.chdir(tmp_path)
        path, steps = write_scene("mine", "table2-deorbit")
        assert (str(path), steps[0]) == (
            "mine.toml",
            "next: edit mine.toml, then `dcone validate mine.toml` and `dcone run mine.toml`",
        )
        (tmp_path / "mine.toml").write_text("years of work")
        with pytest.raises(InputError, match=r"mine\.toml is there already and was not touched"):
            write_scene("mine.toml", "mission")
        assert (tmp_path / "mine.toml").read_text() == "years of work"

    @pytest.mark.parametrize(
        ("name", "origin", "told"),
        [
            ("mine.txt", "mission", "expected one that ends in .toml"),
            (" ", "mission", "the name of the new scene is empty"),
            ("mine", "misson", "did you mean 'mission'?"),
            ("nowhere/mine", "mission", "nowhere/mine.toml cannot be written: No such file"),
        ],
    )
    def test_names_that_cannot_be(self, tmp_path: Path, monkeypatch, name: str, origin: str, told: str) -> None:
        monkeypatch.chdir(tmp_path)
        with pytest.raises(InputError, match=re.escape(told)):
            write_scene(name, origin)
        assert not list(tmp_path.iterdir())

    def test_it_names_a_schema_that_lies_beside_it(self, tmp_path: Path) -> None:
        write_schema(tmp_path / "dcone-schema.json")
        path, steps = write_scene(str(tmp_path / "mine"), "mission")
        assert path.read_text().startswith("#:schema ./dcone-schema.json\n")
        assert len(steps) == 1


def _in_marked_table(text: str, at: int) -> bool:
    tables = re.findall(r"^(# )?\[[\w.]+\]", text[:at], re.MULTILINE)
    return bool(tables) and tables[-1] == "# "


class TestSchema:
    def test_it_is_one(self) -> None:
        jsonschema.Draft7Validator.check_schema(schema())

    @pytest.mark.parametrize("origin", sorted(shipped()))
    def test_scenes_hold(self, origin: str) -> None:
        valid(tomllib.loads(find(origin).read_text()))
        valid(tomllib.loads(begun(origin)))

    @pytest.mark.parametrize(
        ("old", "new"),
        [
            ("\nside =", "\nsied ="),
            ("[capture.bullets]", "[capture.bulets]"),
            ("[orbit]", "[orbti]"),
            ('side = "12 m"', "side = 12"),
            ('side = "12 m"', 'side = "twelve"'),
            ("damping_ratio = 0.106", 'damping_ratio = "0.106"'),
            ("damping_ratio = 0.106", "damping_ratio = -0.1"),
            ('law = "hill"', 'law = "hil"'),
            ('law = "hill"', ""),
            ('["0 m", "-12 m", "0 m"]', '["0 m", "-12 m"]'),
            ("compare_without_recoil = true", "compare_without_recoil = 1"),
            ('phases = ["capture", "removal"]', 'phases = ["captur"]'),
            ('macro_step = "0.02 s"', ""),
            ("capacity = 625", "capacity = 0"),
        ],
    )
    def test_what_validate_refuses_it_refuses(self, old: str, new: str) -> None:
        text = find("mission").read_text()
        assert text.count(old) == 1
        document = tomllib.loads(text.replace(old, new))
        with pytest.raises(jsonschema.ValidationError):
            valid(document)
        with pytest.raises(InputError):
            parse(text.replace(old, new), "a", "a")

    def test_an_fmu_takes_any_key(self) -> None:
        """Of its variables a schema knows nothing; a misspelt key of the phase's own is still found in its type."""
        phase: dict[str, Any] = {"fmu": "my.fmu", "macro_step": "1 s", "duration": "9 s", "engine": {"speed": "3 m/s"}}
        valid({"capture": phase})
        phase["components"] = {"reel": {"model": "reel_control", "isolate": True}}
        phase["connections"] = ["capture.tether.length -> reel.length"]
        phase["coupling"] = {"method": "jacobi", "step": "0.1 s", "order": ["reel", "capture"]}
        valid({"capture": phase})
        for wrong in (
            {"isolate": "yes"},
            {"connections": ["capture -> reel"]},
            {"coupling": {"methods": "jacobi"}},
            {"components": {"reel": {}}},
        ):
            with pytest.raises(jsonschema.ValidationError):
                valid({"capture": phase | wrong})

    def test_every_parameter_is_described_with_its_default(self) -> None:
        net = schema()["properties"]["capture"]["properties"]["net"]["properties"]
        assert net["side"]["description"] == "side of the mouth; greater than 0 m"
        for phase, kind in kinds().items():
            model = build.CATALOGUE[kind.model]
            tables = schema()["properties"][phase]["properties"]
            always = {row.name: row for row in (*reversed(list(build.all_rows(model))), *model.base)}
            for row in build.all_rows(model):
                if row.causality in build.SETTABLE and row.section != "orbit":
                    entry = tables[row.section]["properties"][row.key]
                    assert row.description in entry["description"]
                    row = always[row.name]  # with a term that tells it anew the default may be another
                    expected = expected_of(row)
                    read = expected.read(entry["default"])
                    assert (read if isinstance(read, list) else [read]) == [float(s) for s in row.starts()]

    def test_only_a_schema_is_replaced(self, tmp_path: Path) -> None:
        path = tmp_path / "dcone-schema.json"
        for _ in range(2):
            assert json.loads(write_schema(path)) == json.loads(path.read_text()) == schema()
        path.write_text("years of work")
        with pytest.raises(InputError, match="is there already and is not a schema"):
            write_schema(path)
        assert [p.name for p in tmp_path.iterdir()] == ["dcone-schema.json"]
