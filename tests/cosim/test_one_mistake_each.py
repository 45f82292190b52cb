"""One thing wrong with a scene is one mistake: nothing is said of what hangs on it."""

from __future__ import annotations

import pytest

from dcone_cosim.errors import InputError
from dcone_cosim.loading import load

OF_LEVEL = "removal.lumped = a table: cannot go together with [removal.level]"


@pytest.mark.parametrize(
    ("scene", "setting", "told"),
    [
        ("lumped-tether", 'removal.level.detail="event_map"', OF_LEVEL),
        ("lumped-tether", 'removal.plume.face="4 m"', OF_LEVEL.replace("level", "plume")),
        (
            "lumped-tether",
            'removal.reel.law="linear"',
            'removal.reel.law = "linear": does not go with the table [removal.lumped]: take locked, or leave that out',
        ),
        (
            "lumped-tether",
            'removal.solver.scheme="gauss"',
            'removal.solver.scheme = "gauss": does not go with the table [removal.lumped]: take dop853',
        ),
        ("second-shot", 'second_shot.like="removal"', 'second_shot.like = "removal": expected a phase of this scene'),
    ],
)  # fmt: skip
def test_of_what_hangs_on_a_mistake_nothing_is_said(scene: str, setting: str, told: str) -> None:
    with pytest.raises(InputError) as caught:
        load(scene, [setting])
    _, *mistakes = str(caught.value).splitlines()
    assert len(mistakes) == 1
    assert told in mistakes[0]


def test_a_key_that_no_term_has_is_told_all_the_same() -> None:
    with pytest.raises(InputError) as caught:
        load("lumped-tether", ['removal.level.detail="event_map"', "removal.lumped.node=3"])
    assert "removal.lumped.node = 3: unknown key" in str(caught.value)
