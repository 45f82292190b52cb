"""What a scene says of the release: a speed that follows from an ejector's data, and lists with an entry per bullet."""

from __future__ import annotations

import math

import pytest

from dcone_cosim.errors import InputError
from dcone_cosim.loading import find
from dcone_cosim.scene.data import ComponentScene
from dcone_cosim.scenes.reading import parse

SPRINGS = ("capture.ejector.kind=springs", "capture.ejector.stiffness=3000 N/m", "capture.ejector.stroke=4 cm")


def main(*settings: str) -> ComponentScene:
    """The deployment without a speed, and with these settings."""
    text = find("deployment").read_text()
    less = text.replace('speed = "3 m/s"', "")
    assert less != text
    return parse(less, "mine", "mine", settings=settings).phases[0].main


def test_an_ejector_gives_the_speed() -> None:
    left_out = main(*SPRINGS)
    assert left_out.parameters["bullets.speed"] == pytest.approx(math.sqrt(3000.0 * 0.04**2 / 0.5), rel=1e-12)
    assert "bullets.speed" in left_out.designed


def test_a_speed_that_is_said_too_is_a_mistake() -> None:
    with pytest.raises(InputError, match=r"capture.bullets.speed = .3 m/s.: follows from what this scene asks for"):
        main(*SPRINGS, "capture.bullets.speed=3 m/s")


def test_an_ejector_that_cannot_work_is_told_by_its_key() -> None:
    with pytest.raises(InputError, match=r"capture.ejector.friction = .90 N.: must be less"):
        main(*SPRINGS, "capture.ejector.friction=90 N")


def test_lists_are_as_long_as_there_are_bullets() -> None:
    found = main(
        "capture.ejection.stays=[false, false, true, false]", "capture.ejection.delay=['0 s', '10 ms', '0 s', '0 s']"
    )
    assert found.terms["ejection"] == "4"
    assert [found.parameters[f"ejection.stays[{i}]"] for i in range(1, 5)] == [0.0, 0.0, 1.0, 0.0]
    with pytest.raises(InputError, match="expected a list of 4"):
        main("capture.ejection.stays=[false, true]")
    with pytest.raises(InputError, match=r"ejection.stays = .*: at least one must leave"):
        main("capture.ejection.stays=[true, true, true, true]")


def test_scatter_goes_into_the_errors_of_each_bullet() -> None:
    found = main(
        *SPRINGS, "capture.ejector.scatter=0.02", "capture.ejection.side_angle=['0 deg', '0 deg', '0 deg', '1 deg']"
    )
    errors = [found.parameters[f"ejection.speed_error[{i}]"] for i in range(1, 5)]
    assert len({*errors}) == 4
    assert 0.0 < max(map(abs, errors)) < 0.1 * found.parameters["bullets.speed"]
