"""`--set KEY=VALUE`: it takes the place of what the file says, is told in mistakes, and is kept with the results."""

from __future__ import annotations

import tomllib

import pytest

from dcone_cosim.errors import InputError
from dcone_cosim.loading import find, load
from dcone_cosim.scene.data import Scene
from dcone_cosim.scenes.reading import parse
from dcone_cosim.scenes.text import override


def changed(*settings: str, scene: str = "mission") -> Scene:
    return load(scene, settings)


def complaint(*settings: str, scene: str = "mission") -> str:
    with pytest.raises(InputError) as error:
        load(scene, settings)
    return str(error.value)


@pytest.mark.parametrize(
    ("setting", "value"),
    [
        ('a.b="4 m/s"', "4 m/s"),
        ("a.b=4 m/s", "4 m/s"),
        ("a.b = 4", 4),
        ("a.b=0.5", 0.5),
        ("a.b=true", True),
        ('a.b=["1 m", "2 m"]', ["1 m", "2 m"]),
        ("a.b=linear", "linear"),
        ("a.b=1\nc=2", "1\nc=2"),
        ("a.b=1 = 2", "1 = 2"),
    ],
)
def test_a_value_is_toml_or_a_text(setting: str, value: object) -> None:
    document: dict[str, object] = {}
    (found,) = override(document, [setting])
    assert document == {"a": {"b": value}}
    assert found.path == ("a", "b")


def test_a_quoted_part_may_hold_a_dot() -> None:
    document: dict[str, object] = {}
    override(document, ['a."b.c"=1'])
    assert document == {"a": {"b.c": 1}}


def test_the_last_counts() -> None:
    capture, _ = changed("capture.bullets.speed=4 m/s", "capture.bullets.speed=3.5 m/s").phases
    assert capture.main.parameters["bullets.speed"] == 3.5


@pytest.mark.parametrize(
    ("setting", "told"),
    [
        ("capture.bullets.speed", 'expected KEY.KEY=VALUE, such as capture.bullets.speed="4 m/s"'),
        ("=3", "expected KEY.KEY=VALUE"),
        ("capture.bullets.speed=", "expected KEY.KEY=VALUE"),
        ("capture..speed=3", "'capture..speed' is not a key"),
        ("capture.bullets.speed.x=3", "capture.bullets.speed is not a table: it has no 'x'"),
        ("capture.bullets.speed=4 kg", '--set capture.bullets.speed=4 kg: capture.bullets.speed = "4 kg": is a mass'),
        (
            "capture.bullets.sped=4 m/s",
            '--set capture.bullets.sped=4 m/s: capture.bullets.sped = "4 m/s": unknown key; did',
        ),
        ("capture.bulets.speed=4 m/s", "capture.bulets = a table: unknown key; did you mean 'bullets'?"),
        ("captur.bullets.speed=4 m/s", "captur = a table: unknown key; did you mean 'capture'?"),
        ("removal.reel.law=linar", '--set removal.reel.law=linar: removal.reel.law = "linar": expected locked'),
        ("capture.net.side=12.3 m", "--set capture.net.side=12.3 m: capture.net.side"),
    ],
)
def test_a_mistake_names_the_setting_as_its_place(setting: str, told: str) -> None:
    assert told in complaint(setting)


def test_mistakes_of_the_file_keep_their_lines() -> None:
    text = find("mission").read_text().replace('mass = "1.27 kg"', "mass = 1.27")
    line = text.splitlines().index("mass = 1.27") + 1
    with pytest.raises(InputError) as error:
        parse(text, "a", "a.toml", settings=["capture.solver.seed=x", "capture.net.side=12"])
    first, *rows = str(error.value).splitlines()
    assert first == "a.toml: 3 mistakes"
    assert any(row.startswith(f"  line {line}: capture.bullets.mass = 1.27") for row in rows)
    assert any(row.startswith("  --set capture.net.side=12: capture.net.side = 12") for row in rows)


def test_the_text_kept_has_the_changes_and_the_comments() -> None:
    scene = changed("capture.bullets.speed=3.5 m/s", "removal.duration=3 h", "capture.solver.seed=3")
    assert 'speed = "3.5 m/s"' in scene.text
    assert scene.text.startswith("# Net and bullets of Table 3")
    assert "# a little low: in eight seconds" in scene.text
    again = parse(scene.text, "again", "again")
    assert again.phases == scene.phases
    assert scene.places.overrides[0].argument == "capture.bullets.speed=3.5 m/s"


@pytest.mark.parametrize("scene", ["mission", "table1-capture", "table2-deorbit"])
def test_a_scene_that_nothing_changes_is_kept_to_the_letter(scene: str) -> None:
    assert load(scene).text == find(scene).read_text()


@pytest.mark.parametrize(
    "setting", ["removal.chaser.mass=3 t", 'removal.solver={tolerance_orbit = "1 mm"}', 'phases=["removal"]']
)
def test_every_kind_of_place_can_be_set(setting: str) -> None:
    """Inline tables, dotted keys and new tables: what is kept is what was checked, however it was written."""
    text = find("table2-deorbit").read_text().replace('[removal.chaser]\nmass = "2000 kg"\n', "")
    for chaser in ('chaser = {mass = "2 t"}', 'chaser.mass = "2 t"'):
        inline = text.replace('duration = "1 day"', f'duration = "1 day"\n{chaser}')
        assert tomllib.loads(inline)["removal"]["chaser"] == {"mass": "2 t"}
        scene = parse(inline, "a", "a", settings=[setting])
        assert parse(scene.text, "a", "a").phases == scene.phases


@pytest.mark.parametrize(
    ("settings", "title"),
    [
        ((), "Table 1: a 24 m net takes a 4 x 8 x 4 m box"),
        (("capture.net.side=12 m",), "{} (changed: capture.net.side = 12 m)"),
        (
            ('capture.net.side="12 m"', "capture.solver.seed=3"),
            "{} (changed: capture.net.side = 12 m, capture.solver.seed = 3)",
        ),
        (("capture.net.side=12 m", "capture.net.side=20 m"), "{} (changed: capture.net.side = 20 m)"),
        (('capture.target.size=["1 m", "2 m", "3 m"]',), '{} (changed: capture.target.size = ["1 m", "2 m", "3 m"])'),
        (("capture.net.side=24 m",), "{}"),
        (("title=Mine", "capture.net.mesh=2 m"), "Mine (changed: capture.net.mesh = 2 m)"),
        (("title=Mine",), "Mine"),
    ],
)  # fmt: skip
def test_the_title_follows(settings: tuple[str, ...], title: str) -> None:
    """It would say 24 m of a net of 12 m otherwise; what is set to what it was has changed nothing."""
    scene = changed(*settings, scene="table1-capture")
    assert scene.title == title.format("Table 1: a 24 m net takes a 4 x 8 x 4 m box")
    again = parse(scene.text, "again", "again")
    assert again.title == scene.title


def test_the_title_tells_all_changes_of_a_scene_that_was_changed_before() -> None:
    first = changed("capture.net.side=12 m", scene="table1-capture")
    second = parse(first.text, "again", "again", settings=["capture.solver.seed=3"])
    assert second.title.endswith("(changed: capture.net.side = 12 m) (changed: capture.solver.seed = 3)")


def test_a_scene_without_a_title_gets_one_when_changed() -> None:
    text = "\n".join(line for line in find("table1-capture").read_text().splitlines() if not line.startswith("title"))
    scene = parse(text, "a", "a", settings=["capture.net.side=12 m"])
    assert scene.title == parse(scene.text, "b", "b").title == "(changed: capture.net.side = 12 m)"
