"""How a case came out, and whether that is success."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import pytest

from dcone_cosim.campaign.outcomes import margin, outcome, settled, succeeded, unlike
from dcone_cosim.campaign.spec import Judged, Success
from dcone_cosim.cases.rows import Row, lost, refused
from dcone_cosim.errors import InputError
from dcone_cosim.loading import load
from dcone_cosim.scene.mistakes import SceneError
from tests.campaign.conftest import spec_of


def row(exit_code: int = 0, status: str = "completed", **figures: Any) -> Row:
    return Row("k", status, exit_code, "", {name.replace("__", "."): value for name, value in figures.items()})


DRAWN = '[[dispersion]]\nkey = "removal.thrust.level"\ndistribution = "normal"\ndeviation = "5 %"\n'
SEEN = "yes, for the 5 s to the end of the phase"


@pytest.mark.parametrize(
    ("one", "word", "good"),
    [
        (row(capture__outcome="captured", capture__lasted=SEEN), "captured", True),
        (row(capture__outcome="settled", capture__lasted=SEEN), "captured", True),
        (
            row(capture__outcome="captured", capture__lasted="not followed: the phase ends at the capture"),
            "captured",
            True,
        ),
        (
            row(capture__outcome="slipped off", capture__lasted="no: the target was out again 3 s later"),
            "out again",
            False,
        ),
        (row(8, "overloaded", capture__outcome="captured", capture__lasted=SEEN), "broke", False),
        (row(3, "capture failed", capture__outcome="missed"), "missed", False),
        (row(3, "capture failed", capture__outcome="tether taut"), "tether taut", False),
        (row(capture__outcome="flown"), "flown", False),
        (row(3, "capture failed", capture__outcome="flying"), "undecided at the end", False),
        (row(4, "hand-off refused", capture__outcome="captured"), "not handed over", False),
        (row(4, "propellant overdrawn", capture__outcome="captured"), "propellant overdrawn", False),
        (row(), "completed", False),
        (row(5, "FMU failed"), "FMU failed", None),
        (lost("k", "died"), "lost", None),
        (refused("k", "no"), "refused", None),
    ],
)
def test_words(one: Row, word: str, good: bool | None) -> None:
    assert (outcome(one), succeeded(one, Success())) == (word, good)


LOST = {"capture__outcome": "slipped off", "capture__lasted": "no: again", "capture__lost_after": 3.0}
KEPT = {"capture__outcome": "captured", "capture__lasted": SEEN, "capture__followed": 5.0}


@pytest.mark.parametrize(
    ("figures", "judged", "word"),
    [
        (LOST, Judged(), "out again"),
        (LOST, Judged(after=0.0), "captured"),
        (LOST, Judged(after=2.9), "captured"),
        (LOST, Judged(after=3.0), "out again"),
        (KEPT, Judged(after=5.0), "captured"),
        (KEPT, Judged(after=6.0), "undecided at the end"),
        (KEPT, Judged(after=6.0).at_capture(), "captured"),
        (KEPT | {"capture__approach": 3.9}, Judged(too_near=4.0), "too near the chaser"),
        (KEPT | {"capture__approach": 4.1}, Judged(too_near=4.0), "captured"),
        (KEPT | {"capture__approach": 9.0, "removal__approach": 3.0}, Judged(too_near=4.0), "too near the chaser"),
        ({"capture__outcome": "missed", "second_shot__outcome": "captured"}, Judged(), "captured"),
        ({"capture__outcome": "missed", "second_shot__outcome": "slipped off"}, Judged(), "slipped off"),
    ],
)
def test_when_it_is_judged_and_what_is_too_near(figures: dict[str, Any], judged: Judged, word: str) -> None:
    """At capture and later, by the last shot that was made; nearness is told before what else came of it."""
    assert outcome(row(**figures), judged) == word
    assert succeeded(row(**figures), Success(judged=judged)) is (word == "captured")


@pytest.mark.parametrize(
    ("text", "said"),
    [('too_near = "4 kg"', "too_near"), ("too_near = 4", "too_near"), ('judged_after = "-5 s"', "judged_after")],
)
def test_a_distance_or_a_time_that_is_none(text: str, said: str) -> None:
    drawn = '[[dispersion]]\nkey = "removal.thrust.level"\ndistribution = "normal"\ndeviation = "5 %"\n'
    with pytest.raises(SceneError) as error:
        spec_of(f"{text}\n{drawn}")
    assert said in str(error.value)


def test_a_bound_in_another_unit_is_never_compared() -> None:
    """Whatever the case: 47 N are not below 50 kg."""
    below = Success("", "removal.peak", 50.0, False, "peak below 50 kg", "kg")
    one = replace(row(removal__peak=47.0), units={"removal.peak": "N"})
    with pytest.raises(InputError, match=r"removal\.peak is in N, its bound is in kg"):
        succeeded(one, below)
    assert succeeded(replace(one, units={"removal.peak": "kg"}), below) is True


@pytest.mark.parametrize(
    ("bound", "figure", "fits"),
    [
        ("N", "kg.m/s2", True),
        ("mm", "m", True),
        ("1", "1", True),
        ("%", "1", True),
        ("deg/s", "rad/s", True),
        ("1", "rad", False),
        ("1/s", "rad/s", False),
        ("deg", "1", False),
        ("1", "N", False),
        ("K", "no unit", True),
    ],
)
def test_units_of_bounds(bound: str, figure: str, fits: bool) -> None:
    assert (not unlike(Success("", "a", unit=bound), figure)) == fits


def test_a_bound() -> None:
    below = Success("", "removal.peak", 50.0, False, "peak below 50 N")
    assert [succeeded(row(removal__peak=value), below) for value in (49.0, 51.0, math.nan)] == [True, False, None]
    assert succeeded(row(5, "FMU failed", removal__peak=1.0), below) is None
    assert margin(row(removal__peak=47.0), below) == 3.0
    assert math.isnan(margin(row(removal__peak="none"), below))


def test_another_outcome() -> None:
    assert succeeded(row(3, "capture failed", capture__outcome="missed"), Success("missed")) is True
    assert succeeded(row(capture__outcome="captured", capture__lasted=SEEN), Success("missed")) is False


@pytest.mark.parametrize(
    ("scene", "word"), [("table1-capture", "captured"), ("deployment", "flown"), ("table2-deorbit", "completed")]
)
def test_what_counts_where_a_campaign_does_not_say(scene: str, word: str) -> None:
    assert settled(spec_of("jitter = true\n"), load(scene)).success.outcome == word
    bound = spec_of('jitter = true\nsuccess = { figure = "a.b", below = 1 }\n')
    assert settled(bound, load(scene)) == bound


@pytest.mark.parametrize(
    ("scene", "word", "good"),
    [
        ("table2-deorbit", "captured", False),
        ("table2-deorbit", "missed", False),
        ("table2-deorbit", "completed", True),
        ("table2-deorbit", "broke", True),
        ("deployment", "captured", False),
        ("deployment", "completed", False),
        ("deployment", "flown", True),
        ("table1-capture", "captured", True),
        ("table1-capture", "missed", True),
        ("table1-capture", "completed", False),
        ("table1-capture", "flown", False),
    ],
)
def test_an_outcome_that_no_case_can_have(scene: str, word: str, good: bool) -> None:
    """A probability of 1 or 0 would be told of it."""
    spec = spec_of(f'jitter = true\nsuccess = "{word}"\n')
    if good:
        assert settled(spec, load(scene)).success.outcome == word
        return
    with pytest.raises(SceneError, match=f'line 7: success = "{word}": no case of {scene} can come out so: expected'):
        settled(spec, load(scene))


def test_a_figure_and_an_outcome() -> None:
    """A net that has slipped off does not hold, however little its vertex gave way; by the figure alone it did."""
    both = spec_of(
        f'success = {{ figure = "removal.largest_tug_peak", below = "50 N", outcome = "completed" }}\n{DRAWN}'
    )
    figure = replace(both.success, figure="capture.drawn", bound=10.0, outcome="flown", unit="1")
    flown, slipped, far = (
        row(capture__outcome=word, capture__drawn=way)
        for word, way in (("flown", 6.0), ("slipped off", 2.0), ("flown", 12.0))
    )
    assert [succeeded(one, figure) for one in (flown, slipped, far)] == [True, False, False]
    assert succeeded(slipped, replace(figure, outcome="")) is True
    assert succeeded(row(capture__outcome="flown"), figure) is None
    assert succeeded(row(5, "FMU failed"), figure) is None
    assert both.success.text == "removal.largest_tug_peak below 50 N, completed"
    assert settled(both, load("table2-deorbit")) == both
    wrong = spec_of(f'success = {{ figure = "removal.largest_tug_peak", below = "50 N", outcome = "missed" }}\n{DRAWN}')
    with pytest.raises(SceneError, match="no case of table2-deorbit can come out so"):
        settled(wrong, load("table2-deorbit"))


def test_a_rare_failure_goes_by_the_figure_alone() -> None:
    success = 'success = { figure = "removal.largest_tug_peak", below = "50 N", outcome = "completed" }'
    with pytest.raises(SceneError, match="goes by the figure alone"):
        spec_of(f'sampler = "subset"\n{success}\n{DRAWN}')
