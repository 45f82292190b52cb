"""The tow by itself: loads by hand, and a body that a hand-over has chosen."""

from __future__ import annotations

import math

import pytest

from dcone_cosim.cases.alone import Alone
from dcone_cosim.cases.rows import Row
from dcone_cosim.errors import InputError
from dcone_cosim.progress import Progress
from dcone_cosim.sizing.ground import Found, Ground, preload, reduced, steady, stiffness
from dcone_cosim.sizing.study import asked_of
from dcone_cosim.sizing.uncertain import uncertain

N = math.sqrt(3.986004418e14 / 7178137.0**3)


@pytest.fixture(scope="module")
def ground() -> Ground:
    return Ground(Alone("table2-deorbit", (), None), Progress())


def test_table_2(ground: Ground) -> None:
    assert stiffness(ground.values) == pytest.approx(3926.99, rel=1e-5)
    assert reduced(ground.values) == pytest.approx(666.667, rel=1e-5)
    assert steady(ground.values) == pytest.approx(0.025865, rel=1e-4), "the tide of a pair at rest"
    pulled = {**ground.values, "thrust.level": -1.0}
    assert steady(pulled) == pytest.approx(1.0 / 3.0)


def test_preload(ground: Ground) -> None:
    """At rest across the orbit the tide; along the track the thrust; a line that swings forwards pulls harder."""
    weight = 2000.0 / 3.0 * 12.0 * N**2
    assert preload(ground.values, 0.0, 0.0) == pytest.approx(3.0 * weight, rel=1e-6)
    assert preload(ground.values, math.pi / 2, 0.0) == pytest.approx(0.01 / 3.0, rel=1e-6)
    aslant = 0.75 * weight + 0.01 / 3.0 * math.sin(math.radians(60.0))
    assert preload(ground.values, math.radians(60.0), 0.0) == pytest.approx(aslant, rel=1e-6), "3 n^2 cos^2"
    assert preload(ground.values, 0.0, N) == pytest.approx(6.0 * weight, rel=1e-6)
    assert preload(ground.values, 0.0, -2.0 * N) == pytest.approx(3.0 * weight, rel=1e-6)


def test_a_line_that_ends_before_the_debris_centre(ground: Ground) -> None:
    """Two metres from it: the pair is 14 m long, and the tide pulls as much more."""
    longer = {**ground.values, "target.attachment_distance": 2.0}
    assert steady(longer) == pytest.approx(14.0 / 12.0 * steady(ground.values), rel=1e-12)
    assert preload(longer, 0.0, 0.0) == pytest.approx(14.0 / 12.0 * preload(ground.values, 0.0, 0.0), rel=1e-12)


def test_no_start_is_stretched(ground: Ground) -> None:
    """Table 2's starts two metres from taut; a shorter line or a farther start goes as far as the line reaches."""
    assert ground.fitted({"start.separation": 13.0})["start.separation"] == 12.0
    assert ground.fitted({"tether.rest_length": 9.0}) == {"tether.rest_length": 9.0, "start.separation": 9.0}
    assert ground.fitted({"tether.rest_length": 11.0}) == {"tether.rest_length": 11.0}
    heavy = Ground(Alone("tumbling-target", (), None), Progress())
    assert heavy.fitted({"start.separation": 15.0})["start.separation"] == 14.0, "its line ends 4 m before the centre"


def test_what_is_pinned_stays_in_every_run(ground: Ground) -> None:
    before = ground.case({}).key
    values = dict(ground.scene_with({"tether.diameter": 2e-3}).phases[0].main.parameters)
    assert values["tether.diameter"] == 2e-3
    assert ground.scene.phases[0].main.parameters["tether.diameter"] == 1e-3
    other = Ground(Alone("heavy-8t", (), None), Progress())
    assert other.breaks_at == 18e3
    other.pin({"break.strength": 1e12})
    assert other.scene_with({}).phases[0].main.parameters["break.strength"] == 1e12
    assert ground.case({}).key == before


def test_a_tow_that_is_handed_over_begins_where_that_left_it(ground: Ground) -> None:
    """Its own separation, a default, counts for nothing."""
    tow = Ground(Alone("mission", (), None), Progress())
    tow.pin({f"start.relative_position[{i}]": x for i, x in ((1, 3.0), (2, 4.0), (3, 12.0))})
    for of, expected in ((tow, (13.0, "the hand-over")), (ground, (10.0, "start.separation"))):
        (row,) = (row for row in asked_of(of) if row.what == "separation at the start")
        assert (row.value, row.how) == expected


def test_the_second_of_two_tows() -> None:
    """The tow that is named, by its own values and figures."""
    alone = Alone("two-tows", (), None)
    second = Ground(alone, Progress(), "second_tow")
    assert (second.phase.name, second.handed_over) == ("second_tow", True)
    assert not Ground(alone, Progress()).handed_over
    run = Found(1.0, (), Row("0", "completed", figures={"second_tow.tugs": 3}, samples={"second_tow": {"peak": 1.0}}))
    assert (run.figure("tugs"), run.loads["peak"]) == (3.0, 1.0)
    with pytest.raises(InputError, match=r"expected a key of \[second_tow\]"):
        uncertain(second, {"removal.thrust.level": ("-1 N", "-2 N")})
    with pytest.raises(InputError, match=r"needs a tow, \[capture\]"):
        Ground(Alone("mission", (), None), Progress(), "capture")


@pytest.mark.slow
def test_a_body_that_the_hand_over_has_chosen_stays() -> None:
    """The line of a debris that turns wraps round it: by itself too the tow has a box, turning as it was caught."""
    alone = Alone("tumbling-mission", ("removal.duration=1 min",), None)
    alone.begin(Progress())
    main = alone.scene_of("removal").phases[0].main
    assert main.terms["target"] == "box"
    rate = [main.parameters[f"target.start_rate[{i}]"] for i in (1, 2, 3)]
    assert math.degrees(math.hypot(*rate)) == pytest.approx(2.0, rel=0.1)
    assert main.parameters["target.size[2]"] == 3.9
