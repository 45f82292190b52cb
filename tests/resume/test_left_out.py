"""Going on from a run that left a further shot out, since the one before had caught the target."""

from __future__ import annotations

from pathlib import Path

import pytest

from dcone_cosim.errors import InputError
from tests.cosim.fmus.build import build
from tests.cosim.test_second_shot import TOWS, hits
from tests.runs import put, tables


@pytest.fixture(scope="module")
def caught(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A capture that took the target, a tow and another one; no second shot."""
    folder = tmp_path_factory.mktemp("caught")
    build(folder, "capture", "MISSES=0.6")
    (folder / "caught.toml").write_text(TOWS, encoding="utf-8")
    return put(folder / "caught.toml", folder / "run", (hits("capture"),))


def test_the_shot_that_was_left_out_is_refused_by_name(caught: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="that run left the second_shot out: the capture before it had not failed"):
        put(caught, tmp_path / "out", go_on="second_shot")
    assert not (tmp_path / "out").exists()


def test_the_tow_after_it_goes_on_with_the_same_bits(caught: Path, tmp_path: Path) -> None:
    again = put(caught, tmp_path / "again", go_on="removal")
    assert tables(again) == tables(caught)
    faster = put(caught, tmp_path / "faster", ("second_tow.thrust.level=-1 N",), go_on="second_tow")
    then = tables(faster)
    assert then["removal.parquet"] == tables(caught)["removal.parquet"]
    assert then["second_tow.parquet"] != tables(caught)["second_tow.parquet"]
