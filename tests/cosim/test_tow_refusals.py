"""What does not go together in a tow is refused before anything is built, by key, value and what was expected."""

from __future__ import annotations

import json
from collections.abc import Sequence

import pytest

from dcone_cosim.errors import InputError
from dcone_cosim.loading import find
from dcone_cosim.scenes.reading import parse

TABLE_2 = find("table2-deorbit").read_text(encoding="utf-8")
RIGID = '[removal.chaser]\nbody = "rigid"\nmass = "2000 kg"'


@pytest.mark.parametrize(
    ("tables", "said", "mended"),
    [
        (
            '[removal.aocs]\nfrequency = "0.1 rad/s"',
            ["removal.aocs.frequency", "0.1 rad/s", "chaser.body = rigid"],
            ('[removal.chaser]\nmass = "2000 kg"', RIGID),
        ),
        (
            '[removal.appendage]\nmass = "20 kg"',
            ["removal.appendage.mass", "20 kg", "target.body = rigid"],
            ("[removal.target]", '[removal.target]\nbody = "rigid"'),
        ),
        (
            '[removal.appendage]\nmass = "2000 kg"\n',
            ["removal.appendage.mass", "2000 kg", "target.body = rigid"],
            ("[removal.appendage]\nmass = \"2000 kg\"", ""),
        ),
        (
            '[removal.engine]\nkind = "chemical"\npropellant = "2000 kg"',
            ["removal.engine.propellant", "2000 kg", "less than chaser.mass"],
            ('propellant = "2000 kg"', 'propellant = "1999 kg"'),
        ),
        (
            '[removal.engine]\nkind = "chemical"\npropellant = "100 kg"\ntank_radius = "0.5 m"',
            ["removal.engine.tank_radius", "0.5 m", "chaser.body = rigid"],
            ('[removal.chaser]\nmass = "2000 kg"', RIGID),
        ),
        (
            '[removal.environment]\nfield = "none"\n[removal.burn]\nwhen = "arcs"\nhalf_width = "20 deg"',
            ["removal.burn.half_width", "20 deg", "need an orbit"],
            ('[removal.environment]\nfield = "none"', ""),
        ),
        (
            '[removal.level]\ndetail = "settled"',
            ["removal.level.detail", "settled", "reel.law = locked alone"],
            ('law = "commanded"', 'law = "locked"'),
        ),
        (
            '[removal.environment]\nfield = "none"\n[removal.third_bodies]\nwhich = "moon"',
            ["removal.third_bodies.which", "moon", "needs an orbit"],
            ('[removal.environment]\nfield = "none"', ""),
        ),
        (
            '[removal.engine]\nkind = "chemical"\n[removal.shadow]\nshape = "cone"\n[removal.power]\nsource = "solar"',
            ["removal.power.source", "solar", "engine.kind = electric"],
            ('kind = "chemical"', 'kind = "electric"'),
        ),
    ],
)  # fmt: skip
def test_what_does_not_go_together(tables: str, said: Sequence[str], mended: tuple[str, str]) -> None:
    text = TABLE_2 + "\n" + tables + "\n"
    if "field" in tables:
        text = text.replace('condition = "same_orbit"', 'condition = "equal_velocity"')
    if "level" in tables:
        line = text.index("[removal.tether]")
        text = text.replace('law = "locked"', 'law = "commanded"')
        text = text[: line + 3] + text[text.index("[removal.thrust]") :]
    with pytest.raises(InputError) as caught:
        parse(text, "wrong", "wrong.toml")
    assert all(word in str(caught.value) for word in said)
    assert "wrong.toml:" in str(caught.value)
    parse(text.replace(*mended), "right", "right.toml")


TURNING = (
    TABLE_2.replace("[removal.target]", '[removal.target]\nbody = "rigid"').replace(
        "[removal.chaser]", '[removal.chaser]\nbody = "rigid"'
    )
    + '\n[removal.appendage]\nmass = "20 kg"\n'
)
NOT_OF_A_BODY = "no body has that inertia: its principal moments must be positive"


@pytest.mark.parametrize(
    ("role", "moments", "said"),
    [
        ("appendage", (-40, 12, 50, 0, 0, 0), NOT_OF_A_BODY),
        ("appendage", (40, 12, 500, 0, 0, 0), NOT_OF_A_BODY),
        ("appendage", (4000, 4000, 4000, 0, 0, 0), "leaves no body of the target"),
        ("appendage", (10, 10, 900, 0, 0, 890), NOT_OF_A_BODY),
        ("target", (6000, 12, 500, 0, 0, 0), NOT_OF_A_BODY),
        ("target", (1000, 1000, 0, 0, 0, 0), NOT_OF_A_BODY),
        ("chaser", (1000, 1000, 1000, 2000, 0, 0), NOT_OF_A_BODY),
    ],
)
def test_an_inertia_that_no_body_has(role: str, moments: Sequence[float], said: str) -> None:
    setting = f"removal.{role}.inertia={json.dumps([f'{one} kg m2' for one in moments])}"
    with pytest.raises(InputError) as caught:
        parse(TURNING, "wrong", "wrong.toml", settings=(setting,))
    _, *mistakes = str(caught.value).splitlines()
    assert len(mistakes) == 1
    assert f"removal.{role}.inertia = [" in mistakes[0]
    assert said in mistakes[0]


@pytest.mark.parametrize(
    ("role", "moments"),
    [
        ("appendage", (0, 10, 10, 0, 0, 0)),
        ("appendage", (900, 818, 818, 0, 0, 0)),
        ("target", (5500, 3000, 3000, 0, 0, 0)),
        ("chaser", (1000, 1500, 1000, 400, 0, 0)),
    ],
)
def test_an_inertia_that_some_body_has(role: str, moments: Sequence[float]) -> None:
    """A rod, a disc, and bodies whose principal axes are turned; an appendage that has most of the target's."""
    setting = f"removal.{role}.inertia={json.dumps([f'{one} kg m2' for one in moments])}"
    parse(TURNING, "right", "right.toml", settings=(setting,))


@pytest.mark.parametrize(
    ("level", "tables", "said"),
    [
        ("event_map", '[removal.break]\nstrength = "100 N"', "removal.break"),
        ("event_map", "rigid", "target = rigid"),
        ("averaged", '[removal.oblateness]\nzonal = "J2"', "removal.oblateness"),
        ("averaged", '[removal.plume]\nface = "4 m"', "removal.plume"),
        ("averaged", "tether", "thrust = tether"),
    ],
)
def test_what_a_level_cannot_carry(level: str, tables: str, said: str) -> None:
    text = f'{TABLE_2}\n[removal.level]\ndetail = "{level}"\n'
    parse(text, "right", "right.toml")
    if tables == "rigid":
        wrong = text.replace("[removal.target]", '[removal.target]\nbody = "rigid"')
    elif tables == "tether":
        wrong = text.replace('direction = "along_track"', 'direction = "tether"')
    else:
        wrong = f"{text}{tables}\n"
    with pytest.raises(InputError) as caught:
        parse(wrong, "wrong", "wrong.toml")
    assert all(word in str(caught.value) for word in ("removal.level", level, said, "wrong.toml"))


def test_rows_lie_on_the_grid_of_the_macro_steps() -> None:
    text = TABLE_2.replace('macro_step = "60 s"', 'macro_step = "60 s"\nrecord_every = "90 s"')
    with pytest.raises(InputError, match=r"removal\.record_every = .*90 s.*whole number of macro steps, 60 s each"):
        parse(text, "wrong", "wrong.toml")
    options = parse(text.replace('"90 s"', '"1 h"'), "right", "right.toml").phases[0].options
    assert options is not None
    assert options.record_every == 3600.0


def test_an_empty_chaser_is_a_body() -> None:
    """1000 kg m2 about each axis, of which 100 kg at 3.16 m are all."""
    text = TABLE_2.replace('[removal.chaser]\nmass = "2000 kg"', RIGID)
    text += '\n[removal.engine]\nkind = "chemical"\npropellant = "100 kg"\ntank_radius = "3.17 m"\n'
    with pytest.raises(InputError, match=r"removal\.engine\.tank_radius = .*3\.17 m.*at most 3\.162 m"):
        parse(text, "wrong", "wrong.toml")
    parse(text.replace("3.17 m", "3.15 m"), "right", "right.toml")


@pytest.mark.parametrize(
    "keys", ['when = "timed"\nduration = "0 s"', 'when = "timed"\nduration = "1 s"\nedge = "notch"']
)
def test_a_line_without_stiffness_has_no_period(keys: str) -> None:
    text = TABLE_2.replace('law = "locked"', 'law = "commanded"')
    line = text.index("[removal.tether]")
    text = text[:line] + text[text.index("[removal.thrust]") :] + f"\n[removal.burn]\n{keys}\n"
    with pytest.raises(InputError, match=r"removal\.burn\.(duration|edge)"):
        parse(text, "wrong", "wrong.toml")
    parse(text.replace('"0 s"', '"2 s"').replace("notch", "ramp"), "right", "right.toml")


def test_averaged_says_where_its_macro_step_is_too_short() -> None:
    """Three revolutions at 800 km take 18,157 s."""
    for step, told in (("60 s", True), ("18100 s", True), ("18200 s", False), ("1 day", False)):
        scene = parse(
            TABLE_2, "mine", "mine.toml", settings=('removal.level.detail="averaged"', f'removal.macro_step="{step}"')
        )
        said = [text for text in scene.cautions if "averaged" in text]
        assert bool(said) == told
        assert not said or "18157" in said[0].replace(",", "")


def test_a_selector_that_is_misspelt_has_its_nearest_key() -> None:
    for table in ("level", "release", "electrodynamic", "air", "shadow"):
        selector = {"level": "detail", "release": "when", "electrodynamic": "field", "air": "law", "shadow": "shape"}[
            table
        ]
        with pytest.raises(
            InputError, match=rf"removal.{table}.{selector}s = .*unknown key; did you mean '{selector}'"
        ):
            parse(TABLE_2, "mine", "mine.toml", settings=(f'removal.{table}.{selector}s="x"',))


def test_what_a_table_of_an_argument_lacks_is_told_of_the_argument() -> None:
    with pytest.raises(InputError) as told:
        parse(TABLE_2, "mine", "mine.toml", settings=('removal.release.att="3 s"',))
    lines = str(told.value).splitlines()[1:]
    assert lines
    assert all(line.strip().startswith("--set removal.release.att") for line in lines)
    with pytest.raises(InputError, match=r"line \d+: removal.release.when missing"):
        parse(
            TABLE_2 + '[removal.release]\nat = "3 s"\nfar = 1\n',
            "mine",
            "mine.toml",
            settings=("removal.release.att=1",),
        )


@pytest.mark.parametrize("value", ["0.5", "2.1"])
def test_light_presses_between_black_and_a_mirror(value: str) -> None:
    text = find("eclipse-powered").read_text(encoding="utf-8")
    with pytest.raises(InputError, match=r"sunlight.coefficient = \d.\d: must be at (least 1|most 2);"):
        parse(text, "mine", "mine.toml", settings=(f"removal.sunlight.coefficient={value}",))


@pytest.mark.parametrize("value", ["1226.85 degC", "1226.85 \u00b0C", "1226.85 deg_C", "1500 K"])
def test_degrees_celsius_as_people_write_them(value: str) -> None:
    scene = parse(
        find("edt").read_text(encoding="utf-8"),
        "mine",
        "mine.toml",
        settings=(f'removal.electrodynamic.electron_temperature="{value}"',),
    )
    assert scene.phases[0].main.parameters["electrodynamic.electron_temperature"] == pytest.approx(1500.0, rel=1e-12)


def test_a_line_stretched_however_the_bodies_stand() -> None:
    """20 m apart, made fast 1 m and 2 m off the centres of mass: at least 17 m, and the line has 12 m."""
    text = TABLE_2.replace('[removal.chaser]\nmass = "2000 kg"', f'{RIGID}\nattachment = ["0 m", "1 m", "0 m"]')
    text = text.replace("[removal.target]", '[removal.target]\nbody = "rigid"\nattachment = ["0 m", "0 m", "-2 m"]')
    head, _, tail = text.partition("separation = ")
    for separation, refused in (("20 m", True), ("14.9 m", False)):
        scene = f'{head}separation = "{separation}"{tail[tail.index(chr(10)) :]}'
        if refused:
            with pytest.raises(InputError, match=r"start.separation = \"20 m\".*at least 17 m apart.*12 m"):
                parse(scene, "mine", "mine.toml")
        else:
            parse(scene, "mine", "mine.toml")
