"""Dispersions held against a scene: applied to what they name, or told as mistakes."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.stats import kendalltau

from dcone_cosim.campaign.applied import base_of, inputs_of
from dcone_cosim.campaign.inputs import Group as InputGroup
from dcone_cosim.campaign.inputs import Inputs, shown
from dcone_cosim.campaign.sampling import monte_carlo
from dcone_cosim.loading import load
from dcone_cosim.scene.mistakes import SceneError
from tests.campaign.conftest import TOW, spec_of


def dispersion(key: str, rest: str) -> str:
    return f'[[dispersion]]\nkey = "{key}"\n{rest}\n'


def made(text: str, head: str = TOW) -> Inputs:
    spec = spec_of(text, head)
    return inputs_of(spec, base_of(spec))


NET = TOW.replace("table2-deorbit", "table1-capture")
BULLETS = "[set.capture.ejection]\nnumber = 4\n"
TENTH = 'distribution = "normal"\ndeviation = "10 %"'


def test_values_reach_the_fmu() -> None:
    """What is drawn stands in the scene that a case runs, to the last bit, and nothing else changes."""
    inputs = made(dispersion("removal.thrust.level", TENTH) + dispersion("removal.tether.damping_ratio", TENTH))
    values = inputs.values(np.array([0.2, 0.9]))
    scene, base = load("table2-deorbit", inputs.settings(values)), load("table2-deorbit")
    found, before = (one.phases[0].main.values for one in (scene, base))
    level = "thrust.level[2]" if "thrust.level[2]" in found else "thrust.level"
    assert (found[level], found["tether.damping_ratio"]) == tuple(values)
    assert {name for name in found if found[name] != before[name]} == {level, "tether.damping_ratio"}
    assert values[0] == pytest.approx(before[level] - 0.8416212 * 0.1 * abs(before[level]), rel=1e-6)


def test_each_bullet_has_its_own() -> None:
    text = BULLETS + dispersion("capture.ejection.speed_error", 'distribution = "normal"\ndeviation = "3 cm/s"')
    inputs = made(text, NET)
    assert inputs.names == [f"capture.ejection.speed_error[{i}]" for i in (1, 2, 3, 4)]
    values = inputs.values(np.array([0.1, 0.4, 0.6, 0.9]))
    scene = load("table1-capture", ["capture.ejection.number=4", *inputs.settings(values)])
    found = scene.phases[0].main.values
    assert [found[f"ejection.speed_error[{i}]"] for i in (1, 2, 3, 4)] == values
    assert values[3] == pytest.approx(0.03 * 1.2815516, rel=1e-6)


@pytest.mark.parametrize(
    ("key", "rest", "head", "unit", "told"),
    [
        ("capture.target.start_rate[2]", 'least = "10 deg/s"\nmost = "30 deg/s"', NET, "deg/s", "20 deg/s"),
        ("removal.tether.diameter", 'least = "800 um"\nmost = "1200 um"', TOW, "um", "1000 um"),
        ("removal.tether.diameter", 'within = "10 %"', TOW, "mm", "1 mm"),
        ("removal.tether.damping_ratio", "least = 0.04\nmost = 0.06", TOW, "", "0.05"),
    ],
)
def test_values_are_told_in_the_unit_that_they_were_given_in(
    key: str, rest: str, head: str, unit: str, told: str
) -> None:
    """Of shares in that of a person; drawn and written they stay SI."""
    (one,) = made(dispersion(key, f'distribution = "uniform"\n{rest}'), head).inputs
    assert one.label == (f"{key} [{unit}]" if unit else key)
    assert shown(one, one.value(0.5)) == told
    assert one.read(one.value(0.5)) == pytest.approx(float(told.split()[0]), rel=1e-12)
    assert one.told(one.value(0.5)).number == one.value(0.5)


def test_a_width_names_the_unit_where_nothing_else_does() -> None:
    text = 'distribution = "normal"\nmean = "1 mm"\ndeviation = "30 um"'
    (one,) = made(dispersion("removal.tether.diameter", text)).inputs
    assert one.label.endswith("[mm]")
    (one,) = made(dispersion("removal.tether.diameter", text.replace('mean = "1 mm"\n', ""))).inputs
    assert one.label.endswith("[um]")


def test_one_element_leaves_the_others() -> None:
    key = "capture.ejection.delay[2]"
    inputs = made(BULLETS + dispersion(key, 'distribution = "uniform"\nleast = "0 s"\nmost = "50 ms"'), NET)
    found = load("table1-capture", ["capture.ejection.number=4", *inputs.settings([0.03])]).phases[0].main.values
    assert [found[f"ejection.delay[{i}]"] for i in (1, 2, 3, 4)] == [0.0, 0.03, 0.0, 0.0]


def test_texts_are_chosen() -> None:
    rest = 'distribution = "discrete"\nvalues = ["target", "chaser"]\nweights = [3, 1]'
    inputs = made(dispersion("removal.start.leading", rest))
    assert inputs.settings(inputs.values(np.array([0.74]))) == ('removal.start.leading="target"',)
    assert inputs.settings(inputs.values(np.array([0.76]))) == ('removal.start.leading="chaser"',)


def test_a_material_whose_stiffness_the_scene_gives_changes_nothing() -> None:
    """It would have looked applied: a table with two materials, and one line."""
    rest = 'distribution = "discrete"\nvalues = ["Kevlar 29", "Dyneema SK75"]'
    with pytest.raises(SceneError, match="Kevlar 29 and Dyneema SK75 come to the same in table2-deorbit"):
        made(dispersion("removal.tether.material", rest))


def test_correlation() -> None:
    """Kendall's tau of a Gaussian copula is 2/pi asin(r), whatever the marginal distributions are."""
    text = dispersion("removal.thrust.level", TENTH) + dispersion(
        "removal.tether.damping_ratio", 'distribution = "uniform"\nwithin = "20 %"'
    )
    link = '[[correlation]]\nbetween = ["removal.thrust.level", "removal.tether.damping_ratio"]\ncoefficient = -0.6\n'
    inputs = made(text + link)
    values = np.array([inputs.values(monte_carlo(1, number, 2)) for number in range(1, 3001)])
    assert kendalltau(*values.T).statistic == pytest.approx(2.0 / math.pi * math.asin(-0.6), abs=0.03)
    assert values[:, 1].min() >= 0.8 * 0.05 * 0.99
    free = made(text)
    values = np.array([free.values(monte_carlo(1, number, 2)) for number in range(1, 3001)])
    assert abs(kendalltau(*values.T).statistic) < 0.03


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (dispersion("removal.tether.rest_lenght", TENTH), "did you mean 'removal.tether.rest_length'?"),
        (dispersion("capture.net.mass", TENTH), "has no such key with a number"),
        (dispersion("removal.thrust.level", 'distribution = "normal"\ndeviation = "1 kg"'), "is in kg"),
        (dispersion("removal.thrust.level", 'distribution = "normal"\ndeviation = 0.1'), "is in no unit"),
        (dispersion("removal.thrust.level[7]", TENTH), "no vector of that name"),
        (dispersion("title", 'distribution = "discrete"\nvalues = ["a", "b"]'), "nothing that reaches an FMU differs"),
        (
            dispersion("removal.tether.damping_ratio", 'distribution = "discrete"\nvalues = [0.05, 0.050]'),
            "nothing that reaches an FMU differs",
        ),
        (
            dispersion("removal.macro_step", 'distribution = "uniform"\nleast = "30 s"\nmost = "60 s"'),
            "nothing that reaches an FMU differs",
        ),
        (
            dispersion("removal.tether.damping_ratio", 'distribution = "normal"\nmean = -5\ndeviation = 1'),
            "does not take",
        ),
        (dispersion("removal.thrust.level", TENTH) * 2, "is dispersed above"),
        (
            dispersion("removal.thrust.level", TENTH)
            + '[[correlation]]\nbetween = ["removal.thrust.level", "removal.thrust"]\ncoefficient = 0.5\n',
            "is not dispersed",
        ),
        ("jitter = true\n", "jitter"),
    ],
)
def test_what_is_refused(text: str, told: str) -> None:
    if text.startswith("jitter"):
        made(text, TOW)  # a tow that begins apart can be jittered
        return
    with pytest.raises(SceneError) as error:
        made(text)
    assert told in str(error.value)
    assert "tow.toml: 1 mistake" in str(error.value)
    assert "line " in str(error.value)


def test_a_direction_left_at_its_default() -> None:
    """All zero stands for "along the chaser's y": with one element set alone the shot would go sideways."""
    text = dispersion("capture.shot.axis[1]", 'distribution = "normal"\ndeviation = 0.01')
    with pytest.raises(SceneError, match=r"give all of it first, in \[set\.capture\.shot\]"):
        made(text, NET)
    good = made("[set.capture.shot]\naxis = [0.0, 1.0, 0.0]\n" + text, NET)
    assert good.settings([0.02]) == ("capture.shot.axis=[0.02, 1.0, 0.0]",)


def test_what_is_wrong_in_set() -> None:
    with pytest.raises(SceneError) as error:
        made('[set.removal.tether]\nrest_lenght = "3 m"\n' + dispersion("removal.thrust.level", TENTH))
    assert "line 7: set.removal.tether.rest_lenght" in str(error.value)
    assert "did you mean 'rest_length'?" in str(error.value)


def test_no_such_scene() -> None:
    with pytest.raises(SceneError, match="did you mean 'table2-deorbit'"):
        made(dispersion("removal.thrust.level", TENTH), TOW.replace("table2-deorbit", "table2-deorbits"))


def test_jitter_is_an_input() -> None:
    """Each case has a seed of its own, in the FMU, and the micrometre that it moves."""
    inputs = made("jitter = true\n", NET)
    assert inputs.names == ["jitter"]
    found = [
        load("table1-capture", inputs.settings(inputs.values(np.array([u])))).phases[0].main.values for u in (0.2, 0.7)
    ]
    assert [one["solver.seed"] for one in found] == [float(int(u * (2**31 - 1))) for u in (0.2, 0.7)]
    assert [one["solver.jitter[1]"] for one in found] == [1e-6, 1e-6]


def test_within() -> None:
    """Both ways about the scene's own value."""
    inputs = made(dispersion("removal.tether.damping_ratio", 'distribution = "uniform"\nwithin = "20 %"'))
    assert [inputs.inputs[0].value(u) for u in (0.0, 0.5, 1.0)] == pytest.approx([0.04, 0.05, 0.06], rel=1e-12)
    inputs = made(dispersion("removal.start.separation", 'distribution = "uniform"\nwithin = "50 cm"'))
    assert [inputs.inputs[0].value(u) for u in (0.0, 1.0)] == pytest.approx([9.5, 10.5], rel=1e-12)


def test_elements_of_one_vector_by_dispersions_of_their_own() -> None:
    """Each is written with the others: a setting for each would have left the last alone."""
    rest = 'distribution = "uniform"\nleast = -0.4\nmost = 0.4'
    text = "[set.capture.shot]\naxis = [0.0, 1.0, 0.0]\n"
    text += dispersion("capture.shot.axis[1]", rest) + dispersion("capture.shot.axis[3]", rest)
    inputs = made(text, NET)
    assert inputs.settings([0.1, -0.2]) == ("capture.shot.axis=[0.1, 1.0, -0.2]",)
    assert inputs.values(np.array([0.25, 0.75])) == pytest.approx([-0.2, 0.2])


def test_an_input_that_another_undoes() -> None:
    """Tried by itself each has an effect; tried with the others, the first has none."""
    from dcone_cosim.campaign import applied

    rest = 'distribution = "uniform"\nleast = -0.4\nmost = 0.4'
    text = "[set.capture.shot]\naxis = [0.0, 1.0, 0.0]\n"
    inputs = made(text + dispersion("capture.shot.axis[1]", rest) + dispersion("capture.shot.axis[3]", rest), NET)
    alone = [made(text + dispersion(f"capture.shot.axis[{i}]", rest), NET).groups[0].write for i in (1, 3)]
    apart = Inputs(inputs.inputs, tuple(InputGroup((i,), write) for i, write in enumerate(alone)))
    base = base_of(spec_of(text + dispersion("capture.shot.axis[1]", rest), NET))
    assert [one.given for one in applied._all_count(base, apart)] == ["capture.shot.axis[1]"]
    assert list(applied._all_count(base, inputs)) == []
