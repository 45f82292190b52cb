"""What campaigns came to is told as it is stored."""

from __future__ import annotations

import json

from dcone_cosim.cases.statistics import share
from tests.campaign.evidence.__main__ import ANSWERS, PAGE, rows, stored, with_table


def test_page_and_gallery_tell_what_is_stored() -> None:
    page = PAGE.read_text(encoding="utf-8")
    assert with_table(page) == page
    assert json.loads(ANSWERS.read_text(encoding="utf-8")) == rows()
    assert stored()


def test_intervals_are_those_of_the_counts() -> None:
    """Wilson's, worked out again from the counts; every case has come to one outcome or given no answer."""
    for name, one in stored().items():
        told = sum(of["count"] for of in one["outcomes"].values()) + sum(one["no_answer"].values())
        assert told == one["cases"], name
        if one["probability"] is not None and one["probability"]["interval"][0] is not None:
            again = share(one["probability"]["count"], one["probability"]["of"])
            assert list(again.interval) == one["probability"]["interval"], name
