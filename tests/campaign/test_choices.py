"""Values that go together, and answers for each of them."""

from __future__ import annotations

import numpy as np
import pytest

from dcone_cosim.campaign.answers import answers
from dcone_cosim.campaign.applied import base_of, inputs_of
from dcone_cosim.campaign.engine import Made
from dcone_cosim.campaign.inputs import Inputs
from dcone_cosim.campaign.show import as_dict, sentences
from dcone_cosim.campaign.toml_text import as_toml
from dcone_cosim.cases.rows import Row
from dcone_cosim.cases.statistics import share
from dcone_cosim.loading import load
from dcone_cosim.scene.mistakes import SceneError
from tests.campaign.conftest import TOW, spec_of

NET = TOW.replace("table2-deorbit", "table1-capture")
TARGETS = """
[[dispersion]]
key = "capture.target"
distribution = "discrete"
names = ["box", "stage"]
values = [
    { shape = "box", size = ["2 m", "2 m", "2 m"], mass = "100 kg" },
    { shape = "union", parts = [
        { shape = "cylinder", radius = "1 m", length = "3 m", mass = "500 kg" },
        { shape = "sphere", radius = "1 m", mass = "20 kg", position = ["0 m", "0 m", "1.5 m"] },
    ] },
]
"""
SIZES = """
[[dispersion]]
name = "size"
keys = ["capture.net.side", "capture.net.mesh", "capture.bullets.mass"]
distribution = "discrete"
names = ["small", "large"]
values = [["12 m", "0.5 m", "0.3 kg"], ["24 m", "1 m", "0.5 kg"]]
"""

LEADING = """
[[dispersion]]
key = "removal.start.leading"
distribution = "discrete"
values = ["target", "chaser"]
"""


def made(text: str) -> Inputs:
    spec = spec_of(text, NET)
    return inputs_of(spec, base_of(spec))


def test_a_table_is_a_value() -> None:
    inputs = made(TARGETS)
    box, stage = (
        load("table1-capture", inputs.settings(inputs.values(np.array([u])))).phases[0].main for u in (0.2, 0.7)
    )
    assert (box.terms["target"], box.values["target.mass"]) == ("box", 100.0)
    assert box.values["target.start_rate[3]"] == 0.0, "a table takes the place of the scene's own"
    assert stage.terms["target"] == "union"
    assert stage.values["target.mass"] == pytest.approx(520.0)


def test_keys_go_together() -> None:
    inputs = made(SIZES)
    assert inputs.names == ["size"]
    assert [one.texts for one in inputs.inputs] == [("small", "large")]
    for u, expected in ((0.2, (12.0, 0.5, 0.3)), (0.7, (24.0, 1.0, 0.5))):
        values = load("table1-capture", inputs.settings(inputs.values(np.array([u])))).phases[0].main.values
        assert tuple(values[key] for key in ("net.side", "net.mesh", "bullets.mass")) == expected


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ('names = ["small", "large"]', 'names = ["small"]', "expected a name for each value, each once"),
        ('names = ["small", "large"]', 'names = ["small", "small"]', "expected a name for each value, each once"),
        ('names = ["small", "large"]', "", "several keys have no text"),
        ('"1 m", "0.5 kg"]', '"1 m"]', "expected a list with a value for each of 3 keys"),
        ('name = "size"\n', "", "name missing: expected a text"),
        ("[[dispersion]]", 'by = ["sizes"]\n[[dispersion]]', "did you mean 'size'?"),
        ("[[dispersion]]", 'by = ["size"]\nsampler = "latin-hypercube"\n[[dispersion]]', "alone are independent"),
        ('"capture.net.mesh"', '"capture.net.mehs"', "did you mean 'capture.net.mesh'?"),
    ],
)
def test_mistakes(old: str, new: str, told: str) -> None:
    assert old in SIZES
    with pytest.raises(SceneError) as error:
        made(SIZES.replace(old, new, 1))
    assert told in str(error.value)


def test_a_table_and_a_key_in_it_are_the_same_twice() -> None:
    inside = '[[dispersion]]\nkey = "capture.target.mass"\ndistribution = "uniform"\nwithin = "10 %"\n'
    for text in (TARGETS + inside, inside + TARGETS):
        with pytest.raises(SceneError, match="dispersed above"):
            made(text)


def test_tables_within_a_line() -> None:
    assert as_toml([{"a": [1.5, "2 m"]}]) == '[{a = [1.5, "2 m"]}]'
    assert as_toml(["1 m", "2 m"]) == '["1 m", "2 m"]'


def test_an_empty_table_brings_its_part_in() -> None:
    """It was dropped without a word. One that the scene has keeps what it says."""
    spec = spec_of("[set.capture.volume]\n[set.capture.closing]\n" + SIZES, NET)
    main = base_of(spec).phases[0].main
    assert "volume" in main.terms
    assert main.values["closing.time"] == 11.2


def test_answers_for_each_value() -> None:
    """Two in three of the small ones are caught, one in five of the large ones; each has its own interval."""
    spec = spec_of('by = ["size"]\n' + SIZES, NET)
    caught = [True, True, False] * 10, [True, False, False, False, False] * 6
    cases = [
        Made(
            1, (float(place),), Row("", "completed", 0 if good else 3, "", _figures(good, place), {"capture.peak": "N"})
        )
        for place, verdicts in enumerate(caught)
        for good in verdicts
    ]
    found = answers(spec, cases, {"capture.derived": [3.0] * 30 + [4.0] * 30}, ["size"])
    assert {words: one.success for words, one in found.by.items()} == {
        ("small",): share(20, 30),
        ("large",): share(6, 30),
    }
    assert [one.figures["capture.peak"].mean for one in found.by.values()] == [1.0, 2.0]
    assert [one.figures["capture.derived"].mean for one in found.by.values()] == [3.0, 4.0]
    assert found.success == share(26, 60)
    assert "small: 20 of 30, 0.6667 (0.4878 to 0.8077); 10 missed" in list(sentences(spec, found))
    told = as_dict(spec, found)["by"]
    quoted = spec_of('by = ["removal.start.leading"]\n' + LEADING)
    one = Made(1, (0.0,), Row("", "completed", 0, "", {}, {}))
    assert [*answers(quoted, [one], {}, ["removal.start.leading"]).by] == [("target",), ("chaser",)]
    assert [(row["values"], row["succeeded"]) for row in told] == [({"size": "small"}, 20), ({"size": "large"}, 6)]


def _figures(good: bool, place: int) -> dict[str, float | str]:
    return {"capture.outcome": "captured" if good else "missed", "capture.peak": 1.0 + place}
