"""The Earth's shadow: its edges in a plane, and the share of a disc by counting."""

from __future__ import annotations

import math

import numpy as np
import pytest

from orbital.constants import ASTRONOMICAL_UNIT, EARTH_EQUATORIAL_RADIUS, SUN_RADIUS
from orbital.shadow import LIT, PENUMBRA, UMBRA, cone_zone, cylinder_zone, lit_share

SUN = np.array([ASTRONOMICAL_UNIT, 0.0, 0.0])
R = EARTH_EQUATORIAL_RADIUS


def test_cylinder() -> None:
    behind = np.array([-7e6, 0.999 * R, 0.0])
    assert cylinder_zone(behind, SUN, R) == UMBRA
    assert cylinder_zone(-behind, SUN, R) == LIT
    assert cylinder_zone(np.array([-7e6, 0.0, -1.001 * R]), SUN, R) == LIT


@pytest.mark.parametrize("back", [1e6, 7e6, 42e6, 380e6])
def test_cones(back: float) -> None:
    """Lines that touch both spheres: the umbra narrows as (R_s - R)/s, the penumbra widens as (R_s + R)/s."""
    s = ASTRONOMICAL_UNIT
    umbra, penumbra = math.asin((SUN_RADIUS - R) / s), math.asin((SUN_RADIUS + R) / s)
    inner = (R - back * math.sin(umbra)) / math.cos(umbra)
    outer = (R + back * math.sin(penumbra)) / math.cos(penumbra)
    for height, zone in (
        (inner - 10.0, UMBRA),
        (inner + 10.0, PENUMBRA),
        (outer - 10.0, PENUMBRA),
        (outer + 10.0, LIT),
    ):
        assert cone_zone(np.array([-back, 0.0, height]), SUN, R, SUN_RADIUS) == zone
    assert cone_zone(np.array([back, 0.0, inner]), SUN, R, SUN_RADIUS) == LIT


@pytest.mark.parametrize("height", [6.36e6, 6.38e6, 6.40e6])
def test_share_of_the_disc(height: float) -> None:
    place = np.array([-7e6, 0.0, height])
    axis = np.linspace(-1.0, 1.0, 1001)
    y, z = np.meshgrid(axis, axis)
    seen = y**2 + z**2 < 1.0
    points = np.stack([np.full(seen.sum(), SUN[0]), SUN_RADIUS * y[seen], SUN_RADIUS * z[seen]], axis=1)
    way = points - place
    way /= np.linalg.norm(way, axis=1)[:, None]
    along = -(way @ place)
    nearest = np.linalg.norm(place + np.maximum(along, 0.0)[:, None] * way, axis=1)
    assert lit_share(place, SUN, R, SUN_RADIUS) == pytest.approx(np.mean(nearest > R), abs=2e-3)
    assert lit_share(-place, SUN, R, SUN_RADIUS) == 1.0


def test_a_small_earth_hides_a_ring() -> None:
    far = np.array([-3e9, 0.0, 0.0])
    ratio = math.asin(R / 3e9) / math.asin(SUN_RADIUS / (SUN[0] + 3e9))
    assert cone_zone(far, SUN, R, SUN_RADIUS) == PENUMBRA
    assert lit_share(far, SUN, R, SUN_RADIUS) == pytest.approx(1.0 - ratio**2, rel=1e-12)
