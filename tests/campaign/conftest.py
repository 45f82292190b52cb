"""What the tests of campaigns share: a scene of one small FMU whose answer is known in closed form."""

from __future__ import annotations

from pathlib import Path

import pytest

from dcone_cosim.campaign.reading import parse
from dcone_cosim.campaign.spec import Spec
from tests.cases.conftest import put_scene, template
from tests.cosim.conftest import dcone

__all__ = ["dcone", "template"]

DRIFT = """
title = "A pair that drifts"
scene = "drift.toml"
seed = 5
n = 60
success = { figure = "removal.separation", below = "10.12563103 m" } # two bodies 10 m apart, 100 s: 0.9 by hand

[[dispersion]]
key = "removal.start.relative_velocity[2]"
distribution = "normal"
mean = "1 mm/s"
deviation = "0.2 mm/s"
"""


@pytest.fixture
def drift(tmp_path: Path, template: Path) -> Path:
    """A campaign in a folder of its own, over a scene whose FMU takes a millisecond: separation = 10 m + v 100 s."""
    scene = put_scene(tmp_path / "scene", template)
    return put_campaign(scene.parent, DRIFT)


def put_campaign(folder: Path, text: str) -> Path:
    path = folder / "campaign.toml"
    path.write_text(text, encoding="utf-8")
    return path


TOW = """
title = "A tow"
scene = "table2-deorbit"
seed = 1
n = 10
"""


def spec_of(text: str = "", head: str = TOW) -> Spec:
    """A campaign of Table 2 with more in its file."""
    return parse(head + text, "tow", "tow.toml")
