"""The scaling law: a net at a sixteenth of its size opens alike over t/s, and not if its bullets' masses go with s2."""

import numpy as np

from tests.net_capture.evidence import similar

ALIKE = 1.0
"""Per cent of the flat net's area."""


def test_a_square_is_similar():
    whole, small, twin = (similar.curve("square", *how) for how in ((1.0,), (1.0 / 16.0,), (1.0 / 16.0, 2)))
    assert whole.max() > 0.5
    assert 100.0 * np.abs(whole - small).max() < ALIKE
    assert 100.0 * np.abs(whole - twin).max() > 5.0 * ALIKE
    assert (similar.curve("square", 1.0 / 16.0, alike=True) == whole).all(), "with substeps alike, the same bits"
