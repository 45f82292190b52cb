"""A net smaller than the target's surface is warned of: it can hardly be drawn together behind it."""

import math

import pytest

from fmu_src.net_capture.cautions import before, surface_area
from fmu_src.net_capture.interface import TARGETS

BOX = {f"target.size[{axis}]": edge for axis, edge in enumerate((25.0, 5.0, 10.0), 1)}
TERMS = {"net": "rectangle", "target": "box", "contact": "inelastic", "closing": "winches"}


def told(width, height):
    values = {**BOX, "net.width": width, "net.height": height, "net.mesh": 1.0, "closing.rings": 3, "net.segments": 1}
    values["closing.lock_length"] = 1.0
    return [c.sentence for c in before(values, (), TERMS) if c.about == "net.width"]


def test_a_net_of_780_m2_for_850_m2_is_told():
    assert told(30.0, 26.0) == [
        "780 m2 of net are to close round 850 m2 of target: a mouth of its girth, 30 m, leaves at most 71.6 m2 of that "
        "bare, so it can hardly count as captured"
    ]
    assert not told(34.0, 25.1)
    assert told(34.0, 24.9)


@pytest.mark.parametrize(
    ("shape", "values", "area"),
    [
        ("box", BOX, 850.0),
        ("cylinder", {"target.radius": 2.0, "target.length": 5.0}, 2.0 * math.pi * 2.0 * 7.0),
        ("sphere", {"target.radius": 3.0}, 36.0 * math.pi),
    ],
)
def test_the_surface_of_a_shape(shape, values, area):
    assert surface_area(*TARGETS[shape].checks.surface(values)) == pytest.approx(area, rel=0.03)
