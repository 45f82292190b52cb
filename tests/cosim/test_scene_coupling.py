"""Further components of a phase, connections and coupling: what a scene says of them, and every mistake in it."""

from __future__ import annotations

import pytest

from dcone_cosim.coupling.options import Connection, Coupling
from dcone_cosim.errors import InputError
from dcone_cosim.loading import find
from dcone_cosim.scene.data import PhaseScene
from dcone_cosim.scene.mistakes import SceneError
from dcone_cosim.scenes.reading import parse

CONTROLLED = """
[removal]
macro_step = "60 s"
duration = "1 day"
connections = [
  "removal.separation -> controller.length", # what the reel sees
  "removal.tether.length_rate -> controller.length_rate",
  "controller.tension -> removal.reel.tension",
]

[removal.reel]
law = "commanded"

[removal.components.controller]
model = "reel_control"

[removal.components.controller.reel]
length = "11 m"

[removal.coupling]
method = "jacobi"
step = "1 s"
control = "error"
tolerance = 1e-5
smallest_step = "1 ms"
extrapolation = "linear"
order = ["controller", "removal"]
"""


def read(text: str) -> PhaseScene:
    (phase,) = parse(text, "mine", "mine.toml").phases
    return phase


def complaint(*changes: tuple[str, str]) -> str:
    text = CONTROLLED
    for old, new in changes:
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    with pytest.raises(InputError) as error:
        parse(text, "mine", "mine.toml")
    return str(error.value)


def line(beginning: str) -> int:
    (number,) = [i for i, row in enumerate(CONTROLLED.splitlines(), start=1) if row.strip().startswith(beginning)]
    return number


def test_a_phase_of_two_components() -> None:
    phase = read(CONTROLLED)
    assert [component.name for component in phase.components] == ["removal", "controller"]
    (controller,) = phase.others
    assert (controller.model, controller.fmu) == ("reel_control", None)
    assert controller.parameters == {"reel.length": 11.0}
    assert phase.connections[2] == Connection("controller", "tension", "removal", "reel.tension")
    assert phase.coupling == Coupling("jacobi", 1.0, "error", 1e-5, 1e-3, "linear", ("controller", "removal"))


def test_what_is_not_said_of_the_coupling() -> None:
    assert read(CONTROLLED[: CONTROLLED.index("[removal.coupling]")]).coupling == Coupling()


def test_an_input_may_be_given_a_value() -> None:
    assert (
        read(find("table2-deorbit").read_text() + "[removal.components]\n").main.parameters.get("thrust.offset") is None
    )
    text = find("table2-deorbit").read_text().replace("[removal.reel]", '[removal.reel]\nlength_offset = "10 cm"')
    assert read(text).main.parameters["reel.length_offset"] == 0.1
    text = find("table1-capture").read_text() + "[capture.close]\ncommand = true\n"
    assert read(text).main.parameters["close.command"] == 1.0


@pytest.mark.parametrize(
    ("old", "new", "at", "told"),
    [
        (
            '"controller.tension -> ',
            '"controler.tension -> ',
            '"controller.tension',
            "there is no component 'controler'; did you mean 'controller'?",
        ),
        (
            "removal.separation -> ",
            "removal.seperation -> ",
            '"removal.separation ->',
            "removal has no output 'seperation'; did you mean 'separation'?",
        ),
        (
            '-> controller.length"',
            '-> controller.lenght"',
            '"removal.separation ->',
            "controller has no input 'lenght'; did you mean 'length'?",
        ),
        (
            "removal.separation ->",
            "removal.chaser.mass ->",
            '"removal.separation ->',
            "'chaser.mass' is a parameter of removal, expected an output",
        ),
        (
            '-> controller.length"',
            '-> controller.tension"',
            '"removal.separation ->',
            "'tension' is an output of controller, expected an input",
        ),
        (
            "removal.separation ->",
            "removal.tether.tension ->",
            '"removal.separation ->',
            "removal.tether.tension is in N, controller.length in m: different dimensions",
        ),
        (
            "removal.separation ->",
            "removal.tether.taut ->",
            '"removal.separation ->',
            "removal.tether.taut is a Boolean, controller.length is a Real",
        ),
        (
            "removal.separation ->",
            "removal.relative.position ->",
            '"removal.separation ->',
            "removal.relative.position has 3 elements, controller.length has 1: expected as many",
        ),
        (
            'removal.separation -> controller.length"',
            'removal.separation => controller.length"',
            '"removal.separation ->',
            'expected "INSTANCE.VARIABLE -> INSTANCE.VARIABLE"',
        ),
        (
            'removal.separation -> controller.length"',
            'separation -> controller.length"',
            '"removal.separation ->',
            'expected "INSTANCE.VARIABLE -> INSTANCE.VARIABLE"',
        ),
        (
            "removal.tether.length_rate -> controller.length_rate",
            "removal.tether.length -> controller.length",
            '"removal.tether.length_rate',
            "controller.length is connected twice: also by removal.connections[1]",
        ),
        (
            '-> controller.length"',
            '-> removal.thrust.offset"',
            '"removal.separation ->',
            "has no input 'thrust.offset'",
        ),
        ("controller.tension ->", "removal.tether.tension ->", '"controller.tension', "connects removal with itself"),
    ],
)
def test_a_mistake_in_a_connection(old: str, new: str, at: str, told: str) -> None:
    """It is told with the line of the connection, not of the list."""
    message = complaint((old, new))
    assert message.startswith("mine.toml: 1 mistake"), message
    assert f"  line {line(at)}: removal.connections[" in message
    assert told in message


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        (
            '"reel_control"',
            '"reel_controls"',
            'components.controller.model = "reel_controls": expected the name of a '
            "model; did you mean 'reel_control'?",
        ),
        (
            'model = "reel_control"',
            "",
            'components.controller = a table: expected a key fmu = "path.fmu" or model = "name"',
        ),
        ('model = "reel_control"', 'model = "reel_control"\ntimeout = "1 s"', "add isolate = true"),
        ('model = "reel_control"', 'model = "reel_control"\nisolate = 1', "isolate = 1: expected true or false"),
        ("[removal.components.controller.reel]", "[removal.components.controller.reels]", "did you mean 'reel'?"),
        ('length = "11 m"', 'lenght = "11 m"', "did you mean 'length'?"),
        ('length = "11 m"', 'length = "11 kg"', "is a mass; expected a length"),
        ('method = "jacobi"', 'method = "jacoby"', 'coupling.method = "jacoby": expected one of gauss_seidel, jacobi'),
        ('step = "1 s"', 'step = "61 s"', 'coupling.step = "61 s": must be at most removal.macro_step, "60 s"'),
        (
            'control = "error"',
            'control = "fixed"',
            "coupling.tolerance = 1e-05: says nothing to fixed steps; add control",
        ),
        ('smallest_step = "1 ms"', 'smallest_step = "2 s"', "must be at most coupling.step"),
        (
            '["controller", "removal"]',
            '["controller"]',
            'expected each component once, such as ["removal", "controller"]',
        ),
        (
            '["controller", "removal"]',
            '["contoller", "removal"]',
            'order[1] = "contoller": no component of this phase; did',
        ),
        (
            "[removal.coupling]",
            "[removal.couplings]",
            "removal.couplings = a table: unknown key; did you mean 'coupling'?",
        ),
        ("[removal.components.controller]", "[removal.components.capture]", "cannot be the name of a component"),
        ("connections = [", "connections = 3 # [", "expected a list of"),
    ],
)
def test_a_mistake_in_a_component(old: str, new: str, told: str) -> None:
    changes = [(old, new)]
    if "connections" in old:
        text = CONTROLLED[CONTROLLED.index("connections") : CONTROLLED.index("]", CONTROLLED.index("connections")) + 1]
        changes = [(text, "connections = 3")]
    assert told in complaint(*changes)


def test_a_value_and_a_connection_contradict_one_another() -> None:
    told = complaint(('law = "commanded"', 'law = "commanded"\ntension = "1 N"'))
    assert "removal.reel.tension is connected here, and is given a value as removal.reel.tension" in told


def test_what_cannot_be_read_is_told_once() -> None:
    """Of an FMU that is not there nothing is known: its connections are no mistakes."""
    told = complaint(('model = "reel_control"', 'fmu = "nowhere.fmu"'))
    assert told == (
        f'mine.toml: 1 mistake\n  line {line("model")}: removal.components.controller.fmu = "nowhere.fmu": no such file'
    )


def test_all_mistakes_at_once_each_on_its_line() -> None:
    changed = CONTROLLED.replace("removal.separation ->", "removal.seperation ->").replace('"11 m"', '"11 kg"')
    changed = changed.replace("tolerance = 1e-5", "tolerance = 0")
    with pytest.raises(SceneError) as error:
        parse(changed, "mine", "mine.toml")
    rows = error.value.rows()
    assert [row["line"] for row in rows] == [line('"removal.separation ->'), line('length = "11 m"'), line("tolerance")]
    assert rows[0]["nearest"] == "separation"
    assert rows[0]["key"] == "removal.connections[1]"
