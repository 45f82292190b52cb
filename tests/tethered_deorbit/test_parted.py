"""A line that parts where it lies round a body: from then on it lies round nothing, and the run goes on."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fmu_src.tethered_deorbit.interface import HANDED_OVER, MODEL
from tests.plain import PlainInstance, plain

__all__ = ["plain"]
pytestmark = pytest.mark.usefixtures("plain")
RATE = 0.4
AWAY: dict[str, Any] = {
    "start.condition": HANDED_OVER,
    "start_relative_position": (0.0, 20.0, 0.0),
    "target_size": (2.0, 2.0, 2.0),
    "target_attachment": (0.0, -1.0, 0.0),
    "target_start_rate": (0.0, 0.0, RATE),
}
PARTS = {
    "release": ({"release": "time"}, {"release.at": 20.0, "tether.rest_length": 1000.0}),
    "break": ({"break": "breaks"}, {"break.strength": 5.0, "break.flies_on": 1, "tether.rest_length": 26.0}),
}


@pytest.mark.parametrize("how", PARTS)
def test_once_parted_the_line_lies_round_nothing(how: str) -> None:
    """A box that turns at 0.4 rad/s, field-free: 5 turns before the line is cut slack, or until it breaks as it is
    wound up taut; 15 more, in which a line still held would have been wound over more edges than are followed."""
    terms, values = PARTS[how]
    i = PlainInstance(MODEL, {"reel": "locked", "environment": "none", "target": "box", **terms}, AWAY | values)
    parted, wrapped, before = False, [], 0.0
    for _ in range(256):
        i.step(1.0)
        if not parted:
            before = i["tether.wrapped"] or before
        else:
            wrapped.append(i["tether.wrapped"])
            w, *xyz = i.array("target_attitude")
            arm = Rotation.from_quat([*xyz, w]).apply((0.0, -1.0, 0.0))
            straight = np.linalg.norm(i.array("target_position") + arm - i.array("chaser_position"))
            assert i["tether.length"] == pytest.approx(straight, rel=1e-12)
        parted = bool(i["release.released" if how == "release" else "break.broken"])
    assert parted
    assert before > 4.0
    assert len(wrapped) > 200
    assert max(wrapped) == 0.0
    assert not i["tether.taut"]
    assert i["tether.bends"] == 0
    if how == "release":
        assert i.array("target_rate")[2] == pytest.approx(RATE, rel=1e-12)
