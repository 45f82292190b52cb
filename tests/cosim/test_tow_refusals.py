"""What does not go together in a tow is refused before anything is built, by key, value and what was expected."""

from __future__ import annotations

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
