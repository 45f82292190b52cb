"""`like`: a phase that is as another one, but for what its own table says."""

from __future__ import annotations

from dcone_cosim.scene.mistakes import Mistake
from dcone_cosim.scenes.alike import filled

FIRST = {
    "net": {"side": "12 m", "mesh": "0.5 m"},
    "chaser": {"mass": "2000 kg", "start_position": ["0 m", "-12 m", "0 m"]},
    "target": {"shape": "box", "start_rate": ["1 deg/s", "0 deg/s", "0 deg/s"]},
    "macro_step": "0.1 s",
}


def test_its_own_words_count_and_the_rest_is_as_there() -> None:
    """What a hand-over sets is not taken, lists are not mixed, and what it is like stays as it was."""
    document = {"capture": FIRST, "second_shot": {"like": "capture", "net": {"mesh": "1 m"}, "macro_step": "0.2 s"}}
    mistakes: list[Mistake] = []
    found = filled(document, mistakes)["second_shot"]
    assert not mistakes
    assert found["net"] == {"side": "12 m", "mesh": "1 m"}
    assert found["chaser"] == {"start_position": ["0 m", "-12 m", "0 m"]}
    assert found["target"] == {"shape": "box"}
    assert found["macro_step"] == "0.2 s"
    assert document["capture"]["net"] == {"side": "12 m", "mesh": "0.5 m"}
    assert document["second_shot"]["net"] == {"mesh": "1 m"}


def test_a_phase_that_is_like_one_that_is_like_another() -> None:
    document = {"capture": FIRST, "second_shot": {"like": "capture"}, "third_shot": {"like": "second_shot"}}
    assert filled(document, [])["third_shot"]["net"] == FIRST["net"]


def test_what_it_cannot_be_like_is_told() -> None:
    for given in ("removal", "second_shot", 3):
        mistakes: list[Mistake] = []
        filled({"capture": FIRST, "removal": {}, "second_shot": {"like": given}}, mistakes)
        assert [mistake.path for mistake in mistakes] == [("second_shot", "like")], given
