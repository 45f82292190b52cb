"""Values as settings: what follows from them, and what a scene has named."""

from __future__ import annotations

import pytest

from dcone_cosim.cases.changes import following
from dcone_cosim.loading import load


def test_what_follows_from_a_value_follows_it() -> None:
    """25 x 25 knots, and a node in each of 1200 threads."""
    capture = load("mission").phases[0]
    assert list(following(capture, {"net.segments": 2.0})) == ["capture.nodes.capacity=1825"]
    assert list(following(capture, {"net.segments": 1.0})) == []


@pytest.mark.parametrize(
    ("scene", "settings", "group", "term"),
    [
        ("eclipse-powered", (), "oblateness", "J4"),
        ("edt", ('removal.electrodynamic.field="igrf"',), "electrodynamic", "igrf"),
        ("table2-deorbit", ('removal.level.detail="averaged"',), "level", "averaged"),
    ],
)
def test_a_term_that_a_scene_names_stays_whatever_the_values(
    scene: str, settings: tuple[str, ...], group: str, term: str
) -> None:
    """Where another is the usual one."""
    phase = load(scene, settings).phases[0]
    assert phase.main.terms[group] == term
    assert list(following(phase, {"tether.damping_ratio": 0.0})) == []
